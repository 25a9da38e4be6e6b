//! What happens from one substep to the next: contacts begin and end, sensors are entered and left,
//! joints reach their limits, bodies fall asleep, worlds diverge.

use crate::engine::Task;
use crate::simulation::later;
use crate::{OutputPart, Outputs, Simulation, SimulationError};
use glam::DVec3;
use model::{BodyId, JointId, Model, ShapeId};
use numbers::Float;
use std::collections::{BTreeMap, BTreeSet};

/// Something that happened in a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// Which world.
    pub world: usize,
    /// End [s] of the substep in which it happened; sensors are as shapes lay at its beginning.
    pub time: f64,
    /// What.
    pub kind: EventKind,
}

/// Kinds of [`Event`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EventKind {
    /// Two shapes press on each other, and did not in the substep before.
    ContactBegins {
        /// The shapes; the second one moves.
        shapes: [ShapeId; 2],
        /// What the first shape gave to the second in this substep [N·s], world axes.
        impulse: DVec3,
    },
    /// Two shapes still press on each other.
    ContactPersists {
        /// The shapes; the second one moves.
        shapes: [ShapeId; 2],
        /// What the first shape gave to the second in this substep [N·s], world axes.
        impulse: DVec3,
    },
    /// Two shapes press on each other no more.
    ContactEnds {
        /// The shapes; the second one moves.
        shapes: [ShapeId; 2],
    },
    /// Two shapes overlap at the beginning of the substep, of which one or both are sensors, and did not at that of the
    /// substep before.
    SensorBegins {
        /// The shapes; the second one moves.
        shapes: [ShapeId; 2],
    },
    /// Two shapes overlap no more at the beginning of the substep, of which one or both are sensors.
    SensorEnds {
        /// The shapes; the second one moves.
        shapes: [ShapeId; 2],
    },
    /// A joint reaches the end of its range, which is that of the world's own model, and was within it in the substep
    /// before. Joints that close loops take no range, as they have no coordinates.
    LimitReached {
        /// Degree of freedom, as in `Outputs::joint_velocity`.
        dof: usize,
        /// Its upper end, else its lower.
        upper: bool,
    },
    /// A body has been slow for so long that it stays where it is until touched; `impulse` only.
    FallsAsleep {
        /// The body.
        body: BodyId,
    },
    /// A body that slept moves again; `impulse` only.
    Wakes {
        /// The body.
        body: BodyId,
    },
    /// The world left the finite numbers or its speed limit. It stays at its last good state, and
    /// nothing more is told of it until it is set or reset.
    Diverged,
}

/// Which events are told; none unless asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Watch {
    /// Contacts that begin or end.
    pub contacts: bool,
    /// Contacts that persist, in every substep.
    pub persisting_contacts: bool,
    /// Overlaps with sensors that begin or end.
    pub sensors: bool,
    /// Joints that reach their limits.
    pub limits: bool,
    /// Bodies that fall asleep or wake.
    pub sleep: bool,
    /// Worlds that diverge.
    pub divergence: bool,
}

impl Watch {
    /// All events.
    pub const ALL: Self = Self {
        contacts: true,
        persisting_contacts: true,
        sensors: true,
        limits: true,
        sleep: true,
        divergence: true,
    };
    fn anything(self) -> bool {
        self != Self::default()
    }
}

/// What is remembered of each world, and what has not been fetched yet.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watcher {
    watch: Watch,
    /// Per world: the shapes that press on each other.
    pressing: Vec<BTreeMap<[ShapeId; 2], DVec3>>,
    /// Of each shape, whether it is a sensor; none where they are not watched.
    sensors: Vec<bool>,
    /// Per world: the shapes that overlap, one of them a sensor.
    sensed: Vec<BTreeSet<[ShapeId; 2]>>,
    /// Per world: at which end of its range each degree of freedom is, as [`ends`] has it.
    ends: Vec<Vec<i8>>,
    /// Per world: which bodies sleep.
    asleep: Vec<Vec<bool>>,
    /// Per world: it has not diverged.
    runs: Vec<bool>,
    /// Worlds whose state was set since the last substep.
    set: Vec<usize>,
    queue: Vec<Event>,
}

