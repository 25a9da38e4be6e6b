//! Motions that have been solved: falling, swinging, spinning.

use crate::common::*;
use glam::{DQuat, DVec3};
use kinetarium_sim::Simulation;
use model::{BodyId, Builder};
use numbers::Float;
use std::f64::consts::TAU;

/// With a constant force every method is a sum that can be written down. After n steps from rest,
/// with v = n h g: semi-implicit Euler and xpbd fell n (n + 1)/2 h² g, explicit Euler
/// n (n − 1)/2 h² g, the others, which are exact, n²/2 h² g.
#[test]
fn free_fall() {
    let (n, h) = (1000, 1e-3);
    let end = n as f64 * h;
    let late = 0.5 * n as f64 * h * h * G;
    let parabola = -0.5 * G * end * end;
    let cases = [
        (EULER, parabola - late),
        (XPBD, parabola - late),
        (EXPLICIT_EULER, parabola + late),
        (VERLET, parabola),
        (RK4, parabola),
    ];
    for (method, fallen) in cases {
        fall::<f64>(method, n, h, fallen, f64::EPSILON);
        fall::<f32>(method, n, h, fallen, f64::from(f32::EPSILON));
    }
}

/// Throws a turning body up at 3 m/s and along at 2 m/s. Each of n additions rounds by `epsilon`/2
/// of a number of at most 5.
fn fall<T: Float>(method: Method, n: usize, h: f64, fallen: f64, epsilon: f64) {
    let mut world = Builder::new("ball");
    body(
        world.object(""),
        "ball",
        0.7,
        DVec3::ZERO,
        DVec3::splat(0.1),
    );
    let mut simulation = method.simulate::<T>(&world.build().unwrap(), h);
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    simulation
        .set_joint_state(0, &start, &[2.0, 3.0, 0.0, 0.3, -0.2, 0.1])
        .unwrap();
    simulation.step(n);
    let end = n as f64 * h;
    let outputs = simulation.outputs();
    let tolerance = 5.0 * n as f64 * epsilon;
    let expected = DVec3::new(2.0, 3.0, 0.0) * end + DVec3::Y * fallen;
    near(
        format!("{method:?} place"),
        outputs.body_position(0, BodyId(0)),
        expected,
        tolerance,
    );
    let speed = DVec3::new(2.0, 3.0 - G * end, 0.0);
    near(
        format!("{method:?} speed"),
        outputs.body_velocity(0, BodyId(0)),
        speed,
        2.0 * tolerance,
    );
}

fn state(simulation: &mut Simulation<f64>) -> (f64, f64) {
    let outputs = simulation.outputs();
    (outputs.joint_position(0)[0], outputs.joint_velocity(0)[0])
}

/// Small swings, against the discrete solution. With ω₀ h = s, the linearised steps are
///
/// ```text
/// semi-implicit Euler   v' = v − h ω₀² q,          q' = q + h v'     cos φ = 1 − s²/2   no decay
/// xpbd                  v' = v − h ω₀² q,  q' = q + h v' − h s² w,  w' = v' + μ s² w
/// ```
///
/// where v is the angular momentum about the hinge over its moment, and xpbd's way takes the weight's
/// torque where free flight ends, with the spin w; μ is m l² over the moment about the centre. So
/// xpbd's z = exp(iφ) has (z − 1)² + κ z = 0, κ = s² (1 − s² / (z − μ s²)), which is as Euler's to
/// first order, and decays by s⁴ a step. A passage through zero tells the phase: after n steps from
/// rest it is φ n. Swings of a = 1e-4 rad are linear to a²/16 = 6e-10.
#[test]
fn small_swings_have_the_discrete_frequency_and_decay() {
    let (w, h, n) = (pendulum_frequency(), 1e-3, 20_000);
    let s = w * h;
    let (m, l, i) = PENDULUM;
    let spin = m * l * l / i * s * s;
    let weaker = s * s * (1.0 - s * s / (1.0 - spin));
    let cases = [
        (EULER, (1.0 - s * s / 2.0).acos(), 1.0),
        (XPBD, (1.0 - weaker / 2.0).acos(), 1.0 - s.powi(4)),
    ];
    for (method, phase, decay_squared) in cases {
        let mut simulation = method.simulate::<f64>(&pendulum(), h);
        simulation.set_joint_state(0, &[1e-4], &[0.0]).unwrap();
        let mut passages = Vec::new();
        let mut before = state(&mut simulation).0;
        for i in 0..n {
            simulation.step(1);
            let now = state(&mut simulation).0;
            if before * now < 0.0 {
                passages.push(i as f64 + before / (before - now));
            }
            before = now;
        }
        let last = passages.len() - 1;
        let half_turns = (passages[last] - passages[0]) * phase / std::f64::consts::PI;
        // The sine is straight to φ²/24 between two samples beside zero, twice.
        let tolerance = 6e-10 * last as f64 + phase.powi(3);
        close(
            format!("{method:?} half turns"),
            half_turns,
            last as f64,
            tolerance,
        );
        let energy = {
            let (q, v) = state(&mut simulation);
            // Invariant of the linear map: q² ω² ∓ … ; at a passage through zero only v counts.
            q * q * w * w + v * v
        };
        let expected = (1e-4 * w).powi(2) * decay_squared.powi(n);
        // q² ω² + v² of the discrete orbit wobbles by ω h.
        close(format!("{method:?} decay"), energy / expected, 1.0, s);
    }
}

