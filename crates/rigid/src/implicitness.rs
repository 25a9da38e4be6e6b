//! How far a step looks ahead along springs.
//!
//! Springs, drives and position servos along a coordinate, of stiffness k together, are taken at q + Θ h q̇':
//!
//! ```text
//! M (q̇' − q̇) = −h K (q + Θ h q̇')        q' = q + h q̇'
//! ```
//!
//! Θ = 1 is implicit Euler: stable however stiff, but springs get dampers h k, and amplitudes fall by exp(−½ ω² h t).
//! Θ = 0 is symplectic Euler, which keeps what swings. With q̇ eliminated,
//!
//! ```text
//! (M − h² K (¼ − ½ Θ)) δ² + ½ h² K Θ (q⁺ − q⁻) + ¼ h² K (q⁺ + 2 q + q⁻) = 0        δ² = q⁺ − 2 q + q⁻
//! ```
//!
//! which is a mass, a damper and a spring by the trapezoidal rule: stable where that mass is positive. K = Σ kⱼ eⱼ eⱼᵀ, so it
//! is where Σ kⱼ h² (¼ − ½ Θⱼ) q̇ⱼ² < q̇ᵀ M q̇, for all q̇. Let mⱼ be the least inertia along coordinate j of the two
//! bodies of its joint, if no others hung on them. Then mⱼ q̇ⱼ² is at most the sum of what both have in q̇ᵀ M q̇, and it is
//! enough that for each body, over the coordinates of all its joints,
//!
//! ```text
//! Σ sⱼ (¼ − ½ Θⱼ) ≤ ¼        sⱼ = h² kⱼ / mⱼ
//! ```
//!
//! With Θⱼ = max(0, 1 − s/sⱼ) a coordinate takes ¼ sⱼ up to the level s; stiffer ones take ¼ (2 s − sⱼ), and nothing where that
//! is negative. All this rises with s. The level of a body is the highest up to 1 at which its coordinates take ¼ together; of
//! two bodies' levels the lower counts. A spring that steps resolve, ω h < 1, keeps what swings on it, and a stiff one comes to
//! rest, as with levels above 1 it would not. Three quarters of M are left for what is not linear.

use crate::featherstone::forest::{Forest, Node, steiner, turned};
use crate::featherstone::tables::{is_rigid, motion};
use glam::{DMat3, DQuat, DVec3};
use model::{
    Axis, AxisKind, Body, BodyId, BodyKind, Joint, JointId, JointKind, MassProperties, Model, Pose,
};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// At how many turns the least inertia is looked for.
const TURNS: usize = 16;
/// How often what holds it is cut by the golden section: to 10⁻⁴ rad.
const CUTS: usize = 20;
/// What is left of an inertia by rounding, as a share.
const ROUNDING: f64 = 1e-12;

/// Θ of each degree of freedom in steps of `h` [s] of solvers in which joints do not give way; 1 in models whose joints do.
pub(crate) fn implicitness(model: &Model, forest: &Forest, h: f64) -> Vec<f64> {
    let mut springs = Springs::new(model, h);
    if !is_rigid(model) {
        return vec![1.0; springs.stiffness.len()];
    }
    for (n, node) in forest.nodes.iter().enumerate() {
        let dofs = node.dof..node.dof + node.dofs();
        if springs.any(dofs.clone()) {
            let least = least_inertia(node, node.parent.map(|p| &forest.nodes[p]));
            springs.join(dofs, &least, [Some(n), node.parent]);
        }
    }
    springs.implicitness()
}

/// How springs of joints act that are pushed one by one, once in a step.
pub(crate) struct OneByOne {
    /// Θ of each degree of freedom.
    pub implicitness: Vec<f64>,
    /// The largest stiffness of each [N/m or N·m/rad].
    pub stiffest: Vec<f64>,
}

