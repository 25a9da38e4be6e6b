//! A prismatic joint.

use super::stuff::{PLAIN, WOOD};
use crate::{Builder, Drive, Geometry, Limit, Model, ModelError, Pose};
use glam::DVec3;

/// A carriage of 2 kg on a rail of 2 m along x, whose motor holds it at a position, like a printer's.
///
/// To see: the carriage follows its target as a mass on a spring and a damper does: a stiffness of
/// 200 N/m and a damping of 40 N·s/m are critical, k = c²/4m, less damping overshoots.
///
/// # Errors
/// None.
pub fn prismatic() -> Result<Model, ModelError> {
    const RAIL: f64 = 1.0;
    let mut world = Builder::new("prismatic");
    let machine = world.object("machine");
    let rail = Geometry::Cylinder {
        radius: 0.015,
        half_height: RAIL + 0.15,
    };
    let lying = glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    for z in [-0.06, 0.06] {
        let at = Pose::new(DVec3::new(0.0, 0.3, z), lying);
        machine.scenery(PLAIN.shape(rail.clone()).at(at).without_contact());
    }
    for x in [-RAIL - 0.15, RAIL + 0.15] {
        let half = DVec3::new(0.03, 0.17, 0.12);
        let post = WOOD.shape(Geometry::Box { half });
        let at = Pose::at(DVec3::new(x, 0.17, 0.0));
        machine.scenery(post.at(at).without_contact());
    }
    let half = DVec3::new(0.12, 0.07, 0.12);
    let carriage = machine
        .body("carriage")
        .shape(WOOD.shape(Geometry::Box { half }).without_contact())
        .mass(2.0)
        .handle();
    let rail = Pose::at(DVec3::new(0.0, 0.3, 0.0));
    let slider = machine.prismatic("slider", carriage, DVec3::X);
    slider.frames(rail, Pose::IDENTITY).initial(&[-0.6]);
    slider.drive(Drive {
        stiffness: 200.0,
        damping: 10.0,
        target_position: 0.5,
        ..Drive::default()
    });
    slider.limit(Limit {
        lower: -RAIL,
        upper: RAIL,
        stiffness: 2e4,
        damping: 400.0,
        inertia: 0.0,
    });
    world.build()
}
