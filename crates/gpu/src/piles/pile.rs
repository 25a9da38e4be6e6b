//! One world of many bodies in a card's memory.

use super::kernels::Kernels;
use super::plan::{BLOCK, COLOURS, KEYS, Plan, flag, run, status};
use super::scene::Scene;
use crate::memory::{NUMBER, Staging, buffer, filled, indirect};
use crate::pipeline::WORKGROUP;
use crate::{Gpu, GpuError};
use rigid::impulse::{ContactTables, REMEMBERED, pair::placed, row};
use wgpu::{BindGroup, Buffer, CommandEncoder, ComputePass, ComputePipeline};

/// A world, and room for what its steps find.
#[derive(Debug)]
pub(super) struct Pile {
    plan: Plan,
    /// Rounds of colouring in a step.
    rounds: usize,
    /// Steps in a submission: fewer where they are often not taken.
    eager: usize,
    state: Buffer,
    status: Buffer,
    launches: Buffer,
    steps: Steps,
    staging: Staging,
}

/// What a step binds. Made anew where there has to be more room.
#[derive(Debug)]
struct Steps {
    all: BindGroup,
    place: BindGroup,
    bodies: BindGroup,
    contacts: BindGroup,
    colours: Vec<BindGroup>,
    groups: Vec<BindGroup>,
    /// Of buckets, units, groups, touching pairs, bodies, colours, pressing contacts.
    scans: [Scan; 7],
    sort_pairs: BindGroup,
    sort_contacts: BindGroup,
}

/// A run of words of which sums are taken.
#[derive(Debug)]
struct Scan {
    length: u32,
    bindings: BindGroup,
}

/// Pairs and contacts of each body that there is room for at first.
const PAIRS: u32 = 8;
const CONTACTS: u32 = 4;
/// Colours that are launched at first, and rounds of colouring at least.
const FIRST_COLOURS: u32 = 16;
const FEWEST_ROUNDS: usize = 8;
/// Sums of words of which one workgroup takes care.
const SUMMED: u32 = 1024;
/// Most steps in one submission.
const STEPS: usize = 16;

/// How far a submission has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Progress {
    /// So many steps were taken; the next one is to be tried again, or is beyond those asked for.
    Taken(usize),
    /// So many were taken; the next one is the processor's.
    Processor(usize),
    /// The world has diverged.
    Dead,
}

impl Pile {
    pub fn new(gpu: &Gpu, scene: &Scene, kernels: &Kernels) -> Result<Self, GpuError> {
        let mut plan = scene.plan;
        plan.pairs = PAIRS * plan.shapes + BLOCK;
        plan.contacts = CONTACTS * plan.bodies + BLOCK;
        plan.colours = FIRST_COLOURS;
        let state = room(gpu, scene.impulse.lengths().state as u64)?;
        let status = filled(gpu, &[0_u32; status::WIDTH])?;
        let launches = indirect(gpu, 3 * u64::from(run::COUNT))?;
        let steps = Steps::new(gpu, scene, kernels, &mut plan, [&state, &status, &launches])?;
        Ok(Self {
            plan,
            rounds: FEWEST_ROUNDS,
            eager: 1,
            state,
            status,
            launches,
            steps,
            staging: Staging::default(),
        })
    }

    /// Sets numbers of the state, from one of them on.
    pub fn write(&self, gpu: &Gpu, first: usize, numbers: &[f32]) {
        let bytes = bytemuck::cast_slice(numbers);
        gpu.queue()
            .write_buffer(&self.state, first as u64 * NUMBER, bytes);
    }
    /// Reads these numbers of the state.
    pub fn read(
        &mut self,
        gpu: &Gpu,
        numbers: std::ops::Range<usize>,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), GpuError> {
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let ranges = std::iter::once(numbers.clone());
        self.staging.ask(gpu, &mut encoder, &self.state, ranges)?;
        gpu.queue().submit([encoder.finish()]);
        let Some(mapping) = self.staging.map() else {
            return Ok(());
        };
        gpu.wait()?;
        mapping.read(gpu, |all| read(&all[..numbers.len()]))
    }

