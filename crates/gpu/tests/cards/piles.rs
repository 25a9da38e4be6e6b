//! Piles by sequential impulses, on a card and on the processor.
//!
//! A step on a card is the processor's but for rounding: contacts are the same, in the same order, and solved in the
//! same. What rounding does in a step in which much is struck is measured: it is how far the processor is from itself
//! where it rounds other than in its widest lanes.

use crate::agreement::come_to_rest;
use crate::card::{Card, card, rounds_alike, small};
use crate::models::mixed;
use crate::pair::Pair;
use crate::scenes::statistics;
use glam::{DMat3, DQuat, DVec2, DVec3};
use model::examples::{
    SCENES, arch, balls, bowl, n_pendula, pile, pyramid, square_pyramid, terrain, tower,
};
use model::{
    BodyId, Builder, Combine, Geometry, Hull, Material, Model, ModelError, Pose, Shape, ShapeId,
    Softness, TriangleMesh,
};
use numbers::dispatch::Isa;
use rigid::Settings;
use rigid::impulse::suits;
use sim::{Quantity, Simulation, SimulationError, SimulationSettings, SolverKind};
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

const H: f64 = 0.004;

pub fn settings(worlds: usize) -> SimulationSettings {
    SimulationSettings {
        solver: SolverKind::Impulse,
        step: Settings {
            sleep_speed: 0.0,
            ..Settings::new(H)
        },
        ..SimulationSettings::new(worlds, H)
    }
}

/// The processor in double lanes, in place of a card: without fused operations.
fn plain(model: &Model, worlds: usize) -> Simulation<f32> {
    let isa = Isa::available().into_iter().last();
    let settings = SimulationSettings {
        isa,
        ..settings(worlds)
    };
    Simulation::new(model.clone(), settings).unwrap()
}

/// How far the processor is from another one, which takes the card's place.
fn between(pair: &mut Pair, other: &mut Simulation<f32>, apart: fn(&mut Pair) -> f64) -> f64 {
    std::mem::swap(&mut pair.gpu, other);
    let rounding = apart(pair);
    std::mem::swap(&mut pair.gpu, other);
    rounding
}

/// How far bodies are, after a step from the processor's state, from where a card takes them, and another processor.
fn stepped_apart(pair: &mut Pair, other: &mut Simulation<f32>) -> [f64; 2] {
    pair.put();
    other.restore(&pair.cpu.snapshot()).unwrap();
    pair.step(1);
    other.step(1);
    let moved = pair.moved_apart();
    [moved, between(pair, other, Pair::moved_apart)]
}

/// Where a card fuses what the processor rounds twice, one in so many steps may decide otherwise which features touch,
/// and bodies go apart by so much [m].
const DECIDING: usize = 5;
const DECIDED: f64 = 5e-3;

/// Steps one by one, from the processor's states, `stride` steps apart.
fn agrees(model: &Model, steps: usize, stride: usize) -> Pair {
    let card = card();
    let mut left = if rounds_alike(&card) {
        0
    } else {
        steps / DECIDING
    };
    let mut pair = Pair::at_rest(&card, model, settings(1));
    let mut other = plain(model, 1);
    for step in 0..steps {
        let [moved, rounding] = stepped_apart(&mut pair, &mut other);
        let within = moved < 1e-5 + 4.0 * rounding;
        assert!(
            within || left > 0 && moved < DECIDED,
            "{}: {moved:e} after step {}, of which rounding {rounding:e}",
            model.name,
            step * stride
        );
        left -= usize::from(!within);
        pair.step(stride - 1);
    }
    pair
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn piles_agree_with_the_processor() {
    for model in [tower(3, 0.001), pyramid(6), arch(9)] {
        let pair = agrees(&model.unwrap(), 40, 1);
        assert_eq!(pair.gpu.left_to_processor(), 0);
    }
}

/// Spheres, boxes, capsules and cylinders.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn mixed_piles_agree_with_the_processor() {
    let pair = agrees(&pile(30).unwrap(), 40, 3);
    assert_eq!(pair.gpu.left_to_processor(), 0);
    agrees(&bowl(100).unwrap(), 20, 10);
}

/// What is met by its corners or by its support alone; bodies of two shapes, off their centres; some that pass through others.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn hulls_cones_and_ellipsoids_agree_with_the_processor() {
    let mut pair = agrees(&odds().unwrap(), 30, 4);
    assert_eq!(
        pair.gpu.outputs().contacts(0).count(),
        pair.cpu.outputs().contacts(0).count()
    );
}

