//! Which shapes may touch which.

use crate::contact_pair::{ContactPair, key};
use crate::{BodyId, BodyKind, JointKind, Model, Shape, ShapeId};
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
/// - one body is the parent and the other the child of a joint that restrains them, and that does
///   not let them touch ([`Joint::bodies_collide`](crate::Joint::bodies_collide)). A free joint
///   restrains nothing; and a joint to the world itself does not keep its child from touching the
///   world's shapes.
///
/// Shapes fixed to the world are static, in group −1 and world −1.
///
/// Pairs that the model names ([`Parts::contact_pairs`](crate::Parts::contact_pairs)) may collide
/// whatever their masks, groups, exclusions and joints, but for those that are [`ContactPair::filtered`].
#[derive(Clone, Debug, PartialEq)]
pub struct CollisionFilter {
    shapes: Vec<Membership>,
    /// For each owner, those that it does not touch, in order.
    apart: Vec<Vec<usize>>,
    /// Rows of the pairs that touch in any case, the lower first.
    paired: HashSet<(usize, usize)>,
}

/// What a shape brings to the decision of a [`CollisionFilter`], but for pairs that the model names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterSide<'a> {
    /// 0 for the world, 1 more than its row for a body.
    pub owner: usize,
    /// Whether that is a dynamic body.
    pub moves: bool,
    /// See [`Shape::collides`].
    pub collides: bool,
    /// See [`Shape::membership`].
    pub membership: u32,
    /// See [`Shape::collides_with`].
    pub collides_with: u32,
    /// See [`Body::group`](crate::Body::group).
    pub group: i32,
    /// See [`Body::world`](crate::Body::world).
    pub world: i32,
    /// Owners that it does not touch, in order.
    pub apart: &'a [usize],
}

/// What a shape has from its body, and says itself.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Membership {
    /// 0 for the world, 1 more than its row for a body.
    owner: usize,
    moves: bool,
    collides: bool,
    /// Whether it is of any pair that touches in any case.
    paired: bool,
    membership: u32,
    collides_with: u32,
    group: i32,
    world: i32,
}

impl CollisionFilter {
    /// The filter of a model.
    pub fn new(model: &Model) -> Self {
        let pairs = model.contact_pairs.iter().filter(|pair| !pair.filtered);
        let paired: HashSet<_> = pairs.map(ContactPair::key).collect();
        let mut shapes: Vec<_> = model
            .shapes
            .iter()
            .map(|s| Membership::of(s, model))
            .collect();
        for &(a, b) in &paired {
            (shapes[a].paired, shapes[b].paired) = (true, true);
        }
        Self {
            shapes,
            apart: apart(model),
            paired,
        }
    }

    /// All pairs of shapes that may collide, the lower row first, in order.
    ///
    /// Looks at every two shapes: a tenth of a second for five thousand.
    pub fn pairs(&self) -> impl Iterator<Item = (ShapeId, ShapeId)> {
        let n = self.shapes.len();
        let touches = |s: &Membership| s.paired || (s.collides && s.group != 0);
        (0..n)
            .filter(move |a| touches(&self.shapes[*a]))
            .flat_map(move |a| (a + 1..n).map(move |b| (ShapeId(a), ShapeId(b))))
            .filter(|(a, b)| self.may_collide(*a, *b))
    }

    /// What a shape brings to the decision, for who makes it elsewhere.
    ///
    /// # Panics
    /// If the shape is not of the model that the filter was made for.
    pub fn side(&self, shape: ShapeId) -> FilterSide<'_> {
        let s = &self.shapes[shape.0];
        FilterSide {
            owner: s.owner,
            moves: s.moves,
            collides: s.collides,
            membership: s.membership,
            collides_with: s.collides_with,
            group: s.group,
            world: s.world,
            apart: &self.apart[s.owner],
        }
    }

    /// Whether two shapes of the model may collide; the order does not matter.
    ///
    /// # Panics
    /// If a shape is not of the model that the filter was made for.
    pub fn may_collide(&self, a: ShapeId, b: ShapeId) -> bool {
        let (one, two) = (&self.shapes[a.0], &self.shapes[b.0]);
        if one.owner == two.owner || !(one.moves || two.moves) || !share_world(one, two) {
            return false;
        }
        (one.paired && two.paired && self.paired.contains(&key(a, b)))
            || (one.collides
                && two.collides
                && masks_meet(one, two)
                && groups_collide(one.group, two.group)
                && self.apart[one.owner].binary_search(&two.owner).is_err())
    }
}

/// For each owner, those that a joint or an exclusion keeps it from, in order.
fn apart(model: &Model) -> Vec<Vec<usize>> {
    let ties = model
        .joints
        .iter()
        .filter(|j| j.kind != JointKind::Free && !j.bodies_collide);
    let tied = ties.filter_map(|j| Some((Some(j.parent?), j.child)));
    let mut apart = vec![Vec::new(); model.bodies.len() + 1];
    for (a, b) in tied.chain(model.exclusions.iter().copied()) {
        let (a, b) = (owner(a), owner(Some(b)));
        apart[a].push(b);
        apart[b].push(a);
    }
    for others in &mut apart {
        others.sort_unstable();
        others.dedup();
    }
    apart
}

impl Membership {
    fn of(shape: &Shape, model: &Model) -> Self {
        let body = shape.body.map(|id| &model.bodies[id.0]);
        Self {
            owner: owner(shape.body),
            moves: body.is_some_and(|b| b.kind == BodyKind::Dynamic),
            collides: shape.collides,
            paired: false,
            membership: shape.membership,
            collides_with: shape.collides_with,
            group: body.map_or(STATIC_GROUP, |b| b.group),
            world: body.map_or(SHARED_WORLD, |b| b.world),
        }
    }
}

fn owner(body: Option<BodyId>) -> usize {
    body.map_or(0, |id| id.0 + 1)
}

fn share_world(a: &Membership, b: &Membership) -> bool {
    a.world == b.world || a.world == SHARED_WORLD || b.world == SHARED_WORLD
}

fn masks_meet(a: &Membership, b: &Membership) -> bool {
    ((a.membership & b.collides_with) | (b.membership & a.collides_with)) != 0
}

fn groups_collide(a: i32, b: i32) -> bool {
    (a > 0 && b != 0) || (b > 0 && a != 0)
}
