//! Room for what a step finds. Batches of worlds are stepped one after the other, and share it.

use crate::Card;
use crate::batch::Batch;
use crate::card::{Commands, WORKGROUP, filled, sized};
use crate::joints::Joints;
use crate::kernels::Kernels;
use crate::plan::{COLOURS, KEYS, Plan, of_world, run, status};
use crate::scene::{ROW, Scene, unsupported};
use rigid::impulse::pair::placed;
use rigid::impulse::{ContactTables, POINTS, REMEMBERED, global};
use sim::DeviceError;

/// Buffers, in the order in which they are bound after those of a batch.
#[derive(Debug)]
pub(crate) struct Buffers<C: Card> {
    rows: C::Buffer,
    shape_scratch: C::Buffer,
    placed: C::Buffer,
    pair_parameters: C::Buffer,
    pair_scratch: C::Buffer,
    mesh_parameters: C::Buffer,
    mesh_scratch: C::Buffer,
    fresh: C::Buffer,
    contacts: C::Buffer,
    joints: C::Buffer,
    seats: C::Buffer,
    words: C::Buffer,
    marks: C::Buffer,
    pub status: C::Buffer,
    runs: C::Buffer,
    pub launches: C::Buffer,
    struck_seats: C::Buffer,
    whole: C::Buffer,
    plan: C::Buffer,
    globals: C::Buffer,
}

/// Buffers, and what the kernels bind of them. Made anew where there has to be more.
#[derive(Debug)]
pub(crate) struct Room<C: Card> {
    pub buffers: Buffers<C>,
    pub contacts: C::Bindings,
    pub sums: C::Bindings,
    pub colours: Vec<C::Bindings>,
    /// Of runs of joints, and of those in them that hand a blow on; the last has all.
    pub joints: [Vec<C::Bindings>; 2],
    pub groups: Vec<C::Bindings>,
    /// Of buckets, units, groups, touching pairs, bodies, colours, pressing contacts, and those that ended.
    pub scans: [Scan<C>; 8],
    pub sort_pairs: C::Bindings,
    pub sort_contacts: C::Bindings,
    /// What launches of bodies and of shapes see.
    bodies: C::Buffer,
    shapes: C::Buffer,
    /// What is bound where a kernel has nothing to write, and nothing to read.
    none: C::Buffer,
    nothing: C::Buffer,
    /// Points of a contact.
    points: C::Buffer,
}

/// What kernels bind of a batch.
#[derive(Debug)]
pub(crate) struct Own<C: Card> {
    /// Those between the kernels.
    all: C::Bindings,
    pub bodies: C::Bindings,
    pub shapes: C::Bindings,
}

/// A run of words of which sums are taken.
#[derive(Debug)]
pub(crate) struct Scan<C: Card> {
    length: u32,
    bindings: C::Bindings,
}

/// Sums of words of which one workgroup takes care.
const SUMMED: u32 = 1024;
/// Numbers of a shape's scratch: motion, acceleration and place of its body.
const SHAPE_SCRATCH: usize = 19;
/// Numbers of the box about a shape.
const BOX: usize = 6;

impl<C: Card> Buffers<C> {
    fn new(
        card: &C,
        scene: &Scene,
        plan: &Plan,
        [words, marks]: [u32; 2],
    ) -> Result<Self, DeviceError> {
        let of = |things: u32, width: usize| sized(card, u64::from(things) * width as u64);
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
            status: card.buffer(told(plan) as u64)?,
            runs: of(run::COUNT, 2)?,
            launches: card.launches(3 * u64::from(run::JOINTS + plan.joint_runs))?,
            struck_seats: of(2 * plan.joints, 1)?,
            whole: filled(card, &scene.whole)?,
            plan: card.uniform(bytemuck::cast_slice(&[*plan]))?,
            globals: card.buffer(global::WIDTH as u64)?,
        })
    }
}

/// Words of the status of all worlds.
pub(crate) fn told(plan: &Plan) -> usize {
    status::WIDTH + plan.worlds as usize * of_world::WIDTH
}

/// What the kernels of each run of joints bind.
fn bind_joints<C: Card>(
    card: &C,
    joints: &Joints,
    buffers: &Buffers<C>,
    plan: &Plan,
) -> Result<[Vec<C::Bindings>; 2], DeviceError> {
    let (worlds, bodies) = (plan.worlds, plan.own_bodies);
    let seat = |world: u32, body: u32| match body {
        0 => world,
        body => worlds + world * bodies + body - 1,
    };
    let all = joints.seats.iter();
    let seats = all.flat_map(|body| (0..worlds).map(move |world| seat(world, *body)));
    let seats = filled(card, &Vec::from_iter(seats))?;
    let runs = joints.runs.as_flattened().iter().map(|n| worlds * n);
    let runs = filled(card, &Vec::from_iter(runs))?;
    let links = filled(card, &joints.links)?;
    let Buffers {
        joints: own,
        struck_seats,
        rows,
        globals,
        ..
    } = buffers;
    let numbers = 0..joints.runs.len() as u32;
    let bind = |seats, number| {
        let launch = card.uniform(&[plan.joints, number, plan.bodies])?;
        let all = [own, seats, &runs, rows, globals, &links, &launch];
        Ok(card.bind_kernel(all))
    };
    let of = |seats| numbers.clone().map(|number| bind(seats, number)).collect();
    let [all, struck]: [Result<_, DeviceError>; 2] = [of(&seats), of(struck_seats)];
    Ok([all?, struck?])
}

