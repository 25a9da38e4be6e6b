//! One entry per instruction set around a whole block of work, chosen at run time.
//!
//! A [`Job`] is generic over its numbers. [`run_block`] runs it with a register
//! full of worlds, [`run_single`] with one world. The entry function carries the
//! `target_feature`; all below it is inlined into it, so that a job pays for the
//! choice once, and one binary serves all machines. Hence loops belong inside a
//! job, not around it.
//!
//! The entries are `#[inline]` although none is ever inlined (no caller has their
//! instructions): it lets each job be compiled where it is used, in parallel.

#![allow(unsafe_code)] // calls of the entries, after detection

use crate::{Float, Lanes};
use core::fmt;
use core::str::FromStr;

/// Work that is written for any number of worlds side by side.
///
/// `run` and all it calls must be `#[inline(always)]`: what is not inlined into
/// the entry is compiled without its instructions, and is many times slower.
pub trait Job {
    /// The precision.
    type Scalar: Float;
    /// What it answers.
    type Output;
    /// Whether one world is to be compiled for the 32 registers of AVX-512, besides the 16 of AVX2:
    /// up to a tenth faster, for a fifth more time to compile.
    const MANY_REGISTERS: bool = false;
    /// Whether a block is to be compiled for AVX-512, besides AVX2, which gives the same bits: worth its
    /// while to compile for what takes much of the time.
    const WIDEST: bool = true;
    /// Does the work, reading numbers as `R`.
    fn run<R: Lanes<Scalar = Self::Scalar>>(self) -> Self::Output;
}

/// An instruction set which this machine has.
///
/// The variants cannot be constructed outside this crate, so that a value is
/// proof of detection; see [`Isa::detect`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Isa {
    /// AVX-512 F, BW, CD, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    #[non_exhaustive]
    Avx512,
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    #[non_exhaustive]
    Avx2,
    /// NEON.
    #[cfg(target_arch = "aarch64")]
    #[non_exhaustive]
    Neon,
    /// WebAssembly's 128-bit vectors.
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    #[non_exhaustive]
    Simd128,
    /// Arrays; no fused multiply-add.
    #[non_exhaustive]
    Portable,
}

/// An instruction set that cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum IsaError {
    /// The name means nothing.
    #[error("unknown instruction set `{0}`; known are {known}", known = NAMES.join(", "))]
    Unknown(String),
    /// The name is known, but this machine or build has no such instructions.
    #[error(
        "instruction set `{0}` is not available on this machine; available are {available}",
        available = available_names()
    )]
    Unavailable(String),
}

/// All names, whatever the machine.
const NAMES: [&str; 5] = ["avx512", "avx2", "neon", "simd128", "portable"];

/// Variable that overrides [`Isa::detect`] in [`Isa::from_env`].
pub const VARIABLE: &str = "KINETARIUM_ISA";

fn available_names() -> String {
    let names: Vec<_> = Isa::available().iter().map(Isa::to_string).collect();
    names.join(", ")
}

impl Isa {
    /// All that this machine has, the fastest first.
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let widest = {
            let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            let avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512cd")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl");
            [
                (avx2 && avx512).then_some(Self::Avx512),
                avx2.then_some(Self::Avx2),
            ]
        };
        #[cfg(target_arch = "aarch64")]
        let widest = [Some(Self::Neon)];
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        let widest = [Some(Self::Simd128)];
        #[cfg(not(any(
            target_arch = "x86_64",
            target_arch = "aarch64",
            all(target_arch = "wasm32", target_feature = "simd128")
        )))]
        let widest = [None; 0];
        let portable = [Some(Self::Portable)];
        widest.into_iter().chain(portable).flatten().collect()
    }

    /// The fastest that this machine has.
    pub fn detect() -> Self {
        Self::available()[0]
    }

    /// The one that the variable `KINETARIUM_ISA` names, else the fastest.
    ///
    /// # Errors
    /// The variable holds a name that is unknown, or not available here.
    pub fn from_env() -> Result<Self, IsaError> {
        match std::env::var_os(VARIABLE) {
            Some(name) => name.to_string_lossy().parse(),
            None => Ok(Self::detect()),
        }
    }

    /// Whether its multiply-add rounds once.
    pub fn fused(self) -> bool {
        match self {
            Self::Portable => false,
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Self::Simd128 => false,
            #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
            _ => true,
        }
    }

    /// Worlds that its registers hold side by side in [`run_registers`]; 1 where it has none so wide.
    pub fn width<T: Float>(self) -> usize {
        if self == Self::Portable { 1 } else { T::BLOCK }
    }

    /// The name, as [`FromStr`] reads it.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "aarch64")]
            Self::Neon => "neon",
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            Self::Simd128 => "simd128",
            Self::Portable => "portable",
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Isa {
    type Err = IsaError;
    fn from_str(name: &str) -> Result<Self, IsaError> {
        if let Some(isa) = Self::available().into_iter().find(|isa| isa.name() == name) {
            Ok(isa)
        } else if NAMES.contains(&name) {
            Err(IsaError::Unavailable(name.to_owned()))
        } else {
            Err(IsaError::Unknown(name.to_owned()))
        }
    }
}

