//! The launches of a step, in their order.

use super::batch::Batch;
use super::joints::Joints;
use super::kernels::Kernels;
use super::pace::Pace;
use super::plan::{COLOURS, KEYS, SUM_ROUNDS, run};
use super::room::{Own, Scan};
use super::scene::Scene;
use super::steps::Steps;
use crate::clock::Pass;
use crate::memory::NUMBER;
use crate::pipeline::{WORKGROUP, dispatch};
use wgpu::{BindGroup, ComputePipeline};

impl Steps {
    /// A step, or a part of one.
    pub fn encode(
        &self,
        pass: &mut Pass<'_>,
        k: &Kernels,
        scene: &Scene,
        own: &Own,
        batch: &Batch,
        (parts, part): (usize, usize),
    ) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        own.launch(pass, &e.clear, p.buckets.max(p.bodies).max(p.worlds) + 1);
        own.launch(pass, &e.load_bodies, p.bodies);
        let bodies = p.bodies.div_ceil(WORKGROUP);
        if batch.pushed {
            dispatch(pass, &k.push_body, &own.bodies, bodies);
        }
        dispatch(pass, &k.begin, &own.bodies, bodies);
        // For each world, too, it chooses into how many parts the step is cut.
        own.launch(pass, &e.load_shapes, p.shapes.max(p.worlds));
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
        own.launch(pass, &e.surround, p.shapes);
        own.launch(pass, &e.count_buckets, p.shapes);
        buckets.run(pass, k);
        own.launch(pass, &e.fill_buckets, p.shapes);
        own.launch(pass, &e.count_pairs, p.units + 1);
        units.run(pass, k);
        own.launch(pass, &e.list_pairs, p.units + 1);
        pass.mark("broad phase");
        dispatch(pass, &k.sort[0], &s.sort_pairs, p.pair_blocks);
        groups.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_pairs, p.pair_blocks);
        own.launch(pass, &e.plan_groups, p.groups);
        own.launch(pass, &e.seat_pairs, p.pairs);
        if p.mesh_pairs > 0 {
            own.launch(pass, &e.seat_meshes, p.mesh_pairs);
        }
        pass.mark("sorting pairs");
        for (group, (kernel, bindings)) in (0..).zip(k.apart.iter().zip(&s.groups)) {
            if let Some(kernel) = kernel {
                self.run(pass, kernel, bindings, group);
            }
        }
        own.launch(pass, &e.part_pairs, p.pairs);
        pass.mark("pairs apart");
        for (group, (kernel, bindings)) in (0..).zip(k.groups.iter().zip(&s.groups)) {
            self.run(pass, kernel, bindings, group);
        }
        pass.mark("narrow phase");
        own.launch(pass, &e.find_touching, p.pairs + 1);
        touching.run(pass, k);
        own.launch(pass, &e.make_contacts, p.pairs + 1);
        joined.run(pass, k);
        own.launch(pass, &e.join, p.contacts);
        pass.mark("making contacts");
        for _ in 0..batch.pace.rounds {
            own.launch(pass, &e.paint, p.contacts);
            own.launch(pass, &e.settle, 1);
        }
        pass.mark("colouring");
        dispatch(pass, &k.sort[0], &s.sort_contacts, p.contact_blocks);
        colours.run(pass, k);
        dispatch(pass, &k.sort[1], &s.sort_contacts, p.contact_blocks);
        own.launch(pass, &e.plan_colours, KEYS);
        own.launch(pass, &e.seat_contacts, p.contacts);
        pass.mark("sorting contacts");
        self.run(pass, &k.prepare, &s.contacts, run::CONTACTS);
        pass.mark("preparing contacts");
        let joints = scene.joints.as_ref().zip(k.joints.as_ref());
        if let Some((joints, kernels)) = joints {
            own.launch(pass, &e.load_joints, p.joints);
            if joints.drives {
                self.all_joints(pass, &kernels.follow);
            }
            self.all_joints(pass, &kernels.place);
        }
        pass.mark("preparing joints");
        self.small_steps(pass, k, scene, own, &batch.pace, parts);
        dispatch(pass, &k.finish, &own.bodies, bodies);
        own.launch(pass, &e.read_contacts, p.contacts);
        if part > 0 {
            self.sums(pass, k, own, ended);
        }
        own.launch(pass, &e.find_pressing, p.contacts + 1);
        pressing.run(pass, k);
        own.launch(pass, &e.check_bodies, p.bodies);
        own.launch(pass, &e.check_shapes, p.shapes);
        own.launch(pass, &e.store_bodies, p.bodies);
        own.launch(pass, &e.store_contacts, p.contacts);
        if joints.is_some() {
            own.launch(pass, &e.store_joints, p.joints);
        }
        own.launch(pass, &e.end, p.worlds);
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
                    own.launch(pass, &k.entries.foresee_blows, p.contacts);
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
    fn sums(&self, pass: &mut Pass<'_>, k: &Kernels, own: &Own, ended: &Scan) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        own.launch(pass, &e.find_ended, p.places() + 1);
        ended.run(pass, k);
        for _ in 0..SUM_ROUNDS {
            own.launch(pass, &e.match_parts, p.contacts);
            own.launch(pass, &e.seat_parts, p.contacts);
            self.run(pass, &k.add_part, &s.sums, run::SUMS);
            own.launch(pass, &e.read_parts, p.contacts);
        }
        own.launch(pass, &e.match_parts, p.contacts);
        own.launch(pass, &e.place_ended, p.places().max(1));
        own.launch(pass, &e.merge, p.contacts);
    }

    /// The blows of a small step.
    fn blows(&self, pass: &mut Pass<'_>, k: &Kernels, own: &Own, pace: &Pace) {
        let (p, s, e) = (&self.plan, &self.room, &k.entries);
        let several = p.worlds > 1;
        own.launch(pass, &e.begin_blows, p.contacts.max(COLOURS).max(p.worlds));
        if several {
            own.launch(pass, &e.keep_free, p.bodies);
        }
        self.run(pass, &k.part, &own.bodies, run::BLOW_BODIES);
        for round in 0..pace.blows.count {
            let strike = [&k.strike_foreseen, &k.strike][round.min(1)];
            for (colour, bindings) in (0..pace.colours.count as u32).zip(&s.colours) {
                self.run(pass, strike, bindings, run::BLOW_COLOURS + colour);
            }
            own.launch(pass, &e.tell_blows, p.contacts);
            own.launch(pass, &e.part_struck, p.contacts.max(p.joints));
            own.launch(pass, &e.end_round, 1);
            if let Some(kernels) = &k.joints {
                for (joints, bindings) in (0..p.joint_runs).zip(&s.joints[1]) {
                    self.run(pass, &kernels.strike, bindings, run::JOINTS + joints);
                }
            }
        }
        self.run(pass, &k.part, &own.bodies, run::BLOW_BODIES);
        if several {
            own.launch(pass, &e.put_free, p.bodies);
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
