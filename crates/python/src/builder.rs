//! Making models by hand: `Builder` → `Object` → `Body` and `Joint`.

use crate::body_options::BodyOptions;
use crate::count::natural;
use crate::error;
use crate::joint_options::JointOptions;
use crate::material::{Material, Softness};
use crate::model::{Model, UP_AXES};
use crate::names::{find, name_of};
use crate::object::Object;
use crate::shape_handle::ShapeHandle;
use crate::vector::vector;
use glam::DVec3;
use kinetarium::model::{self, BodyDraft, BodyHandle, JointDraft, JointHandle, ModelError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Makes a `Model` by hand.
///
/// A world consists of objects, an object of bodies, joints and actuators that belong together; an object can be
/// replicated within the world, and each replica be placed by itself. `gravity` [m/s²] is 9.81 downwards unless
/// given; `up_axis` is "y" or "z"; `time_step` [s] is what is recommended; `worlds` is how many the model asks for. All
/// four can be set later, too.
///
/// `copy.copy` and `copy.deepcopy` make a builder that goes its own way, and takes the bodies and joints that were made
/// before; objects that are copied deeply together with their builder belong to the copy.
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
    pub builder: model::Builder,
}

impl Builder {
    /// Only a body that this builder made will do.
    pub fn must_have_body(&mut self, what: &str, role: &'static str, body: &Body) -> PyResult<()> {
        let found = self.builder.body_mut(body.handle).map(drop);
        found.map_err(|_| foreign(what, role))
    }
    /// Only a parent that this builder made will do.
    pub fn must_have_parent(&mut self, joint: &str, options: &JointOptions) -> PyResult<()> {
        match &options.parent {
            Some(parent) => self.must_have_body(joint, "parent body", parent),
            None => Ok(()),
        }
    }
    /// Only a joint that this builder made will do.
    pub fn must_have_joint(
        &mut self,
        what: &str,
        role: &'static str,
        joint: &Joint,
    ) -> PyResult<()> {
        let found = self.builder.joint_mut(joint.handle).map(drop);
        found.map_err(|_| foreign(what, role))
    }
}

fn foreign(what: &str, role: &'static str) -> PyErr {
    error::model(ModelError::ForeignHandle {
        what: what.into(),
        role,
    })
}

#[pymethods]
impl Builder {
    #[new]
    #[pyo3(signature = (name, *, up_axis="y", gravity=None, time_step=0.002, worlds=1))]
    fn new(
        name: &str,
        up_axis: &str,
        gravity: Option<&Bound<'_, PyAny>>,
        time_step: f64,
        worlds: i64,
    ) -> PyResult<Self> {
        let mut builder = model::Builder::new(name);
        builder
            .time_step(time_step)
            .replicate(natural("builder", "worlds", worlds)?)
            .up_axis(find(&UP_AXES, "axis", up_axis)?);
        if let Some(gravity) = gravity {
            let what = format!("builder {name:?}: gravity");
            builder.gravity(DVec3::from_array(vector(&what, gravity)?));
        }
        Ok(Self { builder })
    }

