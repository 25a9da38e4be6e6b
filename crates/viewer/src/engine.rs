//! The thread on which the session runs, and what it shares with the pages.

use axum::body::Bytes;
use numbers::Float;
use session::{Outgoing, Session, Wardrobe};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use std::{io, iter};
use tokio::sync::{mpsc, watch};

/// Messages that wait for a page; one that does not take them is let go, and may come again.
const WAITING: usize = 64;
/// Commands that wait for the session, of all pages together.
const COMMANDS: usize = 256;
/// Commands between two advances of the session, so that no page can stop it by talking.
const AT_ONCE: usize = 32;
/// How long to wait for a command where there is nothing to do.
const PAUSE: Duration = Duration::from_millis(4);
/// How long where nobody sees it, so that what a program has let go of ends.
const UNSEEN: Duration = Duration::from_millis(500);
/// How long pages may take to hear that it is over, and between two looks at whether they have.
pub(crate) const FAREWELL: [Duration; 2] = [Duration::from_secs(1), Duration::from_millis(2)];

/// What a page is sent.
#[derive(Clone, Debug)]
pub(crate) enum Note {
    Text(String),
    Frame(Bytes),
    /// Of the frame before, for the page to answer.
    Number(u32),
    /// There is nothing more to come.
    End,
}

/// What pages say to the engine.
pub(crate) enum Said {
    /// A page has come, and is to be greeted.
    Hello(mpsc::Sender<Note>),
    /// A page wants something; what is refused is told to it alone.
    Command(String, mpsc::Sender<Note>),
    /// The program shows it no longer.
    End,
}

/// The engine, as the pages' connections know it.
#[derive(Clone, Debug)]
pub(crate) struct Engine {
    pub said: SyncSender<Said>,
    /// The last frame: who is slow misses some. Closed when the session is over.
    pub frames: watch::Receiver<Bytes>,
    /// What bodies wear, of which each page is told after a frame.
    pub wardrobe: Arc<Wardrobe>,
}

/// Seconds since the first question.
pub fn clock() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Room for a page's messages.
pub(crate) fn mailbox() -> (mpsc::Sender<Note>, mpsc::Receiver<Note>) {
    mpsc::channel(WAITING)
}

/// Starts the thread; it ends when the session is over, or the server is gone.
pub(crate) fn start<T: Float>(session: Session<T>) -> io::Result<(Engine, JoinHandle<()>)> {
    let (said, heard) = sync_channel(COMMANDS);
    let (show, frames) = watch::channel(Bytes::new());
    let wardrobe = session.wardrobe();
    let work = move || Work::new(session, show).run(&heard);
    let thread = thread::Builder::new().name("session".into()).spawn(work)?;
    let engine = Engine {
        said,
        frames,
        wardrobe,
    };
    Ok((engine, thread))
}

struct Work<T: Float> {
    session: Session<T>,
    frames: watch::Sender<Bytes>,
    pages: Vec<mpsc::Sender<Note>>,
}

impl<T: Float> Work<T> {
    fn new(session: Session<T>, frames: watch::Sender<Bytes>) -> Self {
        Self {
            session,
            frames,
            pages: Vec::new(),
        }
    }

    fn run(mut self, heard: &Receiver<Said>) {
        while self.round(heard) && !self.session.over() {}
        self.part();
    }

    /// Advances the session and does what pages say; false where there is no more to do.
    fn round(&mut self, heard: &Receiver<Said>) -> bool {
        self.keep(|page| !page.is_closed());
        let pause = if self.pages.is_empty() {
            // What nobody sees stands still.
            UNSEEN
        } else if self.session.advance() {
            Duration::ZERO
        } else {
            PAUSE
        };
        self.tell(None);
        match heard.recv_timeout(pause) {
            Ok(said) => {
                let more = heard.try_iter().take(AT_ONCE);
                iter::once(said).chain(more).all(|said| self.hear(said))
            }
            Err(RecvTimeoutError::Timeout) => true,
            Err(RecvTimeoutError::Disconnected) => false,
        }
    }

    /// Lets go of all pages, once they have heard what they were told.
    fn part(mut self) {
        self.session.end();
        self.tell(None);
        self.pages.retain(|page| page.try_send(Note::End).is_ok());
        let [longest, pause] = FAREWELL;
        let end = Instant::now() + longest;
        while self.pages.iter().any(|page| !page.is_closed()) && Instant::now() < end {
            thread::sleep(pause);
        }
    }

    /// False where the program shows it no longer.
    fn hear(&mut self, said: Said) -> bool {
        match said {
            Said::End => return false,
            Said::Hello(page) => {
                let greeting = self.session.greeting();
                if greeting
                    .into_iter()
                    .all(|o| page.try_send(o.into()).is_ok())
                {
                    self.pages.push(page);
                }
            }
            Said::Command(text, page) => {
                self.session.receive(&text);
                self.tell(Some(&page));
            }
        }
        true
    }

    /// Sends what the session has to say; refusals to the page that asked, news to the others.
    fn tell(&mut self, asked: Option<&mpsc::Sender<Note>>) {
        while let Some(outgoing) = self.session.outgoing() {
            match (outgoing, asked) {
                (Outgoing::Frame(bytes), _) => {
                    self.frames.send_replace(bytes.into());
                }
                (refusal @ Outgoing::Refusal(_), Some(page)) => {
                    // A page that does not listen need not know.
                    let _ = page.try_send(refusal.into());
                }
                (news @ Outgoing::News(_), Some(asked)) => {
                    let note = Note::from(news);
                    self.keep(|page| {
                        page.same_channel(asked) || page.try_send(note.clone()).is_ok()
                    });
                }
                (text, _) => {
                    let note = Note::from(text);
                    self.keep(|page| page.try_send(note.clone()).is_ok());
                }
            }
        }
    }

    /// Forgets the other pages, and lets go of what they held.
    fn keep(&mut self, stays: impl Fn(&mpsc::Sender<Note>) -> bool) {
        let before = self.pages.len();
        self.pages.retain(stays);
        if self.pages.len() < before {
            self.session.release();
        }
    }
}

impl From<Outgoing> for Note {
    fn from(outgoing: Outgoing) -> Self {
        match outgoing {
            Outgoing::Text(text) | Outgoing::Refusal(text) | Outgoing::News(text) => {
                Self::Text(text)
            }
            Outgoing::Frame(bytes) => Self::Frame(bytes.into()),
        }
    }
}
