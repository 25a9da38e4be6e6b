//! What sensors of joints, bodies and contacts read of many worlds at once, again and again.
//!
//! By a kernel ([`rigid::Gauges`]): in lanes, or on the device that holds the worlds, of which no more than what is read
//! comes back.

use crate::compile::Compiled;
use crate::device::Constants;
use crate::error::{index, length};
use crate::instrument::Reader;
use crate::outputs::existing;
use crate::queries::check_pose;
use crate::{OutputPart, Simulation, SimulationError};
use model::{BodyId, Joint, JointId, Model, Mount, ShapeId};
use numbers::{Float, Memory};
use rigid::{Gauge, Instrument, Report, Reported};
use std::ops::Range;
use std::sync::Arc;

/// Gauges of a model. See [`Simulation::gauges`].
#[derive(Clone)]
pub struct Gauges<T: Float> {
    model: Arc<Model>,
    /// Its name, and whether shapes touch: on both depends where contacts stand.
    solver: (&'static str, bool),
    worlds: usize,
    list: Vec<Gauge>,
    numbers: Vec<Range<usize>>,
    /// What of the outputs they are read from.
    parts: Vec<OutputPart>,
    reader: Reader<T>,
    /// The model of each world when its constants were written, if worlds have had their own.
    models: Vec<Arc<Model>>,
}

impl<T: Float> std::fmt::Debug for Gauges<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gauges")
            .field("list", &self.list)
            .finish_non_exhaustive()
    }
}

impl<T: Float> Gauges<T> {
    /// How many numbers of a world they have together.
    pub fn length(&self) -> usize {
        self.reader.length()
    }
    /// How much of the outputs they are read from.
    pub fn needs(&self) -> Report {
        let needs = self.parts.iter().map(|part| part.needs()).max();
        needs.unwrap_or(Report::Joints)
    }
    /// Which of these numbers are each gauge's, in their order.
    pub fn numbers(&self) -> &[Range<usize>] {
        &self.numbers
    }
    /// Copies numbers as they were last read of a world, 0 before, from that in this row on: as many as there is room for.
    ///
    /// Panics where the world or a number does not exist, as an array would.
    pub fn copy(&self, world: usize, from: usize, numbers: &mut [T]) {
        let world = existing("world", world, self.worlds);
        self.reader.copy(world, from, numbers);
    }
}

impl<T: Float> Simulation<T> {
    /// Gauges of joints, bodies and contacts, to be read in many worlds at once, again and again, by
    /// [`read_gauges`](Self::read_gauges).
    ///
    /// # Errors
    /// A body, joint, shape or actuator that does not exist; a frame that is nowhere, or turned by no rotation; efforts of drives
    /// with a control time.
    pub fn gauges(&self, mut list: Vec<Gauge>) -> Result<Gauges<T>, SimulationError> {
        let model = self.model();
        for (i, gauge) in list.iter_mut().enumerate() {
            check(model, gauge, i)?;
        }
        Ok(self.checked_gauges(list))
    }

    /// The same of what the model has.
    pub(crate) fn checked_gauges(&self, list: Vec<Gauge>) -> Gauges<T> {
        let compiled = self.compiled_gauges((self.model(), &self.shared), &list);
        let rows = self.last_reported().contact_rows(|_| true).len();
        let parts = list.iter().flat_map(|gauge| self.parts(gauge, rows));
        Gauges {
            model: Arc::clone(self.model()),
            solver: (self.solver(), self.settings().contacts),
            worlds: self.worlds(),
            numbers: compiled.numbers().to_vec(),
            parts: parts.collect(),
            reader: Reader::new(
                Instrument::Gauges(compiled),
                self.worlds(),
                self.output.width(),
            ),
            models: Vec::new(),
            list,
        }
    }

    /// By the numbers of a model.
    fn compiled_gauges(
        &self,
        (model, compiled): (&Model, &Compiled<T>),
        list: &[Gauge],
    ) -> rigid::Gauges {
        let reported = Reported {
            outputs: &self.output_tables,
            inputs: &self.input_tables,
            contact_shapes: self.shared.engine.contact_shapes(),
            acting: &compiled.acting,
        };
        rigid::Gauges::new(model, &reported, list)
    }

