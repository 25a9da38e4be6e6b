//! Links and joints as a tree, its root first.

use super::geometry::{Looks, origin};
use super::joint::{self, Kind};
use super::link;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use model::{Body, BodyId, BodyKind, Joint, JointId, JointKind, Parts, Pose};
use std::collections::HashMap;

/// A joint element with the names it refers to looked up.
pub(super) struct Connection<'a> {
    pub element: &'a Element,
    pub kind: Kind,
    /// The joint's frame in the parent link.
    pub origin: Pose,
    child: usize,
}

/// The links, and the joints that leave each of them.
pub(super) struct Robot<'a> {
    links: Vec<&'a Element>,
    leaving: Vec<Vec<Connection<'a>>>,
    root: usize,
}

/// What was built, besides the model's tables.
pub(super) struct Tree<'a> {
    /// The element of each body.
    pub elements: Vec<Element>,
    pub joints: Vec<TreeJoint<'a>>,
}

/// A joint of the model and its element.
pub(super) struct TreeJoint<'a> {
    pub element: &'a Element,
    pub id: JointId,
    pub range: Option<(f64, f64)>,
}

impl<'a> Robot<'a> {
    /// Looks up who hangs on whom.
    pub fn read(robot: &'a Element, report: &mut Report) -> Result<Self, FormatError> {
        let links: Vec<&Element> = robot.children_named("link").collect();
        let rows = rows(&links)?;
        if links.is_empty() {
            return Err(robot.invalid("the robot has no link", "add <link name=\"…\">"));
        }
        let joints: Vec<&Element> = robot.children_named("joint").collect();
        self::rows(&joints)?;
        let mut leaving: Vec<Vec<Connection>> = links.iter().map(|_| Vec::new()).collect();
        let mut carrier: Vec<Option<&Element>> = vec![None; links.len()];
        for element in joints {
            let parent = end(element, "parent", &rows)?;
            let child = end(element, "child", &rows)?;
            if let Some(first) = carrier[child].replace(element) {
                return Err(element.invalid(
                    &format!(
                        "its child already hangs on the joint at line {}",
                        first.place.line
                    ),
                    "give each link one parent: URDF describes trees only",
                ));
            }
            let (kind, origin) = (Kind::of(element)?, origin(element, report)?);
            if kind == Kind::Fixed {
                joint::note_fixed_follower(element, report);
            }
            leaving[parent].push(Connection {
                element,
                kind,
                origin,
                child,
            });
        }
        let root = root(robot, &links, &carrier)?;
        Ok(Self {
            links,
            leaving,
            root,
        })
    }
}

/// Rows of elements by their names.
fn rows<'a>(elements: &[&'a Element]) -> Result<HashMap<&'a str, usize>, FormatError> {
    let mut rows = HashMap::new();
    for (row, element) in elements.iter().enumerate() {
        let name = element.require("name")?;
        if rows.insert(name, row).is_some() {
            let problem = format!("is `{name}`, the name of another {}", element.name);
            return Err(element.invalid_attribute("name", &problem, "rename one of them"));
        }
    }
    Ok(rows)
}

/// The link that a joint names as its parent or child.
fn end(joint: &Element, which: &str, rows: &HashMap<&str, usize>) -> Result<usize, FormatError> {
    let Some(element) = joint.child(which) else {
        let remedy = format!("add <{which} link=\"…\"/>");
        return Err(joint.invalid(&format!("it has no <{which}>"), &remedy));
    };
    let name = element.require("link")?;
    rows.get(name).copied().ok_or_else(|| {
        let problem = format!("names `{name}`, but no link has this name");
        element.invalid_attribute("link", &problem, "correct the name")
    })
}

/// The one link that is nobody's child.
fn root(
    robot: &Element,
    links: &[&Element],
    carrier: &[Option<&Element>],
) -> Result<usize, FormatError> {
    let roots: Vec<usize> = (0..links.len()).filter(|i| carrier[*i].is_none()).collect();
    match roots[..] {
        [root] => Ok(root),
        [] => Err(robot.invalid(
            "every link is the child of a joint, so the joints go in a circle",
            "remove the joint that closes the circle",
        )),
        [first, second, ..] => Err(links[second].invalid(
            &format!(
                "it hangs on no joint, and neither does the link `{}`",
                links[first].get("name").unwrap_or_default()
            ),
            "join the two: a robot has one root link",
        )),
    }
}

