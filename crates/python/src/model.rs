//! Models, made by files or builders.

use crate::camera::MODES;
use crate::error;
use crate::joint::Drive;
use crate::names::{Table, find, name_of};
use crate::pickled::{Reduced, reduce, restored};
use crate::range;
use kinetarium::formats::{self, Files, InMemory, Loaded, Meshes, Options};
use kinetarium::model::{self, BodyId, JointId, ModelError, hint};
use kinetarium::sim::Parameter;
use numpy::{PyArray1, PyArray2, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use render::{Device, RenderError, Renderer, Scene};
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// A checked, immutable model of one world, shared by all worlds of a simulation.
///
/// Made by `load`, `parse` or a `Builder`. Names index its tables: `model.body("torso")` is a row of
/// `model.body_names`.
#[pyclass(frozen, eq, module = "kinetarium._engine")]
pub struct Model {
    pub model: Arc<model::Model>,
    warnings: Vec<String>,
    /// What draws it, made when it is first asked for: one for each device.
    renderers: Mutex<Vec<(Device, Renderer)>>,
}

impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        self.model == other.model && self.warnings == other.warnings
    }
}

impl Model {
    fn new(model: Arc<model::Model>, warnings: Vec<String>) -> Self {
        Self {
            model,
            warnings,
            renderers: Mutex::default(),
        }
    }

    /// Joints that are to have drives, by name.
    fn driven(&self, names: &[String]) -> PyResult<Vec<JointId>> {
        let joint = |name: &String| {
            let joint = self.model.joint(name).map_err(error::model)?;
            if self.model.joints[joint.0].dofs.is_empty() {
                let why = "it has no degree of freedom that a drive could pull; leave it out";
                return Err(error::value(format!("joint {name:?}: {why}")));
            }
            Ok(joint)
        };
        names.iter().map(joint).collect()
    }

    /// What draws it on a device. The files of meshes are read once, and their trees of boxes built.
    pub fn renderer(&self, device: &Device) -> Result<Renderer, RenderError> {
        let mut known = self
            .renderers
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some((_, renderer)) = known.iter().find(|(other, _)| other == device) {
            return Ok(renderer.clone());
        }
        let scene = match known.first() {
            Some((_, renderer)) => renderer.scene().clone(),
            None => Scene::new(&self.model)?,
        };
        let renderer = Renderer::new(scene, device)?;
        known.push((device.clone(), renderer.clone()));
        Ok(renderer)
    }
}

impl From<model::Model> for Model {
    fn from(model: model::Model) -> Self {
        Self::new(Arc::new(model), Vec::new())
    }
}

impl From<Loaded> for Model {
    fn from(loaded: Loaded) -> Self {
        let warnings = loaded.warnings.iter().map(ToString::to_string).collect();
        Self::new(Arc::new(loaded.model), warnings)
    }
}

/// Name, rate, noise, cutoff.
type Described = (String, Option<f64>, f64, Option<f64>);

/// What becomes of meshes that collide.
const MESHES: Table<Meshes, 4> = [
    ("named", Meshes::Named),
    ("exact", Meshes::Exact),
    ("hull", Meshes::ConvexHull),
    ("pieces", Meshes::Pieces),
];

fn options(lenient: bool, meshes: &str, floating_base: bool) -> PyResult<Options> {
    let meshes = find(&MESHES, "treatment of meshes", meshes)?;
    Ok(Options {
        lenient,
        meshes,
        floating_base,
    })
}

/// Reads a robot file: MJCF (`<mujoco>`) or URDF (`<robot>`).
///
/// `meshes`: what becomes of meshes that collide: "named" (refused by the solvers), "exact" (as they are),
/// "hull" (their convex hulls) or "pieces" (convex pieces, nearly what they are). `lenient`: what is not supported and would change the motion is left out
/// with a warning instead of an error. `floating_base`: the root link of a URDF floats. What was left out is in
/// `Model.warnings`.
///
/// Raises `FileError` with file and line.
#[pyfunction]
#[pyo3(signature = (path, *, meshes="named", lenient=false, floating_base=false))]
pub fn load(path: PathBuf, meshes: &str, lenient: bool, floating_base: bool) -> PyResult<Model> {
    let options = options(lenient, meshes, floating_base)?;
    Ok(formats::load(&path, &options).map_err(error::file)?.into())
}

