//! Disassembles the SIMD entries of the release program and fails on stray calls.
//!
//! A kernel is fast only if everything in it is inlined into the entry of its instruction set: one call left
//! over costs a factor of seven to thirty. What may remain is the panic of a bounds check or of a cast, and the
//! memory functions of the C library.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Result, bail, ensure};
use xshell::{Shell, cmd};

use crate::workshop::Workshop;

const ENTRIES: [&str; 4] = [
    "dispatch::entry_avx512",
    "dispatch::entry_avx2",
    "dispatch::entry_fma512",
    "dispatch::entry_fma",
];
const MEMORY_FUNCTIONS: [&str; 5] = ["memcpy", "memmove", "memset", "memcmp", "bcmp"];

pub fn check(workshop: &Workshop) -> Result<()> {
    workshop.need_program("objdump", "binutils")?;
    ensure!(
        cfg!(target_arch = "x86_64"),
        "the entries are those of x86-64: run this check there"
    );
    let program = workshop.program()?;
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
    let casts = callee == "bytemuck::internal::something_went_wrong";
    panics || casts || bare == "_Unwind_Resume" || MEMORY_FUNCTIONS.contains(&bare)
}

/// The entries in the program, each with what it calls or jumps out to.
fn disassemble(sh: &Shell, program: &Path) -> Result<Vec<Function>> {
    let relocations = cmd!(sh, "objdump --dynamic-reloc {program}")
        .quiet()
        .read()?;
    let listing = cmd!(
        sh,
        "objdump --disassemble --demangle --no-show-raw-insn {program}"
    )
    .quiet()
    .read()?;
    Ok(parse(&listing, &relocations))
}

fn parse(listing: &str, relocations: &str) -> Vec<Function> {
    let names: BTreeMap<u64, &str> = listing.lines().filter_map(header).collect();
    let imports = imports(relocations, &names);
    let mut functions: Vec<Function> = Vec::new();
    let mut inside = false;
    let mut loaded = BTreeMap::new();
    for line in listing.lines() {
        if let Some((_, name)) = header(line) {
            loaded.clear();
            inside = ENTRIES.iter().any(|entry| name.contains(entry));
            if inside {
                functions.push(Function {
                    name: name.to_owned(),
                    callees: Vec::new(),
                });
            }
        } else if inside && let Some(function) = functions.last_mut() {
            let callee =
                through_register(line, &loaded).or_else(|| callee(line, &function.name, &imports));
            function.callees.extend(callee);
            track(line, &imports, &mut loaded);
        }
    }
    functions
}

/// `0000000000012340 <name>:`
fn header(line: &str) -> Option<(u64, &str)> {
    let (address, name) = line.split_once(" <")?;
    Some((hexadecimal(address)?, name.strip_suffix(">:")?))
}

/// The table through which functions are called indirectly: its addresses, with the functions' names.
///
/// `5000 R_X86_64_GLOB_DAT memcpy@GLIBC_2.14` or, for a function of the program, `5008 R_X86_64_RELATIVE *ABS*+0x12340`
fn imports(relocations: &str, names: &BTreeMap<u64, &str>) -> BTreeMap<u64, String> {
    let relocation = |line: &str| {
        let mut columns = line.split_whitespace();
        let address = hexadecimal(columns.next()?)?;
        let value = columns.nth(1)?;
        let own = value
            .strip_prefix("*ABS*+0x")
            .and_then(hexadecimal)
            .and_then(|at| names.get(&at));
        Some((address, own.map_or(value, |name| name).to_owned()))
    };
    relocations.lines().filter_map(relocation).collect()
}

/// Remembers which registers hold the address of an import: `mov 0x10(%rip),%rbx  # 5000 <…>`.
fn track(line: &str, imports: &BTreeMap<u64, String>, loaded: &mut BTreeMap<String, String>) {
    let (operands, comment) = line.split_once("# ").unwrap_or((line, ""));
    let Some((_, register)) = operands.trim_end().rsplit_once(",%") else {
        return;
    };
    let target = comment.split_whitespace().next().and_then(hexadecimal);
    match target.and_then(|at| imports.get(&at)) {
        Some(import) if operands.contains("mov ") => {
            loaded.insert(register.to_owned(), import.clone());
        }
        _ => {
            loaded.remove(register);
        }
    }
}

/// The import that `call *%rbx` calls, if the register holds one.
fn through_register(line: &str, loaded: &BTreeMap<String, String>) -> Option<String> {
    let (_, register) = line.split_once("call ")?.1.split_once("*%")?;
    loaded.get(register.trim()).cloned()
}

/// What an instruction calls, or jumps to outside its own function.
fn callee(line: &str, function: &str, imports: &BTreeMap<u64, String>) -> Option<String> {
    let (_, instruction) = line.split_once(":\t")?;
    let is_prefix = |word: &&str| matches!(*word, "addr32" | "data16" | "notrack" | "bnd");
    let mnemonic = instruction
        .split_whitespace()
        .find(|word| !is_prefix(word))?;
    let (is_call, is_jump) = (mnemonic.starts_with("call"), mnemonic.starts_with('j'));
    if !is_call && !is_jump {
        return None;
    }
    if let Some((_, target)) = instruction.split_once("# ") {
        let import = target
            .split_whitespace()
            .next()
            .and_then(hexadecimal)
            .and_then(|at| imports.get(&at));
        return Some(import.cloned().unwrap_or_else(|| symbol(target)));
    }
    if instruction.contains('*') {
        // A jump through a register is a `match` turned into a table; its targets lie in the function.
        let is_table = is_jump && !instruction.contains('(');
        return (!is_table).then(|| instruction.trim().to_owned());
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
    name.unwrap_or("(unknown)").to_owned()
}

fn hexadecimal(digits: &str) -> Option<u64> {
    u64::from_str_radix(digits, 16).ok()
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
    100e:\tcall   *0x18(%rip)        # 5008 <_DYNAMIC+0x18>
    1010:\tcall   2000 <model::mass>
    1012:\tcall   *0x20(%rip)        # 5010 <_DYNAMIC+0x20>
    1014:\tjmp    4010 <f32::sin>
    1016:\tnotrack jmp *%rax
    1018:\tcall   *%rax
    101a:\tmov    0x10(%rip),%rbx        # 5000 <memcpy@GLIBC_2.14>
    101c:\tcall   *%rbx
    101e:\tmov    %rcx,%rbx
    1020:\tcall   *%rbx
0000000000002000 <model::mass>:
    2000:\tcall   4010 <f32::sin>
0000000000003000 <core::panicking::panic_bounds_check>:
    3000:\tud2
";
    const RELOCATIONS: &str = "\
OFFSET           TYPE              VALUE
0000000000005000 R_X86_64_GLOB_DAT  memcpy@GLIBC_2.14
0000000000005008 R_X86_64_RELATIVE  *ABS*+0x0000000000003000
0000000000005010 R_X86_64_RELATIVE  *ABS*+0x0000000000002000
";

    #[test]
    fn stray_calls_and_tail_calls_of_entries_are_found() {
        let functions = parse(LISTING, RELOCATIONS);
        assert_eq!(functions.len(), 1);
        let stray: Vec<String> = functions[0].stray_calls().collect();
        let callees = [
            "model::mass",
            "model::mass",
            "f32::sin",
            "call   *%rax",
            "call   *%rbx",
        ];
        assert_eq!(
            stray,
            callees.map(|callee| format!("{} -> {callee}", functions[0].name))
        );
    }
}