fn odds() -> Result<Model, ModelError> {
    let mut world = Builder::new("odds");
    world.object("ground").scenery(ground());
    let end = |z| [(-0.1, 0.0), (0.1, 0.0), (0.05, 0.12)].map(|(x, y)| DVec3::new(x, y, z));
    let wedge = Hull::new(&[end(-0.06), end(0.07)].concat())?;
    let (radius, half_height) = (0.06, 0.08);
    let solids = [
        Geometry::Hull(wedge),
        Geometry::Cone {
            radius,
            half_height,
        },
        Geometry::Ellipsoid {
            half: DVec3::new(0.1, 0.05, 0.07),
        },
    ];
    for i in 0..12 {
        let at = DVec3::new(
            0.03 * (i % 3) as f64,
            0.15 + 0.13 * i as f64,
            0.02 * (i % 2) as f64,
        );
        let body = world.object(format!("odd {i}"));
        let body = body.body(format!("body {i}")).at(Pose::at(at));
        let solid = Shape::new(solids[i % 3].clone());
        let ghost = u32::from(i % 4 == 3);
        body.shape(solid.with_masks(1 << ghost, 1 << ghost));
        let knob = Shape::new(Geometry::Sphere { radius: 0.04 });
        body.shape(knob.at(Pose::at(DVec3::new(0.09, 0.02, 0.0))));
    }
    world.build()
}

/// Blows are handed on from ball to ball, by joints, too.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_bounces_agrees_with_the_processor() {
    for model in [balls(), cradle(12)] {
        let pair = agrees(&model.unwrap(), 60, 5);
        assert_eq!(pair.gpu.left_to_processor(), 0, "{}", pair.gpu.model().name);
    }
}

/// So many balls that hang on rods and touch, the first drawn aside.
fn cradle(balls: usize) -> Result<Model, ModelError> {
    let mut world = Builder::new("cradle");
    let cradle = world.object("cradle");
    let elastic = Material {
        restitution: 1.0,
        friction: 0.0,
        ..Material::default()
    };
    for i in 0..balls {
        let ball = Shape::new(Geometry::Sphere { radius: 0.05 }).with_material(elastic);
        let ball = cradle.body(format!("ball {i}")).shape(ball).handle();
        let rod = cradle.revolute(format!("rod {i}"), ball, DVec3::Z);
        let hook = Pose::at(DVec3::new(0.1 * i as f64, 1.0, 0.0));
        let rod = rod.frames(hook, Pose::at(DVec3::Y * 0.5));
        if i == 0 {
            rod.initial(&[-0.6]);
        }
    }
    world.build()
}

/// So many rods above the ground.
fn rods(rods: usize) -> Result<Model, ModelError> {
    let mut world = Builder::new("rods");
    world.object("ground").scenery(ground());
    for i in 0..rods {
        let rod = world.object(format!("rod {i}")).body(format!("rod {i}"));
        rod.shape(Geometry::Capsule {
            radius: 0.02,
            half_height: 0.1,
        });
        let tilt = DQuat::from_rotation_z(1.2 + 0.1 * i as f64);
        rod.at(Pose::new(
            DVec3::new(0.05 * i as f64, 0.1 + 0.05 * i as f64, 0.0),
            tilt,
        ));
    }
    world.build()
}

/// Steps are cut into parts, the more the faster the rods spin; what contacts gave in all of them is told, also of those that
/// ended within the step.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_spins_agrees_with_the_processor() {
    let model = rods(6).unwrap();
    let mut pair = Pair::at_rest(&card(), &model, settings(1));
    let velocity: Vec<_> = (0..model.degrees_of_freedom())
        .map(|v| {
            if v % 6 == 4 {
                60.0 * (v / 6 + 1) as f64
            } else {
                0.0
            }
        })
        .collect();
    for simulation in pair.both() {
        let start = model.initial_position();
        simulation.set_joint_state(0, &start, &velocity).unwrap();
    }
    let mut ended = false;
    for step in 0..120 {
        pair.put();
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < 1e-4, "{moved:e} after step {step}");
        let [cpu, gpu] = pair.both().map(|s| {
            let outputs = s.outputs();
            outputs.contacts(0).collect::<Vec<_>>()
        });
        assert_eq!(cpu.len(), gpu.len(), "after step {step}");
        for (a, b) in cpu.iter().zip(&gpu) {
            assert_eq!(a.shapes, b.shapes, "after step {step}");
            let apart = a.force.distance(b.force);
            assert!(apart < 1e-2 * a.force.length().max(1.0), "{a:?}\n{b:?}");
        }
        ended |= cpu
            .iter()
            .any(|c| c.distance > 1e-3 && c.force.length() > 0.0);
    }
    assert!(ended);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

/// With more pairs, contacts, colours and rounds of colouring than there is room for at first.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn there_is_room_for_more() {
    agrees(&square_pyramid(8).unwrap(), 3, 5);
    for balls in [40, 80] {
        agrees(&table(balls, false), 20, 5);
    }
    let pair = agrees(&row(600), 2, 3);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

/// So many boxes on the ground, each against the next: the colour of a contact depends on all before it.
fn row(boxes: usize) -> Model {
    let mut world = Builder::new("row");
    world.object("ground").scenery(ground());
    let row = world.object("row");
    for i in 0..boxes {
        let half = DVec3::splat(0.05);
        let cube = row.body(format!("box {i}")).shape(Geometry::Box { half });
        cube.at(Pose::at(DVec3::new(0.1 * i as f64, 0.05, 0.0)));
    }
    world.build().unwrap()
}

