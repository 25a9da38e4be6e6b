//! How far shapes have moved, for how long two of them stay apart.
//!
//! Shapes that are apart by a length cannot touch before their points have moved as far, both together. (Mirtich 1996,
//! "Impulse-based dynamic simulation of rigid body systems", bounds the time of impact by the same.) Where a shape
//! goes from p, q to p', q', none of its points, which are within R of p, moves farther than
//!
//! ```text
//! |p' − p| + 2 R sin(θ/2),     sin(θ/2) = d √(1 − d²/4),     d = |q' − q| = 2 sin(θ/4).
//! ```

use collide::kind;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::Impulse;
use rigid::impulse::pair::{Placed, placed};

/// Position and orientation.
pub(super) type Place = [f64; 7];

/// The way of each colliding shape.
#[derive(Debug, Default)]
pub(super) struct Odometers {
    places: Vec<Place>,
    ways: Vec<f64>,
}

impl Odometers {
    /// Takes note of where the shapes are now; a thread takes so many as a part at a time.
    pub fn advance<T: Float>(
        &mut self,
        impulse: &Impulse,
        shapes: &[Placed<T>],
        parameters: &[T],
        part: usize,
    ) {
        if self.places.len() != shapes.len() {
            self.places = shapes.iter().map(place).collect();
            self.ways = vec![0.0; shapes.len()];
        }
        let all = self.places.par_iter_mut().zip(&mut self.ways).zip(shapes);
        let all = all.with_min_len(part).enumerate();
        all.for_each(|(i, ((before, way), shape))| {
            let now = place(shape);
            if now != *before {
                let radius = if impulse.shapes()[i].kind == kind::PLANE {
                    f64::INFINITY
                } else {
                    impulse.radius_of(i, parameters).to_f64()
                };
                *way += moved(before, &now, radius);
                *before = now;
            }
        });
    }

    /// How far each shape's points have moved at most [m], step by step.
    pub fn ways(&self) -> &[f64] {
        &self.ways
    }
}

fn place<T: Float>(shape: &Placed<T>) -> Place {
    let numbers = &shape.placed[placed::POSITION..][..7];
    std::array::from_fn(|i| numbers[i].to_f64())
}

/// How far a point within `radius` of a centre moves at most [m].
pub(super) fn moved(from: &Place, to: &Place, radius: f64) -> f64 {
    let square = |i: usize| (to[i] - from[i]).powi(2);
    let shift = (square(0) + square(1) + square(2)).sqrt();
    let d_squared = square(3) + square(4) + square(5) + square(6);
    let sine = (d_squared * (1.0 - 0.25 * d_squared).max(0.0)).sqrt();
    // What only shifts stays in its place, were it without end.
    if sine > 0.0 {
        shift + 2.0 * radius * sine
    } else {
        shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    #[test]
    fn no_point_moves_farther_than_is_counted() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut vector = || DVec3::from_array([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        for _ in 0..1000 {
            let [p, q] = [vector(), vector()];
            let turns = [vector(), vector()].map(|v| DQuat::from_scaled_axis(3.0 * v));
            let place = |p: DVec3, q: DQuat| {
                let [x, y, z] = p.to_array();
                let [i, j, k, w] = q.to_array();
                [x, y, z, i, j, k, w]
            };
            let bound = moved(&place(p, turns[0]), &place(q, turns[1]), 0.7);
            for _ in 0..20 {
                let arm = 0.7 * vector().normalize();
                let way = (q + turns[1] * arm) - (p + turns[0] * arm);
                assert!(way.length() <= bound + 1e-12);
            }
        }
    }
}
