//! Pairs of objects, and how they are put in order.

use rayon::prelude::*;

/// Two objects, `a < b`. Ordered by `a`, then by `b`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// The lower index.
    pub a: u32,
    /// The higher index.
    pub b: u32,
}

impl Pair {
    /// Of two different objects, in either order.
    #[inline]
    pub fn new(i: u32, j: u32) -> Self {
        Self {
            a: i.min(j),
            b: i.max(j),
        }
    }
}

/// Puts pairs of objects below `objects` in order, in time linear in both.
///
/// A counting sort by `a`; then each object's few partners are sorted by `b`.
pub(crate) fn sort(pairs: &mut Vec<Pair>, objects: usize) {
    let mut end = vec![0_u32; objects + 1];
    for pair in pairs.iter() {
        end[pair.a as usize + 1] += 1;
    }
    for i in 0..objects {
        end[i + 1] += end[i];
    }
    // `end[a]` is where a's partners start; it moves to where they end.
    let mut partners = vec![0_u32; pairs.len()];
    for pair in pairs.iter() {
        let next = &mut end[pair.a as usize];
        partners[*next as usize] = pair.b;
        *next += 1;
    }
    let mut start = 0;
    pairs.clear();
    for (a, &end) in end[..objects].iter().enumerate() {
        let of_a = &mut partners[start..end as usize];
        of_a.sort_unstable();
        pairs.extend(of_a.iter().map(|&b| Pair { a: a as u32, b }));
        start = end as usize;
    }
}

/// Runs `find` over chunks of `0..tasks`, in threads where that pays, and joins
/// what the chunks found in their order.
pub(crate) fn gather(
    tasks: usize,
    chunk: usize,
    found: &mut Vec<Pair>,
    find: impl Fn(std::ops::Range<usize>, &mut Vec<Pair>) + Sync,
) {
    if tasks <= chunk {
        return find(0..tasks, found);
    }
    let parts: Vec<Vec<Pair>> = (0..tasks.div_ceil(chunk))
        .into_par_iter()
        .map(|i| {
            let mut part = Vec::new();
            find(i * chunk..tasks.min((i + 1) * chunk), &mut part);
            part
        })
        .collect();
    found.reserve(parts.iter().map(Vec::len).sum());
    for part in &parts {
        found.extend_from_slice(part);
    }
}
