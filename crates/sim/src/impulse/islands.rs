//! Which bodies touch each other, directly or through others.

/// Disjoint sets of bodies (Tarjan, 1975: union by index, path halving).
#[derive(Debug, Default)]
pub(super) struct Islands {
    parent: Vec<u32>,
}

impl Islands {
    /// Each body by itself.
    pub fn separate(&mut self, bodies: usize) {
        self.parent.clear();
        self.parent.extend(0..bodies as u32);
    }
    /// The body that stands for an island: its lowest.
    pub fn of(&mut self, mut body: u32) -> u32 {
        while self.parent[body as usize] != body {
            let next = self.parent[self.parent[body as usize] as usize];
            self.parent[body as usize] = next;
            body = next;
        }
        body
    }
    /// Makes one island of two.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.of(a), self.of(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