    /// Name of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.builder.settings().name
    }
    /// The direction that is up: "y" or "z". Setting it turns gravity to point down.
    #[getter]
    fn up_axis(&self) -> &'static str {
        name_of(&UP_AXES, &self.builder.settings().up_axis)
    }
    #[setter]
    fn set_up_axis(&mut self, up_axis: &str) -> PyResult<()> {
        self.builder.up_axis(find(&UP_AXES, "axis", up_axis)?);
        Ok(())
    }
    /// Gravity [m/s²].
    #[getter]
    fn gravity(&self) -> (f64, f64, f64) {
        self.builder.settings().gravity.into()
    }
    #[setter]
    fn set_gravity(&mut self, gravity: &Bound<'_, PyAny>) -> PyResult<()> {
        let what = format!("builder {:?}: gravity", self.name());
        self.builder
            .gravity(DVec3::from_array(vector(&what, gravity)?));
        Ok(())
    }
    /// Recommended time step [s].
    #[getter]
    fn time_step(&self) -> f64 {
        self.builder.settings().time_step
    }
    #[setter]
    fn set_time_step(&mut self, time_step: f64) {
        self.builder.time_step(time_step);
    }
    /// Number of worlds that the model asks for.
    #[getter]
    fn worlds(&self) -> usize {
        self.builder.settings().worlds
    }
    #[setter]
    fn set_worlds(&mut self, worlds: i64) -> PyResult<()> {
        self.builder
            .replicate(natural("builder", "worlds", worlds)?);
        Ok(())
    }
    /// The objects, in the order of making.
    #[getter]
    fn objects(slf: &Bound<'_, Self>) -> Vec<Object> {
        let this = slf.borrow();
        let ids = this.builder.objects().iter().map(model::Object::id);
        ids.map(|id| Object::new(slf, id)).collect()
    }

    /// Adds an empty object.
    fn object(slf: &Bound<'_, Self>, name: &str) -> Object {
        let id = slf.borrow_mut().builder.object(name).id();
        Object::new(slf, id)
    }
    /// Changes a body that was made before: `shapes`, one or several, are added to those that it has; of the rest, the
    /// keywords of `Object.body`, what is not given stays. A body can be made `static`, and stays so.
    #[pyo3(signature = (body, shapes=None, **options))]
    fn change_body(
        &mut self,
        body: &Body,
        shapes: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let what = format!("body {:?}", body.name);
        self.must_have_body(&what, "body", body)?;
        let draft = self.builder.body_mut(body.handle).map_err(error::model)?;
        BodyOptions::read(&body.name, shapes, options, Some(&*draft))?.shape(draft);
        Ok(())
    }
    /// Changes a joint that was made before: of the keywords that all joints take, what is not given stays; a `limit`
    /// of `None` takes away what limits there are. See `JointOptions`.
    #[pyo3(signature = (joint, **options))]
    fn change_joint(&mut self, joint: &Joint, options: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let what = format!("joint {:?}", joint.name);
        self.must_have_joint(&what, "joint", joint)?;
        let draft = self.builder.joint_mut(joint.handle).map_err(error::model)?;
        let options = JointOptions::read(&joint.name, draft.dofs(), options)?;
        self.must_have_parent(&what, &options)?;
        let draft = self.builder.joint_mut(joint.handle).map_err(error::model)?;
        options.shape(draft);
        Ok(())
    }
    /// Adds a named state of the finished model: coordinates of all joints, their velocities, controls of the
    /// actuators; without `joint_velocity`, at rest as the world is now.
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
    /// Has two shapes touch in any case, whatever masks, groups, joints and exclusions say, with a surface of their own:
    /// `material`, or else what their materials make of each other now; and of that surface what else is given. Where
    /// `friction` is given, what sticks has it too, unless `static_friction` is.
    ///
    /// Each replica of the one is paired with its own replica of the other; one of another object may also stand there
    /// only once.
    ///
    /// >>> import kinetarium as kn
    /// >>> world = kn.Builder("curling")
    /// >>> ice = world.object("rink").scenery(kn.Geometry.plane())
    /// >>> stone = world.object("stones").body("stone", kn.Geometry.cylinder(0.145, 0.06), mass=19.0)
    /// >>> world.contact_pair(stone.shape(), ice, friction=0.01)
    #[pyo3(signature = (a, b, material=None, *, friction=None, static_friction=None, torsional_friction=None,
        rolling_friction=None, restitution=None, softness=None, margin=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn contact_pair(
        &mut self,
        a: ShapeHandle,
        b: ShapeHandle,
        material: Option<Material>,
        friction: Option<f64>,
        static_friction: Option<f64>,
        torsional_friction: Option<f64>,
        rolling_friction: Option<f64>,
        restitution: Option<f64>,
        softness: Option<Softness>,
        margin: Option<f64>,
    ) -> PyResult<()> {
        let pair = self.builder.contact_pair(a.handle, b.handle);
        let pair = pair.map_err(error::model)?;
        let given = material.map_or(pair.surface(), |material| material.0);
        pair.material(model::Material {
            friction: friction.unwrap_or(given.friction),
            static_friction: match friction {
                Some(_) => static_friction,
                None => static_friction.or(given.static_friction),
            },
            torsional_friction: torsional_friction.unwrap_or(given.torsional_friction),
            rolling_friction: rolling_friction.unwrap_or(given.rolling_friction),
            restitution: restitution.unwrap_or(given.restitution),
            softness: softness.map_or(given.softness, |softness| softness.0),
            margin: margin.unwrap_or(given.margin),
            ..given
        });
        Ok(())
    }
    /// Row of a body's k-th replica in the model that `build` makes.
    #[pyo3(signature = (body, replica=0))]
    fn body_row(&self, body: &Body, replica: i64) -> PyResult<usize> {
        let replica = natural(&format!("body {:?}", body.name), "replica", replica)?;
        let row = self.builder.body_replica(body.handle, replica);
        Ok(row.map_err(error::model)?.0)
    }
    /// Row of a joint's k-th replica in the model that `build` makes.
    #[pyo3(signature = (joint, replica=0))]
    fn joint_row(&self, joint: &Joint, replica: i64) -> PyResult<usize> {
        let replica = natural(&format!("joint {:?}", joint.name), "replica", replica)?;
        let row = self.builder.joint_replica(joint.handle, replica);
        Ok(row.map_err(error::model)?.0)
    }
    /// Row of a shape's k-th replica in the model that `build` makes.
    #[pyo3(signature = (shape, replica=0))]
    fn shape_row(&self, shape: &ShapeHandle, replica: i64) -> PyResult<usize> {
        let what = format!("shape {} of {}", shape.number, shape.owner);
        let replica = natural(&what, "replica", replica)?;
        let row = self.builder.shape_replica(shape.handle, replica);
        Ok(row.map_err(error::model)?.0)
    }
    /// Compiles the world to a checked model. The builder can go on being used.
    ///
    /// Raises `ModelError` with the first fault found and its remedy.
    fn build(&self) -> PyResult<Model> {
        Ok(self.builder.build().map_err(error::model)?.into())
    }
    fn __copy__(&self) -> Self {
        let builder = self.builder.clone();
        Self { builder }
    }
    fn __deepcopy__(&self, _memo: &Bound<'_, PyDict>) -> Self {
        self.__copy__()
    }
    fn __repr__(&self) -> String {
        let objects = self.builder.objects();
        let bodies: usize = objects.iter().map(|o| o.bodies().len()).sum();
        let joints: usize = objects.iter().map(|o| o.joints().len()).sum();
        let (name, objects) = (self.name(), objects.len());
        format!("<Builder {name:?}: {objects} objects, {bodies} bodies, {joints} joints>")
    }
}

