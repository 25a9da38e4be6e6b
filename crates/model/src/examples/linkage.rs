//! A machine that walks on linkages.

use super::countable;
use super::stuff::STONE;
use crate::{Axis, BodyHandle, Builder, Drive, Geometry, Model, ModelError, Object, Pose, Shape};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Lengths of a leg [m]: T. Jansen's, at 1 cm each unit (*The Great Pretender*, 2007).
mod length {
    pub const CRANK: f64 = 0.15;
    /// From the crank's axle to the pivots, across and down.
    pub const PIVOT: [f64; 2] = [0.38, 0.078];
    /// The upper triangle: from its pivot to its top and to its outer corner, and between these.
    pub const UPPER: [f64; 3] = [0.415, 0.401, 0.558];
    /// From the pivot to the knee.
    pub const LOWER: f64 = 0.393;
    /// From the crank to the upper triangle's top, and to the knee.
    pub const RODS: [f64; 2] = [0.50, 0.619];
    /// From the upper triangle's outer corner to the foot's.
    pub const STRUT: f64 = 0.394;
    /// The foot: from its corner to the knee and to its tip, and between these.
    pub const FOOT: [f64; 3] = [0.367, 0.657, 0.49];
}

/// Radius of the soles [m].
const SOLE: f64 = 0.025;
/// Between two legs, across [m].
const LAYER: f64 = 0.06;

/// Where the joints of a leg are for an angle of its crank, from the crank's axle; the leg is at −x.
#[derive(Clone, Copy, Debug)]
struct Leg {
    pin: DVec2,
    pivot: DVec2,
    top: DVec2,
    outer: DVec2,
    knee: DVec2,
    corner: DVec2,
    tip: DVec2,
}

impl Leg {
    fn new(crank: f64) -> Self {
        let [across, down] = length::PIVOT;
        let (pin, pivot) = (
            DVec2::from_angle(crank) * length::CRANK,
            -DVec2::new(across, down),
        );
        let [to_top, to_outer, between] = length::UPPER;
        let top = meet((pivot, to_top), (pin, length::RODS[0]));
        let outer = meet((pivot, to_outer), (top, between));
        let knee = meet((pin, length::RODS[1]), (pivot, length::LOWER));
        let [to_knee, to_tip, shin] = length::FOOT;
        let corner = meet((knee, to_knee), (outer, length::STRUT));
        let tip = meet((knee, shin), (corner, to_tip));
        Self {
            pin,
            pivot,
            top,
            outer,
            knee,
            corner,
            tip,
        }
    }
    /// The same, on the other side.
    fn mirrored(self) -> Self {
        let flip = |p: DVec2| DVec2::new(-p.x, p.y);
        Self {
            pin: flip(self.pin),
            pivot: flip(self.pivot),
            top: flip(self.top),
            outer: flip(self.outer),
            knee: flip(self.knee),
            corner: flip(self.corner),
            tip: flip(self.tip),
        }
    }
}

/// Where two circles meet, to the left of the way from the first centre to the second.
fn meet((one, r): (DVec2, f64), (other, s): (DVec2, f64)) -> DVec2 {
    let way = other - one;
    let along = (way.length_squared() + r * r - s * s) / (2.0 * way.length());
    let across = (r * r - along * along).sqrt();
    let x = way.normalize();
    one + x * along + x.perp() * across
}