/// Reads a text as `load` reads a file; `files` are the texts of those that it includes, by their names.
#[pyfunction]
#[pyo3(signature = (text, *, files=HashMap::new(), meshes="named", lenient=false, floating_base=false))]
pub fn parse(
    text: &str,
    files: HashMap<String, String>,
    meshes: &str,
    lenient: bool,
    floating_base: bool,
) -> PyResult<Model> {
    let options = options(lenient, meshes, floating_base)?;
    let files = InMemory::new(files);
    let files: &dyn Files = &files;
    let loaded = formats::parse(text, "text", files, &options).map_err(error::file)?;
    Ok(loaded.into())
}

/// Numbers of a model that can be other ones in each world.
const PARAMETERS: Table<Parameter, 17> = [
    ("gravity", Parameter::Gravity),
    ("body_mass", Parameter::BodyMass),
    ("body_center", Parameter::BodyCenter),
    ("body_inertia", Parameter::BodyInertia),
    ("armature", Parameter::Armature),
    ("damping", Parameter::Damping),
    ("stiffness", Parameter::Stiffness),
    ("rest", Parameter::Rest),
    ("friction_loss", Parameter::FrictionLoss),
    ("drive_stiffness", Parameter::DriveStiffness),
    ("drive_damping", Parameter::DriveDamping),
    ("effort_limit", Parameter::EffortLimit),
    ("friction", Parameter::Friction),
    ("restitution", Parameter::Restitution),
    ("gear", Parameter::Gear),
    ("gain", Parameter::Gain),
    ("bias", Parameter::Bias),
];

/// A parameter by its name.
pub fn parameter(name: &str) -> PyResult<Parameter> {
    find(&PARAMETERS, "parameter", name)
}

/// Directions that are up.
pub const UP_AXES: Table<model::UpAxis, 2> = [("y", model::UpAxis::Y), ("z", model::UpAxis::Z)];

fn names<'a>(names: impl Iterator<Item = &'a String>) -> Vec<String> {
    names.cloned().collect()
}

