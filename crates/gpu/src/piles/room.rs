//! Room for what a step finds. Batches of worlds are stepped one after the other, and share it.

use super::batch::Batch;
use super::joints::Joints;
use super::kernels::Kernels;
use super::plan::{COLOURS, KEYS, Plan, of_world, run, status};
use super::scene::{ROW, Scene};
use crate::memory::{NUMBER, buffer, filled, indirect};
use crate::pipeline::{WORKGROUP, dispatch};
use crate::{Gpu, GpuError};
use rigid::impulse::pair::placed;
use rigid::impulse::{ContactTables, POINTS, REMEMBERED, global};
use wgpu::{BindGroup, Buffer, ComputePass, ComputePipeline};

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
    whole: Buffer,
    plan: Buffer,
    globals: Buffer,
}

/// Buffers, and what the kernels bind of them. Made anew where there has to be more.
#[derive(Debug)]
pub(super) struct Room {
    pub buffers: Buffers,
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
    /// What launches of bodies and of shapes see.
    bodies: Buffer,
    shapes: Buffer,
    /// What is bound where a kernel has nothing to write, and nothing to read.
    none: Buffer,
    nothing: Buffer,
    /// Points of a contact.
    points: Buffer,
}

/// What kernels bind of a batch.
#[derive(Debug)]
pub(super) struct Own {
    /// Those between the kernels.
    all: BindGroup,
    pub bodies: BindGroup,
    pub shapes: BindGroup,
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
            whole: filled(gpu, &scene.whole)?,
            plan: gpu.uniform(bytemuck::cast_slice(&[*plan])),
            globals: buffer(gpu, global::WIDTH as u64)?,
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
    let seat = |world: u32, body: u32| match body {
        0 => world,
        body => worlds + world * bodies + body - 1,
    };
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
            bodies: of_run(plan.bodies, run::BODIES),
            shapes: gpu.uniform(&[plan.shapes, 1]),
            contacts: of_contacts(run::CONTACTS),
            sums: of_contacts(run::SUMS),
            colours: (0..COLOURS)
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
            none,
            nothing,
            points,
            buffers,
        })
    }

    /// Writes the constants of a step that is cut into so many parts: those of the model, which contacts and joints read.
    pub fn cut(&self, gpu: &Gpu, scene: &Scene, parts: usize) {
        let globals = scene.common_globals(parts);
        let bytes = bytemuck::cast_slice(&globals);
        gpu.queue().write_buffer(&self.buffers.globals, 0, bytes);
    }
    /// After constants have changed, and where they lie.
    pub fn renew(&self, gpu: &Gpu, scene: &Scene, plan: &Plan) {
        let b = &self.buffers;
        let plan = bytemuck::bytes_of(plan);
        gpu.queue().write_buffer(&b.plan, 0, plan);
        let whole = bytemuck::cast_slice(&scene.whole);
        gpu.queue().write_buffer(&b.whole, 0, whole);
    }

    /// What kernels bind of a batch.
    pub fn of(&self, gpu: &Gpu, kernels: &Kernels, batch: &Batch) -> Own {
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
            &batch.constants,
            &b.whole,
            &b.plan,
        ];
        let (none, nothing, points) = (&self.none, &self.nothing, &self.points);
        let bodies = [
            &b.rows,
            nothing,
            &b.runs,
            none,
            &batch.bodies,
            points,
            &self.bodies,
        ];
        let shapes = [
            &b.placed,
            nothing,
            none,
            &b.shape_scratch,
            &batch.shapes,
            points,
            &self.shapes,
        ];
        Own {
            all: gpu.bindings(&kernels.bindings, &all),
            bodies: gpu.bindings(gpu.layout(), &bodies),
            shapes: gpu.bindings(gpu.layout(), &shapes),
        }
    }
}

impl Own {
    /// Runs what lies between the kernels on so many things.
    pub fn launch(&self, pass: &mut ComputePass<'_>, kernel: &ComputePipeline, things: u32) {
        dispatch(pass, kernel, &self.all, things.div_ceil(WORKGROUP));
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
