//! Which colliding shapes could touch within the step.

use super::sleep::NEARBY;
use collide::kind;
use glam::Vec3;
use model::CollisionFilter;
use numbers::Float;
use rigid::impulse::Impulse;
use rigid::impulse::pair::{Placed, placed};
use space::{Aabb, Auto, Pair, Space, SpaceError};

/// Boxes about all shapes, and the pairs whose boxes overlap.
#[derive(Debug, Default)]
pub(super) struct BroadPhase {
    boxes: Vec<Aabb>,
    space: Option<Space<Auto>>,
    pairs: Vec<Pair>,
}

impl BroadPhase {
    /// The pairs that may collide, in order: shapes whose ways within the step meet.
    ///
    /// # Errors
    /// A shape is nowhere.
    pub fn find<T: Float>(
        &mut self,
        impulse: &Impulse,
        filter: &CollisionFilter,
        shapes: &[Placed<T>],
        parameters: &[T],
        found: &mut Vec<[u32; 2]>,
    ) -> Result<(), SpaceError> {
        self.boxes.clear();
        for (i, shape) in shapes.iter().enumerate() {
            let grown = impulse.widest_margin(i as u32, parameters) + NEARBY;
            self.boxes.push(if impulse.shapes()[i].kind == kind::PLANE {
                Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY)
            } else {
                around(shape, grown)
            });
        }
        match &mut self.space {
            Some(space) => space.update(&self.boxes)?,
            None => self.space = Some(Space::new(&self.boxes)?),
        }
        if let Some(space) = &self.space {
            space.pairs_into(&mut self.pairs);
        }
        let id = |i: u32| impulse.shapes()[i as usize].shape;
        let may = |pair: &&Pair| filter.may_collide(id(pair.a), id(pair.b));
        found.clear();
        found.extend(self.pairs.iter().filter(may).map(|pair| [pair.a, pair.b]));
        Ok(())
    }
}

fn around<T: Float>(shape: &Placed<T>, grown: f64) -> Aabb {
    let at = |i: usize| shape.placed[i].to_f64() as f32;
    let vec3 = |i: usize| Vec3::new(at(i), at(i + 1), at(i + 2));
    let (center, half) = (vec3(placed::POSITION), vec3(placed::EXTENT));
    // What rounding to single precision may take away, far from the origin.
    let rounding = 1e-6 * (center.abs() + half).max_element();
    Aabb::around(center, half + (grown as f32 + rounding))
}
