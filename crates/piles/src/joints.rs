//! The joints of a model as a card has them: in runs of which each is solved side by side.

use crate::PilesError;
use numbers::trace::Members;
use records::JointPrograms;
use rigid::impulse::Impulse;
use rigid::impulse::joint::{
    Actuation, JointTables, PLACED, ROWS, Sources, TIED_STATE, Tied, acting, axis, axis_link,
    bounded, joint,
};
use sim::joint_runs;

/// What all worlds of a model have in common.
#[derive(Debug)]
pub(crate) struct Joints {
    pub programs: JointPrograms,
    /// Joints in the order in which they are solved, as the solver counts them.
    pub ties: Vec<u32>,
    /// Rows of their bodies, `[side][joint]`.
    pub seats: Vec<u32>,
    /// First joint and number of joints of each run; the last run has all.
    pub runs: Vec<[u32; 2]>,
    pub links: Vec<u32>,
    /// Whether there are drives.
    pub drives: bool,
    /// What each axis has room for.
    pub sources: Sources,
}

impl Joints {
    /// None where nothing is tied.
    ///
    /// # Errors
    /// The kernels do what a record cannot express.
    pub fn new(impulse: &Impulse) -> Result<Option<Self>, PilesError> {
        let tied = (0..impulse.ties()).filter_map(|tie| Some((tie, impulse.tied_rows(tie)?)));
        let (all, rows): (Vec<_>, Vec<_>) = tied.unzip();
        if all.is_empty() {
            return Ok(None);
        }
        let mut order = Vec::new();
        let mut runs = Vec::new();
        for run in joint_runs(&rows, impulse.rows()) {
            runs.push([order.len() as u32, run.len() as u32]);
            order.extend(run);
        }
        runs.push([0, order.len() as u32]);
        let order = order.iter().map(|i| *i as usize);
        let side = |side: usize| order.clone().map(|i| rows[i][side]).collect::<Vec<_>>();
        let sources = all.iter().map(|tie| impulse.sources(*tie));
        let sources = sources.fold(Sources::default(), Sources::max);
        let mut links = Vec::new();
        let mut laws = 0;
        for (row, count) in sources.laws.into_iter().enumerate() {
            // Whether anything does changes with the controls.
            let may_act = all.iter().any(|tie| impulse.freedoms(*tie)[row]);
            let numbers = [may_act.into(), laws as u32, (laws + count) as u32];
            links.extend::<[u32; axis_link::WIDTH]>(numbers);
            laws += count;
        }
        Ok(Some(Self {
            programs: JointPrograms::record(&sources)?,
            ties: order.clone().map(|i| all[i] as u32).collect(),
            seats: [side(0), side(1)].concat(),
            runs,
            links,
            drives: impulse.drives(),
            sources,
        }))
    }

    pub fn count(&self) -> usize {
        self.ties.len()
    }
    /// Numbers of the laws of a joint.
    pub fn law_numbers(&self) -> usize {
        bounded::WIDTH * self.sources.all_laws()
    }
    /// Constants of each joint.
    pub fn constants(&self) -> usize {
        joint::CONSTANTS + ROWS * axis::CONSTANTS + self.law_numbers()
    }
    /// What controls make of each.
    pub fn actuation(&self) -> Actuation {
        Actuation::new(&self.sources)
    }
    /// Numbers of a joint while a step runs, those of axes without laws left out; then what kernels work with.
    fn lengths(&self) -> [usize; 2] {
        let (t, laws) = (JointTables::new(), self.sources.all_laws());
        let scratch = JointTables::scratch(laws) - 2 * PLACED;
        [t.law.at(laws, 0), scratch]
    }
    /// All of them.
    pub fn width(&self) -> usize {
        self.lengths().iter().sum()
    }
    /// Numbers of a joint in the buffer that has most of each.
    pub fn widest(&self) -> usize {
        let lengths = self.actuation().lengths.into_iter();
        lengths.fold(self.width(), usize::max)
    }
    pub fn members(&self) -> Members {
        Members::Seats {
            bodies: PLACED as u32,
            state: self.lengths()[0] as u32,
        }
    }

    /// Constants of the joints of a world, `[number][joint]`.
    pub fn constants_of(&self, impulse: &Impulse, parameters: &[f32]) -> Vec<f32> {
        let count = self.count();
        let mut constants = vec![0.0; self.constants() * count];
        for (i, tie) in self.ties.iter().enumerate() {
            let Tied { joint, axes, laws } = impulse.tied_constants(*tie as usize, parameters);
            let axes = axes.iter().flatten();
            let laws = laws.iter().zip(self.sources.laws);
            let laws = laws.flat_map(|(laws, count)| laws[..count].iter().flatten());
            for (number, x) in joint.iter().chain(axes).chain(laws).enumerate() {
                constants[number * count + i] = *x as f32;
            }
        }
        constants
    }
}

/// What the shader has as constants.
pub(crate) fn constants() -> [(&'static str, usize); 17] {
    let t = JointTables::new();
    [
        ("JOINT_CONSTANTS", joint::CONSTANTS),
        ("JOINT_TARGET", t.joint.at(0, joint::TARGET)),
        ("JOINT_SUM", joint::SUM - joint::TARGET),
        ("JOINT_CARRIED", TIED_STATE),
        ("AXES", ROWS),
        ("AXIS", t.axis.at(0, 0)),
        ("AXIS_WIDTH", axis::WIDTH),
        ("AXIS_CONSTANTS", axis::CONSTANTS),
        ("AXIS_ACTS", axis::ACTS),
        ("AXIS_FORCE", axis::FORCE),
        ("AXIS_GOAL", axis::GOAL),
        ("LAW", t.law.at(0, 0)),
        ("LAW_WIDTH", bounded::WIDTH),
        ("LAW_FORCE", bounded::FORCE),
        ("ACTING", acting::WIDTH),
        ("ACTING_FORCE", acting::FORCE),
        ("ACTING_GOAL", acting::GOAL),
    ]
}
