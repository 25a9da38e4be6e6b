//! The objects: one checked box each.

use crate::{Aabb, SpaceError};

/// Bits 30 and 31 are free for a structure's own marks.
pub(crate) const MOST_OBJECTS: usize = 1 << 30;

/// One box per object, by index. No NaN, none inside out.
///
/// Removed objects hold [`Aabb::EMPTY`] until their index is used again.
/// Unbounded boxes (planes) are listed apart, so that no structure meets an infinity.
#[derive(Clone, Debug, Default)]
pub struct Boxes {
    boxes: Vec<Aabb>,
    unbounded: Vec<u32>,
    free: Vec<u32>,
}

impl Boxes {
    /// # Errors
    /// A box has a NaN or is inside out, or there are more than 2³⁰.
    pub fn new(boxes: &[Aabb]) -> Result<Self, SpaceError> {
        if boxes.len() > MOST_OBJECTS {
            return Err(SpaceError::TooMany {
                given: boxes.len(),
                limit: MOST_OBJECTS,
            });
        }
        for (object, aabb) in boxes.iter().enumerate() {
            check(object, aabb)?;
        }
        let unbounded = (0..boxes.len()).filter(|i| !boxes[*i].is_bounded());
        Ok(Self {
            unbounded: unbounded.map(|i| i as u32).collect(),
            boxes: boxes.to_vec(),
            free: Vec::new(),
        })
    }

    /// All boxes, those of removed objects included.
    #[inline]
    pub fn all(&self) -> &[Aabb] {
        &self.boxes
    }

    /// An object's box; [`Aabb::EMPTY`] where it has been removed.
    #[inline]
    pub fn get(&self, object: u32) -> &Aabb {
        &self.boxes[object as usize]
    }

    /// Objects present.
    pub fn count(&self) -> usize {
        self.boxes.len() - self.free.len()
    }

    /// Whether an object has this index.
    #[inline]
    pub fn contains(&self, object: u32) -> bool {
        self.boxes
            .get(object as usize)
            .is_some_and(|b| b.min.x <= b.max.x)
    }

    /// Objects with unbounded boxes, in order.
    #[inline]
    pub fn unbounded(&self) -> &[u32] {
        &self.unbounded
    }

    /// Objects with bounded boxes, in order.
    pub fn bounded(&self) -> impl Iterator<Item = (u32, &Aabb)> {
        let numbered = self.boxes.iter().enumerate().map(|(i, b)| (i as u32, b));
        numbered.filter(|(_, b)| b.is_bounded())
    }

    /// Replaces the boxes of all objects that are present; says whether the set of unbounded ones changed.
    pub(crate) fn replace(&mut self, boxes: &[Aabb]) -> Result<bool, SpaceError> {
        if boxes.len() != self.boxes.len() {
            return Err(SpaceError::Count {
                given: boxes.len(),
                expected: self.boxes.len(),
            });
        }
        let present = |i: &usize| self.contains(*i as u32);
        for object in (0..boxes.len()).filter(present) {
            check(object, &boxes[object])?;
        }
        let unbounded = (0..boxes.len())
            .filter(present)
            .filter(|i| !boxes[*i].is_bounded());
        let unbounded: Vec<u32> = unbounded.map(|i| i as u32).collect();
        self.boxes.copy_from_slice(boxes);
        for object in &self.free {
            self.boxes[*object as usize] = Aabb::EMPTY;
        }
        let changed = unbounded != self.unbounded;
        self.unbounded = unbounded;
        Ok(changed)
    }

    /// Adds an object under the index freed last, or a new one.
    pub(crate) fn insert(&mut self, aabb: Aabb) -> Result<u32, SpaceError> {
        let object = self.free.last().map_or(self.boxes.len(), |i| *i as usize);
        check(object, &aabb)?;
        if object == MOST_OBJECTS {
            return Err(SpaceError::TooMany {
                given: object + 1,
                limit: MOST_OBJECTS,
            });
        }
        match self.free.pop() {
            Some(object) => self.boxes[object as usize] = aabb,
            None => self.boxes.push(aabb),
        }
        self.list(object as u32);
        Ok(object as u32)
    }

    /// Takes an object out; returns its box.
    pub(crate) fn remove(&mut self, object: u32) -> Result<Aabb, SpaceError> {
        let old = self.set(object, Aabb::EMPTY)?;
        self.unbounded.retain(|i| *i != object);
        self.free.push(object);
        Ok(old)
    }

    /// Gives an object another box; returns the old one.
    pub(crate) fn relocate(&mut self, object: u32, aabb: Aabb) -> Result<Aabb, SpaceError> {
        check(object as usize, &aabb)?;
        let old = self.set(object, aabb)?;
        self.unbounded.retain(|i| *i != object);
        self.list(object);
        Ok(old)
    }

    fn set(&mut self, object: u32, aabb: Aabb) -> Result<Aabb, SpaceError> {
        if !self.contains(object) {
            return Err(SpaceError::NoSuchObject {
                object: object as usize,
            });
        }
        Ok(std::mem::replace(&mut self.boxes[object as usize], aabb))
    }

    /// Lists an object as unbounded if it is.
    fn list(&mut self, object: u32) {
        if !self.get(object).is_bounded()
            && let Err(place) = self.unbounded.binary_search(&object)
        {
            self.unbounded.insert(place, object);
        }
    }
}

/// Refuses boxes with a NaN, and those inside out.
pub(crate) fn check(object: usize, aabb: &Aabb) -> Result<(), SpaceError> {
    let Aabb { min, max } = *aabb;
    if min.is_nan() || max.is_nan() {
        return Err(SpaceError::NotANumber { object, min, max });
    }
    if min.cmpgt(max).any() {
        return Err(SpaceError::InsideOut { object, min, max });
    }
    Ok(())
}
