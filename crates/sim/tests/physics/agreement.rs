//! Trees drawn at random, with everything that may act along their joints, by all solvers.
//!
//! The three have little in common: what acts along axes is a force of reduced coordinates, a compliant row of positions or
//! a soft row of velocities. So what one of them gets wrong, the others do not.

use crate::common::*;
use fastrand::Rng;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_sim::Simulation;
use model::{
    Axis, BodyHandle, BodyId, Builder, Coupling, Dof, Drive, Geometry, Joint, JointDraft,
    JointHandle, JointId, JointKind, Limit, Material, Model, Object, Pose, Shape, Softness,
};

/// How long they move [s].
const WAY: f64 = 0.2;

/// Numbers of a seed.
struct Draw(Rng);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.f64()
    }
    /// True in so many of a hundred cases.
    fn in_hundred(&mut self, cases: u32) -> bool {
        self.0.u32(0..100) < cases
    }
    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::from_array([(); 3].map(|()| self.between(-size, size)))
    }
    fn direction(&mut self) -> DVec3 {
        self.rotation() * DVec3::X
    }
    fn rotation(&mut self) -> DQuat {
        DQuat::from_scaled_axis(self.point(2.0))
    }
    fn pose(&mut self, size: f64) -> Pose {
        Pose::new(self.point(size), self.rotation())
    }

    fn body(&mut self, object: &mut Object, name: &str) -> BodyHandle {
        let turn = DMat3::from_quat(self.rotation());
        let small = self.between(5e-3, 0.03);
        let moments = DVec3::new(
            small,
            self.between(1.0, 1.5) * small,
            self.between(1.0, 1.5) * small,
        );
        let inertia = turn * DMat3::from_diagonal(moments) * turn.transpose();
        let (mass, center) = (self.between(0.5, 2.0), self.point(0.1));
        object.body(name).inertia(mass, center, inertia).handle()
    }

    fn joint<'a>(
        &mut self,
        object: &'a mut Object,
        name: &str,
        child: BodyHandle,
    ) -> (&'a mut JointDraft, JointKind) {
        use JointKind::*;
        const KINDS: [JointKind; 8] = [
            Revolute, Revolute, Prismatic, Ball, PlaneXz, D6, Fixed, Free,
        ];
        let kind = KINDS[self.0.usize(0..KINDS.len())];
        let joint = match kind {
            Revolute => object.revolute(name, child, self.direction()),
            Prismatic => object.prismatic(name, child, self.direction()),
            Ball => object.ball(name, child),
            PlaneXz => object.plane_xz(name, child),
            Fixed => object.fixed(name, child),
            Free | Distance => object.free(name, child),
            D6 => {
                let frame = DMat3::from_quat(self.rotation());
                let (linear, angular) = (self.0.usize(0..3), self.0.usize(1..3));
                let mut axes = Vec::from_iter((0..linear).map(|i| Axis::linear(frame.col(i))));
                axes.extend((0..angular).map(|i| Axis::angular(frame.col(i))));
                object.d6(name, child, &axes)
            }
        };
        (joint, kind)
    }

    /// What acts along an axis.
    fn laws(&mut self, dof: &mut Dof) {
        if self.in_hundred(40) {
            dof.armature = self.between(1e-3, 0.1);
        }
        if self.in_hundred(40) {
            dof.damping = self.between(0.0, 0.5);
        }
        if self.in_hundred(30) {
            (dof.stiffness, dof.rest) = (self.between(1.0, 50.0), self.between(-0.5, 0.5));
        }
        if self.in_hundred(20) {
            dof.friction_loss = self.between(0.05, 1.0);
        }
        if self.in_hundred(30) {
            dof.limit = Some(Limit {
                lower: self.between(-0.5, -0.05),
                upper: self.between(0.05, 0.5),
                stiffness: self.between(100.0, 1000.0),
                damping: self.between(0.5, 5.0),
                inertia: if self.in_hundred(50) {
                    self.between(0.0, 0.1)
                } else {
                    0.0
                },
            });
        }
        if self.in_hundred(30) {
            dof.drive = self.drive();
        }
    }
    fn drive(&mut self) -> Drive {
        Drive {
            stiffness: self.between(0.0, 50.0),
            damping: self.between(0.1, 2.0),
            target_position: self.between(-1.0, 1.0),
            target_velocity: self.between(-1.0, 1.0),
            effort_limit: if self.in_hundred(50) {
                self.between(0.5, 5.0)
            } else {
                f64::INFINITY
            },
            control_time: if self.in_hundred(30) {
                self.between(0.0, 0.05)
            } else {
                0.0
            },
        }
    }

    fn tree(&mut self) -> Model {
        let mut world = Builder::new("tree");
        let object = world.object("");
        let mut bodies: Vec<BodyHandle> = Vec::new();
        for i in 0..self.0.usize(1..6) {
            let parent = bodies.get(self.0.usize(0..bodies.len().max(1)));
            let child = self.body(object, &format!("body{i}"));
            let frames = [self.pose(0.2), self.pose(0.2)];
            let (joint, kind) = self.joint(object, &format!("joint{i}"), child);
            joint.frames(frames[0], frames[1]);
            if let Some(&parent) = parent {
                joint.parent(parent);
            }
            self.act(joint, kind);
            let (handle, axes) = (joint.handle(), joint.dofs().len());
            let has_axes = !matches!(kind, JointKind::Ball | JointKind::Free | JointKind::Fixed);
            if has_axes && self.in_hundred(40) {
                self.actuator(object, &format!("actuator{i}"), handle, axes);
            }
            bodies.push(child);
        }
        world.build().unwrap()
    }
    fn act(&mut self, joint: &mut JointDraft, kind: JointKind) {
        match kind {
            JointKind::Free => {}
            JointKind::Ball => {
                joint.damping(self.between(0.0, 0.2));
                if self.in_hundred(50) {
                    joint.drive(self.drive());
                }
            }
            _ => joint.dofs_mut().iter_mut().for_each(|dof| self.laws(dof)),
        }
    }
    fn actuator(&mut self, object: &mut Object, name: &str, joint: JointHandle, axes: usize) {
        let (stiffness, damping) = (self.between(1.0, 50.0), self.between(0.1, 2.0));
        let actuator = match self.0.u32(0..3) {
            0 => object.motor(name, joint),
            1 => object.position_servo(name, joint, stiffness, damping),
            _ => object.velocity_servo(name, joint, damping),
        };
        actuator
            .dof(self.0.usize(0..axes))
            .gear(self.between(-2.0, 2.0));
        if self.in_hundred(50) {
            actuator.force_range(self.between(-3.0, -0.1), self.between(0.1, 3.0));
        }
    }

    /// A tree with a loop more, of joints that are not side by side.
    fn close(&mut self, model: Model) -> Option<Model> {
        let count = model.bodies.len();
        let (child, other) = (BodyId(self.0.usize(0..count)), self.0.usize(0..count + 1));
        let parent = (other < count).then_some(BodyId(other));
        let ends = [Some(child), parent];
        let mut joints = model.joints.iter();
        if parent == Some(child)
            || joints.any(|j| ends.contains(&Some(j.child)) && ends.contains(&j.parent))
        {
            return None;
        }
        let mut simulation = EULER.simulate::<f64>(&model, 1e-3);
        let outputs = simulation.outputs();
        let of_child = outputs.body_pose(0, child);
        let of_parent = parent.map_or(Pose::IDENTITY, |body| outputs.body_pose(0, body));
        let kind = [JointKind::Distance, JointKind::Ball][self.0.usize(0..2)];
        let mut joint = Joint::new("closing", kind, parent, child, Vec::new());
        joint.closes_loop = true;
        let (at, from) = (of_child * self.pose(0.2), of_parent * self.pose(0.2));
        let from = if kind == JointKind::Ball { at } else { from };
        joint.child_frame = of_child.inverse() * at;
        joint.parent_frame = of_parent.inverse() * from;
        joint.length = at.position.distance(from.position);
        let mut parts = model.into_parts();
        parts.joints.push(joint);
        let model = Model::new(parts).unwrap();
        // What nothing separates has no loop.
        let settings = EULER.settings(1, 1e-3);
        Simulation::<f64>::new(model.clone(), settings).ok()?;
        Some(model)
    }

    /// A tree of which two axes are coupled.
    fn gear(&mut self, model: Model) -> Option<Model> {
        let straight = |joint: &usize| model.joints[*joint].axes.len() == 1;
        let joints = Vec::from_iter((0..model.joints.len()).filter(straight));
        let [joint, other, ..] = joints[..] else {
            return None;
        };
        let mut parts = model.into_parts();
        parts.couplings.push(Coupling {
            name: "gear".into(),
            joint: JointId(joint),
            other: JointId(other),
            ratio: self.between(-2.0, 2.0),
            offset: 0.0,
        });
        Some(Model::new(parts).unwrap())
    }

    /// A tree that flies free, over soft ground, the centre of its lowest shape 8 cm above that. Its shapes touch that,
    /// not each other.
    fn land(&mut self, model: Model, geometry: Geometry, friction: f64) -> Model {
        let softness = Softness::Spring {
            stiffness: 4000.0,
            damping: 60.0,
        };
        let material = Material {
            friction,
            softness,
            ..Material::default()
        };
        let mut parts = model.into_parts();
        for body in 0..parts.bodies.len() {
            let mut shape = Shape::new(geometry.clone()).with_material(material);
            shape.body = Some(BodyId(body));
            shape.pose = Pose::at(self.point(0.1));
            (shape.membership, shape.collides_with) = (1, 2);
            parts.shapes.push(shape);
        }
        let (name, child) = (parts.joints[0].name.clone(), parts.joints[0].child);
        parts.joints[0] = Joint::new(name, JointKind::Free, None, child, Vec::new());
        parts
            .actuators
            .retain(|actuator| actuator.joint != JointId(0));
        // By `impulse` that of an axis holds up to a fifth more where locks of its joint bring the load.
        let dofs = parts.joints.iter_mut().flat_map(|joint| &mut joint.dofs);
        dofs.for_each(|dof| dof.friction_loss = 0.0);
        let flying = Model::new(parts.clone()).unwrap();
        let mut simulation = EULER.simulate::<f64>(&flying, 1e-3);
        let outputs = simulation.outputs();
        let lowest = flying.shapes.iter().map(|shape| {
            let body = outputs.body_pose(0, shape.body.unwrap());
            body.point(shape.pose.position).y
        });
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        parts.joints[0].initial[1] = 0.08 - lowest;
        let plane = Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        };
        let mut ground = Shape::new(plane).with_material(material);
        (ground.membership, ground.collides_with) = (2, 1);
        parts.shapes.push(ground);
        Model::new(parts).unwrap()
    }
}

