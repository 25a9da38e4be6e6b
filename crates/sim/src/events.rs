//! What happens from one substep to the next: contacts begin and end, sensors are entered and left,
//! joints reach their limits, bodies fall asleep, worlds diverge.

use crate::device::each_once;
use crate::engine::Task;
use crate::facts::{Facts, Source};
use crate::simulation::later;
use crate::{Simulation, SimulationError};
use glam::DVec3;
use model::{BodyId, ShapeId};
use numbers::Float;

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
    /// Whether contacts are looked at, whatever is told of them.
    pub(crate) fn touches(self) -> bool {
        self.contacts || self.persisting_contacts
    }
    fn anything(self) -> bool {
        self != Self::default()
    }
}

/// What is remembered of each world, and what has not been fetched yet.
#[derive(Clone, Debug)]
pub(crate) struct Watcher<T: Float> {
    watch: Watch,
    source: Source<T>,
    /// Of each world, as they were last.
    facts: Vec<Facts>,
    /// Of each world: it has not diverged.
    runs: Vec<bool>,
    /// Worlds whose state was set since the last substep.
    set: Vec<usize>,
    queue: Vec<Event>,
}

impl<T: Float> Watcher<T> {
    fn new(simulation: &Simulation<T>, watch: Watch) -> Self {
        let worlds = simulation.worlds();
        Self {
            watch,
            source: Source::new(simulation, watch),
            facts: vec![Facts::default(); worlds],
            runs: vec![true; worlds],
            set: (0..worlds).collect(),
            queue: Vec::new(),
        }
    }

    /// Takes worlds that were set for granted as they are.
    fn take_for_granted(&mut self, simulation: &mut Simulation<T>) -> Result<(), SimulationError> {
        each_once(&mut self.set);
        self.source.forget(&self.set);
        for (world, facts) in self.source.news(simulation, &self.set)? {
            self.facts[world] = facts;
            self.runs[world] = simulation.runs(world);
        }
        self.set.clear();
        Ok(())
    }

    /// Tells what a substep has changed, of so many seconds, which has just ended at a time of each world.
    fn look(
        &mut self,
        simulation: &mut Simulation<T>,
        time: impl Fn(usize) -> f64,
        substep: f64,
    ) -> Result<(), SimulationError> {
        let running = (0..self.runs.len()).filter(|world| simulation.runs(*world));
        let running = Vec::from_iter(running);
        let mut news = self
            .source
            .news(simulation, &running)?
            .into_iter()
            .peekable();
        for world in 0..self.runs.len() {
            let runs = simulation.runs(world);
            let ran = std::mem::replace(&mut self.runs[world], runs);
            let mut changes = Vec::new();
            if let Some((_, now)) = news.next_if(|(of, _)| *of == world) {
                let before = std::mem::replace(&mut self.facts[world], now);
                self.compare([&before, &self.facts[world]], substep, &mut changes);
            } else if ran && !runs && self.watch.divergence {
                changes.push(EventKind::Diverged);
            }
            let time = time(world);
            let events = changes.into_iter().map(|kind| Event { world, time, kind });
            self.queue.extend(events);
        }
        Ok(())
    }

    /// What is not as before in a world: contacts, then sensors, limits, sleep.
    fn compare(&self, [before, now]: [&Facts; 2], substep: f64, changes: &mut Vec<EventKind>) {
        self.contacts([before, now], substep, changes);
        let begin = now.sensed.difference(&before.sensed);
        changes.extend(begin.map(|&shapes| EventKind::SensorBegins { shapes }));
        let end = before.sensed.difference(&now.sensed);
        changes.extend(end.map(|&shapes| EventKind::SensorEnds { shapes }));
        for (dof, (now, before)) in now.ends.iter().zip(&before.ends).enumerate() {
            if *now != 0 && now != before {
                let upper = *now > 0;
                changes.push(EventKind::LimitReached { dof, upper });
            }
        }
        for (row, (now, before)) in now.asleep.iter().zip(&before.asleep).enumerate() {
            let body = BodyId(row);
            match (*before, *now) {
                (false, true) => changes.push(EventKind::FallsAsleep { body }),
                (true, false) => changes.push(EventKind::Wakes { body }),
                _ => {}
            }
        }
    }

    /// What is not as before in the contacts of a world: what presses now, then what ended, each by shapes.
    fn contacts(&self, [before, now]: [&Facts; 2], substep: f64, changes: &mut Vec<EventKind>) {
        for (&shapes, &force) in &now.pressing {
            let impulse = force * substep;
            if before.pressing.contains_key(&shapes) {
                if self.watch.persisting_contacts {
                    changes.push(EventKind::ContactPersists { shapes, impulse });
                }
            } else if self.watch.contacts {
                changes.push(EventKind::ContactBegins { shapes, impulse });
            }
        }
        let pressed = before.pressing.keys();
        let ended = pressed.filter(|shapes| !now.pressing.contains_key(*shapes));
        if self.watch.contacts {
            changes.extend(ended.map(|&shapes| EventKind::ContactEnds { shapes }));
        }
    }
}

impl<T: Float> Simulation<T> {
    /// Tells from now on what happens, to be fetched by
    /// [`drain_events`](Simulation::drain_events). Events not fetched yet are lost.
    ///
    /// Costs a report of contacts or joints in every substep. What a world touched before it was set or reset does not end.
    pub fn watch(&mut self, watch: Watch) {
        self.watcher = watch.anything().then(|| Watcher::new(self, watch));
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

    /// Makes so many substeps, and tells what happens in each.
    pub(crate) fn step_watched(
        &mut self,
        watcher: &mut Watcher<T>,
        substeps: usize,
    ) -> Result<(), SimulationError> {
        let substep = self.settings().step.substep();
        watcher.take_for_granted(self)?;
        let begun = self.time.clone();
        for i in 1..=substeps {
            self.perform(Task::Step(1))?;
            let time = |world: usize| later(begun[world], i, substep);
            watcher.look(self, time, substep)?;
        }
        Ok(())
    }
}
