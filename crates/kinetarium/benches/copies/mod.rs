//! How fast a card copies within its memory: what the bytes that a step moves are held to.

use kinetarium::sim::DeviceError;
use piles::{Card, Commands, NUMBER};
use std::iter::once;
use std::time::Instant;

/// Words of a copy, where a buffer takes them: more than caches hold.
const WORDS: u64 = 1 << 26;
const COPIES: usize = 20;
const REPETITIONS: usize = 5;

/// Bytes that it reads and writes in a second, the median.
pub fn bandwidth<C: Card>(card: &C) -> Result<f64, DeviceError> {
    let words = WORDS.min(card.most_bytes() / NUMBER);
    let [from, to] = [card.buffer(words)?, card.buffer(words)?];
    let mut staging = C::Staging::default();
    let mut timed = |copies: usize| {
        let begin = Instant::now();
        let mut todo = card.commands(None);
        for _ in 0..copies {
            todo.copy(&from, 0..words as usize, &to, 0);
        }
        card.fetch(todo, &mut staging, &to, once(0..1), |_| ())?;
        Ok::<_, DeviceError>(begin.elapsed().as_secs_f64())
    };
    timed(1)?;
    let mut rates = Vec::new();
    for _ in 0..REPETITIONS {
        rates.push((2 * words * NUMBER) as f64 * COPIES as f64 / timed(COPIES)?);
    }
    rates.sort_by(f64::total_cmp);
    Ok(rates[REPETITIONS / 2])
}