    /// Takes at most so many steps.
    pub fn step(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        steps: usize,
    ) -> Result<Progress, GpuError> {
        gpu.queue()
            .write_buffer(&self.status, 0, &[0; 4 * status::WIDTH]);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let steps = steps.min(self.eager);
        for _ in 0..steps {
            self.encode(kernels, scene, &mut encoder);
        }
        let all = std::iter::once(0..status::WIDTH);
        self.staging.ask(gpu, &mut encoder, &self.status, all)?;
        gpu.queue().submit([encoder.finish()]);
        let Some(mapping) = self.staging.map() else {
            return Ok(Progress::Taken(0));
        };
        gpu.wait()?;
        let mut told = [0_u32; status::WIDTH];
        mapping.read(gpu, |numbers| {
            told = std::array::from_fn(|i| numbers[i].to_bits());
        })?;
        let (flags, taken) = (told[status::FLAG], told[status::STEPS] as usize);
        if flags & flag::DEAD != 0 {
            return Ok(Progress::Dead);
        }
        self.eager = if taken == steps {
            STEPS.min(2 * self.eager)
        } else {
            1
        };
        if flags & (flag::MORE_PAIRS | flag::MORE_CONTACTS | flag::MORE_COLOURS) != 0 {
            self.grow(gpu, scene, kernels, &told)?;
        } else if flags & flag::MORE_ROUNDS != 0 {
            self.rounds *= 2;
        } else {
            // In most steps colours are those of the step before.
            self.rounds = FEWEST_ROUNDS.max(2 * told[status::ROUNDS] as usize);
            if flags & flag::PROCESSOR != 0 {
                return Ok(Progress::Processor(taken));
            }
        }
        Ok(Progress::Taken(taken))
    }

    /// Makes room for what a step has found too little for.
    fn grow(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        told: &[u32; status::WIDTH],
    ) -> Result<(), GpuError> {
        let flags = told[status::FLAG];
        let enough = |n: u32| n + n / 2;
        let p = &mut self.plan;
        if flags & flag::MORE_PAIRS != 0 {
            p.pairs = enough(told[status::PAIRS]);
        } else if flags & flag::MORE_CONTACTS != 0 {
            p.contacts = enough(told[status::CONTACTS]);
        } else {
            p.colours = enough(told[status::COLOURED]).min(COLOURS);
        }
        let kept = [&self.state, &self.status, &self.launches];
        self.steps = Steps::new(gpu, scene, kernels, &mut self.plan, kept)?;
        Ok(())
    }

