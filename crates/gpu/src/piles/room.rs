//! Room for what a step finds. Batches of worlds are stepped one after the other, and share it.

use super::batch::Batch;
use super::joints::Joints;
use super::kernels::Kernels;
use super::plan::{KEYS, Plan, of_world, run, status};
use super::scene::{BODY, ROW, Scene};
use crate::memory::{NUMBER, buffer, filled, indirect};
use crate::pipeline::dispatch;
use crate::{Gpu, GpuError};
use rigid::impulse::pair::{placed, solid};
use rigid::impulse::{ContactTables, POINTS, REMEMBERED, global};
use std::iter::repeat_n;
use wgpu::{BindGroup, Buffer, ComputePass};

/// Buffers, in the order in which they are bound after those of a batch.
#[derive(Debug)]
pub(super) struct Buffers {
    rows: Buffer,
    shape_scratch: Buffer,
    placed: Buffer,
    pair_parameters: Buffer,
    pair_scratch: Buffer,
    mesh_parameters: Buffer,
    mesh_scratch: Buffer,
    fresh: Buffer,
    contacts: Buffer,
    joints: Buffer,
    seats: Buffer,
    words: Buffer,
    marks: Buffer,
    pub status: Buffer,
    runs: Buffer,
    pub launches: Buffer,
    struck_seats: Buffer,
    constants: Buffer,
    whole: Buffer,
    plan: Buffer,
    globals: Buffer,
    body_parameters: Buffer,
    shape_parameters: Buffer,
}

/// Buffers, and what the kernels bind of them. Made anew where there has to be more.
#[derive(Debug)]
pub(super) struct Room {
    pub buffers: Buffers,
    pub shapes: BindGroup,
    pub bodies: BindGroup,
    pub contacts: BindGroup,
    pub sums: BindGroup,
    pub colours: Vec<BindGroup>,
    /// Of runs of joints, and of those in them that hand a blow on; the last has all.
    pub joints: [Vec<BindGroup>; 2],
    pub groups: Vec<BindGroup>,
    /// Of buckets, units, groups, touching pairs, bodies, colours, pressing contacts, and those that ended.
    pub scans: [Scan; 8],
    pub sort_pairs: BindGroup,
    pub sort_contacts: BindGroup,
}

/// A run of words of which sums are taken.
#[derive(Debug)]
pub(super) struct Scan {
    length: u32,
    bindings: BindGroup,
}

/// Sums of words of which one workgroup takes care.
const SUMMED: u32 = 1024;
/// Numbers of a shape's scratch: motion, acceleration and place of its body.
const SHAPE_SCRATCH: usize = 19;
/// Numbers of the box about a shape.
const BOX: usize = 6;

impl Buffers {
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        plan: &Plan,
        [words, marks]: [u32; 2],
    ) -> Result<Self, GpuError> {
        let of = |things: u32, width: usize| sized(gpu, u64::from(things) * width as u64);
        let [parameters, scratch] = scene.pair_lengths(false);
        let [mesh_parameters, mesh_scratch] = scene.pair_lengths(true);
        Ok(Self {
            rows: of(plan.bodies, ROW)?,
            shape_scratch: of(plan.shapes, SHAPE_SCRATCH)?,
            placed: of(plan.shapes, placed::WIDTH + BOX)?,
            pair_parameters: of(plan.pairs, parameters)?,
            pair_scratch: of(plan.pairs, scratch)?,
            mesh_parameters: of(plan.mesh_pairs, mesh_parameters)?,
            mesh_scratch: of(plan.mesh_pairs, mesh_scratch)?,
            fresh: of(plan.contacts, REMEMBERED)?,
            contacts: of(plan.contacts, ContactTables::new().length)?,
            joints: of(plan.joints, scene.joints.as_ref().map_or(0, Joints::width))?,
            seats: of(2 * plan.contacts, 1)?,
            words: of(words + words.div_ceil(SUMMED), 1)?,
            marks: of(marks + marks.div_ceil(SUMMED), 1)?,
            status: buffer(gpu, told(plan) as u64)?,
            runs: of(run::COUNT, 2)?,
            launches: indirect(gpu, 3 * u64::from(run::JOINTS + plan.joint_runs))?,
            struck_seats: of(2 * plan.joints, 1)?,
            constants: sized(gpu, scene.constants(0).len() as u64)?,
            whole: buffer(gpu, scene.whole.len() as u64)?,
            plan: gpu.uniform(bytemuck::cast_slice(&[*plan])),
            globals: buffer(gpu, global::WIDTH as u64)?,
            body_parameters: of(plan.bodies, global::WIDTH + BODY)?,
            shape_parameters: of(plan.shapes, global::WIDTH + solid::WIDTH)?,
        })
    }
}

