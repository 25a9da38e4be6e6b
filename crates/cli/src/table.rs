//! Trajectories as comma-separated values: one row per time and world.

use crate::trajectory::Trajectory;
use std::io::Write;

/// Writes a trajectory, with a line of names before it.
pub fn write(trajectory: &Trajectory, file: impl Write) -> csv::Result<()> {
    let mut table = csv::Writer::from_writer(file);
    table.write_record(columns(trajectory))?;
    for row in 0..trajectory.rows() * trajectory.worlds {
        table.write_record(cells(trajectory, row))?;
    }
    Ok(table.flush()?)
}

fn columns(t: &Trajectory) -> Vec<String> {
    let first = [
        "time",
        "world",
        "energy",
        "kinetic_energy",
        "potential_energy",
    ];
    let mut columns = first.map(str::to_owned).to_vec();
    columns.extend(t.coordinates.iter().map(|c| format!("position.{}", c.name)));
    columns.extend(t.dof_names.iter().map(|name| format!("velocity.{name}")));
    for body in &t.body_names {
        columns
            .extend(["x", "y", "z", "qx", "qy", "qz", "qw"].map(|part| format!("{body}.{part}")));
    }
    columns
}

/// The cells of a row, which are counted over times and worlds.
fn cells(t: &Trajectory, row: usize) -> Vec<String> {
    let of_row = |table: &[f64], n: usize| table[row * n..][..n].to_vec();
    let (kinetic, potential) = (t.kinetic_energy[row], t.potential_energy[row]);
    let mut numbers = vec![kinetic + potential, kinetic, potential];
    numbers.extend(of_row(&t.joint_position, t.coordinates.len()));
    numbers.extend(of_row(&t.joint_velocity, t.dof_names.len()));
    for body in row * t.body_names.len()..(row + 1) * t.body_names.len() {
        numbers.extend(&t.body_position[3 * body..][..3]);
        numbers.extend(&t.body_orientation[4 * body..][..4]);
    }
    let (time, world) = (t.time[row / t.worlds], row % t.worlds);
    let first = [time.to_string(), world.to_string()];
    first
        .into_iter()
        .chain(numbers.iter().map(f64::to_string))
        .collect()
}
