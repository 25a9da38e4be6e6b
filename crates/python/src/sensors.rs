//! Sensors, as `kinetarium.sensors` uses them.

use crate::camera::{View, images};
use crate::error;
use crate::geometry::pose;
use crate::model::Model;
use crate::names::{Table, find, unknown};
use crate::simulation::{Engine, Precise, contiguous, in_parts};
use kinetarium::model::{self, BodyId, JointId};
use kinetarium::sensors::{
    self, Axes, Draw, ImageNoise, Level, Mount, Noise, Sensor, SensorError, SensorKind, Sensors,
};
use kinetarium::sim::Diverged;
use numpy::{PyArrayDyn, PyArrayMethods, PyReadwriteArrayDyn, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard};

fn failed(error: SensorError) -> PyErr {
    let class = match error {
        SensorError::UnknownName { .. } => "UnknownNameError",
        _ => "SensorError",
    };
    error::raise(class, error.to_string())
}

/// What a sensor measures, of a model whose names it was given.
#[pyclass(frozen, from_py_object, module = "kinetarium._engine")]
#[derive(Clone)]
pub struct Measurement {
    kind: SensorKind,
    /// Which of its numbers are told, if not all.
    part: Option<Range<usize>>,
}

impl From<SensorKind> for Measurement {
    fn from(kind: SensorKind) -> Self {
        Self { kind, part: None }
    }
}

/// Rows of joints by name; all that have coordinates where no names are given.
fn joints(model: &model::Model, names: Option<Vec<String>>) -> PyResult<Vec<JointId>> {
    let Some(names) = names else {
        return Ok(SensorKind::all_joints(model));
    };
    let joint = |name: &String| model.joint(name).map_err(error::model);
    names.iter().map(joint).collect()
}

fn body(model: &model::Model, name: Option<&str>) -> PyResult<Option<BodyId>> {
    let body = name.map(|name| model.body(name).map_err(error::model));
    body.transpose()
}

/// A name of a body, or none for the world; a position [m] and a quaternion x, y, z, w.
type Place<'a> = (Option<String>, [f64; 3], [f64; 4]);

fn mount(model: &model::Model, (name, position, orientation): &Place<'_>) -> PyResult<Mount> {
    let body = body(model, name.as_deref())?;
    Ok(Mount {
        body,
        pose: pose(*position, *orientation),
    })
}

/// Axes in which readings are told.
const AXES: Table<Axes, 2> = [("world", Axes::World), ("own", Axes::Own)];

