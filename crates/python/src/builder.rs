//! Making models by hand: `Builder` → `Object` → `Body` and `Joint`.

use crate::error;
use crate::geometry::{AnyShape, pose};
use crate::joint::{Axis, Drive, Limit};
use crate::model::Model;
use glam::{DMat3, DVec3};
use kinetarium::model::{self, BodyHandle, JointDraft, JointHandle, ModelError, ObjectId, Pose};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Makes a `Model` by hand.
///
/// A world consists of objects, an object of bodies, joints and actuators that belong together; an object can be
/// replicated within the world, and each replica be placed by itself. `gravity` [m/s²] is 9.81 downwards unless
/// given; `up_axis` is "y" or "z"; `time_step` [s] is what is recommended; `worlds` is how many the model asks for.
///
/// >>> import kinetarium as kn
/// >>> world = kn.Builder("pendulum")
/// >>> arm = world.object("arm")
/// >>> rod = kn.Geometry.capsule(radius=0.02, half_height=0.5)
/// >>> link = arm.body("link", shapes=[rod], position=(0, -0.5, 0), mass=1.0)
/// >>> hinge = arm.revolute("hinge", link, axis=(0, 0, 1), initial=[0.3])
/// >>> arm.motor("motor", hinge, control_range=(-2, 2))
/// >>> world.build().dof_names
/// ['hinge']
#[pyclass(module = "kinetarium._engine")]
pub struct Builder {
    builder: model::Builder,
}

#[pymethods]
impl Builder {
    #[new]
    #[pyo3(signature = (name, *, up_axis="y", gravity=None, time_step=0.002, worlds=1))]
    fn new(
        name: &str,
        up_axis: &str,
        gravity: Option<[f64; 3]>,
        time_step: f64,
        worlds: usize,
    ) -> PyResult<Self> {
        let mut builder = model::Builder::new(name);
        builder.time_step(time_step).replicate(worlds);
        match up_axis {
            "y" => builder.up_axis(model::UpAxis::Y),
            "z" => builder.up_axis(model::UpAxis::Z),
            other => {
                let message = format!("unknown axis \"{other}\"; known are y, z");
                return Err(error::value(message));
            }
        };
        if let Some(gravity) = gravity {
            builder.gravity(DVec3::from_array(gravity));
        }
        Ok(Self { builder })
    }

    /// Adds an empty object.
    fn object(slf: &Bound<'_, Self>, name: &str) -> Object {
        let id = slf.borrow_mut().builder.object(name).id();
        Object {
            builder: slf.clone().unbind(),
            id,
        }
    }
    /// Adds a named state of the finished model: coordinates of all joints, their velocities, controls of the
    /// actuators.
    #[pyo3(signature = (name, joint_position, *, joint_velocity=None, control=Vec::new()))]
    fn keyframe(
        &mut self,
        name: &str,
        joint_position: Vec<f64>,
        joint_velocity: Option<Vec<f64>>,
        control: Vec<f64>,
    ) -> PyResult<()> {
        let at_rest = || Ok(vec![0.0; self.builder.build()?.degrees_of_freedom()]);
        let joint_velocity = joint_velocity.map_or_else(at_rest, Ok);
        self.builder.keyframe(model::Keyframe {
            name: name.to_owned(),
            joint_position,
            joint_velocity: joint_velocity.map_err(error::model)?,
            control,
        });
        Ok(())
    }
    /// Row of a body's k-th replica in the model that `build` makes.
    #[pyo3(signature = (body, replica=0))]
    fn body_row(&self, body: Body, replica: usize) -> PyResult<usize> {
        let row = self.builder.body_replica(body.0, replica);
        Ok(row.map_err(error::model)?.0)
    }
    /// Row of a joint's k-th replica in the model that `build` makes.
    #[pyo3(signature = (joint, replica=0))]
    fn joint_row(&self, joint: Joint, replica: usize) -> PyResult<usize> {
        let row = self.builder.joint_replica(joint.0, replica);
        Ok(row.map_err(error::model)?.0)
    }
    /// Compiles the world to a checked model. The builder can go on being used.
    ///
    /// Raises `ModelError` with the first fault found and its remedy.
    fn build(&self) -> PyResult<Model> {
        Ok(self.builder.build().map_err(error::model)?.into())
    }
}

