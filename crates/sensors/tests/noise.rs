//! Noise: its size, and that it is the same whatever else runs.

mod common;

use common::{close, eye, pendulum, simulate};
use glam::DVec3;
use kinetarium_sensors::{
    Camera, Channels, ImageNoise, Images, Level, Mount, Noise, Sensor, SensorKind, Sensors, View,
};
use model::{BodyId, Builder, Geometry, JointId, Pose, Shape};
use sim::{Simulation, SimulationSettings, SolverKind};
use std::f64::consts::PI;

fn angle() -> SensorKind {
    let joints = vec![JointId(0)];
    SensorKind::JointPosition { joints }
}

fn imu() -> SensorKind {
    let mount = Mount::on(BodyId(0));
    SensorKind::Imu { mount }
}

/// Worlds that hang at rest: what is measured is 0, so that readings are the noise.
fn hanging(worlds: usize) -> Simulation<f64> {
    simulate(&pendulum(), SolverKind::Featherstone, worlds, 0.01)
}

/// All readings of the angle over so many steps, step after step.
fn angles(noise: Noise, worlds: usize, steps: usize) -> Vec<Vec<f64>> {
    let mut simulation = hanging(worlds);
    let sensor = Sensor::new("angle", angle()).with_noise(noise);
    let mut sensors = Sensors::new(&mut simulation, vec![sensor], 5).unwrap();
    let read = |_| {
        sensors.step(&mut simulation, 1).unwrap();
        sensors.reading("angle").unwrap().numbers.to_vec()
    };
    (0..steps).map(read).collect()
}

/// Mean and variance of n numbers of deviation σ are off by σ/√n and σ² √(2/n) in standard deviation; five of
/// these are allowed.
#[track_caller]
fn normal(what: &str, x: &[f64], deviation: f64) {
    let n = x.len() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let variance = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    close(what, mean, 0.0, 5.0 * deviation / n.sqrt());
    let tolerance = 5.0 * (2.0 / n).sqrt();
    close(what, variance / (deviation * deviation), 1.0, tolerance);
}

#[test]
fn white_noise_has_its_standard_deviation_and_no_memory() {
    let readings = angles(Noise::white(0.3), 100, 200);
    let all = readings.concat();
    normal("white noise", &all, 0.3);
    let product = |pair: &[Vec<f64>]| -> f64 {
        let both = pair[0].iter().zip(&pair[1]);
        both.map(|(a, b)| a * b / 0.09).sum()
    };
    let n = 100.0 * 199.0;
    let correlation = readings.windows(2).map(product).sum::<f64>() / n;
    close("correlation", correlation, 0.0, 5.0 / n.sqrt());
}

#[test]
fn a_bias_is_drawn_once_for_each_world() {
    let noise = Noise {
        bias: Level::All(0.2),
        ..Noise::default()
    };
    let readings = angles(noise, 3000, 3);
    normal("bias", &readings[0], 0.2);
    assert!(readings.iter().all(|r| *r == readings[0]));
}

/// After t seconds the variance is σ² t; increments of steps that do not overlap are independent.
#[test]
fn a_bias_that_walks_spreads_with_the_root_of_time() {
    let noise = Noise {
        walk: Level::All(0.2),
        ..Noise::default()
    };
    let readings = angles(noise, 3000, 100);
    for (step, readings) in readings.iter().enumerate().step_by(33) {
        let t = (step + 1) as f64 * 0.01;
        normal(&format!("walk after {t} s"), readings, 0.2 * t.sqrt());
    }
    let later: Vec<f64> = readings[99]
        .iter()
        .zip(&readings[49])
        .map(|(a, b)| a - b)
        .collect();
    normal("walk of the last half", &later, 0.2 * 0.5_f64.sqrt());
}

#[test]
fn readings_are_multiples_of_their_step() {
    let noise = Noise {
        step: Level::All(0.05),
        ..Noise::white(0.3)
    };
    let all = angles(noise, 20, 20).concat();
    assert!(all.iter().any(|x| x.abs() > 0.3));
    for x in all {
        close(
            "distance to a multiple",
            (x / 0.05).fract().abs() % 1.0 % 0.999_999_999,
            0.0,
            1e-8,
        );
    }
}