    fn encode(&self, k: &Kernels, scene: &Scene, encoder: &mut CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let pass = &mut pass;
        let (p, s, e) = (&self.plan, &self.steps, &k.entries);
        let all = |pass: &mut ComputePass<'_>, kernel: &ComputePipeline, things: u32| {
            dispatch(pass, kernel, &s.all, things.div_ceil(WORKGROUP));
        };
        all(pass, &e.clear, p.buckets.max(p.bodies) + 1);
        all(pass, &e.load_bodies, p.bodies);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        dispatch(pass, &k.begin, &s.bodies, bodies);
        all(pass, &e.load_shapes, p.shapes);
        dispatch(pass, &k.place, &s.place, p.shapes.div_ceil(WORKGROUP));
        let [buckets, units, groups, touching, joined, colours, pressing] = &s.scans;
        all(pass, &e.surround, p.shapes);
        buckets.run(pass, k);
        all(pass, &e.fill_buckets, p.shapes);
        all(pass, &e.count_pairs, p.units + 1);
        units.run(pass, k);
        all(pass, &e.list_pairs, p.units + 1);
        dispatch(pass, &k.sort[0], &s.sort_pairs, p.pair_blocks);
        groups.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_pairs, p.pair_blocks);
        all(pass, &e.plan_groups, p.groups);
        all(pass, &e.seat_pairs, p.pairs);
        for (group, (kernel, bindings)) in (0..).zip(k.apart.iter().zip(&s.groups)) {
            if let Some(kernel) = kernel {
                self.run(pass, kernel, bindings, group);
            }
        }
        all(pass, &e.part_pairs, p.pairs);
        for (group, (kernel, bindings)) in (0..).zip(k.groups.iter().zip(&s.groups)) {
            self.run(pass, kernel, bindings, group);
        }
        all(pass, &e.find_touching, p.pairs + 1);
        touching.run(pass, k);
        all(pass, &e.make_contacts, p.pairs + 1);
        joined.run(pass, k);
        all(pass, &e.join, p.contacts);
        for _ in 0..self.rounds {
            all(pass, &e.paint, p.contacts);
            all(pass, &e.settle, 1);
        }
        dispatch(pass, &k.sort[0], &s.sort_contacts, p.contact_blocks);
        colours.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_contacts, p.contact_blocks);
        all(pass, &e.plan_colours, KEYS);
        all(pass, &e.seat_contacts, p.contacts);
        self.run(pass, &k.prepare, &s.contacts, run::CONTACTS);
        self.small_steps(pass, k, scene);
        dispatch(pass, &k.finish, &s.bodies, bodies);
        all(pass, &e.read_contacts, p.contacts);
        all(pass, &e.find_pressing, p.contacts + 1);
        pressing.run(pass, k);
        all(pass, &e.check_bodies, p.bodies);
        all(pass, &e.check_shapes, p.shapes);
        all(pass, &e.store_bodies, p.bodies);
        all(pass, &e.store_contacts, p.contacts);
        all(pass, &e.end, 1);
    }

    fn small_steps(&self, pass: &mut ComputePass<'_>, k: &Kernels, scene: &Scene) {
        let (p, s) = (&self.plan, &self.steps);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        let contacts = |pass: &mut ComputePass<'_>, kernel: &ComputePipeline| {
            for (colour, bindings) in (0..p.colours).zip(&s.colours) {
                self.run(pass, kernel, bindings, run::COLOURS + colour);
            }
        };
        for step in 0..scene.impulse.settings().contact_iterations {
            if step == 0 {
                dispatch(pass, &k.advance, &s.bodies, bodies);
                if p.bounces != 0 {
                    self.run(pass, &k.foresee, &s.contacts, run::CONTACTS);
                    let all = p.contacts.div_ceil(WORKGROUP);
                    dispatch(pass, &k.entries.find_blows, &s.all, all);
                }
                contacts(pass, &k.warm_start);
            } else {
                dispatch(pass, &k.advance_again, &s.bodies, bodies);
            }
            contacts(pass, &k.push);
            dispatch(pass, &k.drift, &s.bodies, bodies);
            contacts(pass, &k.relax);
        }
    }

    /// Runs a kernel on the members of a run.
    fn run(
        &self,
        pass: &mut ComputePass<'_>,
        kernel: &ComputePipeline,
        bindings: &BindGroup,
        run: u32,
    ) {
        pass.set_pipeline(kernel);
        pass.set_bind_group(0, bindings, &[]);
        pass.dispatch_workgroups_indirect(&self.launches, u64::from(3 * run) * NUMBER);
    }
}

