//! Prints, for each example of the gallery, a hash of its frame after 100 steps: the same wherever numbers
//! are the same to the bit.
//!
//! `KINETARIUM_ISA=portable cargo run --release -p kinetarium-session --example frames` agrees with the
//! engine in a browser, which has no fused multiply-add either.

use kinetarium_session::frame::HEADER;
use kinetarium_session::{EXAMPLES, Outgoing, Session};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for example in &EXAMPLES {
        let mut session = Session::example(example.name, || 0.0)?;
        session.receive(r#"{"type": "step", "steps": 100}"#);
        while session.advance() {}
        let mut last = Vec::new();
        while let Some(outgoing) = session.outgoing() {
            if let Outgoing::Frame(bytes) = outgoing {
                last = bytes;
            }
        }
        println!("{} {:016x}", example.name, hash(&last[HEADER..]));
    }
    Ok(())
}

/// FNV-1a (Fowler, Noll, Vo).
fn hash(bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}