#[pymethods]
impl Measurement {
    #[staticmethod]
    fn joint_position(model: &Bound<'_, Model>, names: Option<Vec<String>>) -> PyResult<Self> {
        let joints = joints(&model.get().model, names)?;
        Ok(SensorKind::JointPosition { joints }.into())
    }
    #[staticmethod]
    fn joint_velocity(model: &Bound<'_, Model>, names: Option<Vec<String>>) -> PyResult<Self> {
        let joints = joints(&model.get().model, names)?;
        Ok(SensorKind::JointVelocity { joints }.into())
    }
    #[staticmethod]
    fn joint_effort(model: &Bound<'_, Model>, names: Option<Vec<String>>) -> PyResult<Self> {
        let joints = joints(&model.get().model, names)?;
        Ok(SensorKind::JointEffort { joints }.into())
    }
    #[staticmethod]
    fn actuator_force(model: &Bound<'_, Model>, names: Option<Vec<String>>) -> PyResult<Self> {
        let model = &model.get().model;
        let actuator = |name: &String| model.actuator(name).map_err(error::model);
        let actuators = match names {
            Some(names) => names.iter().map(actuator).collect::<PyResult<_>>()?,
            None => (0..model.actuators.len()).collect(),
        };
        Ok(SensorKind::ActuatorForce { actuators }.into())
    }
    #[staticmethod]
    fn center_of_mass(model: &Bound<'_, Model>, body: Option<&str>) -> PyResult<Self> {
        let body = self::body(&model.get().model, body)?;
        Ok(SensorKind::CenterOfMass { body }.into())
    }
    /// What a sensor of the model's file measures.
    #[staticmethod]
    fn described(model: &Bound<'_, Model>, name: &str) -> PyResult<Self> {
        let sensors = Sensor::from_model(&model.get().model);
        let Some(sensor) = sensors.iter().find(|s| s.name == name) else {
            let known: Vec<_> = sensors.iter().map(|s| s.name.as_str()).collect();
            return Err(unknown("sensor of the model", name, &known));
        };
        let sensor = sensor.clone();
        Ok(Self {
            kind: sensor.kind,
            part: sensor.part,
        })
    }
    #[staticmethod]
    fn imu(model: &Bound<'_, Model>, place: Place<'_>) -> PyResult<Self> {
        let mount = mount(&model.get().model, &place)?;
        Ok(SensorKind::Imu { mount }.into())
    }
    #[staticmethod]
    fn force_torque(
        model: &Bound<'_, Model>,
        joint: &str,
        frame: Option<([f64; 3], [f64; 4])>,
    ) -> PyResult<Self> {
        let joint = model.get().model.joint(joint).map_err(error::model)?;
        let frame = frame.map(|(position, orientation)| pose(position, orientation));
        Ok(SensorKind::ForceTorque { joint, frame }.into())
    }
    #[staticmethod]
    fn touch(model: &Bound<'_, Model>, body: &str) -> PyResult<Self> {
        let body = model.get().model.body(body).map_err(error::model)?;
        Ok(SensorKind::Touch { body }.into())
    }
    #[staticmethod]
    fn contact_force(model: &Bound<'_, Model>, body: &str, axes: &str) -> PyResult<Self> {
        let body = model.get().model.body(body).map_err(error::model)?;
        let axes = find(&AXES, "kind of axes", axes)?;
        Ok(SensorKind::ContactForce { body, axes }.into())
    }
    #[staticmethod]
    fn frame_pose(
        model: &Bound<'_, Model>,
        place: Place<'_>,
        relative_to: Place<'_>,
    ) -> PyResult<Self> {
        let model = &model.get().model;
        let (mount, relative_to) = (mount(model, &place)?, self::mount(model, &relative_to)?);
        Ok(SensorKind::FramePose { mount, relative_to }.into())
    }
    #[staticmethod]
    fn frame_velocity(model: &Bound<'_, Model>, place: Place<'_>, axes: &str) -> PyResult<Self> {
        let mount = mount(&model.get().model, &place)?;
        let axes = find(&AXES, "kind of axes", axes)?;
        Ok(SensorKind::FrameVelocity { mount, axes }.into())
    }
    #[staticmethod]
    fn rangefinder(model: &Bound<'_, Model>, place: Place<'_>, max_range: f64) -> PyResult<Self> {
        let mount = mount(&model.get().model, &place)?;
        Ok(SensorKind::Rangefinder { mount, max_range }.into())
    }
    #[staticmethod]
    fn lidar(
        model: &Bound<'_, Model>,
        place: Place<'_>,
        azimuths: Vec<f64>,
        elevations: Vec<f64>,
        max_range: f64,
    ) -> PyResult<Self> {
        let mount = mount(&model.get().model, &place)?;
        let lidar = SensorKind::Lidar {
            mount,
            azimuths,
            elevations,
            max_range,
        };
        Ok(lidar.into())
    }
    #[staticmethod]
    fn camera(view: View, rgb_noise: f64, depth_noise: f64, device: &str) -> PyResult<Self> {
        let noise = ImageNoise {
            rgb: rgb_noise,
            depth: depth_noise,
        };
        let camera = SensorKind::Camera {
            view: view.0,
            noise,
            device: crate::camera::device(device)?,
        };
        Ok(camera.into())
    }
}

enum Precision {
    Single(Sensors<f32>),
    Double(Sensors<f64>),
}

/// The sensors of one simulation.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct SensorArray {
    sensors: Mutex<Precision>,
}

