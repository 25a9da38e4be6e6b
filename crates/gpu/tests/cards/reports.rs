//! What a card tells of piles is what the processor tells of the same state: by the same kernels, in single precision where
//! that has double.

use crate::agreement::read;
use crate::card::{card, small};
use crate::models::mixed;
use crate::pair::{Pair, apart};
use crate::piles::{changed, company, control, settings};
use model::examples::{balls, n_pendula, pile};
use model::{BodyId, JointId, Model, ShapeId};
use sim::{Event, EventKind, OutputPart, Outputs, Quantity, Simulation, Watch};
use std::mem::{Discriminant, discriminant};

/// In parts of the larger of a number and 1.
const ROUNDING: f64 = 1e-5;

/// Brings the card to the processor's state, and compares all that is told of it.
fn tells_the_same(pair: &mut Pair) {
    pair.put();
    let name = pair.cpu.model().name.clone();
    // Each by itself, of what is not known yet.
    for quantity in Quantity::ALL {
        let [cpu, gpu] = pair.both().map(|s| read(s, quantity));
        // Forces, of which most cancels.
        let unit = cpu.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let of_unit = |numbers: Vec<f64>| Vec::from_iter(numbers.iter().map(|x| x / unit));
        let told = apart(&of_unit(cpu), &of_unit(gpu));
        assert!(told < ROUNDING, "{name}: {told:e} of {quantity:?}");
    }
    let model = pair.cpu.model().clone();
    let (cpu, gpu) = (pair.cpu.outputs(), pair.gpu.outputs());
    for world in 0..cpu.worlds() {
        let numbers = [&cpu, &gpu].map(|outputs| numbers(&model, outputs, world));
        let told = apart(&numbers[0], &numbers[1]);
        assert!(told < ROUNDING, "{name}: {told:e} in world {world}");
        let [own, other] = [&cpu, &gpu].map(|o| Vec::from_iter(o.contacts(world)));
        assert_eq!(own.len(), other.len(), "{name}: contacts of world {world}");
        for (a, b) in own.iter().zip(&other) {
            assert_eq!((a.shapes, a.feature), (b.shapes, b.feature), "{name}");
            let numbers = [a, b].map(|contact| {
                let vectors = [contact.position, contact.normal, contact.torque];
                let vectors = vectors.iter().flat_map(|v| v.to_array());
                vectors.chain([contact.distance]).collect::<Vec<_>>()
            });
            assert!(
                apart(&numbers[0], &numbers[1]) < ROUNDING,
                "{name}: {a:?}, {b:?}"
            );
            let unit = 1.0 + a.force.length();
            assert!(
                a.force.distance(b.force) < ROUNDING * unit,
                "{name}: {a:?}, {b:?}"
            );
        }
    }
}

/// Of a world all that no quantity tells.
fn numbers(model: &Model, outputs: &Outputs<'_, f32>, world: usize) -> Vec<f64> {
    let mut all = vec![outputs.capped(world) as f64];
    for body in (0..model.bodies.len()).map(BodyId) {
        let turning = outputs.body_angular_acceleration(world, body);
        let vectors = [outputs.body_acceleration(world, body), turning];
        // They are of the size of velocities over a step.
        all.extend(vectors.iter().flat_map(|v| (*v * 0.004).to_array()));
        all.push(f64::from(u8::from(outputs.asleep(world, body))));
    }
    all
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_is_told_of_piles_is_what_the_processor_tells() {
    for model in [pile(30).unwrap(), company().unwrap(), balls().unwrap()] {
        let mut pair = Pair::new(&card(), &model, settings(2));
        for steps in [0, 1, 30, 250] {
            pair.cpu.step(steps);
            tells_the_same(&mut pair);
        }
        let contacts = pair.cpu.outputs().contacts(0).count();
        assert!(contacts > 0, "{}: nothing touches", model.name);
    }
}

/// Joints of every kind; each world with constants of its own.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_is_told_of_joints_is_what_the_processor_tells() {
    let model = mixed(false).unwrap();
    let mut pair = Pair::new(&card(), &model, settings(3));
    for phase in 0..4 {
        for simulation in pair.both() {
            control(simulation, 1, phase);
            if phase == 2 {
                let own = changed(&model, 1.3);
                simulation.set_world_model(1, &own).unwrap();
            }
        }
        pair.cpu.step(20);
        tells_the_same(&mut pair);
    }
}

/// A card that takes so little that worlds lie in several batches; first all with the same constants.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_of_several_batches_are_told_of() {
    let model = company().unwrap();
    let card = small(1 << 18);
    let mut pair = Pair::new(&card, &model, settings(20));
    pair.cpu.step(60);
    tells_the_same(&mut pair);
    for world in [0, 7, 19] {
        for simulation in pair.both() {
            let own = changed(&model, 1.0 + 0.02 * world as f64);
            simulation.set_world_model(world, &own).unwrap();
        }
    }
    for _ in 0..2 {
        pair.cpu.step(10);
        tells_the_same(&mut pair);
    }
}