#[test]
fn each_number_may_have_its_own_level() {
    let levels = vec![0.0, 0.1, 0.0, 0.0, 1.0, 0.0];
    let mut simulation = hanging(2000);
    let exact = Sensor::new("exact", imu());
    let noisy = Sensor::new("noisy", imu()).with_noise(Noise::white(levels.clone()));
    let sensors = Sensors::new(&mut simulation, vec![exact, noisy], 5).unwrap();
    let [exact, noisy] = ["exact", "noisy"].map(|name| sensors.reading(name).unwrap().numbers);
    for (i, level) in levels.iter().enumerate() {
        let errors: Vec<f64> = (0..2000)
            .map(|w| noisy[6 * w + i] - exact[6 * w + i])
            .collect();
        if *level == 0.0 {
            assert!(errors.iter().all(|e| *e == 0.0));
        } else {
            normal("level", &errors, *level);
        }
    }
}

/// Everything at once, in `f32`.
fn noisy() -> Vec<Sensor> {
    let noise = Noise {
        deviation: Level::All(0.1),
        bias: Level::All(0.2),
        walk: Level::All(0.3),
        step: Level::All(1e-4),
    };
    let sensor = |name: &str, kind| Sensor::new(name, kind).with_noise(noise.clone());
    vec![
        sensor("angle", angle()),
        sensor("imu", imu()).with_rate(30.0),
    ]
}

fn swinging(worlds: usize, threads: usize) -> Simulation<f32> {
    let settings = SimulationSettings {
        threads,
        ..SimulationSettings::new(worlds, 0.01)
    };
    let mut simulation = Simulation::new(pendulum(), settings).unwrap();
    for world in 0..worlds {
        let angle = 0.1 * world as f64;
        simulation.set_joint_state(world, &[angle], &[0.0]).unwrap();
    }
    simulation
}

fn readings(sensors: &Sensors<f32>) -> [Vec<f32>; 2] {
    ["angle", "imu"].map(|name| sensors.reading(name).unwrap().numbers.to_vec())
}

#[test]
fn a_world_reads_the_same_among_any_number_of_worlds_and_threads() {
    let run = |worlds: usize, threads: usize, list: Vec<Sensor>| {
        let mut simulation = swinging(worlds, threads);
        let mut sensors = Sensors::new(&mut simulation, list, 5).unwrap();
        sensors.step(&mut simulation, 50).unwrap();
        readings(&sensors)
    };
    let [one_angle, one_imu] = run(1, 1, noisy());
    let [angle, imu] = run(200, 1, noisy());
    assert_eq!(one_angle, angle[..1]);
    assert_eq!(one_imu, imu[..6]);
    assert_eq!([&angle, &imu], run(200, 2, noisy()).each_ref());
    assert_ne!(angle[0], angle[1]);
    // Another sensor beside them, and another order, change nothing.
    let mut list = noisy();
    list.push(Sensor::new("other", self::imu()).with_noise(Noise::white(1.0)));
    list.reverse();
    assert_eq!([angle, imu], run(200, 1, list));
}

#[test]
fn another_seed_or_name_gives_other_noise() {
    let first = |seed: u64, name: &str| {
        let mut simulation = hanging(1);
        let sensor = Sensor::new(name, angle()).with_noise(Noise::white(1.0));
        let sensors = Sensors::new(&mut simulation, vec![sensor], seed).unwrap();
        sensors.reading(name).unwrap().numbers[0]
    };
    assert_eq!(first(1, "a"), first(1, "a"));
    assert_ne!(first(1, "a"), first(2, "a"));
    assert_ne!(first(1, "a"), first(1, "b"));
}

#[test]
fn what_was_saved_goes_on_as_it_would_have() {
    let mut simulation = swinging(70, 1);
    let mut sensors = Sensors::new(&mut simulation, noisy(), 5).unwrap();
    sensors.step(&mut simulation, 17).unwrap();
    let (snapshot, saved) = (simulation.snapshot(), sensors.save());
    let at = readings(&sensors);
    sensors.step(&mut simulation, 40).unwrap();
    let expected = readings(&sensors);

    simulation.restore(&snapshot).unwrap();
    sensors.restore(&saved).unwrap();
    sensors.update(&mut simulation).unwrap();
    assert_eq!(readings(&sensors), at);
    sensors.step(&mut simulation, 40).unwrap();
    assert_eq!(readings(&sensors), expected);

    // And elsewhere.
    let mut other = swinging(70, 2);
    let mut elsewhere = Sensors::new(&mut other, noisy(), 5).unwrap();
    other.restore(&snapshot).unwrap();
    elsewhere.restore(&saved).unwrap();
    elsewhere.step(&mut other, 40).unwrap();
    assert_eq!(readings(&elsewhere), expected);
}

