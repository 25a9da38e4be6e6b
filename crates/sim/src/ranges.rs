//! Numbers of a memory, as ranges.

use std::ops::Range;

/// Ranges in order, of which none meets another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ranges(Vec<Range<usize>>);

impl Ranges {
    /// All numbers of these, however they lie.
    pub fn of(ranges: impl IntoIterator<Item = Range<usize>>) -> Self {
        let mut all = Vec::from_iter(ranges.into_iter().filter(|range| !range.is_empty()));
        all.sort_unstable_by_key(|range| range.start);
        let mut merged = Vec::<Range<usize>>::with_capacity(all.len());
        for range in all {
            match merged.last_mut() {
                Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
                _ => merged.push(range),
            }
        }
        Self(merged)
    }
    /// Whether it has all numbers of another.
    pub fn covers(&self, other: &Self) -> bool {
        other.0.iter().all(|range| {
            let after = self.0.partition_point(|own| own.start <= range.start);
            let own = after.checked_sub(1).map(|i| &self.0[i]);
            own.is_some_and(|own| range.end <= own.end)
        })
    }
    /// With the numbers of another.
    pub fn include(&mut self, other: Self) {
        *self = Self::of(std::mem::take(&mut self.0).into_iter().chain(other.0));
    }
    pub fn clear(&mut self) {
        self.0.clear();
    }
    pub fn as_slice(&self) -> &[Range<usize>] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_merged_and_covered() {
        let mut own = Ranges::of([7..9, 0..2, 4..4, 2..3, 8..12]);
        assert_eq!(own.as_slice(), [0..3, 7..12]);
        assert!(own.covers(&Ranges::of([7..8, 1..3])));
        assert!(own.covers(&Ranges::default()));
        for missing in [2..4, 3..4, 6..8, 11..13, 20..21] {
            assert!(!own.covers(&Ranges::of([missing])));
        }
        own.include(Ranges::of([3..5, 5..7]));
        assert_eq!(own.as_slice(), std::slice::from_ref(&(0..12)));
        own.clear();
        assert!(!own.covers(&Ranges::of([0..1, 1..2])));
    }
}
