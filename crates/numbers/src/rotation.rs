//! Conversions between the ways to write an orientation.
//!
//! | from | to a quaternion | back |
//! |---|---|---|
//! | rotation matrix | [`quat_from_mat3`] | [`Quat::to_mat3`] |
//! | axis and angle | [`Quat::from_axis_angle`] | [`axis_angle_from_quat`] |
//! | rotation vector | [`Quat::exp`] | [`Quat::log`] |
//! | Euler angles | [`EulerSequence::to_quat`] | [`EulerSequence::from_quat`] |
//!
//! Quaternions are unit quaternions; q and −q are the same orientation. The numbers
//! are computed without branches; only the choice of a sequence branches.

use crate::{Float, Mat3, Quat, Real, Vec3, functions};

/// The quaternion of a rotation matrix.
///
/// Shepperd, "Quaternion from Rotation Matrix" (1978): of 4 w², 4 x², 4 y² and 4 z²,
/// which follow from the diagonal, the largest is the divisor. A matrix that is
/// slightly off a rotation gives a unit quaternion nearby.
#[inline(always)]
pub fn quat_from_mat3<R: Real>(m: Mat3<R>) -> Quat<R> {
    let (x, y, z) = (m.x, m.y, m.z);
    let one = R::one();
    let xx = one + x.x - y.y - z.z;
    let yy = one - x.x + y.y - z.z;
    let zz = one - x.x - y.y + z.z;
    let ww = one + x.x + y.y + z.z;
    let (xy, xz, yz) = (x.y + y.x, x.z + z.x, y.z + z.y);
    let (xw, yw, zw) = (y.z - z.y, z.x - x.z, x.y - y.x);

    // Each is the quaternion times four times one of its components.
    let by_x = Quat::new(xx, xy, xz, xw);
    let by_y = Quat::new(xy, yy, yz, yw);
    let by_z = Quat::new(xz, yz, zz, zw);
    let by_w = Quat::new(xw, yw, zw, ww);
    let larger_xy = Quat::select(xx.lt(yy), by_y, by_x);
    let larger_zw = Quat::select(zz.lt(ww), by_w, by_z);
    Quat::select(xx.max(yy).lt(zz.max(ww)), larger_zw, larger_xy).normalized()
}

/// Unit axis, and angle in [0, π] (rad). Without a rotation the axis is x.
#[inline(always)]
pub fn axis_angle_from_quat<R: Real>(q: Quat<R>) -> (Vec3<R>, R) {
    let v = Vec3::select(q.w.lt(R::zero()), -q.vector(), q.vector());
    let angle = R::lit(2.0) * functions::atan2(v.length(), q.w.abs());
    let x = Vec3::new(R::one(), R::zero(), R::zero());
    (v.normalized_or(x), angle)
}

/// Whose axes the three rotations of Euler angles turn about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Frame {
    /// The axes of the body, which turn with it.
    Intrinsic,
    /// The axes of the outer frame, which stay.
    Extrinsic,
}

macro_rules! sequences {
    ($($name:ident: $axes:expr;)+) => {
        /// The axes of the first, second and third rotation.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[allow(missing_docs)]
        pub enum EulerSequence {
            $($name,)+
        }

        impl EulerSequence {
            /// All twelve.
            pub const ALL: [Self; 12] = [$(Self::$name,)+];

            /// The axes: 0 for x, 1 for y, 2 for z.
            pub fn axes(self) -> [usize; 3] {
                match self {
                    $(Self::$name => $axes,)+
                }
            }

            /// By its name, as "xyz" or "ZXZ".
            pub fn from_name(name: &str) -> Option<Self> {
                [$((stringify!($name), Self::$name),)+]
                    .into_iter()
                    .find(|(known, _)| known.eq_ignore_ascii_case(name))
                    .map(|(_, sequence)| sequence)
            }
        }
    };
}