#[test]
fn a_state_of_others_or_a_damaged_one_is_refused() {
    let mut simulation = swinging(4, 1);
    let mut sensors = Sensors::new(&mut simulation, noisy(), 5).unwrap();
    let saved = sensors.save();
    let refused =
        |sensors: &mut Sensors<f32>, bytes: &[u8]| sensors.restore(bytes).unwrap_err().to_string();
    assert!(refused(&mut sensors, b"nonsense").contains("KNTRMSNS"));
    for cut in [8, 9, 12, 20, saved.len() / 2, saved.len() - 1] {
        assert!(refused(&mut sensors, &saved[..cut]).contains("damaged"));
    }
    for byte in (0..saved.len()).step_by(7) {
        let mut damaged = saved.clone();
        damaged[byte] ^= 4;
        sensors.restore(&damaged).unwrap_err();
    }
    let mut other = Sensors::new(&mut simulation, noisy(), 6).unwrap();
    assert!(refused(&mut other, &saved).contains("another seed"));
    sensors.restore(&saved).unwrap();
}

/// A world that begins anew draws new noise, but keeps its bias.
#[test]
fn an_episode_has_noise_of_its_own_and_the_bias_of_its_world() {
    let first = |noise: Noise| {
        let mut simulation = hanging(2);
        let sensor = Sensor::new("angle", angle()).with_noise(noise);
        let mut sensors = Sensors::new(&mut simulation, vec![sensor], 5).unwrap();
        let before = sensors.reading("angle").unwrap().numbers.to_vec();
        sensors.step(&mut simulation, 5).unwrap();
        simulation.reset(&[1]).unwrap();
        sensors.update(&mut simulation).unwrap();
        let after = sensors.reading("angle").unwrap();
        assert_eq!(after.time[1], 0.0);
        [before[1], after.numbers[1]]
    };
    let [before, after] = first(Noise::white(1.0));
    assert_ne!(before, after);
    let [before, after] = first(Noise {
        bias: Level::All(1.0),
        ..Noise::default()
    });
    assert_eq!(before, after);
    let [before, after] = first(Noise {
        walk: Level::All(1.0),
        ..Noise::default()
    });
    assert_eq!([before, after], [0.0; 2]);
}

/// A deviation of s of the numbers of a quaternion turns by 2 s about each axis.
#[test]
fn noisy_quaternions_have_unit_length() {
    let mut simulation = hanging(3000);
    let (mount, relative_to) = (Mount::on(BodyId(0)), Mount::default());
    let sensor = Sensor::new("pose", SensorKind::FramePose { mount, relative_to });
    let sensor = sensor.with_noise(Noise::white(0.01));
    let sensors = Sensors::new(&mut simulation, vec![sensor], 5).unwrap();
    let poses = sensors.reading("pose").unwrap().numbers.chunks_exact(7);
    let turns: Vec<f64> = poses
        .map(|pose| {
            let q = glam::DQuat::from_slice(&pose[3..]);
            close("length", q.length(), 1.0, 1e-12);
            2.0 * q.x * q.w.signum()
        })
        .collect();
    normal("turn about x", &turns, 0.02);
}

/// Distances to a wall 1 m away, and away from it, in 200 worlds at 20 samples, with a largest range.
fn ranges(max_range: f64) -> Vec<[f64; 2]> {
    let mut world = Builder::new("wall");
    let wall = Shape::new(Geometry::Box { half: DVec3::ONE });
    let wall = wall.at(Pose::at(2.0 * DVec3::X));
    world.object("").scenery(wall);
    let settings = SimulationSettings::new(200, 0.01);
    let mut simulation = Simulation::<f64>::new(world.build().unwrap(), settings).unwrap();
    let kind = SensorKind::Lidar {
        mount: Mount::default(),
        azimuths: vec![0.0, PI],
        elevations: vec![0.0],
        max_range,
    };
    let noise = Noise {
        deviation: Level::All(0.1),
        bias: Level::All(0.1),
        walk: Level::All(0.1),
        step: Level::All(0.04),
    };
    let sensor = Sensor::new("lidar", kind).with_noise(noise);
    let mut sensors = Sensors::new(&mut simulation, vec![sensor], 5).unwrap();
    let read = |_| {
        sensors.step(&mut simulation, 1).unwrap();
        let (pairs, []) = sensors.reading("lidar").unwrap().numbers.as_chunks() else {
            panic!("two rays a world");
        };
        pairs.to_vec()
    };
    (0..20).flat_map(read).collect()
}