/// The same for joints that are pushed one by one, once in a step, and do not hold their bodies while others are: so mⱼ is that
/// of the two bodies by themselves, whatever is fixed to them. What a spring does gets no farther than to the next joint, and so
/// joints that share bodies, which fall into n parts, have none that a step does not resolve: a stiffer one is taken for
///
/// ```text
/// h² k = mⱼ/n + armature
/// ```
///
/// Trees at random are stable with twice as much; of those with springs without bounds a third is not. `shared` tells n of a
/// joint, none where its bodies have no other.
pub(crate) fn one_by_one(
    model: &Model,
    h: f64,
    shared: impl Fn(JointId) -> Option<f64>,
) -> OneByOne {
    let moves = |id: &BodyId| model.bodies[id.0].kind == BodyKind::Dynamic;
    let mut springs = Springs::new(model, h);
    let mut stiffest = vec![f64::INFINITY; springs.stiffness.len()];
    let mut forest = Forest::empty(model);
    for (i, joint) in model.joints.iter().enumerate() {
        let (id, dofs) = (JointId(i), model.dof_range(JointId(i)));
        if joint.closes_loop || !joint.enabled || !springs.any(dofs.clone()) {
            continue;
        }
        let ends = [joint.parent, Some(joint.child)].map(|end| end.filter(moves));
        forest.take_joint(model, id);
        for node in &forest.nodes {
            let own = node.dof..node.dof + node.dofs();
            let least = least_inertia(node, node.parent.map(|p| &forest.nodes[p]));
            springs.join(own, &least, ends.map(|end| end.map(|id| id.0)));
        }
        if let Some(n) = shared(id) {
            for (v, free) in dofs.zip(free_inertia(model, joint)) {
                let known = Some(springs.inertia[v]).filter(|m| *m > 0.0);
                let inertia = known.unwrap_or(free) / n + springs.armature[v];
                stiffest[v] = inertia / (h * h);
            }
        }
    }
    OneByOne {
        implicitness: springs.implicitness(),
        stiffest,
    }
}

/// The springs of a model, and what they share.
struct Springs {
    h: f64,
    /// k, and what motors reflect, of each degree of freedom.
    stiffness: Vec<f64>,
    armature: Vec<f64>,
    /// m of each degree of freedom, without armature; 0 where it is not known.
    inertia: Vec<f64>,
    /// s of each.
    ratio: Vec<f64>,
    /// The bodies of each.
    bodies: Vec<[Option<usize>; 2]>,
    /// s of all that a body has.
    shares: HashMap<usize, Vec<f64>>,
}

/// mⱼ of a node's degrees of freedom [kg or kg·m²], without armature; zero where nothing is known.
enum Least {
    OfEach(Vec<f64>),
    /// About any axis: k |ω|² of a ball is one spring.
    OfBall(f64),
}

impl Springs {
    fn new(model: &Model, h: f64) -> Self {
        let dofs = || {
            model
                .joints
                .iter()
                .filter(|j| !j.closes_loop)
                .flat_map(|j| &j.dofs)
        };
        let mut stiffness: Vec<_> = dofs().map(|d| d.stiffness + d.drive.stiffness).collect();
        for a in &model.actuators {
            let pulls = (-a.bias[1]).max(0.0);
            stiffness[model.dof_range(a.joint).start + a.dof] += a.gear * a.gear * pulls;
        }
        let count = stiffness.len();
        Self {
            h,
            stiffness,
            armature: dofs().map(|d| d.armature).collect(),
            inertia: vec![0.0; count],
            ratio: vec![0.0; count],
            bodies: vec![[None; 2]; count],
            shares: HashMap::new(),
        }
    }

    fn any(&self, mut dofs: Range<usize>) -> bool {
        dofs.any(|v| self.stiffness[v] > 0.0)
    }

    /// Tells the bodies of a node's joint, and the least inertia along its degrees of freedom.
    fn join(&mut self, dofs: Range<usize>, least: &Least, bodies: [Option<usize>; 2]) {
        match least {
            Least::OfEach(all) => {
                for (v, m) in dofs.zip(all) {
                    self.share(v..v + 1, *m, bodies);
                }
            }
            Least::OfBall(m) => self.share(dofs, *m, bodies),
        }
    }

    /// Degrees of freedom that are one spring, as stiff as the stiffest of them.
    fn share(&mut self, dofs: Range<usize>, least: f64, bodies: [Option<usize>; 2]) {
        let ratio = |v| self.stiffness[v] / (least + self.armature[v]);
        let ratios = dofs.clone().filter(|v| self.stiffness[*v] > 0.0).map(ratio);
        let ratio = self.h * self.h * ratios.fold(0.0, f64::max);
        for v in dofs {
            self.inertia[v] = least;
            self.ratio[v] = ratio;
            self.bodies[v] = bodies;
        }
        for body in bodies.into_iter().flatten() {
            self.shares.entry(body).or_default().push(ratio);
        }
    }

