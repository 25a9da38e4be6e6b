//! Which geoms may touch: `<contact>`, and what hangs on what (modeling guide, "Collision detection").
//!
//! MuJoCo takes bodies that never move against each other as one, as it does the world and all that
//! is welded to it. Geoms do not touch where these are one, or one carries the other; unless the
//! other is the world.

use super::Context;
use super::surface::Surface;
use super::tree::Tree;
use crate::error::FormatError;
use crate::joint_space::JointSpace;
use crate::report::Report;
use crate::xml::Element;
use model::{
    BodyId, CollisionFilter, ContactPair, JointKind, Material, Model, ModelError, ShapeId, Softness,
};
use std::collections::HashSet;

const EXCLUDE: &[&str] = &["name", "class", "body1", "body2"];
pub(super) const PAIR: &[&str] = &[
    "name", "class", "geom1", "geom2", "condim", "friction", "solref", "solimp", "margin", "gap",
];
pub(super) const PAIR_UNUSED: &[(&str, &str)] =
    &[("solreffriction", "dry friction is not softened")];

/// Reads `<contact>`, and keeps apart what is welded or hinged together. Masses are those of the finished bodies.
pub(super) fn read(
    root: &Element,
    tree: &mut Tree,
    space: &JointSpace,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    weigh(tree, space, context);
    let rules = root.children_named("contact").flat_map(|s| &s.children);
    for rule in rules {
        match rule.name.as_str() {
            "exclude" => exclude(rule, tree, report)?,
            "pair" => {
                let rule = context.defaults.apply(rule, None, &["pair"])?;
                pair(&rule, tree, context, report)?;
            }
            _ => return Err(rule.invalid("contact holds no such element", "remove it")),
        }
    }
    let welds = Welds::of(tree);
    welds.let_joints_collide(tree, context);
    welds.exclude(tree, context);
    Ok(())
}

/// The names of the geoms that pairs are of, which touch whatever their masks are.
pub(super) fn paired(root: &Element) -> impl Iterator<Item = &str> {
    let rules = root.children_named("contact").flat_map(|s| &s.children);
    let pairs = rules.filter(|rule| rule.name == "pair");
    pairs.flat_map(|pair| {
        ["geom1", "geom2"]
            .into_iter()
            .filter_map(move |end| pair.get(end))
    })
}

/// Tells surfaces how easily the bodies give way that they are of, and shapes what they are made of, then.
fn weigh(tree: &mut Tree, space: &JointSpace, context: &Context<'_>) {
    let bodies = tree.parts.bodies.iter().enumerate();
    let mobilities: Vec<f64> = bodies
        .map(|(i, body)| space.translation(BodyId(i), body.pose.point(body.center)))
        .collect();
    for (shape, surface) in tree.parts.shapes.iter_mut().zip(&mut tree.surfaces) {
        surface.mobility = shape.body.map_or(0.0, |body| mobilities[body.0]);
        shape.material = surface.of_shape(&context.physics);
    }
}

fn exclude(element: &Element, tree: &mut Tree, report: &mut Report) -> Result<(), FormatError> {
    report.check_attributes(element, EXCLUDE, &[])?;
    let ends = [tree.body(element, "body1")?, tree.body(element, "body2")?];
    match ends {
        [a, b] if a == b => report.note(
            element,
            "exclusion of a body from itself",
            "its geoms never touch",
        ),
        [other, Some(body)] | [Some(body), other] => tree.parts.exclusions.push((other, body)),
        [None, None] => {}
    }
    Ok(())
}

fn pair(
    element: &Element,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    report.check_attributes(element, PAIR, PAIR_UNUSED)?;
    let shapes = (tree.geom(element, "geom1")?, tree.geom(element, "geom2")?);
    let mut surface = Surface::of_pair(element, &context.physics, report)?;
    let mobility = |shape: ShapeId| tree.surfaces[shape.0].mobility;
    surface.mobility = mobility(shapes.0) + mobility(shapes.1);
    let material = surface.material(&context.physics);
    let mut pairs = tree.parts.contact_pairs.iter();
    let same = |(a, b)| (a, b) == shapes || (b, a) == shapes;
    if let Some(earlier) = pairs.find(|pair| same(pair.shapes)) {
        if earlier.material != material {
            let remedy = "keep one of them";
            return Err(element.invalid("an earlier pair of the same geoms says otherwise", remedy));
        }
        let meaning =
            "it counts once; MuJoCo makes each of its contacts twice, which is a little stiffer";
        report.note(element, "a pair that repeats an earlier one", meaning);
        return Ok(());
    }
    let [a, b] = [shapes.0, shapes.1].map(|s| tree.parts.shapes[s.0].body);
    if a == b || !(tree.moves(a) || tree.moves(b)) {
        let meaning = "left out, for its geoms never move against each other";
        report.note(element, "pair", meaning);
    } else if context.physics.on("contact") {
        tree.parts
            .contact_pairs
            .push(ContactPair::new(shapes, material));
    }
    Ok(())
}