/// Words of the status of all worlds.
pub(super) fn told(plan: &Plan) -> usize {
    status::WIDTH + plan.worlds as usize * of_world::WIDTH
}

/// A buffer of so many numbers, if the card takes one that large.
pub(super) fn sized(gpu: &Gpu, numbers: u64) -> Result<Buffer, GpuError> {
    let (bytes, most) = (numbers * NUMBER, gpu.most_bytes());
    if bytes > most {
        return Err(GpuError::TooLarge {
            bytes,
            most,
            card: gpu.name().to_owned(),
        });
    }
    buffer(gpu, numbers)
}

/// What the kernels of each run of joints bind.
fn bind_joints(
    gpu: &Gpu,
    joints: &Joints,
    buffers: &Buffers,
    plan: &Plan,
) -> Result<[Vec<BindGroup>; 2], GpuError> {
    let (worlds, bodies) = (plan.worlds, plan.own_bodies);
    let seat = |world: u32, body: u32| if body == 0 { 0 } else { world * bodies + body };
    let all = joints.seats.iter();
    let seats = all.flat_map(|body| (0..worlds).map(move |world| seat(world, *body)));
    let seats = filled(gpu, &Vec::from_iter(seats))?;
    let runs = joints.runs.as_flattened().iter().map(|n| worlds * n);
    let runs = filled(gpu, &Vec::from_iter(runs))?;
    let links = filled(gpu, &joints.links)?;
    let Buffers {
        joints: own,
        struck_seats,
        rows,
        globals,
        ..
    } = buffers;
    let numbers = 0..joints.runs.len() as u32;
    let bind = |seats, number| {
        let launch = gpu.uniform(&[plan.joints, number, plan.bodies]);
        let all = [own, seats, &runs, rows, globals, &links, &launch];
        gpu.bindings(gpu.layout(), &all)
    };
    let of = |seats| numbers.clone().map(|number| bind(seats, number)).collect();
    Ok([of(&seats), of(struck_seats)])
}

