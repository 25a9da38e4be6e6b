//! What a page shows and does: examples, commands, frames. It knows no transport.
//!
//! A [`Session`] is a simulation that pages watch and steer. A server, or a worker in a browser, gives it
//! what pages say ([`Session::receive`]), calls [`Session::advance`] again and again, and sends what
//! [`Session::outgoing`] hands out. [`protocol`] and [`frame`] say what the messages mean.
//!
//! ```
//! use kinetarium_session::{Outgoing, Session};
//!
//! let mut session = Session::gallery(|| 0.0)?;
//! session.receive(r#"{"type": "open", "example": "dominoes", "build": {"count": 5}}"#);
//! session.receive(r#"{"type": "step", "steps": 100}"#);
//! while session.advance() {}
//! let frames = std::iter::from_fn(|| session.outgoing()).filter(|o| matches!(o, Outgoing::Frame(_)));
//! assert!(frames.count() >= 1);
//! # Ok::<(), kinetarium_session::SessionError>(())
//! ```

#![forbid(unsafe_code)]

mod batch;
mod card;
mod describe;
mod error;
mod form;
pub mod frame;
mod gallery;
mod hands;
mod history;
mod perturb;
mod physics;
mod play;
pub mod protocol;
mod pull;
mod quantity;
mod session;
mod shared;
mod skin;
mod sliders;
mod stage;
mod steering;
mod wander;
mod wardrobe;

pub use error::SessionError;
pub use form::Form;
pub use frame::Frame;
pub use gallery::{EXAMPLES, Example};
pub use perturb::perturb;
pub use protocol::Gauge;
pub use session::{Outgoing, Session};
pub use shared::{Guard, Shared};
pub use skin::{LONGEST_FILE, Skin, SkinError, SkinFile};
pub use stage::Stage;
pub use wardrobe::{Told, Wardrobe};
