//! One time step, linearised at the present state of a world.
//!
//! With x the state of the joints, u the controls and F one whole time step, all its substeps included,
//! x' = F(x, u), this is A = ∂F/∂x and B = ∂F/∂u. Each direction goes through the step as the ε part of
//! dual numbers (Griewank & Walther, *Evaluating Derivatives*, 2nd ed. 2008, chapter 3), so that columns
//! are exact to rounding. Coordinates and conventions are those of MuJoCo's `mjd_transitionFD`, which
//! takes differences: see [`Linearization`].

use crate::LinearizeError;
use crate::jobs::{Direction, Layout, World};
use crate::tangent::{Coordinate, coordinates};
use model::Model;
use numbers::dispatch::Isa;
use numbers::machine::space::Input;
use numbers::{Float, Table};
use rigid::{
    ArticulatedBodies, Featherstone, InputTables, Kernels, Settings, TouchingFeatherstone,
};
use sim::{Simulation, WorldNumbers};
use std::ops::Range;

/// The derivatives of one time step.
///
/// The state is x = (δq, q̇), 2·`dofs` numbers, both in the model's order of degrees of freedom. δq is a
/// change in tangent space: [m] or [rad] along axes; for orientations a rotation vector [rad] in the
/// child's joint axes, as angular velocities are; of a free joint the change of position [m] in the
/// parent's joint axes, then that rotation vector. Rows are the state after the step, columns what it
/// is differentiated with respect to. Matrices are row-major: the entry of row i and column j of an
/// m × n matrix is at i·n + j.
///
/// What is held constant is all else that a world carries from step to step: drive targets as far as
/// they are smoothed (`control_time`), and the forces of the last step's contacts, from which those of
/// this one are iterated.
#[derive(Clone, Debug, PartialEq)]
pub struct Linearization {
    /// Degrees of freedom, n.
    pub dofs: usize,
    /// Actuators, m.
    pub controls: usize,
    /// A = ∂x'/∂x, 2n × 2n.
    pub state: Vec<f64>,
    /// B = ∂x'/∂u, 2n × m; u are the controls of the actuators. Zero where a control or force is
    /// beyond its range.
    pub control: Vec<f64>,
    /// ∂x'/∂τ, 2n × n; τ are the generalised forces [N or N·m].
    pub force: Vec<f64>,
    /// ∂x' by the position targets of drives [m or rad], 2n × n; zero columns where there is no drive.
    pub target_position: Vec<f64>,
    /// ∂x' by the velocity targets of drives [m/s or rad/s], 2n × n; zero columns where there is no drive.
    pub target_velocity: Vec<f64>,
}

/// Linearises one time step of a world at its present state and controls, in double precision.
///
/// Exact for the step that the simulation takes, with its integrator and all its substeps. A simulation in
/// `f32` is linearised at its state, but in `f64`: as if it stepped in that.
///
/// Where a law has a kink the derivative is that of the side taken: limits, ranges of controls and forces,
/// contacts. A contact that the step makes, keeps, breaks, or lets slide is taken as it is in this step;
/// nothing is known beyond. Where contacts are iterated, it is the derivative of the passes made.
///
/// It takes a run through the step for every eight columns (for every one, where the instruction set is
/// `portable`).
///
/// # Errors
/// A world that does not exist or has diverged, or diverges in this step; a solver other than
/// `featherstone`.
pub fn linearize<T: Float>(
    simulation: &mut Simulation<T>,
    world: usize,
) -> Result<Linearization, LinearizeError> {
    let numbers = simulation.numbers_of_world(world)?;
    let step = Step {
        world,
        model: simulation.model(),
        settings: &simulation.settings().step,
        isa: simulation.isa(),
        numbers,
    };
    if let Some(kernels) = simulation.kernels(world)? {
        step.apart(kernels)
    } else if let Some(kernels) = simulation.kernels(world)? {
        step.touching(kernels)
    } else {
        let solver = simulation.solver();
        Err(LinearizeError::Solver { solver })
    }
}

/// A step to be linearised. What it does is not generic, so that its kernels are compiled here, and not
/// wherever it is asked for.
struct Step<'a> {
    world: usize,
    model: &'a Model,
    settings: &'a Settings,
    isa: Isa,
    numbers: WorldNumbers,
}

