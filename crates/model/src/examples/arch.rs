//! An arch of stones.

use super::stuff::{STONE, floor};
use crate::model::Subject;
use crate::{Builder, Geometry, Hull, Model, ModelError, Pose};
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Inner and outer radius [m].
const RADII: [f64; 2] = [0.42, 0.58];
/// Half of its width [m].
const HALF_WIDTH: f64 = 0.1;

/// A half circle of equal wedges of stone, a metre wide, that stand on the floor and on each other.
///
/// A round arch stands if its thickness is at least 0.1075 of its mean radius (Milankovitch, Theorie
/// der Druckkurven, 1907): the line of thrust then fits into it. This one has 0.32.
///
/// To see: nothing. The arch stands, without mortar.
///
/// # Errors
/// Fewer than three stones, or more than a thousand.
pub fn arch(stones: usize) -> Result<Model, ModelError> {
    let subject = Subject {
        kind: "arch",
        name: "",
    };
    subject.within("number of stones", stones as f64, 3.0, 1000.0)?;
    let angle = PI / stones as f64;
    let stone = Hull::new(&corners(angle))?;
    let mut world = Builder::new(format!("arch_{stones}"));
    world.time_step(0.002);
    floor(world.object("ground"), STONE);
    let arch = world.object("arch");
    for i in 0..stones {
        let turn = DQuat::from_rotation_z((i as f64 + 0.5) * angle - FRAC_PI_2);
        arch.body(format!("stone_{i}"))
            .at(Pose::new(turn * DVec3::Y * stone.center().y, turn))
            .shape(
                STONE
                    .shape(Geometry::Hull(stone.clone()))
                    .at(Pose::at(-stone.center())),
            );
    }
    world.build()
}

/// Of the stone at the top that spans an angle [rad], from the middle of the arch.
fn corners(angle: f64) -> Vec<DVec3> {
    let mut corners = Vec::new();
    for radius in RADII {
        for turn in [-0.5 * angle, 0.5 * angle] {
            let (x, y) = (radius * turn.sin(), radius * turn.cos());
            corners.extend([-HALF_WIDTH, HALF_WIDTH].map(|z| DVec3::new(x, y, z)));
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All stones weigh what their prisms do: sin α (R² − r²)/2 · width for the angle α.
    #[test]
    fn stones_are_equal_wedges() {
        let model = arch(9).unwrap();
        let [r, outer] = RADII;
        let area = 0.5 * (PI / 9.0).sin() * (outer * outer - r * r);
        let mass = STONE.density * area * 2.0 * HALF_WIDTH;
        for body in &model.bodies {
            assert!((body.mass / mass - 1.0).abs() < 1e-12, "{}", body.mass);
            assert!(body.center.length() < 1e-12);
        }
        assert!(arch(2).is_err() && arch(1001).is_err());
    }
}
