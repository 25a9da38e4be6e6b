//! Which of the numbers that a kernel tells come to the host.

use std::ops::Range;
use std::sync::Arc;

/// A number that is told.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Where in the output it belongs.
    pub at: usize,
    /// Of which thing of a world.
    pub thing: usize,
    /// Which one of those that are told of it.
    pub number: usize,
}

/// Numbers of all things, `[number][thing]`, of which some are read.
#[derive(Debug)]
pub struct Columns {
    /// Where all belongs, and where what is read does.
    all: Arc<[Place]>,
    places: Vec<Range<usize>>,
    /// Numbers that are read, as few ranges as that can be.
    runs: Vec<Range<usize>>,
    /// Of each number, which of those that are read it is.
    nth: Vec<usize>,
}

impl Columns {
    /// Of so many numbers that are told, and belong to these places in their order, those that belong to these ranges of the
    /// output.
    pub fn of(all: &Arc<[Place]>, asked: &[Range<usize>], told: usize) -> Self {
        let from = |at: usize| all.partition_point(|place| place.at < at);
        let of_range = |range: &Range<usize>| from(range.start)..from(range.end);
        let places = Vec::from_iter(asked.iter().map(of_range));
        let mut is_read = vec![false; told];
        let wanted = places.iter().flat_map(|range| &all[range.clone()]);
        wanted.for_each(|place| is_read[place.number] = true);
        let (mut runs, mut nth, mut read) = (Vec::<Range<usize>>::new(), vec![0; told], 0);
        for number in (0..told).filter(|number| is_read[*number]) {
            match runs.last_mut() {
                Some(run) if run.end == number => run.end += 1,
                _ => runs.push(number..number + 1),
            }
            (nth[number], read) = (read, read + 1);
        }
        Self {
            all: Arc::clone(all),
            places,
            runs,
            nth,
        }
    }
    /// Where what is read belongs.
    pub fn places(&self) -> impl Iterator<Item = &Place> {
        let ranges = self.places.iter();
        ranges.flat_map(|range| &self.all[range.clone()])
    }
    /// How many numbers are read.
    pub fn width(&self) -> usize {
        self.runs.iter().map(Range::len).sum()
    }
    /// The words of so many things.
    pub fn words(&self, count: usize) -> impl Iterator<Item = Range<usize>> {
        let runs = self.runs.iter();
        runs.map(move |run| run.start * count..run.end * count)
    }
    /// A number of so many things, of what was read of them.
    pub fn column<'a>(&self, number: usize, count: usize, read: &'a [f32]) -> &'a [f32] {
        &read[self.nth[number] * count..][..count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_columns_that_are_wanted_are_read() {
        let places = [(10, 4), (11, 9), (12, 7), (20, 5), (21, 4)];
        let place = |(at, number)| Place {
            at,
            thing: 0,
            number,
        };
        let places = Arc::from(places.map(place));
        let columns = Columns::of(&places, &[0..12, 20..30], 12);
        assert!(columns.places().map(|place| place.at).eq([10, 11, 20, 21]));
        assert_eq!(columns.width(), 3);
        assert!(columns.words(2).eq([8..12, 18..20]));
        let read = [4.0, 4.5, 5.0, 5.5, 9.0, 9.5];
        let found = [4, 5, 9].map(|number| columns.column(number, 2, &read)[0]);
        assert_eq!(found, [4.0, 5.0, 9.0]);
    }
}
