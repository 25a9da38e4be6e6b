//! A stack of entries that rarely grows beyond a fixed size.

/// `N` entries in place; more go to the heap, which only a degenerate tree needs.
pub(crate) struct Stack<T, const N: usize> {
    place: [T; N],
    count: usize,
    more: Vec<T>,
}

impl<T: Copy + Default, const N: usize> Stack<T, N> {
    #[inline(always)]
    pub fn with(first: T) -> Self {
        let mut place = [T::default(); N];
        place[0] = first;
        Self {
            place,
            count: 1,
            more: Vec::new(),
        }
    }

    #[inline(always)]
    pub fn push(&mut self, entry: T) {
        if self.count < N {
            self.place[self.count] = entry;
            self.count += 1;
        } else {
            self.more.push(entry);
        }
    }

    /// Pushes the first `count` of four.
    #[inline(always)]
    pub fn push_some(&mut self, entries: [T; 4], count: usize) {
        let free = self.place.get_mut(self.count..);
        if let Some(place) = free.and_then(<[T]>::first_chunk_mut) {
            *place = entries;
            self.count += count;
        } else {
            // One by one, so that the four need not lie in memory.
            let [a, b, c, d] = entries;
            for (i, entry) in [(0, a), (1, b), (2, c), (3, d)] {
                if i < count {
                    self.push(entry);
                }
            }
        }
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        if self.count == N
            && let Some(entry) = self.more.pop()
        {
            return Some(entry);
        }
        self.count = self.count.checked_sub(1)?;
        Some(self.place[self.count])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is pushed, one or several at a time, comes back in reverse, beyond the fixed size as well.
    #[test]
    fn entries_come_back_in_reverse() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..200 {
            let (mut stack, mut list) = (Stack::<u32, 8>::with(7), vec![7]);
            for _ in 0..60 {
                let (entries, count) = ([(); 4].map(|()| random.u32(..)), random.usize(..5));
                stack.push_some(entries, count);
                list.extend(&entries[..count]);
                stack.push(entries[0]);
                list.push(entries[0]);
                for _ in 0..random.usize(..5) {
                    assert_eq!(stack.pop(), list.pop());
                }
            }
            while let Some(entry) = list.pop() {
                assert_eq!(stack.pop(), Some(entry));
            }
            assert_eq!(stack.pop(), None);
        }
    }
}
