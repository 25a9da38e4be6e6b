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
//! Two words w, w' of the four, as u = (w + 1) / 2³² and v = w' / 2³², give two independent normal numbers
//! (Box & Muller 1958), the other two words two more:
//!
//! ```text
//! √(−2 ln u) cos 2πv,   √(−2 ln u) sin 2πv
//! ```
//!
//! In single precision, in lanes: within 1e-5 of the exact ones, and as the lanes' own functions the same on
//! all machines with a fused multiply-add. None is beyond 6.7.

use numbers::dispatch::{Isa, Job, run_block};
use numbers::{Lanes, functions};
use std::f64::consts::TAU;

const M: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const W: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];

/// Words side by side, of so many counters.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Words([u32; BATCH]);

/// Enciphers all counters at once: loops over words that compilers make registers of.
#[inline(always)]
fn philox(c: &mut [Words; 4], k: &mut [Words; 2]) {
    let [c0, c1, c2, c3] = c;
    let [k0, k1] = k;
    for _ in 0..10 {
        for i in 0..BATCH {
            let [first, other] =
                [(M[0], c0.0[i]), (M[1], c2.0[i])].map(|(a, b)| u64::from(a) * u64::from(b));
            c0.0[i] = (other >> 32) as u32 ^ c1.0[i] ^ k0.0[i];
            c1.0[i] = other as u32;
            c2.0[i] = (first >> 32) as u32 ^ c3.0[i] ^ k1.0[i];
            c3.0[i] = first as u32;
            k0.0[i] = k0.0[i].wrapping_add(W[0]);
            k1.0[i] = k1.0[i].wrapping_add(W[1]);
        }
    }
}

/// What a random number is for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Purpose {
    White = 0,
    Walk = 1,
    Bias = 2,
    /// White noise of depth, beside that of colours.
    Depth = 3,
}

/// Which sample of which world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Draw {
    /// The world.
    pub world: usize,
    /// How often the world had begun anew.
    pub episode: u32,
    /// Which sample of its sensor, counted from 0.
    pub sample: u64,
    /// Time since the one before [s].
    pub elapsed: f64,
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
    /// Normal numbers 4 i … 4 i + 3 of a sample come of this counter and key, i below 2³⁰.
    fn counter(&self, purpose: Purpose, draw: Draw, i: usize) -> ([u32; 4], [u32; 2]) {
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
        (counter, key)
    }
    /// Calls `take` with each of n numbers of each sample, and a normal number for it.
    pub fn each(
        &self,
        isa: Isa,
        purpose: Purpose,
        samples: impl Iterator<Item = Draw>,
        n: usize,
        mut take: impl FnMut(&Draw, usize, f64),
    ) {
        let mut batch = Batch::default();
        for draw in samples {
            for i in 0..n.div_ceil(4) {
                batch.push(draw, 4 * i, self.counter(purpose, draw, i));
                if batch.count == BATCH {
                    batch.flush(isa, n, &mut take);
                }
            }
        }
        batch.flush(isa, n, &mut take);
    }
}

/// So many times four numbers are made at once.
const BATCH: usize = 32;

/// A number for each that waits, aligned for any register.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Wide([f32; BATCH]);

/// Numbers in the making.
struct Batch {
    counters: [Words; 4],
    keys: [Words; 2],
    /// Four numbers of each counter.
    numbers: [Wide; 4],
    /// For which sample, and from which number on.
    of: [(Draw, usize); BATCH],
    count: usize,
}

impl Default for Batch {
    fn default() -> Self {
        Self {
            counters: [Words([0; BATCH]); 4],
            keys: [Words([0; BATCH]); 2],
            numbers: [Wide([0.0; BATCH]); 4],
            of: [(Draw::default(), 0); BATCH],
            count: 0,
        }
    }
}

impl Batch {
    fn push(&mut self, draw: Draw, first: usize, (counter, key): ([u32; 4], [u32; 2])) {
        let at = self.count;
        self.of[at] = (draw, first);
        for (words, word) in self.counters.iter_mut().zip(counter) {
            words.0[at] = word;
        }
        for (words, word) in self.keys.iter_mut().zip(key) {
            words.0[at] = word;
        }
        self.count += 1;
    }
    /// Hands out what waits, those of n numbers.
    fn flush(&mut self, isa: Isa, n: usize, take: &mut impl FnMut(&Draw, usize, f64)) {
        run_block(isa, Encipher(&mut self.counters, &mut self.keys));
        run_block(isa, Normal(&self.counters, &mut self.numbers));
        for (i, (draw, first)) in self.of[..self.count].iter().enumerate() {
            let numbers = *first..n.min(first + 4);
            for (number, z) in numbers.zip(&self.numbers) {
                take(draw, number, f64::from(z.0[i]));
            }
        }
        self.count = 0;
    }
}

