//! What holds in worlds, of all that events tell changes of: which shapes press on each other, which sensors overlap with
//! something, which joints are at the ends of their ranges, which bodies sleep.
//!
//! Where each pair of shapes has rows of contacts of its own, a kernel tells yes or no of each, in lanes or on the device
//! that holds the worlds; forces are read in those worlds alone in which something differs from before. By `impulse`, which
//! has rows for whatever touches, facts are looked for in all contacts.

use crate::{Gauges, OutputPart, Outputs, Simulation, SimulationError, Watch};
use glam::DVec3;
use model::{BodyId, JointId, Model, ShapeId};
use numbers::Float;
use rigid::{FLAGS, Gauge};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Two shapes, as contacts have them: the second one moves.
type Pair = [ShapeId; 2];

/// Of one world, as far as they are watched.
#[derive(Clone, Debug, Default)]
pub(crate) struct Facts {
    /// What presses on each other, with the force [N] on the second.
    pub pressing: BTreeMap<Pair, DVec3>,
    /// What overlaps, where one of them is a sensor.
    pub sensed: BTreeSet<Pair>,
    /// Of each degree of freedom: −1 at the lower end of its range, 1 at the upper, else 0.
    pub ends: Vec<i8>,
    /// Of each body.
    pub asleep: Vec<bool>,
}

/// Where facts come from.
#[derive(Clone, Debug)]
pub(crate) enum Source<T: Float> {
    Flags(Box<Flags<T>>),
    Contacts(Found),
}

impl<T: Float> Source<T> {
    pub fn new(simulation: &Simulation<T>, watch: Watch) -> Self {
        let tables = &simulation.output_tables;
        if tables.names_contacts() || tables.asleep.is_some() {
            Self::Contacts(Found::new(simulation.model(), watch))
        } else {
            Self::Flags(Box::new(Flags::new(simulation, watch)))
        }
    }

    /// Facts of those of these worlds, in their order, in which they may differ from what was told before.
    pub fn news(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<(usize, Facts)>, SimulationError> {
        match self {
            Self::Flags(flags) => flags.news(simulation, worlds),
            Self::Contacts(found) => found.news(simulation, worlds),
        }
    }

    /// Facts of these worlds are news in any case.
    pub fn forget(&mut self, worlds: &[usize]) {
        if let Self::Flags(flags) = self {
            worlds.iter().for_each(|world| flags.known[*world] = None);
        }
    }
}

/// Facts by kernels.
#[derive(Clone, Debug)]
pub(crate) struct Flags<T: Float> {
    /// One of each kind: what presses, what is sensed, what is at an end.
    flags: Gauges<T>,
    /// Of what presses.
    forces: Gauges<T>,
    pairs: Vec<Pair>,
    sensed: Vec<Pair>,
    dofs: usize,
    /// Whether forces are news.
    persisting: bool,
    /// The flags of each world that were told of last.
    known: Vec<Option<Vec<T>>>,
}

impl<T: Float> Flags<T> {
    fn new(simulation: &Simulation<T>, watch: Watch) -> Self {
        let model = simulation.model();
        let is_sensed = |pair: &Pair| senses(model, *pair);
        let met = simulation.last_reported().shapes.iter().copied();
        let (sensed, pairs): (BTreeSet<Pair>, BTreeSet<Pair>) = met.partition(is_sensed);
        let pairs = Vec::from_iter(pairs.into_iter().filter(|_| watch.touches()));
        let sensed = Vec::from_iter(sensed.into_iter().filter(|_| watch.sensors));
        let joints = (0..model.joints.len()).filter(|_| watch.limits);
        let joints = Vec::from_iter(joints.map(JointId));
        Self {
            dofs: joints.iter().map(|j| model.dof_range(*j).len()).sum(),
            flags: simulation.checked_gauges(vec![
                Gauge::Pressing(pairs.clone()),
                Gauge::Overlapping(sensed.clone()),
                Gauge::AtEnd(joints),
            ]),
            forces: simulation.checked_gauges(vec![Gauge::PairForce(pairs.clone())]),
            pairs,
            sensed,
            persisting: watch.persisting_contacts,
            known: vec![None; simulation.worlds()],
        }
    }

