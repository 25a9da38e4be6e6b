//! How steps are taken: of which worlds, how many, and how much of what is launched follows from the steps before.

use crate::Card;
use crate::batch::Batch;
use crate::plan::{Plan, flag, of_world, status};
use crate::room::told;
use crate::scene::Scene;
use rigid::impulse::blow::ROUNDS as BLOWS;

/// Colours that are launched at first.
const FIRST_COLOURS: usize = 16;
/// Rounds of colouring in a step: at least, and at most.
const FEWEST_ROUNDS: usize = 8;
pub(crate) const MOST_ROUNDS: usize = 256;
/// Most steps in one turn, and about as many launches.
pub(crate) const STEPS: usize = 16;
const LAUNCHES: usize = 16_384;
/// Steps after which more worlds are tried at once.
const FITTED: usize = 256;
/// Most worlds whose steps are cut into parts in one turn: each is copied, so that it can be undone.
const CUT: usize = 256;
/// Of what a turn told: colouring goes on where it ended.
pub(crate) const UNCOLOURED: u32 = flag::MORE_ROUNDS | flag::MORE_COLOURS;

/// How steps of a batch are taken.
#[derive(Debug)]
pub(crate) struct Pace {
    /// Steps in a turn: fewer where they are often not taken.
    pub steps: usize,
    /// Worlds in a turn, and in one of steps that are cut into parts: fewer where there was no room for all of them.
    worlds: usize,
    cut: usize,
    /// For how many steps there was.
    fitted: usize,
    /// Colours of contacts that are launched.
    pub colours: Held,
    /// Rounds of colouring in a step.
    pub rounds: usize,
    /// Worlds for which these, or colours, were too few, so that colouring goes on where it ended.
    pub uncoloured: Vec<usize>,
    /// Rounds of blows in a small step.
    pub blows: Held,
}

/// How many of something are launched: as many as were needed in any of the last steps.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Held {
    pub count: usize,
    /// Steps in which fewer were needed, without a break.
    fewer: usize,
}

/// Steps after which fewer are launched.
const HELD: usize = 16;

impl Held {
    pub fn at_least(&mut self, needed: usize) {
        if needed >= self.count {
            *self = Self {
                count: needed,
                fewer: 0,
            };
        }
    }
    /// So many were needed in so many steps.
    fn needed(&mut self, needed: usize, steps: usize) {
        self.at_least(needed);
        self.fewer += steps;
        if needed < self.count && self.fewer >= HELD {
            *self = Self {
                count: needed + (self.count - needed) / 2,
                fewer: 0,
            };
        }
    }
}

impl Pace {
    /// Of so many worlds.
    pub fn new(worlds: usize) -> Self {
        Self {
            steps: 1,
            worlds,
            cut: worlds.min(CUT),
            fitted: 0,
            colours: Held {
                count: FIRST_COLOURS,
                fewer: 0,
            },
            rounds: FEWEST_ROUNDS,
            uncoloured: Vec::new(),
            blows: Held::default(),
        }
    }
    /// Has fewer worlds stepped at once than in a turn; false where it was but one.
    pub fn fewer(&mut self, turn: &Turn) -> bool {
        let fewer = turn.worlds.len() / 2;
        if fewer > 0 {
            let most = match turn.parts {
                1 => &mut self.worlds,
                _ => &mut self.cut,
            };
            (*most, self.fitted) = (fewer, 0);
        }
        fewer > 0
    }
    /// From what so many steps have taken.
    pub fn learn(&mut self, told: &Told, taken: usize) {
        self.colours
            .needed(told.of(status::COLOURED) as usize, taken);
        // One more, in which nothing is struck; none where none was foreseen.
        let foreseen = told.of(status::FORESEEN) != 0;
        let struck = told.of(status::MOST_BLOWS) as usize;
        let rounds = BLOWS.min(struck + usize::from(foreseen));
        self.blows.needed(rounds, taken);
        // In most steps colours are those of the step before.
        let usual = 2 * told.of(status::ROUNDS) as usize;
        self.rounds = usual.clamp(FEWEST_ROUNDS, MOST_ROUNDS);
        // What found no room may have found it but once.
        self.fitted += taken;
        if self.fitted >= FITTED {
            self.worlds = self.worlds.saturating_mul(2);
            self.cut = CUT.min(2 * self.cut);
            self.fitted = 0;
        }
    }
}

/// Steps that are taken before anything is read.
#[derive(Debug)]
pub(crate) struct Turn {
    /// Worlds of the batch, counted from its first.
    pub worlds: Vec<usize>,
    pub steps: usize,
    /// Into how many parts each step is cut.
    pub parts: usize,
}

/// What the card has told of a turn.
pub(crate) struct Told(pub Vec<u32>);

impl Told {
    pub fn of(&self, place: usize) -> u32 {
        self.0[place]
    }
    pub fn of_world(&self, world: usize, place: usize) -> u32 {
        self.0[status::WIDTH + world * of_world::WIDTH + place]
    }
}

/// Which steps of a batch come next: of worlds, the first of them, whose steps are cut into as many parts as that of the one
/// that is farthest behind.
pub(crate) fn turn<C: Card>(scene: &Scene, batch: &Batch<C>) -> Turn {
    let pace = &batch.pace;
    let all = 0..batch.left.len();
    let last = all.clone().max_by_key(|world| batch.left[*world]);
    let parts = last.map_or(1, |world| batch.parts[world]);
    let waits = |world: &usize| batch.left[*world] > 0 && batch.parts[*world] == parts;
    // What is cut into parts is taken one by one, that it can be undone.
    let (most_worlds, most_steps) = match parts {
        1 => (pace.worlds, pace.steps),
        _ => (pace.cut, 1),
    };
    let worlds: Vec<_> = all.filter(waits).take(most_worlds).collect();
    let small_steps = scene.impulse.settings().contact_iterations;
    let joints = scene.joints.as_ref().map_or(0, |joints| joints.runs.len());
    let stage = pace.colours.count + joints + 1;
    let launches = small_steps * (2 + pace.blows.count) * stage;
    let most = most_steps.min(LAUNCHES / launches).max(1);
    let left = worlds.iter().map(|world| batch.left[*world]);
    Turn {
        steps: left.max().unwrap_or(0).min(most),
        worlds,
        parts,
    }
}

/// What the card is told as a turn begins.
pub(crate) fn begin<C: Card>(plan: &Plan, batch: &Batch<C>, turn: &Turn) -> Vec<u32> {
    let mut words = vec![0; told(plan)];
    words[status::KEEP] = (batch.pace.uncoloured == turn.worlds).into();
    words[status::LAUNCHED] = batch.pace.colours.count as u32;
    words[status::ROUNDS_OF_BLOWS] = batch.pace.blows.count as u32;
    words[status::PARTS] = turn.parts as u32;
    for &world in &turn.worlds {
        let steps = batch.left[world].min(turn.steps);
        words[status::WIDTH + world * of_world::WIDTH + of_world::LEFT] = steps as u32;
    }
    words
}