#[pymethods]
impl Model {
    /// Name of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }
    /// What of its file was left out, each with its line.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
    /// Recommended time step [s].
    #[getter]
    fn time_step(&self) -> f64 {
        self.model.time_step
    }
    /// The direction that is up: "y" or "z".
    #[getter]
    fn up_axis(&self) -> &'static str {
        name_of(&UP_AXES, &self.model.up_axis)
    }
    /// Number of worlds that the model asks for.
    #[getter]
    fn worlds(&self) -> usize {
        self.model.worlds
    }
    /// Number of joint coordinates: columns of `state.joint_position`.
    #[getter]
    fn coordinates(&self) -> usize {
        self.model.coordinates()
    }
    /// Number of degrees of freedom: columns of `state.joint_velocity` and `controls.force`.
    #[getter]
    fn degrees_of_freedom(&self) -> usize {
        self.model.degrees_of_freedom()
    }
    /// Mass of everything that moves [kg].
    #[getter]
    fn total_mass(&self) -> f64 {
        self.model.total_mass()
    }
    /// Names of the bodies.
    #[getter]
    fn body_names(&self) -> Vec<String> {
        names(self.model.bodies.iter().map(|b| &b.name))
    }
    /// Names of the joints.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        names(self.model.joints.iter().map(|j| &j.name))
    }
    /// Kinds of the joints, such as "revolute".
    #[getter]
    fn joint_kinds(&self) -> Vec<&'static str> {
        self.model.joints.iter().map(|j| j.kind.name()).collect()
    }
    /// Names of the shapes; some may be empty.
    #[getter]
    fn shape_names(&self) -> Vec<String> {
        names(self.model.shapes.iter().map(|s| &s.name))
    }
    /// The body of each shape, −1 for the world's.
    #[getter]
    fn shape_bodies(&self) -> Vec<i64> {
        let shapes = self.model.shapes.iter();
        shapes.map(|s| s.body.map_or(-1, |b| b.0 as i64)).collect()
    }
    /// Names of the degrees of freedom.
    #[getter]
    fn dof_names(&self) -> Vec<String> {
        self.model.dof_names().map(str::to_owned).collect()
    }
    /// Names of the joint coordinates.
    #[getter]
    fn coordinate_names(&self) -> Vec<String> {
        self.model.coordinate_names()
    }
    /// Names of the actuators.
    #[getter]
    fn actuator_names(&self) -> Vec<String> {
        names(self.model.actuators.iter().map(|a| &a.name))
    }
    /// Of each sensor that the file describes: name, samples a second (none: at every step), standard deviation of
    /// its noise, and cutoff, if any. `kinetarium.sensors.from_model` makes sensors of them.
    #[getter]
    fn sensors(&self) -> Vec<Described> {
        let sensors = self.model.sensors.iter();
        sensors
            .map(|s| (s.name.clone(), s.rate, s.noise, s.cutoff))
            .collect()
    }
    /// Names of the keyframes.
    #[getter]
    fn keyframe_names(&self) -> Vec<String> {
        names(self.model.keyframes.iter().map(|k| &k.name))
    }
    /// Names of the cameras.
    #[getter]
    fn camera_names(&self) -> Vec<String> {
        names(self.model.cameras.iter().map(|c| &c.name))
    }

    /// Row of a body. Raises `UnknownNameError`, as all that look up names do.
    fn body(&self, name: &str) -> PyResult<usize> {
        Ok(self.model.body(name).map_err(error::model)?.0)
    }
    /// Row of a joint.
    fn joint(&self, name: &str) -> PyResult<usize> {
        Ok(self.model.joint(name).map_err(error::model)?.0)
    }
    /// Row of a shape; of several of that name, of the first.
    fn shape(&self, name: &str) -> PyResult<usize> {
        let names = self.model.shapes.iter().map(|shape| shape.name.as_str());
        let row = names.clone().position(|own| own == name && !own.is_empty());
        row.ok_or_else(|| {
            let known = Vec::from_iter(names.filter(|own| !own.is_empty()));
            error::model(ModelError::UnknownName {
                kind: "shape",
                name: name.to_owned(),
                hint: hint(name, &known),
            })
        })
    }
    /// Row of a degree of freedom.
    fn dof(&self, name: &str) -> PyResult<usize> {
        self.model.dof(name).map_err(error::model)
    }
    /// Row of an actuator.
    fn actuator(&self, name: &str) -> PyResult<usize> {
        self.model.actuator(name).map_err(error::model)
    }
    /// The coordinates of a joint: columns of `state.joint_position`.
    fn joint_coordinates(&self, name: &str) -> PyResult<(usize, usize)> {
        let range = self
            .model
            .coordinate_range(self.model.joint(name).map_err(error::model)?);
        Ok((range.start, range.end))
    }
    /// The degrees of freedom of a joint: columns of `state.joint_velocity`.
    fn joint_dofs(&self, name: &str) -> PyResult<(usize, usize)> {
        let range = self
            .model
            .dof_range(self.model.joint(name).map_err(error::model)?);
        Ok((range.start, range.end))
    }
    /// A named state: joint coordinates, joint velocities, actuator controls.
    #[expect(clippy::type_complexity, reason = "three arrays")]
    fn keyframe<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray1<f64>>,
    )> {
        let k = self.model.keyframe(name).map_err(error::model)?;
        let [position, velocity, control] =
            [&k.joint_position, &k.joint_velocity, &k.control].map(|x| x.to_pyarray(py));
        Ok((position, velocity, control))
    }
    /// A camera: what `kinetarium.Camera` takes, by name.
    fn camera<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyDict>> {
        let camera = self.model.camera(name).map_err(error::model)?;
        let body = camera.body.map(|body| &self.model.bodies[body.0].name);
        let fields = PyDict::new(py);
        fields.set_item("body", body)?;
        fields.set_item("mode", name_of(&MODES, &camera.mode))?;
        fields.set_item("position", camera.pose.position.to_array())?;
        fields.set_item("orientation", camera.pose.orientation.to_array())?;
        fields.set_item("field_of_view", camera.field_of_view)?;
        if let Some([width, height]) = camera.size {
            fields.set_item("width", width)?;
            fields.set_item("height", height)?;
        }
        Ok(fields)
    }
    /// The parent body of each body's joint, −1 for the world and for bodies that do not move.
    #[getter]
    fn body_parents(&self) -> Vec<i64> {
        let parent = |body| {
            let JointId(joint) = self.model.carrier(body)?;
            self.model.joints[joint].parent
        };
        let bodies = (0..self.model.bodies.len()).map(BodyId);
        bodies
            .map(|b| parent(b).map_or(-1, |p| p.0 as i64))
            .collect()
    }
    /// Joint coordinates at the start, shape (coordinates,).
    #[getter]
    fn initial_position<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.model.initial_position().to_pyarray(py)
    }
    /// Lower and upper end of each actuator's control, shape (actuators, 2); infinite where there is none.
    #[getter]
    fn control_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let ranges = self.model.actuators.iter();
        let flat: Vec<f64> = ranges
            .flat_map(|a| range::in_python(a.control_range))
            .collect();
        flat.to_pyarray(py).reshape([flat.len() / 2, 2])
    }
    /// Lower and upper end of each degree of freedom's range [m or rad], shape (degrees of freedom, 2); infinite
    /// where there is none.
    #[getter]
    fn dof_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let joints = self.model.joints.iter().filter(|j| !j.closes_loop);
        let flat: Vec<f64> = joints
            .flat_map(|j| &j.dofs)
            .flat_map(|d| range::in_python(d.limit.map(|l| (l.lower, l.upper))))
            .collect();
        flat.to_pyarray(py).reshape([flat.len() / 2, 2])
    }
    /// A parameter of the model by the name that it has in `Simulation.parameters`, shape (rows, numbers).
    fn parameter<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let parameter = parameter(name)?;
        let numbers = parameter.of(&self.model);
        let rows = numbers.len() / parameter.width();
        numbers.to_pyarray(py).reshape([rows, parameter.width()])
    }

    /// The same model with a drive along each degree of freedom of some joints, in place of what they had: robot files
    /// often have joints without any, and the targets in `Simulation.controls` need them.
    ///
    /// Without names: all joints, but for free ones and those that follow another by a coupling; a model with actuators,
    /// which move some of its joints and leave others free on purpose, wants names. Where the drive has no effort limit,
    /// each joint keeps its own, as URDF files have it (`effort`). A drive without stiffness and damping takes theirs
    /// away. Hinges that turn without end are pulled the shorter way round: see `Drive`.
    ///
    /// >>> import kinetarium as kn
    /// >>> model = kn.examples.n_pendula(2).with_drives(kn.Drive(100.0, 10.0))
    /// >>> sim = kn.Simulation(model)
    /// >>> sim.controls.target_position[:, "hinge1"] = 0.5
    /// >>> sim.parameters.drive_stiffness
    /// NamedArray([[100., 100.]])
    ///
    /// Raises `UnknownNameError`, and `ModelError` for joints that take no drive.
    #[pyo3(signature = (drive, joints=None))]
    fn with_drives(&self, drive: Drive, joints: Option<Vec<String>>) -> PyResult<Self> {
        let joints = match joints {
            Some(names) => self.driven(&names)?,
            None if self.model.actuators.is_empty() => self.model.drivable_joints(),
            None => {
                let message = "the model has actuators: name the joints that are to have drives besides, as [\"knee\"]";
                return Err(error::value(message.into()));
            }
        };
        let model = self.model.with_drives(drive.into(), &joints);
        let model = Arc::new(model.map_err(error::model)?);
        Ok(Self::new(model, self.warnings.clone()))
    }

    fn __repr__(&self) -> String {
        let m = &self.model;
        format!(
            "<Model {:?}: {} bodies, {} joints, {} degrees of freedom, {} actuators>",
            m.name,
            m.bodies.len(),
            m.joints.len(),
            m.degrees_of_freedom(),
            m.actuators.len()
        )
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let this = slf.get();
        reduce(slf, &(&*this.model, &this.warnings))
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let (model, warnings): (model::Model, _) = restored(bytes)?;
        Ok(Self::new(Arc::new(model), warnings))
    }
    fn __copy__(&self) -> Self {
        Self::new(self.model.clone(), self.warnings.clone())
    }
    fn __deepcopy__(&self, _memo: &Bound<'_, PyDict>) -> Self {
        // Immutable: a copy may share it.
        self.__copy__()
    }
}
