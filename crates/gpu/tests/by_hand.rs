//! What cards run that no kernel was recorded for is what ARCHITECTURE.md says, to the line.

use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Files of a folder that end so.
fn files(folder: &Path, end: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let is_one = |path: &PathBuf| path.extension().is_some_and(|it| it == end);
    paths.filter(is_one).collect()
}

/// All files below a folder that end so.
fn below(folder: &Path, end: &str) -> Vec<PathBuf> {
    let mut found = files(folder, end);
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(below(&path, end));
        }
    }
    found
}

#[test]
fn what_is_written_by_hand_is_stated() {
    let root = Path::new(ROOT);
    let text = fs::read_to_string(root.join("ARCHITECTURE.md")).unwrap();
    let mut stated = Vec::new();
    for row in text.lines().filter(|line| line.starts_with("| `crates/")) {
        let mut cells = row.split('|').skip(1).map(str::trim);
        let pattern = cells.next().unwrap().trim_matches('`');
        let Some((folder, end)) = pattern.rsplit_once("/*.") else {
            continue;
        };
        let own = files(&root.join(folder), end);
        let lines = |path| fs::read_to_string(path).unwrap().lines().count();
        let count: usize = own.iter().map(lines).sum();
        assert_eq!(cells.next().unwrap(), count.to_string(), "{pattern}");
        stated.extend(own);
    }
    // Pictures are another matter.
    let crates = fs::read_dir(root.join("crates")).unwrap();
    let sources = crates.map(|entry| entry.unwrap().path().join("src"));
    let sources = sources.filter(|path| !path.starts_with(root.join("crates/render")));
    let mut all: Vec<_> = sources
        .flat_map(|path| ["wgsl", "cu"].map(|end| below(&path, end)))
        .flatten()
        .collect();
    all.sort();
    stated.sort();
    assert_eq!(all, stated);
}

/// Entry points of kernels stand in those files, or are what prints records and translates texts.
#[test]
fn no_kernel_stands_anywhere_else() {
    let printers = [
        "crates/numbers/src/trace/wgsl.rs",
        "crates/numbers/src/trace/cuda.rs",
        "crates/cuda/src/wgsl/entries.rs",
    ];
    let root = Path::new(ROOT);
    let crates = fs::read_dir(root.join("crates")).unwrap();
    let sources = crates.map(|entry| entry.unwrap().path().join("src"));
    let sources =
        sources.filter(|path| path.is_dir() && !path.starts_with(root.join("crates/render")));
    let mut found = Vec::new();
    for path in sources.flat_map(|path| below(&path, "rs")) {
        let text = fs::read_to_string(&path).unwrap();
        let is_test = path.file_name().is_some_and(|name| name == "tests.rs");
        if !is_test && (text.contains("@compute") || text.contains("__global__")) {
            let path = path.strip_prefix(root).unwrap();
            found.push(path.to_string_lossy().into_owned());
        }
    }
    found.sort();
    let mut printers = printers.map(String::from);
    printers.sort();
    assert_eq!(found, printers);
    let page = fs::read_dir(root.join("web/src/transport")).unwrap();
    for entry in page {
        let path = entry.unwrap().path();
        let has = |text: String| text.contains("@compute");
        assert!(!fs::read_to_string(&path).is_ok_and(has), "{path:?}");
    }
}
