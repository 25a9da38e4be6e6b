//! Filling the tables that a solver's kernels read.

use glam::{DMat3, DQuat, DVec3};
use model::{Actuator, Dof, Pose};
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::Parameter;

/// Parameters and links of a solver, written field by field.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Filler {
    pub parameters: Vec<f64>,
    pub links: Vec<u32>,
}

impl Filler {
    pub fn new(parameters: usize, links: usize) -> Self {
        Self {
            parameters: vec![0.0; parameters],
            links: vec![0; links],
        }
    }
    pub fn number<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        x: f64,
    ) {
        self.parameters[table.at(row, field)] = x;
    }
    pub fn numbers<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        x: &[f64],
    ) {
        self.parameters[table.at(row, field)..][..x.len()].copy_from_slice(x);
    }
    pub fn vec3<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        v: DVec3,
    ) {
        self.numbers(table, row, field, &v.to_array());
    }
    pub fn quat<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        q: DQuat,
    ) {
        self.numbers(table, row, field, &q.to_array());
    }
    /// Seven fields: position, orientation.
    pub fn pose<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        p: Pose,
    ) {
        self.vec3(table, row, field, p.position);
        self.quat(table, row, field + 3, p.orientation);
    }
    /// Six fields: xx, yy, zz, xy, xz, yz.
    pub fn sym<const W: usize>(
        &mut self,
        table: Table<Parameter, W>,
        row: usize,
        field: usize,
        m: DMat3,
    ) {
        let x = [
            m.x_axis.x, m.y_axis.y, m.z_axis.z, m.y_axis.x, m.z_axis.x, m.z_axis.y,
        ];
        self.numbers(table, row, field, &x);
    }
    pub fn link<const W: usize>(&mut self, links: Links<W>, row: usize, field: usize, x: usize) {
        self.links[links.at(row, field)] = x as u32;
    }
}

/// No bound, but a finite number: infinities have no place in a shader.
pub(crate) const UNBOUNDED: f64 = 1e30;

/// A bound, kept finite.
pub(crate) fn bounded(x: f64) -> f64 {
    x.min(UNBOUNDED)
}

/// Gear, gain, bias 3, control range 2, force range 2.
pub(crate) fn actuator_numbers(a: &Actuator) -> [f64; 9] {
    let all = (-UNBOUNDED, UNBOUNDED);
    let (c, r) = (a.control_range.unwrap_or(all), a.force_range.unwrap_or(all));
    let [b0, b1, b2] = a.bias;
    [a.gear, a.gain, b0, b1, b2, c.0, c.1, r.0, r.1]
}

/// Initial target of a ball's drive, as a quaternion x, y, z, w.
pub(crate) fn ball_target(dofs: &[Dof]) -> [f64; 4] {
    let r = [0, 1, 2].map(|i| dofs[i].drive.target_position);
    DQuat::from_scaled_axis(DVec3::from_array(r)).to_array()
}

/// The frame whose first columns are the given directions, made orthonormal.
pub(crate) fn frame(directions: &[DVec3]) -> DQuat {
    let Some(&x) = directions.first() else {
        return DQuat::IDENTITY;
    };
    let y = match directions.get(1) {
        Some(&d) if d.cross(x).length() > 1e-6 => (d - x * d.dot(x)).normalize(),
        _ => x.any_orthonormal_vector(),
    };
    DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)))
}
