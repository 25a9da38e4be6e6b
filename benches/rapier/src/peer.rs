//! Rapier's side: a model of free bodies and static shapes as a Rapier world.

use crate::engine::{Engine, Outcome, TIME_STEP};
use glam::{DMat3, DVec3};
use kinetarium::model::{Body, BodyKind, Combine, Joint, JointKind, Shape};
use kinetarium::prelude::{BodyId, Geometry, Model};
use rapier3d::math::{Matrix, Pose, Rotation, Vector};
use rapier3d::prelude::*;
use rapier3d::rayon::{ThreadPool, ThreadPoolBuilder};

/// Rapier's tolerances are for bodies of about this size [m] unless it is told another.
const DEFAULT_LENGTH: f64 = 1.0;
/// About that of the bodies here.
const FITTING_LENGTH: f64 = 0.1;

/// A Rapier world with threads of its own.
pub struct Peer {
    name: &'static str,
    world: PhysicsWorld,
    /// Of the model's bodies, in their order.
    bodies: Vec<RigidBodyHandle>,
    threads: ThreadPool,
}

impl Peer {
    /// The same masses, surfaces and gravity, at default integration parameters but for the time step.
    ///
    /// Softness has no counterpart. Nothing sleeps, so that a pile at rest is simulated, too.
    ///
    /// # Errors
    /// What is neither a free body nor a static shape, and surfaces that Rapier does not know.
    pub fn new(model: &Model, threads: usize) -> Outcome<Self> {
        Self::with_length("Rapier", DEFAULT_LENGTH, model, threads)
    }

    /// The same, with Rapier's tolerances scaled to the size of the bodies (`length_unit`).
    ///
    /// # Errors
    /// As of [`new`](Self::new).
    pub fn fitted(model: &Model, threads: usize) -> Outcome<Self> {
        Self::with_length("Rapier, unit 0.1 m", FITTING_LENGTH, model, threads)
    }

    fn with_length(
        name: &'static str,
        length: f64,
        model: &Model,
        threads: usize,
    ) -> Outcome<Self> {
        check(model)?;
        let mut world = PhysicsWorld::new();
        world.gravity = vector(model.gravity);
        world.integration_parameters.dt = TIME_STEP as f32;
        world.integration_parameters.length_unit = length as f32;
        let mut bodies = Vec::new();
        for body in &model.bodies {
            bodies.push(world.insert_body(rigid_body(body)));
        }
        for shape in model.shapes.iter().filter(|s| s.collides) {
            let owner = shape.body.map(|id| bodies[id.0]);
            world.insert_collider(collider(shape)?, owner);
        }
        let threads = ThreadPoolBuilder::new().num_threads(threads).build()?;
        Ok(Self {
            name,
            world,
            bodies,
            threads,
        })
    }
}

impl Engine for Peer {
    fn name(&self) -> &'static str {
        self.name
    }
    /// All steps at once on the threads, so that none waits to be handed over.
    fn step(&mut self, steps: usize) {
        let world = &mut self.world;
        self.threads.install(|| {
            for _ in 0..steps {
                world.step();
            }
        });
    }
    fn position(&mut self, body: BodyId) -> DVec3 {
        let place = self.world.bodies[self.bodies[body.0]].translation();
        DVec3::from_array(place.to_array().map(f64::from))
    }
    fn points(&mut self) -> Option<usize> {
        None
    }
    fn check(&self) -> Outcome<()> {
        let lost = self
            .bodies
            .iter()
            .any(|h| !self.world.bodies[*h].is_enabled());
        if lost {
            return Err("Rapier disabled a body whose state was not finite".into());
        }
        Ok(())
    }
}

/// Refuses what has no counterpart.
fn check(model: &Model) -> Outcome<()> {
    if let Some(joint) = model.joints.iter().find(|j| !is_free(j)) {
        return refuse("joint", &joint.name, "only free joints without forces");
    }
    if let Some(coupling) = model.couplings.first() {
        return refuse("coupling", &coupling.name, "no couplings");
    }
    if let Some(actuator) = model.actuators.first() {
        return refuse("actuator", &actuator.name, "no actuators");
    }
    if !(model.contact_pairs.is_empty() && model.exclusions.is_empty()) {
        return refuse("model", &model.name, "no named pairs and no exclusions");
    }
    let moving = |b: &&Body| b.kind == BodyKind::Dynamic;
    if let Some(body) = model.bodies.iter().filter(moving).find(|b| b.group <= 0) {
        return refuse("body", &body.name, "only groups that collide with all");
    }
    for shape in model.shapes.iter().filter(|s| s.collides) {
        check_surface(shape)?;
    }
    Ok(())
}

/// A joint as every body has that hangs on none.
fn is_free(joint: &Joint) -> bool {
    let idle = joint.dofs.iter().all(|dof| {
        let unnamed = kinetarium::model::Dof {
            name: String::new(),
            ..dof.clone()
        };
        unnamed == kinetarium::model::Dof::default()
    });
    joint.kind == JointKind::Free && joint.parent.is_none() && idle
}

