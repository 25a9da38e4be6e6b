//! What a device has made of instruments.

use rigid::Instrument;
use std::ops::{Index, IndexMut};
use std::sync::{Arc, Weak};

/// What was made of instruments, for as long as anybody may still read them.
#[derive(Debug)]
pub struct Instruments<F>(Vec<(Weak<Instrument>, F)>);

impl<F> Default for Instruments<F> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<F> Instruments<F> {
    /// The row of what was made of an instrument, if it still `serves`, or is made now; none where it cannot be.
    ///
    /// # Errors
    /// What `make` says.
    pub fn row_of<E>(
        &mut self,
        instrument: &Arc<Instrument>,
        serves: impl FnOnce(&F) -> bool,
        make: impl FnOnce() -> Result<Option<F>, E>,
    ) -> Result<Option<usize>, E> {
        let of = Arc::downgrade(instrument);
        let known = self.0.iter().position(|(own, _)| own.ptr_eq(&of));
        if let Some(row) = known {
            if serves(&self.0[row].1) {
                return Ok(Some(row));
            }
            self.0.swap_remove(row);
        }
        self.0.retain(|(own, _)| own.strong_count() > 0);
        Ok(make()?.map(|made| {
            self.0.push((of, made));
            self.0.len() - 1
        }))
    }
}

impl<F> Index<usize> for Instruments<F> {
    type Output = F;
    fn index(&self, row: usize) -> &F {
        &self.0[row].1
    }
}

impl<F> IndexMut<usize> for Instruments<F> {
    fn index_mut(&mut self, row: usize) -> &mut F {
        &mut self.0[row].1
    }
}
