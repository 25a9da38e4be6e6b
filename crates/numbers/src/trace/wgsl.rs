//! A record printed as a WGSL compute shader.

use super::operation::Type;
use super::print::{Language, Members, PrintOptions, finite};
use super::program::Program;

const OPERATIONS: &str = include_str!("operations.wgsl");
/// The bindings.
const WORLDS: &str = include_str!("worlds.wgsl");
const RUNS: &str = include_str!("runs.wgsl");

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
    /// One invocation runs one world after the other: that of its index, `global_invocation_id.x`, and
    /// those that lie whole launches beyond it. In group 0 it binds state (0), input (1), output (2), scratch (3), parameters (4) and
    /// links (5) as storage buffers (1, 4 and 5 read-only) and, as a uniform of two
    /// `u32` (6), the number of worlds and how often the kernel runs, one time
    /// after the other. All seven are declared whether used or
    /// not; a pipeline needs an explicit layout, as one derived from the shader
    /// leaves out the unused. A world's number at `offset` lies at
    /// `offset · worlds + world`, of scratch and state as [`PrintOptions`] say.
    ///
    /// Of [runs](Members::Runs), an invocation works on a member of one: `global_invocation_id.x` counts from its first.
    /// Binding 1 then holds the bodies of each member, `[side][member]`, of one that is left out `u32::MAX`; binding 2 each
    /// run's first member and how many it has, and the uniform how many members there is room for, which run it is, and how
    /// many bodies there are.
    ///
    /// A GPU rounds division, `sqrt` and `fma` as WGSL allows, so results agree
    /// with the CPU to a tolerance, not to the bit; and it may take for granted
    /// that no infinity and no NaN comes up.
    pub fn to_wgsl(&self, options: &PrintOptions) -> Result<String, WgslError> {
        let (opening, closing) = match options.members {
            Members::Worlds => (of_worlds(options), "    }\n    }\n}\n"),
            Members::Runs => (of_runs(options, "", ""), "    }\n}\n"),
            Members::Seats { bodies, .. } => {
                let seated = format!(" && seats[world] != {}u", u32::MAX);
                (of_runs(options, &seat(bodies), &seated), "    }\n}\n")
            }
        };
        self.print::<Wgsl>(options, opening, closing)
    }
}

fn of_worlds(options: &PrintOptions) -> String {
    let own = options.own_piece();
    let own = own.map_or(String::new(), |own| format!("    let {own};\n"));
    let held = options.held_piece();
    let held = held.map_or(String::new(), |held| format!("    let {held};\n"));
    let [counted, count] = options.counted();
    let list = options.list();
    let [entries, world] = list.map_or(Default::default(), |list| {
        list.map(|line| format!("    let {line};\n"))
    });
    let size = options.workgroup_size;
    format!(
        "{WORLDS}\n{OPERATIONS}\n@compute @workgroup_size({size})\n\
         fn main(@builtin(global_invocation_id) invocation: vec3<u32>, \
         @builtin(num_workgroups) workgroups: vec3<u32>) {{\n    \
         let index = invocation.x;\n    \
         let worlds = launch.worlds;\n\
         {own}{entries}    \
         for (var {counted} = index; {counted} < {count}; {counted} += workgroups.x * {size}u) {{\n\
         {world}{held}    \
         for (var nth = 0u; nth < launch.rounds; nth++) {{\n"
    )
}

fn of_runs(options: &PrintOptions, seat: &str, seated: &str) -> String {
    format!(
        "{RUNS}\n{OPERATIONS}\n{seat}@compute @workgroup_size({})\n\
         fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {{\n    \
         let run = runs[launch.run];\n    \
         let world = run.x + invocation.x;\n    \
         let worlds = launch.worlds;\n    \
         if (invocation.x < run.y{seated}) {{\n",
        options.workgroup_size
    )
}

/// Where a number of a member's bodies lies, of which it has so many of each.
fn seat(width: u32) -> String {
    format!(
        "fn seat(offset: u32, member: u32) -> u32 {{\n    \
         let body = seats[(offset / {width}u) * launch.worlds + member];\n    \
         return (offset % {width}u) * launch.bodies + body;\n\
         }}\n\n"
    )
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
