//! Contacts from their records into lanes, and back.

use numbers::{Float, Memory};
use rigid::impulse::{
    Cached, CachedPoint, ContactTables, Impulse, POINTS, contact, manifold, point,
};

/// Memory for contacts in lanes; kept from step to step, its contents are not.
pub(super) struct Lanes<T> {
    numbers: Memory<T>,
    /// Of each batch, its block of them.
    blocks: Vec<usize>,
    /// Bodies A, then bodies B, of each batch.
    bodies: Vec<u32>,
}

impl<T: Float> Default for Lanes<T> {
    fn default() -> Self {
        Self {
            numbers: Memory::new(0, 1, 1),
            blocks: Vec::new(),
            bodies: Vec::new(),
        }
    }
}

/// A register's worth of contacts of one colour.
pub(super) struct Batch<'a, T> {
    pub numbers: &'a mut [T],
    /// Bodies A, then bodies B, a lane each; row 0 where nothing moves.
    pub bodies: &'a mut [u32],
    /// Which contacts these are.
    pub members: &'a [u32],
    /// Most points that one of them has.
    pub points: u32,
    /// Whether any of them can bounce.
    pub bounces: bool,
    /// Whether any of those could be struck within the step before another is.
    pub meets: bool,
}

impl<T: Float> Lanes<T> {
    /// Room for batches of `width` contacts, at these places.
    pub fn make_room(&mut self, places: impl Iterator<Item = usize>, width: usize) {
        self.blocks.clear();
        self.blocks.extend(places);
        let blocks = self.blocks.last().map_or(0, |last| last + 1);
        let (lanes, length) = (blocks * width, ContactTables::new().length);
        let fits = self.numbers.width() == width && self.numbers.length() == length;
        if !fits || self.numbers.worlds() < lanes {
            self.numbers = Memory::new(lanes + lanes / 4 + width, length, width);
        }
        self.bodies.resize(2 * lanes.max(self.bodies.len() / 2), 0);
    }

    /// The batches, each with its contacts, and still to be filled.
    pub fn batches<'a>(
        &'a mut self,
        members: impl Iterator<Item = &'a [u32]>,
        width: usize,
    ) -> impl Iterator<Item = Batch<'a, T>> {
        let block = self.numbers.block_size();
        let mut numbers = self.numbers.scalars_mut().chunks_exact_mut(block);
        let mut next = 0;
        let numbers = self.blocks.iter().filter_map(move |&place| {
            let left_out = place - next;
            next = place + 1;
            numbers.nth(left_out)
        });
        let bodies = self.bodies.chunks_exact_mut(2 * width);
        let rooms = numbers.zip(bodies).zip(members);
        rooms.map(|((numbers, bodies), members)| Batch {
            numbers,
            bodies,
            members,
            points: 0,
            bounces: false,
            meets: false,
        })
    }

    /// Takes back the impulses of the contact in a lane; lanes are counted through all batches.
    pub fn read(&self, lane: usize, contact: &mut Cached<T>) {
        let t = ContactTables::new();
        let width = self.numbers.width();
        let numbers = self.numbers.block(self.blocks[lane / width]);
        let get = |at: usize| numbers[at * width + lane % width];
        for axis in 0..3 {
            contact.drag[axis] = get(t.manifold.at(0, manifold::DRAG + axis));
            contact.twist[axis] = get(t.manifold.at(0, manifold::TWIST + axis));
            contact.drag_sum[axis] = get(t.manifold.at(0, manifold::DRAG_SUM + axis));
            contact.twist_sum[axis] = get(t.manifold.at(0, manifold::TWIST_SUM + axis));
        }
        for (i, p) in contact.points[..contact.count].iter_mut().enumerate() {
            p.impulse = get(t.point.at(i, point::IMPULSE));
            p.sum = get(t.point.at(i, point::SUM));
        }
        let aside = [0, 1, 2].map(|i| get(t.manifold.at(0, manifold::ASIDE + i)));
        if aside != [T::zero(); 3] {
            contact.acted_aside(aside);
        }
    }
}

impl<T: Float> Batch<'_, T> {
    /// Writes the contacts into their lanes.
    pub fn fill(&mut self, impulse: &Impulse, parameters: &[T], contacts: &[Cached<T>]) {
        let width = self.bodies.len() / 2;
        self.bodies.fill(0);
        (self.points, self.bounces, self.meets) = (0, false, false);
        for (lane, &member) in self.members.iter().enumerate() {
            let contact = &contacts[member as usize];
            for (side, shape) in contact.shapes.into_iter().enumerate() {
                self.bodies[side * width + lane] = impulse.shapes()[shape as usize].row;
            }
            self.points = self.points.max(contact.count as u32);
            let mut row = Lane {
                numbers: self.numbers,
                width,
                lane,
            };
            self.bounces |= row.write(impulse, parameters, contact);
        }
    }

    /// Whether any of the contacts has just been struck, or may be.
    pub fn is_struck(&self) -> bool {
        let width = self.bodies.len() / 2;
        let at = ContactTables::new().manifold.at(0, manifold::STRUCK);
        let lanes = &self.numbers[at * width..][..width];
        lanes.iter().any(|struck| *struck > T::zero())
    }
}

/// A lane of a batch.
struct Lane<'a, T> {
    numbers: &'a mut [T],
    width: usize,
    lane: usize,
}

impl<T: Float> Lane<'_, T> {
    fn put(&mut self, at: usize, x: &[T]) {
        for (i, x) in x.iter().enumerate() {
            self.numbers[(at + i) * self.width + self.lane] = *x;
        }
    }

    /// Writes a contact; tells whether it can bounce.
    fn write(&mut self, impulse: &Impulse, parameters: &[T], contact: &Cached<T>) -> bool {
        let t = ContactTables::new();
        let surface = impulse.surface(contact.shapes, parameters);
        let coefficients = [
            surface.friction,
            surface.restitution,
            surface.torsion,
            surface.rolling,
            surface.spring[0],
            surface.spring[1],
            surface.settling,
        ];
        let at = |field| t.manifold.at(0, field);
        self.put(at(manifold::NORMAL), &contact.normal);
        for (i, x) in coefficients.into_iter().enumerate() {
            self.put(at(manifold::FRICTION + i), &[T::from_f64(x)]);
        }
        let thickness = impulse.way_through(contact.shapes, parameters);
        self.put(at(manifold::THICKNESS), &[thickness]);
        self.put(at(manifold::STICKING), &[T::from_f64(surface.sticking)]);
        self.put(at(manifold::DRAG), &contact.drag);
        self.put(at(manifold::TWIST), &contact.twist);
        self.put(at(manifold::DRAG_SUM), &contact.drag_sum);
        self.put(at(manifold::TWIST_SUM), &contact.twist_sum);
        for i in 0..POINTS {
            self.write_point(&t, contact, i);
        }
        surface.restitution > 0.0
    }

    /// Points that are not lie where the first does, but far apart: they give nothing.
    fn write_point(&mut self, t: &ContactTables, contact: &Cached<T>, i: usize) {
        let at = |field| t.point.at(i, field);
        let mut p = CachedPoint {
            gap: T::from_f64(contact::NOWHERE),
            impulse: T::zero(),
            sum: T::zero(),
            ..contact.points[0]
        };
        if i < contact.count {
            p = contact.points[i];
        }
        self.put(at(point::ARM_A), &p.position);
        self.put(at(point::GAP), &[p.gap, p.impulse]);
        self.put(at(point::SUM), &[p.sum]);
    }
}