/// Runs a job with [`Float::BLOCK`] worlds side by side, in arrays where registers are not so wide.
#[inline]
pub fn run_block<J: Job>(isa: Isa, job: J) -> J::Output {
    if isa == Isa::Portable {
        entry_portable(job)
    } else {
        run_registers(isa, job)
    }
}

/// Runs a job with [`Isa::width`] worlds side by side: with a block in registers, or with one world.
///
/// For jobs so large that compiling them for arrays would take longer than for all else.
#[inline]
pub fn run_registers<J: Job>(isa: Isa, job: J) -> J::Output {
    run_lanes(isa, false, job)
}

/// As [`run_registers`], but with AVX-512 only: gives the job back where the machine has none.
///
/// For what is compiled once more to be faster there.
///
/// # Errors
/// The job, not begun.
#[inline]
pub fn run_widest<J: Job>(isa: Isa, job: J) -> Result<J::Output, J> {
    match isa {
        // SAFETY: an `Isa` exists only where its instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => Ok(unsafe { entry_avx512(job) }),
        _ => Err(job),
    }
}

/// Runs a job with one world, with the same bits as [`run_block`] on the same `isa`.
#[inline]
pub fn run_single<J: Job>(isa: Isa, job: J) -> J::Output {
    run_lanes(isa, true, job)
}

/// As [`run_single`] or as [`run_registers`].
///
/// What has no target feature of its own is compiled into whoever calls it, so it is called in one place.
#[inline]
#[allow(unused_variables)] // `single`, where there are no registers to choose
pub fn run_lanes<J: Job>(isa: Isa, single: bool, job: J) -> J::Output {
    match isa {
        // SAFETY: an `Isa` exists only where its instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 if single && J::MANY_REGISTERS => unsafe { entry_fma512(job) },
        // SAFETY: an `Isa` exists only where its instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 | Isa::Avx2 if single => unsafe { entry_fma(job) },
        // SAFETY: an `Isa` exists only where its instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 if J::WIDEST => unsafe { entry_avx512(job) },
        // SAFETY: an `Isa` exists only where its instructions were detected.
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 | Isa::Avx2 => unsafe { entry_avx2(job) },
        #[cfg(target_arch = "aarch64")]
        Isa::Neon if single => entry_scalar(job),
        #[cfg(target_arch = "aarch64")]
        Isa::Neon => entry_neon(job),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Isa::Simd128 if !single => entry_simd128(job),
        _ => entry_unfused(job),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma")]
#[inline]
unsafe fn entry_avx512<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Avx512>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline]
unsafe fn entry_avx2<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Avx2>()
}

/// One world, with 32 registers for its numbers: 8 % faster than with 16 on a humanoid's step.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma")]
#[inline]
unsafe fn entry_fma512<J: Job>(job: J) -> J::Output {
    job.run::<J::Scalar>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
#[inline]
unsafe fn entry_fma<J: Job>(job: J) -> J::Output {
    job.run::<J::Scalar>()
}

#[cfg(target_arch = "aarch64")]
#[inline]
fn entry_neon<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Neon>()
}

#[cfg(target_arch = "aarch64")]
#[inline]
fn entry_scalar<J: Job>(job: J) -> J::Output {
    job.run::<J::Scalar>()
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
#[inline]
fn entry_simd128<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Simd128>()
}

#[inline]
fn entry_portable<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Portable>()
}

#[inline]
fn entry_unfused<J: Job>(job: J) -> J::Output {
    job.run::<<J::Scalar as Float>::Unfused>()
}