/// A body of a builder.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, PartialEq)]
pub struct Body(BodyHandle);

/// A joint of a builder.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, PartialEq)]
pub struct Joint(JointHandle);

/// Bodies, joints and actuators that belong together; made by `Builder.object`.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Object {
    builder: Py<Builder>,
    id: ObjectId,
}

impl Object {
    fn with<R>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut model::Object) -> Result<R, PyErr>,
    ) -> PyResult<R> {
        let mut builder = self.builder.borrow_mut(py);
        change(builder.builder.object_mut(self.id).map_err(error::model)?)
    }
    fn joint(
        &self,
        py: Python<'_>,
        options: Option<&Bound<'_, PyDict>>,
        make: impl FnOnce(&mut model::Object) -> &mut JointDraft,
    ) -> PyResult<Joint> {
        self.with(py, |object| {
            let draft = make(object);
            let handle = draft.handle();
            if let Some(options) = options {
                shape_joint(draft, options)?;
            }
            Ok(Joint(handle))
        })
    }
}

/// The names of what a joint may be given, as in the type stubs' `JointOptions`.
const JOINT_OPTIONS: &str = "parent, position, orientation, parent_frame, child_frame, initial, limit, drive, \
     damping, stiffness, rest, armature, friction_loss, linear_compliance, angular_compliance, closes_loop, \
     bodies_collide, enabled";

type Frame = ([f64; 3], [f64; 4]);

/// Gives a joint what the keywords say.
fn shape_joint(draft: &mut JointDraft, options: &Bound<'_, PyDict>) -> PyResult<()> {
    let number = |name: &str, default: f64| match options.get_item(name)? {
        Some(x) => x.extract::<f64>(),
        None => Ok(default),
    };
    let (mut at, mut frames) = (None::<Pose>, [None::<Pose>; 2]);
    for (name, value) in options {
        let name: String = name.extract()?;
        match name.as_str() {
            "parent" => {
                if let Some(parent) = value.extract::<Option<Body>>()? {
                    draft.parent(parent.0);
                }
            }
            "position" => at.get_or_insert_default().position = DVec3::from_array(value.extract()?),
            "orientation" => {
                at.get_or_insert_default().orientation =
                    pose([0.0; 3], value.extract()?).orientation;
            }
            "parent_frame" | "child_frame" => {
                let (position, orientation): Frame = value.extract()?;
                frames[usize::from(name == "child_frame")] = Some(pose(position, orientation));
            }
            "initial" => {
                draft.initial(&value.extract::<Vec<f64>>().or_else(|e| {
                    let one = value.extract::<f64>().map_err(|_| e)?;
                    PyResult::Ok(vec![one])
                })?);
            }
            "limit" => {
                draft.limit(value.extract::<Limit>()?.0);
            }
            "drive" => {
                draft.drive(value.extract::<Drive>()?.0);
            }
            "damping" => {
                draft.damping(value.extract()?);
            }
            "stiffness" | "rest" => {
                draft.spring(number("stiffness", 0.0)?, number("rest", 0.0)?);
            }
            "armature" => {
                draft.armature(value.extract()?);
            }
            "friction_loss" => {
                draft.friction_loss(value.extract()?);
            }
            "linear_compliance" | "angular_compliance" => {
                let (linear, angular) = ("linear_compliance", "angular_compliance");
                draft.compliance(number(linear, 0.0)?, number(angular, 0.0)?);
            }
            "closes_loop" if value.extract()? => {
                draft.closes_loop();
            }
            "bodies_collide" if value.extract()? => {
                draft.bodies_collide();
            }
            "enabled" if !value.extract::<bool>()? => {
                draft.disabled();
            }
            "closes_loop" | "bodies_collide" | "enabled" => {}
            other => {
                let message =
                    format!("joints have no option \"{other}\"; known are {JOINT_OPTIONS}");
                return Err(error::raise("UnknownNameError", message));
            }
        }
    }
    match (at, frames) {
        (None, [None, None]) => {}
        (Some(at), [None, None]) => {
            draft.at(at);
        }
        (None, [parent, child]) => {
            draft.frames(parent.unwrap_or_default(), child.unwrap_or_default());
        }
        _ => {
            let message = "give a joint its frame in the object (position, orientation) or in both bodies \
                           (parent_frame, child_frame), not both";
            return Err(error::value(message.into()));
        }
    }
    Ok(())
}

