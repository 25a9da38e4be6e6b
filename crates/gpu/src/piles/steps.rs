//! Steps of worlds, submitted several at a time.

use super::joints::Joints;
use super::kernels::Kernels;
use super::pile::Pile;
use super::plan::{BLOCK, COLOURS, KEYS, Plan, SUM_ROUNDS, flag, run, status};
use super::room::{Room, Scan};
use super::scene::Scene;
use crate::clock::{Clock, Pass};
use crate::memory::{NUMBER, Staging, buffer};
use crate::pipeline::{WORKGROUP, dispatch};
use crate::{Gpu, GpuError};
use rigid::impulse::blow::ROUNDS as BLOWS;
use wgpu::{BindGroup, Buffer, ComputePipeline};

/// What steps have room for, and how they are submitted.
#[derive(Debug)]
pub(super) struct Steps {
    plan: Plan,
    room: Room,
    /// Into how many parts steps are cut that the room is ready for.
    parts: usize,
    /// The state of a world before a step that is cut into parts.
    before: Option<Buffer>,
    staging: Staging,
    /// While stages are timed.
    pub clock: Option<Clock>,
}

/// Pairs of each shape and contacts of each body that there is room for at first.
const PAIRS: u32 = 8;
const CONTACTS: u32 = 4;
/// Colours that there is room for, and that are launched, at first.
const FIRST_COLOURS: u32 = 16;
/// Rounds of colouring in a step: at least, and at most.
const FEWEST_ROUNDS: usize = 8;
const MOST_ROUNDS: usize = 256;
/// Most steps in one submission, and about as many launches.
const STEPS: usize = 16;
const LAUNCHES: usize = 16_384;

/// How steps of a world are submitted.
#[derive(Debug)]
pub(super) struct Pace {
    /// Steps in a submission: fewer where they are often not taken.
    steps: usize,
    /// Colours of contacts that are launched.
    colours: u32,
    /// Rounds of colouring in a step.
    rounds: usize,
    /// Whether these, or colours, were too few, so that colouring goes on where it ended.
    goes_on: bool,
    /// Rounds of blows in a small step.
    blows: usize,
    /// Parts of a step.
    parts: usize,
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            steps: 1,
            colours: FIRST_COLOURS,
            rounds: FEWEST_ROUNDS,
            goes_on: false,
            blows: 0,
            parts: 1,
        }
    }
}

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

impl Steps {
    pub fn new(gpu: &Gpu, scene: &Scene, kernels: &Kernels) -> Result<Self, GpuError> {
        let mut plan = scene.plan;
        plan.pairs = (PAIRS * plan.shapes + BLOCK).min(scene.most_pairs(gpu, false));
        let near = scene.groups.iter().flat_map(|group| group.triangles);
        plan.most_near = near.max().unwrap_or(0) as u32;
        if plan.most_near > 0 {
            plan.mesh_pairs = BLOCK.min(scene.most_pairs(gpu, true));
        }
        plan.contacts = CONTACTS * plan.bodies + BLOCK;
        plan.colours = FIRST_COLOURS;
        Ok(Self {
            room: Room::new(gpu, scene, kernels, &mut plan)?,
            plan,
            parts: 0,
            before: None,
            staging: Staging::default(),
            clock: None,
        })
    }