    fn implicitness(self) -> Vec<f64> {
        let shares = self.shares.into_iter();
        let levels: HashMap<_, _> = shares.map(|(b, s)| (b, level(&s))).collect();
        let all = self.ratio.iter().zip(&self.bodies);
        all.map(|(ratio, bodies)| {
            let levels = bodies.iter().flatten().map(|body| levels[body]);
            let level = levels.fold(f64::MAX, f64::min);
            (1.0 - level / ratio).max(0.0)
        })
        .collect()
    }
}

/// The highest s up to 1 at which those of a body take a quarter together. What has no inertia, sⱼ = ∞, takes nothing: its Θ is
/// 1.
fn level(ratios: &[f64]) -> f64 {
    let taken = |s: f64| -> f64 {
        let of = |r: &f64| if *r <= s { *r } else { (2.0 * s - r).max(0.0) };
        ratios.iter().map(of).sum()
    };
    // It rises in straight lines from corner to corner.
    let corners = ratios.iter().flat_map(|r| [0.5 * r, *r]);
    let mut corners: Vec<_> = corners.filter(|s| *s < 1.0).collect();
    corners.sort_by(f64::total_cmp);
    corners.push(1.0);
    let over = corners.partition_point(|s| taken(*s) <= 1.0);
    let Some(end) = corners.get(over) else {
        return 1.0;
    };
    let begin = if over > 0 { corners[over - 1] } else { 0.0 };
    let [low, high] = [begin, *end].map(taken);
    begin + (end - begin) * (1.0 - low) / (high - low)
}

fn least_inertia(node: &Node, parent: Option<&Node>) -> Least {
    match node.motions[..] {
        [m] if m.kind == motion::REVOLUTE => Least::OfEach(vec![about(node, parent, m.axis)]),
        [m] if m.kind == motion::PRISMATIC => Least::OfEach(vec![along(node, parent, m.axis)]),
        [m] if m.kind == motion::BALL => Least::OfBall(1.0 / looseness(node, parent)),
        _ => Least::OfEach(in_turn(node, parent)),
    }
}

/// mⱼ of a hinge, in the worst of its turns.
fn about(node: &Node, parent: Option<&Node>, axis: DVec3) -> f64 {
    let speed = axis.cross(node.center);
    let at = |turn: f64| {
        let turn = DQuat::from_axis_angle(axis, turn);
        inertia(node, parent, Pose::new(DVec3::ZERO, turn), axis, speed)
    };
    match parent {
        None => at(0.0),
        Some(_) => least_of_turns(at, TAU),
    }
}

/// The least of what comes again after a `period` [rad]. It dips where slender bodies come to turn about their own axes, so the
/// lowest of some turns are looked around.
fn least_of_turns(at: impl Fn(f64) -> f64, period: f64) -> f64 {
    let step = period / TURNS as f64;
    let around: [f64; TURNS] = std::array::from_fn(|i| at(step * i as f64));
    // The first of those that are alike, and none where all are.
    let lowest = |i: &usize| {
        let (before, after) = (around[(i + TURNS - 1) % TURNS], around[(i + 1) % TURNS]);
        around[*i] < before && around[*i] <= after
    };
    let dips = (0..TURNS).filter(lowest);
    let dips = dips.map(|i| dip(&at, step * i as f64, step));
    around.into_iter().chain(dips).fold(f64::INFINITY, f64::min)
}

/// The least that is found within `reach` of a place, by golden sections.
fn dip(at: impl Fn(f64) -> f64, middle: f64, reach: f64) -> f64 {
    let share = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut low, mut high) = (middle - reach, middle + reach);
    let inner = |low: f64, high: f64| {
        let way = share * (high - low);
        [high - way, low + way]
    };
    let mut places = inner(low, high);
    let mut found = places.map(&at);
    for _ in 0..CUTS {
        if found[0] < found[1] {
            high = places[1];
            places = inner(low, high);
            found = [at(places[0]), found[0]];
        } else {
            low = places[0];
            places = inner(low, high);
            found = [found[1], at(places[1])];
        }
    }
    found[0].min(found[1])
}