#[pymethods]
impl Object {
    /// Adds a body.
    ///
    /// `position` [m] and `orientation` (x, y, z, w) are in the object. Mass [kg] and inertia follow from the shapes and
    /// their densities; `mass` alone scales them; `mass` with `inertia` [kg·m²] (3 × 3, about `center` [m], along the
    /// body's axes) replaces them. A `static` body never moves. Bodies of `group`s collide as the conventions say;
    /// `membership` and `collides_with` are given to all its shapes. `world` is the one world that it is in.
    #[pyo3(signature = (name, shapes=Vec::new(), *, position=[0.0; 3], orientation=[0.0, 0.0, 0.0, 1.0], mass=None,
        inertia=None, center=[0.0; 3], r#static=false, group=None, membership=None, collides_with=None, world=0))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn body(
        &self,
        py: Python<'_>,
        name: &str,
        shapes: Vec<AnyShape>,
        position: [f64; 3],
        orientation: [f64; 4],
        mass: Option<f64>,
        inertia: Option<[[f64; 3]; 3]>,
        center: [f64; 3],
        r#static: bool,
        group: Option<i32>,
        membership: Option<u32>,
        collides_with: Option<u32>,
        world: i32,
    ) -> PyResult<Body> {
        self.with(py, |object| {
            let draft = object.body(name);
            draft.at(pose(position, orientation)).world(world);
            for shape in shapes {
                draft.shape(shape);
            }
            match (mass, inertia) {
                (Some(mass), Some(inertia)) => {
                    let inertia = DMat3::from_cols_array_2d(&inertia).transpose();
                    draft.inertia(mass, DVec3::from_array(center), inertia);
                }
                (Some(mass), None) => {
                    draft.mass(mass);
                }
                (None, Some(_)) => {
                    let message = format!("body \"{name}\" has an inertia and no mass: give both");
                    return Err(error::value(message));
                }
                (None, None) => {}
            }
            if r#static {
                draft.immovable();
            }
            if let Some(group) = group {
                draft.group(group);
            }
            if membership.is_some() || collides_with.is_some() {
                draft.collision_masks(membership.unwrap_or(1), collides_with.unwrap_or(1));
            }
            Ok(Body(draft.handle()))
        })
    }
    /// Adds shapes that belong to the world, such as a floor.
    fn scenery(&self, py: Python<'_>, shape: AnyShape) -> PyResult<()> {
        self.with(py, |object| {
            object.scenery(shape);
            Ok(())
        })
    }

    /// Adds a joint without motion. What else joints may be given are keywords: see `JointOptions`.
    #[pyo3(signature = (name, child, **options))]
    fn fixed(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, options, |object| object.fixed(name, child.0))
    }
    /// Adds a hinge about an axis of its frame.
    #[pyo3(signature = (name, child, axis, **options))]
    fn revolute(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        axis: [f64; 3],
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axis = DVec3::from_array(axis);
        self.joint(py, options, |object| object.revolute(name, child.0, axis))
    }
    /// Adds a slide along an axis of its frame.
    #[pyo3(signature = (name, child, axis, **options))]
    fn prismatic(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        axis: [f64; 3],
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axis = DVec3::from_array(axis);
        self.joint(py, options, |object| object.prismatic(name, child.0, axis))
    }
    /// Adds a ball joint; its coordinates are a quaternion x, y, z, w.
    #[pyo3(signature = (name, child, **options))]
    fn ball(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, options, |object| object.ball(name, child.0))
    }
    /// Adds a joint that lets everything go; its coordinates are a position [m] and a quaternion.
    #[pyo3(signature = (name, child, **options))]
    fn free(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, options, |object| object.free(name, child.0))
    }
    /// Adds a joint that keeps the origins of its two frames `length` [m] apart.
    #[pyo3(signature = (name, child, length, **options))]
    fn distance(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        length: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, options, |object| object.distance(name, child.0, length))
    }
    /// Adds a joint of up to three linear and three angular axes, in turn.
    #[pyo3(signature = (name, child, axes, **options))]
    fn d6(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        axes: Vec<Axis>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axes: Vec<_> = axes.into_iter().map(|axis| axis.0).collect();
        self.joint(py, options, |object| object.d6(name, child.0, &axes))
    }
    /// Adds a joint that moves along x and z of its frame and turns about its y.
    #[pyo3(signature = (name, child, **options))]
    fn plane_xz(
        &self,
        py: Python<'_>,
        name: &str,
        child: Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, options, |object| object.plane_xz(name, child.0))
    }

    /// Lets two bodies pass through each other; without `other`, a body and the world.
    #[pyo3(signature = (body, other=None))]
    fn exclude(&self, py: Python<'_>, body: Body, other: Option<Body>) -> PyResult<()> {
        self.with(py, |object| {
            object.exclude(body.0, other.map(|b| b.0));
            Ok(())
        })
    }
    /// Ties two coordinates: q(joint) = offset + ratio · q(other); taken by `xpbd`.
    #[pyo3(signature = (name, joint, other, *, ratio=1.0, offset=0.0))]
    fn couple(
        &self,
        py: Python<'_>,
        name: &str,
        joint: Joint,
        other: Joint,
        ratio: f64,
        offset: f64,
    ) -> PyResult<()> {
        self.with(py, |object| {
            object.couple(name, joint.0, other.0, ratio, offset);
            Ok(())
        })
    }
    /// Adds a motor: its force is gear · control [N or N·m].
    #[pyo3(signature = (name, joint, *, gear=1.0, dof=0, control_range=None, force_range=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn motor(
        &self,
        py: Python<'_>,
        name: &str,
        joint: Joint,
        gear: f64,
        dof: usize,
        control_range: Option<(f64, f64)>,
        force_range: Option<(f64, f64)>,
    ) -> PyResult<()> {
        self.with(py, |object| {
            let draft = object.motor(name, joint.0);
            actuate(draft, gear, dof, control_range, force_range);
            Ok(())
        })
    }
    /// Adds a servo whose control is a position: stiffness · (control − q) − damping · q̇.
    #[pyo3(signature = (name, joint, *, stiffness, damping=0.0, gear=1.0, dof=0, control_range=None,
        force_range=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn position_servo(
        &self,
        py: Python<'_>,
        name: &str,
        joint: Joint,
        stiffness: f64,
        damping: f64,
        gear: f64,
        dof: usize,
        control_range: Option<(f64, f64)>,
        force_range: Option<(f64, f64)>,
    ) -> PyResult<()> {
        self.with(py, |object| {
            let draft = object.position_servo(name, joint.0, stiffness, damping);
            actuate(draft, gear, dof, control_range, force_range);
            Ok(())
        })
    }
    /// Adds a servo whose control is a velocity: damping · (control − q̇).
    #[pyo3(signature = (name, joint, *, damping, gear=1.0, dof=0, control_range=None, force_range=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn velocity_servo(
        &self,
        py: Python<'_>,
        name: &str,
        joint: Joint,
        damping: f64,
        gear: f64,
        dof: usize,
        control_range: Option<(f64, f64)>,
        force_range: Option<(f64, f64)>,
    ) -> PyResult<()> {
        self.with(py, |object| {
            let draft = object.velocity_servo(name, joint.0, damping);
            actuate(draft, gear, dof, control_range, force_range);
            Ok(())
        })
    }

    /// Asks for this many copies of the object within the world, each placed by `replica`.
    fn replicate(&self, py: Python<'_>, count: usize) -> PyResult<()> {
        self.with(py, |object| {
            object.replicate(count);
            Ok(())
        })
    }
    /// The k-th copy, to be moved.
    fn replica(&self, py: Python<'_>, k: usize) -> PyResult<Replica> {
        self.with(py, |object| {
            object.replica(k).map_err(error::model)?;
            Ok(())
        })?;
        Ok(Replica {
            builder: self.builder.clone_ref(py),
            object: self.id,
            k: Some(k),
        })
    }
    /// All copies, to be moved together.
    fn replicas(&self, py: Python<'_>) -> Replica {
        Replica {
            builder: self.builder.clone_ref(py),
            object: self.id,
            k: None,
        }
    }
}