/// Makes words that look random of counters.
struct Encipher<'a>(&'a mut [Words; 4], &'a mut [Words; 2]);

impl Job for Encipher<'_> {
    type Scalar = f32;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        philox(self.0, self.1);
    }
}

/// Makes normal numbers of words.
struct Normal<'a>(&'a [Words; 4], &'a mut [Wide; 4]);

impl Job for Normal<'_> {
    type Scalar = f32;
    type Output = ();
    const WIDEST: bool = false;
    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        const STEP: f64 = 1.0 / (1_u64 << 32) as f64;
        for (words, pair) in self.0.chunks_exact(2).zip(self.1.chunks_exact_mut(2)) {
            let [u, v] = pair else { continue };
            for i in 0..BATCH {
                u.0[i] = ((f64::from(words[0].0[i]) + 1.0) * STEP) as f32;
                v.0[i] = (f64::from(words[1].0[i]) * STEP) as f32;
            }
            let u: &mut [R] = bytemuck::cast_slice_mut(&mut u.0);
            let v: &mut [R] = bytemuck::cast_slice_mut(&mut v.0);
            for (u, v) in u.iter_mut().zip(v) {
                let radius = (functions::log(*u) * R::lit(-2.0)).sqrt();
                let (sin, cos) = functions::sin_cos(*v * R::lit(TAU));
                (*u, *v) = (radius * cos, radius * sin);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a counter and a key give.
    fn words((counter, key): ([u32; 4], [u32; 2])) -> [u32; 4] {
        let mut c = counter.map(|word| Words([word; BATCH]));
        let mut k = key.map(|word| Words([word; BATCH]));
        philox(&mut c, &mut k);
        c.map(|words| words.0[BATCH - 1])
    }

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
            assert_eq!(words((counter, key)), answer);
        }
    }

    /// All instruction sets against double precision.
    #[test]
    fn numbers_are_those_of_box_and_muller() {
        let source = Source::new(3, "imu");
        let draw = |sample| Draw {
            sample,
            ..Draw::default()
        };
        let expected = |sample: u64, number: usize| {
            let words = words(source.counter(Purpose::White, draw(sample), number / 4));
            let pair = &words[number % 4 / 2 * 2..];
            let scale = 2_f64.powi(-32);
            let radius = (-2.0 * ((f64::from(pair[0]) + 1.0) * scale).ln()).sqrt();
            let (sin, cos) = (TAU * f64::from(pair[1]) * scale).sin_cos();
            radius * if number & 1 == 0 { cos } else { sin }
        };
        for isa in Isa::available() {
            let mut taken = 0;
            let samples = (0..1000).map(draw);
            source.each(isa, Purpose::White, samples, 7, |draw, number, z| {
                assert_eq!((draw.sample as usize, number), (taken / 7, taken % 7));
                let exact = expected(draw.sample, number);
                assert!((z - exact).abs() < 1e-5, "{isa}: {z} {exact}");
                taken += 1;
            });
            assert_eq!(taken, 7000);
        }
    }

    /// Words at their ends give numbers, and the largest there are: √(2 · 32 ln 2) = 6.66.
    #[test]
    fn the_ends_of_the_range_give_numbers() {
        for isa in Isa::available() {
            let words = [0, 0, u32::MAX, u32::MAX].map(|word| Words([word; BATCH]));
            let mut numbers = [Wide([0.0; BATCH]); 4];
            run_block(isa, Normal(&words, &mut numbers));
            let found = numbers.map(|numbers| numbers.0[0]);
            assert!(
                (found[0] - 6.6604).abs() < 1e-3 && found[1].abs() < 1e-5,
                "{found:?}"
            );
            assert!(found[2].abs() < 1e-3 && found[3].abs() < 1e-3, "{found:?}");
        }
    }

    /// Mean, variance, fourth moment (3) and correlation of neighbours of n normal numbers are off by
    /// 1/√n, √(2/n), √(96/n), 1/√n in standard deviation; five of these are allowed.
    #[test]
    fn numbers_are_normal_and_independent() {
        let source = Source::new(7, "imu");
        let n = 100_000;
        let samples = (0..n).map(|sample| Draw {
            world: 3,
            episode: 1,
            sample,
            elapsed: 0.0,
        });
        let mut x = vec![];
        source.each(Isa::detect(), Purpose::White, samples, 1, |_, _, z| {
            x.push(z)
        });
        let n = n as f64;
        let moment = |power: i32| x.iter().map(|x| x.powi(power)).sum::<f64>() / n;
        assert!(moment(1).abs() < 5.0 / n.sqrt());
        assert!((moment(2) - 1.0).abs() < 5.0 * (2.0 / n).sqrt());
        assert!((moment(4) - 3.0).abs() < 5.0 * (96.0 / n).sqrt());
        let neighbours = x.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
        assert!(neighbours.abs() < 5.0 / n.sqrt());
    }
}