/// mⱼ of a slide, in the worst of its places: where both centres of mass are level, or where slender bodies turn about the
/// line between them. With that line by s along the axis a and by r along e beside it, and J as [below](inertia) but for
/// the row and column across a and e, about which the bodies turn as the slide pushes,
///
/// ```text
/// det J = μ a·C a ((s − s₀)² + w²)        C = I + I'
/// ```
///
/// and what is divided by that is a sinusoid of 2 φ where s = s₀ + w tan φ: sixteen places find how it dips, however narrow.
fn along(node: &Node, parent: Option<&Node>, axis: DVec3) -> f64 {
    let at = |moved: f64| inertia(node, parent, Pose::at(axis * moved), DVec3::ZERO, axis);
    let Some(parent) = parent else {
        return at(0.0);
    };
    let seen = node.place.inverse();
    let way = node.center - seen.point(parent.center);
    let (level, beside) = (-axis.dot(way), way.reject_from_normalized(axis));
    let both = node.inertia + turned(parent.inertia, seen.orientation);
    let (own, aside) = (axis.dot(both * axis), beside.normalize_or_zero());
    let (mixed, others) = (axis.dot(both * aside), aside.dot(both * aside));
    let middle = level - beside.length() * mixed / own;
    let share = 1.0 / node.mass + 1.0 / parent.mass + beside.length_squared() / own;
    let width = ((others - mixed * mixed / own) * share).max(0.0).sqrt();
    // None of the turns that are looked at is a right angle, where the bodies are infinitely far apart.
    let first = PI / (2 * TURNS) as f64;
    let around = |turn: f64| at(middle + width * (first + turn).tan());
    least_of_turns(around, PI).min(at(level))
}

/// The least twice the kinetic energy of a node with its parent, which moves as it likes, where the node turns by `spin` and
/// its centre goes by `speed` as seen from the parent, and has moved by `moved`:
///
/// ```text
/// ω·I ω + μ v² − L·J⁻¹ L      L = I ω + μ d × v,   J = I + I' + μ (d² 1 − d dᵀ)
/// ```
///
/// with the reduced mass μ, and d from the parent's centre to the node's.
fn inertia(node: &Node, parent: Option<&Node>, moved: Pose, spin: DVec3, speed: DVec3) -> f64 {
    let own = node.inertia * spin;
    let Some(parent) = parent else {
        return spin.dot(own) + node.mass * speed.length_squared();
    };
    let seen = (node.place * moved).inverse();
    let others = turned(parent.inertia, seen.orientation);
    let reduced = node.mass * parent.mass / (node.mass + parent.mass);
    let way = node.center - seen.point(parent.center);
    let momentum = own + reduced * way.cross(speed);
    let both = node.inertia + others + steiner(reduced, way);
    let held = spin.dot(own) + reduced * speed.length_squared();
    let left = held - momentum.dot(both.inverse() * momentum);
    // Also where a body without mass is between, and nothing can be divided by its own.
    if left > ROUNDING * held { left } else { 0.0 }
}

/// A bound of the same for several axes in turn: two turns keep their angle, and shifts that no turn of the joint's comes
/// before keep theirs; a ball may come last. With Gram's matrix G of their directions, q̇ⱼ² ≤ (G⁻¹)ⱼⱼ |Σ aᵢ q̇ᵢ|².
fn in_turn(node: &Node, parent: Option<&Node>) -> Vec<f64> {
    let of = |kind| {
        let all = node.motions.iter().filter(move |m| m.kind == kind);
        all.map(|m| m.axis).collect::<Vec<_>>()
    };
    let (turns, shifts) = (of(motion::REVOLUTE), of(motion::PRISMATIC));
    let shifts_first = node.motions[..shifts.len()]
        .iter()
        .all(|m| m.kind == motion::PRISMATIC);
    let balls = of(motion::BALL).len();
    let bare = turns.len() + shifts.len() + balls == node.motions.len();
    let bare = bare && balls * turns.len() == 0;
    if !bare || !shifts_first || (parent.is_some() && !shifts.is_empty()) {
        return vec![0.0; node.dofs()];
    }
    let loose = looseness(node, parent);
    let arm = match turns.len() + balls {
        0 => 0.0,
        _ => node.center.length_squared() * loose,
    };
    let shift = spread(&shifts).map(|g| 1.0 / (g * (1.0 / node.mass + arm)));
    let turn = match turns.len() {
        0 => [1.0 / loose; 3],
        3 => [0.0; 3],
        _ => spread(&turns).map(|g| 1.0 / (g * loose)),
    };
    let shift = shift.into_iter().take(shifts.len());
    let turn = turn.into_iter().take(turns.len() + 3 * balls);
    shift.chain(turn).collect()
}

