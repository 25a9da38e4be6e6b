//! Bad input is refused with a typed error that says what to do, and changes nothing.

use glam::{DVec3, Vec3};
use kinetarium_space::{Aabb, Bvh, Cast, Space, SpaceError};

const UNIT: Aabb = Aabb::new(Vec3::ZERO, Vec3::ONE);
const NAN: Aabb = Aabb::new(Vec3::ZERO, Vec3::new(1.0, f32::NAN, 1.0));
const INSIDE_OUT: Aabb = Aabb::new(Vec3::ONE, Vec3::ZERO);

#[test]
fn a_nan_is_named_with_its_object_and_remedy() {
    let error = Space::<Bvh>::new(&[UNIT, UNIT, NAN]).unwrap_err();
    assert!(matches!(error, SpaceError::NotANumber { object: 2, .. }));
    let text = error.to_string();
    assert!(
        text.contains("object 2") && text.contains("NaN") && text.contains("check"),
        "{text}"
    );
}

#[test]
fn an_inside_out_box_is_refused() {
    let error = Space::<Bvh>::new(&[UNIT, INSIDE_OUT]).unwrap_err();
    assert!(matches!(error, SpaceError::InsideOut { object: 1, .. }));
}

#[test]
fn refused_changes_change_nothing() {
    let mut space = Space::<Bvh>::new(&[UNIT, UNIT]).unwrap();
    assert!(matches!(
        space.update(&[UNIT, NAN]),
        Err(SpaceError::NotANumber { object: 1, .. })
    ));
    assert!(matches!(
        space.update(&[UNIT]),
        Err(SpaceError::Count {
            given: 1,
            expected: 2
        })
    ));
    assert!(matches!(
        space.insert(NAN),
        Err(SpaceError::NotANumber { object: 2, .. })
    ));
    assert!(matches!(
        space.relocate(1, INSIDE_OUT),
        Err(SpaceError::InsideOut { object: 1, .. })
    ));
    assert!(matches!(
        space.relocate(2, UNIT),
        Err(SpaceError::NoSuchObject { object: 2 })
    ));
    assert!(matches!(
        space.remove(7),
        Err(SpaceError::NoSuchObject { object: 7 })
    ));
    assert_eq!(space.boxes().all(), [UNIT, UNIT]);
    assert_eq!(space.pairs().len(), 1);
}

#[test]
fn a_removed_object_is_gone_and_its_index_is_used_again() {
    let mut space = Space::<Bvh>::new(&[UNIT, UNIT]).unwrap();
    space.remove(0).unwrap();
    assert!(matches!(
        space.remove(0),
        Err(SpaceError::NoSuchObject { object: 0 })
    ));
    // What an update says of it is not even read.
    space.update(&[NAN, UNIT]).unwrap();
    assert_eq!(space.overlap(&UNIT), [1]);
    assert_eq!(space.insert(UNIT).unwrap(), 0);
    assert_eq!(space.overlap(&UNIT), [0, 1]);
}

#[test]
fn senseless_casts_are_refused() {
    let refused = |o, d| matches!(Cast::ray(o, d), Err(SpaceError::Query { .. }));
    assert!(refused(Vec3::NAN, Vec3::X));
    assert!(refused(Vec3::new(0.0, f32::INFINITY, 0.0), Vec3::X));
    assert!(refused(Vec3::ZERO, Vec3::ZERO));
    assert!(refused(Vec3::ZERO, Vec3::new(1.0, f32::NAN, 0.0)));
    assert!(refused(Vec3::ZERO, Vec3::splat(f32::INFINITY)));
    assert!(Cast::sphere(Vec3::ZERO, -1.0, Vec3::X).is_err());
    assert!(Cast::sphere(Vec3::ZERO, f32::NAN, Vec3::X).is_err());
}

#[test]
fn nothing_is_near_a_point_that_is_nowhere() {
    let space = Space::<Bvh>::new(&[UNIT]).unwrap();
    for point in [Vec3::NAN, Vec3::INFINITY, Vec3::splat(1e20)] {
        assert!(
            space
                .nearest(point, 3, f32::INFINITY, space.boxes())
                .is_empty()
        );
    }
    assert!(space.nearest(Vec3::ZERO, 0, 1.0, space.boxes()).is_empty());
    assert!(space.nearest(Vec3::ZERO, 1, -1.0, space.boxes()).is_empty());
    assert!(space.overlap(&NAN).is_empty());
}

#[test]
fn a_box_in_double_precision_lies_within_its_enclosing_one() {
    let (min, max) = (DVec3::splat(0.1), DVec3::splat(0.7));
    let aabb = Aabb::enclosing(min, max);
    assert!(aabb.min.as_dvec3().cmple(min).all() && aabb.max.as_dvec3().cmpge(max).all());
    assert!((aabb.max - aabb.min).max_element() < 0.600_001);
}