/// What a bias lifts to the range is still seen, and no multiple of the step is beyond the range.
#[test]
fn noisy_distances_are_cut_off_at_the_range_and_are_else_as_without() {
    let (near, far) = (ranges(1.05), ranges(100.0));
    assert!(near.iter().any(|[seen, _]| *seen < 1.0));
    for ([seen, nothing], [beyond, _]) in near.into_iter().zip(far) {
        assert_eq!(seen, beyond.clamp(0.0, 1.05));
        assert_eq!(nothing, 1.05);
    }
}

/// Images of a grey wall 2 m away, and of nothing beside it, in so many worlds.
fn noisy_images(worlds: usize, threads: usize, steps: usize) -> Images {
    let mut world = Builder::new("wall");
    let half = DVec3::new(0.5, 10.0, 0.1);
    let wall = Shape::new(Geometry::Box { half });
    let mut grey = wall.at(Pose::at(DVec3::new(0.5, 0.0, -2.1)));
    grey.color = Some([0.5, 0.5, 0.5, 1.0]);
    world.object("").scenery(grey);
    let settings = SimulationSettings {
        threads,
        ..SimulationSettings::new(worlds, 0.01)
    };
    let mut simulation = Simulation::<f32>::new(world.build().unwrap(), settings).unwrap();
    let camera = Camera::new(40, 30, 0.5).looking(DVec3::ZERO, -DVec3::Z, DVec3::Y);
    let view = View::new(camera).with_channels(Channels::ALL);
    let noise = ImageNoise {
        rgb: 0.03,
        depth: 0.05,
    };
    let sensor = Sensor::new("eye", eye(view, noise));
    let mut sensors = Sensors::new(&mut simulation, vec![sensor], 7).unwrap();
    sensors.step(&mut simulation, steps).unwrap();
    sensors.images("eye").unwrap().images.clone()
}

/// Colours and depth of what is seen, 600 pixels in each of 20 worlds: of 12 000 numbers the deviation is known to
/// 0.65 %, and as [`normal`] allows.
#[test]
fn images_have_the_noise_that_is_asked_for() {
    let images = noisy_images(20, 2, 0);
    let (rgb, depth, body) = (
        images.rgb.unwrap(),
        images.depth.unwrap(),
        images.shape.unwrap(),
    );
    let seen = |pixel: &usize| body[*pixel] >= 0;
    let pixels: Vec<usize> = (0..depth.len()).filter(seen).collect();
    assert!((11_000..=12_000).contains(&pixels.len()));
    let off: Vec<f64> = pixels.iter().map(|p| f64::from(depth[*p]) - 2.0).collect();
    normal("depth", &off, 0.05);
    let infinite = (0..depth.len()).filter(|p| !seen(p));
    infinite.for_each(|p| assert!(depth[p].is_infinite()));
    for channel in 0..3 {
        let values: Vec<f64> = pixels
            .iter()
            .map(|p| f64::from(rgb[3 * p + channel]))
            .collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!(
            (40.0..215.0).contains(&mean),
            "no value is at an end: {mean}"
        );
        // Rounding to whole numbers adds a variance of 1/12.
        let expected = ((255.0_f64 * 0.03).powi(2) + 1.0 / 12.0).sqrt();
        let off: Vec<f64> = values.iter().map(|x| x - mean).collect();
        normal("colour", &off, expected);
    }
}

#[test]
fn noise_of_images_is_a_function_of_world_and_sample() {
    let many = noisy_images(5, 3, 2);
    assert_eq!(many, noisy_images(5, 1, 2));
    let (one, later) = (noisy_images(1, 1, 2), noisy_images(1, 1, 3));
    let first = |images: &Images| images.rgb.as_ref().unwrap()[..3 * 40 * 30].to_vec();
    assert_eq!(first(&many), first(&one));
    assert_ne!(first(&later), first(&one));
    let all = many.depth.unwrap();
    assert_ne!(all[..1200], all[1200..2400]);
    assert_eq!(all[..1200], one.depth.unwrap());
}