impl Room {
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        plan: &mut Plan,
    ) -> Result<Self, GpuError> {
        let [words, marks] = plan.place();
        if plan.most_invocations() > gpu.most_invocations() {
            return Err(GpuError::Unsupported {
                what: "so many bodies, shapes, pairs or contacts",
                remedy: "run on the processor",
            });
        }
        let buffers = Buffers::new(gpu, scene, plan, [words, marks])?;
        let b = &buffers;
        let (none, nothing) = (buffer(gpu, 1)?, buffer(gpu, 1)?);
        let points = filled(gpu, &[POINTS as u32])?;
        let bind = |buffers: [&Buffer; 7]| gpu.bindings(gpu.layout(), &buffers);
        let of_run = |room: u32, number: u32| gpu.uniform(&[room, number, plan.bodies]);
        let of_contacts = |number: u32| {
            let launch = of_run(plan.contacts, number);
            bind([
                &b.contacts,
                &b.seats,
                &b.runs,
                &b.rows,
                &b.globals,
                &points,
                &launch,
            ])
        };
        let groups = scene.groups.iter().zip(0..).map(|(group, number)| {
            let links = filled(gpu, group.tables.links())?;
            let (room, scratch, parameters) = if group.has_mesh() {
                (plan.mesh_pairs, &b.mesh_scratch, &b.mesh_parameters)
            } else {
                (plan.pairs, &b.pair_scratch, &b.pair_parameters)
            };
            let launch = of_run(room, number);
            Ok(bind([
                &none, &nothing, &b.runs, scratch, parameters, &links, &launch,
            ]))
        });
        let bodies = of_run(plan.bodies, run::BODIES);
        let bodies = [
            &b.rows,
            &nothing,
            &b.runs,
            &none,
            &b.body_parameters,
            &points,
            &bodies,
        ];
        let launch = gpu.uniform(&[plan.shapes, 1]);
        let scratch = &b.shape_scratch;
        let shapes = [
            &b.placed,
            &nothing,
            &none,
            scratch,
            &b.shape_parameters,
            &points,
            &launch,
        ];
        // The sums of workgroups lie behind all others.
        let scan_of = |buffer: &Buffer, end: u32, at: u32, length: u32| {
            let uniform = gpu.uniform(&[at, length, end]);
            let bindings = gpu.bindings(&kernels.scanned, &[buffer, &uniform]);
            Scan { length, bindings }
        };
        let scan = |at: u32, length: u32| scan_of(&b.words, words, at, length);
        let scan_marks = |at: u32, length: u32| scan_of(&b.marks, marks, at, length);
        let sort = |numbers: [u32; 7]| {
            let uniform = gpu.uniform(&numbers);
            gpu.bindings(&kernels.sorted, &[&b.words, &b.status, &b.marks, &uniform])
        };
        Ok(Self {
            shapes: bind(shapes),
            bodies: bind(bodies),
            contacts: of_contacts(run::CONTACTS),
            sums: of_contacts(run::SUMS),
            colours: (0..plan.colours)
                .map(|colour| of_contacts(run::COLOURS + colour))
                .collect(),
            joints: match &scene.joints {
                Some(joints) => bind_joints(gpu, joints, &buffers, plan)?,
                None => [Vec::new(), Vec::new()],
            },
            groups: groups.collect::<Result<_, GpuError>>()?,
            scans: [
                scan_marks(plan.bucket_start, plan.buckets),
                scan(plan.unit_start, plan.units + 1),
                scan(plan.group_matrix, plan.group_matrix_length()),
                scan(plan.contact_start, plan.pairs + 1),
                scan_marks(plan.body_start, plan.bodies + 1),
                scan(plan.colour_matrix, plan.colour_matrix_length()),
                scan(plan.pressing, plan.contacts + 1),
                scan(plan.ended, plan.places() + 1),
            ],
            sort_pairs: sort([
                plan.pair_group,
                status::PAIRS as u32,
                plan.pairs,
                plan.groups,
                plan.pair_blocks,
                plan.group_matrix,
                plan.pair_order,
            ]),
            sort_contacts: sort([
                plan.colour,
                status::CONTACTS as u32,
                plan.contacts,
                KEYS,
                plan.contact_blocks,
                plan.colour_matrix,
                plan.contact_order,
            ]),
            buffers,
        })
    }

    /// Writes the constants of worlds from the first on.
    pub fn fill(&self, gpu: &Gpu, scene: &Scene, first: usize) {
        let b = &self.buffers;
        let behind_globals = |things: u32| u64::from(things) * global::WIDTH as u64;
        for (buffer, at, numbers) in [
            (&b.constants, 0, scene.constants(first)),
            (
                &b.body_parameters,
                behind_globals(scene.plan.bodies),
                scene.body_constants(first),
            ),
            (
                &b.shape_parameters,
                behind_globals(scene.plan.shapes),
                scene.shape_constants(first),
            ),
        ] {
            let bytes = bytemuck::cast_slice(&numbers);
            gpu.queue().write_buffer(buffer, at * NUMBER, bytes);
        }
        let bytes = bytemuck::cast_slice(&scene.whole);
        gpu.queue().write_buffer(&b.whole, 0, bytes);
    }
    /// Writes those of a step that is cut into so many parts.
    pub fn cut(&self, gpu: &Gpu, scene: &Scene, first: usize, parts: usize) {
        let globals = scene.globals(first, parts);
        let b = &self.buffers;
        let (bodies, shapes) = (scene.plan.own_bodies, scene.plan.own_shapes);
        // Row 0 of bodies is everybody's.
        for (buffer, before, each, sets) in [
            (&b.globals, 0, 1, &vec![scene.common_globals(parts)]),
            (&b.body_parameters, 1, bodies, &globals),
            (&b.shape_parameters, 0, shapes, &globals),
        ] {
            let column = |number: usize| {
                let own = move |set: &[f32; global::WIDTH]| repeat_n(set[number], each as usize);
                repeat_n(0.0, before).chain(sets.iter().flat_map(own))
            };
            let numbers = Vec::from_iter((0..global::WIDTH).flat_map(column));
            let bytes = bytemuck::cast_slice(&numbers);
            gpu.queue().write_buffer(buffer, 0, bytes);
        }
    }

    /// What lies between the kernels, with a batch's own buffers.
    pub fn of(&self, gpu: &Gpu, kernels: &Kernels, batch: &Batch) -> BindGroup {
        let b = &self.buffers;
        let all = [
            &batch.state,
            &batch.colours,
            &b.rows,
            &b.shape_scratch,
            &b.placed,
            &b.pair_parameters,
            &b.pair_scratch,
            &b.fresh,
            &b.contacts,
            &b.seats,
            &b.words,
            &b.marks,
            &b.status,
            &b.runs,
            &b.launches,
            &b.joints,
            &b.mesh_parameters,
            &b.mesh_scratch,
            &b.struck_seats,
            &b.constants,
            &b.whole,
            &b.plan,
        ];
        gpu.bindings(&kernels.bindings, &all)
    }
}

impl Scan {
    pub fn run(&self, pass: &mut ComputePass<'_>, k: &Kernels) {
        let blocks = self.length.div_ceil(SUMMED);
        for (kernel, blocks) in k.scan.iter().zip([blocks, 1, blocks]) {
            dispatch(pass, kernel, &self.bindings, blocks);
        }
    }
}
