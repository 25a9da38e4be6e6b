//! What acts along a degree of freedom, one law at a time.
//!
//! Along one coordinate of effective mass m all solvers take a damper d with speed w at the end of the step, and a spring k
//! with rest r at a share Θ of the way there, Θ = 0 where h² k < m, besides a force f:
//!
//! ```text
//! v' = (m v + h (f − k (q − r) + d w)) / (m + h d + Θ h² k)      q' = q + h v'      Θ = max(0, 1 − m/(h² k))
//! ```
//!
//! so the tests compare with that sequence itself, up to rounding; that it tends to the solution of
//! the differential equation `driven_oscillator` checks too. `swings` asks how Θ is shared among coordinates.

use crate::common::*;
use glam::DVec3;
use kinetarium_sim::Simulation;
use model::{Actuator, Builder, Drive, JointDraft, JointId, Limit, Model, Object, Pose};
use rigid::featherstone::FRICTION_SPEED;

const H: f64 = 1e-3;

/// Rounding of thousands of steps of f64, with numbers of order one.
const ROUNDING: f64 = 1e-10;

/// A linear law along one coordinate.
#[derive(Clone, Copy, Debug, Default)]
struct Law {
    mass: f64,
    stiffness: f64,
    rest: f64,
    damping: f64,
    speed: f64,
    force: f64,
}

impl Law {
    /// One step.
    fn step(&self, (q, v): (f64, f64)) -> (f64, f64) {
        let Self {
            mass: m,
            stiffness: k,
            rest: r,
            damping: d,
            speed: w,
            force: f,
        } = *self;
        let stiff = (H * H * k - m).max(0.0);
        let v = (m * v + H * (f - k * (q - r) + d * w)) / (m + H * d + stiff);
        (q + H * v, v)
    }
}

/// All methods on a slider and on a wheel, with their names.
fn cases(configure: impl Fn(&mut JointDraft)) -> Vec<(String, Simulation<f64>)> {
    let models = [slider(&configure), wheel(&configure)];
    let all = models
        .iter()
        .flat_map(|model| SOLVERS.map(|method| (model, method)));
    all.map(|(model, method)| {
        (
            format!("{} {method:?}", model.name),
            method.simulate(model, H),
        )
    })
    .collect()
}

fn state(simulation: &mut Simulation<f64>) -> (f64, f64) {
    let outputs = simulation.outputs();
    (outputs.joint_position(0)[0], outputs.joint_velocity(0)[0])
}

/// Steps a simulation and a sequence together, and compares them every time.
#[track_caller]
fn follows(
    name: &str,
    simulation: &mut Simulation<f64>,
    steps: usize,
    mut next: impl FnMut(usize, (f64, f64)) -> (f64, f64),
) {
    let mut expected = state(simulation);
    let mut worst: f64 = 0.0;
    for i in 0..steps {
        simulation.step(1);
        expected = next(i, expected);
        let (q, v) = state(simulation);
        worst = worst
            .max((q - expected.0).abs())
            .max((v - expected.1).abs());
    }
    close(
        format!("{name}: distance from the sequence"),
        worst,
        0.0,
        ROUNDING,
    );
}

/// Springs that a step resolves, and stiff ones.
#[test]
fn passive_spring_and_damper() {
    for stiffness in [50.0, 1e6, 3e6, 1e9] {
        let law = Law {
            mass: MASS,
            stiffness,
            rest: 0.2,
            damping: 1.5,
            ..Law::default()
        };
        for (name, mut simulation) in cases(|j| {
            j.spring(stiffness, 0.2).damping(1.5);
        }) {
            let name = format!("{name} {stiffness}");
            // So far that all turn by as little in a swing: by `xpbd` turns are not exact.
            let share = (50.0 / stiffness).sqrt();
            let start = [0.2 + 0.5 * share * share];
            simulation.set_joint_state(0, &start, &[-share]).unwrap();
            follows(&name, &mut simulation, 3000, |_, x| law.step(x));
        }
    }
}