/// Where the bodies of a tree are in the end: three points of each.
fn end(model: &Model, method: Method, h: f64, speed: &[f64]) -> Vec<DVec3> {
    let mut settings = method.settings(1, h);
    settings.contacts = !model.shapes.is_empty();
    let mut simulation = Simulation::<f64>::new(model.clone(), settings).unwrap();
    let start = model.initial_position();
    simulation.set_joint_state(0, &start, speed).unwrap();
    let controls = Vec::from_iter((0..model.actuators.len()).map(|i| 1.0 - 0.7 * i as f64));
    simulation.controls().set_control(0, &controls).unwrap();
    simulation.step((WAY / h).round() as usize);
    let outputs = simulation.outputs();
    let poses = (0..model.bodies.len()).map(|body| outputs.body_pose(0, BodyId(body)));
    let points = [DVec3::ZERO, DVec3::X * 0.2, DVec3::Y * 0.2];
    poses
        .flat_map(|pose| points.map(|x| pose.point(x)))
        .collect()
}

/// How far [m] the ends of each two methods are apart at most.
fn apart(model: &Model, speed: &[f64], methods: &[Method], h: f64) -> Vec<f64> {
    let ends = Vec::from_iter(methods.iter().map(|m| end(model, *m, h, speed)));
    let pairs = (1..ends.len()).flat_map(|i| (0..i).map(move |j| (j, i)));
    let distance = |(j, i): (usize, usize)| {
        let points = ends[i].iter().zip(&ends[j]);
        points.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
    };
    pairs.map(distance).collect()
}

