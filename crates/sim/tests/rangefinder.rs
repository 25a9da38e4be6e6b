//! Rays that many worlds cast in lanes go as far as each does alone.

mod solids;
#[path = "../../rigid/tests/scene/surroundings.rs"]
mod surroundings;

use glam::DVec3;
use kinetarium_sim::{Ray, Simulation, SimulationError, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Model, Mount, Pose, Shape};
use numbers::Float;
use solids::{PLANE, scenery};
use surroundings::{directions, flights, somewhere, surroundings};

const EYE: BodyId = BodyId(0);

/// Distances of all worlds' rays, and those of rays that are cast one by one.
fn both<T: Float>(
    simulation: &mut Simulation<T>,
    mount: Mount,
    directions: &[DVec3],
    range: f64,
) -> (Vec<f64>, Vec<f64>) {
    let worlds: Vec<_> = (0..simulation.worlds()).collect();
    let mut finder = simulation.rangefinder(mount, directions, range).unwrap();
    let mut distances = vec![T::zero(); worlds.len() * directions.len()];
    simulation
        .measure_ranges(&mut finder, &worlds, &mut distances)
        .unwrap();
    let outputs = simulation.outputs();
    let place = |&world: &usize| {
        let carrier = mount.body.map(|body| outputs.body_pose(world, body));
        carrier.unwrap_or(Pose::IDENTITY) * mount.pose
    };
    let places: Vec<_> = worlds.iter().map(place).collect();
    let rays = places.iter().flat_map(|at| {
        directions.iter().map(|&d| Ray {
            origin: at.position,
            direction: at.direction(d),
            max_distance: range,
        })
    });
    let rays: Vec<_> = rays.collect();
    let hits = simulation.cast_rays_in_worlds(&worlds, &rays, mount.body);
    let alone = hits.unwrap().into_iter();
    let alone = alone.map(|hit| hit.map_or(range, |hit| hit.distance));
    (
        distances.iter().map(|x| x.to_f64()).collect(),
        alone.collect(),
    )
}

fn flown<T: Float>(solver: SolverKind, model: &Model, worlds: usize) -> Simulation<T> {
    let settings = SimulationSettings {
        solver,
        threads: 2,
        ..SimulationSettings::new(worlds, 0.01)
    };
    let mut simulation = Simulation::new(model.clone(), settings).unwrap();
    for world in 0..worlds {
        let position = flights(world, model.bodies.len());
        let velocity = vec![0.1; model.degrees_of_freedom()];
        simulation
            .set_joint_state(world, &position, &velocity)
            .unwrap();
    }
    simulation.step(3);
    assert!(simulation.diverged().is_empty());
    simulation
}

/// Largest relative difference, but for so large a share of all; what is met by one alone is far apart.
fn apart((ours, theirs): (Vec<f64>, Vec<f64>), range: f64, but: f64) -> f64 {
    let off = |(a, b): (&f64, &f64)| match (*a == range, *b == range) {
        (true, true) => 0.0,
        (false, false) => (a - b).abs() / b.max(1.0),
        _ => f64::INFINITY,
    };
    let mut off: Vec<_> = ours.iter().zip(&theirs).map(off).collect();
    off.sort_by(f64::total_cmp);
    off[((1.0 - but) * off.len() as f64).ceil() as usize - 1]
}

#[test]
fn lanes_measure_what_rays_meet_one_by_one() {
    let model = surroundings();
    let mount = Mount {
        body: Some(EYE),
        pose: somewhere(50),
    };
    let fixed = Mount {
        body: None,
        ..mount
    };
    let directions = directions(60);
    for solver in [
        SolverKind::Featherstone,
        SolverKind::Xpbd,
        SolverKind::Impulse,
    ] {
        for mount in [mount, fixed] {
            for range in [f64::INFINITY, 4.0, 0.0] {
                let mut exact = flown::<f64>(solver, &model, 37);
                let pair = both(&mut exact, mount, &directions, range);
                let met = pair.1.iter().filter(|x| **x < range).count();
                assert!(range == 0.0 || met > pair.1.len() / 8, "{met} are met");
                assert!(apart(pair, range, 0.0) < 1e-9);
                let mut single = flown::<f32>(solver, &model, 37);
                let pair = both(&mut single, mount, &directions, range);
                // One by one they are cast in double precision.
                let same = |(a, b): (&f64, &f64)| *a as f32 == *b as f32;
                assert!(range == 0.0 || !pair.0.iter().zip(&pair.1).all(same));
                // In single precision a ray that just misses an edge may meet it.
                assert!(apart(pair, range, 2e-3) < 2e-5);
            }
        }
    }
}