/// A drive and a position servo beside a spring are one with it.
#[test]
fn springs_of_all_kinds_share_a_coordinate() {
    let drive = Drive {
        stiffness: 1.5e6,
        damping: 1.0,
        ..Drive::default()
    };
    let law = Law {
        mass: MASS,
        stiffness: 4e6,
        damping: 2.0,
        ..Law::default()
    };
    let mut parts = slider(|j| {
        j.spring(1.5e6, 0.0).drive(drive);
    })
    .into_parts();
    let servo = Actuator::position("servo", JointId(0), 1e6, 1.0);
    parts.actuators.push(servo);
    let model = Model::new(parts).unwrap();
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation.set_joint_state(0, &[0.7], &[-1.0]).unwrap();
        let name = format!("{method:?}");
        follows(&name, &mut simulation, 1000, |_, x| law.step(x));
    }
}

/// x = e^(−δt) (a cos ωt + b sin ωt) of a damped spring. Runge–Kutta 4 is off by (ω₀ h)⁵/120 a step.
#[test]
fn damped_oscillation() {
    let (k, d, t) = (50.0, 1.5, 2.0);
    let (w0, delta) = ((k / MASS).sqrt(), d / (2.0 * MASS));
    let w = (w0 * w0 - delta * delta).sqrt();
    let model = slider(|j| {
        j.spring(k, 0.0).damping(d);
    });
    let mut simulation = RK4.simulate::<f64>(&model, H);
    simulation.set_joint_state(0, &[0.5], &[0.0]).unwrap();
    simulation.step((t / H).round() as usize);
    let expected = 0.5 * (-delta * t).exp() * ((w * t).cos() + delta / w * (w * t).sin());
    let tolerance = (w0 * H).powi(4) * w0 * t / 120.0 + 1e-12;
    close("position", state(&mut simulation).0, expected, tolerance);
}

/// Complex amplitude of q in m q̈ + d q̇ + k q = k A cos ωt: (amplitude, phase). A step is
/// Q (m (z − 2 + 1/z)/h² + d (z − 1)/h + k) = k A with z = exp(iωh), as Θ = 0.
fn response(k: f64, d: f64, a: f64, w: f64, discrete: bool) -> (f64, f64) {
    let (m, s) = (MASS, w * H);
    let (re, im) = if discrete {
        let re = m * (2.0 * s.cos() - 2.0) / (H * H) + d * (s.cos() - 1.0) / H + k;
        (re, d * s.sin() / H)
    } else {
        (k - m * w * w, d * w)
    };
    (k * a / re.hypot(im), -im.atan2(re))
}

/// A drive whose target swings: below, at and above resonance, after the transient has died out, the
/// coordinate has the amplitude and the phase of the discrete solution, to rounding; those differ
/// from the continuous ones by first order in h, by h ω d ω of the damper alone: see `bound`.
#[test]
fn driven_oscillator() {
    let (k, d, a) = (50.0, 4.0, 0.3);
    for w in [2.5_f64, 5.0, 10.0] {
        let period = (std::f64::consts::TAU / w / H).round();
        let w = std::f64::consts::TAU / (period * H);
        let drive = Drive {
            stiffness: k,
            damping: d,
            ..Drive::default()
        };
        for (name, mut simulation) in cases(|j| {
            j.drive(drive);
        }) {
            // The transient fades like exp(−d t/2m): exp(−40) after 40 s.
            let start = (40.0 / H / period).ceil() * period;
            let (mut re, mut im) = (0.0, 0.0);
            for i in 0..(start + period) as usize {
                let (sin, cos) = (w * i as f64 * H).sin_cos();
                if i as f64 >= start {
                    let q = state(&mut simulation).0;
                    re += 2.0 * q * cos / period;
                    im -= 2.0 * q * sin / period;
                }
                simulation.controls().set_target(0, 0, a * cos).unwrap();
                simulation.step(1);
            }
            let (amplitude, phase) = response(k, d, a, w, true);
            close(
                format!("{name} {w:.2} amplitude"),
                re.hypot(im),
                amplitude,
                ROUNDING,
            );
            close(
                format!("{name} {w:.2} phase"),
                im.atan2(re),
                phase,
                ROUNDING,
            );
            let (amplitude, phase) = response(k, d, a, w, false);
            // The damper acts half a step late, and ω h is not small to second order.
            let bound = H * w * (d * w + H * w * MASS * w * w) / (k - MASS * w * w).hypot(d * w);
            close(
                format!("{name} {w:.2} continuous amplitude"),
                re.hypot(im) / amplitude,
                1.0,
                bound,
            );
            close(
                format!("{name} {w:.2} continuous phase"),
                im.atan2(re),
                phase,
                bound,
            );
        }
    }
}

