//! Spatial vectors and inertias against their definitions.

use fastrand::Rng;
use kinetarium_numbers::spatial::{Inertia, Spatial};
use kinetarium_numbers::{Mat3, SymMat3, Vec3};

fn vector(rng: &mut Rng) -> Vec3<f64> {
    let mut number = || rng.f64() - 0.5;
    Vec3::new(number(), number(), number())
}

fn motion(rng: &mut Rng) -> Spatial<f64> {
    Spatial::new(vector(rng), vector(rng))
}

/// Σ v vᵀ over five vectors, which is positive definite.
fn positive(rng: &mut Rng) -> SymMat3<f64> {
    (0..5).fold(SymMat3::zero(), |sum, _| {
        sum + SymMat3::outer(vector(rng), 1.0)
    })
}

fn size(x: Spatial<f64>) -> f64 {
    x.dot(x).sqrt()
}

#[test]
fn a_rigid_inertia_gives_the_momentum() {
    let rng = &mut Rng::with_seed(1);
    for _ in 0..100 {
        let (m, c, i, v) = (rng.f64(), vector(rng), positive(rng), motion(rng));
        let p = (v.linear + v.angular.cross(c)) * m;
        let momentum = Spatial::new(i * v.angular + c.cross(p), p);
        let found = Inertia::rigid(m, c, i).apply(v);
        assert!(size(found - momentum) < 1e-14, "{found:?} {momentum:?}");
    }
}

#[test]
fn solving_undoes_applying() {
    let rng = &mut Rng::with_seed(2);
    for _ in 0..100 {
        // Bodies of a tree: a sum of rigid inertias, less what a joint gives way to.
        let mut inertia = Inertia::rigid(1.0, vector(rng), positive(rng));
        for _ in 0..3 {
            inertia = inertia + Inertia::rigid(1.0, vector(rng), positive(rng));
        }
        let axis = motion(rng);
        let u = inertia.apply(axis);
        let inertia = inertia.minus_outer(u, 0.5 / axis.dot(u));
        let a = motion(rng);
        let found = inertia.solve(inertia.apply(a), 1e-20);
        // A few digits go to the condition of the matrix.
        assert!(size(found - a) < 1e-11, "{found:?} {a:?}");
    }
}

#[test]
fn products_with_a_sum_are_products_and_a_sum() {
    let rng = &mut Rng::with_seed(3);
    for _ in 0..100 {
        let (v, s, c) = (motion(rng), motion(rng), motion(rng));
        let crossed = v.cross_motion_plus(s, c) - (v.cross_motion(s) + c);
        assert!(size(crossed) < 1e-15);
        let (a, b, c) = (vector(rng), vector(rng), vector(rng));
        assert!((a.cross_plus(b, c) - (a.cross(b) + c)).length() < 1e-15);
        let m = Mat3::from_columns(vector(rng), vector(rng), vector(rng));
        assert!((m.mul_plus(b, c) - (m * b + c)).length() < 1e-15);
        let transposed = m.transpose_mul_plus(b, c) - (m.transpose_mul(b) + c);
        assert!(transposed.length() < 1e-15);
    }
}

#[test]
fn force_products_are_dual_to_motion_products() {
    // (v × m) · f + m · (v ×* f) = 0: a power is the same seen from a frame that moves with v.
    let rng = &mut Rng::with_seed(4);
    for _ in 0..100 {
        let (v, m, f) = (motion(rng), motion(rng), motion(rng));
        let sum = v.cross_motion(m).dot(f) + m.dot(v.cross_force(f));
        assert!(sum.abs() < 1e-15);
    }
}