/// In one world, and in worlds of `impulse`, lanes are rays of one world.
#[test]
fn lanes_are_rays_where_worlds_are_looked_at_one_by_one() {
    let model = surroundings();
    let mount = Mount::on(EYE).at(somewhere(50));
    for (solver, worlds) in [(SolverKind::Featherstone, 1), (SolverKind::Impulse, 3)] {
        // One more than a whole number of lanes, and several times what one thread takes at once.
        for rays in [14, 30, 2500] {
            let directions = directions(rays);
            let pair = both(
                &mut flown::<f64>(solver, &model, worlds),
                mount,
                &directions,
                9.0,
            );
            assert!(apart(pair, 9.0, 0.0) < 1e-9);
            let pair = both(
                &mut flown::<f32>(solver, &model, worlds),
                mount,
                &directions,
                9.0,
            );
            assert!(apart(pair, 9.0, 2e-3) < 2e-5);
        }
    }
}

/// A crate on a floor, and one ray, by all solvers.
#[test]
fn a_single_ray_measures_how_high_it_starts() {
    fn heights<T: Float>(solver: SolverKind, worlds: usize) -> Vec<f64> {
        let mut world = Builder::new("crate");
        let object = world.object("things");
        object.scenery(Shape::new(PLANE));
        let half = DVec3::splat(0.5);
        object
            .body("crate")
            .at(Pose::at(0.5 * DVec3::Y))
            .shape(Geometry::Box { half });
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(worlds, 0.01)
        };
        let mut simulation = Simulation::<T>::new(world.build().unwrap(), settings).unwrap();
        let all: Vec<_> = (0..worlds).collect();
        let of = |simulation: &mut Simulation<T>, mount| {
            let mut finder = simulation
                .rangefinder(mount, &[-DVec3::Y], f64::INFINITY)
                .unwrap();
            let mut distances = vec![T::zero(); worlds];
            simulation
                .measure_ranges(&mut finder, &all, &mut distances)
                .unwrap();
            Vec::from_iter(distances.iter().map(|x| x.to_f64()))
        };
        let above = Mount::in_world(Pose::at(3.0 * DVec3::Y));
        let beside = Mount::on(BodyId(0)).at(Pose::at(DVec3::new(2.0, 0.25, 0.0)));
        [of(&mut simulation, above), of(&mut simulation, beside)].concat()
    }
    for solver in [
        SolverKind::Featherstone,
        SolverKind::Xpbd,
        SolverKind::Impulse,
    ] {
        for worlds in [1, 3, 17] {
            let expected = [vec![2.0; worlds], vec![0.75; worlds]].concat();
            assert_eq!(heights::<f32>(solver, worlds), expected, "{solver:?}");
            assert_eq!(heights::<f64>(solver, worlds), expected, "{solver:?}");
        }
    }
}

/// In single precision a floor is as near a kilometre from its origin as it is there.
#[test]
fn a_floor_is_as_exact_far_from_its_origin() {
    let floor = scenery([Shape::new(PLANE).without_contact()]);
    let settings = SimulationSettings::new(20, 0.01);
    let mut simulation = Simulation::<f32>::new(floor, settings).unwrap();
    for far in [0.0, 1e2, 1e3, 1e4] {
        let mount = Mount::in_world(Pose::at(DVec3::new(far, 1.5, -far)));
        let down = DVec3::new(0.6, -0.8, 0.0);
        let mut finder = simulation
            .rangefinder(mount, &[down], f64::INFINITY)
            .unwrap();
        let mut distance = [0.0];
        simulation
            .measure_ranges(&mut finder, &[7], &mut distance)
            .unwrap();
        assert!(
            (distance[0] - 1.875_f32).abs() < 1e-6,
            "{far}: {distance:?}"
        );
    }
}

#[test]
fn worlds_measure_the_same_whichever_are_asked() {
    let model = surroundings();
    let directions = directions(5);
    let mut simulation = flown::<f32>(SolverKind::Featherstone, &model, 37);
    let mount = Mount {
        body: Some(EYE),
        pose: Pose::IDENTITY,
    };
    let mut finder = simulation.rangefinder(mount, &directions, 9.0).unwrap();
    let mut of = |worlds: &[usize]| {
        let mut distances = vec![-1.0; worlds.len() * finder.rays()];
        simulation
            .measure_ranges(&mut finder, worlds, &mut distances)
            .unwrap();
        distances
    };
    let all = of(&Vec::from_iter(0..37));
    let rays = directions.len();
    let some = [36, 3, 3, 20];
    let expected = some.iter().flat_map(|w| &all[w * rays..(w + 1) * rays]);
    assert_eq!(of(&some), Vec::from_iter(expected.copied()));
    assert!(of(&[]).is_empty());
    // Alone, in a simulation of one world.
    let mut alone = Simulation::<f32>::new(
        model.clone(),
        SimulationSettings {
            solver: SolverKind::Featherstone,
            scalar: true,
            ..SimulationSettings::new(37, 0.01)
        },
    )
    .unwrap();
    alone.restore(&simulation.snapshot()).unwrap();
    let mut finder = alone.rangefinder(mount, &directions, 9.0).unwrap();
    let mut one = vec![0.0; rays];
    alone.measure_ranges(&mut finder, &[20], &mut one).unwrap();
    let close = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-4;
    assert!(one.iter().zip(&all[20 * rays..]).all(close), "{one:?}");
}