/// A body of a builder, in all replicas of its object.
#[pyclass(frozen, eq, hash, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Body {
    pub handle: BodyHandle,
    /// Its name.
    #[pyo3(get)]
    pub name: String,
}

impl From<&BodyDraft> for Body {
    fn from(draft: &BodyDraft) -> Self {
        Self {
            handle: draft.handle(),
            name: draft.name().to_owned(),
        }
    }
}

#[pymethods]
impl Body {
    /// Its shape of this number, in the order of adding.
    #[pyo3(signature = (number=0))]
    fn shape(&self, number: i64) -> PyResult<ShapeHandle> {
        let owner = format!("body {:?}", self.name);
        let number = natural(&owner, "shape", number)?;
        Ok(ShapeHandle {
            handle: self.handle.shape(number),
            owner,
            number,
        })
    }
    fn __copy__(&self) -> Self {
        self.clone()
    }
    fn __deepcopy__(&self, _memo: &Bound<'_, PyDict>) -> Self {
        self.clone()
    }
    fn __repr__(&self) -> String {
        format!("<Body {:?}>", self.name)
    }
}

/// A joint of a builder, in all replicas of its object.
#[pyclass(frozen, eq, hash, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Joint {
    pub handle: JointHandle,
    /// Its name.
    #[pyo3(get)]
    pub name: String,
}

impl From<&JointDraft> for Joint {
    fn from(draft: &JointDraft) -> Self {
        Self {
            handle: draft.handle(),
            name: draft.name().to_owned(),
        }
    }
}

#[pymethods]
impl Joint {
    fn __copy__(&self) -> Self {
        self.clone()
    }
    fn __deepcopy__(&self, _memo: &Bound<'_, PyDict>) -> Self {
        self.clone()
    }
    fn __repr__(&self) -> String {
        format!("<Joint {:?}>", self.name)
    }
}
