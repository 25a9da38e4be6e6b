//! Stages, cut into parts that threads share.

use super::colours::Colours;
use super::team::{Parts, parts};
use std::ops::Range;

/// Into how many parts a stage is cut that takes as long as so many batches: a thread that waits for another loses the
/// time of one or two.
pub(super) fn pieces(batches: usize, team: usize) -> usize {
    if team == 1 || batches < FEW * team {
        1
    } else {
        team
    }
}

/// Batches in parts, stage by stage.
///
/// Of each colour, how many batches it has, and into how many parts they are cut. What has no colour is not cut, since
/// it is solved in turn.
#[derive(Debug)]
pub(super) struct Cuts(Vec<[usize; 2]>);

impl Cuts {
    /// Each colour for all of a team.
    pub fn new(colours: &Colours, team: usize) -> Self {
        let last = colours.colours.len().wrapping_sub(1);
        let cut = |(i, colour): (usize, &Range<usize>)| {
            let in_turn = colours.uncoloured && i == last;
            let pieces = if in_turn {
                1
            } else {
                pieces(colour.len(), team)
            };
            [colour.len(), pieces]
        };
        Self(colours.colours.iter().enumerate().map(cut).collect())
    }

    /// The sizes of the parts of each stage: of a colour, or of those that follow on each other and are not cut.
    fn stages(&self) -> impl Iterator<Item = impl Iterator<Item = usize>> {
        let stages = self.0.chunk_by(|[_, a], [_, b]| *a == 1 && *b == 1);
        stages.map(|stage| {
            let length: usize = stage.iter().map(|[length, _]| length).sum();
            let pieces = stage[0][1];
            let cut = move |piece: usize| length * piece / pieces;
            (0..pieces).map(move |piece| cut(piece + 1) - cut(piece))
        })
    }

    /// Places of all batches in memory. There is a gap after each part: processors fetch what may follow before it is
    /// asked for, and that is what another thread writes.
    pub fn places(&self) -> impl Iterator<Item = usize> {
        let mut end = 0;
        let parts = self.stages().flatten();
        parts.flat_map(move |size| {
            let begin = end;
            end += size + 1;
            begin..begin + size
        })
    }

    /// The batches themselves.
    pub fn share<B>(&self, mut batches: impl Iterator<Item = B>) -> Vec<Parts<Vec<B>>> {
        let mut take = |size| batches.by_ref().take(size).collect();
        self.stages()
            .map(|sizes| parts(sizes.map(&mut take)))
            .collect()
    }
}

/// With fewer batches for each thread, one does them all.
const FEW: usize = 2;

#[cfg(test)]
mod tests {
    use super::super::team::together;
    use super::*;
    use std::sync::Mutex;

    /// A row of bodies has two colours of many contacts, a star as many colours as there are, and more contacts.
    #[test]
    fn stages_have_all_batches_in_order() {
        let row = (1..400_u32).map(|i| ([i, i + 1], 4));
        let star = (500..590_u32).map(|i| ([450, i], 1));
        let mut colours = Colours::default();
        colours.paint(&row.chain(star).collect::<Vec<_>>(), 600, 8);
        assert!(colours.uncoloured);
        let count = colours.batches.len();
        for team in 1..5 {
            let cuts = Cuts::new(&colours, team);
            let stages = cuts.share(0..count);
            let parts = Vec::from_iter(stages.iter().map(Vec::len));
            let places = Vec::from_iter(cuts.places());
            let gaps = places.windows(2).filter(|pair| pair[1] == pair[0] + 2);
            let without = places.windows(2).filter(|pair| pair[1] == pair[0] + 1);
            assert_eq!(gaps.clone().count() + without.count() + 1, count);
            assert_eq!(gaps.count(), parts.iter().sum::<usize>() - 1);
            let expected: &[usize] = if team == 1 { &[1] } else { &[team, team, 1] };
            assert_eq!(parts, expected);
            let done = Mutex::new(Vec::new());
            together(1, |mut member| {
                for stage in &stages {
                    member.stage(stage, |batches| done.lock().unwrap().append(batches));
                }
            });
            assert!(done.into_inner().unwrap().into_iter().eq(0..count));
        }
    }
}
