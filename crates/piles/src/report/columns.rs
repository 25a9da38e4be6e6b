//! Which of the numbers that a kernel tells come to the host.

use std::ops::Range;

/// A number that is told, of which thing of a world, and where in the output it belongs.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub at: usize,
    pub thing: usize,
    pub number: usize,
}

/// Numbers of all things, `[number][thing]`, of which some are read.
#[derive(Debug)]
pub struct Columns {
    /// What is read of them belongs there.
    pub places: Vec<Place>,
    /// Those that are read, as few ranges as that can be.
    runs: Vec<Range<usize>>,
    /// Of each, which of those that are read it is.
    nth: Vec<usize>,
}

impl Columns {
    /// Of so many numbers, those that belong to these places.
    pub fn of(places: Vec<Place>, told: usize) -> Self {
        let mut is_read = vec![false; told];
        places.iter().for_each(|place| is_read[place.number] = true);
        let (mut runs, mut nth, mut read) = (Vec::<Range<usize>>::new(), vec![0; told], 0);
        for number in (0..told).filter(|number| is_read[*number]) {
            match runs.last_mut() {
                Some(run) if run.end == number => run.end += 1,
                _ => runs.push(number..number + 1),
            }
            (nth[number], read) = (read, read + 1);
        }
        Self { places, runs, nth }
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
        let places = [4, 9, 5, 4].map(|number| Place {
            at: 0,
            thing: 0,
            number,
        });
        let columns = Columns::of(places.into(), 12);
        assert!(columns.words(2).eq([8..12, 18..20]));
        let read = [4.0, 4.5, 5.0, 5.5, 9.0, 9.5];
        let found = [4, 5, 9].map(|number| columns.column(number, 2, &read)[0]);
        assert_eq!(found, [4.0, 5.0, 9.0]);
    }
}
