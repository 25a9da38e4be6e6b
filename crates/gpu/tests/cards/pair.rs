//! The same worlds on the processor and on a card.

use crate::card::Card;
use model::{BodyId, Model};
use sim::{Simulation, SimulationSettings, SolverKind};

/// The solver that `auto` takes but for `impulse`, which is there for what touches.
pub fn of_joints(model: &Model) -> SolverKind {
    SolverKind::Auto.pick(model, false)
}

/// Worlds in motion under controls of every sort, each pushed a little harder than the one before; and the same on
/// a card.
pub struct Pair {
    pub cpu: Simulation<f32>,
    pub gpu: Simulation<f32>,
}

impl Pair {
    pub fn new(card: &Card, model: &Model, settings: SimulationSettings) -> Self {
        let mut pair = Self::at_rest(card, model, settings);
        pair.both().into_iter().for_each(stir);
        pair
    }
    /// The same as the model begins.
    pub fn at_rest(card: &Card, model: &Model, settings: SimulationSettings) -> Self {
        let gpu = Simulation::on(card, model.clone(), settings).unwrap();
        let solver = settings.solver.pick_on(card, model, settings.contacts);
        let settings = SimulationSettings { solver, ..settings };
        let cpu = Simulation::new(model.clone(), settings).unwrap();
        Self { cpu, gpu }
    }
    pub fn both(&mut self) -> [&mut Simulation<f32>; 2] {
        [&mut self.cpu, &mut self.gpu]
    }
    /// Brings the worlds on the card to the state of those on the processor.
    pub fn put(&mut self) {
        self.gpu.restore(&self.cpu.snapshot()).unwrap();
    }
    pub fn step(&mut self, steps: usize) {
        self.cpu.step(steps);
        self.gpu.step(steps);
    }
    /// The largest difference of the worlds' states, in parts of the larger of a number and 1.
    pub fn apart(&mut self) -> f64 {
        let worlds = 0..self.cpu.worlds();
        let of_world = |world| {
            let [cpu, gpu] = self.both().map(|s| s.numbers_of_world(world).unwrap());
            apart(&cpu.state, &gpu.state)
        };
        worlds.map(of_world).fold(0.0, f64::max)
    }
    /// The largest difference of the bodies' poses [m, or numbers of unit quaternions].
    pub fn moved_apart(&mut self) -> f64 {
        let bodies = self.cpu.model().bodies.len();
        let (cpu, gpu) = (self.cpu.outputs(), self.gpu.outputs());
        let mut most = 0.0;
        for world in 0..cpu.worlds() {
            for body in (0..bodies).map(BodyId) {
                let [a, b] = [&cpu, &gpu].map(|o| o.body_pose(world, body));
                let position = apart(&a.position.to_array(), &b.position.to_array());
                // q and −q are the same orientation.
                let sign = a.orientation.dot(b.orientation).signum();
                let b = (b.orientation * sign).to_array();
                most = position.max(apart(&a.orientation.to_array(), &b)).max(most);
            }
        }
        most
    }
}

fn stir(simulation: &mut Simulation<f32>) {
    let model = simulation.model().clone();
    let (dofs, actuators) = (model.degrees_of_freedom(), model.actuators.len());
    let wave = |i: usize| (1.7 * i as f64 + 0.4).sin();
    let velocity: Vec<_> = (0..dofs).map(wave).collect();
    let control: Vec<_> = (0..actuators).map(|a| wave(a + 2)).collect();
    for world in 0..simulation.worlds() {
        let position = model.initial_position();
        let set = simulation.set_joint_state(world, &position, &velocity);
        set.unwrap();
        let push = 0.1 * (world % 8) as f64;
        let force: Vec<_> = (0..dofs).map(|v| 0.3 * wave(v + 1) + push).collect();
        let mut controls = simulation.controls();
        controls.set_force(world, &force).unwrap();
        controls.set_control(world, &control).unwrap();
    }
}

/// The largest difference, in parts of the larger of a number and 1.
pub fn apart(expected: &[f64], found: &[f64]) -> f64 {
    assert_eq!(expected.len(), found.len());
    let each = expected.iter().zip(found).enumerate();
    each.fold(0.0, |most, (i, (x, y))| {
        let difference = (x - y).abs() / x.abs().max(1.0);
        assert!(!difference.is_nan(), "number {i}: {x}, {y}");
        difference.max(most)
    })
}
