//! Bowls, and a heap of any size in one.

use super::countable;
use super::stuff::{PLAIN, Stuff};
use crate::{Builder, Geometry, Model, ModelError, Object, Pose};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_4, TAU};

/// From one solid to the next [m]: no two touch, however they are turned.
const SPACING: f64 = 0.12;
/// Half the thickness of the bowl [m].
const THICK: f64 = 0.1;

/// Spheres, boxes, capsules and cylinders of about 5 cm, in turn, each a little different, in a loose
/// cube of a grid above a bowl of 16 slopes about a flat bottom, as wide as the grid.
///
/// To see: they fall, slide down the slopes, and come to rest in a heap. None gets out.
///
/// # Errors
/// If there are none, or more than a million.
pub fn bowl(count: usize) -> Result<Model, ModelError> {
    countable("bowl", "number of solids", count)?;
    let mut world = Builder::new(format!("bowl_{count}"));
    let side = (count as f64).cbrt().ceil() as usize;
    let width = SPACING * side as f64;
    let rim = ground(world.object("ground"), width);
    let solids = world.object("solids");
    let corner = DVec3::new(-0.5 * width, rim, -0.5 * width);
    for i in 0..count {
        let cell = [i % side, i / (side * side), i / side % side];
        let place = corner + SPACING * (DVec3::from_array(cell.map(|n| n as f64)) + 0.5);
        let axis = DVec3::new(fraction(i, 3), fraction(i, 4), 1.0).normalize();
        let turn = DQuat::from_axis_angle(axis, TAU * fraction(i, 5));
        solids
            .body(format!("solid_{i}"))
            .at(Pose::new(place, turn))
            .shape(PLAIN.shape(solid(i)));
    }
    world.build()
}

/// The i-th solid, from four fifths to six fifths of 5 cm across.
fn solid(i: usize) -> Geometry {
    let [a, b, c] = [0, 1, 2].map(|which| 0.025 * (0.8 + 0.4 * fraction(i, which)));
    match i % 4 {
        0 => Geometry::Sphere { radius: a },
        1 => Geometry::Box {
            half: DVec3::new(a, b, c),
        },
        2 => Geometry::Capsule {
            radius: 0.7 * a,
            half_height: 1.5 * b,
        },
        _ => Geometry::Cylinder {
            radius: a,
            half_height: b,
        },
    }
}

/// A number from 0 to 1 that differs from solid to solid: multiples of an irrational number, modulo 1,
/// another one for each use.
fn fraction(i: usize, which: i32) -> f64 {
    const ROOTS: f64 = 1.220_744_084_605_759_5;
    ((i + 1) as f64 / ROOTS.powi(which + 1)).fract()
}

/// The bowl below a square of a width [m]; returns the height of its rim [m].
fn ground(object: &mut Object, width: f64) -> f64 {
    let inner = 0.25 * width;
    // The rim is outside of the square's corners.
    let outer = std::f64::consts::FRAC_1_SQRT_2 * width + SPACING;
    let half_length = (outer - inner) * FRAC_PI_4.cos().recip() / 2.0;
    // Each slope reaches its neighbours at the rim; lower down they overlap, outside of the bowl.
    let half_width = 1.1 * outer * (TAU / 32.0).tan();
    let bottom = DVec3::new(outer, THICK, outer);
    let bottom = PLAIN
        .shape(Geometry::Box { half: bottom })
        .at(Pose::at(DVec3::Y * -THICK));
    object.scenery(bottom.named("bottom"));
    let walls = Slopes {
        sides: 16,
        inner,
        tilt: FRAC_PI_4,
        half: DVec3::new(half_length, THICK, half_width),
    };
    slopes(object, &walls, PLAIN);
    outer - inner
}

/// Boxes that rise outwards from a floor at y = 0, all around.
pub(super) struct Slopes {
    /// How many.
    pub sides: u32,
    /// Distance of their upper faces' lower edges from the middle [m].
    pub inner: f64,
    /// Angle with the floor [rad].
    pub tilt: f64,
    /// Half sizes of each [m]: along its slope, thickness, across.
    pub half: DVec3,
}

/// Puts slopes about the origin.
pub(super) fn slopes(ground: &mut Object, slopes: &Slopes, stuff: Stuff) {
    let half = slopes.half;
    for side in 0..slopes.sides {
        let around = DQuat::from_rotation_y(TAU / f64::from(slopes.sides) * f64::from(side));
        let tilt = DQuat::from_rotation_z(slopes.tilt);
        // The upper face's inner edge lies on the floor.
        let middle = DVec3::X * slopes.inner - tilt * DVec3::new(-half.x, half.y, 0.0);
        let wall = stuff
            .shape(Geometry::Box { half })
            .at(Pose::new(around * middle, around * tilt));
        ground.scenery(wall.named(format!("slope_{side}")));
    }
}

#[cfg(test)]
mod tests {
    use super::super::overlap::nothing_overlaps;
    use super::*;

    #[test]
    fn as_many_solids_of_four_kinds_hang_apart_above_the_bowl() {
        for count in [10, 100, 1000] {
            let model = bowl(count).unwrap();
            assert_eq!(model.bodies.len(), count);
            assert_eq!(model.shapes.len(), count + 17);
            nothing_overlaps(&model);
        }
        let model = bowl(1000).unwrap();
        let masses = model.bodies.iter().map(|b| b.mass);
        let (least, most) = masses.fold((f64::MAX, 0.0_f64), |(a, b), m| (a.min(m), b.max(m)));
        assert!(least > 0.02 && most < 0.25, "{least} to {most} kg");
    }

    #[test]
    fn nothing_can_fall_beside_the_bowl() {
        let model = bowl(1000).unwrap();
        let walls: Vec<_> = model.shapes.iter().filter(|s| s.body.is_none()).collect();
        for body in &model.bodies {
            let below = walls.iter().any(|wall| {
                let Geometry::Box { half } = wall.geometry else {
                    unreachable!("the bowl is made of boxes")
                };
                // The foot on the wall's upper face, along the vertical.
                let up = wall.pose.direction(DVec3::Y);
                let face = wall.pose.point(DVec3::Y * half.y);
                let fall = up.dot(body.pose.position - face) / up.y;
                let foot = body.pose.position - DVec3::Y * fall;
                let local = wall.pose.inverse().point(foot).abs();
                fall > 0.0 && local.x <= half.x && local.z <= half.z
            });
            assert!(below, "{}", body.name);
        }
    }
}