fn actuate(
    draft: &mut model::ActuatorDraft,
    gear: f64,
    dof: usize,
    control_range: Option<(f64, f64)>,
    force_range: Option<(f64, f64)>,
) {
    draft.gear(gear).dof(dof);
    if let Some((lower, upper)) = control_range {
        draft.control_range(lower, upper);
    }
    if let Some((lower, upper)) = force_range {
        draft.force_range(lower, upper);
    }
}

/// One copy of an object, or all, to be moved within the world.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Replica {
    builder: Py<Builder>,
    object: ObjectId,
    k: Option<usize>,
}

impl Replica {
    fn place(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut model::Placement<'_>),
    ) -> PyResult<()> {
        let mut builder = self.builder.borrow_mut(py);
        let object = builder
            .builder
            .object_mut(self.object)
            .map_err(error::model)?;
        let mut placement = match self.k {
            Some(k) => object.replica(k).map_err(error::model)?,
            None => object.replicas(),
        };
        change(&mut placement);
        Ok(())
    }
}

/// A direction of any length but zero.
fn direction(axis: [f64; 3]) -> PyResult<DVec3> {
    let axis = DVec3::from_array(axis);
    if axis.length() > 1e-12 && axis.is_finite() {
        return Ok(axis);
    }
    let what = "placement".into();
    let quantity = "axis".into();
    Err(error::model(ModelError::ZeroLength {
        what,
        quantity,
        remedy: "give a direction",
    }))
}

