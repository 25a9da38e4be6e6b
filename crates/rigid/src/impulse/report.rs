//! What a world looks like from outside.

use super::layout::{Impulse, State, WORLD, pose_at};
use super::memory::{Cached, CachedPoint, vec3};
use super::tables::mass;
use crate::output::{body, body_acceleration, contact, reaction, total};
use collide::FAR;
use glam::DVec3;
use numbers::Float;
use numbers::functions::wrap;

impl Impulse {
    /// Fills the output of a world from its state.
    pub fn report<T: Float>(&self, state: &State<'_, T>, output: &mut [T]) {
        self.report_bodies(state, output);
        self.report_joints(state, output);
        let stored = self.report_ties(state, output);
        self.report_sums(state, stored, output);
        self.report_contacts(state, output);
    }

    fn report_bodies<T: Float>(&self, state: &State<'_, T>, output: &mut [T]) {
        let long = state.long();
        for (id, &row) in self.rows.iter().enumerate() {
            let frame = pose_at(state.parameters, self.frame.at(id, 0));
            let (pose, [v, w], [a, turning]) = if row == WORLD {
                (frame, [DVec3::ZERO; 2], [DVec3::ZERO; 2])
            } else {
                let own = state.pose(row as usize);
                let [v, w] = state.velocity(row as usize);
                let [past_v, past_w] = state.before(row as usize);
                let pose = own * frame;
                let arm = pose.position - own.position;
                // Changes of velocity over the last step, and what draws the frame inwards.
                let [a, turning] = [v - past_v, w - past_w].map(|change| change / long);
                let a = a + turning.cross(arm) + w.cross(w.cross(arm));
                (pose, [v + w.cross(arm), w], [a, turning])
            };
            let at = self.output.body.at(id, 0);
            put(output, at + body::POSITION, pose.position.to_array());
            put(output, at + body::ORIENTATION, pose.orientation.to_array());
            put(output, at + body::VELOCITY, v.to_array());
            put(output, at + body::ANGULAR_VELOCITY, w.to_array());
            let at = self.output.body_acceleration.at(id, 0);
            put(output, at + body_acceleration::LINEAR, a.to_array());
            put(output, at + body_acceleration::ANGULAR, turning.to_array());
            if let Some(asleep) = self.output.asleep {
                let sleeps = f64::from(u8::from(state.sleeps(row as usize)));
                put(output, asleep.at(id, 0), [sleeps]);
            }
        }
    }

    fn report_joints<T: Float>(&self, state: &State<'_, T>, output: &mut [T]) {
        let long = state.long();
        for free in &self.free {
            let row = self.rows[free.body.0] as usize;
            let own = state.pose(row);
            let inner = pose_at(state.parameters, self.frame.at(free.body.0, 0));
            let frame = own * inner * free.child_frame;
            let arm = frame.position - own.position;
            let relative = free.parent_frame.inverse() * frame;
            let turned = |[v, w]: [DVec3; 2]| {
                [
                    free.parent_frame.orientation.inverse() * (v + w.cross(arm)),
                    frame.orientation.inverse() * w,
                ]
            };
            let [v, w] = turned(state.velocity(row));
            let [past_v, past_w] = turned(state.before(row));
            let (q, dof) = (self.output.position.at(free.coordinate, 0), free.dof);
            put(output, q, relative.position.to_array());
            put(output, q + 3, relative.orientation.to_array());
            let at = self.output.velocity.at(dof, 0);
            put(output, at, v.to_array());
            put(output, at + 3, w.to_array());
            let at = self.output.acceleration.at(dof, 0);
            put(output, at, ((v - past_v) / long).to_array());
            put(output, at + 3, ((w - past_w) / long).to_array());
            put(
                output,
                self.output.reaction.at(free.joint.0, 0),
                [0.0; reaction::WIDTH],
            );
        }
    }

    /// All other joints. Returns the energy of springs, and that of armatures [J].
    fn report_ties<T: Float>(&self, state: &State<'_, T>, output: &mut [T]) -> [f64; 2] {
        let long = state.long();
        let mut energy = [0.0; 2];
        for (i, tie) in self.ties.list.iter().enumerate() {
            let seen = state.see(i);
            let (rows, quaternion) = tie.reported();
            for (row, coordinate, dof, turns) in rows {
                let [now, past] = [0, 1].map(|i| seen.rates[i][row]);
                put(output, self.output.velocity.at(dof, 0), [now]);
                let acceleration = (now - past) / long;
                put(output, self.output.acceleration.at(dof, 0), [acceleration]);
                if let Some(coordinate) = coordinate {
                    let value = seen.value[row];
                    let value = if turns { wrap(value) } else { value };
                    put(output, self.output.position.at(coordinate, 0), [value]);
                }
            }
            if let Some(first) = quaternion {
                let at = self.output.position.at(first, 0);
                put(output, at, seen.turn.to_array());
            }
            let [torque, force] = seen.impulse.map(|x| (x / long).to_array());
            let at = self.output.reaction.at(tie.joint.0, 0);
            put(output, at + reaction::FORCE, force);
            put(output, at + reaction::TORQUE, torque);
            energy = [0, 1].map(|i| energy[i] + seen.energy[i]);
        }
        energy
    }