/// Period of large swings θ₀ of a pendulum: T = T₀ / agm(1, cos θ₀/2) (Gauss; Landau & Lifshitz,
/// Mechanics, §11). With h = T/n the state must be back after n steps, up to the method's error.
/// Semi-implicit Euler is conjugate to Verlet by half a kick, and so returns to second order; as
/// does xpbd, whose error of third order is large, however.
#[test]
fn large_swings_return_after_the_elliptic_period() {
    let methods = [
        (EULER, 2.0, 400),
        (EXPLICIT_EULER, 1.0, 20_000),
        (VERLET, 2.0, 400),
        (RK4, 4.0, 800),
        (XPBD, 2.0, 64_000),
    ];
    for (method, order, steps) in methods {
        for degrees in [20.0_f64, 60.0, 120.0, 150.0] {
            let start = degrees.to_radians();
            let t = TAU / pendulum_frequency() / agm(1.0, (start / 2.0).cos());
            let error = |h: f64| {
                let mut simulation = method.simulate::<f64>(&pendulum(), h);
                simulation.set_joint_state(0, &[start], &[0.0]).unwrap();
                simulation.step((t / h).round() as usize);
                let (q, v) = state(&mut simulation);
                (q - start).hypot(v / pendulum_frequency())
            };
            vanishes(
                format!("{method:?} {degrees}°"),
                order,
                0.2,
                t / steps as f64,
                error,
            );
        }
    }
}

/// The pendulum swings as far as f32 can tell: users' step of 2 ms, one period of 90°.
#[test]
fn large_swings_in_single_precision() {
    let t = TAU / pendulum_frequency() / agm(1.0, (90_f64.to_radians() / 2.0).cos());
    let h = t / 600.0;
    let mut simulation = RK4.simulate::<f32>(&pendulum(), h);
    let start = 90_f64.to_radians();
    simulation.set_joint_state(0, &[start], &[0.0]).unwrap();
    simulation.step(600);
    let outputs = simulation.outputs();
    // Each step rounds q and v by ε/2 of at most 7 rad/s; the method's own share is (ω h)⁴ ≈ 1e-9.
    let tolerance = 600.0 * f64::from(f32::EPSILON) * 7.0 / 2.0;
    close("amplitude", outputs.joint_position(0)[0], start, tolerance);
}

/// Starts a [`floating`] body turning.
fn spin<T: Float>(method: Method, moments: DVec3, w: DVec3, h: f64) -> Simulation<T> {
    let mut simulation = method.simulate::<T>(&floating(moments), h);
    let position = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    simulation
        .set_joint_state(0, &position, &[0.0, 0.0, 0.0, w.x, w.y, w.z])
        .unwrap();
    simulation
}