fn check_surface(shape: &Shape) -> Outcome<()> {
    let m = &shape.material;
    let sticks = m.sticking() != m.friction;
    if sticks || m.torsional_friction != 0.0 || m.rolling_friction != 0.0 || m.margin != 0.0 {
        let what = "no static friction, no torsional friction, no rolling friction, no margin";
        return refuse("shape", &shape.name, what);
    }
    if (shape.membership, shape.collides_with) != (1, 1) {
        return refuse("shape", &shape.name, "only masks that collide with all");
    }
    Ok(())
}

fn refuse(kind: &str, name: &str, taken: &str) -> Outcome<()> {
    Err(format!("{kind} \"{name}\" cannot be converted to Rapier: {taken}").into())
}

/// A body whose mass is the model's own; its colliders have none.
fn rigid_body(body: &Body) -> RigidBodyBuilder {
    if body.kind == BodyKind::Static {
        return RigidBodyBuilder::fixed().pose(pose(&body.pose));
    }
    let mass = MassProperties::with_inertia_matrix(
        vector(body.center),
        body.mass as f32,
        matrix(body.inertia),
    );
    RigidBodyBuilder::dynamic()
        .pose(pose(&body.pose))
        .additional_mass_properties(mass)
        .can_sleep(false)
}

fn collider(shape: &Shape) -> Outcome<ColliderBuilder> {
    let builder = match shape.geometry {
        Geometry::Plane { .. } => ColliderBuilder::new(SharedShape::halfspace(Vector::Y)),
        Geometry::Sphere { radius } => ColliderBuilder::ball(radius as f32),
        Geometry::Capsule {
            radius: r,
            half_height: h,
        } => ColliderBuilder::capsule_y((h - r) as f32, r as f32),
        Geometry::Cylinder {
            radius: r,
            half_height: h,
        } => ColliderBuilder::cylinder(h as f32, r as f32),
        Geometry::Cone {
            radius: r,
            half_height: h,
        } => ColliderBuilder::cone(h as f32, r as f32),
        Geometry::Box { half: a } => ColliderBuilder::cuboid(a.x as f32, a.y as f32, a.z as f32),
        Geometry::Mesh(ref mesh) => {
            let vertices = mesh.vertices().iter().map(|v| vector(*v));
            ColliderBuilder::trimesh(vertices.collect(), mesh.triangles().to_vec())?
        }
        Geometry::Ellipsoid { .. } | Geometry::Hull(_) | Geometry::MeshFile { .. } => {
            let what = "neither ellipsoids nor hulls nor files of meshes";
            return Err(refuse("shape", &shape.name, what).unwrap_err());
        }
    };
    let material = &shape.material;
    let rule = rule(material.combine);
    Ok(builder
        .position(pose(&shape.pose))
        .density(0.0)
        .friction(material.friction as f32)
        .restitution(material.restitution as f32)
        .friction_combine_rule(rule)
        .restitution_combine_rule(rule))
}

/// Of two rules the same one holds in both engines.
fn rule(combine: Combine) -> CoefficientCombineRule {
    match combine {
        Combine::Average => CoefficientCombineRule::Average,
        Combine::Minimum => CoefficientCombineRule::Min,
        Combine::Multiply => CoefficientCombineRule::Multiply,
        Combine::Maximum => CoefficientCombineRule::Max,
    }
}

fn vector(v: DVec3) -> Vector {
    Vector::from_array(v.to_array().map(|x| x as f32))
}

fn matrix(m: DMat3) -> Matrix {
    Matrix::from_cols_array(&m.to_cols_array().map(|x| x as f32))
}

fn pose(pose: &kinetarium::prelude::Pose) -> Pose {
    let turn = Rotation::from_array(pose.orientation.to_array().map(|x| x as f32));
    Pose::from_parts(vector(pose.position), turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinetarium::prelude::examples;

    #[test]
    fn masses_and_places_are_the_models() {
        let model = examples::bowl(20).unwrap();
        let mut peer = Peer::new(&model, 1).unwrap();
        peer.step(1);
        for (i, body) in model.bodies.iter().enumerate() {
            let handle = peer.bodies[i];
            let theirs = &peer.world.bodies[handle];
            assert!((f64::from(theirs.mass()) / body.mass - 1.0).abs() < 1e-5);
            let moment = theirs.mass_properties().local_mprops.principal_inertia();
            let trace = body.inertia.x_axis.x + body.inertia.y_axis.y + body.inertia.z_axis.z;
            assert!((f64::from(moment.element_sum()) / trace - 1.0).abs() < 1e-5);
            // One step of falling from rest.
            let fallen = body.pose.position - peer.position(BodyId(i));
            assert!(fallen.length() < 2.0 * 9.81 * TIME_STEP * TIME_STEP);
        }
        peer.check().unwrap();
    }

    #[test]
    fn what_rapier_does_not_know_is_refused_by_its_name() {
        for (model, named) in [
            (examples::n_pendula(2), "hinge0"),
            (examples::pile(6), "ellipsoid"),
        ] {
            let error = Peer::new(&model.unwrap(), 1).err().unwrap().to_string();
            assert!(error.contains(named), "{error}");
        }
    }
}
