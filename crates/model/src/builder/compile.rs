//! From the tree of objects to flat tables.

use super::joint::Frames;
use super::{
    BodyHandle, ContactPairDraft, JointDraft, JointHandle, Object, ObjectId, ShapeHandle, foreign,
};
use crate::model::{MOST_ROWS, Subject};
use crate::{
    BodyId, ContactPair, Coupling, Joint, JointId, ModelError, Parts, Pose, Shape, ShapeId,
};

/// Appends the rows of all replicas of all objects, and of all pairs, to the parts.
pub(super) fn compile(
    objects: &[Object],
    pairs: &[ContactPairDraft],
    parts: &mut Parts,
) -> Result<(), ModelError> {
    must_be_few(objects)?;
    let layout = Layout::of(objects);
    for object in objects {
        let subject = Subject {
            kind: "object",
            name: &object.name,
        };
        for (k, placement) in object.placements.iter().enumerate() {
            subject.pose("placement", placement)?;
            let replica = Replica {
                layout: &layout,
                object,
                k,
            };
            replica.bodies(parts)?;
            replica.joints(parts)?;
            replica.exclusions(parts)?;
            replica.couplings(parts)?;
            replica.actuators(parts)?;
        }
    }
    for (number, pair) in pairs.iter().enumerate() {
        let what = format!("contact pair \"{number}\"");
        for replicas in matching(&what, objects, pair.shapes.map(|shape| shape.object))? {
            let row = |side: usize| layout.shape(&what, pair.shapes[side], replicas[side]);
            let shapes = (row(0)?, row(1)?);
            parts
                .contact_pairs
                .push(ContactPair::new(shapes, pair.surface()));
        }
    }
    Ok(())
}

/// Which replicas of two objects belong together: those of the same number, or all with the only one.
fn matching(
    what: &str,
    objects: &[Object],
    ids: [ObjectId; 2],
) -> Result<impl Iterator<Item = [usize; 2]> + use<>, ModelError> {
    let known = |id| find(objects, id).ok_or_else(|| foreign(what, "shape"));
    let [one, other] = [known(ids[0])?, known(ids[1])?];
    let counts = [one, other].map(|object| object.placements.len());
    let count = match counts {
        [a, b] if a == b => a,
        [1, n] | [n, 1] => n,
        [count, other_count] => {
            return Err(ModelError::ReplicasDiffer {
                what: what.into(),
                role: "second shape",
                count,
                other: other.name.clone(),
                other_count,
            });
        }
    };
    let place = move |k: usize| counts.map(|count| if count == 1 { 0 } else { k });
    Ok((0..count).map(place))
}

/// The object that a handle means, unless it is another builder's.
pub(super) fn find(objects: &[Object], id: ObjectId) -> Option<&Object> {
    objects.get(id.index).filter(|object| object.id() == id)
}

/// Stops before tables are filled that no model may have.
fn must_be_few(objects: &[Object]) -> Result<(), ModelError> {
    let rows = |of: fn(&Object) -> usize| {
        objects
            .iter()
            .map(|o| o.placements.len().saturating_mul(of(o)))
            .sum()
    };
    let most = MOST_ROWS;
    let tables = [
        ("replicas", rows(|_| 1)),
        ("bodies", rows(|o| o.bodies.len())),
        ("shapes", rows(Object::shapes)),
        ("joints", rows(|o| o.joints.len())),
        ("exclusions", rows(|o| o.exclusions.len())),
        ("couplings", rows(|o| o.couplings.len())),
        ("actuators", rows(|o| o.actuators.len())),
    ];
    match tables.into_iter().find(|&(_, count)| count > most) {
        Some((what, count)) => Err(ModelError::TooMany { what, count, most }),
        None => Ok(()),
    }
}

/// Knows the row of every body and joint: rows come object by object, replica by replica.
pub(super) struct Layout<'a> {
    objects: &'a [Object],
    body_start: Vec<usize>,
    joint_start: Vec<usize>,
    shape_start: Vec<usize>,
}

