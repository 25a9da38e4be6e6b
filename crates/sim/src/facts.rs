//! What holds in worlds, of all that events tell changes of: which shapes press on each other, which sensors overlap with
//! something, which joints are at the ends of their ranges, which bodies sleep.
//!
//! A kernel tells yes or no of each, in lanes or on the device that holds the worlds: of joints, and of pairs of shapes where
//! each has rows of contacts of its own. Forces are read in those worlds alone in which something differs from before. By
//! `impulse`, which has rows for whatever touches, what does is looked for in all contacts, and so is who sleeps.

use crate::{Gauges, OutputPart, Simulation, SimulationError, Watch};
use glam::DVec3;
use model::{BodyId, JointId, Model, ShapeId};
use numbers::Float;
use rigid::{FLAGS, Gauge};
use std::collections::{BTreeMap, BTreeSet};

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
pub(crate) struct Source<T: Float> {
    touching: Touching<T>,
    /// At which ends of their ranges joints are.
    ends: Flags<T>,
    /// Whose ends are watched.
    dofs: usize,
}

/// What touches, and what sleeps.
#[derive(Clone, Debug)]
enum Touching<T: Float> {
    Pairs(Box<Pairs<T>>),
    Contacts(Found),
}

impl<T: Float> Source<T> {
    pub fn new(simulation: &Simulation<T>, watch: Watch) -> Self {
        let (model, tables) = (simulation.model(), &simulation.output_tables);
        let joints = (0..model.joints.len()).filter(|_| watch.limits);
        let joints = Vec::from_iter(joints.map(JointId));
        Self {
            touching: if tables.names_contacts() || tables.asleep.is_some() {
                Touching::Contacts(Found::new(model, watch))
            } else {
                Touching::Pairs(Box::new(Pairs::new(simulation, watch)))
            },
            dofs: joints.iter().map(|j| model.dof_range(*j).len()).sum(),
            ends: Flags::new(simulation, vec![Gauge::AtEnd(joints)]),
        }
    }

    /// Facts of those of these worlds, in their order, in which they may differ from what was told before.
    pub fn news(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<(usize, Facts)>, SimulationError> {
        if worlds.is_empty() {
            return Ok(Vec::new());
        }
        // First what needs more of a report.
        let mut changed = match &mut self.touching {
            Touching::Pairs(pairs) => pairs.read(simulation, worlds)?,
            Touching::Contacts(found) => found.read(simulation, worlds)?,
        };
        let ends = self.ends.read(simulation, worlds)?;
        changed.iter_mut().zip(ends).for_each(|(x, end)| *x |= end);
        let changed = worlds.iter().zip(changed).filter(|(_, x)| *x);
        let changed = Vec::from_iter(changed.map(|(world, _)| *world));
        if let Touching::Pairs(pairs) = &mut self.touching {
            simulation.read_gauges(&mut pairs.forces, &changed)?;
        }
        let facts = |world| (world, self.facts(simulation, world));
        Ok(changed.into_iter().map(facts).collect())
    }

    /// As they were read last.
    fn facts(&self, simulation: &Simulation<T>, world: usize) -> Facts {
        let mut facts = match &self.touching {
            Touching::Pairs(pairs) => pairs.facts(world),
            Touching::Contacts(found) => found.facts(simulation, world),
        };
        let ends = self.ends.set(world, 0);
        let end = |dof: usize| match [2 * dof, 2 * dof + 1].map(|flag| ends.contains(&flag)) {
            [true, _] => 1,
            [_, true] => -1,
            _ => 0,
        };
        facts.ends = (0..self.dofs).map(end).collect();
        facts
    }

    /// Facts of these worlds are news in any case.
    pub fn forget(&mut self, worlds: &[usize]) {
        self.ends.forget(worlds);
        if let Touching::Pairs(pairs) = &mut self.touching {
            pairs.flags.forget(worlds);
        }
    }
}

/// Yes or no of many things, by a kernel.
#[derive(Clone, Debug)]
struct Flags<T: Float> {
    gauges: Gauges<T>,
    /// As they were read last, of each world.
    known: Vec<Option<Vec<T>>>,
}

impl<T: Float> Flags<T> {
    fn new(simulation: &Simulation<T>, list: Vec<Gauge>) -> Self {
        Self {
            gauges: simulation.checked_gauges(list),
            known: vec![None; simulation.worlds()],
        }
    }

