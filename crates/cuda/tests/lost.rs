//! A card that fails is told, and a snapshot goes on. By itself, as all worlds of a process share the card.

use cudarc::driver::{CudaContext, LaunchConfig};
use cudarc::nvrtc::compile_ptx;
use kinetarium_cuda::Cuda;
use model::examples::n_pendula;
use sim::{Device, Simulation, SimulationSettings};

/// A kernel that fails takes all with it that the process has on the card.
fn lose() {
    let text = r#"extern "C" __global__ void fail() { __trap(); }"#;
    let context = CudaContext::new(0).unwrap();
    let module = context.load_module(compile_ptx(text).unwrap()).unwrap();
    let fail = module.load_function("fail").unwrap();
    let stream = context.default_stream();
    let mut launch = stream.launch_builder(&fail);
    // Safety: it has no parameters.
    let launched = unsafe { launch.launch(LaunchConfig::for_num_elems(1)) };
    assert!(launched.and(stream.synchronize()).is_err());
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_card_that_is_lost_is_told_and_a_snapshot_goes_on() {
    let card = Cuda::open(0).unwrap();
    let (model, settings) = (n_pendula(3).unwrap(), SimulationSettings::new(4, 0.002));
    let mut simulation = Simulation::on(&card, model.clone(), settings).unwrap();
    simulation.step(50);
    let kept = simulation.snapshot();
    lose();
    for _ in 0..2 {
        let told = simulation.try_step(1).unwrap_err().to_string();
        let remedy = "go back to a snapshot on the device cpu, or in a new process";
        let named = told.contains(card.name()) && told.contains(remedy);
        assert!(named, "{told}");
    }
    assert!(card.has_failed());
    assert!(Simulation::on(&card, model.clone(), settings).is_err());
    let solver = settings.solver.pick_on(&card, &model, settings.contacts);
    let settings = SimulationSettings { solver, ..settings };
    let mut again = Simulation::<f32>::new(model, settings).unwrap();
    again.restore(&kept).unwrap();
    again.step(50);
    assert!(again.diverged().is_empty());
}
