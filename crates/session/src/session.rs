//! A simulation that pages watch and steer.

use crate::SessionError;
use crate::card::Card;
use crate::frame::Frame;
use crate::gallery::{EXAMPLES, Example};
use crate::hands::Subject;
use crate::play::Play;
use crate::protocol::{Message, Values};
use crate::shared::Shared;
use crate::stage::Stage;
use crate::steering::Steering;
use crate::wardrobe::Wardrobe;
use numbers::Float;
use parking_lot::MutexGuard;
use sim::{Device, Simulation};
use std::fmt;
use std::sync::{Arc, Weak};

/// Longest stretch of computing between two looks at what the page says [s].
const SLICE: f64 = 0.012;
/// The same where a program waits meanwhile [s].
const LENT: f64 = 0.004;

/// What goes to the page.
#[derive(Clone, Debug, PartialEq)]
pub enum Outgoing {
    /// A [`Message`] as JSON.
    Text(String),
    /// A [`Message::Error`] as JSON: an answer to what the page has just said.
    Refusal(String),
    /// A [`Message::Changed`] as JSON: what the page has just said, for all other pages. Where nobody has said it,
    /// it is a [`Text`](Outgoing::Text).
    News(String),
    /// A [`Frame`] as bytes.
    Frame(Vec<u8>),
}

/// A simulation that pages watch and steer: commands go in, messages and frames come out.
///
/// The simulation is the session's own, or that of a program that steps it, too. The session knows no
/// transport and no clock of its own: `clock` tells seconds since any moment.
#[derive(Debug)]
pub struct Session<T: Float = f32> {
    source: Source<T>,
    steering: Steering,
}

/// Whose the simulation is.
enum Source<T: Float> {
    Own(Box<Subject<T>>),
    Program(Weak<Shared<T>>),
}

impl Session {
    /// The first example of the gallery, stopped. `clock` tells seconds.
    ///
    /// # Errors
    /// None; the examples are tested.
    pub fn gallery(clock: fn() -> f64) -> Result<Self, SessionError> {
        Self::example(EXAMPLES[0].name, clock)
    }
    /// An example of the gallery, stopped. `clock` tells seconds.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn example(name: &str, clock: fn() -> f64) -> Result<Self, SessionError> {
        let example = Example::find(name)?;
        let play = Play::of_example(example, example.form(), &Values::new(), &Card::Unasked)?;
        Ok(Self::own(play, clock))
    }
    /// A stage of one's own, stopped, to which pages can return from the examples. `clock` tells seconds.
    ///
    /// # Errors
    /// A stage that no simulation takes.
    pub fn of(stage: Stage, clock: fn() -> f64) -> Result<Self, SessionError> {
        let play = Play::of_model(stage, &Values::new(), &Card::Unasked)?;
        Ok(Self::own(play, clock))
    }
    /// The same, whose pages may have it run on this graphics card, or are told why there is none. Without, they
    /// are not asked.
    ///
    /// A card that fails is let go: the processor goes on from a recorded state.
    pub fn with_card(mut self, card: Result<Arc<dyn Device<f32>>, String>) -> Self {
        if let Source::Own(subject) = &mut self.source {
            subject.card = card.into();
            self.steering.offer(&subject.card);
        }
        self
    }
    fn own((play, mut simulation): (Play, Simulation<f32>), clock: fn() -> f64) -> Self {
        Self {
            steering: Steering::new(play, &mut simulation, SLICE, clock),
            source: Source::Own(Box::new(Subject::new(simulation))),
        }
    }
}

impl<T: Float> Session<T> {
    /// The simulation of a program, as it is now, to which [restart](crate::protocol::Command::Restart) returns.
    /// `clock` tells seconds.
    ///
    /// Pages may run and step it, draw and push bodies, set targets and controls. What would make it another
    /// simulation (other physics, another model) is the program's, and is refused. When the program has let go
    /// of it, the session is [`over`](Session::over).
    ///
    /// Panics where its worlds are on a device that fails.
    pub fn of_program(shared: &Arc<Shared<T>>, clock: fn() -> f64) -> Self {
        let mut simulation = shared.read();
        let play = Play::of_program(&mut simulation);
        Self {
            steering: Steering::new(play, &mut simulation, LENT, clock),
            source: Source::Program(Arc::downgrade(shared)),
        }
    }