/// A free symmetric top turns by L/I₁ about the fixed L and by (1 − I₃/I₁) ω₃ about its own axis:
/// q(t) = exp(L t/I₁) q(0) exp((1 − I₃/I₁) ω₃ t e₃) (Landau & Lifshitz, Mechanics, §33).
#[test]
fn symmetric_top_precesses() {
    let moments = DVec3::new(1.0, 1.0, 0.4);
    let (w, t) = (DVec3::new(1.5, 0.0, 6.0), 2.0);
    let l = moments * w;
    let exact = DQuat::from_scaled_axis(l * t / moments.x)
        * DQuat::from_rotation_z((1.0 - moments.z / moments.x) * w.z * t);
    // xpbd's free flight is the midpoint rule.
    for (method, order, h) in [(EULER, 1.0, 1e-3), (XPBD, 2.0, 4e-3), (RK4, 4.0, 1e-2)] {
        let error = |h: f64| {
            let mut simulation = spin::<f64>(method, moments, w, h);
            simulation.step((t / h).round() as usize);
            let q = simulation.outputs().body_orientation(0, BodyId(0));
            2.0 * (exact.conjugate() * q).xyz().length()
        };
        vanishes(format!("{method:?} top"), order, 0.1, h, error);
    }
}

/// Half the period in which a free body with moments I₁ < I₂ < I₃ turns over when it spins about
/// its intermediate axis: 2 K(k) √(I₁ I₂ I₃ / ((I₃ − I₂)(L² − 2 E I₁))) with
/// k² = (I₂ − I₁)(2 E I₃ − L²) / ((I₃ − I₂)(L² − 2 E I₁)), where L² > 2 E I₂
/// (Landau & Lifshitz, Mechanics, §37).
fn flip_time(i: DVec3, w: DVec3) -> f64 {
    let (l2, e2) = ((i * w).length_squared(), i.dot(w * w));
    assert!(l2 > e2 * i.y);
    let common = (i.z - i.y) * (l2 - e2 * i.x);
    let k = ((i.y - i.x) * (e2 * i.z - l2) / common).sqrt();
    2.0 * elliptic_k(k) * (i.element_product() / common).sqrt()
}

/// Moments of inertia of a body that flips [kg·m²], and how it spins [rad/s].
const FLIPPING: (DVec3, DVec3) = (DVec3::new(1.0, 2.0, 2.8), DVec3::new(0.0, 5.0, 0.2));

/// Started at (0, ω₂, ω₃), where ω₂ is largest, the rates are (0, −ω₂, ω₃) half a period later:
/// the flip of the intermediate axis (Dzhanibekov; Poinsot 1834).
#[test]
fn intermediate_axis_flips_in_time() {
    let (i, w) = FLIPPING;
    let t = flip_time(i, w);
    for (method, order, steps) in [(EULER, 2.0, 20_000), (XPBD, 2.0, 16_000), (RK4, 4.0, 500)] {
        let error = |h: f64| {
            let mut simulation = spin::<f64>(method, i, w, h);
            simulation.step((t / h).round() as usize);
            let v = simulation.outputs().joint_velocity(0);
            (DVec3::from_slice(&v[3..]) - DVec3::new(0.0, -w.y, w.z)).length()
        };
        vanishes(
            format!("{method:?} flip"),
            order,
            0.15,
            t / steps as f64,
            error,
        );
    }
}

/// Ten flips: xpbd's free flight keeps the angular momentum to rounding (a dozen a step) and the
/// energy to second order, without drift: within (ω h)²; Runge–Kutta drifts by less than (ω h)⁴ ω t/120, the size
/// of all its steps' errors together.
#[test]
fn flips_conserve_energy_and_momentum() {
    let (i, w) = FLIPPING;
    let (h, t) = (1e-3, 10.0 * flip_time(i, w));
    let n = (t / h).round();
    let s = w.length() * h;
    let drift = s.powi(4) * w.length() * t / 120.0;
    for (method, of_energy, of_momentum) in
        [(XPBD, s * s, 12.0 * n * f64::EPSILON), (RK4, drift, drift)]
    {
        let mut simulation = spin::<f64>(method, i, w, h);
        let (energy, momentum) = (0.5 * i.dot(w * w), i * w);
        let mut flips = 0;
        let mut before = w.y;
        for _ in 0..(n as usize) {
            simulation.step(1);
            let outputs = simulation.outputs();
            let l = outputs.angular_momentum(0);
            assert!(
                l.distance(momentum) <= of_momentum * momentum.length(),
                "{method:?}: {l}"
            );
            let change = outputs.energy(0) / energy - 1.0;
            assert!(
                change.abs() <= of_energy,
                "{method:?}: energy off by {change:e}"
            );
            let now = outputs.joint_velocity(0)[4];
            flips += usize::from(before * now < 0.0);
            before = now;
        }
        assert_eq!(flips, 10, "{method:?}");
    }
}
