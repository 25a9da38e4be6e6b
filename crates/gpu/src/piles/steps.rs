//! Steps of batches of worlds, submitted several at a time.

use super::batch::Batch;
use super::joints::Joints;
use super::kernels::Kernels;
use super::plan::{BLOCK, COLOURS, KEYS, Plan, SUM_ROUNDS, flag, of_world, run, status, stopped};
use super::room::{Own, Room, Scan, told};
use super::scene::Scene;
use crate::clock::{Clock, Pass};
use crate::memory::{NUMBER, Staging, buffer};
use crate::pipeline::{WORKGROUP, dispatch};
use crate::{Gpu, GpuError};
use rigid::impulse::ContactTables;
use rigid::impulse::blow::ROUNDS as BLOWS;
use std::iter::once;
use wgpu::{BindGroup, Buffer, ComputePipeline};

/// What steps have room for, and how they are submitted.
#[derive(Debug)]
pub(super) struct Steps {
    plan: Plan,
    room: Room,
    /// Into how many parts steps are cut that the room is ready for.
    cut: usize,
    /// The states of a batch before a step that is cut into parts.
    before: Option<Buffer>,
    staging: Staging,
    /// While stages are timed.
    pub clock: Option<Clock>,
}

/// Pairs of each shape and contacts of each body that there is room for at first.
pub(super) const PAIRS: u32 = 8;
pub(super) const CONTACTS: u32 = 4;
/// Colours that there is room for, and that are launched, at first.
const FIRST_COLOURS: u32 = 16;
/// Rounds of colouring in a step: at least, and at most.
const FEWEST_ROUNDS: usize = 8;
const MOST_ROUNDS: usize = 256;
/// Most steps in one submission, and about as many launches.
const STEPS: usize = 16;
/// Steps after which more worlds are tried at once.
const FITTED: usize = 256;
/// Most worlds whose steps are cut into parts in one submission: each is copied, so that it can be undone.
const CUT: usize = 256;
/// Of what a submission told: colouring goes on where it ended.
const UNCOLOURED: u32 = flag::MORE_ROUNDS | flag::MORE_COLOURS;
const LAUNCHES: usize = 16_384;

/// How steps of a batch are submitted.
#[derive(Debug)]
pub(super) struct Pace {
    /// Steps in a submission: fewer where they are often not taken.
    steps: usize,
    /// Worlds in a submission: fewer where there was no room for all of them; and for how many steps there was.
    worlds: usize,
    fitted: usize,
    /// Colours of contacts that are launched.
    colours: Held,
    /// Rounds of colouring in a step.
    rounds: usize,
    /// Worlds for which these, or colours, were too few, so that colouring goes on where it ended.
    uncoloured: Vec<usize>,
    /// Rounds of blows in a small step.
    blows: Held,
}

/// How many of something are launched: as many as were needed in any of the last steps.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    count: usize,
    /// Steps in which fewer were needed, without a break.
    fewer: usize,
}

/// Steps after which fewer are launched.
const HELD: usize = 16;

impl Held {
    fn at_least(&mut self, needed: usize) {
        if needed >= self.count {
            *self = Self {
                count: needed,
                fewer: 0,
            };
        }
    }
    /// So many were needed in so many steps.
    fn needed(&mut self, needed: usize, steps: usize) {
        self.at_least(needed);
        self.fewer += steps;
        if needed < self.count && self.fewer >= HELD {
            *self = Self {
                count: needed + (self.count - needed) / 2,
                fewer: 0,
            };
        }
    }
}

impl Pace {
    /// Of so many worlds.
    pub fn new(worlds: usize) -> Self {
        Self {
            steps: 1,
            worlds,
            fitted: 0,
            colours: Held {
                count: FIRST_COLOURS as usize,
                fewer: 0,
            },
            rounds: FEWEST_ROUNDS,
            uncoloured: Vec::new(),
            blows: Held::default(),
        }
    }
    /// From what so many steps have taken.
    fn learn(&mut self, told: &Told, taken: usize) {
        self.colours
            .needed(told.of(status::COLOURED) as usize, taken);
        // One more, in which nothing is struck; none where none was foreseen.
        let foreseen = told.of(status::FORESEEN) != 0;
        let struck = told.of(status::MOST_BLOWS) as usize;
        let rounds = BLOWS.min(struck + usize::from(foreseen));
        self.blows.needed(rounds, taken);
        // In most steps colours are those of the step before.
        let usual = 2 * told.of(status::ROUNDS) as usize;
        self.rounds = usual.clamp(FEWEST_ROUNDS, MOST_ROUNDS);
        // What found no room may have found it but once.
        self.fitted += taken;
        if self.fitted >= FITTED {
            self.worlds = self.worlds.saturating_mul(2);
            self.fitted = 0;
        }
    }
}