    /// Reads gauges in these worlds as they are now, of contacts as they were in the last step; see [`Gauges::copy`].
    ///
    /// # Errors
    /// Gauges of another model or solver, or another number of worlds; a world that does not exist; worlds are on a device,
    /// and it fails.
    pub fn read_gauges(
        &mut self,
        gauges: &mut Gauges<T>,
        worlds: &[usize],
    ) -> Result<(), SimulationError> {
        self.recognise_gauges(gauges)?;
        let count = self.worlds();
        worlds.iter().try_for_each(|&w| index("world", w, count))?;
        if gauges.reader.width() != self.output.width() {
            *gauges = self.gauges(std::mem::take(&mut gauges.list))?;
        }
        if worlds.is_empty() || gauges.length() == 0 {
            return Ok(());
        }
        self.renew_constants(gauges);
        let (needs, reader) = (gauges.needs(), &mut gauges.reader);
        if !self.measure_there(reader, needs, worlds)? {
            self.fetch_parts(gauges.parts.iter().copied())?;
            self.measure_here(reader, worlds);
        }
        Ok(())
    }

    fn recognise_gauges(&self, gauges: &mut Gauges<T>) -> Result<(), SimulationError> {
        length("worlds of the gauges", gauges.worlds, self.worlds())?;
        let solver = (self.solver(), self.settings().contacts);
        if gauges.solver != solver || !self.recognises(&mut gauges.model) {
            return Err(SimulationError::OtherModel("gauges are"));
        }
        Ok(())
    }

    /// Writes the constants of worlds whose models have changed.
    fn renew_constants(&self, gauges: &mut Gauges<T>) {
        if !self.has_own_models() {
            return;
        }
        let Gauges {
            models,
            reader,
            list,
            ..
        } = gauges;
        let length = reader.instrument().sheet().parameters.len();
        if length == 0 {
            return;
        }
        let own = reader.own.get_or_insert_with(|| Constants {
            numbers: Memory::new(self.worlds(), length, self.output.width()),
            version: 0,
            changed: vec![0; self.worlds()],
        });
        let mut last: Option<(&Arc<Model>, rigid::Gauges)> = None;
        let version = own.version + 1;
        for world in 0..self.worlds() {
            let model = self.world_model(world);
            if models
                .get(world)
                .is_some_and(|known| Arc::ptr_eq(known, model))
            {
                continue;
            }
            // Neighbours often share a model.
            if !last.as_ref().is_some_and(|(of, _)| Arc::ptr_eq(of, model)) {
                let own = (&**model, self.compiled(world));
                last = Some((model, self.compiled_gauges(own, list)));
            }
            let parameters = last
                .as_ref()
                .map_or(&[][..], |(_, own)| &own.sheet().parameters);
            for (i, x) in parameters.iter().enumerate() {
                own.numbers.set(world, i, T::from_f64(*x));
            }
            match models.get_mut(world) {
                Some(known) => *known = Arc::clone(model),
                None => models.push(Arc::clone(model)),
            }
            own.changed[world] = version;
            own.version = version;
        }
    }

