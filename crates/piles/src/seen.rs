//! Which buffers an entry point sees.
//!
//! An interface to cards wants to be told what each of them binds, and a browser takes eight buffers of an entry point, not
//! the twenty-one of the text. What one sees follows from the names in it, and in the functions that it calls.

use crate::card::Entry;
use std::collections::{HashMap, HashSet};

/// The entry points of a WGSL text of these names, and the bindings that they see, in order.
///
/// # Panics
/// There is no function of such a name.
pub fn seen<const N: usize>(text: &str, names: [&'static str; N]) -> [Entry; N] {
    let code = |line| str::split(line, "//").next().unwrap_or_default();
    let text = Vec::from_iter(text.lines().map(code)).join("\n");
    let (functions, bindings) = (functions(&text), bindings(&text));
    names.map(|name| {
        let (mut met, mut left) = (HashSet::from([name]), vec![name]);
        let mut sees = Vec::new();
        while let Some(function) = left.pop() {
            for &(word, called) in &functions[function] {
                sees.extend(bindings.get(word));
                if called && functions.contains_key(word) && met.insert(word) {
                    left.push(word);
                }
            }
        }
        sees.sort_unstable();
        sees.dedup();
        Entry { name, sees }
    })
}

/// A name, and whether it is called.
type Word<'a> = (&'a str, bool);

/// The names in each function.
fn functions(text: &str) -> HashMap<&str, Vec<Word<'_>>> {
    let function = |part| {
        let (name, rest) = str::split_once(part, '(')?;
        let mut depth = 0;
        let end = rest.find(|c| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == '}' && depth == 0
        })?;
        Some((name.trim(), words(&rest[..end]).collect()))
    };
    text.split("fn ").skip(1).filter_map(function).collect()
}

/// Names, but for those of fields.
fn words(mut code: &str) -> impl Iterator<Item = Word<'_>> {
    let in_path = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    std::iter::from_fn(move || {
        let path = &code[code.find(in_path)?..];
        let end = path.find(|c| !in_path(c)).unwrap_or(path.len());
        let (path, rest) = path.split_at(end);
        code = rest;
        Some((path.split('.').next()?, rest.starts_with('(')))
    })
}

/// The numbers of bindings by their names.
fn bindings(text: &str) -> HashMap<&str, u32> {
    let binding = |part| {
        let (number, rest) = str::split_once(part, ')')?;
        let (_, named) = rest.split_once("> ")?;
        let (name, _) = named.split_once(':')?;
        Some((name.trim(), number.trim().parse().ok()?))
    };
    let declared = text.split("@binding(").skip(1);
    declared.filter_map(binding).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::{ENTRIES, texts};
    use naga::front::wgsl::parse_str;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    /// What a browser gives: WebGPU, `maxStorageBuffersPerShaderStage`, of the least.
    const STORAGE_BUFFERS: usize = 8;

    /// Bindings of an entry point as naga finds them, and how many of them are storage.
    fn found(text: &str, name: &str) -> (Vec<u32>, usize) {
        let module = parse_str(text).unwrap();
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let info = validator.validate(&module).unwrap();
        let at = module.entry_points.iter().position(|it| it.name == name);
        let info = info.get_entry_point(at.unwrap());
        let globals = module.global_variables.iter();
        let used = globals.filter(|(handle, _)| !info[*handle].is_empty());
        let used = used.filter_map(|(_, it)| Some((it.binding.as_ref()?.binding, it.space)));
        let (mut sees, spaces): (Vec<_>, Vec<_>) = used.unzip();
        sees.sort_unstable();
        let is_storage = |space: &&_| matches!(space, naga::AddressSpace::Storage { .. });
        (sees, spaces.iter().filter(is_storage).count())
    }

    #[test]
    fn entry_points_see_what_naga_finds_and_a_browser_takes() {
        for worlds in [1, 3] {
            let [own, scan, sort, given, told] = texts(worlds);
            let own = (own, Vec::from(ENTRIES));
            let scan = (scan, vec!["groups", "sums", "add"]);
            let sort = (sort, vec!["count", "place"]);
            let (given, told) = ((given, vec!["give"]), (told, vec!["add"]));
            for (text, names) in [own, scan, sort, given, told] {
                for name in names {
                    let [entry] = seen(&text, [name]);
                    let (sees, storage) = found(&text, name);
                    assert_eq!(entry.sees, sees, "{name}");
                    assert!(storage <= STORAGE_BUFFERS, "{name} sees {storage}");
                }
            }
        }
    }
}