/// Steps that are submitted together.
#[derive(Debug)]
struct Turn {
    /// Worlds of the batch, counted from its first.
    worlds: Vec<usize>,
    steps: usize,
    /// Into how many parts each step is cut.
    parts: usize,
}

/// What the card has told of a submission.
struct Told(Vec<u32>);

impl Told {
    fn of(&self, place: usize) -> u32 {
        self.0[place]
    }
    fn of_world(&self, world: usize, place: usize) -> u32 {
        self.0[status::WIDTH + world * of_world::WIDTH + place]
    }
}

impl Steps {
    pub fn new(gpu: &Gpu, scene: &Scene, kernels: &Kernels) -> Result<Self, GpuError> {
        let mut plan = scene.plan;
        let near = scene.groups.iter().flat_map(|group| group.triangles);
        plan.most_near = near.max().unwrap_or(0) as u32;
        if plan.most_near > 0 {
            plan.mesh_pairs = BLOCK.min(scene.most_pairs(gpu, true));
        }
        plan.colours = FIRST_COLOURS;
        let mut pairs = PAIRS * plan.shapes + BLOCK;
        let mut contacts = CONTACTS * plan.bodies + BLOCK;
        let room = loop {
            plan.pairs = pairs.min(scene.most_pairs(gpu, false));
            plan.contacts = contacts.min(most_contacts(gpu));
            match Room::new(gpu, scene, kernels, &mut plan) {
                Ok(room) => break room,
                // Fewer worlds at a time may do with less.
                Err(_) if pairs.max(contacts) > BLOCK => {
                    (pairs, contacts) = (pairs / 2, contacts / 2)
                }
                Err(error) => return Err(error),
            }
        };
        Ok(Self {
            room,
            plan,
            cut: 0,
            before: None,
            staging: Staging::default(),
            clock: None,
        })
    }

    /// After a scene has other constants.
    pub fn renew(&mut self, gpu: &Gpu, scene: &Scene) {
        self.plan = self.plan.with_constants_of(&scene.plan);
        self.room.renew(gpu, scene, &self.plan);
    }

    /// Takes some of the steps that worlds of a batch have yet to take. Returns those, counted from its first, of which the
    /// next step is the processor's.
    pub fn take(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        batch: &mut Batch,
    ) -> Result<Vec<usize>, GpuError> {
        let turn = turn(scene, batch);
        let told = self.submit(gpu, scene, kernels, batch, &turn)?;
        let flags = told.of(status::FLAG);
        let mut taken = 0;
        let mut left_to_processor = Vec::new();
        let mut stops = 0;
        for &world in &turn.worlds {
            let asked = batch.left[world].min(turn.steps);
            let steps = asked - told.of_world(world, of_world::LEFT) as usize;
            batch.left[world] -= steps;
            taken = steps.max(taken);
            let why = told.of_world(world, of_world::STOPPED);
            stops |= why & !stopped::DONE;
            if why & stopped::OTHER_PARTS != 0 {
                batch.parts[world] = told.of_world(world, of_world::NEEDED) as usize;
            }
            if why & stopped::PROCESSOR != 0 {
                left_to_processor.push(world);
            }
        }
        let pace = &mut batch.pace;
        if turn.parts == 1 {
            pace.steps = match flags == 0 && left_to_processor.is_empty() {
                true => STEPS.min(2 * pace.steps),
                false => taken.max(1),
            };
        }
        pace.uncoloured.clear();
        if flags & UNCOLOURED != 0 && turn.parts == 1 && stops == 0 {
            let left = turn.worlds.iter().filter(|world| batch.left[**world] > 0);
            pace.uncoloured.extend(left);
        }
        if flags == 0 && stops == 0 && taken == 0 {
            return Err(gpu.failed("it took no step and gave no reason"));
        }
        if flags != 0 {
            // What a step without enough of anything has told besides is of no worth; but that is told before colours.
            if flags & !UNCOLOURED != 0 {
                left_to_processor.clear();
            }
            if !self.adapt(gpu, scene, kernels, batch, (&turn, stops), &told) {
                let behind = turn.worlds.into_iter();
                return Ok(behind.filter(|world| batch.left[*world] > 0).collect());
            }
            return Ok(left_to_processor);
        }
        if taken > 0 {
            batch.pace.learn(&told, taken);
        }
        Ok(left_to_processor)
    }

