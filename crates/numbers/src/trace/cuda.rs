//! A record printed as CUDA C++.

use super::operation::Type;
use super::print::{Language, Members, PrintOptions, finite};
use super::program::Program;
use core::convert::Infallible;

/// Blocks side by side on a multiprocessor, at least, where worlds go different ways: threads have 128 registers then. What
/// the ones wait for is hidden by more of the others, while those who go one way, and wait less, gain by more registers.
const SIDE_BY_SIDE: u32 = 8;

/// The operations that CUDA lacks or has other names for.
const PRELUDE: &str = include_str!("prelude.cu");

impl Program {
    /// Prints the record as CUDA C++ with a kernel `step`, for NVRTC or nvcc with `--fmad=false`.
    ///
    /// One thread runs one world after the other: that of its index, and those that lie whole grids beyond it. The kernel takes pointers to state, input,
    /// output, scratch, parameters and links, in this order, and two 32-bit numbers: how many worlds there are and
    /// how often the kernel runs, one time after the other. The memories must not overlap. A world's number at
    /// `offset` lies at `offset · worlds + world`, of scratch and state as [`PrintOptions`] say, which must fit into 32 bits.
    ///
    /// Every operation is rounded as on the CPU, so a thread's results have the bits of the kernel over `f32` (of a
    /// NaN, that it is one).
    ///
    /// # Panics
    /// If it is to work on members of runs, which have no CUDA yet.
    pub fn to_cuda(&self, options: &PrintOptions) -> String {
        assert_eq!(options.members, Members::Worlds, "no CUDA but for worlds");
        let own = options.own_piece();
        let own = own.map_or(String::new(), |own| format!("    const u32 {own};\n"));
        let held = options.held_piece();
        let held = held.map_or(String::new(), |held| format!("    const u32 {held};\n"));
        let [counted, count] = options.counted();
        let list = options.list();
        let [entries, world] = list.map_or(Default::default(), |list| {
            list.map(|line| format!("    const u32 {line};\n"))
        });
        let size = options.workgroup_size;
        let bounds = match self.differs() {
            true => format!("{size}, {SIDE_BY_SIDE}"),
            false => size.to_string(),
        };
        let opening = format!(
            "{PRELUDE}\nextern \"C\" __global__ void __launch_bounds__({bounds}) step(\n    \
             f32* __restrict__ state, const f32* __restrict__ input, f32* __restrict__ output,\n    \
             f32* __restrict__ scratch, const f32* __restrict__ parameters, const u32* __restrict__ links,\n    \
             const u32 worlds, const u32 rounds) {{\n    \
             const u32 index = blockIdx.x * blockDim.x + threadIdx.x;\n\
             {own}{entries}    \
             for (u32 {counted} = index; {counted} < {count}; {counted} += gridDim.x * blockDim.x) {{\n\
             {world}{held}    \
             for (u32 nth = 0u; nth < rounds; nth++) {{\n"
        );
        let Ok(text) = self.print::<Cuda>(options, opening, "    }\n    }\n}\n");
        text
    }
}

struct Cuda;

impl Language for Cuda {
    type Error = Infallible;
    fn constant(kind: Type) -> &'static str {
        match kind {
            Type::Real => "const f32",
            Type::Mask => "const bool",
            Type::Index => "const u32",
        }
    }
    fn variable(kind: Type) -> &'static str {
        match kind {
            Type::Real => "f32",
            Type::Mask => "bool",
            Type::Index => "u32",
        }
    }
    fn number(x: f32) -> Result<String, Infallible> {
        Ok(if x.is_finite() {
            finite(x)
        } else {
            format!("__uint_as_float({:#x}u)", x.to_bits())
        })
    }
}
