//! What drives, actuators and a controller do along degrees of freedom, by their laws at the present state.
//!
//! ```text
//! drive      clamp(k (target − q) + d (target velocity − q̇), ± effort limit)
//! ball       the same of vectors: k log(q⁻¹ target) + d (target velocity − ω), shortened to the limit
//! actuator   clamp(gain · u + bias₀ + gear · (bias₁ q + bias₂ q̇), force range), along the degree of freedom times its gear
//! ```
//!
//! Of k, and of gain, bias₀ and bias₁ of an actuator that has a bias₁, as much acts as the solver takes
//! ([`Reported::acting`]). Drives that follow their targets with a lag are taken to be there.

use super::rows::{Notes, Rows};
use super::{Of, Reported, Told, reported};
use crate::tables::{Filler, actuator_numbers, bounded};
use model::{Actuator, Drive, JointId, JointKind, Model};
use numbers::functions::wrap;
use numbers::machine::Cell;
use numbers::machine::space::{Input, State};
use numbers::{Machine, Quat, Real, Table, Vec3};

/// Forces that are told.
#[derive(Default)]
pub(super) struct EffortNotes {
    applied: Notes<2, 0>,
    drives: Notes<4, 3>,
    balls: Notes<3, 5>,
    actuators: Notes<4, 10>,
}

/// Where they lie. COORDINATE and DOF are rows of what was reported and of the controls, TO is the first number told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Efforts {
    position: Table<Input>,
    velocity: Table<Input>,
    force: Table<State>,
    target_position: Table<State>,
    target_velocity: Table<State>,
    control: Table<State>,
    /// DOF, TO.
    applied: Rows<2, 0>,
    /// COORDINATE, DOF, TO, 1 where whole turns do not count; stiffness, damping, effort limit.
    drives: Rows<4, 3>,
    /// COORDINATE, DOF, TO; stiffness about each axis, damping, effort limit.
    balls: Rows<3, 5>,
    /// COORDINATE, DOF, ACTUATOR, TO; its numbers, and how many times its force is told.
    actuators: Rows<4, 10>,
}

impl EffortNotes {
    /// All that acts along a joint's degrees of freedom.
    pub fn joint(&mut self, (model, all): Of<'_>, id: JointId, to: usize) {
        let joint = &model.joints[id.0];
        let (q, dofs) = (model.coordinate_range(id).start, model.dof_range(id));
        for (axis, dof) in dofs.clone().enumerate() {
            self.applied.add([dof, to + axis], []);
            for (row, a) in model.actuators.iter().enumerate() {
                if a.joint == id && a.dof == axis {
                    self.actuator((model, all), (row, a.gear), to + axis);
                }
            }
        }
        let stiffness =
            |drive: &Drive, axis: usize| all.acting[dofs.start + axis] * drive.stiffness;
        match joint.kind {
            _ if joint.closes_loop => {}
            JointKind::Free => {}
            JointKind::Ball => {
                let d = &joint.dofs[0].drive;
                let [x, y, z] = [0, 1, 2].map(|axis| stiffness(d, axis));
                let numbers = [x, y, z, d.damping, bounded(d.effort_limit)];
                self.balls.add([q, dofs.start, to], numbers);
            }
            _ => {
                for (axis, dof) in dofs.clone().enumerate() {
                    let d = &joint.dofs[axis].drive;
                    let numbers = [stiffness(d, axis), d.damping, bounded(d.effort_limit)];
                    let turns = usize::from(model.turns_without_end(id, axis));
                    let links = [q + axis, dof, to + axis, turns];
                    self.drives.add(links, numbers);
                }
            }
        }
    }
    /// So many times the force of an actuator.
    pub fn actuator(&mut self, (model, all): Of<'_>, (row, times): (usize, f64), to: usize) {
        let a = &model.actuators[row];
        let (coordinates, dofs) = (model.coordinate_range(a.joint), model.dof_range(a.joint));
        let [gear, gain, b0, b1, b2, c0, c1, f0, f1] = actuator_numbers(a);
        let dof = dofs.start + a.dof;
        // What a servo that pulls less goes to is what it was.
        let acts = if b1 == 0.0 { 1.0 } else { all.acting[dof] };
        let [gain, b0, b1] = [gain, b0, b1].map(|x| acts * x);
        // Rotations of balls and free joints have no coordinate, and no position term: any will do.
        let b1 = if has_coordinate(model, a) { b1 } else { 0.0 };
        let q = (coordinates.start + a.dof).min(coordinates.end - 1);
        let numbers = [gear, gain, b0, b1, b2, c0, c1, f0, f1, times];
        self.actuators.add([q, dof, row, to], numbers);
    }
    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        self.applied.len() + self.drives.len() + self.balls.len() + self.actuators.len()
    }
    pub fn place(
        &self,
        Reported {
            outputs, inputs, ..
        }: &Reported<'_>,
        [parameters, links]: [&mut usize; 2],
    ) -> Efforts {
        Efforts {
            position: reported(outputs.position),
            velocity: reported(outputs.velocity),
            force: reported(inputs.force),
            target_position: reported(inputs.target_position),
            target_velocity: reported(inputs.target_velocity),
            control: reported(inputs.control),
            applied: self.applied.place(parameters, links),
            drives: self.drives.place(parameters, links),
            balls: self.balls.place(parameters, links),
            actuators: self.actuators.place(parameters, links),
        }
    }
}