    /// Makes room for what a step has found too little for, has more of it launched, or has fewer worlds stepped at once;
    /// false where only the processor can take the step.
    fn adapt(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        batch: &mut Batch,
        (turn, stops): (&Turn, u32),
        told: &Told,
    ) -> bool {
        let flags = told.of(status::FLAG);
        let pace = &mut batch.pace;
        let coloured = told.of(status::COLOURED);
        pace.colours.at_least(coloured as usize);
        if flags & flag::MORE_ROOM == flag::MORE_COLOURS && coloured <= self.plan.colours {
            return true;
        }
        if flags & flag::MORE_ROOM != 0 {
            // There, colours of the attempt are not known.
            pace.uncoloured.clear();
            if self.grow(gpu, scene, kernels, told) {
                return true;
            }
            let fewer = turn.worlds.len() / 2;
            if fewer > 0 {
                (pace.worlds, pace.fitted) = (fewer, 0);
            }
            return fewer > 0;
        }
        if flags & flag::MORE_ROUNDS != 0 {
            // Where it cannot go on from where it ended, more rounds than there are would not settle it.
            let goes_on = !pace.uncoloured.is_empty() || stops != 0;
            if pace.rounds == MOST_ROUNDS && !goes_on {
                return false;
            }
            pace.rounds = MOST_ROUNDS.min(2 * pace.rounds);
            return true;
        }
        let more = (2 * pace.blows.count).max(2);
        pace.blows.at_least(BLOWS.min(more));
        true
    }

    /// What is told after the steps of a turn.
    fn submit(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        kernels: &Kernels,
        batch: &mut Batch,
        turn: &Turn,
    ) -> Result<Told, GpuError> {
        let parts = turn.parts;
        batch.ready(gpu, scene, parts)?;
        if self.cut != parts {
            self.room.cut(gpu, scene, parts);
            self.cut = parts;
        }
        let own = self.room.of(gpu, kernels, batch);
        let status = &self.room.buffers.status;
        let begin = begin(&self.plan, batch, turn);
        gpu.queue()
            .write_buffer(status, 0, bytemuck::cast_slice(&begin));
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let length = scene.impulse.lengths().state;
        let all = turn.worlds.len() * length;
        let place = |nth: usize, world: usize| {
            let states = [nth, world].map(|i| (i * length) as u64 * NUMBER);
            (states, length as u64 * NUMBER)
        };
        if parts > 1 {
            let before = self.before.take();
            let before = before.filter(|b| b.size() >= all as u64 * NUMBER);
            let before = before.map_or_else(|| buffer(gpu, all as u64), Ok)?;
            for (nth, world) in turn.worlds.iter().enumerate() {
                let ([kept, own], size) = place(nth, *world);
                encoder.copy_buffer_to_buffer(&batch.state, own, &before, kept, size);
            }
            self.before = Some(before);
        }
        for _ in 0..turn.steps {
            for part in 0..parts {
                let mut clock = self.clock.take();
                let mut pass = Pass::new(&mut encoder, clock.as_mut());
                self.encode(&mut pass, kernels, scene, &own, batch, (parts, part));
                drop(pass);
                self.clock = clock;
            }
        }
        let mut told = Told(Vec::new());
        let words = once(0..begin.len());
        self.staging.fetch(gpu, encoder, status, words, |words| {
            told.0 = words.iter().map(|word| word.to_bits()).collect();
        })?;
        if let Some(clock) = &mut self.clock {
            clock.read(gpu)?;
        }
        if let (true, Some(before)) = (parts > 1, &self.before) {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            for (nth, world) in turn.worlds.iter().enumerate() {
                if told.of_world(*world, of_world::LEFT) > 0 {
                    let ([kept, own], size) = place(nth, *world);
                    encoder.copy_buffer_to_buffer(before, kept, &batch.state, own, size);
                }
            }
            gpu.queue().submit([encoder.finish()]);
        }
        Ok(told)
    }

