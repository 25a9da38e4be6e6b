//! Bodies, joints and actuators in the making.

use crate::body_options::BodyOptions;
use crate::builder::{Body, Builder, Joint};
use crate::count::natural;
use crate::error;
use crate::geometry::direction;
use crate::joint::Axis;
use crate::joint_options::JointOptions;
use crate::range;
use crate::replica::Replica;
use crate::shape::shape;
use crate::shape_handle::ShapeHandle;
use crate::vector::vector;
use kinetarium::model::{self, ActuatorDraft, JointDraft, ModelError, ObjectId};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Bodies, joints and actuators that belong together; made by `Builder.object`.
///
/// A call that is refused leaves everything as it was.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Object {
    builder: Py<Builder>,
    id: ObjectId,
}

/// How an actuator acts on a joint.
struct Transmission<'a, 'py> {
    gear: f64,
    dof: i64,
    control_range: Option<&'a Bound<'py, PyAny>>,
    force_range: Option<&'a Bound<'py, PyAny>>,
}

impl Object {
    pub fn new(builder: &Bound<'_, Builder>, id: ObjectId) -> Self {
        Self {
            builder: builder.clone().unbind(),
            id,
        }
    }
    fn with<R>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut model::Object) -> PyResult<R>,
    ) -> PyResult<R> {
        let mut builder = self.builder.borrow_mut(py);
        change(builder.builder.object_mut(self.id).map_err(error::model)?)
    }
    fn what(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("object {:?}", self.name(py)?))
    }
    /// Adds a joint with so many degrees of freedom.
    fn joint(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        dofs: usize,
        options: Option<&Bound<'_, PyDict>>,
        make: impl FnOnce(&mut model::Object) -> &mut JointDraft,
    ) -> PyResult<Joint> {
        let options = JointOptions::read(name, &vec![model::Dof::default(); dofs], options)?;
        let what = format!("joint {name:?}");
        let mut builder = self.builder.borrow_mut(py);
        builder.must_have_body(&what, "child body", child)?;
        builder.must_have_parent(&what, &options)?;
        let draft = make(builder.builder.object_mut(self.id).map_err(error::model)?);
        options.shape(draft);
        Ok(Joint::from(&*draft))
    }
    fn actuator(
        &self,
        py: Python<'_>,
        name: &str,
        joint: &Joint,
        transmission: &Transmission<'_, '_>,
        make: impl FnOnce(&mut model::Object) -> &mut ActuatorDraft,
    ) -> PyResult<()> {
        let what = format!("actuator {name:?}");
        let dof = natural(&what, "dof", transmission.dof)?;
        let ends = |name, given: Option<&Bound<'_, PyAny>>| {
            let given = given.map(|given| vector(&format!("{what}: {name}"), given));
            Ok::<_, PyErr>(given.transpose()?.and_then(range::in_model))
        };
        let controls = ends("control_range", transmission.control_range)?;
        let forces = ends("force_range", transmission.force_range)?;
        let mut builder = self.builder.borrow_mut(py);
        builder.must_have_joint(&what, "joint", joint)?;
        let draft = make(builder.builder.object_mut(self.id).map_err(error::model)?);
        draft.gear(transmission.gear).dof(dof);
        if let Some((lower, upper)) = controls {
            draft.control_range(lower, upper);
        }
        if let Some((lower, upper)) = forces {
            draft.force_range(lower, upper);
        }
        Ok(())
    }
}

