//! The engine in a browser: a session behind a few exported functions.
//!
//! The page's worker calls [`start`] once, writes each command as UTF-8 into [`room`] and calls [`receive`],
//! and calls [`advance`] again and again; what [`next`] then takes out lies at [`message`]. Imports:
//! `page.now`, seconds of a clock that never goes back, and the page's graphics card, as `gpu`.
//!
//! Those of `gpu` that wait suspend the module, where the worker has a way to do so (`WebAssembly.Suspending`). Only
//! [`receive`] and [`advance`] ever wait, and until they have returned nothing else may be called.
//!
//! There is no tool between: the module has plain numbers for arguments, and needs no generated code.

#![allow(unsafe_code)] // functions that are called by name, and such as are imported
#![cfg(target_family = "wasm")]

mod card;
mod piles;
mod worlds;

use card::Card;
use session::{Outgoing, Session};
use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::Arc;

#[link(wasm_import_module = "page")]
unsafe extern "C" {
    /// Seconds of a clock that never goes back.
    safe fn now() -> f64;
}

/// The engine of this module.
#[derive(Default)]
struct Engine {
    session: Option<Session>,
    /// What the page is told at first.
    greeting: VecDeque<Outgoing>,
    /// The command that comes in; at first, what is to be known of the graphics card.
    room: Vec<u8>,
    /// The message that goes out.
    message: Vec<u8>,
}

thread_local! {
    static ENGINE: RefCell<Engine> = RefCell::default();
}

fn clock() -> f64 {
    now()
}

/// Makes the session; its first messages are then waiting. 1 where that went well, else 0.
///
/// `card` is 1 where the room holds the name of a graphics card, 2 where it holds why there is none; else nobody
/// is asked where simulations are to run.
#[unsafe(no_mangle)]
pub extern "C" fn start(card: u32) -> u32 {
    ENGINE.with_borrow_mut(|engine| {
        let told = String::from_utf8_lossy(&engine.room).into_owned();
        let session = Session::gallery(clock).ok();
        engine.session = match card {
            1 => session.map(|s| s.with_card(Ok(Arc::new(Card { name: told })))),
            2 => session.map(|s| s.with_card(Err(told))),
            _ => session,
        };
        let greeting = engine.session.as_mut().map(Session::greeting);
        engine.greeting = greeting.unwrap_or_default().into();
        u32::from(engine.session.is_some())
    })
}

/// Room for a command of so many bytes.
#[unsafe(no_mangle)]
pub extern "C" fn room(length: u32) -> *mut u8 {
    ENGINE.with_borrow_mut(|engine| {
        engine.room.clear();
        engine.room.resize(length as usize, 0);
        engine.room.as_mut_ptr()
    })
}

/// Does what the command in the room says.
#[unsafe(no_mangle)]
pub extern "C" fn receive() {
    ENGINE.with_borrow_mut(|engine| {
        let command = String::from_utf8_lossy(&engine.room);
        if let Some(session) = &mut engine.session {
            session.receive(&command);
        }
    });
}

/// Steps as the clock says, for a hundredth of a second at most. 1 where there is more to do at once.
#[unsafe(no_mangle)]
pub extern "C" fn advance() -> u32 {
    ENGINE.with_borrow_mut(|engine| {
        engine
            .session
            .as_mut()
            .map_or(0, |s| u32::from(s.advance()))
    })
}

/// Takes out the next message: 0 is none, 1 text, 2 a frame.
#[unsafe(no_mangle)]
pub extern "C" fn next() -> u32 {
    ENGINE.with_borrow_mut(|engine| {
        let greeting = engine.greeting.pop_front();
        // There is one page, to which nothing that it says is news.
        let mut outgoing = || loop {
            match engine.session.as_mut()?.outgoing() {
                Some(Outgoing::News(_)) => {}
                other => return other,
            }
        };
        let (kind, message) = match greeting.or_else(&mut outgoing) {
            None => (0, Vec::new()),
            Some(Outgoing::Text(text) | Outgoing::Refusal(text) | Outgoing::News(text)) => {
                (1, text.into_bytes())
            }
            Some(Outgoing::Frame(bytes)) => (2, bytes),
        };
        engine.message = message;
        kind
    })
}

/// Where the message that was taken out lies, until the next one is.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    ENGINE.with_borrow(|engine| engine.message.as_ptr())
}

/// Its length [bytes].
#[unsafe(no_mangle)]
pub extern "C" fn message_length() -> u32 {
    ENGINE.with_borrow(|engine| engine.message.len() as u32)
}