#[test]
fn velocity_target() {
    let law = Law {
        mass: MASS,
        damping: 30.0,
        speed: 1.7,
        ..Law::default()
    };
    for (name, mut simulation) in cases(|j| {
        j.drive(Drive {
            damping: 30.0,
            target_velocity: 1.7,
            ..Drive::default()
        });
    }) {
        follows(&name, &mut simulation, 1000, |_, x| law.step(x));
        // v = w (1 − (1 + h d/m)⁻ⁿ): all but exp(−15) of it.
        close(
            format!("{name} speed"),
            state(&mut simulation).1,
            1.7,
            1.7 * (-14.0_f64).exp(),
        );
        simulation
            .controls()
            .set_target_velocity(0, 0, -0.4)
            .unwrap();
        let law = Law { speed: -0.4, ..law };
        follows(&name, &mut simulation, 500, |_, x| law.step(x));
    }
}

/// Far from its target a drive with an effort limit f pushes with f, no more.
#[test]
fn effort_limit_saturates() {
    let law = Law {
        mass: MASS,
        force: 3.0,
        ..Law::default()
    };
    let drive = Drive {
        stiffness: 1e4,
        damping: 10.0,
        effort_limit: 3.0,
        target_position: 2.0,
        ..Drive::default()
    };
    for (name, mut simulation) in cases(|j| {
        j.drive(drive);
    }) {
        // ½ 3/2 t² = 0.75 m after 1 s, still far from 2.
        follows(&name, &mut simulation, 1000, |_, x| law.step(x));
        simulation.controls().set_target(0, 0, -1.0).unwrap();
        let law = Law { force: -3.0, ..law };
        follows(&name, &mut simulation, 500, |_, x| law.step(x));
    }
}

/// A jump of the target reaches the drive through a first-order lag of the control time T:
/// s' = s + (target − s) h/(T + h), before the step that it acts in.
#[test]
fn control_time_smooths_a_jump_of_the_target() {
    let (k, d, lag, jump) = (80.0, 20.0, 0.1, 1.2);
    let drive = Drive {
        stiffness: k,
        damping: d,
        control_time: lag,
        ..Drive::default()
    };
    for (name, mut simulation) in cases(|j| {
        j.drive(drive);
    }) {
        simulation.controls().set_target(0, 0, jump).unwrap();
        let mut smoothed = 0.0;
        follows(&name, &mut simulation, 1000, |i, x| {
            smoothed += (jump - smoothed) * H / (lag + H);
            let power = (lag / (lag + H)).powi(i as i32 + 1);
            assert!((smoothed - jump * (1.0 - power)).abs() < 1e-12);
            Law {
                mass: MASS,
                stiffness: k,
                damping: d,
                rest: smoothed,
                ..Law::default()
            }
            .step(x)
        });
    }
}

/// A turning axis goes the short way from 170° to −170°; one with limits goes round.
#[test]
fn turning_axes_take_the_short_way() {
    let drive = Drive {
        stiffness: 400.0,
        damping: 60.0,
        target_position: 170_f64.to_radians(),
        ..Drive::default()
    };
    let limit = Limit {
        lower: -4.0,
        upper: 4.0,
        stiffness: 1e4,
        damping: 1.0,
        inertia: 0.0,
    };
    for method in SOLVERS {
        for (limit, way) in [(None, 20.0), (Some(limit), -340.0)] {
            let model = wheel(|j| {
                j.drive(drive).initial(&[170_f64.to_radians()]);
                limit.map(|l| j.limit(l));
            });
            let mut simulation = method.simulate::<f64>(&model, H);
            simulation
                .controls()
                .set_target_degrees(0, 0, -170.0)
                .unwrap();
            let mut turned = 0.0;
            for _ in 0..10_000 {
                simulation.step(1);
                turned += state(&mut simulation).1 * H;
            }
            // What is left after 10 s of m v' = −d v − k q, whose slower rate is 7.3 1/s: nothing.
            close(format!("{method:?} way"), turned.to_degrees(), way, 1e-6);
            close(
                format!("{method:?} end"),
                state(&mut simulation).0.to_degrees(),
                -170.0,
                1e-6,
            );
        }
    }
}

