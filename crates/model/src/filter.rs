//! Which shapes may touch which.

use crate::{BodyKind, JointKind, Model, Shape, ShapeId};
use std::collections::HashSet;

/// Group of static bodies and of shapes fixed to the world, unless a body says otherwise.
pub(crate) const STATIC_GROUP: i32 = -1;
/// World that all others share.
const SHARED_WORLD: i32 = -1;

/// Decides which pairs of a model's shapes may collide.
///
/// A pair may, unless
/// - one of them does not collide at all ([`Shape::collides`]),
/// - both belong to one body, or neither to a dynamic body,
/// - their groups forbid it: group 0 collides with nothing, positive groups with positive and
///   negative ones, negative groups only with positive ones,
/// - their bodies stand in different worlds, neither of them −1, which all share, or
/// - one body is the parent and the other the child of a joint that restrains them. A free joint
///   restrains nothing; and a joint to the world itself does not keep its child from touching the
///   world's shapes.
///
/// Shapes fixed to the world are static, in group −1 and world −1.
#[derive(Clone, Debug, PartialEq)]
pub struct CollisionFilter {
    shapes: Vec<Membership>,
    /// Bodies that a joint ties, the lower row first.
    tied: HashSet<(usize, usize)>,
}

/// What a shape has from its body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Membership {
    body: Option<usize>,
    moves: bool,
    collides: bool,
    group: i32,
    world: i32,
}

impl CollisionFilter {
    /// The filter of a model.
    pub fn new(model: &Model) -> Self {
        let shapes = model
            .shapes
            .iter()
            .map(|s| Membership::of(s, model))
            .collect();
        let restrains = model.joints.iter().filter(|j| j.kind != JointKind::Free);
        let tied = restrains
            .filter_map(|j| Some(ordered(j.parent?.0, j.child.0)))
            .collect();
        Self { shapes, tied }
    }

    /// Whether two shapes of the model may collide; the order does not matter.
    ///
    /// # Panics
    /// If a shape is not of the model that the filter was made for.
    pub fn may_collide(&self, a: ShapeId, b: ShapeId) -> bool {
        let (a, b) = (self.shapes[a.0], self.shapes[b.0]);
        let share_world = a.world == b.world || a.world == SHARED_WORLD || b.world == SHARED_WORLD;
        a.collides
            && b.collides
            && a.body != b.body
            && (a.moves || b.moves)
            && groups_collide(a.group, b.group)
            && share_world
            && !self.are_tied(a.body, b.body)
    }

    fn are_tied(&self, a: Option<usize>, b: Option<usize>) -> bool {
        a.zip(b)
            .is_some_and(|(a, b)| self.tied.contains(&ordered(a, b)))
    }
}

impl Membership {
    fn of(shape: &Shape, model: &Model) -> Self {
        let collides = shape.collides;
        match shape.body {
            None => Self {
                body: None,
                moves: false,
                collides,
                group: STATIC_GROUP,
                world: SHARED_WORLD,
            },
            Some(id) => {
                let body = &model.bodies[id.0];
                let moves = body.kind == BodyKind::Dynamic;
                let (group, world) = (body.group, body.world);
                Self {
                    body: Some(id.0),
                    moves,
                    collides,
                    group,
                    world,
                }
            }
        }
    }
}

fn groups_collide(a: i32, b: i32) -> bool {
    (a > 0 && b != 0) || (b > 0 && a != 0)
}

fn ordered(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}