impl Watcher {
    fn new(model: &Model, worlds: usize, watch: Watch) -> Self {
        let shapes = if watch.sensors {
            &model.shapes[..]
        } else {
            &[]
        };
        let bodies = if watch.sleep { model.bodies.len() } else { 0 };
        Self {
            watch,
            sensors: shapes.iter().map(|shape| shape.sensor).collect(),
            sensed: vec![BTreeSet::new(); worlds],
            asleep: vec![vec![false; bodies]; worlds],
            runs: vec![true; worlds],
            pressing: vec![BTreeMap::new(); worlds],
            ends: vec![Vec::new(); worlds],
            set: (0..worlds).collect(),
            queue: Vec::new(),
        }
    }

    /// Takes the state of a world for granted as it was last reported, or tells what changed to reach it.
    fn look<T: Float>(&mut self, simulation: &Simulation<T>, world: usize, told: Option<Told>) {
        let runs = simulation.runs(world);
        let ran = std::mem::replace(&mut self.runs[world], runs);
        let mut changes = Vec::new();
        if told.is_none() || runs {
            self.compare(simulation, world, told, &mut changes);
        } else if ran && self.watch.divergence {
            changes.push(EventKind::Diverged);
        }
        if let Some(Told { time, .. }) = told {
            let events = changes.into_iter().map(|kind| Event { world, time, kind });
            self.queue.extend(events);
        }
    }

    /// What changed in a world that runs: contacts, then sensors, limits, sleep.
    fn compare<T: Float>(
        &mut self,
        simulation: &Simulation<T>,
        world: usize,
        told: Option<Told>,
        changes: &mut Vec<EventKind>,
    ) {
        let outputs = &simulation.last_reported();
        if self.watch.contacts || self.watch.persisting_contacts {
            let now = pressing(outputs, world);
            if let Some(told) = told {
                self.contacts(world, &now, told.substep, changes);
            }
            self.pressing[world] = now;
        }
        if self.sensors.contains(&true) {
            let now = self.sensed_now(outputs, world);
            let before = std::mem::replace(&mut self.sensed[world], now);
            let now = &self.sensed[world];
            let begin = now.difference(&before).copied();
            changes.extend(begin.map(|shapes| EventKind::SensorBegins { shapes }));
            let end = before.difference(now).copied();
            changes.extend(end.map(|shapes| EventKind::SensorEnds { shapes }));
        }
        if self.watch.limits {
            let now = ends(simulation.world_model(world), outputs, world);
            let before = std::mem::replace(&mut self.ends[world], now);
            for (dof, (&now, before)) in self.ends[world].iter().zip(before).enumerate() {
                if now != 0 && now != before {
                    let upper = now > 0;
                    changes.push(EventKind::LimitReached { dof, upper });
                }
            }
        }
        for (body, before) in self.asleep[world].iter_mut().enumerate() {
            let body = BodyId(body);
            match (*before, outputs.asleep(world, body)) {
                (false, true) => changes.push(EventKind::FallsAsleep { body }),
                (true, false) => changes.push(EventKind::Wakes { body }),
                _ => continue,
            }
            *before = !*before;
        }
    }

    /// The shapes that overlap, one of them a sensor.
    fn sensed_now<T: Float>(
        &self,
        outputs: &Outputs<'_, T>,
        world: usize,
    ) -> BTreeSet<[ShapeId; 2]> {
        let contacts = outputs.contacts(world);
        contacts
            .filter(|c| c.distance <= 0.0 && c.shapes.iter().any(|shape| self.sensors[shape.0]))
            .map(|c| c.shapes)
            .collect()
    }

    /// What changed in the contacts of a world: what presses now, then what ended, each by shapes.
    fn contacts(
        &self,
        world: usize,
        now: &BTreeMap<[ShapeId; 2], DVec3>,
        substep: f64,
        changes: &mut Vec<EventKind>,
    ) {
        let before = &self.pressing[world];
        for (&shapes, &force) in now {
            let impulse = force * substep;
            if before.contains_key(&shapes) {
                if self.watch.persisting_contacts {
                    changes.push(EventKind::ContactPersists { shapes, impulse });
                }
            } else if self.watch.contacts {
                changes.push(EventKind::ContactBegins { shapes, impulse });
            }
        }
        let ended = before.keys().filter(|shapes| !now.contains_key(*shapes));
        if self.watch.contacts {
            changes.extend(ended.map(|&shapes| EventKind::ContactEnds { shapes }));
        }
    }
}

