//! Centres of mass, and inertias, velocities and forces of bodies about those of their trees.

use glam::{DMat3, DVec3};
use kinetarium_sim::{Parameter, Quantity, Simulation, SimulationSettings, SolverKind};
use model::{BodyKind, Builder, Geometry, JointKind, Model, Pose, Shape};

const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
const WORLDS: usize = 11;

/// Three trees, a floating pair and two arms on a static post, with masses off all axes.
fn scene() -> Model {
    let mut world = Builder::new("scene");
    let half = DVec3::new(0.1, 0.2, 0.3);
    let cube = || Shape::from(Geometry::Box { half });
    let things = world.object("things");
    let post = things.body("post").shape(cube()).immovable().handle();
    let arm = things.body("arm").shape(cube()).group(0).handle();
    let hinge = things.revolute("hinge", arm, DVec3::Z);
    hinge.parent(post).at(Pose::at(DVec3::new(0.0, 0.5, 0.0)));
    let lever = things.body("lever").shape(cube()).group(0).handle();
    things.prismatic("rail", lever, DVec3::X).parent(post);
    let base = things.body("base").shape(cube()).group(0).handle();
    things
        .free("float", base)
        .initial(&[2.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0]);
    let limb = things.body("limb").shape(cube()).group(0).handle();
    let shoulder = things.ball("shoulder", limb);
    shoulder.parent(base).frames(
        Pose::at(DVec3::new(0.3, 0.1, 0.0)),
        Pose::at(DVec3::new(0.0, -0.4, 0.1)),
    );
    let mut parts = world.build().unwrap().into_parts();
    for (i, body) in parts.bodies.iter_mut().enumerate() {
        body.mass = 1.0 + i as f64;
        body.center = DVec3::new(0.1, -0.2, 0.05) * (1.0 + 0.3 * i as f64);
        body.inertia =
            DMat3::from_cols_array(&[0.3, 0.02, -0.05, 0.02, 0.4, 0.03, -0.05, 0.03, 0.5]);
    }
    parts.gravity = DVec3::new(0.0, -9.81, 0.0);
    Model::new(parts).unwrap()
}

/// Worlds that move, each in its own way.
fn moving(solver: SolverKind) -> Simulation<f64> {
    let model = scene();
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(WORLDS, 0.001)
    };
    let dofs = model.degrees_of_freedom();
    let start = model.initial_position();
    let mut sim = Simulation::new(model, settings).unwrap();
    for world in 0..WORLDS {
        let velocity: Vec<_> = (0..dofs)
            .map(|i| ((3 * i + 7 * world) as f64).sin())
            .collect();
        sim.set_joint_state(world, &start, &velocity).unwrap();
    }
    sim.step(40);
    sim
}

fn read(sim: &mut Simulation<f64>, quantity: Quantity) -> Vec<Vec<f64>> {
    let [rows, width] = quantity.shape(sim.model());
    let mut out = vec![f64::NAN; sim.worlds() * rows * width];
    sim.read(quantity, &mut out).unwrap();
    out.chunks(rows * width).map(<[f64]>::to_vec).collect()
}

/// Rows of the bodies of each tree.
fn trees(model: &Model) -> Vec<Vec<usize>> {
    let row = |name| model.body(name).unwrap().0;
    vec![
        vec![row("arm")],
        vec![row("lever")],
        vec![row("base"), row("limb")],
    ]
}

/// Of some bodies of a world: mass, and C = Σ m c / Σ m with c = x + R c₀.
fn center(sim: &mut Simulation<f64>, world: usize, bodies: &[usize]) -> (f64, DVec3) {
    let model = sim.world_model(world).clone();
    let outputs = sim.outputs();
    let (mut mass, mut sum) = (0.0, DVec3::ZERO);
    for &b in bodies {
        let body = &model.bodies[b];
        mass += body.mass;
        sum += body.mass
            * outputs
                .body_pose(world, model::BodyId(b))
                .point(body.center);
    }
    (mass, sum / mass)
}

#[test]
fn centers_of_mass_are_of_all_that_is_not_static() {
    for solver in SOLVERS {
        let mut sim = moving(solver);
        let found = read(&mut sim, Quantity::CenterOfMass);
        let bodies: Vec<_> = trees(sim.model()).concat();
        for (world, found) in found.iter().enumerate() {
            let (_, expected) = center(&mut sim, world, &bodies);
            // Sums of four terms of a few metres: a few of 2⁻⁵².
            let error = (DVec3::from_slice(found) - expected).length();
            assert!(error < 1e-14, "{solver:?}, world {world}: {error:e}");
        }
        assert_ne!(found[0], found[1]);
    }
}