impl SensorArray {
    fn lock(&self) -> PyResult<MutexGuard<'_, Precision>> {
        self.sensors.try_lock().map_err(|_| {
            let message = "another thread is using these sensors: one call at a time";
            error::raise("BusyError", message.into())
        })
    }
}

/// A level of noise for all numbers of a reading, or for each.
#[derive(FromPyObject)]
pub enum AnyLevel {
    All(f64),
    Each(Vec<f64>),
}

impl From<AnyLevel> for Level {
    fn from(level: AnyLevel) -> Self {
        match level {
            AnyLevel::All(x) => Self::All(x),
            AnyLevel::Each(x) => Self::Each(x),
        }
    }
}

/// Name, measurement, rate [Hz], cutoff, and noise: standard deviation, bias, walk, step.
type Draft = (String, Measurement, Option<f64>, Option<f64>, [AnyLevel; 4]);

fn noise(levels: [AnyLevel; 4]) -> Noise {
    let [deviation, bias, walk, step] = levels.map(Level::from);
    Noise {
        deviation,
        bias,
        walk,
        step,
    }
}

fn sensor((name, measurement, rate, cutoff, levels): Draft) -> Sensor {
    Sensor {
        name,
        kind: measurement.kind,
        part: measurement.part,
        rate,
        cutoff,
        noise: noise(levels),
    }
}

/// Noise and cutoff of a sensor that is measured in Python.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Disturbance {
    disturbance: sensors::Disturbance,
}

#[pymethods]
impl Disturbance {
    #[new]
    fn new(
        name: &str,
        seed: u64,
        levels: [AnyLevel; 4],
        cutoff: Option<f64>,
        numbers: usize,
    ) -> PyResult<Self> {
        let made = sensors::Disturbance::new(name, seed, &noise(levels), cutoff, numbers);
        made.map(|disturbance| Self { disturbance }).map_err(failed)
    }
    /// Whether readings are what is measured.
    #[getter]
    fn is_none(&self) -> bool {
        self.disturbance.is_none()
    }
    /// Turns what was measured, shape (worlds, numbers), into what is read in those worlds of which there are samples:
    /// world, how often it has begun anew, which sample, and time since the one before [s].
    fn apply(
        &self,
        py: Python<'_>,
        samples: Vec<(usize, u32, u64, f64)>,
        mut numbers: PyReadwriteArrayDyn<'_, f64>,
        mut walk: PyReadwriteArrayDyn<'_, f64>,
    ) -> PyResult<()> {
        let (numbers, walk) = (contiguous(&mut numbers)?, contiguous(&mut walk)?);
        let draws = samples
            .into_iter()
            .map(|(world, episode, sample, elapsed)| Draw {
                world,
                episode,
                sample,
                elapsed,
            });
        let draws: Vec<_> = draws.collect();
        py.detach(|| self.disturbance.apply(&draws, numbers, walk));
        Ok(())
    }
}

/// The worlds that diverged.
fn lost(stepped: Result<Vec<Diverged>, SensorError>) -> PyResult<Vec<usize>> {
    Ok(stepped.map_err(failed)?.iter().map(|d| d.world).collect())
}

fn other_simulation() -> PyErr {
    let message = "the sensors are of a simulation of another dtype";
    error::raise("SensorError", message.into())
}