/// Fails unless methods lead to the same for each model as their steps vanish. All are of first order, so that a quarter of
/// the step leaves a quarter of the distance, and somewhat more where the next power of h counts; and by as much as bodies
/// move within a step what is reached there, as an end of a range, may be off, `event` [m] in all.
fn converge(
    models: impl Iterator<Item = (Model, Vec<f64>)>,
    methods: &[Method],
    (least, event): (usize, f64),
) {
    let mut count = 0;
    for (i, (model, speed)) in models.enumerate() {
        let [long, short] = [4e-4, 1e-4].map(|h| apart(&model, &speed, methods, h));
        for (long, short) in long.into_iter().zip(short) {
            println!("model {i}: {long:.2e} m apart, then {short:.2e}");
            let most = (0.4 * long + event).min(1e-2);
            assert!(
                short <= most,
                "model {i} by {methods:?}: {long} and {short}"
            );
        }
        count += 1;
    }
    assert!(count >= least, "{count} models");
}

/// So many seeds.
fn draws(count: u64) -> impl Iterator<Item = Draw> {
    (0..count).map(|seed| Draw(Rng::with_seed(seed)))
}

fn at_rest(model: Model) -> (Model, Vec<f64>) {
    let speeds = vec![0.0; model.degrees_of_freedom()];
    (model, speeds)
}

