//! When sensors are sampled.

mod common;

use common::{close, pendulum, simulate};
use kinetarium_sensors::{Sensor, SensorKind, Sensors};
use model::JointId;
use sim::{Simulation, SolverKind};

fn angle(name: &str) -> Sensor {
    let joints = vec![JointId(0)];
    Sensor::new(name, SensorKind::JointPosition { joints })
}

fn falling(worlds: usize, h: f64) -> Simulation<f64> {
    let mut simulation = simulate(&pendulum(), SolverKind::Featherstone, worlds, h);
    for world in 0..worlds {
        simulation
            .set_joint_state(world, &[1.0 + world as f64], &[0.0])
            .unwrap();
    }
    simulation
}

/// 50 Hz at 500 steps a second: every tenth step, and it holds in between.
#[test]
fn a_slow_sensor_holds_what_it_read() {
    let mut simulation = falling(2, 0.002);
    let list = vec![angle("slow").with_rate(50.0), angle("fast")];
    let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    let mut held = sensors.reading("slow").unwrap().numbers.to_vec();
    for step in 1..=1000 {
        sensors.step(&mut simulation, 1).unwrap();
        let fast = sensors.reading("fast").unwrap();
        assert_eq!(fast.numbers[1], simulation.outputs().coordinate(1, 0));
        let slow = sensors.reading("slow").unwrap();
        if step % 10 == 0 {
            assert_eq!(slow.numbers, fast.numbers, "step {step}");
            held = slow.numbers.to_vec();
        } else {
            assert_eq!(slow.numbers, held, "step {step}");
        }
        let due = (step / 10 * 10) as f64 * 0.002;
        close("time of the sample", slow.time[0], due, 1e-9);
    }
}

/// Many steps at once find the same samples as one after the other: a random walk adds up all of them.
#[test]
fn many_steps_at_once_miss_no_sample() {
    let run = |slices: &[usize]| {
        let mut simulation = falling(3, 0.002);
        let noise = kinetarium_sensors::Noise {
            walk: 1.0.into(),
            ..kinetarium_sensors::Noise::default()
        };
        let list = vec![
            angle("a").with_rate(70.0).with_noise(noise.clone()),
            angle("b").with_rate(50.0).with_noise(noise),
        ];
        let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
        for &steps in slices {
            sensors.step(&mut simulation, steps).unwrap();
        }
        ["a", "b"].map(|name| {
            let reading = sensors.reading(name).unwrap();
            // 70 Hz: sample 28 is due at 0.4 s; 50 Hz: sample 20.
            close(name, reading.time[0], 0.4, 1e-9);
            reading.numbers.to_vec()
        })
    };
    let all = run(&[200]);
    assert_eq!(all, run(&[1; 200]));
    assert_eq!(all, run(&[3, 150, 47]));
}

/// What is stepped without its sensors is sampled when they are asked, once.
#[test]
fn update_takes_what_is_due_now() {
    let mut simulation = falling(1, 0.002);
    let list = vec![angle("slow").with_rate(50.0)];
    let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    let first = sensors.reading("slow").unwrap().numbers[0];
    simulation.step(9);
    sensors.update(&mut simulation).unwrap();
    assert_eq!(sensors.reading("slow").unwrap().numbers[0], first);
    simulation.step(24);
    sensors.update(&mut simulation).unwrap();
    let now = sensors.reading("slow").unwrap();
    assert_eq!(now.numbers[0], simulation.outputs().coordinate(0, 0));
    close("time", now.time[0], 33.0 * 0.002, 1e-9);
    // The next is due at 40 steps, not 10 after the last.
    simulation.step(7);
    sensors.update(&mut simulation).unwrap();
    close("time", sensors.reading("slow").unwrap().time[0], 0.08, 1e-9);
}

/// Each world has its own time, and a state that is set is seen at once, though its time is 0 as before.
#[test]
fn a_world_that_is_set_is_sampled_anew() {
    let mut simulation = falling(2, 0.002);
    let list = vec![angle("slow").with_rate(50.0)];
    let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    simulation.set_joint_state(1, &[0.25], &[0.0]).unwrap();
    sensors.update(&mut simulation).unwrap();
    assert_eq!(sensors.reading("slow").unwrap().numbers, [1.0, 0.25]);

    sensors.step(&mut simulation, 15).unwrap();
    simulation.set_joint_state(1, &[0.5], &[0.0]).unwrap();
    sensors.step(&mut simulation, 5).unwrap();
    let reading = sensors.reading("slow").unwrap();
    assert_eq!(reading.numbers[1], 0.5);
    close("time of world 0", reading.time[0], 0.04, 1e-9);
    close("time of world 1", reading.time[1], 0.0, 1e-9);
    sensors.step(&mut simulation, 5).unwrap();
    let reading = sensors.reading("slow").unwrap();
    assert_eq!(reading.numbers[1], simulation.outputs().coordinate(1, 0));
    let reading = sensors.reading("slow").unwrap();
    close("time of world 0", reading.time[0], 0.04, 1e-9);
    close("time of world 1", reading.time[1], 0.02, 1e-9);
}

/// What was moved at a time at which samples were taken is seen when they are taken anew, by those of that time alone.
#[test]
fn samples_of_now_are_taken_anew() {
    let mut simulation = falling(2, 0.002);
    let walk = kinetarium_sensors::Noise {
        walk: 1.0.into(),
        ..kinetarium_sensors::Noise::white(0.1)
    };
    let list = vec![
        angle("slow").with_rate(50.0),
        angle("fast").with_noise(walk),
    ];
    let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    sensors.step(&mut simulation, 15).unwrap();
    let read = |sensors: &Sensors<f64>, name| sensors.reading(name).unwrap().numbers.to_vec();
    let (slow, fast) = (read(&sensors, "slow"), read(&sensors, "fast"));
    let angle = simulation.outputs().coordinate(1, 0);
    simulation.move_joints(1, &[angle + 0.25], &[0.0]).unwrap();
    sensors.update(&mut simulation).unwrap();
    assert_eq!(read(&sensors, "fast"), fast);
    for _ in 0..2 {
        sensors.resample(&mut simulation).unwrap();
        assert_eq!(read(&sensors, "slow"), slow);
        let anew = read(&sensors, "fast");
        close("world 0", anew[0], fast[0], 1e-12);
        close("world 1", anew[1], fast[1] + 0.25, 1e-12);
    }
}

/// A world that diverged keeps its last reading, and does not hold up the others.
#[test]
fn a_world_that_diverged_does_not_stop_the_others() {
    let mut simulation = falling(2, 0.002);
    let list = vec![angle("slow").with_rate(50.0)];
    let mut sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    simulation.controls().set_dof_force(0, 0, 1e20).unwrap();
    let diverged = sensors.step(&mut simulation, 100).unwrap();
    assert_eq!(diverged.len(), 1);
    assert_eq!(diverged[0].world, 0);
    let reading = sensors.reading("slow").unwrap();
    assert!(reading.numbers[0].is_finite());
    close("time of world 1", reading.time[1], 0.2, 1e-9);
}