/// A plate on so many balls on the ground: more contacts of one body than there are colours. Where the balls are fixed,
/// every other one is a little lower.
fn table(balls: usize, fixed: bool) -> Model {
    let mut world = Builder::new(format!("table on {balls} balls"));
    world.object("ground").scenery(ground());
    let sphere = Geometry::Sphere { radius: 0.05 };
    for i in 0..balls {
        let height = if fixed && i % 2 == 1 { 0.04995 } else { 0.05 };
        let place = DVec3::new(0.21 * (i % 10) as f64, height, 0.21 * (i / 10) as f64);
        let name = format!("ball {i}");
        let object = world.object(&name);
        if fixed {
            object.scenery(Shape::new(sphere.clone()).at(Pose::at(place)));
        } else {
            object.body(&name).shape(sphere.clone()).at(Pose::at(place));
        }
    }
    let half = DVec3::new(1.1, 0.02, 1.0);
    let plate = world.object("plate").body("plate");
    let plate = plate.shape(Geometry::Box { half });
    plate.at(Pose::at(DVec3::new(0.95, 0.1201, 0.7)));
    world.build().unwrap()
}

fn ground() -> Shape {
    Shape::new(Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    })
}

/// Contacts that press are remembered before others; here there are more than a world has room for.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_is_forgotten_is_the_same() {
    let mut pair = Pair::at_rest(&card(), &table(40, true), settings(1));
    for _ in 0..20 {
        pair.step(2);
        let [cpu, gpu] = pair.both().map(|s| {
            let outputs = s.outputs();
            let shapes = outputs.contacts(0).map(|c| c.shapes);
            (outputs.capped(0), shapes.collect::<Vec<_>>())
        });
        assert!(cpu.0 > 0);
        assert_eq!(cpu, gpu);
        pair.put();
    }
}

/// Worlds begin unlike each other; one is pushed, one spins, and one is set anew.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_are_on_their_own() {
    let model = pyramid(3).unwrap();
    let mut pair = Pair::at_rest(&card(), &model, settings(4));
    let dofs = model.degrees_of_freedom();
    let start = model.initial_position();
    for simulation in pair.both() {
        let mut velocity = vec![0.0; dofs];
        velocity[1] = 2.0;
        simulation.set_joint_state(1, &start, &velocity).unwrap();
        let mut force = vec![0.0; dofs];
        force[0] = 30.0;
        simulation.controls().set_force(2, &force).unwrap();
        velocity[dofs - 3..].fill(150.0);
        simulation.set_joint_state(3, &start, &velocity).unwrap();
    }
    for _ in 0..10 {
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < 1e-4, "{moved:e}");
        pair.put();
    }
    for simulation in pair.both() {
        simulation.reset(&[0, 3]).unwrap();
    }
    pair.step(1);
    let moved = pair.moved_apart();
    assert!(moved < 1e-5, "{moved:e}");
    assert_eq!(pair.gpu.time(3), H);
}

/// Worlds that begin at random, side by side and each alone: a world has the same bits, whatever others do: what bounces
/// there, what spins, which contacts need more colours, which step is the processor's.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_have_the_same_bits_alone() {
    let card = card();
    let mut bouncing = pyramid(3).unwrap().into_parts();
    for shape in &mut bouncing.shapes {
        shape.material.restitution = 0.7;
    }
    let bouncing = Model::new(bouncing);
    for model in [bouncing, balls(), cradle(4), rods(3), terrain(5)] {
        let model = model.unwrap();
        let together = stirred(&card, &model, 0..4);
        // What rests, and what is fastest.
        for world in [1, 3] {
            let alone = stirred(&card, &model, world..world + 1);
            assert_eq!(together[world], alone[0], "{} {world}", model.name);
        }
    }
}

/// The states of such worlds after some steps, of which some are taken one by one.
fn stirred(card: &Card, model: &Model, worlds: Range<usize>) -> Vec<Vec<f64>> {
    let mut simulation = Simulation::on(card, model.clone(), settings(worlds.len())).unwrap();
    for (i, world) in worlds.clone().enumerate() {
        let wave = |v: usize| 2.0 * (1.7 * v as f64 + world as f64).sin();
        let velocity: Vec<_> = (0..model.degrees_of_freedom())
            .map(|v| wave(v) * [1.0, 0.0, 3.0, 40.0][world])
            .collect();
        let start = model.initial_position();
        simulation.set_joint_state(i, &start, &velocity).unwrap();
    }
    simulation.step(20);
    for _ in 0..5 {
        simulation.step(1);
    }
    let all = 0..worlds.len();
    all.map(|i| simulation.numbers_of_world(i).unwrap().state)
        .collect()
}

/// On a card that takes little in a buffer, worlds are stepped some at a time, and none differs by that.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_that_do_not_fit_are_stepped_some_at_a_time() {
    let model = pyramid(3).unwrap();
    let together = |card: &Card| {
        let mut simulation = Simulation::on(card, model.clone(), settings(40)).unwrap();
        for world in 0..40 {
            let mut velocity = vec![0.0; model.degrees_of_freedom()];
            velocity[2] = 0.1 * world as f64;
            let start = model.initial_position();
            simulation
                .set_joint_state(world, &start, &velocity)
                .unwrap();
        }
        simulation.step(10);
        assert_eq!(simulation.left_to_processor(), 0);
        let states = (0..40).map(|world| simulation.numbers_of_world(world).unwrap().state);
        states.collect::<Vec<_>>()
    };
    let all = together(&card());
    for most_bytes in [1 << 18, 1 << 17] {
        assert!(together(&small(most_bytes)) == all, "{most_bytes} bytes");
    }
}

