//! Casts and neighbours against shapes that are no boxes, and casts against boxes
//! against the definition.

use glam::{DVec3, Vec3};
use kinetarium_space::{Aabb, Bvh, Cast, Space};
use proptest::prelude::*;

fn vector(most: f32) -> impl Strategy<Value = Vec3> {
    [-most..most, -most..most, -most..most].prop_map(Vec3::from_array)
}

fn ball() -> impl Strategy<Value = (Vec3, f32)> {
    (vector(5.0), 0.0..1.0_f32)
}

/// When a ball of radius `r` more meets one that rests: |o + t d − c|² = (R + r)².
fn meets(cast: &Cast, more: f32, (center, radius): (Vec3, f32)) -> Option<f32> {
    let (m, d) = (cast.origin() - center, cast.direction());
    let reach = radius + more;
    let (a, b, c) = (d.dot(d), m.dot(d), m.dot(m) - reach * reach);
    if c <= 0.0 {
        return Some(0.0);
    }
    let root = (b * b - a * c).sqrt();
    (b < 0.0 && root >= 0.0).then(|| (-b - root) / a)
}

proptest! {
    /// A sphere cast among balls: the structure's candidates hold the answer of brute force.
    #[test]
    fn balls_are_hit_as_by_brute_force(
        balls in prop::collection::vec(ball(), 0..100),
        (origin, direction, radius) in (vector(6.0), vector(1.0), 0.0..1.0_f32),
    ) {
        prop_assume!(direction.length() > 0.01);
        let boxes: Vec<Aabb> = balls.iter().map(|(c, r)| Aabb::around(*c, Vec3::splat(r + 1e-5))).collect();
        let space = Space::<Bvh>::new(&boxes).unwrap();
        let cast = Cast::sphere(origin, radius, direction).unwrap();
        let test = |i: u32, cast: &Cast, limit: f32| meets(cast, radius, balls[i as usize]).filter(|t| *t <= limit);

        let times = (0..balls.len()).filter_map(|i| Some((meets(&cast, radius, balls[i])?, i as u32)));
        let first = times.min_by(|x, y| x.partial_cmp(y).unwrap());
        let hit = space.cast(&cast, &test);
        prop_assert_eq!(hit.map(|h| (h.time, h.object)), first);
    }

    /// The nearest of many balls.
    #[test]
    fn balls_are_near_as_by_brute_force(balls in prop::collection::vec(ball(), 0..100), point in vector(6.0)) {
        let boxes: Vec<Aabb> = balls.iter().map(|(c, r)| Aabb::around(*c, Vec3::splat(r + 1e-5))).collect();
        let space = Space::<Bvh>::new(&boxes).unwrap();
        let closest = |i: u32, p: Vec3| {
            let (center, radius) = balls[i as usize];
            center + (p - center).clamp_length_max(radius)
        };
        let squares = (0..balls.len()).map(|i| closest(i as u32, point).distance_squared(point));
        let least = squares.min_by(f32::total_cmp);
        let near = space.closest(point, f32::INFINITY, &closest);
        prop_assert_eq!(near.map(|n| n.distance_squared), least);
    }

    /// At the time of a hit the moving box touches the resting one, and before it does not.
    #[test]
    fn a_hit_is_the_first_touch(
        (center, half, origin, grown) in (vector(2.0), vector(1.0), vector(6.0), vector(0.5)),
        direction in vector(1.0),
    ) {
        prop_assume!(direction.length() > 0.1);
        let (half, grown) = (half.abs(), grown.abs());
        let cast = Cast::aabb(origin, grown, direction).unwrap();
        let apart = |t: f64| {
            let at = origin.as_dvec3() + t * direction.as_dvec3();
            let gap = (at - center.as_dvec3()).abs() - (half + grown).as_dvec3();
            gap.max(DVec3::ZERO).max_element()
        };
        match cast.against(&Aabb::around(center, half), f32::MAX) {
            Some(time) => {
                prop_assert!(apart(time.into()) < 1e-4);
                for share in [0.0, 0.5, 0.9, 0.99] {
                    prop_assert!(time == 0.0 || apart(share * f64::from(time)) > 0.0);
                }
            }
            None => {
                for i in 0..1000 {
                    prop_assert!(apart(f64::from(i) * 0.2) > 0.0);
                }
            }
        }
    }
}
