//! One page's connection.

use crate::engine::{Engine, Note, Said, mailbox};
use axum::extract::ws::{Message, WebSocket};
use std::sync::mpsc::TrySendError;
use std::time::Duration;
use tokio::sync::mpsc;

/// Commands are shorter than this; longer ones end the connection [bytes].
pub(crate) const LONGEST: usize = 1 << 16;
/// How long to wait where the session has more commands than it can take.
const PATIENCE: Duration = Duration::from_millis(2);

/// Carries messages both ways until either side goes.
pub(crate) async fn attend(mut socket: WebSocket, mut engine: Engine) {
    let (page, mut notes) = mailbox();
    engine.frames.mark_unchanged();
    if !say(&engine, || Said::Hello(page.clone())).await {
        return;
    }
    loop {
        let going = tokio::select! {
            biased;
            note = notes.recv() => match note {
                Some(note) => send(&mut socket, note).await,
                None => false,
            },
            message = socket.recv() => match message {
                Some(Ok(message)) => hear(message, &engine, &page).await,
                _ => false,
            },
            changed = engine.frames.changed() => match changed {
                Ok(()) => {
                    let frame = engine.frames.borrow_and_update().clone();
                    send(&mut socket, Note::Frame(frame)).await
                }
                Err(_) => false,
            },
        };
        if !going {
            return;
        }
    }
}

async fn send(socket: &mut WebSocket, note: Note) -> bool {
    let message = match note {
        Note::Text(text) => Message::Text(text.into()),
        Note::Frame(bytes) => Message::Binary(bytes),
    };
    socket.send(message).await.is_ok()
}

/// Takes what the page says; false where it goes.
async fn hear(message: Message, engine: &Engine, page: &mpsc::Sender<Note>) -> bool {
    let text = match message {
        Message::Text(text) => text.to_string(),
        // No command is: the session says so.
        Message::Binary(_) => String::from("binary message"),
        Message::Ping(_) | Message::Pong(_) => return true,
        Message::Close(_) => return false,
    };
    say(engine, || Said::Command(text.clone(), page.clone())).await
}

/// Hands something to the session as soon as it has room; false where it is gone.
async fn say(engine: &Engine, said: impl Fn() -> Said) -> bool {
    loop {
        match engine.said.try_send(said()) {
            Ok(()) => return true,
            Err(TrySendError::Full(_)) => tokio::time::sleep(PATIENCE).await,
            Err(TrySendError::Disconnected(_)) => return false,
        }
    }
}