/// Dry friction f decelerates by f/m until the body stands: after m v₀/f seconds and m v₀²/(2 f).
///
/// The speeds of the steps are those of the closed form, v − f/m t, until it creeps to a stop; the way adds first order in h.
#[test]
fn friction_stops_a_motion_in_time() {
    let (f, v) = (4.0, 1.0);
    let (time, way) = (MASS * v / f, MASS * v * v / (2.0 * f));
    for (name, mut simulation) in cases(|j| {
        j.friction_loss(f);
    }) {
        simulation.set_joint_state(0, &[0.0], &[v]).unwrap();
        let mut stopped = None;
        for i in 0..2000 {
            simulation.step(1);
            let (_, v) = state(&mut simulation);
            assert!(v > -1e-12, "{name} is thrown back at {v}");
            if stopped.is_none() && v < FRICTION_SPEED {
                stopped = Some((i + 1) as f64 * H);
            }
        }
        close(format!("{name} time"), stopped.unwrap(), time, 2.0 * H);
        close(format!("{name} way"), state(&mut simulation).0, way, H * v);
        close(format!("{name} rest"), state(&mut simulation).1, 0.0, 1e-9);
    }
}

/// Against a force F below it, friction f holds: featherstone creeps at F/f · 1 mm/s, xpbd a
/// thousandth of that. Above it, the rest accelerates: (F − f)/m.
#[test]
fn friction_holds_against_less_and_gives_way_to_more() {
    let f = 4.0;
    for (name, mut simulation) in cases(|j| {
        j.friction_loss(f);
    }) {
        simulation.controls().set_dof_force(0, 0, 3.6).unwrap();
        simulation.step(5000);
        close(
            format!("{name} creep"),
            state(&mut simulation).1,
            0.0,
            0.9 * FRICTION_SPEED * 1.001,
        );
        simulation.controls().set_dof_force(0, 0, 5.0).unwrap();
        simulation.step(1000);
        let speed = state(&mut simulation).1;
        let crept = FRICTION_SPEED * (1.0 + ROUNDING);
        close(format!("{name} slip"), speed, (5.0 - f) / MASS, crept);
    }
}

/// What is much stronger than friction f, F, is opposed by f from the first step on, and by −f when it turns round:
/// v' = v + h (±F ∓ f)/m.
#[test]
fn friction_is_never_more_than_it_can_be() {
    let (f, pull) = (1.0, 20.0);
    for (name, mut simulation) in cases(|j| {
        j.friction_loss(f);
    }) {
        let mut expected: f64 = 0.0;
        for step in 0..40 {
            let sign = if step % 20 < 10 { 1.0 } else { -1.0 };
            simulation
                .controls()
                .set_dof_force(0, 0, sign * pull)
                .unwrap();
            simulation.step(1);
            let along = if expected == 0.0 {
                sign
            } else {
                expected.signum()
            };
            expected += H / MASS * (sign * pull - along * f);
            let speed = state(&mut simulation).1;
            // Where it turns round within a step, friction does, too.
            close(
                format!("{name} {step}"),
                speed,
                expected,
                4.0 * H / MASS * f,
            );
        }
    }
}