    /// Makes room for what a step has found too little for, and some more, or none more; false where the card has not
    /// even that.
    fn grow(&mut self, gpu: &Gpu, scene: &Scene, kernels: &Kernels, told: &Told) -> bool {
        let flags = told.of(status::FLAG);
        let rooms = [1, 0].map(|more| {
            let enough = |n: u32| n + more * (n / 4);
            let mut plan = self.plan;
            if flags & flag::MORE_PAIRS != 0 {
                plan.pairs = enough(told.of(status::PAIRS));
            } else if flags & flag::MORE_MESH_PAIRS != 0 {
                plan.mesh_pairs = enough(told.of(status::MESH_PAIRS));
            } else if flags & flag::MORE_CONTACTS != 0 {
                plan.contacts = enough(told.of(status::CONTACTS) + told.of(status::ENDED));
            } else {
                plan.colours = enough(told.of(status::COLOURED)).min(COLOURS);
            }
            plan
        });
        for mut plan in rooms {
            if let Ok(room) = Room::new(gpu, scene, kernels, &mut plan) {
                (self.plan, self.room, self.cut) = (plan, room, 0);
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
        own: &Own,
        batch: &Batch,
        (parts, part): (usize, usize),
    ) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let all = |pass: &mut Pass<'_>, kernel: &ComputePipeline, things: u32| {
            dispatch(pass, kernel, &own.all, things.div_ceil(WORKGROUP));
        };
        all(pass, &e.clear, p.buckets.max(p.bodies).max(p.worlds) + 1);
        all(pass, &e.load_bodies, p.bodies);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        if batch.pushed {
            dispatch(pass, &k.push_body, &own.bodies, bodies);
        }
        dispatch(pass, &k.begin, &own.bodies, bodies);
        // For each world, too, it chooses into how many parts the step is cut.
        all(pass, &e.load_shapes, p.shapes.max(p.worlds));
        dispatch(pass, &k.place, &own.shapes, p.shapes.div_ceil(WORKGROUP));
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
        for _ in 0..batch.pace.rounds {
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
                self.all_joints(pass, &kernels.follow);
            }
            self.all_joints(pass, &kernels.place);
        }
        pass.mark("preparing joints");
        self.small_steps(pass, k, scene, own, &batch.pace, parts);
        dispatch(pass, &k.finish, &own.bodies, bodies);
        all(pass, &e.read_contacts, p.contacts);
        if part > 0 {
            self.sums(pass, k, &own.all, ended);
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
        all(pass, &e.end, p.worlds);
        pass.mark("end");
    }