/// Diagonal of the inverse of Gram's matrix of up to three directions.
fn spread(axes: &[DVec3]) -> [f64; 3] {
    let gram = |i: usize, j: usize| match (axes.get(i), axes.get(j)) {
        (Some(a), Some(b)) => a.dot(*b),
        _ => f64::from(u8::from(i == j)),
    };
    let column = |j| DVec3::new(gram(0, j), gram(1, j), gram(2, j));
    let inverse = DMat3::from_cols(column(0), column(1), column(2)).inverse();
    inverse.diagonal().to_array()
}

/// At least |ω|² of two bodies' turns against each other, for twice their kinetic energy of one.
fn looseness(node: &Node, parent: Option<&Node>) -> f64 {
    match parent {
        Some(parent) => looseness_of(node.inertia) + looseness_of(parent.inertia),
        None if node.motions.iter().any(|m| m.kind == motion::PRISMATIC) => {
            looseness_of(node.inertia)
        }
        None => looseness_of(node.inertia + steiner(node.mass, node.center)),
    }
}

/// The same of one body: the largest of 1/I.
fn looseness_of(inertia: DMat3) -> f64 {
    let body = MassProperties {
        mass: 1.0,
        center: DVec3::ZERO,
        inertia,
    };
    1.0 / body.principal().0.min_element().max(0.0)
}

/// The least inertia of a joint's degrees of freedom, one by one, where the joint does not hold its bodies, either, wherever
/// these are. A turn is taken for one about a unit axis, though gradients of three that nearly lie in a plane are longer.
fn free_inertia(model: &Model, joint: &Joint) -> Vec<f64> {
    let each = |axis: fn(DVec3) -> Axis| [DVec3::X, DVec3::Y, DVec3::Z].map(axis);
    let axes = match joint.kind {
        JointKind::Ball => each(Axis::angular).to_vec(),
        JointKind::Free => [each(Axis::linear), each(Axis::angular)].concat(),
        _ => joint.axes.clone(),
    };
    let angular = |axis: &&Axis| axis.kind == AxisKind::Angular;
    let anchor = axes.iter().find(angular).map_or(DVec3::ZERO, |a| a.anchor);
    let dynamic = |id: BodyId| Some(&model.bodies[id.0]).filter(|b| b.kind == BodyKind::Dynamic);
    let (parent, child) = (joint.parent.and_then(dynamic), dynamic(joint.child));
    let corners = travelled(joint, anchor);
    let corners = corners.into_iter().map(|p| joint.parent_frame.point(p));
    let corners: Vec<_> = corners.collect();
    let arm = joint.child_frame.point(anchor);
    let response = |axis: &Axis| {
        let ends = parent.into_iter().chain(child);
        if axis.kind == AxisKind::Angular {
            return ends.map(|body| looseness_of(body.inertia)).sum();
        }
        // It is fixed in the parent, and any way in the child.
        let way = joint.parent_frame.orientation * axis.direction;
        let of_parent = parent.map_or(0.0, |body| {
            let arms = corners.iter().map(|p| (*p - body.center).cross(way));
            pushed(body, arms.map(DVec3::length).fold(0.0, f64::max))
        });
        of_parent + child.map_or(0.0, |body| pushed(body, arm.distance(body.center)))
    };
    axes.iter().map(|axis| 1.0 / response(axis)).collect()
}

/// Change of a point's speed along a push by a unit of it, the line of the push at most an `arm` [m] from the body's centre.
fn pushed(body: &Body, arm: f64) -> f64 {
    1.0 / body.mass + arm * arm * looseness_of(body.inertia)
}

