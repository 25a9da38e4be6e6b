//! A program that steps its own simulation, as fast as a clock goes, while pages watch and steer it.
//!
//! `cargo run --release -p kinetarium-viewer --example watch`, and open the address that it prints.

use session::Shared;
use sim::{Simulation, SimulationSettings};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let settings = SimulationSettings::new(4, 0.002);
    let shared = Shared::new(Simulation::<f64>::new(model::examples::rover()?, settings)?);
    let viewer = kinetarium_viewer::show(&shared, None, None)?;
    println!("{}", viewer.url());
    let start = Instant::now();
    while viewer.is_open() {
        let behind = start.elapsed().as_secs_f64() - shared.read().time(0);
        if behind > 0.0 {
            shared
                .change()
                .step((behind / settings.step.time_step) as usize);
        }
        sleep(Duration::from_millis(5));
    }
    Ok(())
}
