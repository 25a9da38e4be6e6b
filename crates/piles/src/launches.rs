//! The launches of a step, in their order.

use crate::Card;
use crate::batch::Batch;
use crate::card::{Commands, WORKGROUP};
use crate::joints::Joints;
use crate::kernels::Kernels;
use crate::pace::Pace;
use crate::plan::{COLOURS, KEYS, SUM_ROUNDS, run};
use crate::room::{Own, Scan};
use crate::scene::Scene;
use crate::steps::Steps;

impl<C: Card> Steps<C> {
    /// A step, or a part of one.
    pub fn encode(
        &self,
        todo: &mut C::Commands<'_>,
        k: &Kernels<C>,
        scene: &Scene,
        own: &Own<C>,
        batch: &Batch<C>,
        (parts, part): (usize, usize),
    ) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        own.launch(todo, &e.clear, p.buckets.max(p.bodies).max(p.worlds) + 1);
        own.launch(todo, &e.load_bodies, p.bodies);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        if batch.pushed {
            todo.run(&k.push_body, &own.bodies, bodies);
        }
        todo.run(&k.begin, &own.bodies, bodies);
        // For each world, too, it chooses into how many parts the step is cut.
        own.launch(todo, &e.load_shapes, p.shapes.max(p.worlds));
        todo.run(&k.place, &own.shapes, p.shapes.div_ceil(WORKGROUP));
        todo.mark("bodies and shapes");
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
        own.launch(todo, &e.surround, p.shapes);
        own.launch(todo, &e.count_buckets, p.shapes);
        buckets.run(todo, k);
        own.launch(todo, &e.fill_buckets, p.shapes);
        own.launch(todo, &e.count_pairs, p.units + 1);
        units.run(todo, k);
        own.launch(todo, &e.list_pairs, p.units + 1);
        todo.mark("broad phase");
        todo.run(&k.sort[0], &s.sort_pairs, p.pair_blocks);
        groups.run(todo, k);
        todo.run(&k.sort[1], &s.sort_pairs, p.pair_blocks);
        own.launch(todo, &e.plan_groups, p.groups);
        own.launch(todo, &e.seat_pairs, p.pairs);
        own.launch(todo, &e.place_pairs, p.pairs);
        if p.mesh_pairs > 0 {
            own.launch(todo, &e.seat_meshes, p.mesh_pairs);
        }
        todo.mark("sorting pairs");
        for (group, (kernel, bindings)) in (0..).zip(k.apart.iter().zip(&s.groups)) {
            if let Some(kernel) = kernel {
                self.run(todo, kernel, bindings, (group, self.pairs_of(scene, group)));
            }
        }
        own.launch(todo, &e.part_pairs, p.pairs);
        todo.mark("pairs apart");
        for (group, (kernel, bindings)) in (0..).zip(k.groups.iter().zip(&s.groups)) {
            self.run(todo, kernel, bindings, (group, self.pairs_of(scene, group)));
        }
        todo.mark("narrow phase");
        own.launch(todo, &e.find_touching, p.pairs + 1);
        touching.run(todo, k);
        own.launch(todo, &e.make_contacts, p.pairs + 1);
        own.launch(todo, &e.warm_contacts, p.pairs);
        joined.run(todo, k);
        own.launch(todo, &e.join, p.contacts);
        todo.mark("making contacts");
        for _ in 0..batch.pace.rounds {
            own.launch(todo, &e.paint, p.contacts);
            own.launch(todo, &e.settle, 1);
        }
        todo.mark("colouring");
        todo.run(&k.sort[0], &s.sort_contacts, p.contact_blocks);
        colours.run(todo, k);
        todo.run(&k.sort[1], &s.sort_contacts, p.contact_blocks);
        own.launch(todo, &e.plan_colours, KEYS);
        own.launch(todo, &e.seat_contacts, p.contacts);
        todo.mark("sorting contacts");
        self.run(todo, &k.prepare, &s.contacts, (run::CONTACTS, p.contacts));
        todo.mark("preparing contacts");
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        if let Some((joints, kernels)) = joints {
            own.launch(todo, &e.load_joints, p.joints);
            if joints.drives {
                self.all_joints(todo, &kernels.follow);
            }
            self.all_joints(todo, &kernels.place);
        }
        todo.mark("preparing joints");
        self.small_steps(todo, k, scene, own, &batch.pace, parts);
        todo.run(&k.finish, &own.bodies, bodies);
        own.launch(todo, &e.read_contacts, p.contacts);
        if part > 0 {
            self.sums(todo, k, own, ended);
        }
        own.launch(todo, &e.find_pressing, p.contacts + 1);
        pressing.run(todo, k);
        own.launch(todo, &e.check_bodies, p.bodies);
        own.launch(todo, &e.check_shapes, p.shapes);
        own.launch(todo, &e.store_bodies, p.bodies);
        own.launch(todo, &e.store_contacts, p.contacts);
        if joints.is_some() {
            own.launch(todo, &e.store_joints, p.joints);
        }
        own.launch(todo, &e.end, p.worlds);
        todo.mark("end");
    }

    fn small_steps(
        &self,
        todo: &mut C::Commands<'_>,
        k: &Kernels<C>,
        scene: &Scene,
        own: &Own<C>,
        pace: &Pace,
        parts: usize,
    ) {
        let (p, s) = (&self.plan, &self.room);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        let contacts = |todo: &mut C::Commands<'_>, kernel: &C::Kernel| {
            for (colour, bindings) in (0..pace.colours.count as u32).zip(&s.colours) {
                let run = (run::COLOURS + colour, p.contacts);
                self.run(todo, kernel, bindings, run);
            }
        };
        for step in 0..scene.impulse.settings().contact_iterations / parts {
            if step == 0 {
                todo.run(&k.advance, &own.bodies, bodies);
                if scene.bounces {
                    let run = (run::CONTACTS, p.contacts);
                    self.run(todo, &k.foresee, &s.contacts, run);
                    own.launch(todo, &k.entries.foresee_blows, p.contacts);
                }
                contacts(todo, &k.warm_start);
                if let Some((joints, kernels)) = joints {
                    self.joints(todo, &kernels.warm_start, joints);
                }
            } else {
                todo.run(&k.advance_again, &own.bodies, bodies);
            }
            todo.mark("advancing, warm start");
            if pace.blows.count > 0 {
                self.blows(todo, k, own, pace);
            }
            todo.mark("blows");
            contacts(todo, &k.push);
            if let Some((joints, kernels)) = joints {
                self.joints(todo, &kernels.push, joints);
            }
            todo.mark("pushing");
            todo.run(&k.drift, &own.bodies, bodies);
            if let Some((_, kernels)) = joints {
                self.all_joints(todo, &kernels.place);
            }
            todo.mark("drift");
            contacts(todo, &k.relax);
            if let Some((joints, kernels)) = joints {
                self.joints(todo, &kernels.relax, joints);
            }
            todo.mark("relaxing");
        }
    }

    /// What contacts gave in the parts before.
    fn sums(&self, todo: &mut C::Commands<'_>, k: &Kernels<C>, own: &Own<C>, ended: &Scan<C>) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        own.launch(todo, &e.find_ended, p.places() + 1);
        ended.run(todo, k);
        for _ in 0..SUM_ROUNDS {
            own.launch(todo, &e.match_parts, p.contacts);
            own.launch(todo, &e.seat_parts, p.contacts);
            self.run(todo, &k.add_part, &s.sums, (run::SUMS, p.contacts));
            own.launch(todo, &e.read_parts, p.contacts);
        }
        own.launch(todo, &e.match_parts, p.contacts);
        own.launch(todo, &e.place_ended, p.places().max(1));
        own.launch(todo, &e.merge, p.contacts);
    }

    /// The blows of a small step.
    fn blows(&self, todo: &mut C::Commands<'_>, k: &Kernels<C>, own: &Own<C>, pace: &Pace) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let several = p.worlds > 1;
        own.launch(todo, &e.begin_blows, p.contacts.max(COLOURS).max(p.worlds));
        if several {
            own.launch(todo, &e.keep_free, p.bodies);
        }
        self.run(todo, &k.part, &own.bodies, (run::BLOW_BODIES, p.bodies));
        for round in 0..pace.blows.count {
            let strike = [&k.strike_foreseen, &k.strike][round.min(1)];
            for (colour, bindings) in (0..pace.colours.count as u32).zip(&s.colours) {
                let run = (run::BLOW_COLOURS + colour, p.contacts);
                self.run(todo, strike, bindings, run);
            }
            own.launch(todo, &e.tell_blows, p.contacts);
            own.launch(todo, &e.part_struck, p.contacts.max(p.joints));
            own.launch(todo, &e.end_round, 1);
            if let Some(kernels) = &k.joints {
                for (joints, bindings) in (0..p.joint_runs).zip(&s.joints[1]) {
                    let run = (run::JOINTS + joints, p.joints);
                    self.run(todo, &kernels.strike, bindings, run);
                }
            }
        }
        self.run(todo, &k.part, &own.bodies, (run::BLOW_BODIES, p.bodies));
        if several {
            own.launch(todo, &e.put_free, p.bodies);
        }
    }

    /// Runs a kernel on all joints side by side.
    fn all_joints(&self, todo: &mut C::Commands<'_>, kernel: &C::Kernel) {
        if let Some(bindings) = self.room.joints[0].last() {
            todo.run(kernel, bindings, self.plan.joints.div_ceil(WORKGROUP));
        }
    }

    /// Runs a kernel on all joints, run by run.
    fn joints(&self, todo: &mut C::Commands<'_>, kernel: &C::Kernel, joints: &Joints) {
        let runs = self.plan.joint_runs as usize;
        for (bindings, [_, count]) in self.room.joints[0].iter().zip(&joints.runs).take(runs) {
            let count = self.plan.worlds * count;
            todo.run(kernel, bindings, count.div_ceil(WORKGROUP));
        }
    }

    /// Runs a kernel on the members of a run, of which there are at most so many.
    fn run(
        &self,
        todo: &mut C::Commands<'_>,
        kernel: &C::Kernel,
        bindings: &C::Bindings,
        (run, most): (u32, u32),
    ) {
        let launches = (&self.room.buffers.launches, run);
        todo.run_told(kernel, bindings, launches, most.div_ceil(WORKGROUP));
    }
    /// Pairs that a group has room for.
    fn pairs_of(&self, scene: &Scene, group: u32) -> u32 {
        match scene.groups[group as usize].has_mesh() {
            true => self.plan.mesh_pairs,
            false => self.plan.pairs,
        }
    }
}
