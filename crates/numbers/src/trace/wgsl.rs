//! A record printed as a WGSL compute shader.

use super::operation::Type;
use super::print::{Language, PrintOptions, finite};
use super::program::Program;

/// The bindings, and the operations that WGSL lacks or leaves loose.
const PRELUDE: &str = include_str!("prelude.wgsl");

/// Why a record has no WGSL.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WgslError {
    /// WGSL has no way to write an infinity or a NaN.
    #[error("the literal {0} cannot be written in WGSL: use a large finite number")]
    NotFinite(f32),
}

impl Program {
    /// Prints the record as a WGSL shader whose entry point is `main`.
    ///
    /// One invocation runs one world, `global_invocation_id.x`. In group 0 it
    /// binds state (0), input (1), output (2), scratch (3), parameters (4) and
    /// links (5) as storage buffers (1, 4 and 5 read-only) and, as a uniform of two
    /// `u32` (6), the number of worlds and how often the kernel runs, one time
    /// after the other. All seven are declared whether used or
    /// not; a pipeline needs an explicit layout, as one derived from the shader
    /// leaves out the unused. A world's number at `offset` lies at
    /// `offset · worlds + world`.
    ///
    /// A GPU rounds division, `sqrt` and `fma` as WGSL allows, so results agree
    /// with the CPU to a tolerance, not to the bit; and it may take for granted
    /// that no infinity and no NaN comes up.
    pub fn to_wgsl(&self, options: &PrintOptions) -> Result<String, WgslError> {
        let opening = format!(
            "{PRELUDE}\n@compute @workgroup_size({})\n\
             fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {{\n    \
             let world = invocation.x;\n    \
             let worlds = launch.worlds;\n    \
             if (world >= worlds) {{ return; }}\n    \
             for (var nth = 0u; nth < launch.rounds; nth++) {{\n",
            options.workgroup_size
        );
        self.print::<Wgsl>(options, opening)
    }
}

struct Wgsl;

impl Language for Wgsl {
    type Error = WgslError;
    fn constant(_: Type) -> &'static str {
        "let"
    }
    fn variable(_: Type) -> &'static str {
        "var"
    }
    fn number(x: f32) -> Result<String, WgslError> {
        if x.is_finite() {
            Ok(finite(x))
        } else {
            Err(WgslError::NotFinite(x))
        }
    }
}
