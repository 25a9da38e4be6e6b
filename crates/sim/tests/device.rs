//! What a simulation asks of a device that does not run all solvers.

use kinetarium_sim::{
    Constants, Device, DeviceError, DeviceWorlds, EventKind, Gauge, OutputPart, Parameter,
    Processor, Quantity, Simulation, SimulationError, SimulationSettings, SolverKind, Watch,
};
use model::examples::{Start, chain, tower};
use model::{BodyId, CollisionFilter, JointId, Model, Mount, ShapeId};
use numbers::Memory;
use rigid::impulse::Impulse;
use rigid::{Instrument, Report, Solver};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// One that has no memory, and runs no `impulse`.
struct Full;

impl Device<f32> for Full {
    fn name(&self) -> String {
        "full".into()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        _: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        let asked = match solver {
            Solver::Featherstone(_) | Solver::TouchingFeatherstone(_) => "featherstone",
            Solver::Xpbd(_) => "xpbd",
        };
        Err(DeviceError::new(format!("no memory for {asked}")))
    }
}

/// One that has no memory for the first step, and in which all worlds have diverged after the second.
struct Busy;

impl Device<f32> for Busy {
    fn name(&self) -> String {
        "busy".into()
    }
    fn place(&self, _: Solver<'_>, _: usize) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        Ok(Box::new(BusyWorlds { tried: false }))
    }
}

struct BusyWorlds {
    tried: bool,
}

