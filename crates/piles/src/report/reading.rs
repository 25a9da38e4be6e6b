//! What comes to the host of the worlds of a batch, and where it belongs.

use crate::report::columns::Columns;
use crate::report::part::Part;
use numbers::Memory;
use rigid::impulse::Impulse;
use rigid::impulse::report::{ContactReport, SUMS};
use std::ops::Range;

/// What words are that come to the host.
#[derive(Debug)]
pub enum Words {
    /// Columns of things of a part, and which teller's.
    Things(usize, Part),
    /// Sums over the things of these worlds.
    Sums(Range<usize>),
    /// How many contacts each world remembers, and had no room for.
    Counts,
    /// All that is told of some contacts: which, of each, and of which world.
    Contacts(Vec<(usize, usize)>),
}

/// What is read.
pub struct Reading<'a> {
    pub impulse: &'a Impulse,
    /// The first of the worlds.
    pub first: usize,
    /// Of each teller.
    pub columns: Vec<Columns>,
    /// Of each world.
    pub sums: Vec<[f64; SUMS]>,
    /// How many contacts it remembers, and had no room for.
    pub counts: Vec<[f32; 2]>,
    /// Rows of contacts that were told so far.
    pub rows: Vec<usize>,
    pub output: &'a mut Memory<f32>,
}

impl Reading<'_> {
    /// Takes what has come.
    pub fn take(&mut self, words: Words, read: &[f32]) {
        match words {
            Words::Things(teller, part) => self.take_things(teller, &part, read),
            Words::Sums(worlds) => {
                let count = worlds.len();
                for (i, sums) in self.sums[worlds].iter_mut().enumerate() {
                    let own = read[i..].iter().step_by(count);
                    let sums = sums.iter_mut().zip(own);
                    sums.for_each(|(sum, x)| *sum += f64::from(*x));
                }
            }
            Words::Counts => {
                let (counts, forgotten) = read.split_at(self.counts.len());
                let both = counts.iter().zip(forgotten).map(|(a, b)| [*a, *b]);
                self.counts.iter_mut().zip(both).for_each(|(to, x)| *to = x);
            }
            Words::Contacts(some) => self.take_contacts(&some, read),
        }
    }
    fn take_things(&mut self, teller: usize, part: &Part, read: &[f32]) {
        let (columns, count) = (&self.columns[teller], part.count());
        // World by world, as their outputs lie one after the other.
        for world in part.worlds.clone() {
            for place in columns.places() {
                if let Some(i) = part.find(world, place.thing) {
                    let column = columns.column(place.number, count, read);
                    self.output.set(self.first + world, place.at, column[i]);
                }
            }
        }
    }
    fn take_contacts(&mut self, some: &[(usize, usize)], read: &[f32]) {
        let points = ContactReport::new().count.start();
        for (i, (world, _)) in some.iter().enumerate() {
            let of = |number: usize| read[number * some.len() + i];
            for point in 0..of(points) as usize {
                let row = &mut self.rows[*world];
                self.impulse
                    .told_places_of_point(point, *row, |number, at| {
                        self.output.set(self.first + world, at, of(number));
                    });
                *row += 1;
            }
        }
    }
    /// All contacts that the worlds remember: of which world, and which of its.
    pub fn all_contacts(&self) -> Vec<(usize, usize)> {
        let worlds = self.counts.iter().enumerate();
        let contacts = worlds
            .flat_map(|(world, [count, _])| (0..*count as usize).map(move |nth| (world, nth)));
        contacts.collect()
    }
    pub fn put_sums(&mut self) {
        let places = self.impulse.told_sums();
        for (nth, sums) in self.sums.iter().enumerate() {
            for (at, x) in places.clone().zip(sums) {
                self.output.set(self.first + nth, at, *x as f32);
            }
        }
    }
    pub fn put_capped(&mut self) {
        let at = self.impulse.told_capped();
        for (nth, [_, forgotten]) in self.counts.iter().enumerate() {
            self.output.set(self.first + nth, at, *forgotten);
        }
    }
}
