//! Pairs of boxes that overlap, kept while the boxes move little.
//!
//! An object also has a *fat* box, which is larger than its own (Catto 2019, "Dynamic bounding volume
//! hierarchies"). While its own stays inside, nothing is asked of the tree: the pairs whose own boxes overlap
//! are among those whose fat ones do. An object that has left gets another fat box, and its pairs are found
//! anew. One that would leave again at once gets no larger box than its own, since that would only add pairs.
//!
//! | | cost |
//! |---|---|
//! | update where none has left | O(n) |
//! | where k have | O(k log n + n + pairs); all are looked at together where k is large |

use crate::{Aabb, Auto, Pair, Space, SpaceError, boxes, pairs};

/// How much larger a fat box is on every side, as a share of its mean edge.
const FAT: f32 = 0.1;
/// For how many updates a fat box should do, by the speed of the object.
const LASTING: f32 = 2.0;
/// Where more than one in so many objects have left their fat boxes, the pairs of all are looked for together.
const FEW: usize = 2;
/// Where more than one in so many have, all are put in their places together.
const SOME: usize = 200;
/// Objects that one thread looks at in turn.
const CHUNK: usize = 64;

/// Objects by their boxes, and the pairs that may overlap, each with what the caller knows of it.
#[derive(Clone, Debug)]
pub struct PairCache<K> {
    /// The objects by their fat boxes; none before the first update.
    space: Option<Space<Auto>>,
    /// Each object's own box when it got its fat one, and in which update that was.
    seen: Vec<(Aabb, u32)>,
    updates: u32,
    pairs: Vec<(Pair, K)>,
    /// The objects that have left their fat boxes, and whether each has.
    left: Vec<u32>,
    has_left: Vec<bool>,
    /// Their pairs, and room for the next list.
    fresh: Vec<Pair>,
    next: Vec<(Pair, K)>,
}

impl<K> Default for PairCache<K> {
    fn default() -> Self {
        Self {
            space: None,
            seen: Vec::new(),
            updates: 0,
            pairs: Vec::new(),
            left: Vec::new(),
            has_left: Vec::new(),
            fresh: Vec::new(),
            next: Vec::new(),
        }
    }
}

impl<K: Default> PairCache<K> {
    /// Object i has the box `boxes[i]` now. Pairs of which `may_meet` says no are left out; it is asked when
    /// a pair is new, and must always say the same. A pair that stays keeps its `K`.
    ///
    /// # Errors
    /// A box has a NaN or is inside out, or there are more than 2³⁰. All is as before then; where the number of
    /// objects is another, nothing is kept.
    pub fn update(
        &mut self,
        boxes: &[Aabb],
        may_meet: impl Fn(Pair) -> bool,
    ) -> Result<(), SpaceError> {
        if self.seen.len() != boxes.len() {
            *self = Self::default();
        }
        self.find_left(boxes);
        for &i in &self.left {
            boxes::check(i as usize, &boxes[i as usize])?;
        }
        self.updates = self.updates.wrapping_add(1);
        if !self.left.is_empty() {
            self.grow(boxes)?;
            self.merge(may_meet);
        }
        Ok(())
    }

    /// All pairs whose boxes overlap, and some more, in order.
    pub fn pairs(&self) -> &[(Pair, K)] {
        &self.pairs
    }

    /// The same, with what is known of them to be changed.
    pub fn pairs_mut(&mut self) -> &mut [(Pair, K)] {
        &mut self.pairs
    }

    /// Lists the objects that are no longer inside their fat boxes; before the first update, all.
    fn find_left(&mut self, boxes: &[Aabb]) {
        self.left.clear();
        self.has_left.clear();
        match &self.space {
            Some(space) => {
                let fat = space.boxes().all().iter();
                // What is inside out is nowhere.
                let inside =
                    |(fat, own): (&Aabb, &Aabb)| fat.contains(own) & own.min.cmple(own.max).all();
                self.has_left
                    .extend(fat.zip(boxes).map(|both| !inside(both)));
            }
            None => self.has_left.resize(boxes.len(), true),
        }
        let all = (0..).zip(&self.has_left);
        self.left.extend(all.filter(|o| *o.1).map(|o| o.0));
    }

    /// Gives those that have left another fat box, and finds their pairs.
    fn grow(&mut self, boxes: &[Aabb]) -> Result<(), SpaceError> {
        self.fresh.clear();
        let Some(space) = &mut self.space else {
            let space = Space::new(boxes)?;
            space.pairs_into(&mut self.fresh);
            self.space = Some(space);
            self.seen = boxes.iter().map(|own| (*own, self.updates)).collect();
            return Ok(());
        };
        let mut fat = |i: u32| {
            let (own, seen) = (&boxes[i as usize], &mut self.seen[i as usize]);
            let (before, when) = std::mem::replace(seen, (*own, self.updates));
            fattened(own, &before, self.updates.wrapping_sub(when))
        };
        let (left, has_left) = (&self.left, &self.has_left);
        let [most, some] = [FEW, SOME].map(|share| left.len() * share > boxes.len());
        if some {
            let mut all = space.boxes().all().to_vec();
            for &i in left {
                all[i as usize] = fat(i);
            }
            space.update(&all)?;
        } else {
            for &i in left {
                space.relocate(i, fat(i))?;
            }
        }
        if most {
            space.pairs_into(&mut self.fresh);
            self.fresh
                .retain(|pair| has_left[pair.a as usize] | has_left[pair.b as usize]);
            return Ok(());
        }
        pairs::gather(left.len(), CHUNK, &mut self.fresh, |range, found| {
            for &i in &left[range] {
                let others = space.overlap(space.boxes().get(i)).into_iter();
                // Two that have left find each other twice.
                let once = others.filter(|j| *j > i || (*j < i && !has_left[*j as usize]));
                found.extend(once.map(|j| Pair::new(i, j)));
            }
        });
        if some {
            pairs::sort(&mut self.fresh, boxes.len());
        } else {
            self.fresh.sort_unstable();
        }
        Ok(())
    }

    /// Replaces the pairs of those that have left by what was found.
    fn merge(&mut self, may_meet: impl Fn(Pair) -> bool) {
        let left = &self.has_left;
        let stays = |pair: &Pair| !(left[pair.a as usize] | left[pair.b as usize]);
        self.next.clear();
        let mut old = self.pairs.drain(..).peekable();
        for &pair in &self.fresh {
            while let Some(kept) = old.next_if(|kept| kept.0 < pair) {
                if stays(&kept.0) {
                    self.next.push(kept);
                }
            }
            match old.next_if(|kept| kept.0 == pair) {
                Some(kept) => self.next.push(kept),
                None if may_meet(pair) => self.next.push((pair, K::default())),
                None => {}
            }
        }
        self.next.extend(old.filter(|kept| stays(&kept.0)));
        std::mem::swap(&mut self.pairs, &mut self.next);
    }
}

/// The fat box of an object that has come here from another box in so many updates.
fn fattened(own: &Aabb, before: &Aabb, updates: u32) -> Aabb {
    if !own.is_bounded() {
        return *own;
    }
    let margin = FAT / 3.0 * own.extent().element_sum();
    let shift = (own.min - before.min)
        .abs()
        .max((own.max - before.max).abs());
    let lasts = shift.max_element() * LASTING <= margin * updates as f32;
    own.padded(if lasts { margin } else { 0.0 })
}