    fn report_sums<T: Float>(&self, state: &State<'_, T>, stored: [f64; 2], output: &mut [T]) {
        let g = self.gravity(state.parameters);
        let gravity = DVec3::new(g[0].to_f64(), g[1].to_f64(), g[2].to_f64());
        let [mut potential, mut kinetic] = stored;
        let (mut momentum, mut angular) = (DVec3::ZERO, DVec3::ZERO);
        for row in 1..self.rows() {
            let numbers = self.mass_of(row, state.parameters);
            let m = numbers[mass::MASS].to_f64();
            let moments = DVec3::from_array([0, 1, 2].map(|i| numbers[mass::MOMENTS + i].to_f64()));
            let (own, [v, w]) = (state.pose(row), state.velocity(row));
            let spin = own.orientation.inverse() * w;
            kinetic += 0.5 * (m * v.length_squared() + spin.dot(moments * spin));
            potential -= m * gravity.dot(own.position);
            momentum += m * v;
            angular += own.orientation * (moments * spin) + own.position.cross(m * v);
        }
        let at = self.output.total.at(0, 0);
        put(output, at + total::KINETIC, [kinetic, potential]);
        put(output, at + total::MOMENTUM, momentum.to_array());
        put(output, at + total::ANGULAR_MOMENTUM, angular.to_array());
        put(output, at + total::CAPPED, [self.forgotten(state.state)]);
    }

    /// Mean force and torque over the last step on the shape that moves.
    fn report_contacts<T: Float>(&self, state: &State<'_, T>, output: &mut [T]) {
        let long = state.long();
        let mut row = 0;
        for i in 0..self.remembered(state.state) {
            let touch = self.recall(i, state.state).contact();
            let [a, b] = touch.shapes;
            let flip = self.shapes()[b as usize].row == WORLD;
            let sign = if flip { -1.0 } else { 1.0 };
            let shapes = if flip { [b, a] } else { [a, b] };
            let shapes = shapes.map(|s| self.shapes()[s as usize].shape.0 as f64);
            let normal = vec3(&touch.normal);
            let share = Shares::of(&touch, normal);
            for p in &touch.points[..touch.count] {
                let [force, torque] = share.of_point(p).map(|given| given * (sign / long));
                let at = self.output.contact.at(row, 0);
                put(output, at + contact::POSITION, vec3(&p.position).to_array());
                put(output, at + contact::NORMAL, (normal * sign).to_array());
                put(
                    output,
                    at + contact::DISTANCE,
                    [p.gap.to_f64(), p.feature.to_f64()],
                );
                put(output, at + contact::FORCE, force.to_array());
                if let Some(torques) = self.output.contact_torque {
                    put(output, torques.at(row, 0), torque.to_array());
                }
                put(output, self.output.touching.at(row, 0), shapes);
                row += 1;
            }
        }
        for row in row..self.output.contacts {
            put(
                output,
                self.output.contact.at(row, contact::DISTANCE),
                [FAR],
            );
        }
    }
}

/// What the points of a contact bear of its friction: in proportion to their loads; alike where a bounce has taken back
/// what they bore.
struct Shares {
    normal: DVec3,
    drag: DVec3,
    torque: DVec3,
    load: f64,
    alike: f64,
}

impl Shares {
    /// Friction pulls at the middle of the points, and is told of where they are loaded.
    fn of<T: Float>(touch: &Cached<T>, normal: DVec3) -> Self {
        let points = &touch.points[..touch.count];
        let (middle, drag) = (touch.middle(), vec3(&touch.drag_sum));
        let mut shares = Self {
            normal,
            drag,
            torque: DVec3::ZERO,
            load: points.iter().map(|p| p.sum.to_f64()).sum(),
            alike: 1.0 / touch.count as f64,
        };
        let arm = |p: &CachedPoint<T>| (vec3(&p.position) - middle) * shares.share(p);
        let loaded = points.iter().map(arm).sum::<DVec3>();
        shares.torque = vec3(&touch.twist_sum) - loaded.cross(drag);
        shares
    }
    fn share<T: Float>(&self, p: &CachedPoint<T>) -> f64 {
        if self.load > 0.0 {
            p.sum.to_f64() / self.load
        } else {
            self.alike
        }
    }
    /// Impulse and angular impulse of a point.
    fn of_point<T: Float>(&self, p: &CachedPoint<T>) -> [DVec3; 2] {
        let share = self.share(p);
        let load = self.normal * p.sum.to_f64();
        [load + self.drag * share, self.torque * share]
    }
}

fn put<T: Float, const N: usize>(output: &mut [T], at: usize, x: [f64; N]) {
    for (to, x) in output[at..at + N].iter_mut().zip(x) {
        *to = T::from_f64(x);
    }
}