/// On such a card joints of worlds are controlled some worlds at a time, with constants of their own, and none differs by
/// that.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn joints_of_worlds_that_do_not_fit_are_controlled_some_at_a_time() {
    let model = mixed(false).unwrap();
    let worlds = 10;
    let together = |card: &Card| {
        let mut simulation = Simulation::on(card, model.clone(), settings(worlds)).unwrap();
        for phase in 0..2 {
            for world in (phase..worlds).step_by(1 + phase) {
                control(&mut simulation, world, phase);
            }
            simulation.step(3);
            for world in (0..worlds).step_by(3) {
                let own = changed(&model, 1.0 + 0.1 * (world + phase) as f64);
                simulation.set_world_model(world, &own).unwrap();
            }
            simulation.step(3);
        }
        let states = (0..worlds).map(|world| simulation.numbers_of_world(world).unwrap().state);
        states.collect::<Vec<_>>()
    };
    let all = together(&card());
    assert!(all[0] != all[1] && all[1] != all[2] && all[2] != all[3]);
    assert!(together(&small(1 << 16)) == all);
}

/// A world that is lost is told, and no other is; not by what both hang on either, which overflows there.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_world_that_diverges_harms_no_other() {
    for (model, speed) in [(tower(2, 0.001), 1e7), (cradle(3), 1e9)] {
        let model = model.unwrap();
        let mut pair = Pair::at_rest(&card(), &model, settings(2));
        let velocity = vec![speed; model.degrees_of_freedom()];
        let start = model.initial_position();
        for simulation in pair.both() {
            simulation.set_joint_state(0, &start, &velocity).unwrap();
        }
        pair.step(20);
        let lost = pair.both().map(|s| {
            let lost = s.diverged().iter().map(|d| (d.world, d.time));
            lost.collect::<Vec<_>>()
        });
        assert_eq!(lost[0].len(), 1);
        assert_eq!(lost[0], lost[1]);
        assert!(pair.gpu.left_to_processor() < 20, "{}", model.name);
        let top = pair.both().map(|s| s.outputs().body_position(1, BodyId(1)));
        assert!(top[0].distance(top[1]) < 1e-5);
    }
}

/// Far faster than a shape in a step, and faster than anything in cells.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn small_balls_may_be_fast() {
    let mut world = Builder::new("grains");
    world.object("ground").scenery(ground());
    for i in 0..60 {
        let place = DVec3::new(
            0.02 * (i % 5) as f64,
            0.1 + 0.02 * i as f64,
            0.005 * (i % 3) as f64,
        );
        let grain = world
            .object(format!("grain {i}"))
            .body(format!("grain {i}"));
        grain
            .shape(Geometry::Sphere { radius: 0.005 })
            .at(Pose::at(place));
    }
    let model = world.build().unwrap();
    // What would get through the ground within a step is stopped there by the processor.
    let pair = agrees(&model, 40, 4);
    let left = pair.gpu.left_to_processor();
    assert!(left < 80, "{left} of 160 steps");
    let mut pair = Pair::at_rest(&card(), &model, settings(1));
    let mut velocity = vec![0.0; model.degrees_of_freedom()];
    velocity[0] = 1e9;
    for simulation in pair.both() {
        let start = model.initial_position();
        simulation.set_joint_state(0, &start, &velocity).unwrap();
    }
    pair.step(3);
    assert_eq!(pair.cpu.diverged(), pair.gpu.diverged());
    assert_eq!(pair.gpu.diverged().len(), 1);
}

/// Who may touch whom, and of what contacts are made: springs, margins, rules, twisting and rolling.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn filters_and_surfaces_agree_with_the_processor() {
    let pair = agrees(&company().unwrap(), 40, 6);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

pub fn company() -> Result<Model, ModelError> {
    let mut world = Builder::new("company");
    world.object("ground").scenery(ground());
    let shelf = world.object("shelf").body("shelf").immovable();
    let half = DVec3::new(2.0, 0.05, 2.0);
    shelf
        .shape(Geometry::Box { half })
        .at(Pose::at(DVec3::Y * 0.3));
    let soft = Softness::Spring {
        stiffness: 4e4,
        damping: 60.0,
    };
    let plain = Material {
        restitution: 0.0,
        ..Material::default()
    };
    let surfaces = [
        plain,
        Material {
            softness: soft,
            ..plain
        },
        Material {
            margin: 0.004,
            friction: 0.9,
            combine: Combine::Maximum,
            ..plain
        },
        Material {
            friction: 0.3,
            torsional_friction: 0.01,
            rolling_friction: 0.003,
            combine: Combine::Multiply,
            ..plain
        },
    ];
    let mut handles = Vec::new();
    let crowd = world.object("crowd");
    for i in 0..16 {
        let at = DVec3::new(
            0.04 * (i % 4) as f64,
            0.42 + 0.09 * i as f64,
            0.03 * (i % 3) as f64,
        );
        let body = crowd.body(format!("body {i}")).at(Pose::at(at));
        let solid = match i % 2 {
            0 => Geometry::Sphere { radius: 0.05 },
            _ => Geometry::Box {
                half: DVec3::splat(0.05),
            },
        };
        body.shape(Shape::new(solid).with_material(surfaces[i % 4]));
        body.group([1, 1, -1, 2][i / 4]).world([-1, 0, 1][i % 3]);
        handles.push(body.handle());
    }
    crowd.exclude(handles[0], handles[1]);
    world.build()
}