#[test]
fn of_trees() {
    let models = draws(100).map(|mut draw| {
        let model = draw.tree();
        let speeds = (0..model.degrees_of_freedom()).map(|_| draw.between(-1.0, 1.0));
        let speeds = speeds.collect();
        (model, speeds)
    });
    converge(models, &SOLVERS, (100, 1e-4));
}

#[test]
fn of_trees_that_close_loops() {
    let models = draws(300).filter_map(|mut draw| {
        let tree = draw.tree();
        draw.close(tree).map(at_rest)
    });
    converge(models, &SOLVERS, (50, 2e-4));
}

/// `impulse` has no couplings.
#[test]
fn of_trees_with_coupled_axes() {
    let models = draws(150).filter_map(|mut draw| {
        let tree = draw.tree();
        draw.gear(tree).map(at_rest)
    });
    converge(models, &[EULER, XPBD, Method::Xpbd(4)], (50, 1e-4));
}

const BALL: Geometry = Geometry::Sphere { radius: 0.06 };
const CUBE: Geometry = Geometry::Box {
    half: DVec3::splat(0.04),
};

fn landing(geometry: Geometry, friction: f64) -> impl Iterator<Item = (Model, Vec<f64>)> {
    draws(60).map(move |mut draw| {
        let tree = draw.tree();
        at_rest(draw.land(tree, geometry.clone(), friction))
    })
}

#[test]
fn of_trees_on_smooth_ground() {
    converge(landing(BALL, 0.0), &SOLVERS, (60, 1e-4));
    converge(landing(CUBE, 0.0), &SOLVERS, (60, 1e-4));
}

/// What slides sticks within a step, and by each method in another one. The patches of `impulse` have a test of their own.
#[test]
fn of_trees_on_rough_ground() {
    converge(landing(BALL, 0.5), &SOLVERS, (60, 1e-3));
}

/// By `impulse` the four corners of a face rub as one patch, which is near to what they do one by one.
#[test]
fn of_patches_and_points_that_rub() {
    let distance =
        |(model, speed): (Model, Vec<f64>)| apart(&model, &speed, &[XPBD, IMPULSE], 1e-4)[0];
    let distances = Vec::from_iter(landing(CUBE, 0.5).map(distance));
    let mean = distances.iter().sum::<f64>() / distances.len() as f64;
    let most = distances.iter().copied().fold(0.0, f64::max);
    println!("mean {mean}, most {most}");
    assert!(mean < 1e-3 && most < 5e-3, "mean {mean} m, most {most} m");
}