/// When the events of a substep happen, and how long [s] it was.
#[derive(Clone, Copy)]
struct Told {
    time: f64,
    substep: f64,
}

/// At which end of its range each degree of freedom of a world is, by the limits of that world's model: −1 at the lower,
/// 1 at the upper, else 0.
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

/// The shapes that press on each other, with the force [N] on the second.
fn pressing<T: Float>(outputs: &Outputs<'_, T>, world: usize) -> BTreeMap<[ShapeId; 2], DVec3> {
    let mut forces = BTreeMap::new();
    for contact in outputs.contacts(world) {
        if contact.force != DVec3::ZERO {
            *forces.entry(contact.shapes).or_insert(DVec3::ZERO) += contact.force;
        }
    }
    forces
}

impl<T: Float> Simulation<T> {
    /// Tells from now on what happens, to be fetched by
    /// [`drain_events`](Simulation::drain_events). Events not fetched yet are lost.
    ///
    /// Costs a report in every substep. What a world touched before it was set or reset does not end.
    pub fn watch(&mut self, watch: Watch) {
        self.watcher = watch
            .anything()
            .then(|| Watcher::new(self.model(), self.worlds(), watch));
    }

    /// The events since the last call: in the order of substeps, then of worlds, whatever the number of
    /// threads; the time of a world that was set or reset meanwhile starts at 0 again. Of a world in a
    /// substep: contacts, then sensors, limits, sleep, each in the order of shapes, degrees of freedom,
    /// bodies; a world that diverges tells that alone. Sensors are as shapes lay at the beginning of the
    /// substep, as `Outputs::contacts` are.
    pub fn drain_events(&mut self) -> Vec<Event> {
        self.watcher
            .as_mut()
            .map_or_else(Vec::new, |watcher| std::mem::take(&mut watcher.queue))
    }

    /// As [`step`](Simulation::step), and hands every event to a subscriber, in the same order.
    pub fn step_with(&mut self, steps: usize, mut subscriber: impl FnMut(&Event)) {
        for _ in 0..steps {
            self.step(1);
            self.drain_events().iter().for_each(&mut subscriber);
        }
    }

    /// What a world that was set touches, which limits it is at, and what in it sleeps, is no news.
    pub(crate) fn take_for_granted(&mut self, world: usize) {
        if let Some(watcher) = &mut self.watcher {
            watcher.set.push(world);
        }
    }

    /// Makes known what is watched of the present state, and no more.
    fn fetch_watched(&mut self, watch: Watch) -> Result<(), SimulationError> {
        let contacts = watch.contacts || watch.persisting_contacts || watch.sensors;
        let contacts = contacts.then_some(OutputPart::Contacts);
        let joints = (0..self.model().joints.len()).filter(|_| watch.limits);
        let bodies = (0..self.model().bodies.len()).filter(|_| watch.sleep);
        let joints = joints.map(|joint| OutputPart::Coordinates(JointId(joint)));
        let bodies = bodies.map(|body| OutputPart::Asleep(BodyId(body)));
        let parts = contacts.into_iter().chain(joints).chain(bodies);
        self.fetch_parts(Vec::from_iter(parts))
    }

    /// Makes so many substeps, and tells what happens in each.
    pub(crate) fn step_watched(
        &mut self,
        watcher: &mut Watcher,
        substeps: usize,
    ) -> Result<(), SimulationError> {
        let substep = self.settings().step.substep();
        self.fetch_watched(watcher.watch)?;
        for world in std::mem::take(&mut watcher.set) {
            watcher.look(self, world, None);
        }
        for i in 1..=substeps {
            self.perform(Task::Step(1))?;
            self.fetch_watched(watcher.watch)?;
            for world in 0..self.worlds() {
                let time = later(self.time[world], i, substep);
                watcher.look(self, world, Some(Told { time, substep }));
            }
        }
        Ok(())
    }
}