/// Shapes that only tell what touches them, at rest and moving, and two shapes with a surface of their own.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn sensors_and_surfaces_of_pairs_agree_with_the_processor() {
    let mut world = Builder::new("gates");
    let rink = world.object("rink");
    rink.scenery(ground());
    let ice = rink.id().scenery(0);
    let half = DVec3::new(0.3, 0.2, 0.3);
    let gate = Shape::new(Geometry::Box { half });
    let gates = world.object("gates");
    gates.scenery(gate.at(Pose::at(DVec3::Y * 0.4)).as_sensor());
    let mut stones = Vec::new();
    for i in 0..12 {
        let stone = world.object(format!("stone {i}"));
        let stone = stone.body(format!("stone {i}"));
        let at = DVec3::new(0.15 * (i % 4) as f64, 0.1 + 0.11 * i as f64, 0.0);
        stone.shape(Geometry::Box {
            half: DVec3::splat(0.05),
        });
        if i % 3 == 0 {
            stone.shape(Shape::new(Geometry::Sphere { radius: 0.2 }).as_sensor());
        }
        stones.push(stone.at(Pose::at(at)).handle());
    }
    for (stone, friction, margin) in [(0, 0.01, 0.0), (5, 0.9, 0.01)] {
        let pair = world.contact_pair(stones[stone].shape(0), ice).unwrap();
        pair.friction(friction).margin(margin);
    }
    let model = world.build().unwrap();
    let mut pair = agrees(&model, 40, 5);
    assert_eq!(pair.gpu.left_to_processor(), 0);
    pair.put();
    pair.step(1);
    let [cpu, gpu] = pair.both().map(|s| {
        let outputs = s.outputs();
        let shapes = outputs.contacts(0).map(|c| c.shapes);
        shapes.collect::<Vec<_>>()
    });
    let sensor = |shape: &ShapeId| model.shapes[shape.0].sensor;
    assert!(cpu.iter().flatten().any(sensor));
    assert_eq!(cpu, gpu);
}

/// Solids of all kinds on a hillside, which is a mesh.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn solids_on_meshes_agree_with_the_processor() {
    let pair = agrees(&terrain(12).unwrap(), 30, 8);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

/// A bowl that falls with stones in it, and lies on the ground.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn boxes_in_meshes_agree_with_the_processor() {
    let dent = |x: f64, z: f64| 0.6 * (x * x + z * z);
    let steps = (0..7).map(|i| 0.1 * f64::from(i) - 0.3);
    let heights = steps
        .clone()
        .map(|x| steps.clone().map(|z| dent(x, z)).collect());
    let heights = Vec::from_iter(heights);
    let bowl = TriangleMesh::height_field(&heights, DVec2::splat(0.1)).unwrap();
    let mut world = Builder::new("bowl");
    world.object("ground").scenery(ground());
    let dish = world
        .object("dish")
        .body("dish")
        .at(Pose::at(DVec3::Y * 0.05));
    let inertia = DMat3::from_diagonal(DVec3::new(0.1, 0.2, 0.1));
    dish.inertia(2.0, DVec3::ZERO, inertia)
        .shape(Geometry::Mesh(bowl));
    for (i, x) in [-0.15, 0.0, 0.15].into_iter().enumerate() {
        let stone = world.object(format!("stone {i}"));
        let half = DVec3::new(0.05, 0.03, 0.04);
        let stone = stone
            .body(format!("stone {i}"))
            .shape(Geometry::Box { half });
        stone.at(Pose::at(DVec3::new(x, 0.3, 0.02)));
    }
    agrees(&world.build().unwrap(), 40, 5);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn meshes_on_meshes_agree_with_the_processor() {
    let mut pair = agrees(&heap(&tetrahedron()), 40, 5);
    assert_eq!(pair.gpu.left_to_processor(), 0);
    assert!(pair.cpu.outputs().contacts(0).count() > 3);
}

fn tetrahedron() -> TriangleMesh {
    let corner = |x: f64, y: f64, z: f64| 0.1 * DVec3::new(x, y, z);
    let corners = [
        corner(1.0, 1.0, 1.0),
        corner(1.0, -1.0, -1.0),
        corner(-1.0, 1.0, -1.0),
        corner(-1.0, -1.0, 1.0),
    ];
    let faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
    TriangleMesh::new(&corners, &faces).unwrap()
}

