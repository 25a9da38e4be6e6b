//! Bodies that have been slow for long sleep, island by island, until something touches them.
//!
//! An island is bodies that press on each other, or that joints tie. It sleeps when each of its bodies
//! has been slow for [`SLEEP_AFTER`], and it rests on something that does not move, or is tied to it; and if nothing
//! moves a joint of it that dampers hold back ([`rigid::impulse::Impulse::creeps`]).
//! Nothing of it is looked at then, and its contacts and joints are kept as they were: they are told to give what they
//! gave in the last small step. What moves into
//! it, a force from outside on one of its bodies, or a controller that moves one of its joints, wakes
//! all of it.

use super::islands::Islands;
use super::world::{Workspace, World};
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{placed, solid};
use rigid::impulse::{Cached, NEARBY, SLEEP_AFTER, State, WORLD, mass, state};

/// Who sleeps in a world, and what of it is kept.
#[derive(Debug)]
pub(super) struct Sleep<T> {
    /// By body.
    pub asleep: Vec<bool>,
    /// For how long [s] each body has been slow.
    rest: Vec<f64>,
    /// Contacts of the step before, where anything sleeps.
    before: Vec<Cached<T>>,
    /// Contacts between bodies that sleep on.
    pub frozen: Vec<Cached<T>>,
    islands: Islands,
    /// Of each island, by its first body.
    touched: Vec<bool>,
    grounded: Vec<bool>,
    least: Vec<f64>,
    /// How far [m] each body reaches from its centre of mass.
    radii: Vec<f64>,
}

impl<T> Default for Sleep<T> {
    fn default() -> Self {
        Self {
            asleep: Vec::new(),
            rest: Vec::new(),
            before: Vec::new(),
            frozen: Vec::new(),
            islands: Islands::default(),
            touched: Vec::new(),
            grounded: Vec::new(),
            least: Vec::new(),
            radii: Vec::new(),
        }
    }
}

/// The same everywhere.
fn refill<X: Clone>(list: &mut Vec<X>, length: usize, x: X) {
    list.clear();
    list.resize(length, x);
}

impl<T: Float> Sleep<T> {
    /// Nobody sleeps.
    pub fn clear(&mut self, bodies: usize) {
        refill(&mut self.asleep, bodies, false);
        refill(&mut self.rest, bodies, 0.0);
    }
    /// Of each body whether it sleeps, and for how long [s] it has been slow; a thread takes so many as a part at a time.
    pub fn bodies(
        &mut self,
        part: usize,
    ) -> impl IndexedParallelIterator<Item = (&mut bool, &mut f64)> {
        let asleep = self.asleep.par_iter_mut().with_min_len(part);
        asleep.zip(&mut self.rest)
    }
    /// Wakes two bodies.
    pub fn wake(&mut self, rows: [u32; 2]) {
        for row in rows {
            (self.asleep[row as usize], self.rest[row as usize]) = (false, 0.0);
        }
    }
    fn is_asleep(&self, body: u32) -> bool {
        self.asleep[body as usize]
    }
}

