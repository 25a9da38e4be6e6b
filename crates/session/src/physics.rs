//! How a stage is simulated: the form that a page shows of it.

use crate::SessionError;
use crate::card::{Card, PROCESSOR, RUNS_ON};
use crate::form::Form;
use crate::protocol::{Field, Values};
use crate::stage::Stage;
use model::{Model, Parts};
use numbers::Float;
use sim::{Device, SETTINGS, Setting, SettingKind, Simulation, SimulationSettings, SolverKind};

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
        let model = &stage.model;
        let down = -model.gravity.dot(model.up_axis.direction());
        let mut usual = stage.settings(stage.solver, model.time_step, stage.substeps(stage.solver));
        // For when a solver runs that has a choice.
        usual.step.integrator = stage.integrator;
        let mut fields = vec![
            Field::choice("solver", "Solver", solver, &names).help(
                "Which solver advances the state; auto picks by the model. A change starts again.",
            ),
            Field::number("gravity", "Gravity", "m/s²", down, [-30.0, 30.0])
                .help("Acceleration downwards: 9.81 on the Earth, 1.62 on the Moon."),
        ];
        fields.extend(SETTINGS.iter().map(|setting| field(setting, &usual)));
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
    /// All fields.
    pub fn fields(&self) -> &[Field] {
        self.form.fields()
    }
    /// Those that concern a solver, of this name.
    pub fn fields_of(&self, solver: &str) -> Vec<Field> {
        let concerns = |field: &&Field| {
            let mut settings = SETTINGS.iter();
            let setting = settings.find(|setting| setting.name == field.name);
            setting.is_none_or(|setting| setting.is_read_by(solver))
        };
        self.fields().iter().filter(concerns).cloned().collect()
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
        let device = match card {
            Card::Present(device) if runs_on != PROCESSOR => Some(&**device),
            _ => None,
        };
        let settings = self.settings(stage, device);
        Ok(match device {
            Some(device) => Simulation::on(device, model, settings)?,
            None => Simulation::new(model, settings)?,
        })
    }
    fn settings<T: Float>(
        &self,
        stage: &Stage,
        device: Option<&dyn Device<T>>,
    ) -> SimulationSettings {
        let chosen = SOLVERS[self.form.integer("solver")];
        let mut settings = SimulationSettings {
            solver: chosen,
            ..SimulationSettings::new(stage.worlds, stage.model.time_step)
        };
        for setting in &SETTINGS {
            (setting.write)(&mut settings, self.form.number(setting.name));
        }
        let (model, contacts) = (&stage.model, settings.contacts);
        if let Some(device) = device {
            settings.solver = chosen.pick_on(device, model, contacts);
        }
        let step = &mut settings.step;
        let solver = settings.solver;
        step.integrator = solver.usual_integrator(model, contacts, step.integrator);
        settings
    }
    /// Gives a model its gravity.
    pub fn change(&self, parts: &mut Parts) {
        let up = parts.up_axis.direction();
        let aside = parts.gravity - parts.gravity.dot(up) * up;
        parts.gravity = aside - self.form.number("gravity") * up;
    }
}

/// A field of a setting, at its value in settings.
fn field(setting: &Setting, settings: &SimulationSettings) -> Field {
    let (name, label, unit) = (setting.name, setting.label, setting.unit);
    let value = (setting.read)(settings);
    let field = match setting.kind {
        SettingKind::Number {
            usual: [least, most],
            logarithmic,
            ..
        } => {
            // What has no cap has the largest that there is.
            let value = if value.is_finite() { value } else { most };
            if logarithmic {
                Field::logarithmic(name, label, unit, value, [least, most])
            } else {
                Field::number(name, label, unit, value, [least, most])
            }
        }
        SettingKind::Whole { usual, .. } => {
            Field::integer(name, label, value as usize, usual.map(|x| x as usize))
        }
        SettingKind::Flag => Field::flag(name, label, value != 0.0),
        SettingKind::Choice(names) => Field::choice(name, label, value as usize, names),
    };
    field.help(setting.help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::tower;

    /// What a setting is, as in the documentation.
    fn row(setting: &Setting) -> String {
        let unit = match setting.unit {
            "" => "–",
            unit => unit,
        };
        let (name, help) = (setting.name, setting.help);
        let (must, solvers) = (setting.must_be(), setting.read_by());
        format!("| `{name}` | {unit} | {must} | {solvers} | {help} |\n")
    }

    #[test]
    fn the_documentation_has_the_settings() {
        let file = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../docs/concepts/simulation.md"
        );
        let page = std::fs::read_to_string(file).unwrap();
        let table: String = SETTINGS.iter().map(row).collect();
        assert!(page.contains(&table), "put this into {file}:\n{table}");
    }

    /// The ends of what is usual are taken, and come back from the form as they were put in.
    #[test]
    fn a_form_gives_settings_that_simulations_take() {
        let stage = Stage::new(tower(1, 0.0).unwrap());
        for solver in 1..4 {
            for end in 0..2 {
                let physics = Physics::new(&stage, &Card::<f32>::Unasked);
                let mut values = Values::from([("solver".to_owned(), f64::from(solver))]);
                for setting in &SETTINGS {
                    let usual = match setting.kind {
                        SettingKind::Number { usual, .. } | SettingKind::Whole { usual, .. } => {
                            usual
                        }
                        SettingKind::Flag => [0.0, 1.0],
                        SettingKind::Choice(names) => [0.0, names.len() as f64 - 1.0],
                    };
                    values.insert(setting.name.into(), usual[end]);
                }
                let physics = physics.with(&values).unwrap();
                let made = physics.simulate::<f32>(stage.model.clone(), &stage, &Card::Unasked);
                let settings = *made.unwrap().settings();
                for setting in SETTINGS
                    .iter()
                    .filter(|s| s.is_read_by(SOLVERS[solver as usize].name()))
                {
                    let (put, got) = (values[setting.name], (setting.read)(&settings));
                    assert!(got == put || got.is_infinite(), "{}: {got}", setting.name);
                }
            }
        }
    }

    #[test]
    fn only_what_the_solver_reads_is_shown() {
        let physics = Physics::new(&Stage::new(tower(1, 0.0).unwrap()), &Card::<f32>::Unasked);
        let shown = |solver: &str| -> Vec<String> {
            let fields = physics.fields_of(solver);
            fields.into_iter().map(|field| field.name).collect()
        };
        for (name, solver) in [
            ("integrator", "featherstone"),
            ("contact_passes", "featherstone"),
            ("relaxation", "xpbd"),
            ("sleep_speed", "impulse"),
        ] {
            for other in ["featherstone", "xpbd", "impulse"] {
                let there = shown(other).contains(&name.to_owned());
                assert_eq!(there, solver == other, "{name} of {other}");
            }
        }
        assert!(shown("xpbd").contains(&"gravity".into()));
    }
}