/// Equal meshes that fall into a heap on the ground.
fn heap(mesh: &TriangleMesh) -> Model {
    let mut world = Builder::new("heap");
    world.object("ground").scenery(ground());
    let heap = world.object("heap");
    for i in 0..5 {
        let name = format!("stone {i}");
        let body = heap.body(name).shape(Geometry::Mesh(mesh.clone()));
        let place = DVec3::new(0.03 * f64::from(i % 2), 0.12 + 0.22 * f64::from(i), 0.01);
        body.at(Pose::new(place, DQuat::from_rotation_x(0.5 * f64::from(i))));
    }
    world.build().unwrap()
}

/// What it knows besides its state, which colours contacts had, changes nothing.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_snapshot_goes_on_to_the_same_bits() {
    let model = pile(20).unwrap();
    let card = card();
    let mut first = Simulation::on(&card, model.clone(), settings(1)).unwrap();
    first.step(100);
    let taken = first.snapshot();
    first.step(50);
    let mut again = Simulation::on(&card, model, settings(1)).unwrap();
    again.restore(&taken).unwrap();
    for _ in 0..50 {
        again.step(1);
    }
    let [one, two] = [&mut first, &mut again].map(|s| s.numbers_of_world(0).unwrap().state);
    assert_eq!(one, two);
}

/// Joints of every kind, with all that acts along their axes, driven and moved by controls that change; each world by
/// others.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn joints_agree_with_the_processor() {
    let model = mixed(false).unwrap();
    let mut pair = Pair::at_rest(&card(), &model, settings(3));
    let wave = |i: usize| (1.7 * i as f64 + 0.4).sin();
    let dofs = model.degrees_of_freedom();
    for simulation in pair.both() {
        for world in 0..3 {
            let velocity: Vec<_> = (0..dofs).map(|v| wave(v + world)).collect();
            let start = model.initial_position();
            simulation
                .set_joint_state(world, &start, &velocity)
                .unwrap();
        }
    }
    let mut other = plain(&model, 3);
    for step in 0..60 {
        pair.put();
        other.restore(&pair.cpu.snapshot()).unwrap();
        for simulation in pair.both().into_iter().chain([&mut other]) {
            control(simulation, 1 + step % 2, step / 20);
        }
        pair.step(1);
        other.step(1);
        let moved = pair.moved_apart();
        assert!(moved < 1e-5, "{moved:e} after step {step}");
        // Velocities and impulses, targets and turns.
        let all = pair.apart();
        let rounding = between(&mut pair, &mut other, Pair::apart);
        assert!(
            all < 2e-4 + 4.0 * rounding,
            "{all:e} after step {step}, of which rounding {rounding:e}"
        );
    }
    let left = pair.gpu.left_to_processor();
    assert!(left < 3, "{left} of 180 steps");
}

/// Sets forces along all joints, targets and controls of a world.
pub fn control(simulation: &mut Simulation<f32>, world: usize, phase: usize) {
    let model = simulation.model().clone();
    let wave = |i: usize| (2.3 * i as f64 + world as f64 + phase as f64).sin();
    let dofs = 0..model.degrees_of_freedom();
    let force: Vec<_> = dofs.clone().map(|v| 0.4 * wave(v)).collect();
    let actuators = 0..model.actuators.len();
    let control: Vec<_> = actuators.map(wave).collect();
    let mut controls = simulation.controls();
    controls.set_force(world, &force).unwrap();
    controls.set_control(world, &control).unwrap();
    for dof in dofs {
        controls
            .set_target(world, dof, 2.0 * wave(dof + 1))
            .unwrap();
        let speed = 0.5 * wave(dof + 2);
        controls.set_target_velocity(world, dof, speed).unwrap();
    }
}

/// Nothing touches.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn bodies_without_shapes_agree_with_the_processor() {
    let pair = agrees(&n_pendula(4).unwrap(), 10, 5);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

/// More joints of one body than there are colours, and a loop of four bars.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn hubs_and_loops_agree_with_the_processor() {
    let mut world = Builder::new("hub");
    let hub = world.object("hub");
    let nave = hub.body("nave").shape(Geometry::Sphere { radius: 0.1 });
    let nave = nave.at(Pose::at(DVec3::Y)).handle();
    let rod = Shape::new(Geometry::Capsule {
        radius: 0.01,
        half_height: 0.1,
    });
    let rod = rod.with_masks(0, 0);
    for i in 0..70 {
        let turn = DQuat::from_rotation_y(0.09 * i as f64) * DQuat::from_rotation_z(1.1);
        let spoke = hub.body(format!("spoke {i}")).shape(rod.clone()).handle();
        let joint = hub.ball(format!("end {i}"), spoke).parent(nave);
        let outward = Pose::new(turn * (DVec3::Y * 0.1), turn);
        joint.frames(outward, Pose::at(DVec3::Y * -0.1));
    }
    let (top, bottom) = (Pose::at(DVec3::Y * 0.1), Pose::at(DVec3::Y * -0.1));
    let frame = world.object("frame");
    let [left, across, right] =
        ["left", "across", "right"].map(|name| frame.body(name).shape(rod.clone()).handle());
    let turned = Pose::new(DVec3::Y * -0.1, DQuat::from_rotation_z(FRAC_PI_2));
    frame
        .revolute("hung", left, DVec3::Z)
        .frames(Pose::IDENTITY, top);
    let bent = frame.revolute("bent", across, DVec3::Z).parent(left);
    bent.frames(turned, top);
    let bend = frame.revolute("bend", right, DVec3::Z).parent(across);
    bend.frames(turned, top);
    let closing = frame.revolute("closing", right, DVec3::Z).closes_loop(true);
    closing.frames(Pose::at(DVec3::X * 0.2), bottom);
    let pair = agrees(&world.build().unwrap(), 10, 3);
    assert_eq!(pair.gpu.left_to_processor(), 0);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn they_come_to_rest_as_on_the_processor() {
    come_to_rest(SolverKind::Impulse);
}

