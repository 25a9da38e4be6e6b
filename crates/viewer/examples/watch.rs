//! A program that steps its own simulation, as fast as a clock goes, while pages watch and steer it.
//!
//! `cargo run --release -p kinetarium-viewer --example watch -- 600`, and open the address that it prints. It goes on
//! for so many seconds; 5, if none are given.

use session::Shared;
use sim::{Simulation, SimulationSettings};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds = match std::env::args().nth(1) {
        Some(seconds) => seconds.parse()?,
        None => 5.0,
    };
    let settings = SimulationSettings::new(4, 0.002);
    let shared = Shared::new(Simulation::<f64>::new(model::examples::rover()?, settings)?);
    let viewer = kinetarium_viewer::show(&shared, None, None)?;
    println!("{}", viewer.url());
    let start = Instant::now();
    while viewer.is_open() && start.elapsed().as_secs_f64() < seconds {
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