/// A machine on `pairs` pairs of legs, which one crank moves: each leg is a linkage of eight links, whose three
/// loops turn the crank's circle into a step. It walks in the plane of its legs.
///
/// To see: the feet's paths are flat below and high above; the machine walks as fast as the crank's motor turns. Only
/// its feet touch the ground: with a single pair of legs it falls, and through it.
///
/// # Errors
/// No legs, or far too many.
pub fn linkage(pairs: usize) -> Result<Model, ModelError> {
    countable("linkage", "pairs of legs", pairs)?;
    let mut world = Builder::new("linkage");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let machine = world.object("machine");
    let phases = (0..pairs).map(|i| TAU * i as f64 / pairs as f64);
    let legs: Vec<[Leg; 2]> = phases
        .map(|phase| [Leg::new(phase), Leg::new(PI - phase).mirrored()])
        .collect();
    let lowest = legs
        .iter()
        .flatten()
        .map(|leg| leg.tip.y)
        .fold(0.0, f64::min);

    let wide = LAYER * pairs as f64;
    let hull = Geometry::Box {
        half: DVec3::new(length::PIVOT[0], 0.03, wide + 0.02),
    };
    let hull = Shape::new(hull).without_contact();
    let below = Pose::at(DVec3::Y * -length::PIVOT[1]);
    let hull = machine.body("hull").shape(hull.at(below));
    let hull = hull.mass(4.0).handle();
    let axes = [
        Axis::linear(DVec3::X),
        Axis::linear(DVec3::Y),
        Axis::angular(DVec3::Z),
    ];
    let height = Pose::at(DVec3::Y * (SOLE - lowest));
    machine
        .d6("walk", hull, &axes)
        .frames(height, Pose::IDENTITY);

    let crank = machine.body("crank").mass(0.5);
    for (i, [leg, _]) in legs.iter().enumerate() {
        crank.shape(bar([DVec2::ZERO, leg.pin], DVec2::ZERO, layer(i, pairs)));
    }
    let crank = crank.handle();
    let motor = Drive {
        damping: 20.0,
        target_velocity: 3.0,
        ..Drive::default()
    };
    let axle = machine.revolute("axle", crank, DVec3::Z).parent(hull);
    axle.drive(motor);
    for (i, sides) in legs.iter().enumerate() {
        for (side, leg) in ["left", "right"].into_iter().zip(sides) {
            add_leg(
                machine,
                &format!("{side}_{i}"),
                leg,
                layer(i, pairs),
                [hull, crank],
            );
        }
    }
    world.build()
}

/// Where a pair of legs is, across [m].
fn layer(i: usize, pairs: usize) -> f64 {
    LAYER * (2.0 * i as f64 + 1.0 - pairs as f64)
}

/// The bodies of a leg have their frames along the world's axes, at the joints that carry them.
fn add_leg(
    machine: &mut Object,
    name: &str,
    leg: &Leg,
    layer: f64,
    [hull, crank]: [BodyHandle; 2],
) {
    let mut link = |part: &str, parent: (BodyHandle, DVec2), at: DVec2, shapes: Vec<Shape>| {
        let body = machine.body(format!("{name}_{part}"));
        for shape in shapes {
            body.shape(shape);
        }
        let body = body.handle();
        let hinge = machine.revolute(format!("{name}_{part}"), body, DVec3::Z);
        let place = Pose::at((at - parent.1).extend(0.0));
        hinge.parent(parent.0).frames(place, Pose::IDENTITY);
        body
    };
    let Leg {
        pin,
        pivot,
        top,
        outer,
        knee,
        corner,
        tip,
    } = *leg;
    let bars = |at: DVec2, ends: &[[DVec2; 2]]| -> Vec<Shape> {
        ends.iter().map(|ends| bar(*ends, at, layer)).collect()
    };
    let center = DVec2::ZERO;
    let upper = bars(pivot, &[[pivot, top], [top, outer], [outer, pivot]]);
    let upper = link("upper", (hull, center), pivot, upper);
    let lower = bars(pivot, &[[pivot, knee]]);
    let lower = link("lower", (hull, center), pivot, lower);
    let mut foot = bars(knee, &[[knee, corner], [corner, tip], [tip, knee]]);
    let sole = STONE.shape(Geometry::Sphere { radius: SOLE });
    foot.push(sole.at(Pose::at((tip - knee).extend(layer))));
    let foot = link("foot", (lower, pivot), knee, foot);
    let strut = bars(outer, &[[outer, corner]]);
    let strut = link("strut", (upper, pivot), outer, strut);
    let high = link("high_rod", (crank, center), pin, bars(pin, &[[pin, top]]));
    let low = link("low_rod", (crank, center), pin, bars(pin, &[[pin, knee]]));
    let loops = [
        ("high", high, pin, upper, pivot, top),
        ("low", low, pin, lower, pivot, knee),
        ("strut", strut, outer, foot, knee, corner),
    ];
    for (what, rod, pin, link, pivot, at) in loops {
        let joint = machine.ball(format!("{name}_{what}_end"), rod);
        let [on_rod, on_link] = [pin, pivot].map(|origin| Pose::at((at - origin).extend(0.0)));
        joint.parent(link).frames(on_link, on_rod).closes_loop(true);
    }
}

/// A bar between two points, that touches nothing, seen from another.
fn bar(ends: [DVec2; 2], from: DVec2, layer: f64) -> Shape {
    let [one, other] = ends.map(|p| (p - from).extend(layer));
    let way = other - one;
    let radius = 0.012;
    let capsule = Geometry::Capsule {
        radius,
        half_height: 0.5 * way.length() + radius,
    };
    let turn = DQuat::from_rotation_arc(DVec3::Y, way.normalize());
    let place = Pose::new(0.5 * (one + other), turn);
    Shape::new(capsule).at(place).without_contact()
}
