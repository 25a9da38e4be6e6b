//! What a controller may set, per world.

use crate::Control;
use crate::error::{MOST_FORCE, MOST_MOTION, SimulationError, bounded, index, length};
use crate::outputs::existing;
use numbers::machine::space::Input;
use numbers::{Float, Memory, Table};
use rigid::InputTables;
use std::ops::Range;

/// The controls of all worlds. Values hold until they are set again.
///
/// Every setter refuses an index out of range, an array of the wrong length,
/// numbers that are not finite, targets beyond ±1e9 and other numbers beyond ±1e30.
#[derive(Debug)]
pub struct Controls<'a, T> {
    pub(crate) memory: &'a mut Memory<T>,
    pub(crate) tables: &'a InputTables,
    /// What was set, for devices to be told.
    pub(crate) changes: &'a mut Changes,
    /// Whether others set them on a device, so that there they may not be what they are here.
    pub(crate) shared: bool,
}

/// The offsets that were set, as few ranges as they are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Changes(Vec<Range<usize>>);

impl Changes {
    pub fn include(&mut self, offsets: Range<usize>) {
        let known = |range: &Range<usize>| range.start <= offsets.start && offsets.end <= range.end;
        if offsets.is_empty() || self.0.iter().any(known) {
            return;
        }
        let mut all = offsets;
        self.0.retain(|range| {
            let apart = range.end < all.start || all.end < range.start;
            if !apart {
                all = all.start.min(range.start)..all.end.max(range.end);
            }
            apart
        });
        self.0.push(all);
    }
    /// The offsets, which are then told.
    pub fn take(&mut self) -> Vec<Range<usize>> {
        std::mem::take(&mut self.0)
    }
}

/// The controls of all worlds, to be read.
///
/// Panics where a world, degree of freedom or actuator does not exist, as an array would.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a, T> {
    pub(crate) memory: &'a Memory<T>,
    pub(crate) tables: &'a InputTables,
}

impl<T: Float> Inputs<'_, T> {
    /// Generalised force of a degree of freedom [N or N·m].
    pub fn force(&self, world: usize, dof: usize) -> f64 {
        self.of_dof(self.tables.force, world, dof)
    }
    /// Position target of a degree of freedom's drive [m or rad].
    pub fn target(&self, world: usize, dof: usize) -> f64 {
        self.of_dof(self.tables.target_position, world, dof)
    }
    /// Velocity target of a degree of freedom's drive [m/s or rad/s].
    pub fn target_velocity(&self, world: usize, dof: usize) -> f64 {
        self.of_dof(self.tables.target_velocity, world, dof)
    }
    /// Control of an actuator.
    pub fn control(&self, world: usize, actuator: usize) -> f64 {
        let (table, end) = (self.tables.control, self.tables.length);
        let row = existing("actuator", actuator, end - table.start());
        self.number(table, world, row)
    }
    fn of_dof(&self, table: Table<Input>, world: usize, dof: usize) -> f64 {
        let row = existing("degree of freedom", dof, self.tables.dofs());
        self.number(table, world, row)
    }
    fn number(&self, table: Table<Input>, world: usize, row: usize) -> f64 {
        let world = existing("world", world, self.memory.worlds());
        self.memory.get(world, table.at(row, 0)).to_f64()
    }
}

impl<T: Float> Controls<'_, T> {
    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.memory.worlds()
    }
    /// Generalised forces of a world's degrees of freedom [N or N·m].
    pub fn set_force(&mut self, world: usize, force: &[f64]) -> Result<(), SimulationError> {
        self.set_row("force", self.tables.force, self.dofs(), world, force)
    }
    /// Generalised force of one degree of freedom [N or N·m].
    pub fn set_dof_force(
        &mut self,
        world: usize,
        dof: usize,
        x: f64,
    ) -> Result<(), SimulationError> {
        index("degree of freedom", dof, self.dofs())?;
        self.set("force", self.tables.force, world, dof, x, MOST_FORCE)
    }
    /// Position target of one degree of freedom's drive [m or rad].
    pub fn set_target(&mut self, world: usize, dof: usize, x: f64) -> Result<(), SimulationError> {
        index("degree of freedom", dof, self.dofs())?;
        self.set(
            "target position",
            self.tables.target_position,
            world,
            dof,
            x,
            MOST_MOTION,
        )
    }
    /// Position target of one angular degree of freedom's drive, in degrees.
    pub fn set_target_degrees(
        &mut self,
        world: usize,
        dof: usize,
        degrees: f64,
    ) -> Result<(), SimulationError> {
        self.set_target(world, dof, degrees.to_radians())
    }
    /// Velocity target of one degree of freedom's drive [m/s or rad/s].
    pub fn set_target_velocity(
        &mut self,
        world: usize,
        dof: usize,
        x: f64,
    ) -> Result<(), SimulationError> {
        index("degree of freedom", dof, self.dofs())?;
        self.set(
            "target velocity",
            self.tables.target_velocity,
            world,
            dof,
            x,
            MOST_MOTION,
        )
    }
    /// Controls of a world's actuators, in the model's order.
    pub fn set_control(&mut self, world: usize, control: &[f64]) -> Result<(), SimulationError> {
        let n = self.count(Control::Actuator);
        self.set_row("control", self.tables.control, n, world, control)
    }
    /// All numbers of a world's controls, in the order force, target position,
    /// target velocity, actuator control.
    pub fn of_world(&self, world: usize) -> Result<Vec<f64>, SimulationError> {
        index("world", world, self.worlds())?;
        Ok((0..self.tables.length)
            .map(|i| self.memory.get(world, i).to_f64())
            .collect())
    }
    /// Sets what [`of_world`](Controls::of_world) gave.
    pub fn set_world(&mut self, world: usize, numbers: &[f64]) -> Result<(), SimulationError> {
        index("world", world, self.worlds())?;
        length("controls of a world", numbers.len(), self.tables.length)?;
        bounded("controls of a world", numbers, MOST_FORCE)?;
        let targets = self.tables.target_position.start()..self.tables.control.start();
        bounded("targets of a world", &numbers[targets], MOST_MOTION)?;
        for (i, &x) in numbers.iter().enumerate() {
            self.put(world, i, T::from_f64(x));
        }
        Ok(())
    }

    /// Sets a number if it is another, or may be.
    pub(crate) fn put(&mut self, world: usize, offset: usize, x: T) {
        if self.shared || self.memory.get(world, offset) != x {
            self.memory.set(world, offset, x);
            self.changes.include(offset..offset + 1);
        }
    }
    fn dofs(&self) -> usize {
        self.tables.target_position.start() - self.tables.force.start()
    }
    fn set(
        &mut self,
        what: &'static str,
        table: Table<Input>,
        world: usize,
        row: usize,
        x: f64,
        most: f64,
    ) -> Result<(), SimulationError> {
        index("world", world, self.worlds())?;
        bounded(what, &[x], most)?;
        self.put(world, table.at(row, 0), T::from_f64(x));
        Ok(())
    }
    fn set_row(
        &mut self,
        what: &'static str,
        table: Table<Input>,
        n: usize,
        world: usize,
        x: &[f64],
    ) -> Result<(), SimulationError> {
        index("world", world, self.worlds())?;
        length(what, x.len(), n)?;
        bounded(what, x, MOST_FORCE)?;
        for (row, &x) in x.iter().enumerate() {
            self.put(world, table.at(row, 0), T::from_f64(x));
        }
        Ok(())
    }
}
