//! The simulation, as `kinetarium.Simulation` uses it.

use crate::device_array::DeviceArray;
use crate::error;
use crate::geometry::Geometry;
use crate::model::{Model, parameter};
use crate::names::{Table, find};
use crate::queries::{self, Sight};
use derivatives::{LinearizeError, linearize};
use kinetarium::model::BodyId;
use kinetarium::rigid::{Integrator, Settings};
use kinetarium::sim::{
    self, Control, EventKind, OutputPart, Parameter, PlacedShape, Quantity, Ray, ShapeCast,
    Simulation, SimulationError, SimulationSettings, Snapshot, SolverKind, Watch,
};
use kinetarium::{Card, Cards, DeviceChoice};
use numpy::ndarray::Dimension;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray, PyReadonlyArray1,
    PyReadonlyArray2, PyReadwriteArrayDyn, PyUntypedArrayMethods, ToPyArray,
};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use session::Shared;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, TryLockError};
use std::time::{Duration, Instant};

/// So that simulations on one card share what is compiled for it: each names its card by itself.
static CARDS: LazyLock<Cards> = LazyLock::new(Cards::default);

/// Steps before it is first seen whether a key interrupts the program, and how long that should take later.
const FIRST_PART: usize = 32;
const PART: Duration = Duration::from_millis(50);

/// A simulation in the precision that was asked for, which a page may be watching.
#[derive(Clone)]
pub enum Precise {
    Single(Arc<Shared<f32>>),
    Double(Arc<Shared<f64>>),
}

/// The same text for both precisions: the simulation as it is taken by `read` or `change`.
macro_rules! each {
    ($precise:expr, $take:ident, $simulation:ident => $body:expr) => {
        match $precise {
            Precise::Single(shared) => {
                let mut guard = shared.$take();
                let $simulation = &mut guard;
                $body
            }
            Precise::Double(shared) => {
                let mut guard = shared.$take();
                let $simulation = &mut guard;
                $body
            }
        }
    };
}
pub(crate) use each;

/// W worlds of one model. All calls copy between arrays and the blocks in which worlds lie, and leave Python's lock
/// free while they compute; arrays are contiguous and of the simulation's precision.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Engine {
    simulation: Mutex<Option<Open>>,
}

/// What an engine has until it is closed.
struct Open {
    precise: Precise,
    /// Where the worlds are, if on a card: held, so that others are given the same.
    _card: Option<Card>,
}

impl Engine {
    /// Does something with the simulation, without Python's lock.
    pub fn with<R: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&Precise) -> Result<R, SimulationError> + Send,
    ) -> PyResult<R> {
        self.attempt(py, |s| act(s).map_err(error::simulation))
    }

    /// The same for what fails in other ways.
    pub fn attempt<R: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&Precise) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        let simulation = self.lock()?;
        let open = simulation.as_ref().ok_or_else(closed)?;
        py.detach(|| act(&open.precise))
    }

    fn lock(&self) -> PyResult<MutexGuard<'_, Option<Open>>> {
        self.simulation.try_lock().map_err(|error| match error {
            TryLockError::WouldBlock => {
                let message = "another thread is using this simulation: one call at a time, or a simulation \
                               for each thread";
                error::raise("BusyError", message.into())
            }
            TryLockError::Poisoned(_) => {
                let message = "the simulation failed in an earlier call: make it anew";
                error::raise("ClosedError", message.into())
            }
        })
    }
}

fn closed() -> PyErr {
    let message = "the simulation is closed: make it anew";
    error::raise("ClosedError", message.into())
}