/// The elbow of an arm whose shoulder is jerked: its friction, 0.05 N·m, is a tenth of what the jerk makes of it, so it bends
/// as if by the constant torque −f, though its parent accelerates.
#[test]
fn friction_gives_way_to_the_motion_of_its_parent() {
    let arm = |friction: f64| {
        let mut world = Builder::new("arm");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let rod = |object: &mut Object, name: &str| {
            body(object, name, 1.0, DVec3::X * 0.25, DVec3::splat(0.03))
        };
        let (upper, lower) = (rod(object, "upper"), rod(object, "lower"));
        object.revolute("shoulder", upper, DVec3::Z);
        let elbow = object.revolute("elbow", lower, DVec3::Z);
        let end = Pose::at(DVec3::X * 0.5);
        elbow
            .parent(upper)
            .frames(end, Pose::IDENTITY)
            .friction_loss(friction);
        world.build().unwrap()
    };
    let turned = |friction: f64, torque: f64| {
        let mut simulation: Simulation<f64> = EULER.simulate(&arm(friction), H);
        let mut speeds = Vec::new();
        for _ in 0..20 {
            simulation.controls().set_dof_force(0, 0, 5.0).unwrap();
            simulation.controls().set_dof_force(0, 1, torque).unwrap();
            simulation.step(1);
            speeds.push(simulation.outputs().joint_velocity(0)[1]);
        }
        speeds
    };
    // The elbow is left behind, so friction drags it along.
    let f = 0.05;
    let (rubbed, pulled) = (turned(f, 0.0), turned(0.0, f));
    for (step, (rubbed, pulled)) in rubbed.into_iter().zip(pulled).enumerate() {
        assert!(pulled < 0.0);
        close(format!("step {step}"), rubbed, pulled, 0.02 * pulled.abs());
    }
}

/// Pressed with a force F into a limit of stiffness k, a coordinate rests F/k beyond it.
#[test]
fn limits_give_way_by_force_over_stiffness() {
    let (k, force) = (2000.0, 5.0);
    let limit = Limit {
        lower: -0.1,
        upper: 0.3,
        stiffness: k,
        damping: 200.0,
        inertia: 0.0,
    };
    for (name, mut simulation) in cases(|j| {
        j.limit(limit);
    }) {
        for (force, end) in [(force, 0.3), (-force, -0.1)] {
            simulation.controls().set_dof_force(0, 0, force).unwrap();
            simulation.step(5000);
            // d > 2 √(k m): no rebound; the slower rate, 11 1/s, leaves e⁻⁴⁰.
            close(
                format!("{name} rest"),
                state(&mut simulation).0,
                end + force / k,
                ROUNDING,
            );
        }
        // Free again between the limits.
        simulation.set_joint_state(0, &[0.1], &[0.05]).unwrap();
        let law = Law {
            mass: MASS,
            ..Law::default()
        };
        follows(&name, &mut simulation, 1000, |_, x| law.step(x));
    }
}

/// A stop of inertia m' with T = 2 (m + m')/d and k T² = m + m' is critically damped: what runs into it
/// with v₀ goes v₀ t e^(−t/T) deep, v₀ T/e at most, and is let go where the stop would pull, which is
/// where q̈ turns, at t = 2 T, with −v₀ e⁻². Wherever in a step it gets there, nothing of v₀ is lost.
#[test]
fn a_stop_with_inertia_is_soft_and_lets_go() {
    let (time, carried, v0) = (0.05, 3.0 * MASS, 2.0);
    let all = MASS + carried;
    let limit = Limit {
        lower: -1.0,
        upper: 0.3,
        stiffness: all / (time * time),
        damping: 2.0 * all / time,
        inertia: carried,
    };
    let cases = cases(|j| {
        j.limit(limit);
    });
    for (case, mut simulation) in cases {
        for before in [0.0, 0.1, 1.4, 10.7] {
            let start = 0.3 - before * v0 * H;
            simulation.set_joint_state(0, &[start], &[v0]).unwrap();
            let mut deepest: f64 = 0.0;
            for _ in 0..(5.0 * time / H + before) as usize {
                simulation.step(1);
                deepest = deepest.max(state(&mut simulation).0 - 0.3);
            }
            let name = format!("{case}, {before} steps before,");
            // First order in h/T.
            let tolerance = v0 * H / time;
            let depth = v0 * time * (-1.0_f64).exp();
            close(format!("{name} depth"), deepest, depth, tolerance * time);
            let (speed, after) = (state(&mut simulation).1, -v0 * (-2.0_f64).exp());
            close(format!("{name} speed"), speed, after, tolerance);
        }
    }
}

