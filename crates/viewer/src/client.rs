//! One page's connection.

use crate::engine::{Engine, FAREWELL, Note, Said, mailbox};
use axum::body::Bytes;
use axum::extract::ws::{Message, WebSocket};
use session::frame::scene_of;
use session::{Told, Wardrobe};
use std::future::ready;
use std::sync::mpsc::TrySendError;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

/// Commands are shorter than this, robot files among them; longer ones end the connection [bytes].
/// `web/src/files.ts` knows it.
pub(crate) const LONGEST: usize = 1 << 20;
/// How long to wait where the session has more commands than it can take.
const PATIENCE: Duration = Duration::from_millis(2);

/// How long a page may take to accept a message, and to get a frame.
const LONGEST_SEND: Duration = Duration::from_secs(10);
/// And longer for each so many bytes of a text, which may be a picture for a skin.
const BYTES_A_SECOND: usize = 1 << 18;

/// Frames that may be on their way to a page. More would lie in the buffers of a slow line, and come late.
const ON_THEIR_WAY: u32 = 4;

/// Frames that a page was sent, and those that it has. Each is followed by a ping with its number, which browsers
/// answer as soon as they have read so far.
#[derive(Clone, Copy, Debug)]
struct Frames {
    sent: u32,
    there: u32,
    /// By when the next one must be there.
    due: Instant,
}

impl Frames {
    fn new() -> Self {
        Self {
            sent: 0,
            there: 0,
            due: Instant::now(),
        }
    }
    fn may_go(&self) -> bool {
        self.sent.wrapping_sub(self.there) < ON_THEIR_WAY
    }
    /// The number of the frame that goes.
    fn go(&mut self) -> u32 {
        self.sent = self.sent.wrapping_add(1);
        self.due = Instant::now() + LONGEST_SEND;
        self.sent
    }
    /// Takes note of an answer; what is none says nothing.
    fn answered(&mut self, pong: &[u8]) {
        if let Ok(number) = pong.try_into().map(u32::from_be_bytes)
            && self.sent.wrapping_sub(number) < self.sent.wrapping_sub(self.there)
        {
            self.there = number;
            self.due = Instant::now() + LONGEST_SEND;
        }
    }
}

/// Carries messages both ways until either side goes, or the session lets go of the page, which holds its
/// only mailbox.
pub(crate) async fn attend(mut socket: WebSocket, mut engine: Engine) {
    let (page, mut notes) = mailbox();
    let me = page.downgrade();
    let mut frames = Frames::new();
    let mut told = Told::default();
    // Of a frame that has come, notes that came before it are sent first: its scene may be among them.
    let mut fresh = false;
    engine.frames.mark_unchanged();
    if !say(&engine, Said::Hello(page)).await {
        return;
    }
    loop {
        let going = tokio::select! {
            biased;
            note = notes.recv() => match note {
                Some(Note::Frame(frame)) => show(&mut socket, frame, &engine.wardrobe, &mut told).await,
                Some(note) => {
                    let last = matches!(note, Note::End);
                    let sent = send(&mut socket, note).await;
                    if last {
                        hear_out(&mut socket).await;
                    }
                    sent && !last
                }
                None => false,
            },
            message = socket.recv() => match message {
                Some(Ok(Message::Pong(number))) => {
                    frames.answered(&number);
                    true
                }
                Some(Ok(message)) => hear(message, &engine, &me).await,
                _ => false,
            },
            () = ready(()), if fresh => {
                fresh = false;
                let frame = engine.frames.borrow_and_update().clone();
                let number = Note::Number(frames.go());
                show(&mut socket, frame, &engine.wardrobe, &mut told).await
                    && send(&mut socket, number).await
            },
            changed = engine.frames.changed(), if frames.may_go() => {
                fresh = true;
                changed.is_ok()
            },
            () = sleep_until(frames.due), if !frames.may_go() => false,
        };
        if !going {
            return;
        }
    }
}

/// Sends a frame, and what is new of the skins of its bodies.
async fn show(socket: &mut WebSocket, frame: Bytes, wardrobe: &Wardrobe, told: &mut Told) -> bool {
    let scene = scene_of(&frame);
    let mut sent = send(socket, Note::Frame(frame)).await;
    for text in scene.map_or(Vec::new(), |scene| wardrobe.news(scene, told)) {
        sent = sent && send(socket, Note::Text(text)).await;
    }
    sent
}

/// Sends a message; false where the page does not take it.
async fn send(socket: &mut WebSocket, note: Note) -> bool {
    let longest = match &note {
        Note::Text(text) => {
            LONGEST_SEND + Duration::from_secs((text.len() / BYTES_A_SECOND) as u64)
        }
        _ => LONGEST_SEND,
    };
    let message = match note {
        Note::Text(text) => Message::Text(text.into()),
        Note::Frame(bytes) => Message::Binary(bytes),
        Note::Number(number) => Message::Ping(number.to_be_bytes().to_vec().into()),
        Note::End => Message::Close(None),
    };
    let sent = tokio::time::timeout(longest, socket.send(message)).await;
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

/// Reads what the page says before it knows that this is the end: a connection that is closed on words of the other
/// side is reset, and what that had not read is lost.
async fn hear_out(socket: &mut WebSocket) {
    let rest = async { while let Some(Ok(_)) = socket.recv().await {} };
    // Who says nothing for so long has gone, or will miss no more than the end.
    let _ = tokio::time::timeout(FAREWELL[0], rest).await;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames go as long as those before them come; what answers nothing that was sent lets none go.
    #[test]
    fn frames_wait_for_those_that_are_on_their_way() {
        let mut frames = Frames::new();
        frames.sent = u32::MAX - 2;
        frames.there = frames.sent;
        let go = |frames: &mut Frames| {
            let going = std::iter::from_fn(|| frames.may_go().then(|| frames.go()));
            going.collect::<Vec<_>>()
        };
        assert_eq!(go(&mut frames), [u32::MAX - 1, u32::MAX, 0, 1]);
        for wrong in [&[][..], &[0; 3], &2_u32.to_be_bytes(), &9_u32.to_be_bytes()] {
            frames.answered(wrong);
            assert!(!frames.may_go(), "{wrong:?}");
        }
        frames.answered(&0_u32.to_be_bytes());
        assert_eq!(go(&mut frames), [2, 3, 4]);
        frames.answered(&u32::MAX.to_be_bytes());
        assert!(!frames.may_go());
    }
}