    /// Takes at most so many steps of a world.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        pile: &mut Pile,
        steps: usize,
    ) -> Result<Progress, GpuError> {
        let small_steps = scene.impulse.settings().contact_iterations;
        let joints = scene.joints.as_ref().map_or(0, |joints| joints.runs.len());
        let stage = pile.pace.colours as usize + joints + 1;
        let launches = small_steps * (2 + pile.pace.blows) * stage;
        let most = pile.pace.steps.min(LAUNCHES / launches).max(1);
        // What is cut into parts is taken one by one, that it can be undone.
        let most = if pile.pace.parts > 1 { 1 } else { most };
        let steps = steps.min(most);
        let told = self.submit(gpu, scene, kernels, pile, steps)?;
        let (flags, taken) = (told[status::FLAG], told[status::STEPS] as usize);
        let pace = &mut pile.pace;
        let more = if taken == steps { 2 * pace.steps } else { 1 };
        pace.steps = more.min(STEPS);
        let uncoloured = flag::MORE_ROUNDS | flag::MORE_COLOURS;
        pace.goes_on = flags & uncoloured != 0 && pace.parts == 1;
        if flags & flag::OTHER_PARTS != 0 {
            pace.parts = told[status::NEEDED] as usize;
            return Ok(Progress::Taken(taken));
        }
        if flags & flag::DEAD != 0 {
            return Ok(Progress::Dead);
        }
        let coloured = told[status::COLOURED];
        pace.colours = pace.colours.max(coloured);
        // What a step without enough of anything has told besides is of no worth: so this is asked first, and whether the
        // processor has to take the step last.
        if flags & flag::MORE_ROOM == flag::MORE_COLOURS && coloured <= self.plan.colours {
            return Ok(Progress::Taken(taken));
        }
        if flags & flag::MORE_ROOM != 0 {
            // There, colours of the attempt are not known.
            pace.goes_on = false;
            return Ok(match self.grow(gpu, scene, kernels, &told) {
                true => Progress::Taken(taken),
                false => Progress::Processor(taken),
            });
        }
        if flags & flag::MORE_ROUNDS != 0 {
            // Where it cannot go on from where it ended, more rounds than there are would not settle it.
            if pace.rounds == MOST_ROUNDS && !pace.goes_on {
                return Ok(Progress::Processor(taken));
            }
            pace.rounds = MOST_ROUNDS.min(2 * pace.rounds);
            return Ok(Progress::Taken(taken));
        }
        if flags & flag::MORE_BLOWS != 0 {
            pace.blows = BLOWS.min((2 * pace.blows).max(2));
            return Ok(Progress::Taken(taken));
        }
        // Soon no more than there are, but not so soon that it would be too few every other time.
        pace.colours = coloured + (pace.colours - coloured) / 2;
        // One more, in which nothing is struck; none where none was foreseen.
        let foreseen = told[status::FORESEEN] != 0;
        let struck = told[status::MOST_BLOWS] as usize;
        pace.blows = BLOWS.min(struck + usize::from(foreseen));
        // In most steps colours are those of the step before.
        let usual = 2 * told[status::ROUNDS] as usize;
        pace.rounds = usual.clamp(FEWEST_ROUNDS, MOST_ROUNDS);
        if flags & flag::PROCESSOR != 0 {
            return Ok(Progress::Processor(taken));
        }
        if taken == 0 {
            return Err(gpu.failed("it took no step and gave no reason"));
        }
        Ok(Progress::Taken(taken))
    }

    /// The status after so many steps.
    fn submit(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        pile: &Pile,
        steps: usize,
    ) -> Result<[u32; status::WIDTH], GpuError> {
        let parts = pile.pace.parts;
        if self.parts != parts {
            self.room.cut(gpu, scene, &self.plan, parts);
            self.parts = parts;
        }
        let own = self.room.of(gpu, kernels, pile);
        let status = &self.room.buffers.status;
        let mut begin = [0_u32; status::WIDTH];
        begin[status::KEEP] = pile.pace.goes_on.into();
        begin[status::LAUNCHED] = pile.pace.colours;
        begin[status::ROUNDS_OF_BLOWS] = pile.pace.blows as u32;
        begin[status::PARTS] = parts as u32;
        let bytes = bytemuck::cast_slice(&begin);
        gpu.queue().write_buffer(status, 0, bytes);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        if parts > 1 {
            let before = self.before.take();
            let before = before.map_or_else(|| buffer(gpu, scene.plan.forces.into()), Ok)?;
            let size = before.size();
            encoder.copy_buffer_to_buffer(&pile.state, 0, &before, 0, size);
            self.before = Some(before);
        }
        for _ in 0..steps {
            for part in 0..parts {
                let mut clock = self.clock.take();
                let mut pass = Pass::new(&mut encoder, clock.as_mut());
                self.encode(&mut pass, kernels, scene, &own, pile, part);
                drop(pass);
                self.clock = clock;
            }
        }
        let mut told = [0; status::WIDTH];
        let staging = &mut self.staging;
        staging.fetch(gpu, encoder, status, 0..status::WIDTH, |numbers| {
            told = std::array::from_fn(|i| numbers[i].to_bits());
        })?;
        if let Some(clock) = &mut self.clock {
            clock.read(gpu)?;
        }
        if let (true, Some(before)) = (told[status::FLAG] != 0 && parts > 1, &self.before) {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(before, 0, &pile.state, 0, before.size());
            gpu.queue().submit([encoder.finish()]);
        }
        Ok(told)
    }

    /// Makes room for what a step has found too little for, and some more, or none more; false where the card has not
    /// even that.
    fn grow(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        told: &[u32; status::WIDTH],
    ) -> bool {
        let flags = told[status::FLAG];
        let rooms = [1, 0].map(|more| {
            let enough = |n: u32| n + more * (n / 4);
            let mut plan = self.plan;
            if flags & flag::MORE_PAIRS != 0 {
                plan.pairs = enough(told[status::PAIRS]);
            } else if flags & flag::MORE_MESH_PAIRS != 0 {
                plan.mesh_pairs = enough(told[status::MESH_PAIRS]);
            } else if flags & flag::MORE_CONTACTS != 0 {
                plan.contacts = enough(told[status::CONTACTS] + told[status::ENDED]);
            } else {
                plan.colours = enough(told[status::COLOURED]).min(COLOURS);
            }
            plan
        });
        for mut plan in rooms {
            if let Ok(room) = Room::new(gpu, scene, kernels, &mut plan) {
                (self.plan, self.room, self.parts) = (plan, room, 0);
                return true;
            }
        }
        false
    }

    /// A step, or a part of one.
    fn encode(
        &self,
        pass: &mut Pass<'_>,
        k: &Kernels,
        scene: &Scene,
        own: &BindGroup,
        pile: &Pile,
        part: usize,
    ) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let all = |pass: &mut Pass<'_>, kernel: &ComputePipeline, things: u32| {
            dispatch(pass, kernel, own, things.div_ceil(WORKGROUP));
        };
        all(pass, &e.clear, p.buckets.max(p.bodies) + 1);
        all(pass, &e.load_bodies, p.bodies);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        if pile.pushed {
            dispatch(pass, &k.push_body, &s.bodies, bodies);
        }
        dispatch(pass, &k.begin, &s.bodies, bodies);
        // One at least: it chooses into how many parts the step is cut.
        all(pass, &e.load_shapes, p.shapes.max(1));
        dispatch(pass, &k.place, &s.shapes, p.shapes.div_ceil(WORKGROUP));
        pass.mark("bodies and shapes");
        let [
            buckets,
            units,
            groups,
            touching,
            joined,
            colours,
            pressing,
            ended,
        ] = &s.scans;
        all(pass, &e.surround, p.shapes);
        all(pass, &e.count_buckets, p.shapes);
        buckets.run(pass, k);
        all(pass, &e.fill_buckets, p.shapes);
        all(pass, &e.count_pairs, p.units + 1);
        units.run(pass, k);
        all(pass, &e.list_pairs, p.units + 1);
        pass.mark("broad phase");
        dispatch(pass, &k.sort[0], &s.sort_pairs, p.pair_blocks);
        groups.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_pairs, p.pair_blocks);
        all(pass, &e.plan_groups, p.groups);
        all(pass, &e.seat_pairs, p.pairs);
        if p.mesh_pairs > 0 {
            all(pass, &e.seat_meshes, p.mesh_pairs);
        }
        pass.mark("sorting pairs");
        for (group, (kernel, bindings)) in (0..).zip(k.apart.iter().zip(&s.groups)) {
            if let Some(kernel) = kernel {
                self.run(pass, kernel, bindings, group);
            }
        }
        all(pass, &e.part_pairs, p.pairs);
        pass.mark("pairs apart");
        for (group, (kernel, bindings)) in (0..).zip(k.groups.iter().zip(&s.groups)) {
            self.run(pass, kernel, bindings, group);
        }
        pass.mark("narrow phase");
        all(pass, &e.find_touching, p.pairs + 1);
        touching.run(pass, k);
        all(pass, &e.make_contacts, p.pairs + 1);
        joined.run(pass, k);
        all(pass, &e.join, p.contacts);
        pass.mark("making contacts");
        for _ in 0..pile.pace.rounds {
            all(pass, &e.paint, p.contacts);
            all(pass, &e.settle, 1);
        }
        pass.mark("colouring");
        dispatch(pass, &k.sort[0], &s.sort_contacts, p.contact_blocks);
        colours.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_contacts, p.contact_blocks);
        all(pass, &e.plan_colours, KEYS);
        all(pass, &e.seat_contacts, p.contacts);
        pass.mark("sorting contacts");
        self.run(pass, &k.prepare, &s.contacts, run::CONTACTS);
        pass.mark("preparing contacts");
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        if let Some((joints, kernels)) = joints {
            all(pass, &e.load_joints, p.joints);
            if joints.drives {
                self.all_joints(pass, &kernels.follow, joints);
            }
            self.all_joints(pass, &kernels.place, joints);
        }
        pass.mark("preparing joints");
        self.small_steps(pass, k, scene, own, &pile.pace);
        dispatch(pass, &k.finish, &s.bodies, bodies);
        all(pass, &e.read_contacts, p.contacts);
        if part > 0 {
            self.sums(pass, k, own, ended);
        }
        all(pass, &e.find_pressing, p.contacts + 1);
        pressing.run(pass, k);
        all(pass, &e.check_bodies, p.bodies);
        all(pass, &e.check_shapes, p.shapes);
        all(pass, &e.store_bodies, p.bodies);
        all(pass, &e.store_contacts, p.contacts);
        if joints.is_some() {
            all(pass, &e.store_joints, p.joints);
        }
        all(pass, &e.end, 1);
        pass.mark("end");
    }

    fn small_steps(
        &self,
        pass: &mut Pass<'_>,
        k: &Kernels,
        scene: &Scene,
        own: &BindGroup,
        pace: &Pace,
    ) {
        let (p, s) = (&self.plan, &self.room);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        let contacts = |pass: &mut Pass<'_>, kernel: &ComputePipeline| {
            for (colour, bindings) in (0..pace.colours).zip(&s.colours) {
                self.run(pass, kernel, bindings, run::COLOURS + colour);
            }
        };
        for step in 0..scene.impulse.settings().contact_iterations / pace.parts {
            if let Some((joints, kernels)) = joints.filter(|(joints, _)| joints.inertia) {
                self.all_joints(pass, &kernels.measure, joints);
            }
            if step == 0 {
                dispatch(pass, &k.advance, &s.bodies, bodies);
                if scene.bounces {
                    self.run(pass, &k.foresee, &s.contacts, run::CONTACTS);
                    let all = p.contacts.div_ceil(WORKGROUP);
                    dispatch(pass, &k.entries.foresee_blows, own, all);
                }
                contacts(pass, &k.warm_start);
                if let Some((joints, kernels)) = joints {
                    self.joints(pass, &kernels.warm_start, joints);
                }
            } else {
                dispatch(pass, &k.advance_again, &s.bodies, bodies);
            }
            pass.mark("advancing, warm start");
            if pace.blows > 0 {
                self.blows(pass, k, own, pace);
            }
            pass.mark("blows");
            contacts(pass, &k.push);
            if let Some((joints, kernels)) = joints {
                self.joints(pass, &kernels.push, joints);
            }
            pass.mark("pushing");
            dispatch(pass, &k.drift, &s.bodies, bodies);
            if let Some((joints, kernels)) = joints {
                self.all_joints(pass, &kernels.place, joints);
            }
            pass.mark("drift");
            contacts(pass, &k.relax);
            if let Some((joints, kernels)) = joints {
                self.joints(pass, &kernels.relax, joints);
            }
            pass.mark("relaxing");
        }
    }

    /// What contacts gave in the parts before.
    fn sums(&self, pass: &mut Pass<'_>, k: &Kernels, own: &BindGroup, ended: &Scan) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let all = |pass: &mut Pass<'_>, kernel: &ComputePipeline, things: u32| {
            dispatch(pass, kernel, own, things.div_ceil(WORKGROUP));
        };
        all(pass, &e.find_ended, p.remembered + 1);
        ended.run(pass, k);
        for _ in 0..SUM_ROUNDS {
            all(pass, &e.match_parts, p.contacts);
            all(pass, &e.seat_parts, p.contacts);
            self.run(pass, &k.add_part, &s.sums, run::SUMS);
            all(pass, &e.read_parts, p.contacts);
        }
        all(pass, &e.match_parts, p.contacts);
        all(pass, &e.place_ended, p.remembered.max(1));
        all(pass, &e.merge, p.contacts);
    }

    /// The blows of a small step.
    fn blows(&self, pass: &mut Pass<'_>, k: &Kernels, own: &BindGroup, pace: &Pace) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let contacts = p.contacts.max(COLOURS).div_ceil(WORKGROUP);
        dispatch(pass, &e.begin_blows, own, contacts);
        self.run(pass, &k.part, &s.bodies, run::BLOW_BODIES);
        for round in 0..pace.blows {
            let strike = [&k.strike_foreseen, &k.strike][round.min(1)];
            for (colour, bindings) in (0..pace.colours).zip(&s.colours) {
                self.run(pass, strike, bindings, run::BLOW_COLOURS + colour);
            }
            dispatch(pass, &e.tell_blows, own, contacts);
            dispatch(pass, &e.end_round, own, 1);
            if let Some(kernels) = &k.joints {
                for (joints, bindings) in (0..p.joint_runs).zip(&s.joints) {
                    self.run(pass, &kernels.strike, bindings, run::JOINTS + joints);
                }
            }
        }
        self.run(pass, &k.part, &s.bodies, run::BLOW_BODIES);
    }

    /// Runs a kernel on all joints side by side.
    fn all_joints(&self, pass: &mut Pass<'_>, kernel: &ComputePipeline, joints: &Joints) {
        if let (Some(bindings), Some([_, count])) = (self.room.joints.last(), joints.runs.last()) {
            dispatch(pass, kernel, bindings, count.div_ceil(WORKGROUP));
        }
    }

    /// Runs a kernel on all joints, run by run.
    fn joints(&self, pass: &mut Pass<'_>, kernel: &ComputePipeline, joints: &Joints) {
        let all = self.room.joints.len().saturating_sub(1);
        for (bindings, [_, count]) in self.room.joints[..all].iter().zip(&joints.runs) {
            dispatch(pass, kernel, bindings, count.div_ceil(WORKGROUP));
        }
    }

    /// Runs a kernel on the members of a run.
    fn run(&self, pass: &mut Pass<'_>, kernel: &ComputePipeline, bindings: &BindGroup, run: u32) {
        pass.set_pipeline(kernel);
        pass.set_bind_group(0, bindings, &[]);
        let launches = &self.room.buffers.launches;
        pass.dispatch_workgroups_indirect(launches, u64::from(3 * run) * NUMBER);
    }
}