impl<T: Float> World<'_, T> {
    /// Keeps the contacts of the step before, if any of them are needed.
    pub fn remember_sleepers(&self, state: &[T], w: &mut Workspace<T>) {
        let impulse = self.impulse();
        w.sleep.before.clear();
        if w.sleep.asleep.contains(&true) {
            let all = 0..impulse.remembered(state);
            let contacts = all.map(|i| impulse.recall(i, state).contact());
            w.sleep.before.extend(contacts);
        }
    }

    /// Wakes the islands that what is awake touches, or is tied to; tells whether any woke.
    pub fn wake_touched(&self, w: &mut Workspace<T>) -> bool {
        let sleep = &mut w.sleep;
        let bodies = sleep.asleep.len();
        if !sleep.asleep.contains(&true) {
            return false;
        }
        sleep.islands.separate(bodies);
        for contact in sleep.before.iter().filter(|c| !self.is_sensed(c)) {
            let [a, b] = self.rows_of(contact);
            if sleep.asleep[a as usize] && sleep.asleep[b as usize] {
                sleep.islands.join(a, b);
            }
        }
        for (_, [a, b]) in self.joints() {
            if sleep.asleep[a as usize] && sleep.asleep[b as usize] {
                sleep.islands.join(a, b);
            }
        }
        refill(&mut sleep.touched, bodies, false);
        for (_, [a, b]) in self.joints().filter(|(_, rows)| !rows.contains(&WORLD)) {
            for (sleeper, other) in [(a, b), (b, a)] {
                if sleep.is_asleep(sleeper) && !sleep.is_asleep(other) {
                    let island = sleep.islands.of(sleeper);
                    sleep.touched[island as usize] = true;
                }
            }
        }
        for contact in &w.found {
            let [a, b] = self.rows_of(contact);
            let way = contact
                .shapes
                .map(|s| w.placed[s as usize].placed[placed::WAY]);
            for (sleeper, way) in [(a, way[1]), (b, way[0])] {
                if sleep.is_asleep(sleeper) && is_within(contact, way.to_f64() + NEARBY) {
                    let island = sleep.islands.of(sleeper);
                    sleep.touched[island as usize] = true;
                }
            }
        }
        let mut woke = false;
        for body in 1..bodies {
            let island = sleep.islands.of(body as u32) as usize;
            if sleep.asleep[body] && sleep.touched[island] {
                (sleep.asleep[body], sleep.rest[body]) = (false, 0.0);
                woke = true;
            }
        }
        woke
    }

    /// Leaves out contacts with bodies that sleep on, and keeps those among sleepers as they were.
    pub fn drop_sleepers(&self, w: &mut Workspace<T>) {
        std::mem::swap(&mut w.contacts, &mut w.found);
        w.sleep.frozen.clear();
        let sleep = &mut w.sleep;
        if sleep.before.is_empty() {
            return;
        }
        let asleep = &sleep.asleep;
        let sleeps = |row: &u32| asleep[*row as usize];
        let rests = |row: &u32| *row == WORLD || sleeps(row);
        let frozen = sleep.before.iter();
        let frozen = frozen.filter(|contact| self.rows_of(contact).iter().all(rests));
        sleep.frozen.extend(frozen);
        let steps = self.small_steps();
        sleep.frozen.iter_mut().for_each(|c| c.persist(steps));
        w.contacts
            .retain(|contact| !self.rows_of(contact).iter().any(sleeps));
    }

    /// Counts for how long bodies have been slow, and lets islands sleep.
    pub fn rest(&self, state: &mut [T], w: &mut Workspace<T>) {
        let slow = self.impulse().settings().sleep_speed;
        if slow == 0.0 {
            return;
        }
        self.find_islands(w);
        self.find_radii(w);
        let sleep = &mut w.sleep;
        refill(&mut sleep.least, sleep.asleep.len(), f64::INFINITY);
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let at = self.impulse().body_state(body as usize);
            let speed = speed(&state[at..][..state::WIDTH], sleep.radii[body as usize]);
            let rest = sleep.rest[body as usize] + self.length();
            let island = sleep.islands.of(body) as usize;
            let rest = if speed < slow { rest } else { 0.0 };
            sleep.least[island] = sleep.least[island].min(rest);
        }
        let numbers = State {
            impulse: self.impulse(),
            state,
            parameters: self.parameters,
        };
        for (tie, rows) in self.joints() {
            let island = sleep.islands.of(rows[0].max(rows[1])) as usize;
            let reaches = rows.map(|row| sleep.radii[row as usize]);
            let sleepy = (SLEEP_AFTER..f64::INFINITY).contains(&sleep.least[island]);
            if sleepy && self.impulse().creeps(tie, &numbers, reaches, slow) {
                sleep.least[island] = 0.0;
            }
        }
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let island = sleep.islands.of(body) as usize;
            let at = self.impulse().body_state(body as usize);
            let to = &mut state[at..][..state::WIDTH];
            let rest = sleep.least[island];
            if rest >= SLEEP_AFTER && sleep.grounded[island] {
                to[state::VELOCITY..state::REST].fill(T::zero());
                to[state::REST] = T::from_f64(SLEEP_AFTER);
            } else {
                // Short of sleep, in whichever precision.
                let awake = SLEEP_AFTER - 0.5 * self.length().max(1e-6);
                to[state::REST] = T::from_f64(rest.min(awake));
            }
        }
    }

    /// Bodies that press on each other or are tied, and which of their islands something fixed holds.
    fn find_islands(&self, w: &mut Workspace<T>) {
        let sleep = &mut w.sleep;
        let bodies = sleep.asleep.len();
        sleep.islands.separate(bodies);
        refill(&mut sleep.grounded, bodies, false);
        let pressed = w.contacts.iter().filter(|contact| contact.presses());
        let ties = self.joints().map(|(_, rows)| rows);
        let links = pressed.map(|contact| self.rows_of(contact)).chain(ties);
        for [a, b] in links.clone().filter(|rows| !rows.contains(&WORLD)) {
            sleep.islands.join(a, b);
        }
        for [a, b] in links.filter(|rows| rows.contains(&WORLD)) {
            let island = sleep.islands.of(a.max(b)) as usize;
            sleep.grounded[island] = true;
        }
    }

    /// The largest radius of gyration [m] of a body: it may have no shapes.
    fn gyration(&self, row: usize) -> f64 {
        let numbers = self.impulse().mass_of(row, self.parameters);
        let moments = numbers[mass::MOMENTS..][..3].iter().map(|x| x.to_f64());
        let most = moments.fold(0.0, f64::max);
        (most / numbers[mass::MASS].to_f64()).sqrt()
    }

    /// How far bodies reach from their centres of mass: their shapes, or else their masses.
    fn find_radii(&self, w: &mut Workspace<T>) {
        let radii = &mut w.sleep.radii;
        refill(radii, w.sleep.asleep.len(), 0.0);
        let shapes = self.impulse().shapes().iter();
        let solids = self.impulse().solids(self.parameters);
        for (shape, numbers) in shapes.zip(solids.chunks_exact(solid::WIDTH)) {
            let center = length(&numbers[solid::POSE..][..3]);
            let radius = &mut radii[shape.row as usize];
            *radius = radius.max(center + numbers[solid::RADIUS].to_f64());
        }
        let bare = radii.iter_mut().enumerate().skip(1).filter(|r| *r.1 == 0.0);
        bare.for_each(|(row, radius)| *radius = self.gyration(row));
    }
}

/// Whether a contact has a point whose gap is smaller than `reach` [m].
fn is_within<T: Float>(contact: &Cached<T>, reach: f64) -> bool {
    let points = &contact.points[..contact.count];
    points.iter().any(|p| p.gap.to_f64() < reach)
}

/// How fast [m/s] a body's farthest point may be.
fn speed<T: Float>(body: &[T], radius: f64) -> f64 {
    let (v, w) = (state::VELOCITY, state::VELOCITY + 3);
    length(&body[v..][..3]) + length(&body[w..][..3]) * radius
}

fn length<T: Float>(v: &[T]) -> f64 {
    let squares = v.iter().map(|x| x.to_f64().powi(2));
    squares.sum::<f64>().sqrt()
}