/// Makes many steps in parts, so that a key that interrupts the program need not wait for all of them; `step` makes some,
/// and tells what diverged. It must hold the simulation no longer: between the parts handlers of signals run, which may
/// close the page, and the page has its turn.
pub fn in_parts<D>(
    steps: usize,
    mut step: impl FnMut(usize) -> PyResult<Vec<D>>,
) -> PyResult<Vec<D>> {
    let (mut left, mut part, mut diverged) = (steps, FIRST_PART, Vec::new());
    loop {
        let (begin, now) = (Instant::now(), left.min(part));
        diverged.extend(step(now)?);
        left -= now;
        if left == 0 {
            return Ok(diverged);
        }
        Python::attach(|py| py.check_signals())?;
        part = if begin.elapsed() < PART {
            2 * now
        } else {
            now.div_ceil(2)
        };
    }
}

impl Engine {
    fn on_device(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&mut Simulation<f32>) -> Result<sim::DeviceArray, SimulationError> + Send,
        shape: Vec<usize>,
    ) -> PyResult<DeviceArray> {
        self.attempt(py, |s| match s {
            Precise::Single(s) => {
                let array = ask(&mut s.change()).map_err(error::simulation)?;
                Ok(DeviceArray::new(array, shape, Arc::clone(s)))
            }
            Precise::Double(_) => Err(error::raise(
                "DeviceError",
                "worlds in double precision are on the processor: nothing of them is on a card"
                    .into(),
            )),
        })
    }
}

/// What is reported of worlds.
const QUANTITIES: Table<Quantity, 19> = [
    ("body_position", Quantity::BodyPosition),
    ("body_orientation", Quantity::BodyOrientation),
    ("body_velocity", Quantity::BodyVelocity),
    ("body_angular_velocity", Quantity::BodyAngularVelocity),
    ("joint_position", Quantity::JointPosition),
    ("joint_velocity", Quantity::JointVelocity),
    ("joint_acceleration", Quantity::JointAcceleration),
    ("reaction_force", Quantity::ReactionForce),
    ("reaction_torque", Quantity::ReactionTorque),
    ("contact_wrench", Quantity::ContactWrench),
    ("center_of_mass", Quantity::CenterOfMass),
    ("spatial_inertia", Quantity::SpatialInertia),
    ("spatial_velocity", Quantity::SpatialVelocity),
    ("spatial_contact_force", Quantity::SpatialContactForce),
    ("kinetic_energy", Quantity::KineticEnergy),
    ("potential_energy", Quantity::PotentialEnergy),
    ("momentum", Quantity::Momentum),
    ("angular_momentum", Quantity::AngularMomentum),
    ("capped", Quantity::Capped),
];

/// What a controller sets.
const CONTROLS: Table<Control, 4> = [
    ("force", Control::Force),
    ("target_position", Control::TargetPosition),
    ("target_velocity", Control::TargetVelocity),
    ("actuator", Control::Actuator),
];

/// An array of the simulation's precision.
fn array<'a, 'py, T: Element>(x: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, PyArrayDyn<T>>> {
    x.cast::<PyArrayDyn<T>>().map_err(|_| {
        let message = "the array must be of the simulation's dtype";
        error::raise("ShapeError", message.into())
    })
}

/// The numbers of an array in the order of C.
pub fn slice<'a, T: Element, D: Dimension>(
    array: &'a PyReadonlyArray<'_, T, D>,
) -> PyResult<&'a [T]> {
    if array.is_c_contiguous() {
        array.as_slice().map_err(|_| not_contiguous())
    } else {
        Err(not_contiguous())
    }
}

/// Worlds by their numbers, which are not negative.
fn rows(worlds: &PyReadonlyArray1<'_, i64>) -> PyResult<Vec<usize>> {
    Ok(slice(worlds)?.iter().map(|world| *world as usize).collect())
}

fn not_contiguous() -> PyErr {
    let message = "the array must be contiguous, in the order of C";
    error::raise("ShapeError", message.into())
}

/// The same, to be written to.
pub fn contiguous<'a, T: Element>(
    array: &'a mut PyReadwriteArrayDyn<'_, T>,
) -> PyResult<&'a mut [T]> {
    if array.is_c_contiguous() {
        array.as_slice_mut().map_err(|_| not_contiguous())
    } else {
        Err(not_contiguous())
    }
}