/// Armature a adds to the inertia: q̈ = f/(m + a), and ½ (m + a) q̇² is the energy.
#[test]
fn armature_adds_to_the_inertia() {
    let law = Law {
        mass: MASS + 3.0,
        force: 2.0,
        ..Law::default()
    };
    for (name, mut simulation) in cases(|j| {
        j.armature(3.0);
    }) {
        simulation.controls().set_dof_force(0, 0, 2.0).unwrap();
        follows(&name, &mut simulation, 1000, |_, x| law.step(x));
        let v = state(&mut simulation).1;
        let energy = simulation.outputs().kinetic_energy(0);
        close(
            format!("{name} energy"),
            energy,
            0.5 * law.mass * v * v,
            ROUNDING,
        );
    }
}

/// Armature under gravity, too: a pulley of inertia I reflected as I/r² slows a falling weight.
#[test]
fn armature_slows_a_fall() {
    let (m, a) = (2.0, 6.0);
    let mut world = Builder::new("hoist");
    let object = world.object("");
    let load = body(object, "load", m, DVec3::ZERO, DVec3::ONE);
    object.prismatic("cable", load, DVec3::Y).armature(a);
    let model = world.build().unwrap();
    let law = Law {
        mass: m + a,
        force: -m * G,
        ..Law::default()
    };
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        follows(&format!("{method:?}"), &mut simulation, 1000, |_, x| {
            law.step(x)
        });
    }
}

/// A model with one actuator on a slider.
fn actuated(add: impl Fn(&mut model::Object, model::JointHandle)) -> Model {
    let mut world = Builder::new("actuated");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let cart = body(object, "cart", MASS, DVec3::ZERO, DVec3::ONE);
    let joint = object.prismatic("axis", cart, DVec3::X).handle();
    add(object, joint);
    world.build().unwrap()
}

#[test]
fn actuators() {
    let motor = actuated(|o, j| {
        o.motor("motor", j).gear(2.0).control_range(-1.0, 1.0);
    });
    let position = actuated(|o, j| {
        o.position_servo("servo", j, 60.0, 5.0);
    });
    let velocity = actuated(|o, j| {
        o.velocity_servo("servo", j, 25.0);
    });
    let limited = actuated(|o, j| {
        o.position_servo("servo", j, 1e4, 5.0)
            .force_range(-1.0, 0.5);
    });
    let still = Law {
        mass: MASS,
        ..Law::default()
    };
    // The control 3 is cut to 1 by the motor, whose gear doubles it.
    let cases = [
        (
            motor,
            Law {
                force: 2.0,
                ..still
            },
        ),
        (
            position,
            Law {
                stiffness: 60.0,
                rest: 3.0,
                damping: 5.0,
                ..still
            },
        ),
        (
            velocity,
            Law {
                damping: 25.0,
                speed: 3.0,
                ..still
            },
        ),
        (
            limited,
            Law {
                force: 0.5,
                ..still
            },
        ),
    ];
    for (model, law) in cases {
        for method in SOLVERS {
            let mut simulation = method.simulate::<f64>(&model, H);
            simulation.controls().set_control(0, &[3.0]).unwrap();
            let name = format!("{} {method:?}", model.actuators[0].name);
            follows(&name, &mut simulation, 1000, |_, x| law.step(x));
        }
    }
}

/// A servo takes a wheel as far as its control says, were it beyond half a turn, and stays there.
#[test]
fn a_servo_counts_whole_turns() {
    let mut world = Builder::new("turned");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let inertia = DVec3::new(1.5, 1.2, MASS);
    let wheel = body(object, "wheel", 1.0, DVec3::ZERO, inertia);
    let joint = object.revolute("axis", wheel, DVec3::Z).handle();
    object.position_servo("servo", joint, 10.0, 5.0);
    let model = world.build().unwrap();
    let law = Law {
        mass: MASS,
        stiffness: 10.0,
        rest: 4.0,
        damping: 5.0,
        ..Law::default()
    };
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation.controls().set_control(0, &[4.0]).unwrap();
        let name = format!("{method:?}");
        follows(&name, &mut simulation, 1500, |_, x| law.step(x));
    }
}