/// A buffer of so many numbers, if the card takes one that large.
fn room(gpu: &Gpu, numbers: u64) -> Result<Buffer, GpuError> {
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

fn dispatch(
    pass: &mut ComputePass<'_>,
    kernel: &ComputePipeline,
    bindings: &BindGroup,
    workgroups: u32,
) {
    pass.set_pipeline(kernel);
    pass.set_bind_group(0, bindings, &[]);
    pass.dispatch_workgroups(workgroups, 1, 1);
}

impl Steps {
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        plan: &mut Plan,
        [state, status, launches]: [&Buffer; 3],
    ) -> Result<Self, GpuError> {
        let used = plan.place();
        let words = room(gpu, u64::from(used + used.div_ceil(SUMMED)))?;
        let of = |things: u32, width: usize| room(gpu, u64::from(things) * width as u64);
        let lengths = scene.groups.iter().map(|group| group.tables.lengths());
        let longest = lengths.fold([1; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let rows = of(plan.bodies, row::WIDTH)?;
        let shape_scratch = of(plan.shapes, SHAPE_SCRATCH)?;
        let placed = of(plan.shapes, placed::WIDTH + 6)?;
        let pair_parameters = of(plan.pairs, longest[0])?;
        let pair_scratch = of(plan.pairs, longest[1])?;
        let fresh = of(plan.contacts, REMEMBERED)?;
        let contacts = of(plan.contacts, ContactTables::new().length)?;
        let seats = of(2 * plan.contacts, 1)?;
        let runs = of(run::COUNT, 2)?;
        let constants = filled(gpu, &scene.constants)?;
        let whole = filled(gpu, &scene.whole)?;
        let uniform = gpu.uniform(bytemuck::cast_slice(&[*plan]));
        let (none, nothing) = (buffer(gpu, 1)?, buffer(gpu, 1)?);
        let all = [
            state,
            &rows,
            &shape_scratch,
            &placed,
            &pair_parameters,
            &pair_scratch,
            &fresh,
            &contacts,
            &seats,
            &words,
            status,
            &runs,
            launches,
            &constants,
            &whole,
            &uniform,
        ];
        let body_parameters = filled(gpu, &scene.body_parameters)?;
        let shape_parameters = filled(gpu, &scene.shape_parameters)?;
        let globals = filled(gpu, &scene.globals)?;
        let points = filled(gpu, &[rigid::impulse::POINTS as u32])?;
        let bind = |buffers: [&Buffer; 7]| gpu.bindings(gpu.layout(), &buffers);
        let of_run = |room: u32, number: u32| gpu.uniform(&[room, number, plan.bodies]);
        let of_contacts = |number: u32| {
            let launch = of_run(plan.contacts, number);
            bind([&contacts, &seats, &runs, &rows, &globals, &points, &launch])
        };
        let groups = scene.groups.iter().zip(0..).map(|(group, number)| {
            let launch = of_run(plan.pairs, number);
            let links = filled(gpu, group.tables.links())?;
            Ok(bind([
                &none,
                &nothing,
                &runs,
                &pair_scratch,
                &pair_parameters,
                &links,
                &launch,
            ]))
        });
        let bodies = of_run(plan.bodies, run::BODIES);
        let shapes = gpu.uniform(&[plan.shapes, 1]);
        let scan = |at: u32, length: u32| Scan::new(gpu, kernels, &words, [at, length, used]);
        let pairs = [
            plan.pair_group,
            status::PAIRS as u32,
            plan.pairs,
            plan.groups,
            plan.pair_blocks,
            plan.group_matrix,
            plan.pair_order,
        ];
        let coloured = [
            plan.colour,
            status::CONTACTS as u32,
            plan.contacts,
            KEYS,
            plan.contact_blocks,
            plan.colour_matrix,
            plan.contact_order,
        ];
        let sort = |numbers: [u32; 7]| {
            let uniform = gpu.uniform(&numbers);
            gpu.bindings(&kernels.sorted, &[&words, status, &uniform])
        };
        Ok(Self {
            all: gpu.bindings(&kernels.bindings, &all),
            place: bind([
                &placed,
                &nothing,
                &none,
                &shape_scratch,
                &shape_parameters,
                &points,
                &shapes,
            ]),
            bodies: bind([
                &rows,
                &nothing,
                &runs,
                &none,
                &body_parameters,
                &points,
                &bodies,
            ]),
            contacts: of_contacts(run::CONTACTS),
            colours: (0..plan.colours)
                .map(|c| of_contacts(run::COLOURS + c))
                .collect(),
            groups: groups.collect::<Result<_, GpuError>>()?,
            scans: [
                scan(plan.bucket_start, plan.buckets),
                scan(plan.unit_start, plan.units + 1),
                scan(plan.group_matrix, plan.group_matrix_length()),
                scan(plan.contact_start, plan.pairs + 1),
                scan(plan.body_start, plan.bodies + 1),
                scan(plan.colour_matrix, plan.colour_matrix_length()),
                scan(plan.pressing, plan.contacts + 1),
            ],
            sort_pairs: sort(pairs),
            sort_contacts: sort(coloured),
        })
    }
}

/// Numbers of a shape's scratch: motion, acceleration and place of its body.
const SHAPE_SCRATCH: usize = 19;

impl Scan {
    fn new(gpu: &Gpu, kernels: &Kernels, words: &Buffer, numbers: [u32; 3]) -> Self {
        let uniform = gpu.uniform(&numbers);
        Self {
            length: numbers[1],
            bindings: gpu.bindings(&kernels.scanned, &[words, &uniform]),
        }
    }
    fn run(&self, pass: &mut ComputePass<'_>, k: &Kernels) {
        let blocks = self.length.div_ceil(SUMMED);
        let [groups, sums, add] = &k.scan;
        dispatch(pass, groups, &self.bindings, blocks);
        dispatch(pass, sums, &self.bindings, 1);
        dispatch(pass, add, &self.bindings, blocks);
    }
}