/// Where a point of the child's joint frame gets in the parent's, by the slides before all turns: the corners of their ranges.
/// One without ends counts as where both frames meet, as nothing is known of where it gets.
fn travelled(joint: &Joint, point: DVec3) -> Vec<DVec3> {
    let mut places = vec![point];
    let slides = joint.axes.iter().zip(&joint.dofs);
    for (axis, dof) in slides.filter(|(axis, _)| axis.kind == AxisKind::Linear) {
        let ends = dof.limit.map(|l| [l.lower, l.upper]);
        let ends = ends.unwrap_or([axis.reference; 2]);
        let ends = ends.map(|end| end - axis.reference);
        let moved = |p: DVec3| ends.map(|way| p + way * axis.direction);
        places = places.into_iter().flat_map(moved).collect();
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::{Builder, JointDraft, Limit, Object};

    const STIFF: f64 = 1e6;

    fn body(object: &mut Object, name: &str, mass: f64, center: DVec3) -> model::BodyHandle {
        let moments = DMat3::from_diagonal(DVec3::new(0.3, 0.4, 0.5) * mass);
        object.body(name).inertia(mass, center, moments).handle()
    }

    /// The inertia along the only spring of bodies of 2 and 3 kg: with h = 1 s that is k/s, and s = 1/(1 − Θ).
    fn inertia_of_one(join: impl Fn(&mut Object, [model::BodyHandle; 2])) -> f64 {
        let mut world = Builder::new("spring");
        let object = world.object("");
        let first = body(object, "first", 2.0, DVec3::new(0.1, 0.2, 0.0));
        let second = body(object, "second", 3.0, DVec3::new(-0.3, 0.1, 0.4));
        join(object, [first, second]);
        let model = world.build().unwrap();
        let all = implicitness(&model, &Forest::new(&model), 1.0);
        let alone = one_by_one(&model, 1.0, |_| None);
        assert_eq!(alone.implicitness, all);
        assert!(alone.stiffest.iter().all(|k| *k == f64::INFINITY));
        let least = all.into_iter().filter(|x| *x > 0.0).fold(1.0, f64::min);
        STIFF * (1.0 - least)
    }

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }

    fn spring(joint: &mut JointDraft) -> &mut JointDraft {
        joint.spring(STIFF, 0.0)
    }

    /// I + m r², and the armature.
    #[test]
    fn a_pendulum_has_its_inertia_about_the_hinge() {
        let found = inertia_of_one(|object, [_, second]| {
            spring(object.revolute("hinge", second, DVec3::Z)).armature(0.25);
        });
        close(found, 1.5 + 3.0 * 0.1 + 0.25);
    }

    /// I₁ I₂/(I₁ + I₂) of wheels on one shaft.
    #[test]
    fn wheels_on_a_shaft_have_their_reduced_inertia() {
        let found = inertia_of_one(|object, [first, second]| {
            let frames = [DVec3::new(0.1, 0.2, 0.0), DVec3::new(-0.3, 0.1, 0.4)].map(Pose::at);
            let joint = object.revolute("shaft", second, DVec3::Z);
            spring(joint).parent(first).frames(frames[0], frames[1]);
        });
        close(found, 1.0 * 1.5 / (1.0 + 1.5));
    }

    /// μ I/(I + μ r²) of bodies on a slide that passes by their centres at r, both turning together with I = I₁ + I₂.
    #[test]
    fn bodies_on_a_slide_turn_where_it_pushes_beside_their_centres() {
        let (reduced, across) = (6.0 / 5.0, DVec3::new(0.0, -0.1, 0.4));
        let moments = DVec3::new(0.3, 0.4, 0.5) * 5.0;
        // About y and z, which r x̂ × p is along: r × x̂ = (0, 0.4, 0.1).
        let push = across.cross(DVec3::X);
        let together = DMat3::from_diagonal(moments) + steiner(reduced, across);
        let turned = push.dot(together.inverse() * push);
        let found = inertia_of_one(|object, [first, second]| {
            let joint = object.prismatic("slide", second, DVec3::X);
            spring(joint).parent(first);
        });
        close(found, reduced - reduced * reduced * turned);
    }

    /// Two hinges at right angles share ω as x and y do; three may lock.
    #[test]
    fn axes_in_turn_have_what_is_left_of_them_together() {
        let stack = |count: usize| {
            inertia_of_one(|object, [_, second]| {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(Axis::angular);
                spring(object.d6("stack", second, &axes[..count]));
            })
        };
        let about = DMat3::from_diagonal(DVec3::new(0.9, 1.2, 1.5));
        let pinned = about + steiner(3.0, DVec3::new(-0.3, 0.1, 0.4));
        close(stack(2), 1.0 / looseness_of(pinned));
        assert_eq!(stack(3), 0.0);
    }

    /// Two pendulums, the second fixed to a plate: only its own mass is near enough, in two parts; so are all three turns, each
    /// with the least moment, which it may come to be about.
    #[test]
    fn joints_that_share_a_body_are_as_stiff_as_it_bears() {
        let mut world = Builder::new("spring");
        let object = world.object("");
        let first = body(object, "first", 2.0, DVec3::ZERO);
        let second = body(object, "second", 3.0, DVec3::new(-0.3, 0.1, 0.4));
        let plate = body(object, "plate", 50.0, DVec3::ZERO);
        let turns = [DVec3::X, DVec3::Y, DVec3::Z].map(Axis::angular);
        spring(object.d6("stack", first, &turns));
        spring(object.revolute("hinge", second, DVec3::Z)).armature(0.25);
        object.fixed("bolt", plate).parent(second);
        let model = world.build().unwrap();
        let found = one_by_one(&model, 0.1, |_| Some(2.0)).stiffest;
        for (found, inertia) in found.into_iter().zip([0.3, 0.3, 0.3, 0.9 + 0.25]) {
            close(found, inertia / 0.01);
        }
    }

    /// A slide along x with a hinge 0.2 m above: it pushes the child at up to the centre's distance from the hinge, wherever that
    /// has turned to, and the parent beside its centre, however far it is along x. A second slide along y, from −1 to 2 m, brings
    /// it 1.9 m beside.
    #[test]
    fn slides_that_turn_are_as_stiff_as_the_longest_arms_bear() {
        let stiffest = |sideways: bool| {
            let mut world = Builder::new("spring");
            let object = world.object("");
            let first = body(object, "first", 2.0, DVec3::new(0.7, 0.1, 0.0));
            let second = body(object, "second", 3.0, DVec3::new(-0.3, 0.1, 0.4));
            let hinge = Axis {
                anchor: DVec3::Z * 0.2,
                ..Axis::angular(DVec3::Z)
            };
            let slides = [DVec3::X, DVec3::Y].map(Axis::linear);
            let slides = &slides[..1 + usize::from(sideways)];
            let joint = object.d6("both", second, &[slides, &[hinge]].concat());
            spring(joint).parent(first).limit(Limit {
                lower: -1.0,
                upper: 2.0,
                stiffness: 1.0,
                damping: 0.0,
                inertia: 0.0,
            });
            let model = world.build().unwrap();
            one_by_one(&model, 1.0, |_| Some(1.0)).stiffest[0]
        };
        let carried = 1.0 / 3.0 + DVec3::new(0.3, -0.1, -0.2).length_squared() / 0.9;
        for (sideways, y) in [(false, 0.1), (true, 1.9)] {
            let carries = 0.5 + DVec3::new(0.0, y, 0.2).length_squared() / 0.6;
            close(stiffest(sideways), 1.0 / (carries + carried));
        }
    }

    /// The least of a body's moments about its ball.
    #[test]
    fn a_ball_is_one_spring() {
        let pinned = DMat3::from_diagonal(DVec3::new(0.9, 1.2, 1.5))
            + steiner(3.0, DVec3::new(-0.3, 0.1, 0.4));
        let least = MassProperties {
            mass: 3.0,
            center: DVec3::ZERO,
            inertia: pinned,
        };
        let least = least.principal().0.min_element();
        let found = inertia_of_one(|object, [_, second]| {
            spring(object.ball("ball", second));
        });
        close(found, least);
    }

    /// A push at a frame off the centre moves that by 1/m and turns by r²/I; the axes of a free joint have no other.
    #[test]
    fn what_flies_has_its_mass_and_its_least_moment() {
        let mut world = Builder::new("spring");
        let object = world.object("");
        let center = DVec3::new(-0.3, 0.1, 0.4);
        let flies = body(object, "body", 3.0, center);
        object.free("float", flies);
        let model = world.build().unwrap();
        let node = &Forest::new(&model).nodes[0];
        let Least::OfEach(all) = least_inertia(node, None) else {
            panic!("a ball alone");
        };
        let straight = 1.0 / (1.0 / 3.0 + center.length_squared() / 0.9);
        for (found, expected) in all.into_iter().zip([[straight; 3], [0.9; 3]].concat()) {
            close(found, expected);
        }
    }

    /// Rods on one hinge, both at θ to it: where all three lie in one plane, each turns about itself with ω/(2 cos θ) against
    /// the other, for which it has I = m r²/2, and so both have I/(2 cos² θ) together. Elsewhere they have some m l²/12.
    #[test]
    fn slender_rods_are_met_where_they_turn_about_themselves() {
        let (m, l, r, tilt) = (1.0, 1.0, 0.01, 1.26_f64);
        let (thin, long) = (0.5 * m * r * r, m * l * l / 12.0);
        let rod = |turn: f64| {
            let turn = DQuat::from_rotation_z(turn) * DQuat::from_rotation_x(tilt);
            let turn = DMat3::from_quat(turn);
            turn * DMat3::from_diagonal(DVec3::new(long, long, thin)) * turn.transpose()
        };
        let mut world = Builder::new("rods");
        let object = world.object("");
        // Midway between two of the turns that are looked at.
        let [first, second] =
            [("first", 0.0), ("second", 0.5 * TAU / TURNS as f64)].map(|(name, turn)| {
                object
                    .body(name)
                    .inertia(m, DVec3::ZERO, rod(turn))
                    .handle()
            });
        object.free("float", first);
        object.revolute("hinge", second, DVec3::Z).parent(first);
        let model = world.build().unwrap();
        let forest = Forest::new(&model);
        let node = forest.nodes.iter().find(|node| node.parent.is_some());
        let node = node.unwrap();
        let parent = node.parent.map(|p| &forest.nodes[p]);
        let found = about(node, parent, DVec3::Z);
        let expected = thin / (2.0 * tilt.cos() * tilt.cos());
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }

    /// Two rods side by side on a slide along x, in many attitudes: no place has less than what is found, though some have
    /// less than where they are level.
    #[test]
    fn slender_rods_are_met_where_they_turn_about_the_line_between_them() {
        let (thin, long) = (5e-5, 1.0 / 12.0);
        let cases: i32 = 300;
        let mut lowest = 1.0_f64;
        for case in 0..cases {
            let height = f64::from(2 * case + 1) / f64::from(cases) - 1.0;
            let (sin, cos) = (2.4 * f64::from(case)).sin_cos();
            let rod =
                DVec3::new(cos, sin, 0.0) * (1.0 - height * height).sqrt() + DVec3::Z * height;
            let inertia = steiner(long - thin, rod) + DMat3::IDENTITY * thin;
            let mut world = Builder::new("rods");
            let object = world.object("");
            let [first, second] = ["first", "second"].map(|name| {
                object
                    .body(name)
                    .inertia(1.0, DVec3::ZERO, inertia)
                    .handle()
            });
            object.free("float", first);
            let joint = object.prismatic("slide", second, DVec3::X);
            joint
                .parent(first)
                .frames(Pose::at(DVec3::Y * 0.6), Pose::IDENTITY);
            let model = world.build().unwrap();
            let forest = Forest::new(&model);
            let [parent, node] = &forest.nodes[..] else {
                panic!("two nodes");
            };
            let at = |way: f64| {
                super::inertia(
                    node,
                    Some(parent),
                    Pose::at(DVec3::X * way),
                    DVec3::ZERO,
                    DVec3::X,
                )
            };
            let found = along(node, Some(parent), DVec3::X);
            let least = (-4000..=4000).map(|i| at(1e-3 * f64::from(i)));
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(found < least * (1.0 + 1e-5), "{case}: {found} {least}");
            lowest = lowest.min(found / at(0.0));
        }
        assert!(lowest < 0.5, "{lowest}");
    }

    #[test]
    fn stiff_springs_leave_to_others_what_is_theirs() {
        assert_eq!(level(&[0.2, 0.3]), 1.0);
        assert_eq!(level(&[5.0]), 1.0);
        assert_eq!(level(&[5.0, 0.25, f64::INFINITY, 9.0]), 1.0);
        assert_eq!(level(&[1.0, 1.0]), 0.75);
        assert_eq!(level(&[0.5, 1.25, 0.75]), 0.625);
    }
}
