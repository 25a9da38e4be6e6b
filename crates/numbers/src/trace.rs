//! A kernel recorded instead of run.
//!
//! [`record`] runs a kernel once over a [`Tracer`]. Its numbers are handles
//! ([`Trace`]): an operation on them computes nothing and adds an instruction
//! to the record, unless all its operands are literals, which fold to a literal
//! with the arithmetic of `f32`. What comes out is a [`Program`]: straight
//! instructions, each the single assignment of a value, with nested blocks for
//! loops and branches. It prints as WGSL ([`Program::to_wgsl`]) and as CUDA C++
//! ([`Program::to_cuda`]), and runs on the CPU ([`Program::interpret`]) with the bits of the kernel over `f32`.
//!
//! ```
//! use kinetarium_numbers::{Machine, Real, Table, machine::space::State, trace};
//!
//! fn halve<M: Machine>(k: &mut M, bodies: Table<State>, n: usize) {
//!     for b in k.count(n) {
//!         let x = k.load(bodies, b, 0);
//!         k.store(bodies, b, 0, x * M::R::lit(0.5));
//!     }
//! }
//!
//! let bodies = Table::place(&mut 0, 10);
//! let program = trace::record(|k| halve(k, bodies, 10))?;
//! let shader = program.to_wgsl(&trace::PrintOptions::default())?;
//! assert!(shader.contains("for (var i0 = 0u; i0 < 10u; i0++)"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limitations
//! The body of a loop is recorded twice and both records must agree, which
//! exposes most values that a kernel carries in a `let mut` from one round to
//! the next, and every value that leaves the block it was made in. A *literal*
//! assigned in a block and used after it looks like any other literal and goes
//! unnoticed. Indices are 32 bits wide.

mod cuda;
mod graph;
mod interpret;
mod machine;
mod number;
mod operation;
mod print;
mod program;
mod wgsl;

pub use graph::TraceError;
pub use interpret::{InterpretError, Work};
pub use machine::{TraceBranch, TraceCell, TraceRounds, Tracer, record};
pub use number::{Trace, TraceIndex, TraceMask};
pub use print::{Members, PIECE, PrintOptions, finite};
pub use program::{Operations, Program};
pub use wgsl::WgslError;