/// A floor 1 m below, which one world has at 2 m.
#[test]
fn worlds_of_their_own_have_floors_of_their_own() {
    let floor = |y: f64| {
        scenery([Shape::new(PLANE)
            .at(Pose::at(y * DVec3::Y))
            .without_contact()])
    };
    let mut simulation =
        Simulation::<f32>::new(floor(-1.0), SimulationSettings::new(3, 0.01)).unwrap();
    let mount = Mount {
        body: None,
        pose: Pose::IDENTITY,
    };
    let mut finder = simulation
        .rangefinder(mount, &[-DVec3::Y], f64::INFINITY)
        .unwrap();
    let mut distances = [0.0; 3];
    simulation
        .measure_ranges(&mut finder, &[0, 1, 2], &mut distances)
        .unwrap();
    assert_eq!(distances, [1.0; 3]);
    simulation.set_world_model(1, &floor(-2.0)).unwrap();
    simulation
        .measure_ranges(&mut finder, &[0, 1, 2], &mut distances)
        .unwrap();
    assert_eq!(distances, [1.0, 2.0, 1.0]);
}

#[test]
fn what_is_wrong_is_told() {
    fn says<T: std::fmt::Debug>(result: Result<T, SimulationError>, message: &str) {
        let error = result.unwrap_err().to_string();
        assert!(
            error.contains(message),
            "`{error}` does not say `{message}`"
        );
    }
    let model = scenery([Shape::new(PLANE)]);
    let mut simulation =
        Simulation::<f32>::new(model.clone(), SimulationSettings::new(2, 0.01)).unwrap();
    let mount = |body| Mount {
        body,
        pose: Pose::IDENTITY,
    };
    let make = |body, d: DVec3, range| simulation.rangefinder(mount(body), &[DVec3::X, d], range);
    says(make(Some(BodyId(5)), DVec3::X, 1.0), "body 5");
    says(make(None, DVec3::ZERO, 1.0), "rangefinder 1");
    says(make(None, DVec3::NAN, 1.0), "direction");
    says(make(None, DVec3::X, -1.0), "largest distance");
    let nowhere = Mount::in_world(Pose::at(DVec3::NAN));
    says(
        simulation.rangefinder(nowhere, &[DVec3::X], 1.0),
        "position",
    );
    let mut unturned = mount(None);
    unturned.pose.orientation *= 0.0;
    says(
        simulation.rangefinder(unturned, &[DVec3::X], 1.0),
        "orientation",
    );
    let mut finder = make(None, DVec3::X, 1.0).unwrap();
    let mut room = [0.0; 4];
    says(
        simulation.measure_ranges(&mut finder, &[2], &mut room[..2]),
        "world 2",
    );
    says(
        simulation.measure_ranges(&mut finder, &[0], &mut room),
        "distances",
    );
    let ball = scenery([Shape::new(Geometry::Sphere { radius: 1.0 })]);
    let mut other = Simulation::<f32>::new(ball, SimulationSettings::new(2, 0.01)).unwrap();
    says(
        other.measure_ranges(&mut finder, &[0, 1], &mut room),
        "another model",
    );
    let mut other = Simulation::<f32>::new(model, SimulationSettings::new(3, 0.01)).unwrap();
    says(
        other.measure_ranges(&mut finder, &[0, 1], &mut room),
        "rangefinder",
    );

    let file = Geometry::MeshFile {
        file: "arm.stl".into(),
        scale: DVec3::ONE,
    };
    let shape = Shape::new(file).named("arm").without_contact();
    let mut unread =
        Simulation::<f32>::new(scenery([shape]), SimulationSettings::new(2, 0.01)).unwrap();
    let mut finder = unread.rangefinder(mount(None), &[DVec3::X], 1.0).unwrap();
    says(
        unread.measure_ranges(&mut finder, &[0], &mut room[..1]),
        "arm",
    );
}
