//! Things that are told of at once.

use std::ops::Range;

/// All things of these worlds, or some of those of one.
#[derive(Clone, Debug)]
pub struct Part {
    pub worlds: Range<usize>,
    pub things: Range<usize>,
}

impl Part {
    /// The parts of so many worlds, of which each has so many things; with room for so many of these.
    pub fn all(worlds: usize, own: usize, room: usize) -> Vec<Self> {
        if own > room {
            let starts = move || (0..own).step_by(room);
            let of_world = |world| {
                starts().map(move |first| Self {
                    worlds: world..world + 1,
                    things: first..own.min(first + room),
                })
            };
            return (0..worlds).flat_map(of_world).collect();
        }
        let together = room / own.max(1);
        let starts = (0..worlds).step_by(together);
        let part = |first| Self {
            worlds: first..worlds.min(first + together),
            things: 0..own,
        };
        starts.map(part).collect()
    }
    /// How many things it has.
    pub fn count(&self) -> usize {
        self.worlds.len() * self.things.len()
    }
    /// Which of these one of a world is, if it is.
    pub fn find(&self, world: usize, thing: usize) -> Option<usize> {
        let is_one = self.things.contains(&thing);
        let first = (world - self.worlds.start) * self.things.len();
        is_one.then(|| first + thing - self.things.start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_all_things_once_and_in_order() {
        for (worlds, own, room) in [(1, 1, 1), (7, 3, 9), (7, 3, 10), (2, 10, 4), (3, 4, 4)] {
            let mut all = Vec::new();
            for part in Part::all(worlds, own, room) {
                assert!(part.count() <= room);
                let mut found = vec![None; part.count()];
                for world in part.worlds.clone() {
                    for thing in 0..own {
                        if let Some(i) = part.find(world, thing) {
                            assert_eq!(found[i].replace(world * own + thing), None);
                        }
                    }
                }
                all.extend(found);
            }
            let expected = (0..worlds * own).map(Some);
            assert!(all.into_iter().eq(expected), "{worlds} of {own} by {room}");
        }
    }
}