/// A link that is still to be built.
struct Visit<'r, 'a> {
    link: usize,
    parent: Option<BodyId>,
    parent_pose: Pose,
    connection: Option<&'r Connection<'a>>,
}

/// Builds bodies, shapes and joints, every parent before its children.
pub(super) fn build<'a>(
    robot: &Robot<'a>,
    floating_base: bool,
    looks: &Looks<'_>,
    parts: &mut Parts,
    report: &mut Report,
) -> Result<Tree<'a>, FormatError> {
    let mut tree = Tree {
        elements: Vec::new(),
        joints: Vec::new(),
    };
    let at_root = Visit {
        link: robot.root,
        parent: None,
        parent_pose: Pose::IDENTITY,
        connection: None,
    };
    let mut waiting = vec![at_root];
    while let Some(visit) = waiting.pop() {
        let (id, pose) = tree.add(&visit, robot, floating_base, looks, parts, report)?;
        let leaving = robot.leaving[visit.link].iter().rev();
        waiting.extend(leaving.map(|connection| Visit {
            link: connection.child,
            parent: Some(id),
            parent_pose: pose,
            connection: Some(connection),
        }));
    }
    if tree.elements.len() < robot.links.len() {
        // One root, and links it does not reach: those hang on one another.
        let reached: Vec<_> = parts.bodies.iter().map(|body| body.name.as_str()).collect();
        let lost = |link: &&&Element| !reached.contains(&link.get("name").unwrap_or_default());
        if let Some(link) = robot.links.iter().find(lost) {
            return Err(link.invalid(
                "it does not hang on the root link: its joints go in a circle",
                "remove the joint that closes the circle",
            ));
        }
    }
    Ok(tree)
}

impl<'a> Tree<'a> {
    /// Adds a link, with the joint it hangs on; gives its body and pose.
    fn add(
        &mut self,
        visit: &Visit<'_, 'a>,
        robot: &Robot<'a>,
        floating_base: bool,
        looks: &Looks<'_>,
        parts: &mut Parts,
        report: &mut Report,
    ) -> Result<(BodyId, Pose), FormatError> {
        let link = robot.links[visit.link];
        let id = BodyId(parts.bodies.len());
        let parent_moves = match visit.parent {
            Some(parent) => parts.bodies[parent.0].kind == BodyKind::Dynamic,
            None => floating_base,
        };
        let moves = parent_moves || visit.connection.is_some_and(|c| c.kind != Kind::Fixed);
        let pose = match visit.connection {
            Some(connection) => visit.parent_pose * connection.origin,
            None => Pose::IDENTITY,
        };
        let mass = link::mass_properties(link, moves, report)?;
        parts.bodies.push(Body {
            kind: if moves {
                BodyKind::Dynamic
            } else {
                BodyKind::Static
            },
            pose,
            mass: mass.mass,
            center: mass.center,
            inertia: mass.inertia,
            group: if moves { 1 } else { -1 },
            ..Body::new(link.require("name")?)
        });
        self.elements.push(link.clone());
        for mut shape in link::shapes(link, looks, report)? {
            shape.body = Some(id);
            parts.shapes.push(shape);
        }
        match visit.connection {
            Some(connection) if moves => {
                let (joint, range) = joint::read(connection, (visit.parent, id), report)?;
                let joint_id = JointId(parts.joints.len());
                self.joints.push(TreeJoint {
                    element: connection.element,
                    id: joint_id,
                    range,
                });
                parts.joints.push(joint);
            }
            None if moves => parts.joints.push(nameless(id)),
            _ => {}
        }
        Ok((id, pose))
    }
}

/// What a floating base hangs on. Without names: it gets its body's, as in MJCF, and so do its degrees of freedom.
fn nameless(child: BodyId) -> Joint {
    let mut joint = Joint::new("", JointKind::Free, None, child, Vec::new());
    joint.dofs.iter_mut().for_each(|dof| dof.name.clear());
    joint
}