#[pymethods]
impl SensorArray {
    #[new]
    fn new(
        py: Python<'_>,
        engine: &Bound<'_, Engine>,
        sensors: Vec<Draft>,
        seed: u64,
    ) -> PyResult<Self> {
        let list: Vec<_> = sensors.into_iter().map(sensor).collect();
        let sensors = engine.get().attempt(py, |s| match s {
            Precise::Single(s) => {
                let made = Sensors::new(&mut s.read(), list, seed).map_err(failed)?;
                Ok(Precision::Single(made))
            }
            Precise::Double(s) => {
                let made = Sensors::new(&mut s.read(), list, seed).map_err(failed)?;
                Ok(Precision::Double(made))
            }
        })?;
        Ok(Self {
            sensors: Mutex::new(sensors),
        })
    }
    /// Advances the simulation and misses no sample; the worlds that diverged meanwhile.
    fn step(
        &self,
        py: Python<'_>,
        engine: &Bound<'_, Engine>,
        steps: usize,
    ) -> PyResult<Vec<usize>> {
        let sensors = &mut *self.lock()?;
        engine.get().attempt(py, |s| match (s, sensors) {
            (Precise::Single(s), Precision::Single(own)) => in_parts(steps, |part| {
                let stepped = own.step(&mut s.change(), part);
                lost(stepped)
            }),
            (Precise::Double(s), Precision::Double(own)) => in_parts(steps, |part| {
                let stepped = own.step(&mut s.change(), part);
                lost(stepped)
            }),
            _ => Err(other_simulation()),
        })
    }
    /// Samples what is due now, as after a reset.
    fn update(&self, py: Python<'_>, engine: &Bound<'_, Engine>) -> PyResult<()> {
        let sensors = &mut *self.lock()?;
        engine.get().attempt(py, |s| match (s, sensors) {
            (Precise::Single(s), Precision::Single(own)) => {
                own.update(&mut s.read()).map_err(failed)
            }
            (Precise::Double(s), Precision::Double(own)) => {
                own.update(&mut s.read()).map_err(failed)
            }
            _ => Err(other_simulation()),
        })
    }
    /// The same, and samples anew what was sampled just now.
    fn resample(&self, py: Python<'_>, engine: &Bound<'_, Engine>) -> PyResult<()> {
        let sensors = &mut *self.lock()?;
        engine.get().attempt(py, |s| match (s, sensors) {
            (Precise::Single(s), Precision::Single(own)) => {
                own.resample(&mut s.read()).map_err(failed)
            }
            (Precise::Double(s), Precision::Double(own)) => {
                own.resample(&mut s.read()).map_err(failed)
            }
            _ => Err(other_simulation()),
        })
    }
    /// The reading of a sensor, shape (worlds, …), and the time of each world's sample [s].
    fn reading<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        fn shaped<'py, T: numpy::Element>(
            py: Python<'py>,
            numbers: &[T],
            shape: &[usize],
        ) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
            numbers.to_pyarray(py).reshape(shape.to_vec())
        }
        match &*self.lock()? {
            Precision::Single(own) => {
                let reading = own.reading(name).map_err(failed)?;
                let numbers = shaped(py, reading.numbers, reading.shape)?;
                Ok((numbers.into_any(), reading.time.to_pyarray(py).into_any()))
            }
            Precision::Double(own) => {
                let reading = own.reading(name).map_err(failed)?;
                let numbers = shaped(py, reading.numbers, reading.shape)?;
                Ok((numbers.into_any(), reading.time.to_pyarray(py).into_any()))
            }
        }
    }
    /// The images of a camera by channel, and the time of each world's image [s].
    fn images<'py>(
        &self,
        py: Python<'py>,
        name: &str,
    ) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyAny>)> {
        let own = self.lock()?;
        let (made, time) = match &*own {
            Precision::Single(own) => {
                let reading = own.images(name).map_err(failed)?;
                (reading.images, reading.time)
            }
            Precision::Double(own) => {
                let reading = own.images(name).map_err(failed)?;
                (reading.images, reading.time)
            }
        };
        Ok((images(py, made.clone())?, time.to_pyarray(py).into_any()))
    }
    /// What the sensors carry along, beside a snapshot of their simulation.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = match &*self.lock()? {
            Precision::Single(own) => own.save(),
            Precision::Double(own) => own.save(),
        };
        Ok(PyBytes::new(py, &bytes))
    }
    /// Puts back what `save` gave.
    fn restore(&self, bytes: &[u8]) -> PyResult<()> {
        match &mut *self.lock()? {
            Precision::Single(own) => own.restore(bytes),
            Precision::Double(own) => own.restore(bytes),
        }
        .map_err(failed)
    }
}
