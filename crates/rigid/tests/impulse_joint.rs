//! The kernels of a joint of `impulse`, in scalars: one joint, its two bodies, one relaxation.

use glam::DVec3;
use kinetarium_rigid::impulse::joint::{
    JointTables, PLACED, ROWS, axis, axis_link, bounded, joint, place, solve,
};
use kinetarium_rigid::impulse::{global, row};
use numbers::{Cpu, Shared};

/// Length of a small step [s].
const H: f64 = 1e-3;
const MASSES: [f64; 2] = [2.0, 0.5];
/// Moments of inertia [kg·m²] of A and B, the same about all axes.
const MOMENTS: [f64; 2] = [0.3, 0.04];
const CENTERS: [DVec3; 2] = [DVec3::ZERO, DVec3::new(0.5, 0.2, -0.1)];
/// Where the joint is.
const ANCHOR: DVec3 = DVec3::new(0.3, 0.1, 0.0);

/// A joint of two bodies that move anyhow, with the given rows locked.
struct Lane {
    state: Vec<f64>,
    scratch: Vec<f64>,
    links: [u32; ROWS * axis_link::WIDTH],
}

impl Lane {
    fn new(locked: [f64; ROWS]) -> Self {
        let t = JointTables::new();
        let mut lane = Self {
            state: vec![0.0; t.length],
            scratch: vec![0.0; JointTables::SCRATCH],
            links: [0; ROWS * axis_link::WIDTH],
        };
        let identity = [0.0, 0.0, 0.0, 1.0];
        let mut put = |field: usize, x: &[f64]| {
            let at = t.joint.at(0, field);
            lane.state[at..at + x.len()].copy_from_slice(x);
        };
        put(joint::ANCHOR_A, &(ANCHOR - CENTERS[0]).to_array());
        put(joint::ANCHOR_B, &(ANCHOR - CENTERS[1]).to_array());
        for frame in [
            joint::FRAME_A,
            joint::FRAME_B,
            joint::LINEAR_FRAME,
            joint::TARGET,
        ] {
            put(frame, &identity);
        }
        put(joint::LOCKED, &locked);
        put(joint::SECOND, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        put(joint::LENGTH, &[-1.0]);
        put(joint::SHARES, &[1.0; 2]);
        for side in 0..2 {
            let wave = |i: usize| (1.3 * (6 * side + i) as f64 + 0.7).sin();
            let body = &mut lane.scratch[side * PLACED..][..PLACED];
            for i in 0..6 {
                body[row::VELOCITY + i] = wave(i);
            }
            body[row::INVERSE_MASS] = MASSES[side].recip();
            body[row::INVERSE_INERTIA..][..3].fill(MOMENTS[side].recip());
            body[row::CENTER..][..3].copy_from_slice(&CENTERS[side].to_array());
            body[row::ORIENTATION..][..4].copy_from_slice(&identity);
        }
        lane
    }

    /// Places the joint and relaxes it.
    fn relax(&mut self, pushing: f64) {
        let t = JointTables::new();
        let mut parameters = [0.0; global::WIDTH];
        (parameters[global::STEP], parameters[global::RATE]) = (H, H.recip());
        let mut k = Cpu {
            state: &mut self.state,
            input: &[],
            output: &mut [],
            scratch: &mut self.scratch,
            parameters: Shared(&parameters),
            links: &self.links,
        };
        place(&mut k, &t);
        solve(&mut k, &t, pushing);
    }

    /// Velocity and spin of a body.
    fn motion(&self, side: usize) -> [DVec3; 2] {
        let at = side * PLACED + row::VELOCITY;
        [0, 3].map(|i| DVec3::from_slice(&self.scratch[at + i..][..3]))
    }

    /// Of B against A: velocity of the anchor, and spin.
    fn apart(&self) -> [DVec3; 2] {
        let [a, b] = [0, 1].map(|side| {
            let [v, w] = self.motion(side);
            [v + w.cross(ANCHOR - CENTERS[side]), w]
        });
        [b[0] - a[0], b[1] - a[1]]
    }

    /// Linear and angular momentum.
    fn momentum(&self) -> [DVec3; 2] {
        let [a, b] = [0, 1].map(|side| {
            let [v, w] = self.motion(side);
            let p = MASSES[side] * v;
            [p, MOMENTS[side] * w + CENTERS[side].cross(p)]
        });
        [a[0] + b[0], a[1] + b[1]]
    }
}

/// What is locked stops at once, what is free goes on as impulses across it allow, and momentum stays.
#[test]
fn one_relaxation_solves_all_locked_rows() {
    for bits in 0..1 << ROWS {
        let locked: [f64; ROWS] = std::array::from_fn(|i| f64::from(bits >> i & 1));
        let mut lane = Lane::new(locked);
        let before = lane.momentum();
        lane.relax(0.0);
        let [v, w] = lane.apart();
        let rates = [w.to_array(), v.to_array()].concat();
        for (rate, locked) in rates.iter().zip(locked) {
            assert!(rate.abs() * locked < 1e-13, "{locked:?}: {rates:?}");
        }
        let after = lane.momentum();
        for (before, after) in before.into_iter().zip(after) {
            assert!(before.distance(after) < 1e-13);
        }
    }
}

/// A drive, a stop and friction along the axis of a hinge: with the moment of inertia m that the hinge
/// leaves, m (v − v₀) = h F(v), where F is the sum of their clamped forces; the locks stay solved.
#[test]
fn what_acts_along_an_axis_is_balanced_exactly() {
    let hinge = [0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let t = JointTables::new();
    let free = {
        let mut lane = Lane::new(hinge);
        lane.relax(0.0);
        lane.apart()[1].x
    };
    let laws = [
        [300.0, 20.0, 0.2, 0.0, -4.0, 4.0, 0.0],
        [0.0, 1e6, 0.0, 0.0, -1.5, 1.5, 0.0],
        [5e3, 10.0, -0.001, 0.0, -1e30, 0.0, 1.0],
    ];
    for count in 0..=laws.len() {
        let mut lane = Lane::new(hinge);
        lane.relax(0.0);
        // Locks yield in proportion to what they have given, while they push.
        lane.state[t.joint.at(0, joint::IMPULSE)..][..ROWS].fill(0.0);
        lane.links[axis_link::ACTS] = 1;
        lane.links[axis_link::END] = count as u32;
        let passive = [1.0, 0.0, 0.3, 0.7, 0.05];
        let at = t.axis.at(0, axis::ACTS);
        lane.state[at..at + passive.len()].copy_from_slice(&passive);
        lane.state[t.joint.at(0, joint::SPEED)] = free;
        for (i, law) in laws[..count].iter().enumerate() {
            let at = t.law.at(i, bounded::STIFFNESS);
            lane.state[at..at + law.len()].copy_from_slice(law);
        }
        lane.relax(1.0);
        let [slip, w] = lane.apart();
        let off = slip.length() + w.y.abs() + w.z.abs();
        assert!(off < 1e-12, "the locks are off by {off}");
        let v = w.x;
        let speed = lane.state[t.joint.at(0, joint::SPEED)];
        assert!(
            (speed - v).abs() < 1e-12,
            "what is geared to it has {speed}"
        );
        let mut force = 0.7 - 0.3 * v - 0.05 * (v - free) / H;
        for [k, d, rest, _, low, high, stop] in &laws[..count] {
            let reaching = (rest / H).clamp(-high, -low) * stop;
            force += (k * (rest - H * v) - d * (v - reaching)).clamp(*low, *high);
        }
        let inertia = 1.0 / lane.state[t.axis.at(0, axis::RESPONSE)];
        let left = inertia * (v - free) - H * force;
        // Friction is steep: a rounding of v is 1e6 times as much force.
        assert!(left.abs() < 1e-11, "{count} laws: {left}");
    }
}

/// What acts along an axis sees of bodies that a hinge does not quite hold how far its own push has moved them: the way of all
/// that it pushes, along that push.
#[test]
fn what_acts_sees_the_way_that_its_push_goes() {
    let t = JointTables::new();
    for i in 0..ROWS {
        let mut lane = Lane::new([0.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
        lane.links[axis_link::ACTS] = 1;
        lane.relax(0.0);
        let way = 1e-6;
        let turns = if i < 3 { row::TURN } else { row::SHIFT };
        lane.scratch[PLACED + turns + i % 3] = way;
        let push = &lane.state[t.axis.at(0, axis::WRENCH)..][..ROWS];
        let at = |first: usize| DVec3::from_slice(&push[first..]);
        // Impulses on B at its anchor, and so about its centre.
        let about = at(0) + (ANCHOR - CENTERS[1]).cross(at(3));
        let along = [about, at(3)][i / 3][i % 3] * way;
        lane.relax(0.0);
        let seen = lane.state[t.axis.at(0, axis::VALUE)];
        assert!((seen - along).abs() < 1e-5 * way, "{i}: {seen} {along}");
    }
}

/// What is geared to three axes of a ball, with far more inertia than the body, is solved as one: after each relaxation the
/// impulses along all of them are λ = −m (v − v₀) of the speeds v that all have in the end, and so after one that pushes
/// nothing.
#[test]
fn what_is_geared_to_three_axes_is_solved_as_one() {
    // The bodies of a joint have all of their masses in it, or a share: then they are slower than what is geared to them.
    for shares in [1.0, 1.5, 4.0] {
        is_solved_as_one(shares);
    }
}

fn is_solved_as_one(shares: f64) {
    let t = JointTables::new();
    let mut lane = Lane::new([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    lane.state[t.joint.at(0, joint::BALL)] = 1.0;
    lane.state[t.joint.at(0, joint::SHARES)..][..2].fill(shares);
    let (armature, begin) = ([5.0, 40.0, 0.3], [0.4, -0.7, 0.2]);
    for row in 0..3 {
        lane.links[row * axis_link::WIDTH + axis_link::ACTS] = 1;
        let passive = [1.0, 0.0, 0.0, 0.0, armature[row]];
        let at = t.axis.at(row, axis::ACTS);
        lane.state[at..at + passive.len()].copy_from_slice(&passive);
        lane.state[t.joint.at(0, joint::SPEED + row)] = begin[row];
    }
    for pushing in [1.0, 0.0] {
        lane.relax(pushing);
        let [slip, w] = lane.apart();
        // They yield while they push, and with shares are held by all joints of a body together.
        let held = pushing == 0.0 && shares == 1.0;
        assert!(
            !held || slip.length() < 1e-12,
            "the locks are off by {slip}"
        );
        for row in 0..3 {
            let given = lane.state[t.joint.at(0, joint::IMPULSE + row)];
            let speed = lane.state[t.joint.at(0, joint::SPEED + row)];
            let left = |rate: f64| (given + armature[row] * (rate - begin[row])).abs();
            // What is geared is told last how fast it is.
            assert!(pushing == 1.0 || left(speed) < 1e-12, "axis {row}: {speed}");
            // They are those of the bodies where locks do not yield.
            assert!(!held || left(w[row]) < 1e-12, "axis {row}: {w}");
        }
    }
}