/// Whether what an actuator drives is a coordinate.
fn has_coordinate(model: &Model, a: &Actuator) -> bool {
    let joint = &model.joints[a.joint.0];
    (joint.kind == JointKind::Free && a.dof < 3) || a.dof < joint.axes.len()
}

impl Efforts {
    pub fn fill(&self, notes: &EffortNotes, f: &mut Filler) {
        self.applied.fill(&notes.applied, f);
        self.drives.fill(&notes.drives, f);
        self.balls.fill(&notes.balls, f);
        self.actuators.fill(&notes.actuators, f);
    }

    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.applied.all(k) {
            let [dof, to] = self.applied.links(k, row);
            let force = k.load(self.force, dof, 0);
            k.add(told, to, 0, force);
        }
        self.tell_drives(k, told);
        self.tell_balls(k, told);
        self.tell_actuators(k, told);
    }
    #[inline(always)]
    fn tell_drives<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.drives.all(k) {
            let [q, dof, to, turns] = self.drives.links(k, row);
            let [stiffness, damping, limit] = self.drives.numbers(k, row);
            let target = k.load(self.target_position, dof, 0);
            let mut error = k.cell(target - k.load(self.position, q, 0));
            if let Some(_branch) = k.when(k.equals(turns, 1)) {
                error.write(wrap(error.read()));
            }
            let speed = k.load(self.target_velocity, dof, 0) - k.load(self.velocity, dof, 0);
            let force = stiffness * error.read() + damping * speed;
            k.add(told, to, 0, force.clamp(-limit, limit));
        }
    }
    #[inline(always)]
    fn tell_balls<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.balls.all(k) {
            let [q, dof, to] = self.balls.links(k, row);
            let [kx, ky, kz, damping, limit] = self.balls.numbers(k, row);
            let now = k.quat(self.position, q, 0).normalized();
            let target = Quat::exp(k.vec3(self.target_position, dof, 0));
            let speed = k.vec3(self.target_velocity, dof, 0) - k.vec3(self.velocity, dof, 0);
            let error = (now.conjugate() * target).log();
            let spring = Vec3::new(kx * error.x, ky * error.y, kz * error.z);
            let force = spring + speed * damping;
            let size = force.length().max(M::R::lit(1e-30));
            k.add_vec3(told, to, 0, force * (limit.min(size) / size));
        }
    }
    #[inline(always)]
    fn tell_actuators<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.actuators.all(k) {
            let [q, dof, actuator, to] = self.actuators.links(k, row);
            let [gear, gain, b0, b1, b2, c0, c1, f0, f1, times] = self.actuators.numbers(k, row);
            let control = k.load(self.control, actuator, 0).clamp(c0, c1);
            let (q, speed) = (k.load(self.position, q, 0), k.load(self.velocity, dof, 0));
            let force = gain.fma(control, b0) + gear * (b1 * q + b2 * speed);
            k.add(told, to, 0, times * force.clamp(f0, f1));
        }
    }
}
