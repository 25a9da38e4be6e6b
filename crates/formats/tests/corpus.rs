//! The fuzz targets' corpus, and files made from it by mutation: read or refused, never a panic.

use kinetarium_formats::{InMemory, Options, mjcf, urdf};
use proptest::prelude::*;
use std::path::Path;

/// Every file of `fuzz/corpus`.
fn corpus() -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let mut files = Vec::new();
    for target in ["mjcf", "urdf"] {
        for entry in std::fs::read_dir(root.join(target)).expect("the corpus") {
            files.push(std::fs::read(entry.expect("a file").path()).expect("a file"));
        }
    }
    files.sort();
    files
}

/// Does what both fuzz targets do; gives how many of the four readings succeeded.
fn read(bytes: &[u8]) -> usize {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return 0;
    };
    let files = InMemory::new([("part.xml", text)]);
    let mut read = 0;
    for lenient in [false, true] {
        let options = Options {
            lenient,
            floating_base: lenient,
            ..Options::default()
        };
        read += usize::from(mjcf::parse(text, "robot.xml", &files, &options).is_ok());
        read += usize::from(urdf::parse(text, "robot.urdf", &files, &options).is_ok());
    }
    read
}

#[test]
fn corpus_is_read_or_refused() {
    let files = corpus();
    let read: usize = files.iter().map(|bytes| read(bytes)).sum();
    assert!(files.len() >= 15, "{} files", files.len());
    assert!(
        read >= 12,
        "only {read} readings succeeded: the corpus has lost its sound files"
    );
}

/// A change of a file.
#[derive(Clone, Debug)]
enum Mutation {
    /// Flips bits of a byte.
    Flip(usize, u8),
    /// Cuts the file off.
    Truncate(usize),
    /// Removes a stretch.
    Remove(usize, usize),
    /// Writes a stretch a second time.
    Repeat(usize, usize),
    /// Exchanges the values of two attributes.
    Swap(usize, usize),
    /// Puts another value into an attribute.
    Value(usize, &'static str),
}

const VALUES: &[&str] = &[
    "",
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "0 0 0",
    "0 0 0 0",
    "1 1 1 1 1 1",
    "true",
    "false",
    "auto",
    "ball",
    "free",
    "mesh",
    "world",
    "main",
    "é",
];

fn mutation() -> impl Strategy<Value = Mutation> {
    let at = any::<usize>();
    prop_oneof![
        (at, any::<u8>()).prop_map(|(i, bits)| Mutation::Flip(i, bits)),
        at.prop_map(Mutation::Truncate),
        (at, 1usize..40).prop_map(|(i, n)| Mutation::Remove(i, n)),
        (at, 1usize..200).prop_map(|(i, n)| Mutation::Repeat(i, n)),
        (at, any::<usize>()).prop_map(|(i, k)| Mutation::Swap(i, k)),
        (at, prop::sample::select(VALUES)).prop_map(|(i, value)| Mutation::Value(i, value)),
    ]
}

/// The stretches between double quotes.
fn values(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let quotes: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i] == b'"').collect();
    quotes
        .chunks_exact(2)
        .map(|pair| pair[0] + 1..pair[1])
        .collect()
}

fn mutate(mut bytes: Vec<u8>, mutation: &Mutation) -> Vec<u8> {
    let n = bytes.len().max(1);
    match *mutation {
        _ if bytes.is_empty() => {}
        Mutation::Flip(i, bits) => bytes[i % n] ^= bits,
        Mutation::Truncate(i) => bytes.truncate(i % n),
        Mutation::Remove(i, length) => {
            let start = i % n;
            bytes.drain(start..(start + length).min(n));
        }
        Mutation::Repeat(i, length) => {
            let start = i % n;
            let stretch = bytes[start..(start + length).min(n)].to_vec();
            bytes.splice(start..start, stretch);
        }
        Mutation::Swap(i, k) => {
            let values = values(&bytes);
            if !values.is_empty() {
                let (a, b) = (i % values.len(), k % values.len());
                let (a, b) = (values[a.min(b)].clone(), values[a.max(b)].clone());
                let (first, second) = (bytes[a.clone()].to_vec(), bytes[b.clone()].to_vec());
                bytes.splice(b, first);
                bytes.splice(a, second);
            }
        }
        Mutation::Value(i, value) => {
            let values = values(&bytes);
            if !values.is_empty() {
                bytes.splice(values[i % values.len()].clone(), value.bytes());
            }
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_files_do_not_panic(
        file in any::<prop::sample::Index>(),
        mutations in prop::collection::vec(mutation(), 1..6),
    ) {
        let files = corpus();
        let bytes = mutations.iter().fold(file.get(&files).clone(), mutate);
        read(&bytes);
    }
}