#[pymethods]
impl Object {
    /// Its name.
    #[getter]
    fn name(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |object| Ok(object.name().to_owned()))
    }
    /// Its bodies, in the order of making.
    #[getter]
    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<Body>> {
        self.with(py, |object| {
            Ok(object.bodies().iter().map(Body::from).collect())
        })
    }
    /// Its joints, in the order of making.
    #[getter]
    fn joints(&self, py: Python<'_>) -> PyResult<Vec<Joint>> {
        self.with(py, |object| {
            Ok(object.joints().iter().map(Joint::from).collect())
        })
    }

    /// Adds a body of shapes, one or several.
    ///
    /// `position` [m] and `orientation` (x, y, z, w) are in the object. Mass [kg] and inertia follow from the shapes and
    /// their densities; `mass` alone scales them; `mass` with `inertia` [kg·m²] (3 × 3, about `center` [m], along the
    /// body's axes) replaces them. A `static` body never moves, and has no mass. Bodies of `group`s collide as the
    /// conventions say; `membership` and `collides_with` are given to all its shapes. `world` is a number from −1 on:
    /// bodies of different numbers, neither of them −1, do not touch, and no joint may tie them. It has nothing to do
    /// with the worlds of a simulation, each of which has all bodies.
    #[pyo3(signature = (name, shapes=None, **options), text_signature = "($self, name, shapes=None, *, \
        position=(0, 0, 0), orientation=(0, 0, 0, 1), mass=None, inertia=None, center=None, static=False, group=None, \
        membership=None, collides_with=None, world=0)")]
    fn body(
        &self,
        py: Python<'_>,
        name: &str,
        shapes: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Body> {
        let options = BodyOptions::read(name, shapes, options, None)?;
        self.with(py, |object| {
            let draft = object.body(name);
            options.shape(draft);
            Ok(Body::from(&*draft))
        })
    }
    /// Adds a shape that belongs to the world, such as a floor.
    fn scenery(&self, py: Python<'_>, shape: &Bound<'_, PyAny>) -> PyResult<ShapeHandle> {
        let shape = self::shape(shape, "scenery")?;
        let owner = self.what(py)?;
        self.with(py, |object| {
            let number = object.scenery(shape).scenery_shapes().len() - 1;
            Ok(ShapeHandle {
                handle: object.id().scenery(number),
                owner,
                number,
            })
        })
    }

    /// Adds a joint without motion. What else joints may be given are keywords: see `JointOptions`.
    #[pyo3(signature = (name, child, **options))]
    fn fixed(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, name, child, 0, options, |object| {
            object.fixed(name, child.handle)
        })
    }
    /// Adds a hinge about an axis of its frame, of any length but zero.
    #[pyo3(signature = (name, child, axis, **options))]
    fn revolute(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        axis: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axis = direction(vector(&format!("joint {name:?}: axis"), axis)?);
        self.joint(py, name, child, 1, options, |object| {
            object.revolute(name, child.handle, axis)
        })
    }
    /// Adds a slide along an axis of its frame, of any length but zero.
    #[pyo3(signature = (name, child, axis, **options))]
    fn prismatic(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        axis: &Bound<'_, PyAny>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axis = direction(vector(&format!("joint {name:?}: axis"), axis)?);
        self.joint(py, name, child, 1, options, |object| {
            object.prismatic(name, child.handle, axis)
        })
    }
    /// Adds a ball joint; its coordinates are a quaternion x, y, z, w. It has three degrees of freedom.
    #[pyo3(signature = (name, child, **options))]
    fn ball(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, name, child, 3, options, |object| {
            object.ball(name, child.handle)
        })
    }
    /// Adds a joint that lets everything go; its coordinates are a position [m] and a quaternion. It has six degrees of
    /// freedom: three along, three about.
    #[pyo3(signature = (name, child, **options))]
    fn free(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, name, child, 6, options, |object| {
            object.free(name, child.handle)
        })
    }
    /// Adds a joint that keeps the origins of its two frames `length` [m] apart.
    #[pyo3(signature = (name, child, length, **options))]
    fn distance(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        length: f64,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, name, child, 0, options, |object| {
            object.distance(name, child.handle, length)
        })
    }
    /// Adds a joint of up to three linear and three angular axes, in turn, each of which is a degree of freedom.
    #[pyo3(signature = (name, child, axes, **options))]
    fn d6(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        axes: Vec<Axis>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        let axes: Vec<_> = axes.into_iter().map(|axis| axis.0).collect();
        self.joint(py, name, child, axes.len(), options, |object| {
            object.d6(name, child.handle, &axes)
        })
    }
    /// Adds a joint that moves along x and z of its frame and turns about its y: three degrees of freedom.
    #[pyo3(signature = (name, child, **options))]
    fn plane_xz(
        &self,
        py: Python<'_>,
        name: &str,
        child: &Body,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Joint> {
        self.joint(py, name, child, 3, options, |object| {
            object.plane_xz(name, child.handle)
        })
    }

    /// Lets two bodies pass through each other; without `other`, a body and the world.
    #[pyo3(signature = (body, other=None))]
    fn exclude(&self, py: Python<'_>, body: &Body, other: Option<&Body>) -> PyResult<()> {
        let what = format!("exclusion in {}", self.what(py)?);
        let mut builder = self.builder.borrow_mut(py);
        builder.must_have_body(&what, "first body", body)?;
        if let Some(other) = other {
            builder.must_have_body(&what, "second body", other)?;
        }
        if other.is_some_and(|other| other.handle == body.handle) {
            let body = body.name.clone();
            return Err(error::model(ModelError::ExcludedFromItself { what, body }));
        }
        let object = builder.builder.object_mut(self.id).map_err(error::model)?;
        object.exclude(body.handle, other.map(|b| b.handle));
        Ok(())
    }
    /// Ties two coordinates: q(joint) = offset + ratio · q(other); taken by `featherstone` and `xpbd`.
    #[pyo3(signature = (name, joint, other, *, ratio=1.0, offset=0.0))]
    fn couple(
        &self,
        py: Python<'_>,
        name: &str,
        joint: &Joint,
        other: &Joint,
        ratio: f64,
        offset: f64,
    ) -> PyResult<()> {
        let what = format!("coupling {name:?}");
        let mut builder = self.builder.borrow_mut(py);
        builder.must_have_joint(&what, "joint", joint)?;
        builder.must_have_joint(&what, "joint", other)?;
        let object = builder.builder.object_mut(self.id).map_err(error::model)?;
        object.couple(name, joint.handle, other.handle, ratio, offset);
        Ok(())
    }
    /// Adds a motor: its force is gear · control [N or N·m]. An end of a range that is infinite is none.
    #[pyo3(signature = (name, joint, *, gear=1.0, dof=0, control_range=None, force_range=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn motor(
        &self,
        py: Python<'_>,
        name: &str,
        joint: &Joint,
        gear: f64,
        dof: i64,
        control_range: Option<&Bound<'_, PyAny>>,
        force_range: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let transmission = Transmission {
            gear,
            dof,
            control_range,
            force_range,
        };
        self.actuator(py, name, joint, &transmission, |object| {
            object.motor(name, joint.handle)
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
        joint: &Joint,
        stiffness: f64,
        damping: f64,
        gear: f64,
        dof: i64,
        control_range: Option<&Bound<'_, PyAny>>,
        force_range: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let pulls = [("stiffness", stiffness), ("damping", damping)];
        error::negative(&format!("actuator {name:?}"), pulls)?;
        let transmission = Transmission {
            gear,
            dof,
            control_range,
            force_range,
        };
        self.actuator(py, name, joint, &transmission, |object| {
            object.position_servo(name, joint.handle, stiffness, damping)
        })
    }
    /// Adds a servo whose control is a velocity: damping · (control − q̇).
    #[pyo3(signature = (name, joint, *, damping, gear=1.0, dof=0, control_range=None, force_range=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn velocity_servo(
        &self,
        py: Python<'_>,
        name: &str,
        joint: &Joint,
        damping: f64,
        gear: f64,
        dof: i64,
        control_range: Option<&Bound<'_, PyAny>>,
        force_range: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        error::negative(&format!("actuator {name:?}"), [("damping", damping)])?;
        let transmission = Transmission {
            gear,
            dof,
            control_range,
            force_range,
        };
        self.actuator(py, name, joint, &transmission, |object| {
            object.velocity_servo(name, joint.handle, damping)
        })
    }

    /// Asks for this many copies of the object within the world, each placed by `replica`.
    fn replicate(&self, py: Python<'_>, count: i64) -> PyResult<()> {
        let count = natural(&self.what(py)?, "count", count)?;
        self.with(py, |object| {
            object.replicate(count);
            Ok(())
        })
    }
    /// The k-th copy, to be moved.
    fn replica(&self, py: Python<'_>, k: i64) -> PyResult<Replica> {
        let k = natural(&self.what(py)?, "replica", k)?;
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

    fn __copy__(&self, py: Python<'_>) -> Self {
        Self {
            builder: self.builder.clone_ref(py),
            id: self.id,
        }
    }
    /// In a copy of its builder, which is the same for all that are copied together.
    fn __deepcopy__(&self, py: Python<'_>, memo: &Bound<'_, PyDict>) -> PyResult<Self> {
        let deepcopy = py.import("copy")?.getattr("deepcopy")?;
        let builder = deepcopy.call1((&self.builder, memo))?;
        Ok(Self::new(builder.cast::<Builder>()?, self.id))
    }
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |object| {
            Ok(format!(
                "<Object {:?}: {} bodies, {} joints, {} replicas>",
                object.name(),
                object.bodies().len(),
                object.joints().len(),
                object.replica_count()
            ))
        })
    }
}
