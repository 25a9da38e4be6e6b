//! Disassembles the SIMD entries of the release program and fails on stray calls.
//!
//! A kernel is fast only if everything in it is inlined into the entry of its instruction set: one call left
//! over costs a factor of seven to thirty. What may remain is the panic of a bounds check and the memory
//! functions of the C library.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Result, bail, ensure};
use xshell::{Shell, cmd};

use crate::workshop::Workshop;

const ENTRIES: [&str; 3] = [
    "dispatch::entry_avx512",
    "dispatch::entry_avx2",
    "dispatch::entry_fma",
];
const MEMORY_FUNCTIONS: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

pub fn check(workshop: &Workshop) -> Result<()> {
    workshop.need_program("objdump", "binutils")?;
    ensure!(
        cfg!(target_arch = "x86_64"),
        "the entries are those of x86-64: run this check there"
    );
    cmd!(
        workshop.sh,
        "cargo build --quiet --release --package kinetarium-cli"
    )
    .run()?;
    let program = workshop.target().join("release/kinetarium");
    let functions = disassemble(&workshop.sh, &program)?;
    for entry in ENTRIES {
        let count = functions
            .iter()
            .filter(|function| function.name.contains(entry))
            .count();
        ensure!(
            count > 0,
            "no instance of `{entry}` in {}: is it inlined away or renamed?",
            program.display()
        );
        println!("{count:>4} instances of {entry}");
    }
    let stray: BTreeSet<String> = functions.iter().flat_map(Function::stray_calls).collect();
    if !stray.is_empty() {
        let list: Vec<String> = stray.into_iter().collect();
        bail!(
            "stray calls; mark the callee #[inline(always)]:\n  {}",
            list.join("\n  ")
        );
    }
    Ok(())
}

struct Function {
    name: String,
    callees: Vec<String>,
}

impl Function {
    fn stray_calls(&self) -> impl Iterator<Item = String> {
        let strays = self.callees.iter().filter(|callee| !is_allowed(callee));
        strays.map(|callee| format!("{} -> {callee}", self.name))
    }
}

fn is_allowed(callee: &str) -> bool {
    let bare = callee.split(['@', '+']).next().unwrap_or(callee);
    let panics =
        callee.starts_with("core::") && (callee.contains("panic") || callee.contains("_fail"));
    panics || bare == "_Unwind_Resume" || MEMORY_FUNCTIONS.contains(&bare)
}

/// The entries in the program, each with what it calls or jumps out to.
fn disassemble(sh: &Shell, program: &Path) -> Result<Vec<Function>> {
    let imports = imports(
        &cmd!(sh, "objdump --dynamic-reloc {program}")
            .quiet()
            .read()?,
    );
    let listing = cmd!(
        sh,
        "objdump --disassemble --demangle --no-show-raw-insn {program}"
    )
    .quiet()
    .read()?;
    Ok(parse(&listing, &imports))
}

/// Addresses of the table through which library functions are called, with the functions' names.
fn imports(relocations: &str) -> BTreeMap<u64, String> {
    relocations
        .lines()
        .filter_map(|line| {
            let mut columns = line.split_whitespace();
            let address = u64::from_str_radix(columns.next()?, 16).ok()?;
            Some((address, columns.nth(1)?.to_owned()))
        })
        .collect()
}

fn parse(listing: &str, imports: &BTreeMap<u64, String>) -> Vec<Function> {
    let mut functions: Vec<Function> = Vec::new();
    let mut inside = false;
    for line in listing.lines() {
        if let Some(name) = header(line) {
            inside = ENTRIES.iter().any(|entry| name.contains(entry));
            if inside {
                functions.push(Function {
                    name: name.to_owned(),
                    callees: Vec::new(),
                });
            }
        } else if inside && let Some(function) = functions.last_mut() {
            function
                .callees
                .extend(callee(line, &function.name, imports));
        }
    }
    functions
}

/// `0000000000012340 <name>:`
fn header(line: &str) -> Option<&str> {
    let (address, name) = line.split_once(" <")?;
    u64::from_str_radix(address, 16).ok()?;
    name.strip_suffix(">:")
}

/// What an instruction calls, or jumps to outside its own function; `<unknown>` where that cannot be told.
fn callee(line: &str, function: &str, imports: &BTreeMap<u64, String>) -> Option<String> {
    let (_, instruction) = line.split_once(":\t")?;
    let mnemonic = instruction
        .split_whitespace()
        .find(|word| !matches!(*word, "addr32" | "data16" | "notrack" | "bnd"))?;
    let is_call = mnemonic.starts_with("call");
    if !is_call && !mnemonic.starts_with('j') {
        return None;
    }
    if let Some((_, target)) = instruction.split_once("# ") {
        let address = u64::from_str_radix(target.split_whitespace().next()?, 16).ok();
        return Some(
            address
                .and_then(|a| imports.get(&a).cloned())
                .unwrap_or_else(|| symbol(target)),
        );
    }
    if instruction.contains('*') {
        return Some(format!("<unknown> ({})", instruction.trim()));
    }
    let target = symbol(instruction);
    let own = target
        .strip_prefix(function)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with("+0x"));
    (is_call || !own).then_some(target)
}

/// `… 1234 <name+0x10>` gives `name+0x10`.
fn symbol(operand: &str) -> String {
    let name = operand
        .split_once(" <")
        .and_then(|(_, rest)| rest.strip_suffix('>'));
    name.unwrap_or("<unknown>").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTING: &str = "\
0000000000001000 <kinetarium_numbers::dispatch::entry_avx2>:
    1000:\tpush   %rbp
    1004:\tjne    1020 <kinetarium_numbers::dispatch::entry_avx2+0x20>
    1008:\tcall   3000 <core::panicking::panic_bounds_check>
    100c:\tcall   *0x10(%rip)        # 5000 <_DYNAMIC+0x10>
    1010:\tcall   4000 <model::mass>
    1014:\tjmp    4010 <f32::sin>
    1018:\tcall   *%rax
0000000000002000 <elsewhere>:
    2000:\tcall   4000 <model::mass>
";
    const RELOCATIONS: &str = "\
OFFSET           TYPE              VALUE
0000000000005000 R_X86_64_GLOB_DAT  memcpy@GLIBC_2.14
";

    #[test]
    fn stray_calls_and_tail_calls_of_entries_are_found() {
        let functions = parse(LISTING, &imports(RELOCATIONS));
        assert_eq!(functions.len(), 1);
        let entry = "kinetarium_numbers::dispatch::entry_avx2";
        let stray: Vec<String> = functions[0].stray_calls().collect();
        assert_eq!(
            stray,
            [
                format!("{entry} -> model::mass"),
                format!("{entry} -> f32::sin"),
                format!("{entry} -> <unknown> (call   *%rax)"),
            ]
        );
    }
}