impl<'a> Layout<'a> {
    pub fn of(objects: &'a [Object]) -> Self {
        let starts = |rows: fn(&Object) -> usize| {
            let ends = objects.iter().scan(0, move |end, o| {
                let start = *end;
                *end += o.placements.len() * rows(o);
                Some(start)
            });
            ends.collect()
        };
        let body_start = starts(|o| o.bodies.len());
        let joint_start = starts(|o| o.joints.len());
        let shape_start = starts(Object::shapes);
        Self {
            objects,
            body_start,
            joint_start,
            shape_start,
        }
    }

    /// Row of a body's k-th replica.
    pub fn body(&self, what: &str, body: BodyHandle, k: usize) -> Result<BodyId, ModelError> {
        let object = self.replicated(what, body.object, k)?;
        let (start, rows) = (self.body_start[body.object.index], object.bodies.len());
        let known = body.index < rows;
        known
            .then(|| BodyId(start + k * rows + body.index))
            .ok_or_else(|| foreign(what, "body"))
    }
    /// Row of a joint's k-th replica.
    pub fn joint(&self, what: &str, joint: JointHandle, k: usize) -> Result<JointId, ModelError> {
        let object = self.replicated(what, joint.object, k)?;
        let (start, rows) = (self.joint_start[joint.object.index], object.joints.len());
        let known = joint.index < rows;
        known
            .then(|| JointId(start + k * rows + joint.index))
            .ok_or_else(|| foreign(what, "joint"))
    }
    /// Row of a shape's k-th replica.
    pub fn shape(&self, what: &str, shape: ShapeHandle, k: usize) -> Result<ShapeId, ModelError> {
        let object = self.replicated(what, shape.object, k)?;
        let body = shape.body.unwrap_or(object.bodies.len());
        let (before, rest) = object.bodies.split_at_checked(body).unwrap_or_default();
        let before: usize = before.iter().map(|body| body.shapes.len()).sum();
        let shapes = match (shape.body, rest.first()) {
            (None, _) => object.scenery.len(),
            (Some(_), body) => body.map_or(0, |body| body.shapes.len()),
        };
        let row = self.shape_start[shape.object.index] + k * object.shapes() + before + shape.index;
        let known = shape.index < shapes;
        known
            .then_some(ShapeId(row))
            .ok_or_else(|| foreign(what, "shape"))
    }
    fn replicated(&self, what: &str, id: ObjectId, k: usize) -> Result<&'a Object, ModelError> {
        let object = find(self.objects, id).ok_or_else(|| foreign(what, "object"))?;
        let count = object.placements.len();
        if k < count {
            return Ok(object);
        }
        Err(ModelError::NoSuchReplica {
            object: object.name.clone(),
            replica: k,
            count,
        })
    }
    /// Where a body's k-th replica was placed in the world.
    fn pose(&self, body: BodyHandle, k: usize) -> Pose {
        let object = &self.objects[body.object.index];
        object.placements[k] * object.bodies[body.index].body.pose
    }
}

/// The k-th replica of an object.
struct Replica<'a> {
    layout: &'a Layout<'a>,
    object: &'a Object,
    k: usize,
}

