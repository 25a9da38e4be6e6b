//! How a stage is simulated: the form that a page shows of it.

use crate::SessionError;
use crate::card::{Card, PROCESSOR, RUNS_ON};
use crate::form::Form;
use crate::protocol::{Field, Values};
use crate::stage::Stage;
use model::{Model, Parts};
use numbers::Float;
use sim::{Simulation, SimulationSettings, SolverKind};

/// Solvers, in the order in which the form names them.
const SOLVERS: [SolverKind; 4] = [
    SolverKind::Auto,
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// The parameters of a simulation that do not change its model's structure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Physics {
    form: Form,
}

impl Physics {
    /// Those of a stage that a card may simulate.
    pub fn new<T: Float>(stage: &Stage, card: &Card<T>) -> Self {
        let solver = SOLVERS.iter().position(|&s| s == stage.solver).unwrap_or(0);
        let names = SOLVERS.map(SolverKind::name);
        let substeps = stage.substeps(stage.solver);
        let model = &stage.model;
        let down = -model.gravity.dot(model.up_axis.direction());
        let mut fields = vec![
            Field::choice("solver", "Solver", solver, &names).help(
                "Which solver advances the state; auto picks by the model. A change starts again.",
            ),
            Field::logarithmic("time_step", "Time step", "s", model.time_step, [1e-5, 0.1])
                .help("Time from one state to the next. Shorter is more accurate, and slower."),
            Field::integer("substeps", "Substeps", substeps, [1, 100])
                .help("Into how many parts each time step is cut."),
            Field::number("gravity", "Gravity", "m/s²", down, [-30.0, 30.0])
                .help("Acceleration downwards: 9.81 on the Earth, 1.62 on the Moon."),
            Field::flag("contacts", "Contacts", true)
                .help("Whether shapes touch; otherwise bodies pass through each other. A change starts again."),
        ];
        fields.extend(card.field());
        Self {
            form: Form::new(fields),
        }
    }
    /// None: a program has chosen them.
    pub fn of_program() -> Self {
        Self {
            form: Form::new(Vec::new()),
        }
    }
    /// The same with other values.
    pub fn with(self, values: &Values) -> Result<Self, SessionError> {
        Ok(Self {
            form: self.form.with(values)?,
        })
    }
    pub fn fields(&self) -> &[Field] {
        self.form.fields()
    }
    /// Length of a time step [s].
    pub fn time_step(&self) -> f64 {
        self.form.number("time_step")
    }
    /// What makes them those of the processor, with the solver of this name: the same that has run elsewhere.
    pub fn on_processor(&self, solver: &str) -> Values {
        let row = SOLVERS.iter().position(|s| s.name() == solver);
        let solver = row.map(|row| ("solver".to_owned(), row as f64));
        let processor = (RUNS_ON.to_owned(), PROCESSOR);
        solver.into_iter().chain([processor]).collect()
    }
    /// A stage's simulation, of a model.
    ///
    /// # Errors
    /// What the solver does not take; what the card refuses.
    pub fn simulate<T: Float>(
        &self,
        model: Model,
        stage: &Stage,
        card: &Card<T>,
    ) -> Result<Simulation<T>, SessionError> {
        let runs_on = match card {
            Card::Unasked => PROCESSOR,
            Card::Missing(_) | Card::Present(_) => self.form.number(RUNS_ON),
        };
        card.simulation(model, self.settings(stage), runs_on)
    }
    fn settings(&self, stage: &Stage) -> SimulationSettings {
        let solver = SOLVERS[self.form.integer("solver")];
        let substeps = self.form.integer("substeps");
        SimulationSettings {
            contacts: self.form.flag("contacts"),
            ..stage.settings(solver, self.time_step(), substeps)
        }
    }
    /// Gives a model its gravity.
    pub fn change(&self, parts: &mut Parts) {
        let up = parts.up_axis.direction();
        let aside = parts.gravity - parts.gravity.dot(up) * up;
        parts.gravity = aside - self.form.number("gravity") * up;
    }
}