    /// What of the outputs a gauge is read from, where there are so many rows of contacts.
    fn parts(&self, gauge: &Gauge, all: usize) -> Vec<OutputPart> {
        use OutputPart::*;
        let model = self.model();
        let mounts = |mounts: &[Mount]| -> Vec<OutputPart> {
            let bodies = mounts.iter().filter_map(|mount| mount.body);
            bodies.map(Motion).collect()
        };
        let axes = |joint: JointId| [Coordinates(joint), Velocities(joint)];
        let contacts = |body: BodyId| -> Vec<OutputPart> {
            let of = |shape: ShapeId| model.shapes[shape.0].body == Some(body);
            let rows = self.last_reported().contact_rows(of);
            if rows.len() == all {
                return vec![Contacts];
            }
            rows.into_iter().map(ContactRow).collect()
        };
        match gauge {
            Gauge::JointPosition(joints) | Gauge::AtEnd(joints) => {
                joints.iter().map(|j| Coordinates(*j)).collect()
            }
            Gauge::JointVelocity(joints) => joints.iter().map(|j| Velocities(*j)).collect(),
            Gauge::JointEffort(joints) => joints.iter().flat_map(|j| axes(*j)).collect(),
            Gauge::ActuatorForce(rows) => {
                let joints = rows.iter().map(|row| model.actuators[*row].joint);
                joints.flat_map(axes).collect()
            }
            Gauge::Imu(mount) => {
                let of = |body| [Motion(body), Acceleration(body)];
                mount.body.into_iter().flat_map(of).collect()
            }
            Gauge::ForceTorque(joint, _) => {
                vec![Motion(model.joints[joint.0].child), Reaction(*joint)]
            }
            Gauge::Touch(body) => contacts(*body),
            Gauge::Pressing(pairs) | Gauge::Overlapping(pairs) | Gauge::PairForce(pairs) => {
                vec![Contacts; usize::from(!pairs.is_empty())]
            }
            Gauge::ContactForce(body, _) => [contacts(*body), vec![Motion(*body)]].concat(),
            Gauge::FramePose(frames) => mounts(frames),
            Gauge::FrameVelocity(mount, _) => mounts(std::slice::from_ref(mount)),
            Gauge::CenterOfMass(_) => {
                let bodies = (0..model.bodies.len()).map(BodyId);
                bodies.map(Motion).collect()
            }
        }
    }
}

/// Refuses what the model does not have; scales orientations to unit length.
fn check(model: &Model, gauge: &mut Gauge, row: usize) -> Result<(), SimulationError> {
    let body = |id: BodyId| index("body", id.0, model.bodies.len());
    let joint = |id: JointId| index("joint", id.0, model.joints.len());
    let shapes = |pairs: &[[ShapeId; 2]]| {
        let mut all = pairs.iter().flatten();
        all.try_for_each(|id| index("shape", id.0, model.shapes.len()))
    };
    let place = |mount: &mut Mount| {
        mount.body.map_or(Ok(()), body)?;
        mount.pose = check_pose(("gauge", row), mount.pose)?;
        Ok(())
    };
    match gauge {
        Gauge::JointPosition(joints) | Gauge::JointVelocity(joints) | Gauge::AtEnd(joints) => {
            joints.iter().try_for_each(|&id| joint(id))
        }
        Gauge::JointEffort(joints) => joints.iter().try_for_each(|&id| {
            joint(id)?;
            follows_at_once(&model.joints[id.0], row)
        }),
        Gauge::ActuatorForce(rows) => {
            let count = model.actuators.len();
            rows.iter().try_for_each(|&a| index("actuator", a, count))
        }
        Gauge::Imu(mount) | Gauge::FrameVelocity(mount, _) => place(mount),
        Gauge::ForceTorque(id, frame) => {
            joint(*id)?;
            if let Some(frame) = frame {
                *frame = check_pose(("gauge", row), *frame)?;
            }
            Ok(())
        }
        Gauge::Touch(id) | Gauge::ContactForce(id, _) => body(*id),
        Gauge::FramePose(frames) => frames.iter_mut().try_for_each(place),
        Gauge::Pressing(pairs) | Gauge::Overlapping(pairs) | Gauge::PairForce(pairs) => {
            shapes(pairs)
        }
        Gauge::CenterOfMass(of) => of.map_or(Ok(()), body),
    }
}

/// Refuses drives of which only their solver knows where they follow their targets.
fn follows_at_once(joint: &Joint, row: usize) -> Result<(), SimulationError> {
    let late = joint.dofs.iter().find(|dof| dof.drive.control_time != 0.0);
    late.map_or(Ok(()), |dof| {
        Err(SimulationError::Query {
            query: "gauge",
            index: row,
            what: "control time of a drive",
            value: format!("{} s (joint `{}`)", dof.drive.control_time, joint.name),
            remedy: "0 where efforts are read: smooth the targets that are set",
        })
    })
}
