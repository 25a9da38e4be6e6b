//! Coordinates measured from bodies are the joint's, to rounding. They once came out a millionth
//! too small, because the measurement was damped even far from gimbal lock.

use glam::DVec3;
use kinetarium_rigid::{Kernels, OutputTables, Settings, Xpbd};
use model::{Axis, Builder, Geometry, Model};
use numbers::{Cpu, Shared};

/// A ball on one joint with the given axes.
fn model(axes: &[Axis]) -> Model {
    let mut world = Builder::new("ball");
    let object = world.object("");
    let ball = object
        .body("ball")
        .shape(Geometry::Sphere { radius: 0.1 })
        .handle();
    object.d6("joint", ball, axes);
    world.build().unwrap()
}

/// Coordinates and velocities reported of a state just set.
fn reported(model: &Model, position: &[f64], velocity: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let kernels = Xpbd::new(model, &Settings::new(0.001)).unwrap();
    let lengths = kernels.lengths();
    let mut output = vec![0.0; lengths.output];
    let mut cpu: Cpu<'_, f64, _> = Cpu {
        state: &mut kernels.initial(model, position, velocity),
        input: &vec![0.0; lengths.input],
        output: &mut output,
        scratch: &mut vec![0.0; lengths.scratch],
        parameters: Shared(kernels.parameters()),
        links: kernels.links(),
    };
    kernels.report(&mut cpu);
    let t = OutputTables::new(model);
    let read = |at: usize| output[at..at + position.len()].to_vec();
    (read(t.position.at(0, 0)), read(t.velocity.at(0, 0)))
}

#[test]
fn of_one_two_and_three_axes() {
    let oblique = DVec3::new(2.0, -1.0, 2.0) / 3.0;
    let cases = [
        vec![Axis::linear(oblique)],
        vec![Axis::angular(oblique)],
        vec![Axis::linear(DVec3::X), Axis::linear(oblique)],
        vec![
            Axis::linear(DVec3::X),
            Axis::linear(DVec3::Y),
            Axis::angular(DVec3::Z),
        ],
    ];
    for axes in cases {
        let model = model(&axes);
        let n = axes.len();
        let position: Vec<_> = (0..n).map(|i| 1.2 - 0.5 * i as f64).collect();
        let velocity: Vec<_> = (0..n).map(|i| 3.0 + 0.7 * i as f64).collect();
        let (q, v) = reported(&model, &position, &velocity);
        for (found, expected) in q.iter().chain(&v).zip(position.iter().chain(&velocity)) {
            assert!(
                (found - expected).abs() < 1e-13,
                "{axes:?}: {found} for {expected}"
            );
        }
    }
}
