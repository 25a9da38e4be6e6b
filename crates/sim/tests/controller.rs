//! Controllers are called when they should be, and their recordings play back to the bit.

use kinetarium_sim::{
    Controller, Controls, Outputs, Recorder, Replay, Simulation, SimulationError,
    SimulationSettings, Snapshot,
};
use model::examples::n_pendula;

const WORLDS: usize = 19;
const TIME_STEP: f64 = 0.002;

fn pendula(worlds: usize) -> Simulation<f32> {
    let model = n_pendula(3).unwrap();
    Simulation::new(model, SimulationSettings::new(worlds, TIME_STEP)).unwrap()
}

/// Pushes against the motion, differently in each world.
struct Brake;

impl Controller<f32> for Brake {
    fn control(
        &mut self,
        time: f64,
        outputs: &Outputs<'_, f32>,
        controls: &mut Controls<'_, f32>,
    ) -> Result<(), SimulationError> {
        for world in 0..outputs.worlds() {
            let gain = 0.1 * world as f64 + time;
            let force: Vec<f64> = outputs
                .joint_velocity(world)
                .iter()
                .map(|v| -gain * v)
                .collect();
            controls.set_force(world, &force)?;
        }
        Ok(())
    }
}

fn positions(simulation: &mut Simulation<f32>) -> Vec<Vec<f64>> {
    let outputs = simulation.outputs();
    (0..outputs.worlds())
        .map(|w| outputs.joint_position(w))
        .collect()
}

#[test]
fn the_controller_is_called_first_and_then_every_period() {
    let mut simulation = pendula(1);
    let mut times = Vec::new();
    let mut clock = |time: f64, _: &Outputs<'_, f32>, _: &mut Controls<'_, f32>| {
        times.push(time);
        Ok(())
    };
    simulation.run(0.025, 0.01, &mut clock).unwrap();
    assert!(
        (simulation.time(0) - 0.026).abs() < 1e-12,
        "0.025 s are 12.5 steps, so 13"
    );
    let expected = [0.0, 0.01, 0.02];
    assert_eq!(times.len(), expected.len());
    assert!(
        times
            .iter()
            .zip(expected)
            .all(|(t, e)| (t - e).abs() < 1e-12),
        "{times:?}"
    );
}

#[test]
fn a_replay_repeats_all_worlds_to_the_bit() {
    let mut first = pendula(WORLDS);
    let mut recorder = Recorder::new(Brake);
    first.run(0.5, 0.01, &mut recorder).unwrap();
    let recording = recorder.into_recording();
    assert_eq!(recording.times().count(), 50);

    let mut second = pendula(WORLDS);
    second.run(0.5, 0.01, &mut Replay::new(recording)).unwrap();
    let (first, second) = (positions(&mut first), positions(&mut second));
    assert_eq!(first, second);
    assert_ne!(first[1], first[2], "the worlds were driven differently");

    let mut free = pendula(WORLDS);
    free.step(250);
    assert_ne!(positions(&mut free), first, "the controller acted");
}

/// Where a controller leads in so many runs of so many seconds, before each of which all worlds are reset.
fn episodes(count: usize, seconds: f64, controller: &mut impl Controller<f32>) -> Vec<Snapshot> {
    let mut simulation = pendula(WORLDS);
    let episode = |_| {
        simulation.reset_all();
        simulation.run(seconds, 0.01, controller).unwrap();
        simulation.snapshot()
    };
    (0..count).map(episode).collect()
}

/// Of ten calls each, and of a single one, at time 0.
#[test]
fn a_replay_plays_one_episode_after_the_other() {
    for seconds in [0.1, 0.01] {
        let mut calls = 0;
        let harder = |_: f64, _: &Outputs<'_, f32>, controls: &mut Controls<'_, f32>| {
            calls += 1;
            let force = |world| 0.01 * f64::from(calls) * world as f64;
            (0..controls.worlds()).try_for_each(|w| controls.set_dof_force(w, 0, force(w)))
        };
        let mut recorder = Recorder::new(harder);
        let recorded = episodes(2, seconds, &mut recorder);
        assert!(recorded[0] != recorded[1], "the episodes differ");
        let mut replay = Replay::new(recorder.into_recording());
        let played = episodes(4, seconds, &mut replay);
        let expected = [&recorded[..]; 2].concat();
        assert!(played == expected, "after the last comes the first again");
    }
}

#[test]
fn a_replay_of_one_run_starts_over() {
    let mut recorder = Recorder::new(Brake);
    let recorded = episodes(1, 0.1, &mut recorder);
    let mut replay = Replay::new(recorder.into_recording());
    let played = episodes(2, 0.1, &mut replay);
    assert!(played == [&recorded[..]; 2].concat());
}

#[test]
fn a_replay_refuses_another_number_of_worlds() {
    let mut recorder = Recorder::new(Brake);
    pendula(4).run(0.02, 0.01, &mut recorder).unwrap();
    let mut replay = Replay::new(recorder.into_recording());
    let error = pendula(5).run(0.02, 0.01, &mut replay).unwrap_err();
    assert_eq!(
        error.to_string(),
        "recording has 36 numbers, but the model needs 45"
    );
}

#[test]
fn periods_and_times_that_make_no_sense_are_refused() {
    let refused = |seconds: f64, period: f64| {
        let mut simulation = pendula(1);
        let error = simulation.run(seconds, period, &mut Brake).unwrap_err();
        assert_eq!(simulation.time(0), 0.0);
        error.to_string()
    };
    let steps = "it must be at least one time step, and finite";
    assert_eq!(refused(0.0, 0.01), format!("run time [s] is 0: {steps}"));
    assert_eq!(
        refused(f64::NAN, 0.01),
        format!("run time [s] is NaN: {steps}")
    );
    assert_eq!(
        refused(1.0, -0.01),
        format!("control period [s] is -0.01: {steps}")
    );
    assert_eq!(
        refused(1.0, f64::INFINITY),
        format!("control period [s] is inf: {steps}")
    );
    let whole = "it must be a whole number of time steps";
    assert_eq!(
        refused(1.0, 0.005),
        format!("control period [s] is 0.005: {whole}")
    );
}

#[test]
fn an_error_of_the_controller_ends_the_run() {
    let mut simulation = pendula(2);
    let mut wrong = |time: f64, _: &Outputs<'_, f32>, controls: &mut Controls<'_, f32>| {
        if time > 0.015 {
            controls.set_dof_force(0, 7, 1.0)
        } else {
            Ok(())
        }
    };
    let error = simulation.run(1.0, 0.01, &mut wrong).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("degree of freedom 7 does not exist"),
        "{error}"
    );
    assert!((simulation.time(0) - 0.02).abs() < 1e-12);
}
