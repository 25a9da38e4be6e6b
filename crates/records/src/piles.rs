//! The kernels of `impulse`, of which each works on a body, a shape, a pair of shapes or a contact.

use numbers::trace::{Program, TraceError, record};
use numbers::{Machine, Real};
use rigid::impulse::joint::{self, Actuation, JointTables, Sources};
use rigid::impulse::pair::{PairTables, ShapeTables, place};
use rigid::impulse::report::{
    BodyReport, ContactReport, FreeReport, TieReport, tell_body, tell_contact, tell_free, tell_tie,
};
use rigid::impulse::sums::{SumTables, add};
use rigid::impulse::{BodyTables, ContactTables, blow, body, contact};

/// What is done to bodies, shapes and contacts, as records. Parameters are those of [`BodyTables`], [`ShapeTables`] and
/// [`ContactTables`].
#[derive(Clone, Debug)]
pub struct PilePrograms {
    /// What pushes a body from outside.
    pub push_body: Program,
    /// A body as a step begins.
    pub begin: Program,
    /// A body as the first small step begins.
    pub advance: Program,
    /// The same of those that follow.
    pub advance_again: Program,
    /// A body before blows, and after them.
    pub part: Program,
    /// A body within a small step.
    pub drift: Program,
    /// A body as the step ends.
    pub finish: Program,
    /// A shape.
    pub place: Program,
    /// A contact as a step begins.
    pub prepare: Program,
    /// Whether a contact may be struck.
    pub foresee: Program,
    /// A contact as the first small step begins.
    pub warm_start: Program,
    /// A contact that may be struck, in the first round of blows.
    pub strike_foreseen: Program,
    /// A contact in those that follow.
    pub strike: Program,
    /// What a contact gave in the parts of a step before comes to what it gives in this one: see [`SumTables`].
    pub add_part: Program,
    /// A contact that also pushes surfaces apart.
    pub push: Program,
    /// A contact that does not.
    pub relax: Program,
}

/// What tells of things, as records: of each kind of [`Thing`](rigid::impulse::report::Thing).
#[derive(Clone, Debug)]
pub struct ReportPrograms {
    /// A body.
    pub body: Program,
    /// A free joint along which nothing acts.
    pub free: Program,
    /// Any other joint.
    pub tie: Program,
    /// A contact.
    pub contact: Program,
}

impl ReportPrograms {
    /// Records them.
    ///
    /// # Errors
    /// The kernels do what a record cannot express.
    pub fn record() -> Result<Self, TraceError> {
        Ok(Self {
            body: record(|k| tell_body(k, &BodyReport::new()))?,
            free: record(|k| tell_free(k, &FreeReport::new()))?,
            tie: record(|k| tell_tie(k, &TieReport::new()))?,
            contact: record(|k| tell_contact(k, &ContactReport::new()))?,
        })
    }
}

/// What is done to joints, as records. Parameters are those of [`JointTables`].
#[derive(Clone, Debug)]
pub struct JointPrograms {
    /// What controls make of the forces along axes; its numbers are those of [`Actuation`].
    pub actuate: Program,
    /// The targets of drives, as a step begins.
    pub follow: Program,
    /// Where a joint stands.
    pub place: Program,
    /// A joint as the first small step begins.
    pub warm_start: Program,
    /// A joint that hands a blow on.
    pub strike: Program,
    /// A joint that is also pushed together.
    pub push: Program,
    /// A joint that is not.
    pub relax: Program,
}

impl JointPrograms {
    /// Records them, for joints of which the axes have room for these.
    ///
    /// # Errors
    /// The kernels do what a record cannot express.
    pub fn record(sources: &Sources) -> Result<Self, TraceError> {
        let t = &JointTables::new();
        let actuation = &Actuation::new(sources);
        Ok(Self {
            actuate: record(|k| joint::actuate(k, actuation))?,
            follow: record(|k| joint::follow(k, t))?,
            place: record(|k| joint::place(k, t))?,
            warm_start: record(|k| joint::warm_start(k, t))?,
            strike: record(|k| joint::strike(k, t))?,
            push: record(|k| hold(k, t, 1.0))?,
            relax: record(|k| hold(k, t, 0.0))?,
        })
    }
}

impl PilePrograms {
    /// Records them.
    ///
    /// # Errors
    /// The kernels do what a record cannot express.
    pub fn record() -> Result<Self, TraceError> {
        let (t, c) = (&BodyTables::new(), &ContactTables::new());
        Ok(Self {
            push_body: record(|k| body::push(k, t))?,
            begin: record(|k| body::begin(k, t))?,
            advance: record(|k| advance(k, t, 0.0))?,
            advance_again: record(|k| advance(k, t, 1.0))?,
            part: record(|k| body::part(k, t))?,
            drift: record(|k| body::drift(k, t))?,
            finish: record(|k| body::finish(k, t))?,
            place: record(|k| place(k, &ShapeTables::new()))?,
            prepare: record(|k| contact::prepare(k, c))?,
            foresee: record(|k| blow::foresee(k, c))?,
            warm_start: record(|k| contact::warm_start(k, c))?,
            strike_foreseen: record(|k| blow::strike_foreseen(k, c))?,
            strike: record(|k| blow::strike(k, c))?,
            add_part: record(|k| add(k, &SumTables::new()))?,
            push: record(|k| solve(k, c, 1.0))?,
            relax: record(|k| solve(k, c, 0.0))?,
        })
    }
    /// Records what tells how far apart a pair is at least, into the distance of its first point.
    ///
    /// # Errors
    /// The kernel does what a record cannot express.
    pub fn apart(tables: &PairTables) -> Result<Program, TraceError> {
        record(|k| tables.contacts().apart(k))
    }
    /// Records what finds the points of contact of a pair.
    ///
    /// # Errors
    /// The kernel does what a record cannot express.
    pub fn pair(tables: &PairTables) -> Result<Program, TraceError> {
        record(|k| tables.meet_in_parts(k))
    }
}

fn advance<M: Machine>(k: &mut M, t: &BodyTables, again: f64) {
    body::advance(k, t, M::R::lit(again));
}

fn hold<M: Machine>(k: &mut M, t: &JointTables, pushing: f64) {
    joint::solve(k, t, M::R::lit(pushing));
}

fn solve<M: Machine>(k: &mut M, t: &ContactTables, pushing: f64) {
    contact::solve(k, t, M::R::lit(pushing));
}
