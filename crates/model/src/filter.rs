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
/// - neither is of a kind that the other collides with ([`Shape::membership`]),
/// - their bodies are excluded from each other ([`Parts::exclusions`](crate::Parts::exclusions)),
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
    /// Bodies that a joint ties, or that are excluded from each other, the lower row first.
    apart: HashSet<(usize, usize)>,
}

/// What a shape has from its body.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Membership {
    body: Option<usize>,
    moves: bool,
    collides: bool,
    membership: u32,
    collides_with: u32,
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
        let tied = restrains.filter_map(|j| Some(ordered(j.parent?.0, j.child.0)));
        let excluded = model.exclusions.iter().map(|(a, b)| ordered(a.0, b.0));
        Self {
            shapes,
            apart: tied.chain(excluded).collect(),
        }
    }

    /// All pairs of shapes that may collide, the lower row first, in order.
    pub fn pairs(&self) -> impl Iterator<Item = (ShapeId, ShapeId)> {
        let n = self.shapes.len();
        (0..n)
            .flat_map(move |a| (a + 1..n).map(move |b| (ShapeId(a), ShapeId(b))))
            .filter(|(a, b)| self.may_collide(*a, *b))
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
            && ((a.membership & b.collides_with) | (b.membership & a.collides_with)) != 0
            && groups_collide(a.group, b.group)
            && share_world
            && !self.are_apart(a.body, b.body)
    }

    fn are_apart(&self, a: Option<usize>, b: Option<usize>) -> bool {
        a.zip(b)
            .is_some_and(|(a, b)| self.apart.contains(&ordered(a, b)))
    }
}

impl Membership {
    fn of(shape: &Shape, model: &Model) -> Self {
        let Shape {
            collides,
            membership,
            collides_with,
            ..
        } = *shape;
        match shape.body {
            None => Self {
                body: None,
                moves: false,
                collides,
                membership,
                collides_with,
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
                    membership,
                    collides_with,
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
