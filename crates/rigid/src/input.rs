//! What a controller tells every solver, in one layout.

use numbers::Table;
use numbers::machine::space::Input;

/// Where the controls of a world lie. All are per degree of freedom, but the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputTables {
    /// Generalised force [N or N·m].
    pub force: Table<Input>,
    /// Position target of the drive [m or rad].
    pub target_position: Table<Input>,
    /// Velocity target of the drive [m/s or rad/s].
    pub target_velocity: Table<Input>,
    /// Control of each actuator.
    pub control: Table<Input>,
    /// Numbers per world.
    pub length: usize,
}

impl InputTables {
    /// The layout for a model.
    pub fn new(model: &model::Model) -> Self {
        let n = model.degrees_of_freedom();
        let mut end = 0;
        let force = Table::place(&mut end, n);
        let target_position = Table::place(&mut end, n);
        let target_velocity = Table::place(&mut end, n);
        let control = Table::place(&mut end, model.actuators.len());
        Self {
            force,
            target_position,
            target_velocity,
            control,
            length: end,
        }
    }
    /// Number of degrees of freedom.
    pub fn dofs(&self) -> usize {
        self.target_position.start() - self.force.start()
    }
    /// The model's own targets, and no force or control.
    pub fn initial(&self, model: &model::Model) -> Vec<f64> {
        let mut input = vec![0.0; self.length];
        let dofs = model
            .joints
            .iter()
            .filter(|j| !j.closes_loop)
            .flat_map(|j| &j.dofs);
        for (i, dof) in dofs.enumerate() {
            input[self.target_position.at(i, 0)] = dof.drive.target_position;
            input[self.target_velocity.at(i, 0)] = dof.drive.target_velocity;
        }
        input
    }
}