/// About its centre of mass C a tree has the momentum p = Σ m v − md × ω and the angular momentum
/// L = Σ I ω + md × v, with which the solver's own totals are p and L + C × p.
#[test]
fn inertias_and_velocities_give_the_momentum() {
    for solver in SOLVERS {
        let mut sim = moving(solver);
        let inertias = read(&mut sim, Quantity::SpatialInertia);
        let velocities = read(&mut sim, Quantity::SpatialVelocity);
        let trees = trees(sim.model());
        for world in 0..WORLDS {
            let (mut momentum, mut angular) = (DVec3::ZERO, DVec3::ZERO);
            for tree in &trees {
                let (mass, at) = center(&mut sim, world, tree);
                let [mut p, mut l, mut md_sum] = [DVec3::ZERO; 3];
                let mut m_sum = 0.0;
                for &b in tree {
                    let i = &inertias[world][10 * b..][..10];
                    let v = &velocities[world][6 * b..][..6];
                    let inertia = DMat3::from_cols_array(&[
                        i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2],
                    ]);
                    let (md, m) = (DVec3::from_slice(&i[6..]), i[9]);
                    let (w, v) = (DVec3::from_slice(v), DVec3::from_slice(&v[3..]));
                    p += m * v - md.cross(w);
                    l += inertia * w + md.cross(v);
                    md_sum += md;
                    m_sum += m;
                }
                assert_eq!(m_sum, mass);
                // C is the centre of the tree.
                assert!(md_sum.length() < 1e-14, "{md_sum}");
                momentum += p;
                angular += l + at.cross(p);
            }
            let outputs = sim.outputs();
            let wrong = (momentum - outputs.momentum(world)).length();
            let turned = (angular - outputs.angular_momentum(world)).length();
            // Momenta are of the order of 10; `impulse` and `xpbd` keep velocities of bodies and sum them in
            // other orders, to rounding, and orientations of unit length to 1e-12.
            assert!(
                wrong < 1e-11 && turned < 1e-11,
                "{solver:?}: {wrong:e} {turned:e}"
            );
            assert!(momentum.length() > 1.0 && angular.length() > 1.0);
        }
    }
}

/// A rod on a hinge at the origin: the inertia along the world's axes is Rz(θ) I₀ Rz(θ)ᵀ, the centre is the body's
/// own, and moves with θ' × c.
#[test]
fn a_pendulum_is_as_the_book_says() {
    let model = model::examples::n_pendula(1).unwrap();
    let mut sim = Simulation::<f64>::new(model.clone(), SimulationSettings::new(1, 0.001)).unwrap();
    let (angle, speed) = (0.7_f64, 1.3);
    sim.set_joint_state(0, &[angle], &[speed]).unwrap();
    let body = &model.bodies[0];
    let arm = model.joints[0].child_frame.position.length();
    let at = arm * DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let turn = DMat3::from_rotation_z(angle);
    let inertia = turn * body.inertia * turn.transpose();
    let (x, y, z) = (inertia.x_axis, inertia.y_axis, inertia.z_axis);
    let expected = [x.x, y.y, z.z, x.y, x.z, y.z, 0.0, 0.0, 0.0, body.mass];
    let velocity = (speed * DVec3::Z).cross(at);
    let motion = [0.0, 0.0, speed, velocity.x, velocity.y, 0.0];
    let near = |found: &[f64], expected: &[f64]| {
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-14, "{found:?} is not {expected:?}");
        }
    };
    near(&read(&mut sim, Quantity::CenterOfMass)[0], &at.to_array());
    near(&read(&mut sim, Quantity::SpatialInertia)[0], &expected);
    near(&read(&mut sim, Quantity::SpatialVelocity)[0], &motion);
}

#[test]
fn masses_are_the_worlds_own() {
    let mut sim = moving(SolverKind::Featherstone);
    let bodies: Vec<_> = trees(sim.model()).concat();
    let shared = read(&mut sim, Quantity::CenterOfMass);
    let masses = Parameter::BodyMass.of(sim.model());
    let heavy: Vec<_> = masses.iter().rev().copied().collect();
    let center_of_limb = [0.4, 0.3, 0.2];
    let mut centers = Parameter::BodyCenter.of(sim.model());
    let limb = sim.model().body("limb").unwrap().0;
    centers[3 * limb..][..3].copy_from_slice(&center_of_limb);
    sim.set_parameters(
        9,
        &[
            (Parameter::BodyMass, &heavy),
            (Parameter::BodyCenter, &centers),
        ],
    )
    .unwrap();
    let own = read(&mut sim, Quantity::CenterOfMass);
    let (_, expected) = center(&mut sim, 9, &bodies);
    assert!((DVec3::from_slice(&own[9]) - expected).length() < 1e-14);
    assert!((DVec3::from_slice(&shared[9]) - expected).length() > 0.1);
    assert_eq!(own[8], shared[8]);
    assert_eq!(
        read(&mut sim, Quantity::SpatialInertia)[9][10 * limb + 9],
        heavy[limb]
    );
}