impl DeviceWorlds<f32> for BusyWorlds {
    fn write_state(&mut self, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_worlds(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_input(&mut self, _: Range<usize>, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_parameters(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn step(&mut self, _: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        if std::mem::replace(&mut self.tried, true) {
            return Ok(());
        }
        Err(DeviceError::new("no memory for now"))
    }
    fn report(&mut self, _: Report) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read_state(
        &mut self,
        rows: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for offset in rows.iter().cloned().flatten() {
            state.fill(offset, 0.0);
        }
        Ok(())
    }
    fn read_output(&mut self, _: &[Range<usize>], _: &mut Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
}

#[test]
fn events_are_told_after_a_step_that_failed() {
    let model = chain(3, Start::Horizontal).unwrap();
    let settings = SimulationSettings::new(1, 0.004);
    let mut simulation = Simulation::on(&Busy, model, settings).unwrap();
    simulation.watch(Watch {
        divergence: true,
        ..Watch::default()
    });
    assert!(simulation.try_step(1).is_err());
    assert_eq!(simulation.drain_events(), []);
    simulation.try_step(1).unwrap();
    let kinds = simulation.drain_events().into_iter().map(|e| e.kind);
    assert!(kinds.eq([EventKind::Diverged]));
}

fn told(model: &Model, solver: SolverKind) -> SimulationError {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, 0.004)
    };
    Simulation::on(&Full, model.clone(), settings)
        .err()
        .unwrap()
}

#[test]
fn auto_takes_what_the_device_runs() {
    let (pile, tree) = (
        tower(3, 0.001).unwrap(),
        chain(3, Start::Horizontal).unwrap(),
    );
    assert_eq!(SolverKind::Auto.pick(&pile, true), SolverKind::Impulse);
    for model in [&pile, &tree] {
        let picked = SolverKind::Auto.pick_on(&Full, model, true);
        assert_eq!(picked, SolverKind::Featherstone);
        let told = told(model, SolverKind::Auto).to_string();
        assert!(told.contains("no memory for featherstone"), "{told}");
    }
}

#[test]
fn a_solver_that_is_named_and_does_not_run_there_is_refused() {
    let told = told(&tower(3, 0.001).unwrap(), SolverKind::Impulse);
    assert!(
        matches!(told, SimulationError::NotOnDevice { .. }),
        "{told}"
    );
    let told = told.to_string();
    assert!(told.contains("impulse") && told.contains("full"), "{told}");
}

/// One that notes what it is asked.
#[derive(Default)]
struct Noting(Arc<Mutex<Notes>>);

#[derive(Default)]
struct Notes {
    /// Which numbers of the output are read.
    output: Vec<Vec<Range<usize>>>,
    /// In which worlds an instrument is.
    measured: Vec<Vec<usize>>,
    /// Whether with constants of each world.
    own: Vec<bool>,
    /// Whose constants are written.
    given: Vec<Vec<usize>>,
    /// What is reported.
    reports: Vec<Report>,
}

impl Device<f32> for Noting {
    fn name(&self) -> String {
        "noting".into()
    }
    fn place(&self, _: Solver<'_>, _: usize) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        Ok(Box::new(NotingWorlds(Arc::clone(&self.0))))
    }
    fn place_piles(
        &self,
        _: &Impulse,
        _: &Model,
        _: Option<&CollisionFilter>,
        _: usize,
    ) -> Result<Option<Box<dyn DeviceWorlds<f32>>>, DeviceError> {
        Ok(Some(Box::new(NotingWorlds(Arc::clone(&self.0)))))
    }
}

struct NotingWorlds(Arc<Mutex<Notes>>);

impl DeviceWorlds<f32> for NotingWorlds {
    fn write_state(&mut self, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_worlds(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_input(&mut self, _: Range<usize>, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_parameters(&mut self, worlds: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        self.0.lock().unwrap().given.push(worlds.to_vec());
        Ok(())
    }
    fn step(&mut self, _: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn report(&mut self, report: Report) -> Result<(), DeviceError> {
        self.0.lock().unwrap().reports.push(report);
        Ok(())
    }
    fn read_state(&mut self, _: &[Range<usize>], _: &mut Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read_output(
        &mut self,
        numbers: &[Range<usize>],
        _: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.0.lock().unwrap().output.push(numbers.to_vec());
        Ok(())
    }
    fn measures(&self) -> bool {
        true
    }
    fn measure(
        &mut self,
        _: &Arc<Instrument>,
        own: Option<&Constants<f32>>,
        worlds: &[usize],
        _: &mut Memory<f32>,
    ) -> Result<bool, DeviceError> {
        let mut notes = self.0.lock().unwrap();
        notes.measured.push(worlds.to_vec());
        notes.own.push(own.is_some());
        Ok(true)
    }
}

#[test]
fn no_more_is_read_than_is_looked_at() {
    let model = chain(3, Start::Horizontal).unwrap();
    let joints = model.joints.len();
    let settings = SimulationSettings::new(2, 0.004);
    let device = Noting::default();
    let mut simulation = Simulation::on(&device, model, settings).unwrap();
    let read = || std::mem::take(&mut device.0.lock().unwrap().output);
    assert_eq!(read(), Vec::<Vec<_>>::new());

    let mut positions = vec![0.0; 2 * joints];
    let quantity = Quantity::JointPosition;
    simulation.read(quantity, &mut positions).unwrap();
    let [all] = &read()[..] else {
        panic!("one reading")
    };
    let [angles] = &all[..] else {
        panic!("one range")
    };
    assert_eq!(angles.len(), joints);
    // What is known is not read again, until there is a step, or more of it is worked out.
    let first = [OutputPart::Coordinates(JointId(0))];
    simulation.observe_parts(first, |_, _| ()).unwrap();
    simulation.read(quantity, &mut positions).unwrap();
    assert_eq!(read(), Vec::<Vec<_>>::new());
    simulation.try_step(1).unwrap();
    simulation.observe_parts(first, |_, _| ()).unwrap();
    let one = angles.start..angles.start + 1;
    assert_eq!(read(), [vec![one.clone()]]);
    let parts = [
        OutputPart::Motion(BodyId(2)),
        OutputPart::Velocities(JointId(1)),
        OutputPart::Coordinates(JointId(0)),
        OutputPart::Motion(BodyId(1)),
    ];
    simulation.observe_parts(parts, |_, _| ()).unwrap();
    let ranges = &read()[0];
    let lengths = Vec::from_iter(ranges.iter().map(|range| range.len()));
    assert_eq!(lengths, [2 * rigid::body::WIDTH, 1, 1]);
    assert_eq!(ranges[1], one);
    // What pushes joints looks at where they are and how they move.
    simulation.try_step(1).unwrap();
    let at_rest = vec![0.0; joints];
    let pushed = simulation.set_joint_velocities([(0, &at_rest[..])]);
    pushed.unwrap();
    let lengths = Vec::from_iter(read().concat().iter().map(|range| range.len()));
    assert_eq!(lengths, [joints, joints]);
    // What gives a world a model of its own needs none of it, where joints tell all.
    let model = Arc::clone(simulation.model());
    simulation.set_world_model(1, &model).unwrap();
    assert_eq!(read(), Vec::<Vec<_>>::new());
}

/// As few as are reset are told of, each once.
#[test]
fn sensors_are_read_in_the_worlds_that_are_asked_for() {
    let device = Noting::default();
    let model = chain(3, Start::Horizontal).unwrap();
    let settings = SimulationSettings::new(1000, 0.004);
    let mut simulation = Simulation::on(&device, model, settings).unwrap();
    let mount = Mount::on(BodyId(1));
    let mut gauges = simulation.gauges(vec![Gauge::Imu(mount)]).unwrap();
    let down = [-glam::DVec3::Y];
    let mut finder = simulation.rangefinder(mount, &down, 9.0).unwrap();
    simulation.try_step(1).unwrap();
    simulation.reset(&[7, 3]).unwrap();
    simulation.read_gauges(&mut gauges, &[7, 3, 7]).unwrap();
    let mut ranges = [0.0; 2];
    let measured = simulation.measure_ranges(&mut finder, &[7, 999], &mut ranges);
    measured.unwrap();
    let measured = std::mem::take(&mut device.0.lock().unwrap().measured);
    assert_eq!(measured, [vec![3, 7], vec![7, 999]]);
}

/// No others than were set go there, and those that were set together go together.
#[test]
fn constants_are_told_of_the_worlds_that_were_given_them() {
    let device = Noting::default();
    let model = chain(3, Start::Horizontal).unwrap();
    let settings = SimulationSettings::new(1000, 0.004);
    let mut simulation = Simulation::on(&device, model.clone(), settings).unwrap();
    simulation.set_world_model(5, &model).unwrap();
    simulation.try_step(1).unwrap();
    let gravity = [0.0, -9.0, 0.0, 0.0, -8.0, 0.0];
    let given = simulation.set_parameter(Parameter::Gravity, &[900, 2], &gravity);
    given.unwrap();
    simulation.try_step(1).unwrap();
    simulation.try_step(1).unwrap();
    let given = std::mem::take(&mut device.0.lock().unwrap().given);
    assert_eq!(given, [vec![5], vec![2, 900]]);
}

/// New controls change what follows from them, so that all is told anew.
#[test]
fn what_is_known_is_read_again_after_new_controls() {
    let settings = SimulationSettings::new(2, 0.004);
    let device = Noting::default();
    let model = chain(3, Start::Horizontal).unwrap();
    let mut simulation = Simulation::on(&device, model, settings).unwrap();
    let read = || std::mem::take(&mut device.0.lock().unwrap().output).len();
    let motion = [OutputPart::Motion(BodyId(1))];
    let more = [motion[0], OutputPart::Acceleration(BodyId(1))];
    simulation.fetch_parts(motion).unwrap();
    assert_eq!(read(), 1);
    simulation.controls().set_dof_force(0, 0, 1.0).unwrap();
    simulation.fetch_parts(motion).unwrap();
    assert_eq!(read(), 1);
    simulation.fetch_parts(more).unwrap();
    simulation.fetch_parts(motion).unwrap();
    assert_eq!(read(), 1);
}

/// Substeps are looked at when they have been made, as far as that goes, and not before the next ones.
#[test]
fn watching_costs_a_report_a_substep() {
    use SolverKind::{Featherstone, Impulse, Xpbd};
    let (contacts, limits) = ([true, false], [false, true]);
    for solver in [Featherstone, Xpbd, Impulse] {
        for (watched, expected) in [
            (contacts, Report::Contacts),
            (limits, Report::Joints),
            ([true; 2], Report::Contacts),
        ] {
            let device = Noting::default();
            let settings = SimulationSettings {
                solver,
                ..SimulationSettings::new(2, 0.004)
            };
            let model = tower(3, 0.001).unwrap();
            let mut simulation = Simulation::on(&device, model, settings).unwrap();
            let [contacts, limits] = watched;
            simulation.watch(Watch {
                contacts,
                limits,
                ..Watch::default()
            });
            // What there is when watching begins is looked at, too.
            simulation.try_step(1).unwrap();
            device.0.lock().unwrap().reports.clear();
            for _ in 0..3 {
                // New controls may change what follows from them.
                simulation.controls();
                simulation.try_step(1).unwrap();
            }
            let told = std::mem::take(&mut device.0.lock().unwrap().reports);
            assert_eq!(told, [expected; 3], "{solver:?} {watched:?}");
        }
    }
}

/// What touches what follows from shapes that worlds of all models have.
#[test]
fn pairs_and_touch_have_no_constants_of_worlds() {
    let device = Noting::default();
    let model = tower(3, 0.001).unwrap();
    let settings = SimulationSettings {
        solver: SolverKind::Featherstone,
        ..SimulationSettings::new(2, 0.004)
    };
    let mut simulation = Simulation::on(&device, model.clone(), settings).unwrap();
    simulation.set_world_model(1, &model).unwrap();
    let pairs = vec![[ShapeId(0), ShapeId(1)], [ShapeId(2), ShapeId(1)]];
    for (gauge, expected) in [
        (Gauge::Pressing(pairs.clone()), false),
        (Gauge::Overlapping(pairs.clone()), false),
        (Gauge::PairForce(pairs), false),
        (Gauge::Touch(BodyId(0)), false),
        (Gauge::CenterOfMass(None), true),
    ] {
        let mut gauges = simulation.gauges(vec![gauge.clone()]).unwrap();
        simulation.read_gauges(&mut gauges, &[0, 1]).unwrap();
        let own = std::mem::take(&mut device.0.lock().unwrap().own);
        assert_eq!(own, [expected], "{gauge:?}");
    }
}