/// Every example scene that `impulse` takes for itself: steps from the same states, then the whole after the steps between
/// these. After more of them one heap has another energy for who slipped first.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn scenes_agree_with_the_processor() {
    for scene in SCENES {
        let model = scene.model().unwrap();
        if !suits(&model) {
            continue;
        }
        let mut pair = agrees(&model, 3, 20);
        let name = scene.name;
        assert!(pair.gpu.diverged().is_empty(), "{name}");
        let [cpu, gpu] = pair.both().map(|s| statistics(&s.outputs(), &model, 1));
        for (cpu, gpu) in cpu.into_iter().zip(gpu) {
            let within = (cpu - gpu).abs() < 0.01 * cpu.abs();
            assert!(within, "{name}: {cpu}, on the card {gpu}");
        }
    }
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn stages_of_steps_are_timed() {
    let mut world = Simulation::on(&card(), tower(3, 0.001).unwrap(), settings(1)).unwrap();
    let (_, times) = world.time_stages(|world| run(world, 3)).unwrap();
    let named = |stage| times.iter().filter(|it| it.name == stage).count();
    let stages = ["narrow phase", "pushing", "telling", "telling of contacts"];
    assert_eq!(stages.map(named), [1; 4], "{times:?}");
    // Of three steps, in two colours at least.
    let launches = |name| {
        times
            .iter()
            .find(|it| it.name == name)
            .map(|it| it.launches)
    };
    let small_steps = world.settings().step.contact_iterations as u64;
    assert!(
        launches("pushing") >= Some(3 * 2 * small_steps),
        "{times:?}"
    );
    // How many there are is told before.
    assert_eq!(launches("telling of contacts"), Some(3), "{times:?}");
    let contacts = |world: &mut Simulation<f32>| {
        world.try_step(1)?;
        let mut wrenches = vec![0.0; 6 * world.model().bodies.len()];
        world.read(Quantity::ContactWrench, &mut wrenches)
    };
    let (_, later) = world.time_stages(contacts).unwrap();
    let named = |stage| later.iter().filter(|it| it.name == stage).count();
    let [narrow_phase, pushing, _, contacts] = stages.map(named);
    assert_eq!([narrow_phase, pushing, contacts], [1; 3], "{later:?}");
    assert!(
        times
            .iter()
            .chain(&later)
            .all(|it| (0.0..10.0).contains(&it.seconds)),
        "{times:?}"
    );
    let mut here = Simulation::<f32>::new(tower(3, 0.001).unwrap(), settings(1)).unwrap();
    let (_, none) = here.time_stages(|here| run(here, 3)).unwrap();
    assert_eq!(none, []);
    assert_eq!(
        [here.time(0), world.time(0)].map(|t| (t * 1e3).round()),
        [12.0, 16.0]
    );
}

/// Steps of 300 small ones mark more in a turn than the card takes marks in one set.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn all_stages_of_long_steps_are_timed() {
    let mut settings = settings(1);
    settings.step.contact_iterations = 300;
    let model = tower(3, 0.001).unwrap();
    let mut world = Simulation::on(&card(), model, settings).unwrap();
    let (_, times) = world.time_stages(|world| run(world, 16)).unwrap();
    let launches = |name| {
        let stages = times.iter().filter(|it| it.name == name);
        stages.map(|it| it.launches).sum::<u64>()
    };
    assert!(launches("end") >= 16, "{times:?}");
    assert!(launches("drift") >= 16 * 300, "{times:?}");
}

/// Steps, and what is told after them.
fn run(world: &mut Simulation<f32>, steps: usize) -> Result<(), SimulationError> {
    world.try_step(steps)?;
    world.try_outputs().map(|_| ())
}

/// Loops of programs that stand in for a card end early: what would have too few contacts there is refused.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn meshes_that_loop_too_long_are_refused_where_loops_end() {
    let profile = [(0.0, 0.0), (0.3, 0.2), (0.28, 0.2), (0.0, 0.02)];
    let profile = profile.map(|(radius, height)| DVec2::new(radius, height));
    let bowl = TriangleMesh::revolution(&profile, 8).unwrap();
    let card = card();
    let placed = Simulation::on(&card, heap(&bowl), settings(1));
    if card.name().contains("llvmpipe") {
        let told = placed.unwrap_err().to_string();
        assert!(told.contains("meshes of many triangles"), "{told}");
    } else {
        agrees(&heap(&bowl), 40, 5);
    }
}