    fn small_steps(
        &self,
        pass: &mut Pass<'_>,
        k: &Kernels,
        scene: &Scene,
        own: &Own,
        pace: &Pace,
        parts: usize,
    ) {
        let (p, s) = (&self.plan, &self.room);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        let contacts = |pass: &mut Pass<'_>, kernel: &ComputePipeline| {
            for (colour, bindings) in (0..pace.colours.count as u32).zip(&s.colours) {
                self.run(pass, kernel, bindings, run::COLOURS + colour);
            }
        };
        for step in 0..scene.impulse.settings().contact_iterations / parts {
            if let Some((_, kernels)) = joints.filter(|(joints, _)| joints.inertia) {
                self.all_joints(pass, &kernels.measure);
            }
            if step == 0 {
                dispatch(pass, &k.advance, &own.bodies, bodies);
                if scene.bounces {
                    self.run(pass, &k.foresee, &s.contacts, run::CONTACTS);
                    let all = p.contacts.div_ceil(WORKGROUP);
                    dispatch(pass, &k.entries.foresee_blows, &own.all, all);
                }
                contacts(pass, &k.warm_start);
                if let Some((joints, kernels)) = joints {
                    self.joints(pass, &kernels.warm_start, joints);
                }
            } else {
                dispatch(pass, &k.advance_again, &own.bodies, bodies);
            }
            pass.mark("advancing, warm start");
            if pace.blows.count > 0 {
                self.blows(pass, k, own, pace);
            }
            pass.mark("blows");
            contacts(pass, &k.push);
            if let Some((joints, kernels)) = joints {
                self.joints(pass, &kernels.push, joints);
            }
            pass.mark("pushing");
            dispatch(pass, &k.drift, &own.bodies, bodies);
            if let Some((_, kernels)) = joints {
                self.all_joints(pass, &kernels.place);
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
        all(pass, &e.find_ended, p.places() + 1);
        ended.run(pass, k);
        for _ in 0..SUM_ROUNDS {
            all(pass, &e.match_parts, p.contacts);
            all(pass, &e.seat_parts, p.contacts);
            self.run(pass, &k.add_part, &s.sums, run::SUMS);
            all(pass, &e.read_parts, p.contacts);
        }
        all(pass, &e.match_parts, p.contacts);
        all(pass, &e.place_ended, p.places().max(1));
        all(pass, &e.merge, p.contacts);
    }

    /// The blows of a small step.
    fn blows(&self, pass: &mut Pass<'_>, k: &Kernels, own: &Own, pace: &Pace) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let all = |pass: &mut Pass<'_>, kernel: &ComputePipeline, things: u32| {
            dispatch(pass, kernel, &own.all, things.div_ceil(WORKGROUP));
        };
        let several = p.worlds > 1;
        all(pass, &e.begin_blows, p.contacts.max(COLOURS).max(p.worlds));
        if several {
            all(pass, &e.keep_free, p.bodies);
        }
        self.run(pass, &k.part, &own.bodies, run::BLOW_BODIES);
        for round in 0..pace.blows.count {
            let strike = [&k.strike_foreseen, &k.strike][round.min(1)];
            for (colour, bindings) in (0..pace.colours.count as u32).zip(&s.colours) {
                self.run(pass, strike, bindings, run::BLOW_COLOURS + colour);
            }
            all(pass, &e.tell_blows, p.contacts);
            all(pass, &e.part_struck, p.contacts.max(p.joints));
            all(pass, &e.end_round, 1);
            if let Some(kernels) = &k.joints {
                for (joints, bindings) in (0..p.joint_runs).zip(&s.joints[1]) {
                    self.run(pass, &kernels.strike, bindings, run::JOINTS + joints);
                }
            }
        }
        self.run(pass, &k.part, &own.bodies, run::BLOW_BODIES);
        if several {
            all(pass, &e.put_free, p.bodies);
        }
    }

    /// Runs a kernel on all joints side by side.
    fn all_joints(&self, pass: &mut Pass<'_>, kernel: &ComputePipeline) {
        if let Some(bindings) = self.room.joints[0].last() {
            dispatch(pass, kernel, bindings, self.plan.joints.div_ceil(WORKGROUP));
        }
    }

    /// Runs a kernel on all joints, run by run.
    fn joints(&self, pass: &mut Pass<'_>, kernel: &ComputePipeline, joints: &Joints) {
        let runs = self.plan.joint_runs as usize;
        for (bindings, [_, count]) in self.room.joints[0].iter().zip(&joints.runs).take(runs) {
            let count = self.plan.worlds * count;
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

/// Which steps of a batch come next: of worlds whose steps are cut into as many parts as that of the one farthest behind.
fn turn(scene: &Scene, batch: &Batch) -> Turn {
    let pace = &batch.pace;
    let all = 0..batch.left.len();
    let last = all.clone().max_by_key(|world| batch.left[*world]);
    let parts = last.map_or(1, |world| batch.parts[world]);
    let waits = |world: &usize| batch.left[*world] > 0 && batch.parts[*world] == parts;
    // What is cut into parts is taken one by one, that it can be undone.
    let (most_worlds, most_steps) = match parts {
        1 => (pace.worlds, pace.steps),
        _ => (pace.worlds.min(CUT), 1),
    };
    let worlds: Vec<_> = all.filter(waits).take(most_worlds).collect();
    let small_steps = scene.impulse.settings().contact_iterations;
    let joints = scene.joints.as_ref().map_or(0, |joints| joints.runs.len());
    let stage = pace.colours.count + joints + 1;
    let launches = small_steps * (2 + pace.blows.count) * stage;
    let most = most_steps.min(LAUNCHES / launches).max(1);
    let left = worlds.iter().map(|world| batch.left[*world]);
    Turn {
        steps: left.max().unwrap_or(0).min(most),
        worlds,
        parts,
    }
}

/// What the card is told as a turn begins.
fn begin(plan: &Plan, batch: &Batch, turn: &Turn) -> Vec<u32> {
    let mut words = vec![0; told(plan)];
    words[status::KEEP] = (batch.pace.uncoloured == turn.worlds).into();
    words[status::LAUNCHED] = (batch.pace.colours.count as u32).min(plan.colours);
    words[status::ROUNDS_OF_BLOWS] = batch.pace.blows.count as u32;
    words[status::PARTS] = turn.parts as u32;
    for &world in &turn.worlds {
        let steps = batch.left[world].min(turn.steps);
        words[status::WIDTH + world * of_world::WIDTH + of_world::LEFT] = steps as u32;
    }
    words
}

/// Contacts whose numbers fit into a buffer of a card.
fn most_contacts(gpu: &Gpu) -> u32 {
    let bytes = ContactTables::new().length as u64 * NUMBER;
    u32::try_from(gpu.most_bytes() / bytes).unwrap_or(u32::MAX)
}