impl Step<'_> {
    /// Of what touches nothing.
    fn apart(&self, kernels: &Featherstone) -> Result<Linearization, LinearizeError> {
        self.linearize(kernels, World::<false>::step)
    }
    fn touching(&self, kernels: &TouchingFeatherstone) -> Result<Linearization, LinearizeError> {
        self.linearize(kernels, World::<true>::step)
    }
    fn linearize<const CONTACTS: bool>(
        &self,
        kernels: &ArticulatedBodies<CONTACTS>,
        substep: fn(&mut World<CONTACTS>, &ArticulatedBodies<CONTACTS>),
    ) -> Result<Linearization, LinearizeError> {
        let layout = Layout {
            position: kernels.position_table().start(),
            velocity: kernels.velocity_table().start(),
            coordinates: coordinates(self.model),
            alive: kernels.alive(),
        };
        let world = self.world;
        if self.numbers.state[layout.alive] == 0.0 {
            return Err(LinearizeError::Diverged { world });
        }
        let variables = Variables::new(self.model);
        let directions = variables.directions(self.model, &layout, &self.numbers);
        let mut columns = Columns::new(2 * layout.coordinates.len(), variables.count());
        let mut dual = World::<CONTACTS>::new(self.isa, kernels.lengths());
        for directions in directions.chunks(dual.directions()) {
            dual.begin(&self.numbers, directions);
            for _ in 0..self.settings.substeps {
                substep(&mut dual, kernels);
            }
            let Some(rows) = dual.end(&layout) else {
                let limit = self.settings.speed_limit;
                return Err(LinearizeError::Diverges { world, limit });
            };
            columns.write(directions, rows.chunks(dual.directions()));
        }
        Ok(variables.divide(&columns))
    }
}

/// What a step is differentiated with respect to, by the ranges of their columns.
struct Variables {
    position: Range<usize>,
    velocity: Range<usize>,
    control: Range<usize>,
    force: Range<usize>,
    target_position: Range<usize>,
    target_velocity: Range<usize>,
}

impl Variables {
    fn new(model: &Model) -> Self {
        let (n, m) = (model.degrees_of_freedom(), model.actuators.len());
        let mut end = 0;
        let mut next = |count| {
            let start = end;
            end += count;
            start..end
        };
        Self {
            position: next(n),
            velocity: next(n),
            control: next(m),
            force: next(n),
            target_position: next(n),
            target_velocity: next(n),
        }
    }
    fn count(&self) -> usize {
        self.target_velocity.end
    }

    /// The directions whose columns need not be zero.
    fn directions(&self, model: &Model, layout: &Layout, numbers: &WorldNumbers) -> Vec<Direction> {
        let position = &numbers.state[layout.position..];
        let place = |(column, coordinate): (usize, &Coordinate)| {
            let seeds = coordinate.seeds(position).into_iter();
            let seeds = seeds.map(|(row, x)| (layout.position + row, x)).collect();
            Direction::of_state(column, seeds)
        };
        let speed = |(v, column)| Direction::of_state(column, vec![(layout.velocity + v, 1.0)]);
        let input = InputTables::new(model);
        let rows = |columns: &Range<usize>, table: Table<Input>| {
            let numbered = columns.clone().enumerate();
            numbered.map(move |(i, column)| Direction::of_input(column, table.at(i, 0)))
        };
        let driven = |columns: &Range<usize>, table| {
            let drives = rows(columns, table).zip(has_drive(model));
            drives.filter_map(|(target, driven)| driven.then_some(target))
        };
        let places = self.position.clone().zip(&layout.coordinates).map(place);
        let speeds = self.velocity.clone().enumerate().map(speed);
        places
            .chain(speeds)
            .chain(rows(&self.control, input.control))
            .chain(rows(&self.force, input.force))
            .chain(driven(&self.target_position, input.target_position))
            .chain(driven(&self.target_velocity, input.target_velocity))
            .collect()
    }

    /// The matrices, cut out of the columns of all.
    fn divide(&self, columns: &Columns) -> Linearization {
        Linearization {
            dofs: self.position.len(),
            controls: self.control.len(),
            state: columns.cut(self.position.start..self.velocity.end),
            control: columns.cut(self.control.clone()),
            force: columns.cut(self.force.clone()),
            target_position: columns.cut(self.target_position.clone()),
            target_velocity: columns.cut(self.target_velocity.clone()),
        }
    }
}

/// Which degrees of freedom have a drive.
fn has_drive(model: &Model) -> impl Iterator<Item = bool> {
    let carrying = model.joints.iter().filter(|j| !j.closes_loop);
    let drives = carrying.flat_map(|j| &j.dofs).map(|dof| &dof.drive);
    drives.map(|drive| drive.stiffness != 0.0 || drive.damping != 0.0)
}

/// A matrix, row-major.
struct Columns {
    count: usize,
    numbers: Vec<f64>,
}

impl Columns {
    fn new(rows: usize, count: usize) -> Self {
        Self {
            count,
            numbers: vec![0.0; rows * count],
        }
    }
    /// Writes what stands side by side in each row to the columns of these directions.
    fn write<'a>(&mut self, directions: &[Direction], rows: impl Iterator<Item = &'a [f64]>) {
        for (row, lanes) in self.numbers.chunks_exact_mut(self.count).zip(rows) {
            for (direction, &x) in directions.iter().zip(lanes) {
                row[direction.column] = x;
            }
        }
    }
    /// These columns alone.
    fn cut(&self, columns: Range<usize>) -> Vec<f64> {
        let rows = self.numbers.chunks_exact(self.count.max(1));
        rows.flat_map(|row| row[columns.clone()].iter().copied())
            .collect()
    }
}
