//! Small random differences between the worlds.

use fastrand::Rng;
use glam::{DQuat, DVec3};
use model::{JointKind, Model};

/// Joint positions that differ from the given ones by up to `size` [rad or m] each; balls and
/// free joints turn by up to `size` about each axis.
pub fn perturb(model: &Model, position: &[f64], size: f64, rng: &mut Rng) -> Vec<f64> {
    let mut next = || size * (2.0 * rng.f64() - 1.0);
    let mut moved = position.to_vec();
    let mut start = 0;
    for joint in &model.joints {
        let q = &mut moved[start..start + joint.coordinates()];
        start += joint.coordinates();
        match (joint.kind, q) {
            (JointKind::Ball, q) => turn(q, &mut next),
            (JointKind::Free, [x, y, z, q @ ..]) => {
                for p in [x, y, z] {
                    *p += next();
                }
                turn(q, &mut next);
            }
            (_, q) => q.iter_mut().for_each(|q| *q += next()),
        }
    }
    moved
}

fn turn(q: &mut [f64], next: &mut impl FnMut() -> f64) {
    // A joint that closes a loop has no coordinates.
    if q.is_empty() {
        return;
    }
    let turned =
        DQuat::from_slice(q) * DQuat::from_scaled_axis(DVec3::from_array([(); 3].map(|()| next())));
    q.copy_from_slice(&turned.to_array());
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::n_pendula;

    #[test]
    fn positions_move_by_up_to_the_size_and_the_seed_repeats_them() {
        let model = n_pendula(50).unwrap();
        let start = model.initial_position();
        let draw = |seed| perturb(&model, &start, 0.1, &mut Rng::with_seed(seed));
        let moved = draw(3);
        let largest = moved
            .iter()
            .zip(&start)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!((0.05..=0.1).contains(&largest), "{largest}");
        assert_eq!(moved, draw(3));
        assert_ne!(moved, draw(4));
    }

    #[test]
    fn orientations_stay_unit_quaternions() {
        let mut world = model::Builder::new("one");
        world
            .object("ball")
            .body("body")
            .inertia(1.0, DVec3::ZERO, glam::DMat3::IDENTITY);
        let model = world.build().unwrap();
        let start = model.initial_position();
        let moved = perturb(&model, &start, 0.3, &mut Rng::with_seed(1));
        assert_eq!(moved.len(), 7);
        assert!((DQuat::from_slice(&moved[3..]).length() - 1.0).abs() < 1e-12);
        assert!(moved.iter().zip(&start).all(|(a, b)| a != b));
    }
}
