//! What is struck gets farther than it was looked for.
//!
//! Contacts are looked for as far as shapes get by the velocities that they have when a step begins. A body
//! that is struck within the step gets farther, and may get through what it was not looked at with. So where a shape
//! has moved by half of its thickness more than was foreseen, which is what takes its middle past what it touched,
//! the step is taken again from its beginning, and contacts are looked for as far as it got. What it strikes then may
//! get farther in turn.
//!
//! What gets less far is left to the next step, which bounces by the speed of then.

use super::odometers::{Place, moved};
use super::world::{Workspace, World};
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{placed, solid};
use rigid::impulse::{WORLD, row, state};

/// How often a step is taken at most.
pub(super) const ATTEMPTS: usize = 4;

impl<T: Float> World<'_, T> {
    /// Looks ahead of the shapes in their places as far as they got in the attempt before.
    pub fn look_farther(&self, w: &mut Workspace<T>) {
        for (shape, more) in w.placed.iter_mut().zip(&w.ahead) {
            for at in [
                placed::WAY,
                placed::REACH,
                placed::EXTENT,
                placed::EXTENT + 1,
                placed::EXTENT + 2,
            ] {
                shape.placed[at] += *more;
            }
        }
    }

    /// Whether any shape has got farther than was foreseen; by how much each has, is kept for the next attempt.
    pub fn went_farther(&self, state: &[T], w: &mut Workspace<T>) -> bool {
        let shapes = self.impulse().shapes().len();
        w.ahead.resize(shapes, T::zero());
        let (rows, asleep, placed) = (&w.rows, &w.sleep.asleep, &w.placed);
        let ahead = w.ahead.par_iter_mut().with_min_len(self.part(shapes));
        let farther = ahead.enumerate().filter_map(|(shape, ahead)| {
            let body = self.impulse().shapes()[shape].row;
            if body == WORLD || asleep[body as usize] {
                return None;
            }
            let body = body as usize;
            let center = &state[self.impulse().body_state(body)..][state::CENTER..];
            let from: Place = std::array::from_fn(|i| center[i].to_f64());
            let to = std::array::from_fn(|i| rows.load(body, row::CENTER + i).to_f64());
            let at = &placed[shape].placed;
            let arm = |i: usize| (at[placed::POSITION + i].to_f64() - from[i]).powi(2);
            let arm = (arm(0) + arm(1) + arm(2)).sqrt();
            let radius = self.impulse().radius_of(shape, self.parameters).to_f64();
            let more = moved(&from, &to, arm + radius) - at[placed::WAY].to_f64();
            let solid = self.impulse().solid_of(shape, self.parameters);
            (more > solid[solid::THICKNESS].to_f64()).then(|| *ahead += T::from_f64(more))
        });
        farther.count() > 0
    }
}
