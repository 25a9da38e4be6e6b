//! People without muscles.

use super::countable;
use super::stuff::{PLAIN, STONE, floor};
use crate::{Axis, BodyHandle, Builder, Geometry, Limit, Model, ModelError, Object, Pose, Shape};
use glam::{DQuat, DVec3};

/// How far each person lies above the one below [m], and to which side.
const ABOVE: DVec3 = DVec3::new(0.15, 0.5, 0.1);

/// People of 1.75 m, limp, who fall on the floor and on each other, each turned against the one below.
///
/// To see: joints hold, knees and elbows bend one way only, and the heap comes to rest.
///
/// # Errors
/// If there are no people, or more than a million.
pub fn ragdolls(people: usize) -> Result<Model, ModelError> {
    countable("heap", "number of people", people)?;
    let mut world = Builder::new(format!("ragdolls_{people}"));
    floor(world.object("ground"), STONE);
    for i in 0..people {
        let lean = DQuat::from_rotation_y(1.1 * i as f64) * DQuat::from_rotation_x(1.2);
        let side = if i % 2 == 0 { 1.0 } else { -1.0 };
        let at = DVec3::new(side * ABOVE.x, 1.0 + i as f64 * ABOVE.y, -side * ABOVE.z);
        let name = format!("person_{i}");
        person(world.object(&name), &name, Pose::new(at, lean));
    }
    world.build()
}

/// A capsule from a joint to its end, in a person's frame [m].
#[derive(Clone, Copy)]
struct Limb {
    from: DVec3,
    to: DVec3,
    radius: f64,
}

impl Limb {
    fn new(from: [f64; 3], to: [f64; 3], radius: f64) -> Self {
        let (from, to) = (DVec3::from_array(from), DVec3::from_array(to));
        Self { from, to, radius }
    }
    fn pose(&self) -> Pose {
        let along = (self.to - self.from).normalize();
        let turn = DQuat::from_rotation_arc(DVec3::Y, along);
        Pose::new(0.5 * (self.from + self.to), turn)
    }
    fn shape(&self) -> Shape {
        PLAIN.shape(Geometry::Capsule {
            radius: self.radius,
            half_height: 0.5 * self.from.distance(self.to) + self.radius,
        })
    }
}

/// Stops at two angles [rad].
fn range(lower: f64, upper: f64) -> Limit {
    Limit {
        lower,
        upper,
        stiffness: 500.0,
        damping: 10.0,
        inertia: 0.0,
    }
}

/// A person in the making, who faces z, the origin between the hips.
struct Person<'a> {
    object: &'a mut Object,
    name: &'a str,
    place: Pose,
}

impl Person<'_> {
    fn body(&mut self, name: &str, limb: Limb) -> BodyHandle {
        let body = self.object.body(format!("{}_{name}", self.name));
        body.at(self.place * limb.pose())
            .shape(limb.shape())
            .handle()
    }

    /// A joint that bends up to an angle [rad] to all sides, and twists by half of it.
    fn socket(&mut self, name: &str, at: [f64; 3], pair: [BodyHandle; 2], most: f64) {
        let axes = [DVec3::X, DVec3::Z, DVec3::Y].map(Axis::angular);
        let name = format!("{}_{name}", self.name);
        let joint = self.object.d6(name, pair[1], &axes);
        joint
            .parent(pair[0])
            .at(self.place * Pose::at(DVec3::from_array(at)))
            .damping(0.5)
            .limit(range(-most, most));
        joint.dofs_mut()[2].limit = Some(range(-0.5 * most, 0.5 * most));
    }

    /// A joint that bends one way only.
    fn hinge(&mut self, name: &str, at: DVec3, axis: DVec3, pair: [BodyHandle; 2]) {
        let name = format!("{}_{name}", self.name);
        self.object
            .revolute(name, pair[1], axis)
            .parent(pair[0])
            .at(self.place * Pose::at(at))
            .damping(0.5)
            .limit(range(0.0, 2.4));
    }

    /// Two limbs and the joints at the trunk and between them.
    fn arm_or_leg(&mut self, names: [&str; 4], trunk: BodyHandle, limbs: [Limb; 2], bends: DVec3) {
        let [upper, lower] = limbs;
        let first = self.body(names[0], upper);
        let second = self.body(names[1], lower);
        self.socket(names[2], upper.from.to_array(), [trunk, first], 1.2);
        self.hinge(names[3], lower.from, bends, [first, second]);
    }
}

fn person(object: &mut Object, name: &str, place: Pose) {
    let mut person = Person {
        object,
        name,
        place,
    };
    let pelvis = Limb::new([-0.08, 0.0, 0.0], [0.08, 0.0, 0.0], 0.1);
    let chest = Limb::new([0.0, 0.22, 0.0], [0.0, 0.4, 0.0], 0.13);
    let head = Limb::new([0.0, 0.66, 0.0], [0.0, 0.72, 0.0], 0.09);
    let pelvis = person.body("pelvis", pelvis);
    let chest = person.body("chest", chest);
    let head = person.body("head", head);
    person.socket("waist", [0.0, 0.1, 0.0], [pelvis, chest], 0.5);
    person.socket("neck", [0.0, 0.55, 0.0], [chest, head], 0.5);
    for (side, x) in [("left", 1.0), ("right", -1.0)] {
        let named = |names: [&str; 4]| names.map(|name| format!("{side}_{name}"));
        let leg = [
            Limb::new([0.1 * x, -0.05, 0.0], [0.1 * x, -0.48, 0.0], 0.07),
            Limb::new([0.1 * x, -0.48, 0.0], [0.1 * x, -0.9, 0.0], 0.05),
        ];
        let arm = [
            Limb::new([0.2 * x, 0.42, 0.0], [0.47 * x, 0.42, 0.0], 0.045),
            Limb::new([0.47 * x, 0.42, 0.0], [0.72 * x, 0.42, 0.0], 0.035),
        ];
        let names = named(["thigh", "shin", "hip", "knee"]);
        person.arm_or_leg(names.each_ref().map(|s| &**s), pelvis, leg, DVec3::X);
        let names = named(["arm", "forearm", "shoulder", "elbow"]);
        person.arm_or_leg(names.each_ref().map(|s| &**s), chest, arm, DVec3::Y * -x);
    }
}
