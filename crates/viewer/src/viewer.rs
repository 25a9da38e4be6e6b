//! A page beside a program that goes on.

use crate::engine::{Said, clock};
use crate::{Access, Server, ViewerError, serve};
use numbers::Float;
use session::{Session, Shared, Skin, SkinError, Wardrobe};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::thread::JoinHandle;
use std::{mem, process};

/// Pages that watch and steer a program's simulation, until this is closed or dropped, or the simulation is.
///
/// Whoever closes it waits until the session has let go of the simulation, so must not hold it. Pages are told. In a process
/// that was forked it is closed, and letting go of it leaves the page to the process that serves it.
#[derive(Debug)]
pub struct Viewer {
    address: SocketAddr,
    url: String,
    said: SyncSender<Said>,
    wardrobe: Arc<Wardrobe>,
    /// Of the session, and of what answers pages, which ends after the session.
    threads: Vec<JoinHandle<()>>,
    /// Which process has the threads.
    process: u32,
}

/// Shows a simulation that the program goes on stepping: at `address`, or at any free port of this machine that
/// nobody else can reach; to those who know `token`, where one is given or others can reach the address.
///
/// ```
/// use session::Shared;
/// use sim::{Simulation, SimulationSettings};
///
/// let model = model::examples::room()?;
/// let simulation = Simulation::<f32>::new(model, SimulationSettings::new(1, 0.002))?;
/// let shared = Shared::new(simulation);
/// let viewer = kinetarium_viewer::show(&shared, None, None)?;
/// println!("open {}", viewer.url());
/// for _ in 0..100 {
///     shared.change().step(1); // pages see it
/// }
/// let time = shared.read().time(0); // pages may have stepped it, too
/// viewer.close();
/// # assert!((time - 0.2).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The address cannot be listened at; the token is empty, or more than letters, digits, `-` and `_`; no thread or
/// random number can be had.
pub fn show<T: Float>(
    shared: &Arc<Shared<T>>,
    address: Option<SocketAddr>,
    token: Option<&str>,
) -> Result<Viewer, ViewerError> {
    let address = address.unwrap_or((Ipv4Addr::LOCALHOST, 0).into());
    let access = match token {
        Some(token) if !can_be_sent(token) => return Err(ViewerError::Token),
        Some(token) => Access::with_token(token),
        None => Access::for_address(address.ip())?,
    };
    serve(Session::of_program(shared, clock), address, access).and_then(Server::in_background)
}

/// Whether a token can stand in an address as it is.
fn can_be_sent(token: &str) -> bool {
    let plain = |b: u8| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'_');
    !token.is_empty() && token.bytes().all(plain)
}

impl Viewer {
    pub(crate) fn new(
        address: SocketAddr,
        url: String,
        said: SyncSender<Said>,
        wardrobe: Arc<Wardrobe>,
        threads: [JoinHandle<()>; 2],
    ) -> Self {
        Self {
            address,
            url,
            said,
            wardrobe,
            threads: threads.into(),
            process: process::id(),
        }
    }
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
    /// What to open in a browser on this machine, with the token, if one is needed.
    pub fn url(&self) -> &str {
        &self.url
    }
    /// Whether pages are still answered: false soon after the simulation is dropped.
    pub fn is_open(&self) -> bool {
        let answering = self.threads.last();
        self.has_threads() && answering.is_some_and(|answering| !answering.is_finished())
    }
    /// Whether its threads are in this process, which has none of them where it was forked.
    fn has_threads(&self) -> bool {
        self.process == process::id()
    }
    /// Has some bodies wear a skin on all pages, by their names, until they are dressed again. The physics does not know.
    ///
    /// It may be called as often as one likes: pages are told with their frames, and of what was put on last. On its
    /// page a user may dress bodies otherwise until then.
    ///
    /// ```
    /// # use session::Shared;
    /// use session::{Gauge, Skin};
    ///
    /// # let model = model::examples::room()?;
    /// # let settings = sim::SimulationSettings::new(1, 0.002);
    /// # let shared = Shared::new(sim::Simulation::<f32>::new(model, settings)?);
    /// let viewer = kinetarium_viewer::show(&shared, None, None)?;
    /// viewer.dress_all(Skin::Gauge(Gauge::Speed))?;
    /// # let name = shared.read().model().bodies[0].name.clone();
    /// # let name = name.as_str();
    /// viewer.dress(&[name], Skin::Color([0.9, 0.2, 0.1, 1.0]))?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A name that no body has; a colour with numbers beyond 0 to 1. Nothing is changed then.
    pub fn dress(&self, bodies: &[impl AsRef<str>], skin: Skin) -> Result<(), SkinError> {
        self.wardrobe.dress(bodies, skin)
    }
    /// Has all bodies wear a skin, likewise.
    ///
    /// # Errors
    /// A colour with numbers beyond 0 to 1.
    pub fn dress_all(&self, skin: Skin) -> Result<(), SkinError> {
        self.wardrobe.dress_all(skin)
    }
    /// Tells pages, and ends. Within a second, and what the simulation is doing at the time.
    pub fn close(self) {
        drop(self);
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let threads = mem::take(&mut self.threads);
        if !self.has_threads() {
            // They stayed behind, and can be neither told, nor joined, nor detached.
            return mem::forget(threads);
        }
        // Where nobody listens any more, it has ended.
        let _ = self.said.send(Said::End);
        for thread in threads {
            // A thread that panicked has said so itself.
            let _ = thread.join();
        }
    }
}
