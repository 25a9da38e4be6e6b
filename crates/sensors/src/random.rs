//! Random numbers that are a function of where they are used.
//!
//! Philox4x32-10 (Salmon, Moraes, Dror, Shaw, *Parallel random numbers: as easy as 1, 2, 3*, 2011, §3.3)
//! enciphers a counter of four words under a key of two: ten rounds of
//!
//! ```text
//! (c₀, c₁, c₂, c₃) ← (hi(M₁ c₂) ⊕ c₁ ⊕ k₀, lo(M₁ c₂), hi(M₀ c₀) ⊕ c₃ ⊕ k₁, lo(M₀ c₀)),   k ← k + W
//! ```
//!
//! The key is of the seed and the sensor's name, the counter of sample, world and number: so a number is
//! the same whatever else is drawn, in whichever order, by however many threads.
//!
//! Two words of 53 random bits each, u in (0, 1] and v in [0, 1), give two independent normal numbers
//! (Box & Muller 1958):
//!
//! ```text
//! √(−2 ln u) cos 2πv,   √(−2 ln u) sin 2πv
//! ```
//!
//! The functions are those of kernels on plain scalars, so that the bits are the same on every machine.

use numbers::{Float, Real, functions};
use std::f64::consts::TAU;

/// Numbers of kernels without a fused multiply-add.
type Plain = <f64 as Float>::Unfused;

const M: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const W: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

fn philox(mut c: [u32; 4], mut k: [u32; 2]) -> [u32; 4] {
    let halves = |a: u32, b: u32| {
        let product = u64::from(a) * u64::from(b);
        ((product >> 32) as u32, product as u32)
    };
    for _ in 0..10 {
        let (high, low) = halves(M[0], c[0]);
        let (other_high, other_low) = halves(M[1], c[2]);
        c = [other_high ^ c[1] ^ k[0], other_low, high ^ c[3] ^ k[1], low];
        k = [k[0].wrapping_add(W[0]), k[1].wrapping_add(W[1])];
    }
    c
}

/// What a random number is for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    White = 0,
    Walk = 1,
    Bias = 2,
}

/// Which sample of which world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw {
    pub world: usize,
    /// How often the world had begun anew.
    pub episode: u32,
    pub sample: u64,
}

/// The random numbers of a sensor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    key: u64,
}

impl Source {
    /// Of the seed and the sensor's name: FNV-1a (Fowler, Noll, Vo) over both, mixed as SplitMix64 does
    /// (Steele, Lea, Flood 2014).
    pub fn new(seed: u64, name: &str) -> Self {
        let bytes = seed.to_le_bytes().into_iter().chain(name.bytes());
        let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mixed = (hash ^ (hash >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        Self {
            key: mixed ^ (mixed >> 31),
        }
    }
    /// Normal numbers 2 i and 2 i + 1 of a sample, i below 2³⁰.
    pub fn pair(&self, purpose: Purpose, draw: Draw, i: usize) -> [f64; 2] {
        let counter = [
            draw.sample as u32,
            draw.episode,
            draw.world as u32,
            i as u32 | (purpose as u32) << 30,
        ];
        let key = [
            self.key as u32,
            (self.key >> 32) as u32 ^ (draw.sample >> 32) as u32,
        ];
        normal_pair(philox(counter, key))
    }
    /// Calls `take` with each of n numbers and a normal number for it.
    pub fn each(&self, purpose: Purpose, draw: Draw, n: usize, mut take: impl FnMut(usize, f64)) {
        for i in 0..n.div_ceil(2) {
            let [a, b] = self.pair(purpose, draw, i);
            take(2 * i, a);
            if 2 * i + 1 < n {
                take(2 * i + 1, b);
            }
        }
    }
}

fn normal_pair([a, b, c, d]: [u32; 4]) -> [f64; 2] {
    const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
    let bits = |low: u32, high: u32| (u64::from(high) << 32 | u64::from(low)) >> 11;
    let u = (bits(a, b) + 1) as f64 * STEP;
    let v = bits(c, d) as f64 * STEP;
    let ln = functions::log(Plain::splat(u));
    let radius = (ln * Plain::lit(-2.0)).sqrt();
    let (sin, cos) = functions::sin_cos(Plain::splat(TAU * v));
    [radius * cos, radius * sin].map(bytemuck::cast)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The authors' own: `kat_vectors` of Random123.
    #[test]
    fn philox_gives_the_known_answers() {
        for (counter, key, answer) in [
            (
                [0; 4],
                [0; 2],
                [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8],
            ),
            (
                [u32::MAX; 4],
                [u32::MAX; 2],
                [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd],
            ),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ] {
            assert_eq!(philox(counter, key), answer);
        }
    }

    /// The kernels' functions against the machine's own: within their bounds of 2 ulp.
    #[test]
    fn pairs_are_those_of_box_and_muller() {
        for words in [
            [0; 4],
            [u32::MAX; 4],
            [1, 2, 3, 4],
            [9, 1 << 31, 5, 3 << 30],
        ] {
            let bits = |low: u32, high: u32| (u64::from(high) << 32 | u64::from(low)) >> 11;
            let scale = 2_f64.powi(-53);
            let u = (bits(words[0], words[1]) + 1) as f64 * scale;
            let v = bits(words[2], words[3]) as f64 * scale;
            let radius = (-2.0 * u.ln()).sqrt();
            let expected = [radius * (TAU * v).cos(), radius * (TAU * v).sin()];
            for (found, expected) in normal_pair(words).into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-14, "{found} {expected}");
            }
        }
    }

    /// Mean, variance, fourth moment (3) and correlation of neighbours of n normal numbers are off by
    /// 1/√n, √(2/n), √(96/n), 1/√n in standard deviation; five of these are allowed.
    #[test]
    fn numbers_are_normal_and_independent() {
        let source = Source::new(7, "imu");
        let n = 100_000;
        let draw = |sample: usize| Draw {
            world: 3,
            episode: 1,
            sample: sample as u64,
        };
        let x: Vec<f64> = (0..n)
            .map(|i| source.pair(Purpose::White, draw(i), 0)[0])
            .collect();
        let n = n as f64;
        let moment = |power: i32| x.iter().map(|x| x.powi(power)).sum::<f64>() / n;
        assert!(moment(1).abs() < 5.0 / n.sqrt());
        assert!((moment(2) - 1.0).abs() < 5.0 * (2.0 / n).sqrt());
        assert!((moment(4) - 3.0).abs() < 5.0 * (96.0 / n).sqrt());
        let neighbours = x.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
        assert!(neighbours.abs() < 5.0 / n.sqrt());
    }
}
