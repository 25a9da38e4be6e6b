//! Where the tip of a chain is after one second.

use crate::common::*;
use glam::DVec3;
use model::{BodyId, Builder, Model, Pose};
use numbers::Float;

const LINKS: usize = 30;
const LINK_LENGTH: f64 = 0.2;
const STEP: f64 = 2e-3;

/// 30 uniform rods of 1 kg and 0.2 m (radius 2 cm, which only spins about the rod's axis would
/// show) on hinges about z, lying along x: the chain of `benches/peers`, with y for its z.
fn rods() -> Model {
    let (along, across) = (0.02_f64.powi(2) / 2.0, LINK_LENGTH.powi(2) / 12.0);
    let center = DVec3::new(LINK_LENGTH / 2.0, 0.0, 0.0);
    let mut world = Builder::new("rods");
    let object = world.object("");
    let mut parent = None;
    for i in 0..LINKS {
        let rod = body(
            object,
            &format!("rod{i}"),
            1.0,
            center,
            DVec3::new(along, across, across),
        );
        let hinge = object.revolute(format!("hinge{i}"), rod, DVec3::Z);
        if let Some(parent) = parent {
            let end = Pose::at(DVec3::new(LINK_LENGTH, 0.0, 0.0));
            hinge.parent(parent).frames(end, Pose::IDENTITY);
        }
        parent = Some(rod);
    }
    world.build().unwrap()
}

/// Where MuJoCo 4.0 has the tip after 1 s, by Runge–Kutta 4 with steps of 20 µs [m].
const MUJOCO: [f64; 3] = [2.547387970382243, -4.910142935493617, 0.0];

/// Tip after 1 s [m].
fn tip<T: Float>(method: Method, h: f64) -> DVec3 {
    let mut simulation = method.simulate::<T>(&rods(), h);
    simulation.step((1.0 / h).round() as usize);
    let last = simulation.outputs().body_pose(0, BodyId(LINKS - 1));
    last.point(DVec3::new(LINK_LENGTH, 0.0, 0.0))
}

#[test]
fn tip_of_a_falling_chain() {
    let reference = tip::<f64>(RK4, STEP / 20.0);
    // Both have errors of order h⁴, far below a micrometre.
    near("reference", reference, DVec3::from_array(MUJOCO), 1e-7);
    near(
        "xpbd, 4 substeps",
        tip::<f32>(Method::Xpbd(4), STEP),
        reference,
        0.015,
    );
    near("Runge–Kutta", tip::<f32>(RK4, STEP), reference, 2e-5);
}