/// The effort limit E of a ball's drive is one of its torque, whichever way that points, and no limit of what else damps:
/// towards a target far away, about one axis, J ω̇ = E − c ω, so that ω = E/c (1 − e^(−c t/J)).
#[test]
fn the_effort_limit_of_a_ball_is_one_of_its_torque() {
    let (effort, damping, moment, time) = (0.6, 0.5, 0.2, 0.3);
    let away = DVec3::new(1.0, 2.0, -1.5);
    let mut world = Builder::new("wrist");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let hand = body(object, "hand", MASS, DVec3::ZERO, DVec3::splat(moment));
    let joint = object.ball("wrist", hand);
    joint.damping(damping).drive(Drive {
        stiffness: 30.0,
        effort_limit: effort,
        ..Drive::default()
    });
    let model = world.build().unwrap();
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        for (dof, target) in away.to_array().into_iter().enumerate() {
            simulation.controls().set_target(0, dof, target).unwrap();
        }
        simulation.step((time / H) as usize);
        let outputs = simulation.outputs();
        let found = DVec3::from_array([0, 1, 2].map(|dof| outputs.dof_velocity(0, dof)));
        let speed = effort / damping * -(-damping * time / moment).exp_m1();
        let off = found.distance(away.normalize() * speed);
        // First order in h c/J.
        assert!(off < speed * H * damping / moment, "{method:?}: {off:e}");
    }
}

/// So it is where the hand moves across the way, and the torque turns, with a wheel on it that rubs: all solvers go the same
/// way.
#[test]
fn the_torque_of_a_ball_turns_within_its_effort_limit() {
    let mut world = Builder::new("wrist");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let moments = DVec3::new(0.2, 0.3, 0.25);
    let hand = body(object, "hand", MASS, DVec3::ZERO, moments);
    object.ball("wrist", hand).drive(Drive {
        stiffness: 8.0,
        damping: 0.5,
        effort_limit: 1.5,
        ..Drive::default()
    });
    let wheel = body(object, "wheel", 0.1, DVec3::ZERO, DVec3::splat(0.1));
    let axle = object.revolute("axle", wheel, DVec3::Z).parent(hand);
    axle.friction_loss(0.3);
    let model = world.build().unwrap();
    let ends = [RK4, EULER, Method::Xpbd(4), IMPULSE].map(|method| {
        let mut simulation = method.simulate::<f64>(&model, H);
        // The wheel turns on all the time.
        let (start, speed) = (model.initial_position(), [3.0, -2.0, 1.0, 9.0]);
        simulation.set_joint_state(0, &start, &speed).unwrap();
        simulation.controls().set_target(0, 1, 1.0).unwrap();
        simulation.step(500);
        let outputs = simulation.outputs();
        DVec3::from_array([0, 1, 2].map(|dof| outputs.dof_velocity(0, dof)))
    });
    for end in &ends[1..] {
        // First order: a step of an acceleration of up to 1.5/0.2.
        let off = end.distance(ends[0]);
        assert!(off < 2.0 * H * 1.5 / 0.2, "{off:e}, {ends:?}");
    }
}

/// Actuators on a ball have force ranges of their own, each about its axis: J ω̇ = g (u₋ … u₊).
#[test]
fn force_ranges_on_a_ball_are_those_of_its_axes() {
    let (moment, steps) = (0.2, 100);
    let mut world = Builder::new("wrist");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let hand = body(object, "hand", MASS, DVec3::ZERO, DVec3::splat(moment));
    let wrist = object.ball("wrist", hand).handle();
    for (dof, low) in [-1.0, -2.0, -0.5].into_iter().enumerate() {
        let motor = object.motor(format!("motor {dof}"), wrist);
        motor.dof(dof).force_range(low, 0.0);
    }
    let model = world.build().unwrap();
    for method in [EULER, IMPULSE] {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation.controls().set_control(0, &[-9.0; 3]).unwrap();
        simulation.step(steps);
        let outputs = simulation.outputs();
        for (dof, force) in [-1.0, -2.0, -0.5].into_iter().enumerate() {
            let expected = force / moment * steps as f64 * H;
            // The axes turn with the hand, by half a radian at most, about what they push along.
            let found = outputs.dof_velocity(0, dof);
            close(format!("{method:?} about {dof}"), found, expected, 1e-3);
        }
    }
}