fn read_only<E: std::fmt::Display>(why: E) -> PyErr {
    error::raise(
        "ShapeError",
        format!("the array cannot be written to: {why}"),
    )
}

#[pymethods]
impl Engine {
    #[new]
    #[pyo3(signature = (model, *, worlds, time_step, solver, substeps, iterations, integrator, contacts,
        contact_passes, contact_iterations, speed_limit, sleep_speed, threads, double, device))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        py: Python<'_>,
        model: &Bound<'_, Model>,
        worlds: usize,
        time_step: f64,
        solver: &str,
        substeps: Option<usize>,
        iterations: usize,
        integrator: &str,
        contacts: bool,
        contact_passes: usize,
        contact_iterations: usize,
        speed_limit: f64,
        sleep_speed: f64,
        threads: usize,
        double: bool,
        device: &str,
    ) -> PyResult<Self> {
        let model = model.get().model.clone();
        let solver: SolverKind = solver
            .parse()
            .map_err(|e| error::raise("UnknownNameError", e))?;
        let choice: DeviceChoice = device.parse().map_err(error::device)?;
        let picked = solver.pick(&model, contacts);
        let card = py.detach(|| CARDS.open_for(&choice, picked, double));
        let card = card.map_err(error::device)?;
        let solver = match &card {
            Some(card) => solver.pick_on(&**card, &model, contacts),
            None => picked,
        };
        let settings = SimulationSettings {
            solver,
            contacts,
            threads,
            step: Settings {
                substeps: substeps.unwrap_or_else(|| solver.usual_substeps(&model, contacts)),
                iterations,
                integrator: find(
                    &Integrator::ALL.map(|i| (i.name(), i)),
                    "integrator",
                    integrator,
                )?,
                contact_passes,
                contact_iterations,
                speed_limit,
                sleep_speed,
                ..Settings::new(time_step)
            },
            ..SimulationSettings::new(worlds, time_step)
        };
        let make = || {
            Ok(match &card {
                Some(card) => {
                    Precise::Single(Shared::new(Simulation::on(&**card, model, settings)?))
                }
                None if double => Precise::Double(Shared::new(Simulation::new(model, settings)?)),
                None => Precise::Single(Shared::new(Simulation::new(model, settings)?)),
            })
        };
        let precise = py.detach(make).map_err(error::simulation)?;
        Ok(Self {
            simulation: Mutex::new(Some(Open {
                precise,
                _card: card,
            })),
        })
    }
    /// Frees the worlds; later calls raise `ClosedError`.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let open = self.lock()?.take().ok_or_else(closed)?;
        py.detach(|| drop(open));
        Ok(())
    }
    /// Name of the solver, name of the instruction set, number of threads, name of the device.
    fn describe(&self, py: Python<'_>) -> PyResult<(&'static str, String, usize, String)> {
        self.with(py, |s| {
            Ok(each!(s, read, s => {
                let device = s.device().unwrap_or("cpu").to_owned();
                (s.solver(), s.isa().to_string(), s.threads(), device)
            }))
        })
    }
    /// How many substeps the device has left to the processor.
    fn left_to_processor(&self, py: Python<'_>) -> PyResult<u64> {
        self.with(py, |s| Ok(each!(s, read, s => s.left_to_processor())))
    }

    /// Advances all worlds; the worlds that diverged meanwhile.
    fn step(&self, py: Python<'_>, steps: usize) -> PyResult<Vec<usize>> {
        self.attempt(py, |s| {
            in_parts(steps, |part| {
                let stepped: Result<Vec<_>, _> = each!(s, change, s => {
                    s.try_step(part).map(|lost| lost.iter().map(|d| d.world).collect())
                });
                stepped.map_err(error::simulation)
            })
        })
    }
    /// How often each world was set, reset or restored.
    fn begun<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let begun: Vec<u64> = self.with(py, |s| {
            Ok(each!(s, read, s => (0..s.worlds()).map(|w| s.begun(w)).collect()))
        })?;
        Ok(begun.to_pyarray(py))
    }
    /// Time of every world [s].
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let times: Vec<f64> = self.with(py, |s| {
            Ok(each!(s, read, s => (0..s.worlds()).map(|w| s.time(w)).collect()))
        })?;
        Ok(times.to_pyarray(py))
    }
    /// The worlds that have diverged, and when [s].
    fn diverged(&self, py: Python<'_>) -> PyResult<Vec<(usize, f64)>> {
        self.with(py, |s| {
            Ok(each!(s, read, s => s.diverged().iter().map(|d| (d.world, d.time)).collect()))
        })
    }
    /// Copies a quantity of all worlds into an array.
    fn read(&self, py: Python<'_>, quantity: &str, out: &Bound<'_, PyAny>) -> PyResult<()> {
        let quantity = find(&QUANTITIES, "quantity", quantity)?;
        fill(
            self,
            py,
            out,
            |s, out| s.read(quantity, out),
            |s, out| s.read(quantity, out),
        )
    }
    /// Copies a quantity of all worlds into columns of a table.
    fn read_columns(
        &self,
        py: Python<'_>,
        quantity: &str,
        table: &Bound<'_, PyAny>,
        column: usize,
    ) -> PyResult<()> {
        let quantity = find(&QUANTITIES, "quantity", quantity)?;
        if let Ok(table) = table.cast::<PyArrayDyn<f32>>() {
            let mut table = table.try_readwrite().map_err(read_only)?;
            let table = contiguous(&mut table)?;
            return self.with(
                py,
                |s| each!(s, read, s => s.read_columns(quantity, table, column)),
            );
        }
        let mut table = array::<f64>(table)?.try_readwrite().map_err(read_only)?;
        let table = contiguous(&mut table)?;
        self.with(
            py,
            |s| each!(s, read, s => s.read_columns(quantity, table, column)),
        )
    }
    /// Where a quantity of all worlds lies on a card, as an array of this shape.
    fn quantity_on_device(
        &self,
        py: Python<'_>,
        quantity: &str,
        shape: Vec<usize>,
    ) -> PyResult<DeviceArray> {
        let quantity = find(&QUANTITIES, "quantity", quantity)?;
        self.on_device(py, |s| s.quantity_on_device(quantity), shape)
    }
    /// Where a control of all worlds lies on a card, as an array of this shape.
    fn control_on_device(
        &self,
        py: Python<'_>,
        control: &str,
        shape: Vec<usize>,
    ) -> PyResult<DeviceArray> {
        let control = find(&CONTROLS, "control", control)?;
        self.on_device(py, |s| s.control_on_device(control), shape)
    }
    /// Copies a control of all worlds into an array.
    fn read_control(&self, py: Python<'_>, control: &str, out: &Bound<'_, PyAny>) -> PyResult<()> {
        let control = find(&CONTROLS, "control", control)?;
        fill(
            self,
            py,
            out,
            |s, out| {
                s.fetch_controls()
                    .and_then(|()| s.controls().read(control, out))
            },
            |s, out| {
                s.fetch_controls()
                    .and_then(|()| s.controls().read(control, out))
            },
        )
    }
    /// Sets a control of all worlds from an array.
    fn write_control(
        &self,
        py: Python<'_>,
        control: &str,
        numbers: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let control = find(&CONTROLS, "control", control)?;
        if let Ok(numbers) = numbers.cast::<PyArrayDyn<f32>>() {
            let numbers = numbers.readonly();
            let numbers = slice(&numbers)?;
            return self.with(py, |s| match s {
                Precise::Single(s) => s.change().controls().write(control, numbers),
                Precise::Double(_) => Err(other_precision("controls")),
            });
        }
        let numbers = array::<f64>(numbers)?.readonly();
        let numbers = slice(&numbers)?;
        self.with(py, |s| match s {
            Precise::Double(s) => s.change().controls().write(control, numbers),
            Precise::Single(_) => Err(other_precision("controls")),
        })
    }
    /// Sets joint coordinates and velocities of some worlds, a row for each; with `keep` they keep their times and
    /// controls.
    fn set_joint_state(
        &self,
        py: Python<'_>,
        worlds: PyReadonlyArray1<'_, i64>,
        position: PyReadonlyArray2<'_, f64>,
        velocity: PyReadonlyArray2<'_, f64>,
        keep: bool,
    ) -> PyResult<()> {
        let columns = [position.as_array().ncols(), velocity.as_array().ncols()];
        let worlds = slice(&worlds)?;
        let position = slice(&position)?;
        let velocity = slice(&velocity)?;
        self.with(py, |s| {
            each!(s, change, s => {
                let states = worlds.iter().enumerate().map(|(i, &world)| {
                    let q = &position[i * columns[0]..][..columns[0]];
                    let v = &velocity[i * columns[1]..][..columns[1]];
                    (world as usize, q, v)
                });
                if !keep {
                    return s.set_joint_states(states);
                }
                s.move_joints_of(states)
            })
        })
    }
    /// Sets joint velocities of some worlds, a row for each; all else stays.
    fn set_joint_velocities(
        &self,
        py: Python<'_>,
        worlds: PyReadonlyArray1<'_, i64>,
        velocity: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let columns = velocity.as_array().ncols();
        let worlds = slice(&worlds)?;
        let velocity = slice(&velocity)?;
        self.with(py, |s| {
            each!(s, change, s => {
                let rows = worlds.iter().enumerate();
                let rows = rows.map(|(i, &w)| (w as usize, &velocity[i * columns..][..columns]));
                s.set_joint_velocities(rows)
            })
        })
    }
    /// Brings some worlds to their initial state.
    fn reset(&self, py: Python<'_>, worlds: PyReadonlyArray1<'_, i64>) -> PyResult<()> {
        let worlds = slice(&worlds)?;
        let worlds: Vec<usize> = worlds.iter().map(|&w| w as usize).collect();
        self.with(py, |s| each!(s, change, s => s.reset(&worlds)))
    }
    /// The whole state of all worlds, to the bit.
    fn snapshot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.with(
            py,
            |s| each!(s, read, s => Ok(s.try_snapshot()?.to_bytes())),
        )?;
        Ok(PyBytes::new(py, &bytes))
    }
    /// Returns to a snapshot.
    fn restore(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<()> {
        self.with(py, |s| {
            let snapshot = Snapshot::from_bytes(bytes)?;
            each!(s, change, s => s.restore(&snapshot))
        })
    }
    /// Which bodies of a world sleep.
    fn asleep(&self, py: Python<'_>, world: usize) -> PyResult<Vec<bool>> {
        self.with(py, |s| {
            each!(s, read, s => {
                exists(world, s.worlds())?;
                let bodies = s.model().bodies.len();
                let parts = (0..bodies).map(|body| OutputPart::Asleep(BodyId(body)));
                Ok(s.observe_parts(parts, |_, outputs| {
                    (0..bodies).map(|b| outputs.asleep(world, BodyId(b))).collect()
                })?)
            })
        })
    }
    /// The contacts of the last step in some worlds, as a dictionary of arrays with a row for each.
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let worlds = rows(&worlds)?;
        let contacts = self.with(py, |s| {
            each!(s, read, s => {
                s.observe_parts([OutputPart::Contacts], |_, outputs| {
                    let of = |&world: &usize| outputs.contacts(world).map(move |c| (world, c));
                    worlds.iter().flat_map(of).collect::<Vec<_>>()
                })
            })
        })?;
        queries::contacts(py, &contacts)
    }
    /// What rays meet first, the same number in each of some worlds: arrays with a row for each ray.
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
        origins: PyReadonlyArray2<'_, f64>,
        directions: PyReadonlyArray2<'_, f64>,
        max_distance: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let worlds = rows(&worlds)?;
        let origins = queries::vectors(slice(&origins)?).into_iter();
        let rays = origins.zip(queries::vectors(slice(&directions)?));
        let rays = Vec::from_iter(rays.map(|(origin, direction)| Ray {
            origin,
            direction,
            max_distance,
        }));
        let hits = self.with(py, |s| {
            each!(s, read, s => {
                let hits = s.cast_rays_in_worlds(&worlds, &rays, None)?.into_iter();
                Ok(Vec::from_iter(hits.map(|hit| Some(queries::met(hit?, s.model())))))
            })
        })?;
        queries::rows(py, &hits)
    }
    /// What a shape first touches that is swept along lines, the same number in each of some worlds: arrays with a row for
    /// each sweep.
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn cast_shapes<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
        geometry: Geometry,
        positions: PyReadonlyArray2<'_, f64>,
        orientations: PyReadonlyArray2<'_, f64>,
        directions: PyReadonlyArray2<'_, f64>,
        max_distance: f64,
        seen: Sight,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (worlds, seen) = (rows(&worlds)?, queries::seen(seen)?);
        let poses = queries::poses(slice(&positions)?, slice(&orientations)?);
        let directions = queries::vectors(slice(&directions)?);
        let casts = poses.into_iter().zip(directions);
        let casts = casts.map(|(pose, direction)| ShapeCast {
            geometry: &geometry.0,
            pose,
            direction,
            max_distance,
        });
        let casts = Vec::from_iter(casts);
        let hits = self.with(
            py,
            |s| each!(s, read, s => s.cast_shapes_in_worlds(&worlds, &casts, &seen)),
        )?;
        queries::rows(py, &hits)
    }
    /// The nearest shapes to points, the same number of points in each of some worlds: arrays with so many rows for each
    /// point.
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
        points: PyReadonlyArray2<'_, f64>,
        count: usize,
        max_distance: f64,
        seen: Sight,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (worlds, seen) = (rows(&worlds)?, queries::seen(seen)?);
        let points = queries::vectors(slice(&points)?);
        let found = self.with(
            py,
            |s| each!(s, read, s => s.nearest_in_worlds(&worlds, &points, count, max_distance, &seen)),
        )?;
        let padded = |hits: &Vec<_>| Vec::from_iter((0..count).map(|i| hits.get(i).copied()));
        queries::rows(py, &Vec::from_iter(found.iter().flat_map(padded)))
    }
    /// The nearest points of all shapes within a distance of points, the same number of points in each of some worlds: arrays
    /// with a row for each shape, and that of its point.
    fn closest_points<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
        points: PyReadonlyArray2<'_, f64>,
        max_distance: f64,
        seen: Sight,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (worlds, seen) = (rows(&worlds)?, queries::seen(seen)?);
        let points = queries::vectors(slice(&points)?);
        let found = self.with(
            py,
            |s| each!(s, read, s => s.closest_points_in_worlds(&worlds, &points, max_distance, &seen)),
        )?;
        queries::listed(py, &found)
    }
    /// The shapes that a shape overlaps in some places, the same number of places in each of some worlds: arrays with a row
    /// for each shape, and that of its place.
    fn overlaps<'py>(
        &self,
        py: Python<'py>,
        worlds: PyReadonlyArray1<'_, i64>,
        geometry: Geometry,
        positions: PyReadonlyArray2<'_, f64>,
        orientations: PyReadonlyArray2<'_, f64>,
        seen: Sight,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (worlds, seen) = (rows(&worlds)?, queries::seen(seen)?);
        let poses = queries::poses(slice(&positions)?, slice(&orientations)?).into_iter();
        let geometry = &geometry.0;
        let shapes = Vec::from_iter(poses.map(|pose| PlacedShape { geometry, pose }));
        let found = self.with(
            py,
            |s| each!(s, read, s => s.overlaps_in_worlds(&worlds, &shapes, &seen)),
        )?;
        queries::listed(py, &found)
    }

    /// A parameter of some worlds, shape (worlds, rows · numbers).
    fn read_parameter<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        worlds: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let parameter = parameter(name)?;
        let worlds = slice(&worlds)?;
        let numbers = self.with(py, |s| {
            each!(s, read, s => {
                let shared = parameter.of(s.model());
                let of = |&world: &i64| {
                    let model = s.world_model(world as usize);
                    if std::sync::Arc::ptr_eq(model, s.model()) {
                        shared.clone()
                    } else {
                        parameter.of(model)
                    }
                };
                Ok(worlds.iter().flat_map(of).collect::<Vec<_>>())
            })
        })?;
        let columns = numbers.len() / worlds.len().max(1);
        numbers.to_pyarray(py).reshape([worlds.len(), columns])
    }
    /// Gives some worlds other numbers of a parameter, a row for each world; none where one is refused.
    fn write_parameter(
        &self,
        py: Python<'_>,
        name: &str,
        worlds: PyReadonlyArray1<'_, i64>,
        numbers: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let parameter: Parameter = parameter(name)?;
        let worlds = slice(&worlds)?.iter().map(|world| *world as usize);
        let (worlds, numbers) = (Vec::from_iter(worlds), slice(&numbers)?);
        self.with(
            py,
            |s| each!(s, change, s => s.set_parameter(parameter, &worlds, numbers)),
        )
    }
    /// Gives some worlds other numbers of several parameters, of each a row for each world, also where they can be had only
    /// together; none where one is refused.
    fn write_parameters(
        &self,
        py: Python<'_>,
        worlds: PyReadonlyArray1<'_, i64>,
        parameters: Vec<(String, PyReadonlyArray2<'_, f64>)>,
    ) -> PyResult<()> {
        let worlds = rows(&worlds)?;
        let mut tables: Vec<(Parameter, &[f64])> = Vec::new();
        for (name, numbers) in &parameters {
            tables.push((parameter(name)?, slice(numbers)?));
        }
        self.with(
            py,
            |s| each!(s, change, s => s.set_parameters_of(&worlds, &tables)),
        )
    }

    /// A time step linearised at the state of a world: arrays by name.
    fn linearize<'py>(&self, py: Python<'py>, world: usize) -> PyResult<Bound<'py, PyDict>> {
        let step = self.attempt(py, |s| {
            each!(s, read, s => {
                linearize(&mut **s, world).map_err(|e| match e {
                    LinearizeError::Simulation(e) => error::simulation(e),
                    other => error::raise("SimulationError", other.to_string()),
                })
            })
        })?;
        let (n, m) = (step.dofs, step.controls);
        let found = PyDict::new(py);
        for (name, numbers, columns) in [
            ("state", &step.state, 2 * n),
            ("control", &step.control, m),
            ("force", &step.force, n),
            ("target_position", &step.target_position, n),
            ("target_velocity", &step.target_velocity, n),
        ] {
            found.set_item(name, numbers.to_pyarray(py).reshape([2 * n, columns])?)?;
        }
        Ok(found)
    }

    /// Chooses which events are told.
    #[expect(clippy::fn_params_excessive_bools, reason = "keywords in Python")]
    #[pyo3(signature = (*, contacts, persisting_contacts, sensors, limits, sleep, divergence))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn watch(
        &self,
        py: Python<'_>,
        contacts: bool,
        persisting_contacts: bool,
        sensors: bool,
        limits: bool,
        sleep: bool,
        divergence: bool,
    ) -> PyResult<()> {
        let watch = Watch {
            contacts,
            persisting_contacts,
            sensors,
            limits,
            sleep,
            divergence,
        };
        self.with(py, |s| {
            each!(s, change, s => s.watch(watch));
            Ok(())
        })
    }
    /// The events since the last call: world, time [s], kind, and what belongs to the kind.
    fn drain_events<'py>(&self, py: Python<'py>) -> PyResult<Vec<Event<'py>>> {
        let events = self.with(py, |s| Ok(each!(s, read, s => s.drain_events())))?;
        let told = |event: kinetarium::sim::Event| {
            let (kind, details) = tell(py, event.kind)?;
            Ok((event.world, event.time, kind, details))
        };
        events.into_iter().map(told).collect()
    }
}