    fn news(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<(usize, Facts)>, SimulationError> {
        simulation.read_gauges(&mut self.flags, worlds)?;
        let mut now = vec![T::zero(); self.flags.length()];
        let pressing = self.flags.numbers()[0].clone();
        let mut changed = Vec::new();
        for &world in worlds {
            self.flags.copy(world, 0, &mut now);
            let persists = self.persisting && now[pressing.clone()].iter().any(|x| *x != T::zero());
            if persists || self.known[world].as_ref() != Some(&now) {
                self.known[world] = Some(now.clone());
                changed.push(world);
            }
        }
        simulation.read_gauges(&mut self.forces, &changed)?;
        let facts = |world| (world, self.facts(world));
        Ok(changed.into_iter().map(facts).collect())
    }

    /// As they were read last.
    fn facts(&self, world: usize) -> Facts {
        let [pressing, sensed, ends] = [0, 1, 2].map(|gauge| self.set(world, gauge));
        let mut forces = vec![T::zero(); self.forces.length()];
        self.forces.copy(world, 0, &mut forces);
        let force = |row: usize| DVec3::from_array([0, 1, 2].map(|i| forces[3 * row + i].to_f64()));
        let end = |dof: usize| match [2 * dof, 2 * dof + 1].map(|flag| ends.contains(&flag)) {
            [true, _] => 1,
            [_, true] => -1,
            _ => 0,
        };
        Facts {
            pressing: pressing
                .iter()
                .map(|&i| (self.pairs[i], force(i)))
                .collect(),
            sensed: sensed.iter().map(|&i| self.sensed[i]).collect(),
            ends: (0..self.dofs).map(end).collect(),
            asleep: Vec::new(),
        }
    }

    /// The flags of a gauge that are set.
    fn set(&self, world: usize, gauge: usize) -> Vec<usize> {
        let numbers: Range<usize> = self.flags.numbers()[gauge].clone();
        let known = self.known[world].as_deref().unwrap_or_default();
        let number = |i: usize| known[numbers.start + i].to_f64() as u32;
        let all = 0..numbers.len() * FLAGS;
        all.filter(|flag| number(flag / FLAGS) >> (flag % FLAGS) & 1 == 1)
            .collect()
    }
}

/// Facts that are looked for in what is reported.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    watch: Watch,
    parts: Vec<OutputPart>,
}

impl Found {
    fn new(model: &Model, watch: Watch) -> Self {
        let contacts = watch.touches() || watch.sensors;
        let contacts = contacts.then_some(OutputPart::Contacts);
        let joints = (0..model.joints.len()).filter(|_| watch.limits);
        let bodies = (0..model.bodies.len()).filter(|_| watch.sleep);
        let joints = joints.map(|joint| OutputPart::Coordinates(JointId(joint)));
        let bodies = bodies.map(|body| OutputPart::Asleep(BodyId(body)));
        let parts = contacts.into_iter().chain(joints).chain(bodies);
        Self {
            watch,
            parts: parts.collect(),
        }
    }

    fn news<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<(usize, Facts)>, SimulationError> {
        simulation.fetch_parts(self.parts.iter().copied())?;
        let outputs = simulation.last_reported();
        let facts = |&world| {
            let facts = self.facts(simulation.world_model(world), &outputs, world);
            (world, facts)
        };
        Ok(worlds.iter().map(facts).collect())
    }

    /// As they were reported last, by the limits of that world's model.
    fn facts<T: Float>(&self, model: &Model, outputs: &Outputs<'_, T>, world: usize) -> Facts {
        let mut facts = Facts::default();
        let watch = self.watch;
        if watch.touches() {
            for contact in outputs.contacts(world) {
                if contact.force != DVec3::ZERO {
                    let force = facts.pressing.entry(contact.shapes).or_default();
                    *force += contact.force;
                }
            }
        }
        if watch.sensors {
            let within = outputs.contacts(world).filter(|c| c.distance <= 0.0);
            let sensed = within.filter(|c| senses(model, c.shapes));
            facts.sensed = sensed.map(|c| c.shapes).collect();
        }
        if watch.limits {
            facts.ends = ends(model, outputs, world);
        }
        if watch.sleep {
            let bodies = (0..model.bodies.len()).map(BodyId);
            facts.asleep = bodies.map(|body| outputs.asleep(world, body)).collect();
        }
        facts
    }
}

fn senses(model: &Model, pair: Pair) -> bool {
    pair.iter().any(|shape| model.shapes[shape.0].sensor)
}

/// At which end of its range each degree of freedom of a world is.
fn ends<T: Float>(model: &Model, outputs: &Outputs<'_, T>, world: usize) -> Vec<i8> {
    let mut ends = vec![0; model.degrees_of_freedom()];
    for (i, joint) in model.joints.iter().enumerate() {
        let id = JointId(i);
        let rows = model.dof_range(id).zip(model.coordinate_range(id));
        for (dof, (row, coordinate)) in joint.dofs.iter().zip(rows) {
            if let Some(limit) = dof.limit {
                let x = outputs.coordinate(world, coordinate);
                ends[row] = match (x >= limit.upper, x <= limit.lower) {
                    (true, _) => 1,
                    (_, true) => -1,
                    _ => 0,
                };
            }
        }
    }
    ends
}
