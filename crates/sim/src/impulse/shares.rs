//! Stages, cut into parts that threads share.

use super::colours::Colours;
use super::team::{Parts, parts};

/// Into how many parts a stage is cut that takes as long as so many batches: a thread that waits for another loses the
/// time of one or two.
pub(super) fn pieces(batches: usize, team: usize) -> usize {
    if team == 1 || batches < FEW * team {
        1
    } else if batches < MANY * team {
        team
    } else {
        PARTS * team
    }
}

/// Batches in parts, stage by stage: a colour each, and those that follow on each other and are not cut together.
/// What has no colour is not cut, since it is solved in turn.
pub(super) fn shares<B>(
    mut batches: impl Iterator<Item = B>,
    colours: &Colours,
    team: usize,
) -> Vec<Parts<Vec<B>>> {
    let last = colours.colours.len().wrapping_sub(1);
    let cuts = colours.colours.iter().enumerate().map(|(i, colour)| {
        let in_turn = colours.uncoloured && i == last;
        let pieces = if in_turn {
            1
        } else {
            pieces(colour.len(), team)
        };
        (colour.len(), pieces)
    });
    let cuts = Vec::from_iter(cuts);
    let stages = cuts.chunk_by(|(_, a), (_, b)| *a == 1 && *b == 1);
    let of_stage = |stage: &[(usize, usize)]| {
        let length: usize = stage.iter().map(|(length, _)| length).sum();
        let (_, pieces) = stage[0];
        let cut = |piece: usize| length * piece / pieces;
        let sizes = (0..pieces).map(|piece| cut(piece + 1) - cut(piece));
        parts(sizes.map(|size| batches.by_ref().take(size).collect()))
    };
    stages.map(of_stage).collect()
}

/// With fewer batches for each thread, one does them all.
const FEW: usize = 2;
/// With more, each has several parts, which others can take over.
const MANY: usize = 16;
/// So many then.
const PARTS: usize = 2;

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
            let stages = shares(0..count, &colours, team);
            let parts = Vec::from_iter(stages.iter().map(Vec::len));
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