type Event<'py> = (usize, f64, &'static str, Bound<'py, PyDict>);

/// An event's kind, and its details by name.
fn tell(py: Python<'_>, kind: EventKind) -> PyResult<(&'static str, Bound<'_, PyDict>)> {
    let details = PyDict::new(py);
    let name = match kind {
        EventKind::ContactBegins { shapes, impulse } => {
            details.set_item("shapes", shapes.map(|s| s.0))?;
            details.set_item("impulse", impulse.to_array())?;
            "contact_begins"
        }
        EventKind::ContactPersists { shapes, impulse } => {
            details.set_item("shapes", shapes.map(|s| s.0))?;
            details.set_item("impulse", impulse.to_array())?;
            "contact_persists"
        }
        EventKind::ContactEnds { shapes } => {
            details.set_item("shapes", shapes.map(|s| s.0))?;
            "contact_ends"
        }
        EventKind::SensorBegins { shapes } => {
            details.set_item("shapes", shapes.map(|s| s.0))?;
            "sensor_begins"
        }
        EventKind::SensorEnds { shapes } => {
            details.set_item("shapes", shapes.map(|s| s.0))?;
            "sensor_ends"
        }
        EventKind::LimitReached { dof, upper } => {
            details.set_item("dof", dof)?;
            details.set_item("upper", upper)?;
            "limit_reached"
        }
        EventKind::FallsAsleep { body } => {
            details.set_item("body", body.0)?;
            "falls_asleep"
        }
        EventKind::Wakes { body } => {
            details.set_item("body", body.0)?;
            "wakes"
        }
        EventKind::Diverged => "diverged",
    };
    Ok((name, details))
}

