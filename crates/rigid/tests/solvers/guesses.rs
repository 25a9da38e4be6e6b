//! Which stops push, and how much joints rub, is found by passes that begin with a guess.

use crate::run::Run;
use crate::scene::mixed;
use kinetarium_rigid::{Featherstone, Kernels, Settings};
use model::Model;

/// How far apart speeds are [m/s or rad/s], at most, after a step that begins with the accelerations of the step before as
/// its guess and one that begins with none.
fn apart(model: &Model) -> f64 {
    let run = || {
        let kernels = Featherstone::new(model, &Settings::new(0.002)).unwrap();
        Run::of(kernels, model, &vec![0.0; model.degrees_of_freedom()])
    };
    let (mut run, mut other) = (run(), run());
    let (q, v) = (run.kernels.position_table(), run.kernels.velocity_table());
    let (coordinates, dofs) = (model.coordinates(), model.degrees_of_freedom());
    let mut most = 0.0_f64;
    for step in 0..500 {
        let state = run.world.state.clone();
        let (position, velocity) = (
            &state[q.start()..][..coordinates],
            &state[v.start()..][..dofs],
        );
        let fresh = &mut other.world.state;
        fresh.clone_from(&state);
        other.kernels.place(position, velocity, fresh);
        assert!(step == 0 || *fresh != state, "nothing is guessed");
        run.step(1);
        other.step(1);
        let speeds = |run: &Run<Featherstone>| run.world.state[v.start()..][..dofs].to_vec();
        let both = speeds(&run).into_iter().zip(speeds(&other));
        most = both.map(|(a, b)| (a - b).abs()).fold(most, f64::max);
    }
    most
}

/// The guess goes by the accelerations of the step before, and no motion does.
#[test]
fn motion_does_not_depend_on_the_guess() {
    let model = mixed(true).unwrap();
    // Passes find friction to 0.1 % of 0.1 N·m, which in 2 ms gives some 10⁻³ kg·m² a speed of 2e-4 rad/s.
    let rubbing = apart(&model);
    assert!(rubbing < 2e-4, "{rubbing:e}");
    let mut parts = model.into_parts();
    let dofs = parts.joints.iter_mut().flat_map(|joint| &mut joint.dofs);
    dofs.for_each(|dof| dof.friction_loss = 0.0);
    let smooth = apart(&Model::new(parts).unwrap());
    assert!(smooth < 1e-10, "{smooth:e}");
}
