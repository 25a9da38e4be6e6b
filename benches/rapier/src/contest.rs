//! Engines that step the same scene in turns.

use crate::engine::{Engine, OURS, Outcome};
use crate::ours::ours;
use crate::peer::Peer;
use kinetarium::prelude::*;
use std::time::Instant;

/// Steps before the first that is timed: the solids of a bowl have reached the heap.
pub const LEAD: usize = 250;
/// Steps of a round, where not too slow.
pub const ROUND: usize = 50;
/// Steps after which it is measured how far the tops have come down.
pub const DROP_AT: usize = 500;
/// Rounds until then.
pub const FEWEST_ROUNDS: usize = (DROP_AT - LEAD) / ROUND;
/// Steps after which solids lie still in any bowl.
pub const REST_AT: usize = 800;

/// What one engine did.
#[derive(Debug)]
pub struct Measured {
    pub engine: &'static str,
    /// Median over the rounds [s].
    pub seconds_per_step: f64,
    /// How far the tops came down [m].
    pub drop: Option<Descent>,
    /// How many points of contact pressed in the end.
    pub points: Option<usize>,
}

/// Of several bodies [m].
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    pub mean: f64,
    pub most: f64,
}

pub struct Contest {
    engines: Vec<Box<dyn Engine>>,
}

impl Contest {
    pub fn new(model: &Model, threads: usize, only_rapier: bool) -> Outcome<Self> {
        let mut engines: Vec<Box<dyn Engine>> = Vec::new();
        if !only_rapier {
            engines.push(Box::new(ours(model, threads)?));
        }
        engines.push(Box::new(Peer::new(model, threads)?));
        engines.push(Box::new(Peer::fitted(model, threads)?));
        Ok(Self { engines })
    }

    /// Steps each engine in turns, `steps` a round, and measures the drop of some bodies on the way.
    pub fn run(&mut self, rounds: usize, steps: usize, tops: &[BodyId]) -> Outcome<Vec<Measured>> {
        let starts: Vec<_> = self.each(|engine| heights(engine, tops));
        self.each(|engine| engine.step(LEAD));
        let mut times = vec![Vec::new(); self.engines.len()];
        let mut drops = starts.clone();
        for round in 1..=rounds {
            self.round(round, steps, &mut times);
            if LEAD + round * steps == DROP_AT {
                drops = self.each(|engine| heights(engine, tops));
            }
        }
        let mut results = Vec::new();
        for (i, engine) in self.engines.iter_mut().enumerate() {
            engine.check()?;
            results.push(Measured {
                engine: engine.name(),
                seconds_per_step: median(&mut times[i]) / steps as f64,
                drop: drop_of(&starts[i], &drops[i]),
                points: engine.points(),
            });
        }
        Ok(results)
    }

    /// One round of each engine; who is first changes from round to round.
    fn round(&mut self, round: usize, steps: usize, times: &mut [Vec<f64>]) {
        let count = self.engines.len();
        for turn in 0..count {
            let i = (round + turn) % count;
            let begin = Instant::now();
            self.engines[i].step(steps);
            times[i].push(begin.elapsed().as_secs_f64());
        }
    }

    fn each<T>(&mut self, mut act: impl FnMut(&mut dyn Engine) -> T) -> Vec<T> {
        let engines = self.engines.iter_mut();
        engines.map(|engine| act(engine.as_mut())).collect()
    }
}

/// Our time for a step of a scene in which all has come to rest.
pub fn at_rest(model: &Model, threads: usize, rounds: usize, steps: usize) -> Outcome<Measured> {
    let mut engine = ours(model, threads)?;
    Engine::step(&mut engine, REST_AT);
    let mut seconds = Vec::new();
    for _ in 0..rounds {
        let begin = Instant::now();
        Engine::step(&mut engine, steps);
        seconds.push(begin.elapsed().as_secs_f64());
    }
    engine.check()?;
    Ok(Measured {
        engine: OURS,
        seconds_per_step: median(&mut seconds) / steps as f64,
        drop: None,
        points: engine.points(),
    })
}

fn heights(engine: &mut dyn Engine, bodies: &[BodyId]) -> Vec<f64> {
    bodies.iter().map(|body| engine.position(*body).y).collect()
}

/// How far bodies came down, those that went furthest up or down as `most`.
fn drop_of(before: &[f64], after: &[f64]) -> Option<Descent> {
    let drops: Vec<f64> = before.iter().zip(after).map(|(a, b)| a - b).collect();
    let most = drops
        .iter()
        .copied()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let mean = drops.iter().sum::<f64>() / drops.len() as f64;
    Some(Descent { mean, most })
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 {
        values[middle]
    } else {
        0.5 * (values[middle - 1] + values[middle])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::top_of_tower;
    use std::f64::consts::TAU;

    /// Two towers of three boxes of 1 kg: each top comes down by 3 mm.
    ///
    /// In Rapier they sink besides: contacts are springs of m ω², with ω = 2π · 30 Hz and m = ½ kg
    /// between two boxes, 60 Hz and 1 kg on the ground, under the weight of 1, 2 and 3 boxes.
    #[test]
    fn small_towers_stand_in_all_engines() {
        let (weight, omega) = (9.81, TAU * 30.0);
        let sunk =
            (1.0 + 2.0) * weight / (0.5 * omega * omega) + 3.0 * weight / (4.0 * omega * omega);
        let model = examples::towers(2, 3).unwrap();
        let tops = [0, 1].map(|tower| model.body(&top_of_tower(tower, 3)).unwrap());
        for threads in [1, 2] {
            let mut contest = Contest::new(&model, threads, false).unwrap();
            let results = contest.run(FEWEST_ROUNDS, ROUND, &tops).unwrap();
            assert_eq!(results.len(), 3);
            let expected = [0.003, 0.003 + sunk, 0.003 + sunk];
            for (measured, expected) in results.iter().zip(expected) {
                let drop = measured.drop.unwrap();
                assert!((drop.most - expected).abs() < 1e-4, "{measured:?}");
                assert!(measured.seconds_per_step > 0.0);
            }
        }
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
    }

    #[test]
    fn what_rises_counts_as_the_furthest_too() {
        let drop = drop_of(&[1.0, 1.0], &[0.9, 1.3]).unwrap();
        assert!((drop.most + 0.3).abs() < 1e-12 && (drop.mean + 0.1).abs() < 1e-12);
        assert!(drop_of(&[], &[]).is_none());
    }
}