/// Worlds have masses, surfaces, springs and gravity of their own, some of them twice, and are given others as they run.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn models_of_worlds_own_agree_with_the_processor() {
    for model in [company().unwrap(), mixed(false).unwrap()] {
        let mut pair = Pair::at_rest(&card(), &model, settings(3));
        let mut other = plain(&model, 3);
        for step in 0..30 {
            if step % 10 == 0 {
                for simulation in pair.both().into_iter().chain([&mut other]) {
                    let worlds = if step == 20 { 1..2 } else { 0..2 };
                    for world in worlds {
                        let own = changed(&model, 1.0 + 0.3 * (world + step / 10) as f64);
                        simulation.set_world_model(world, &own).unwrap();
                    }
                    control(simulation, step / 10, step);
                }
            }
            let [moved, rounding] = stepped_apart(&mut pair, &mut other);
            let within = moved < 1e-5 + 4.0 * rounding;
            assert!(within, "{}: {moved:e} after step {step}", model.name);
            pair.step(2);
        }
        let heights = [0, 1, 2].map(|w| pair.cpu.outputs().body_position(w, BodyId(1)));
        assert!(heights[0] != heights[1] && heights[1] != heights[2]);
    }
}

/// Of many worlds few are given others, which none of the rest notices, and have the same bits as if all were given theirs.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn constants_of_few_worlds_are_those_of_all() {
    const WORLDS: usize = 20;
    let model = mixed(false).unwrap();
    let of = |card: &Card, rounds: &[Vec<usize>]| {
        let mut simulation = Simulation::on(card, model.clone(), settings(WORLDS)).unwrap();
        let energy = |simulation: &mut Simulation<f32>| {
            let mut told = [0.0; WORLDS];
            let read = simulation.read(Quantity::KineticEnergy, &mut told);
            read.unwrap();
            told
        };
        for worlds in rounds {
            for &world in worlds {
                let own = changed(&model, 1.0 + 0.1 * world as f64);
                simulation.set_world_model(world, &own).unwrap();
                control(&mut simulation, world, 1);
            }
            // So that all is there before the next ones are given theirs.
            simulation.step(2);
            energy(&mut simulation);
        }
        simulation.reset_all();
        (0..WORLDS).for_each(|world| control(&mut simulation, world, 2));
        simulation.step(5);
        let told = energy(&mut simulation);
        (simulation.snapshot(), told)
    };
    let together = of(&card(), &[Vec::from_iter(0..WORLDS)]);
    let rest = (0..WORLDS).filter(|w| ![3, 17].contains(w));
    let rounds = [Vec::from_iter(rest), vec![17], vec![3]];
    for card in [card(), small(1 << 17)] {
        assert!(together == of(&card, &rounds), "{}", card.name());
    }
}

/// The same model, heavier, rougher, springier and stronger by a factor, and in weaker gravity.
pub fn changed(model: &Model, factor: f64) -> Model {
    let mut parts = (**model).clone();
    for body in &mut parts.bodies {
        body.mass *= factor;
        body.inertia *= factor;
    }
    for (i, shape) in parts.shapes.iter_mut().enumerate() {
        shape.material.friction *= factor * (1.0 + 0.1 * (i % 3) as f64);
    }
    for joint in &mut parts.joints {
        for dof in &mut joint.dofs {
            dof.stiffness *= factor;
            dof.drive.damping *= factor;
        }
    }
    for actuator in &mut parts.actuators {
        actuator.gear *= factor;
    }
    parts.gravity *= 2.0 - factor;
    Model::new(parts).unwrap()
}

/// How fast is a blow follows from gravity, which is one for all contacts of a launch.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn gravity_of_worlds_own_is_refused_where_things_bounce() {
    let model = balls().unwrap();
    let mut simulation = Simulation::on(&card(), model.clone(), settings(2)).unwrap();
    let mut parts = (*model).clone();
    parts.gravity *= 0.5;
    let told = simulation.set_world_model(1, &Model::new(parts).unwrap());
    let told = told.unwrap_err().to_string();
    assert!(told.contains("gravity of another strength"), "{told}");
    simulation.step(3);
    assert!(simulation.diverged().is_empty());
}

/// A card has a table of what each two kinds of surfaces make of a contact. What is refused leaves all as it was.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn more_kinds_of_surfaces_than_a_card_takes_are_refused() {
    let mut world = Builder::new("shot");
    let shot = world.object("shot");
    for i in 0..1100 {
        let ball = shot.body(format!("ball {i}"));
        let ball = ball.shape(Geometry::Sphere { radius: 0.1 });
        ball.at(Pose::at(DVec3::X * f64::from(i)));
    }
    let model = world.build().unwrap();
    let mut simulation = Simulation::on(&card(), model.clone(), settings(2)).unwrap();
    let mut parts = model.into_parts();
    for (i, shape) in parts.shapes.iter_mut().enumerate() {
        shape.material.friction = 0.1 + 1e-4 * i as f64;
    }
    let own = Model::new(parts).unwrap();
    let told = simulation.set_world_model(1, &own).unwrap_err().to_string();
    assert!(told.contains("so many surfaces"), "{told}");
    simulation.step(2);
    assert!(simulation.diverged().is_empty());
}