fn exists(world: usize, count: usize) -> Result<(), SimulationError> {
    if world < count {
        return Ok(());
    }
    Err(SimulationError::Index {
        what: "world",
        index: world,
        count,
    })
}

fn other_precision(what: &'static str) -> SimulationError {
    SimulationError::Setting {
        what: what.into(),
        value: "of another precision".into(),
        remedy: "an array of the simulation's dtype".into(),
    }
}

/// Fills an array of the simulation's precision.
fn fill(
    engine: &Engine,
    py: Python<'_>,
    out: &Bound<'_, PyAny>,
    single: impl FnOnce(&mut Simulation<f32>, &mut [f32]) -> Result<(), SimulationError> + Send,
    double: impl FnOnce(&mut Simulation<f64>, &mut [f64]) -> Result<(), SimulationError> + Send,
) -> PyResult<()> {
    if let Ok(out) = out.cast::<PyArrayDyn<f32>>() {
        let mut out = out.try_readwrite().map_err(read_only)?;
        let out = contiguous(&mut out)?;
        return engine.with(py, |s| match s {
            Precise::Single(s) => single(&mut s.read(), out),
            Precise::Double(_) => Err(other_precision("the array")),
        });
    }
    let mut out = array::<f64>(out)?.try_readwrite().map_err(read_only)?;
    let out = contiguous(&mut out)?;
    engine.with(py, |s| match s {
        Precise::Double(s) => double(&mut s.read(), out),
        Precise::Single(_) => Err(other_precision("the array")),
    })
}