    /// What its bodies wear, which may be changed at any time, on any thread. Whoever sends a page a frame then sends
    /// it the [news](Wardrobe::news), too.
    pub fn wardrobe(&self) -> Arc<Wardrobe> {
        self.steering.wardrobe.clone()
    }

    /// What the page is to be sent next, if anything.
    pub fn outgoing(&mut self) -> Option<Outgoing> {
        self.steering.outbox.pop_front()
    }

    /// What a page that comes now must know, be it the first or another.
    pub fn greeting(&mut self) -> Vec<Outgoing> {
        let Self { source, steering } = self;
        let Some((messages, frame)) = source.with(|subject, _| steering.greeting(subject)) else {
            return vec![last(GONE)];
        };
        let mut greeting: Vec<_> = messages.iter().map(Outgoing::text).collect();
        greeting.extend(frame.map(|frame| Outgoing::Frame(frame.to_bytes())));
        greeting
    }

    /// Does what a page says, a [`Command`](crate::protocol::Command) as JSON. What is refused is answered by a
    /// [`Message::Error`], and changes nothing.
    pub fn receive(&mut self, command: &str) {
        let Self { source, steering } = self;
        source.with(|subject, changes| {
            steering.notice(&mut subject.simulation, changes);
            steering.receive(subject, command);
        });
    }

    /// Steps as the clock and the page say, for a hundredth of a second at most, and makes frames.
    /// To be called again and again; true where there is more to do at once.
    pub fn advance(&mut self) -> bool {
        let Self { source, steering } = self;
        if !steering.wants(source.changes()) {
            return false;
        }
        let more = source.with(|subject, changes| {
            steering.notice(&mut subject.simulation, changes);
            steering.advance(subject)
        });
        more.unwrap_or(false)
    }

    /// A page has gone: what is drawn is let go, whoever draws it.
    pub fn release(&mut self) {
        self.source.with(|subject, _| subject.hands.grab = None);
    }

    /// Whether the program has let go of its simulation: there is nothing more to show.
    pub fn over(&self) -> bool {
        match &self.source {
            Source::Own(_) => false,
            Source::Program(shared) => shared.strong_count() == 0,
        }
    }

    /// Tells pages that nothing more will come, and why.
    pub fn end(&mut self) {
        let message = if self.over() { GONE } else { CLOSED };
        self.steering.outbox.push_back(last(message));
    }

    /// The present state, of the worlds that are shown; empty where the session is over, or a program's device fails.
    pub fn frame(&mut self) -> Frame {
        let Self { source, steering } = self;
        let frame = source.with(|subject, _| steering.frame(subject));
        frame.flatten().unwrap_or_default()
    }
}

impl<T: Float> Source<T> {
    /// Takes the simulation for a moment, if there still is one; with how often somebody else has had it before, which
    /// is counted while they have it.
    fn with<R>(&mut self, act: impl FnOnce(&mut Subject<T>, u64) -> R) -> Option<R> {
        match self {
            Self::Own(subject) => Some(act(subject, 0)),
            Self::Program(shared) => {
                let shared = shared.upgrade()?;
                let mut subject = shared.lock();
                let result = act(&mut subject, shared.changes());
                // The program goes first if it waits.
                MutexGuard::unlock_fair(subject);
                Some(result)
            }
        }
    }
    /// How often somebody else may have changed it.
    fn changes(&self) -> u64 {
        match self {
            Self::Own(_) => 0,
            Self::Program(shared) => shared.upgrade().map_or(0, |shared| shared.changes()),
        }
    }
}

impl<T: Float> fmt::Debug for Source<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Own(_) => "Own",
            Self::Program(_) => "Program",
        })
    }
}

/// What pages are told when a program has let go of its simulation.
const GONE: &str = "the program has ended this simulation: start it again to see more";
/// And when it shows it no longer.
const CLOSED: &str = "the program has closed this view: open another one there to see more";

fn last(message: &str) -> Outgoing {
    Outgoing::text(&Message::Error {
        message: message.into(),
        refused: None,
    })
}

impl Outgoing {
    /// A message to all pages.
    pub(crate) fn text(message: &Message) -> Self {
        Self::Text(message.to_json())
    }
}

impl Message {
    /// As it is sent.
    pub(crate) fn to_json(&self) -> String {
        serde_json::to_string(self).expect("messages have names for keys")
    }
}