/// What each body is welded to.
struct Welds {
    /// The topmost body that a body never moves against; `None` is the world.
    top: Vec<Option<BodyId>>,
    /// What that one hangs on, as far up as nothing moves.
    above: Vec<Option<BodyId>>,
}

impl Welds {
    fn of(tree: &Tree) -> Self {
        let joints = tree.parts.joints.iter();
        let moving = joints.filter(|j| j.kind != JointKind::Fixed);
        let jointed: HashSet<BodyId> = moving.map(|j| j.child).collect();
        let (mut top, mut above) = (Vec::new(), Vec::new());
        for (i, parent) in tree.parents.iter().enumerate() {
            let body = BodyId(i);
            let of_parent = |table: &[Option<BodyId>]| parent.and_then(|p| table[p.0]);
            // MuJoCo moves a mocap body by hand, so nothing is welded to the world through it.
            let mocap = tree.elements[i].get("mocap") == Some("true");
            let (own_top, own_above) = match mocap || jointed.contains(&body) {
                true => (Some(body), of_parent(&top)),
                false => (of_parent(&top), of_parent(&above)),
            };
            top.push(own_top);
            above.push(own_above);
        }
        Self { top, above }
    }

    /// Whether geoms of two bodies do not touch for what they hang on.
    fn keep_apart(&self, a: BodyId, b: BodyId, context: &Context<'_>) -> bool {
        let (top_a, top_b) = (self.top[a.0], self.top[b.0]);
        if top_a.is_none() || top_b.is_none() {
            return top_a == top_b;
        }
        let carried = self.above[a.0] == top_b || self.above[b.0] == top_a;
        top_a == top_b || (carried && context.physics.on("filterparent"))
    }

    fn let_joints_collide(&self, tree: &mut Tree, context: &Context<'_>) {
        for joint in &mut tree.parts.joints {
            if let Some(parent) = joint.parent {
                joint.bodies_collide = !self.keep_apart(parent, joint.child, context);
            }
        }
    }

    /// Keeps apart what no joint ties directly.
    fn exclude(&self, tree: &mut Tree, context: &Context<'_>) {
        let joints = tree.parts.joints.iter();
        let tied: HashSet<_> = joints.filter_map(|j| Some((j.parent?, j.child))).collect();
        let shapes = tree.parts.shapes.iter().filter(|s| s.collides);
        let mut bodies: Vec<BodyId> = shapes.filter_map(|s| s.body).collect();
        bodies.dedup();
        for (i, &a) in bodies.iter().enumerate() {
            for &b in &bodies[i + 1..] {
                let moves = tree.moves(Some(a)) || tree.moves(Some(b));
                let is_tied = tied.contains(&(a, b)) || tied.contains(&(b, a));
                if moves && !is_tied && self.keep_apart(a, b, context) {
                    tree.parts.exclusions.push((Some(a), b));
                }
            }
        }
    }
}

/// Equal but for rounding: softness is mixed before it is converted, or after.
fn alike(a: &Material, b: &Material) -> bool {
    let softness = match (a.softness, b.softness) {
        (
            Softness::Time {
                constant: t,
                ratio: r,
                impedance: d,
                mass: m,
            },
            Softness::Time {
                constant,
                ratio,
                impedance,
                mass,
            },
        ) => {
            let near = |x: f64, y: f64| (x - y).abs() <= 1e-12 * y;
            let masses = m.zip(mass).map_or(m == mass, |(x, y)| near(x, y));
            masses && near(t, constant) && near(r, ratio) && near(d, impedance)
        }
        (a, b) => a == b,
    };
    let others = Material {
        softness: b.softness,
        ..*a
    };
    softness && others == *b
}

/// Gives contacts the surfaces that MuJoCo mixes, where the shapes' materials would mix otherwise.
///
/// # Errors
/// None but those of the model that comes in.
pub(super) fn mix(
    model: Model,
    surfaces: &[Surface],
    context: &Context<'_>,
) -> Result<Model, ModelError> {
    let named: HashSet<_> = model.contact_pairs.iter().map(|pair| pair.shapes).collect();
    let mut pairs = Vec::new();
    for (a, b) in CollisionFilter::new(&model).pairs() {
        let usual = model.contact_material(a, b);
        let surface = surfaces[a.0].with(&surfaces[b.0], &context.physics);
        let material = surface.material(&context.physics);
        if !alike(&material, &usual) && !named.contains(&(a, b)) && !named.contains(&(b, a)) {
            let whose = surfaces[a.0].wins(&surfaces[b.0]);
            let mut pair = ContactPair::new((a, b), material);
            pair.restitution = whose;
            pair.filtered = true;
            if surface.rubs() {
                pair.friction = whose;
            }
            pairs.push(pair);
        }
    }
    if pairs.is_empty() {
        return Ok(model);
    }
    let mut parts = model.into_parts();
    parts.contact_pairs.extend(pairs);
    Model::new(parts)
}
