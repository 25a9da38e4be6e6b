//! Conversions of orientations: there and back, in gimbal lock, and by composition.

use core::f64::consts::{FRAC_PI_2, PI};
use kinetarium_numbers::rotation::{EulerSequence, Frame, axis_angle_from_quat, quat_from_mat3};
use kinetarium_numbers::{Float, Mat3, Quat, Vec3};
use proptest::prelude::*;

const FRAMES: [Frame; 2] = [Frame::Intrinsic, Frame::Extrinsic];

fn quat<T: Float>(q: Quat<f64>) -> Quat<T> {
    Quat::new(
        T::from_f64(q.x),
        T::from_f64(q.y),
        T::from_f64(q.z),
        T::from_f64(q.w),
    )
}

/// Angle between two orientations [rad], accurate near zero.
fn apart<T: Float>(a: Quat<T>, b: Quat<T>) -> f64 {
    let wide = |q: Quat<T>| Quat::new(q.x.to_f64(), q.y.to_f64(), q.z.to_f64(), q.w.to_f64());
    axis_angle_from_quat(wide(a).conjugate() * wide(b)).1
}

/// The matrix of a rotation about one axis, from the textbook.
fn about(axis: usize, angle: f64) -> Mat3<f64> {
    let (s, c) = angle.sin_cos();
    let v = Vec3::new;
    match axis {
        0 => Mat3::from_columns(v(1.0, 0.0, 0.0), v(0.0, c, s), v(0.0, -s, c)),
        1 => Mat3::from_columns(v(c, 0.0, -s), v(0.0, 1.0, 0.0), v(s, 0.0, c)),
        _ => Mat3::from_columns(v(c, s, 0.0), v(-s, c, 0.0), v(0.0, 0.0, 1.0)),
    }
}

fn distance(a: Mat3<f64>, b: Mat3<f64>) -> f64 {
    (a.x - b.x)
        .length()
        .max((a.y - b.y).length())
        .max((a.z - b.z).length())
}

fn unit_quat() -> impl Strategy<Value = Quat<f64>> {
    let part = -1.0..1.0f64;
    (part.clone(), part.clone(), part.clone(), part)
        .prop_map(|(x, y, z, w)| Quat::new(x, y, z, w))
        .prop_filter("too short to normalise", |q| q.dot(*q) > 1e-3)
        .prop_map(Quat::normalized)
}

fn there_and_back<T: Float>(q: Quat<f64>, tolerance: f64) {
    let q = quat::<T>(q).normalized();
    assert!(
        apart(q, quat_from_mat3(q.to_mat3())) < tolerance,
        "matrix of {q:?}"
    );
    assert!(
        apart(q, Quat::exp(q.log())) < tolerance,
        "rotation vector of {q:?}"
    );
    let (axis, angle) = axis_angle_from_quat(q);
    assert!(
        apart(q, Quat::from_axis_angle(axis, angle)) < tolerance,
        "axis and angle of {q:?}"
    );
    assert!((0.0..=PI + tolerance).contains(&angle.to_f64()));
    for sequence in EulerSequence::ALL {
        for frame in FRAMES {
            let angles = sequence.from_quat(frame, q);
            let back = sequence.to_quat(frame, angles);
            let error = apart(q, back);
            assert!(
                error < tolerance,
                "{sequence:?} {frame:?} of {q:?}: {angles:?}, off by {error}"
            );
        }
    }
}

proptest! {
    #[test]
    fn round_trips(q in unit_quat()) {
        there_and_back::<f32>(q, 1e-5);
        there_and_back::<f64>(q, 1e-11);
    }

    #[test]
    fn angles_compose_the_rotations_about_the_axes(
        a in -PI..PI, b in -PI..PI, c in -PI..PI,
    ) {
        for sequence in EulerSequence::ALL {
            let [i, j, k] = sequence.axes();
            let (first, second, third) = (about(i, a), about(j, b), about(k, c));
            let intrinsic = sequence.to_quat(Frame::Intrinsic, [a, b, c]).to_mat3();
            let extrinsic = sequence.to_quat(Frame::Extrinsic, [a, b, c]).to_mat3();
            prop_assert!(distance(intrinsic, first * second * third) < 1e-14);
            prop_assert!(distance(extrinsic, third * second * first) < 1e-14);
        }
    }

    #[test]
    fn angles_are_found_again(a in -PI..PI, b in 0.01..3.13f64, c in -PI..PI) {
        for sequence in EulerSequence::ALL {
            let [i, _, k] = sequence.axes();
            let b = if i == k { b } else { b - FRAC_PI_2 };
            for frame in FRAMES {
                let found = sequence.from_quat(frame, sequence.to_quat(frame, [a, b, c]));
                for (found, given) in found.into_iter().zip([a, b, c]) {
                    let error = (found - given).abs();
                    prop_assert!(error < 1e-12 || (error - 2.0 * PI).abs() < 1e-12,
                        "{sequence:?} {frame:?}: {found} for {given}");
                }
            }
        }
    }

    #[test]
    fn gimbal_lock_zeroes_the_third_angle(a in -PI..PI, c in -PI..PI, high: bool) {
        for sequence in EulerSequence::ALL {
            let [i, _, k] = sequence.axes();
            let b = match (i == k, high) {
                (true, true) => PI,
                (true, false) => 0.0,
                (false, true) => FRAC_PI_2,
                (false, false) => -FRAC_PI_2,
            };
            for frame in FRAMES {
                let q = sequence.to_quat(frame, [a, b, c]);
                let found = sequence.from_quat(frame, q);
                prop_assert!((found[1] - b).abs() < 1e-14);
                prop_assert!(found[2].abs() < 1e-14, "{sequence:?} {frame:?}: {found:?}");
                prop_assert!(apart(q, sequence.to_quat(frame, found)) < 1e-11);
                there_and_back::<f32>(q, 1e-5);
            }
        }
    }
}

#[test]
fn half_turns_choose_every_divisor() {
    for q in [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ] {
        let q = Quat::new(q[0], q[1], q[2], q[3]);
        assert_eq!(quat_from_mat3(q.to_mat3()), q);
        there_and_back::<f64>(q, 1e-11);
        there_and_back::<f32>(q, 1e-5);
    }
}

#[test]
fn small_rotations_keep_their_digits() {
    for angle in [0.0, 1e-20, 1e-10, 1e-6, 1e-4, 1e-3, 1e-2] {
        let r = Vec3::new(0.6, 0.0, -0.8) * angle;
        assert!(
            (Quat::exp(r).log() - r).length() <= 1e-13 * angle,
            "{angle}"
        );
    }
    assert_eq!(
        axis_angle_from_quat(Quat::<f64>::identity()),
        (Vec3::new(1.0, 0.0, 0.0), 0.0)
    );
}

#[test]
fn sequences_have_names() {
    assert_eq!(EulerSequence::from_name("xyz"), Some(EulerSequence::Xyz));
    assert_eq!(EulerSequence::from_name("ZXZ"), Some(EulerSequence::Zxz));
    assert_eq!(EulerSequence::from_name("xxy"), None);
}