impl<C: Card> Room<C> {
    pub fn new(
        card: &C,
        scene: &Scene,
        kernels: &Kernels<C>,
        plan: &mut Plan,
    ) -> Result<Self, DeviceError> {
        let [words, marks] = plan.place();
        if plan.most_invocations() > card.most_invocations() {
            return Err(unsupported(
                "so many bodies, shapes, pairs or contacts",
                "run on the processor",
            )
            .into());
        }
        let buffers = Buffers::new(card, scene, plan, [words, marks])?;
        let b = &buffers;
        let (none, nothing) = (card.buffer(1)?, card.buffer(1)?);
        let points = filled(card, &[POINTS as u32])?;
        let bind = |buffers: [&C::Buffer; 7]| card.bind_kernel(buffers);
        let of_run = |room: u32, number: u32| card.uniform(&[room, number, plan.bodies]);
        let of_contacts = |number: u32| {
            let launch = of_run(plan.contacts, number)?;
            Ok(bind([
                &b.contacts,
                &b.seats,
                &b.runs,
                &b.rows,
                &b.globals,
                &points,
                &launch,
            ]))
        };
        let groups = scene.groups.iter().zip(0..).map(|(group, number)| {
            let links = filled(card, group.tables.links())?;
            let (room, scratch, parameters) = if group.has_mesh() {
                (plan.mesh_pairs, &b.mesh_scratch, &b.mesh_parameters)
            } else {
                (plan.pairs, &b.pair_scratch, &b.pair_parameters)
            };
            let launch = of_run(room, number)?;
            Ok(bind([
                &none, &nothing, &b.runs, scratch, parameters, &links, &launch,
            ]))
        });
        // The sums of workgroups lie behind all others.
        let scan_of = |buffer: &C::Buffer, end: u32, at: u32, length: u32| {
            let uniform = card.uniform(&[at, length, end])?;
            let bindings = card.bind(&kernels.scanned, &[buffer, &uniform]);
            Ok::<_, DeviceError>(Scan { length, bindings })
        };
        let scan = |at: u32, length: u32| scan_of(&b.words, words, at, length);
        let scan_marks = |at: u32, length: u32| scan_of(&b.marks, marks, at, length);
        let sort = |numbers: [u32; 7]| {
            let uniform = card.uniform(&numbers)?;
            let buffers = [&b.words, &b.status, &b.marks, &uniform];
            Ok::<_, DeviceError>(card.bind(&kernels.sorted, &buffers))
        };
        Ok(Self {
            bodies: of_run(plan.bodies, run::BODIES)?,
            shapes: card.uniform(&[plan.shapes, 1])?,
            contacts: of_contacts(run::CONTACTS)?,
            sums: of_contacts(run::SUMS)?,
            colours: (0..COLOURS)
                .map(|colour| of_contacts(run::COLOURS + colour))
                .collect::<Result<_, DeviceError>>()?,
            joints: match &scene.joints {
                Some(joints) => bind_joints(card, joints, &buffers, plan)?,
                None => [Vec::new(), Vec::new()],
            },
            groups: groups.collect::<Result<_, DeviceError>>()?,
            scans: [
                scan_marks(plan.bucket_start, plan.buckets)?,
                scan(plan.unit_start, plan.units + 1)?,
                scan(plan.group_matrix, plan.group_matrix_length())?,
                scan(plan.contact_start, plan.pairs + 1)?,
                scan_marks(plan.body_start, plan.bodies + 1)?,
                scan(plan.colour_matrix, plan.colour_matrix_length())?,
                scan(plan.pressing, plan.contacts + 1)?,
                scan(plan.ended, plan.places() + 1)?,
            ],
            sort_pairs: sort([
                plan.pair_group,
                status::PAIRS as u32,
                plan.pairs,
                plan.groups,
                plan.pair_blocks,
                plan.group_matrix,
                plan.pair_order,
            ])?,
            sort_contacts: sort([
                plan.colour,
                status::CONTACTS as u32,
                plan.contacts,
                KEYS,
                plan.contact_blocks,
                plan.colour_matrix,
                plan.contact_order,
            ])?,
            none,
            nothing,
            points,
            buffers,
        })
    }

    /// Writes the constants of a step that is cut into so many parts: those of the model, which contacts and joints read.
    pub fn cut(&self, card: &C, scene: &Scene, parts: usize) -> Result<(), DeviceError> {
        let globals = scene.common_globals(parts);
        card.write(&self.buffers.globals, 0, bytemuck::cast_slice(&globals))
    }
    /// After constants have changed, and where they lie.
    pub fn renew(&self, card: &C, scene: &Scene, plan: &Plan) -> Result<(), DeviceError> {
        card.write(&self.buffers.plan, 0, bytemuck::bytes_of(plan))?;
        card.write(&self.buffers.whole, 0, bytemuck::cast_slice(&scene.whole))
    }

    /// What kernels bind of a batch.
    pub fn of(&self, card: &C, kernels: &Kernels<C>, batch: &Batch<C>) -> Own<C> {
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
            all: card.bind(&kernels.bindings, &all),
            bodies: card.bind_kernel(bodies),
            shapes: card.bind_kernel(shapes),
        }
    }
}

impl<C: Card> Own<C> {
    /// Runs what lies between the kernels on so many things.
    pub fn launch(&self, todo: &mut C::Commands<'_>, kernel: &C::Kernel, things: u32) {
        todo.run(kernel, &self.all, things.div_ceil(WORKGROUP));
    }
}

impl<C: Card> Scan<C> {
    pub fn run(&self, todo: &mut C::Commands<'_>, k: &Kernels<C>) {
        let blocks = self.length.div_ceil(SUMMED);
        for (kernel, blocks) in k.scan.iter().zip([blocks, 1, blocks]) {
            todo.run(kernel, &self.bindings, blocks);
        }
    }
}
