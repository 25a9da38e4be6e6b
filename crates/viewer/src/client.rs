//! One page's connection.

use crate::engine::{Engine, Note, Said, mailbox};
use axum::extract::ws::{Message, WebSocket};
use std::sync::mpsc::TrySendError;
use std::time::Duration;
use tokio::sync::mpsc;

/// Commands are shorter than this, robot files among them; longer ones end the connection [bytes].
/// `web/src/files.ts` knows it.
pub(crate) const LONGEST: usize = 1 << 20;
/// How long to wait where the session has more commands than it can take.
const PATIENCE: Duration = Duration::from_millis(2);

/// How long a page may take to accept a message.
const LONGEST_SEND: Duration = Duration::from_secs(10);

/// Carries messages both ways until either side goes, or the session lets go of the page, which holds its
/// only mailbox.
pub(crate) async fn attend(mut socket: WebSocket, mut engine: Engine) {
    let (page, mut notes) = mailbox();
    let me = page.downgrade();
    engine.frames.mark_unchanged();
    if !say(&engine, Said::Hello(page)).await {
        return;
    }
    loop {
        let going = tokio::select! {
            biased;
            note = notes.recv() => match note {
                Some(note) => {
                    let last = matches!(note, Note::End);
                    send(&mut socket, note).await && !last
                }
                None => false,
            },
            message = socket.recv() => match message {
                Some(Ok(message)) => hear(message, &engine, &me).await,
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

/// Sends a message; false where the page does not take it.
async fn send(socket: &mut WebSocket, note: Note) -> bool {
    let message = match note {
        Note::Text(text) => Message::Text(text.into()),
        Note::Frame(bytes) => Message::Binary(bytes),
        Note::End => Message::Close(None),
    };
    let sent = tokio::time::timeout(LONGEST_SEND, socket.send(message)).await;
    matches!(sent, Ok(Ok(())))
}

/// Takes what the page says; false where it goes, or has been let go.
async fn hear(message: Message, engine: &Engine, me: &mpsc::WeakSender<Note>) -> bool {
    let text = match message {
        Message::Text(text) => text.to_string(),
        // No command is: the session says so.
        Message::Binary(_) => String::from("binary message"),
        Message::Ping(_) | Message::Pong(_) => return true,
        Message::Close(_) => return false,
    };
    match me.upgrade() {
        Some(page) => say(engine, Said::Command(text, page)).await,
        None => false,
    }
}

/// Hands something to the session as soon as it has room; false where it is gone.
async fn say(engine: &Engine, mut said: Said) -> bool {
    loop {
        said = match engine.said.try_send(said) {
            Ok(()) => return true,
            Err(TrySendError::Full(said)) => said,
            Err(TrySendError::Disconnected(_)) => return false,
        };
        tokio::time::sleep(PATIENCE).await;
    }
}