/// Where there were contacts before, and are none now, none is told; of the other worlds as before.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn contacts_that_are_gone_are_not_told() {
    let model = pile(30).unwrap();
    let mut pair = Pair::at_rest(&card(), &model, settings(3));
    pair.cpu.step(200);
    tells_the_same(&mut pair);
    let counts = |simulation: &mut Simulation<f32>| {
        let outputs = simulation.outputs();
        [0, 1, 2].map(|world| outputs.contacts(world).count())
    };
    let [all, before] = pair.both().map(counts);
    assert!(
        all.iter().all(|count| *count > 10) && all == before,
        "{all:?}"
    );
    let rest = vec![0.0; model.degrees_of_freedom()];
    for simulation in pair.both() {
        let start = model.initial_position();
        simulation.set_joint_state(1, &start, &rest).unwrap();
    }
    let [cpu, gpu] = pair.both().map(counts);
    assert_eq!(gpu, cpu);
    assert_eq!(gpu, [all[0], 0, all[2]]);
}

/// More things than are told of at once.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn many_worlds_are_told_of_in_parts() {
    let model = n_pendula(4).unwrap();
    let worlds = (1 << 16) / 4 + 100;
    let mut pair = Pair::new(&card(), &model, settings(worlds));
    for quantity in [
        Quantity::BodyPosition,
        Quantity::JointVelocity,
        Quantity::KineticEnergy,
        Quantity::Momentum,
    ] {
        let [cpu, gpu] = pair.both().map(|s| read(s, quantity));
        let told = apart(&cpu, &gpu);
        assert!(told < ROUNDING, "{told:e} of {quantity:?}");
    }
}

/// Parts of what is told are of the present state, also where others have been read before.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn parts_of_what_is_told_are_of_the_present_state() {
    let model = mixed(false).unwrap();
    let mut pair = Pair::new(&card(), &model, settings(2));
    for _ in 0..3 {
        pair.step(1);
        pair.put();
        let (body, joint) = (BodyId(2), JointId(1));
        let position = |simulation: &mut Simulation<f32>| {
            let parts = [OutputPart::Motion(body)];
            let look = |_: &Simulation<f32>, o: &Outputs<'_, f32>| o.body_position(1, body);
            simulation.observe_parts(parts, look).unwrap().to_array()
        };
        let [cpu, gpu] = pair.both().map(position);
        assert!(apart(&cpu, &gpu) < ROUNDING, "{cpu:?}, {gpu:?}");
        let force = |simulation: &mut Simulation<f32>| {
            let parts = [OutputPart::Reaction(joint), OutputPart::Velocities(joint)];
            let look = |_: &Simulation<f32>, o: &Outputs<'_, f32>| {
                let dof = model.dof_range(joint).start;
                (o.reaction(1, joint).0, o.dof_velocity(1, dof))
            };
            let (force, velocity) = simulation.observe_parts(parts, look).unwrap();
            [force.x, force.y, force.z, velocity]
        };
        let [cpu, gpu] = pair.both().map(force);
        let unit = cpu.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
        let [cpu, gpu] = [cpu, gpu].map(|numbers| numbers.map(|x| x / unit));
        assert!(apart(&cpu, &gpu) < ROUNDING, "{cpu:?}, {gpu:?}");
    }
}

/// What happens in a pile on a card is what happens on the processor, step by step from the same states.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn events_of_piles_are_those_of_the_processor() {
    let model = company().unwrap();
    let mut pair = Pair::at_rest(&card(), &model, settings(2));
    pair.both().into_iter().for_each(|s| s.watch(Watch::ALL));
    let mut count = 0;
    for step in 0..60 {
        pair.put();
        pair.step(1);
        let [cpu, gpu] = pair.both().map(|simulation| {
            let events = simulation.drain_events();
            events.iter().map(happened).collect::<Vec<_>>()
        });
        assert_eq!(cpu, gpu, "step {step}");
        count += cpu.len();
    }
    assert!(count > 50, "{count} events");
}

/// In which world something happened, of which kind it is, and to which shapes it happened.
pub fn happened(event: &Event) -> (usize, Discriminant<EventKind>, Option<[ShapeId; 2]>) {
    use EventKind::*;
    let shapes = match &event.kind {
        ContactBegins { shapes, .. }
        | ContactPersists { shapes, .. }
        | ContactEnds { shapes }
        | SensorBegins { shapes }
        | SensorEnds { shapes } => Some(*shapes),
        _ => None,
    };
    (event.world, discriminant(&event.kind), shapes)
}