    /// Whether they differ from what was read before, of each of these worlds.
    fn read(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<bool>, SimulationError> {
        simulation.read_gauges(&mut self.gauges, worlds)?;
        let mut now = vec![T::zero(); self.gauges.length()];
        let differ = worlds.iter().map(|&world| {
            self.gauges.copy(world, 0, &mut now);
            let differs = self.known[world].as_ref() != Some(&now);
            if differs {
                self.known[world] = Some(now.clone());
            }
            differs
        });
        Ok(differ.collect())
    }

    fn forget(&mut self, worlds: &[usize]) {
        worlds.iter().for_each(|world| self.known[*world] = None);
    }

    /// The numbers of a gauge.
    fn numbers(&self, world: usize, gauge: usize) -> &[T] {
        let known = self.known[world].as_deref();
        known.map_or(&[], |known| &known[self.gauges.numbers()[gauge].clone()])
    }

    /// The flags of a gauge that are set.
    fn set(&self, world: usize, gauge: usize) -> Vec<usize> {
        let numbers = self.numbers(world, gauge);
        let is_set = |flag: &usize| {
            let number = numbers[flag / FLAGS].to_f64() as u32;
            number >> (flag % FLAGS) & 1 == 1
        };
        (0..numbers.len() * FLAGS).filter(is_set).collect()
    }
}

/// What touches, of pairs that have rows of contacts of their own.
#[derive(Clone, Debug)]
struct Pairs<T: Float> {
    /// One gauge of each kind: what presses, what is sensed.
    flags: Flags<T>,
    /// Of what presses.
    forces: Gauges<T>,
    pressing: Vec<Pair>,
    sensed: Vec<Pair>,
    /// Whether forces are news.
    persisting: bool,
}

impl<T: Float> Pairs<T> {
    fn new(simulation: &Simulation<T>, watch: Watch) -> Self {
        let model = simulation.model();
        let is_sensed = |pair: &Pair| senses(model, *pair);
        let met = simulation.last_reported().shapes.iter().copied();
        let (sensed, pressing): (BTreeSet<Pair>, BTreeSet<Pair>) = met.partition(is_sensed);
        let pressing = Vec::from_iter(pressing.into_iter().filter(|_| watch.touches()));
        let sensed = Vec::from_iter(sensed.into_iter().filter(|_| watch.sensors));
        let flags = vec![
            Gauge::Pressing(pressing.clone()),
            Gauge::Overlapping(sensed.clone()),
        ];
        Self {
            flags: Flags::new(simulation, flags),
            forces: simulation.checked_gauges(vec![Gauge::PairForce(pressing.clone())]),
            pressing,
            sensed,
            persisting: watch.persisting_contacts,
        }
    }

    /// Whether there is anything to tell, of each of these worlds.
    fn read(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<bool>, SimulationError> {
        let mut changed = self.flags.read(simulation, worlds)?;
        for (changed, world) in changed.iter_mut().zip(worlds) {
            let mut pressing = self.flags.numbers(*world, 0).iter();
            *changed |= self.persisting && pressing.any(|x| *x != T::zero());
        }
        Ok(changed)
    }

    fn facts(&self, world: usize) -> Facts {
        let [pressing, sensed] = [0, 1].map(|gauge| self.flags.set(world, gauge));
        let mut forces = vec![T::zero(); self.forces.length()];
        self.forces.copy(world, 0, &mut forces);
        let force = |row: usize| DVec3::from_array([0, 1, 2].map(|i| forces[3 * row + i].to_f64()));
        let pressing = pressing.iter().map(|&i| (self.pressing[i], force(i)));
        Facts {
            pressing: pressing.collect(),
            sensed: sensed.iter().map(|&i| self.sensed[i]).collect(),
            ..Facts::default()
        }
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
        let bodies = (0..model.bodies.len()).filter(|_| watch.sleep);
        let bodies = bodies.map(|body| OutputPart::Asleep(BodyId(body)));
        Self {
            watch,
            parts: contacts.into_iter().chain(bodies).collect(),
        }
    }

    /// Of each of these worlds, there may be something to tell.
    fn read<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<Vec<bool>, SimulationError> {
        simulation.fetch_parts(self.parts.iter().copied())?;
        Ok(vec![true; worlds.len()])
    }

    fn facts<T: Float>(&self, simulation: &Simulation<T>, world: usize) -> Facts {
        let model = simulation.world_model(world);
        let outputs = simulation.last_reported();
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