sequences! {
    Xyz: [0, 1, 2];
    Xzy: [0, 2, 1];
    Yxz: [1, 0, 2];
    Yzx: [1, 2, 0];
    Zxy: [2, 0, 1];
    Zyx: [2, 1, 0];
    Xyx: [0, 1, 0];
    Xzx: [0, 2, 0];
    Yxy: [1, 0, 1];
    Yzy: [1, 2, 1];
    Zxz: [2, 0, 2];
    Zyz: [2, 1, 2];
}

impl EulerSequence {
    /// The orientation after rotations by `angles` (rad) about the axes in order.
    #[inline(always)]
    pub fn to_quat<R: Real>(self, frame: Frame, angles: [R; 3]) -> Quat<R> {
        let mut q = Quat::identity();
        for (axis, angle) in self.axes().into_iter().zip(angles) {
            let mut unit = [R::zero(); 3];
            unit[axis] = R::one();
            let turn = Quat::from_axis_angle(Vec3::from_array(unit), angle);
            q = match frame {
                Frame::Intrinsic => q * turn,
                Frame::Extrinsic => turn * q,
            };
        }
        q
    }

    /// The angles (rad) of an orientation: first and third in [−π, π], second in
    /// [0, π] if the first and third axis are the same, else in [−π/2, π/2].
    ///
    /// In gimbal lock, where the first and third axis are parallel and only the
    /// combination of their angles is determined, the third angle is zero. That is
    /// within 2e-6 rad (`f32`) or 2e-12 rad (`f64`) of an end of the second range.
    ///
    /// Bernardes & Viollet, "Quaternion to Euler angles conversion: a direct,
    /// general and computationally efficient method" (2022), algorithm 1, for
    /// extrinsic angles; intrinsic ones are those of the reversed sequence.
    #[inline(always)]
    pub fn from_quat<R: Real>(self, frame: Frame, q: Quat<R>) -> [R; 3] {
        let [mut i, j, mut k] = self.axes();
        if frame == Frame::Intrinsic {
            core::mem::swap(&mut i, &mut k);
        }
        let proper = i == k;
        if proper {
            k = 3 - i - j;
        }
        let even = (i + 1) % 3 == j; // (i, j, k) is an even permutation of (x, y, z)
        let sign = R::lit(if even { 1.0 } else { -1.0 });

        // A sequence of three axes is one of two, turned by π/2 about the second.
        let v = q.vector().to_array();
        let (qi, qj, qk) = (v[i], v[j], v[k] * sign);
        let (a, b, c, d) = if proper {
            (q.w, qi, qj, qk)
        } else {
            (q.w - qj, qi + qk, qj + q.w, qk - qi)
        };
        let (ab, cd) = (a.fma(a, b * b).sqrt(), c.fma(c, d * d).sqrt());
        let second = R::lit(2.0) * functions::atan2(cd, ab);

        // Half the sum and half the difference of the outer angles; one of them is free in lock.
        let (sum, difference) = (functions::atan2(b, a), functions::atan2(d, c));
        let near = R::lit(if R::Scalar::DOUBLE { 1e-12 } else { 1e-6 });
        let third_is_zero = match frame {
            Frame::Extrinsic => -R::one(),
            Frame::Intrinsic => R::one(),
        };
        let low = cd.lt(ab * near);
        let high = ab.lt(cd * near);
        let sum_in_lock = difference * third_is_zero;
        let difference = R::select(low, sum * third_is_zero, difference);
        let sum = R::select(high, sum_in_lock, sum);

        let (one, other) = (sum - difference, sum + difference);
        let (other, second) = if proper {
            (other, second)
        } else {
            (other * sign, second - R::lit(core::f64::consts::FRAC_PI_2))
        };
        match frame {
            Frame::Extrinsic => [wrap(one), second, wrap(other)],
            Frame::Intrinsic => [wrap(other), second, wrap(one)],
        }
    }
}

/// The same angle (rad) within [−π, π].
#[inline(always)]
fn wrap<R: Real>(angle: R) -> R {
    let turns = (angle * R::lit(0.5 * core::f64::consts::FRAC_1_PI)).round();
    turns.fnma(R::lit(core::f64::consts::TAU), angle)
}
