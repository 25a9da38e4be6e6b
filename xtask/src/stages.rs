//! Runs named stages in order, times each, and stops at the first that fails.

use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::workshop::Workshop;

/// One thing that must hold.
pub struct Stage {
    pub name: &'static str,
    pub purpose: &'static str,
    pub run: fn(&Workshop) -> Result<()>,
}

/// Runs the stages named, of `stages` and `others` (all of `stages` when none is), then prints how long each took.
pub fn run(stages: &[Stage], others: &[Stage], names: &[&str], workshop: &Workshop) -> Result<()> {
    let mut durations = Vec::new();
    let mut outcome = Ok(());
    for stage in selected(stages, others, names)? {
        println!("\n=== {}: {}", stage.name, stage.purpose);
        let start = Instant::now();
        outcome = (stage.run)(workshop).with_context(|| format!("stage `{}` failed", stage.name));
        durations.push((stage.name, start.elapsed(), outcome.is_ok()));
        if outcome.is_err() {
            break;
        }
    }
    summarise(&durations);
    outcome
}

fn selected<'a>(
    stages: &'a [Stage],
    others: &'a [Stage],
    names: &[&str],
) -> Result<Vec<&'a Stage>> {
    if names.is_empty() {
        return Ok(stages.iter().collect());
    }
    let all = || stages.iter().chain(others);
    if let Some(unknown) = names.iter().find(|name| all().all(|s| s.name != **name)) {
        bail!("no stage is called `{unknown}`; `cargo xtask test --list` names them");
    }
    Ok(all().filter(|s| names.contains(&s.name)).collect())
}

fn summarise(durations: &[(&str, Duration, bool)]) {
    println!("\n{:<12} {:>8}", "stage", "seconds");
    for (name, duration, passed) in durations {
        let verdict = if *passed { "passed" } else { "FAILED" };
        println!("{name:<12} {:>8.1}  {verdict}", duration.as_secs_f64());
    }
    let total: Duration = durations.iter().map(|(_, duration, _)| *duration).sum();
    println!("{:<12} {:>8.1}", "total", total.as_secs_f64());
}