#[pymethods]
impl Replica {
    /// Moves it by a shift [m].
    fn translate_by(&self, py: Python<'_>, shift: [f64; 3]) -> PyResult<()> {
        self.place(py, |p| {
            p.translate_by(DVec3::from_array(shift));
        })
    }
    /// Moves its origin to a point [m].
    fn translate_to(&self, py: Python<'_>, point: [f64; 3]) -> PyResult<()> {
        self.place(py, |p| {
            p.translate_to(DVec3::from_array(point));
        })
    }
    /// Moves it along a direction by a distance [m].
    fn move_on_axis_by(&self, py: Python<'_>, axis: [f64; 3], distance: f64) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.move_on_axis_by(axis, distance);
        })
    }
    /// Moves it along a direction until its origin is at a distance [m] along it.
    fn move_on_axis_to(&self, py: Python<'_>, axis: [f64; 3], distance: f64) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.move_on_axis_to(axis, distance);
        })
    }
    /// Turns it about an axis through a point [m] by an angle [rad].
    fn rotate_around_by(
        &self,
        py: Python<'_>,
        point: [f64; 3],
        axis: [f64; 3],
        angle: f64,
    ) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.rotate_around_by(DVec3::from_array(point), axis, angle);
        })
    }
    /// Turns it about an axis through a point [m] until it is turned by an angle [rad] about it.
    fn rotate_around_to(
        &self,
        py: Python<'_>,
        point: [f64; 3],
        axis: [f64; 3],
        angle: f64,
    ) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.rotate_around_to(DVec3::from_array(point), axis, angle);
        })
    }
}