#[test]
fn static_bodies_have_no_mass_and_stand_still() {
    let mut sim = moving(SolverKind::Featherstone);
    let post = sim.model().body("post").unwrap();
    assert_eq!(sim.model().bodies[post.0].kind, BodyKind::Static);
    let inertia = read(&mut sim, Quantity::SpatialInertia);
    let velocity = read(&mut sim, Quantity::SpatialVelocity);
    assert_eq!(inertia[3][10 * post.0..][..10], [0.0; 10]);
    assert_eq!(velocity[3][6 * post.0..][..6], [0.0; 6]);

    let mut world = Builder::new("nothing that moves");
    world.object("post").body("post").immovable();
    let model = world.build().unwrap();
    let mut sim = Simulation::<f64>::new(model, SimulationSettings::new(2, 0.01)).unwrap();
    assert_eq!(read(&mut sim, Quantity::CenterOfMass)[1], [0.0; 3]);
    let empty = Builder::new("nothing").build().unwrap();
    let mut sim = Simulation::<f64>::new(empty, SimulationSettings::new(2, 0.01)).unwrap();
    sim.read(Quantity::SpatialInertia, &mut []).unwrap();
}

/// The torque about C is that about the world's origin less C × f.
#[test]
fn contacts_press_about_the_center_of_mass() {
    let mut world = Builder::new("two balls");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    for (name, x) in [("near", 0.0), ("far", 3.0)] {
        let balls = world.object(name);
        let ball = Geometry::Sphere { radius: 0.1 };
        let body = balls.body(name).shape(ball).mass(2.0).handle();
        let at = [x, 0.1, 1.0, 0.0, 0.0, 0.0, 1.0];
        balls.free(format!("{name} floats"), body).initial(&at);
    }
    let model = world.build().unwrap();
    assert!(model.joints.iter().all(|j| j.kind == JointKind::Free));
    for solver in SOLVERS {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(5, 0.002)
        };
        let mut sim = Simulation::<f64>::new(model.clone(), settings).unwrap();
        sim.step(500);
        let about_origin = read(&mut sim, Quantity::ContactWrench);
        let about_center = read(&mut sim, Quantity::SpatialContactForce);
        for world in 0..5 {
            for b in 0..2 {
                let (_, at) = center(&mut sim, world, &[b]);
                let row = &about_origin[world][6 * b..][..6];
                let (force, torque) = (DVec3::from_slice(row), DVec3::from_slice(&row[3..]));
                let row = &about_center[world][6 * b..][..6];
                let (t, f) = (DVec3::from_slice(row), DVec3::from_slice(&row[3..]));
                assert_eq!(f, force);
                assert!((t - (torque - at.cross(force))).length() < 1e-12);
                // A ball that rests: its weight, below its centre.
                assert!(
                    (f - 2.0 * 9.81 * DVec3::Y).length() < 0.01 && t.length() < 0.01,
                    "{t} {f}"
                );
            }
        }
    }
}

/// So many worlds that threads share them.
#[test]
fn threads_and_lanes_give_the_same_bits() {
    let model = model::examples::n_pendula(5).unwrap();
    let make = |worlds, threads| {
        let settings = SimulationSettings {
            threads,
            ..SimulationSettings::new(worlds, 0.002)
        };
        let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
        for world in 0..worlds {
            let q = [0.01 * world as f64; 5];
            sim.set_joint_state(world, &q, &[1.0; 5]).unwrap();
        }
        sim.step(3);
        sim
    };
    for quantity in [
        Quantity::CenterOfMass,
        Quantity::SpatialInertia,
        Quantity::SpatialVelocity,
        Quantity::BodyOrientation,
    ] {
        let [rows, width] = quantity.shape(&model);
        let worlds = 2005;
        let read = |worlds, threads| {
            let mut out = vec![f32::NAN; worlds * rows * width];
            make(worlds, threads).read(quantity, &mut out).unwrap();
            out
        };
        let many = read(worlds, 3);
        assert_eq!(many, read(worlds, 1), "{quantity:?}");
        assert_eq!(many[..rows * width], read(1, 1), "{quantity:?}");
    }
}

#[test]
fn nothing_has_its_center_at_the_origin() {
    let model = Builder::new("nothing").build().unwrap();
    let mut sim = Simulation::<f64>::new(model, SimulationSettings::new(2, 0.001)).unwrap();
    let mut out = [f64::NAN; 6];
    sim.read(Quantity::CenterOfMass, &mut out).unwrap();
    assert_eq!(out, [0.0; 6]);
}
