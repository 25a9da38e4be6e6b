//! What is kept of the first worlds of a run, at regular times.

use crate::error::Error;
use kinetarium::model::{AxisKind, BodyId, Joint, JointKind, Model};
use kinetarium::numbers::Float;
use kinetarium::sim::{Diverged, Outputs};

/// Most numbers that are kept: 4 GB.
const MOST: usize = 1 << 29;

/// States of the first worlds over time. All tables are flat: time, then world, then the row.
#[derive(Debug)]
pub struct Trajectory {
    pub coordinates: Vec<Coordinate>,
    pub dof_names: Vec<String>,
    pub body_names: Vec<String>,
    /// Number of worlds kept.
    pub worlds: usize,
    /// [s], one per row.
    pub time: Vec<f64>,
    pub joint_position: Vec<f64>,
    pub joint_velocity: Vec<f64>,
    /// [m], three per body.
    pub body_position: Vec<f64>,
    /// x, y, z, w per body.
    pub body_orientation: Vec<f64>,
    /// [J], one per world.
    pub kinetic_energy: Vec<f64>,
    /// [J], one per world.
    pub potential_energy: Vec<f64>,
    /// When each world diverged [s]; NaN where it did not.
    pub diverged_at: Vec<f64>,
}

/// A joint coordinate.
#[derive(Debug)]
pub struct Coordinate {
    pub name: String,
    /// `rad`, `m`, or empty for a part of a quaternion.
    pub unit: &'static str,
    /// Whether it tells where in the world a robot is: of a free joint that others hang on.
    pub base: bool,
}

impl Trajectory {
    /// An empty trajectory of so many worlds, to be filled with so many rows.
    pub fn new(model: &Model, worlds: usize, rows: usize) -> Result<Self, Error> {
        let of_world =
            model.coordinates() + model.degrees_of_freedom() + 7 * model.bodies.len() + 2;
        let numbers = 1 + worlds.saturating_mul(of_world);
        if rows.saturating_mul(numbers) > MOST {
            return Err(Error::Large {
                rows,
                numbers,
                most: MOST,
            });
        }
        Ok(Self {
            coordinates: coordinates(model),
            dof_names: model.dof_names().map(str::to_owned).collect(),
            body_names: model.bodies.iter().map(|b| b.name.clone()).collect(),
            worlds,
            time: Vec::with_capacity(rows),
            joint_position: Vec::with_capacity(rows * worlds * model.coordinates()),
            joint_velocity: Vec::with_capacity(rows * worlds * model.degrees_of_freedom()),
            body_position: Vec::with_capacity(rows * worlds * 3 * model.bodies.len()),
            body_orientation: Vec::with_capacity(rows * worlds * 4 * model.bodies.len()),
            kinetic_energy: Vec::with_capacity(rows * worlds),
            potential_energy: Vec::with_capacity(rows * worlds),
            diverged_at: vec![f64::NAN; worlds],
        })
    }

    /// Appends a row.
    pub fn record<T: Float>(&mut self, time: f64, outputs: &Outputs<'_, T>) {
        self.time.push(time);
        for world in 0..self.worlds {
            self.joint_position.extend(outputs.joint_position(world));
            self.joint_velocity.extend(outputs.joint_velocity(world));
            for body in (0..self.body_names.len()).map(BodyId) {
                self.body_position
                    .extend(outputs.body_position(world, body).to_array());
                self.body_orientation
                    .extend(outputs.body_orientation(world, body).to_array());
            }
            self.kinetic_energy.push(outputs.kinetic_energy(world));
            self.potential_energy.push(outputs.potential_energy(world));
        }
    }

    /// Notes when worlds diverged.
    pub fn note(&mut self, diverged: &[Diverged]) {
        for Diverged { world, time } in diverged {
            if let Some(at) = self.diverged_at.get_mut(*world) {
                *at = *time;
            }
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }
    /// Total energy [J], one per world.
    pub fn energy(&self) -> impl Iterator<Item = f64> + '_ {
        self.kinetic_energy
            .iter()
            .zip(&self.potential_energy)
            .map(|(k, p)| k + p)
    }
}

fn coordinates(model: &Model) -> Vec<Coordinate> {
    let in_state = model.joints.iter().filter(|j| !j.closes_loop);
    let units = in_state.flat_map(|joint| {
        let units = match joint.kind {
            JointKind::Ball => vec![""; 4],
            JointKind::Free => vec!["m", "m", "m", "", "", "", ""],
            _ => joint.axes.iter().map(|axis| unit(axis.kind)).collect(),
        };
        units.into_iter().map(|unit| (unit, is_base(model, joint)))
    });
    let named = model.coordinate_names().into_iter().zip(units);
    named
        .map(|(name, (unit, base))| Coordinate { name, unit, base })
        .collect()
}

fn is_base(model: &Model, joint: &Joint) -> bool {
    let carries = |other: &Joint| other.parent == Some(joint.child);
    joint.kind == JointKind::Free && model.joints.iter().any(carries)
}

fn unit(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Linear => "m",
        AxisKind::Angular => "rad",
    }
}