impl Replica<'_> {
    fn bodies(&self, parts: &mut Parts) -> Result<(), ModelError> {
        for draft in &self.object.bodies {
            let mut body = draft.finished()?;
            body.name = self.name(&body.name);
            body.pose = self.placement() * body.pose;
            let id = BodyId(parts.bodies.len());
            parts.bodies.push(body);
            parts.shapes.extend(
                draft
                    .finished_shapes()
                    .map(|s| self.shape(&s, Some(id), s.pose)),
            );
        }
        let scenery = self.object.scenery.iter();
        parts
            .shapes
            .extend(scenery.map(|s| self.shape(s, None, self.placement() * s.pose)));
        Ok(())
    }

    fn joints(&self, parts: &mut Parts) -> Result<(), ModelError> {
        for draft in &self.object.joints {
            parts.joints.push(self.joint(draft)?);
        }
        Ok(())
    }

    fn exclusions(&self, parts: &mut Parts) -> Result<(), ModelError> {
        for &(body, other) in &self.object.exclusions {
            let what = format!("exclusion in object \"{}\"", self.object.name);
            self.must_own(&what, "first body", body.object)?;
            let body = self.layout.body(&what, body, self.k)?;
            let other = other.map(|other| {
                let k = self.other_replica(&what, "second body", other.object)?;
                self.layout.body(&what, other, k)
            });
            parts.exclusions.push((other.transpose()?, body));
        }
        Ok(())
    }

    fn couplings(&self, parts: &mut Parts) -> Result<(), ModelError> {
        for draft in &self.object.couplings {
            let what = format!("coupling \"{}\"", draft.coupling.name);
            parts.couplings.push(Coupling {
                name: self.name(&draft.coupling.name),
                joint: self.own_joint(&what, draft.joint)?,
                other: self.own_joint(&what, draft.other)?,
                ..draft.coupling
            });
        }
        Ok(())
    }

    fn actuators(&self, parts: &mut Parts) -> Result<(), ModelError> {
        for draft in &self.object.actuators {
            let what = format!("actuator \"{}\"", draft.actuator.name);
            let mut actuator = draft.actuator.clone();
            actuator.name = self.name(&actuator.name);
            actuator.joint = self.own_joint(&what, draft.joint)?;
            parts.actuators.push(actuator);
        }
        Ok(())
    }

    fn joint(&self, draft: &JointDraft) -> Result<Joint, ModelError> {
        let what = format!("joint \"{}\"", draft.joint.name);
        self.must_own(&what, "child body", draft.child.object)?;
        let mut joint = draft.joint.clone();
        joint.child = self.layout.body(&what, draft.child, self.k)?;
        let mut parent_pose = Pose::IDENTITY;
        if let Some(parent) = draft.parent {
            let k = self.other_replica(&what, "parent body", parent.object)?;
            joint.parent = Some(self.layout.body(&what, parent, k)?);
            parent_pose = self.layout.pose(parent, k);
        }
        match draft.frames {
            Frames::InObject(pose) => {
                let frame = self.placement() * pose;
                joint.parent_frame = parent_pose.inverse() * frame;
                joint.child_frame = self.layout.pose(draft.child, self.k).inverse() * frame;
            }
            Frames::InBodies if draft.parent.is_none() => {
                joint.parent_frame = self.placement() * joint.parent_frame;
            }
            Frames::InBodies => {}
        }
        joint.name = self.name(&joint.name);
        joint
            .dofs
            .iter_mut()
            .for_each(|dof| dof.name = self.name(&dof.name));
        Ok(joint)
    }

    /// Which replica of another object belongs to this one: the same, or the only one.
    fn other_replica(
        &self,
        what: &str,
        role: &'static str,
        other: ObjectId,
    ) -> Result<usize, ModelError> {
        let objects = self.layout.objects;
        let other = find(objects, other).ok_or_else(|| foreign(what, role))?;
        let (count, other_count) = (self.object.placements.len(), other.placements.len());
        match other_count {
            1 => Ok(0),
            n if n == count => Ok(self.k),
            _ => Err(ModelError::ReplicasDiffer {
                what: what.into(),
                role,
                count,
                other: other.name.clone(),
                other_count,
            }),
        }
    }

    fn own_joint(&self, what: &str, joint: JointHandle) -> Result<JointId, ModelError> {
        self.must_own(what, "joint", joint.object)?;
        self.layout.joint(what, joint, self.k)
    }

    fn must_own(&self, what: &str, role: &'static str, owner: ObjectId) -> Result<(), ModelError> {
        let Some(other) = find(self.layout.objects, owner) else {
            return Err(foreign(what, role));
        };
        if owner == self.object.id() {
            return Ok(());
        }
        let (object, other) = (self.object.name.clone(), other.name.clone());
        Err(ModelError::OtherObject {
            what: what.into(),
            role,
            object,
            other,
        })
    }

    fn shape(&self, shape: &Shape, body: Option<BodyId>, pose: Pose) -> Shape {
        let name = if shape.name.is_empty() {
            String::new()
        } else {
            self.name(&shape.name)
        };
        Shape {
            name,
            body,
            pose,
            ..shape.clone()
        }
    }

    fn name(&self, name: &str) -> String {
        let alone = self.object.placements.len() == 1;
        if alone || name.is_empty() {
            name.into()
        } else {
            format!("{name}_{}", self.k)
        }
    }

    fn placement(&self) -> Pose {
        self.object.placements[self.k]
    }
}
