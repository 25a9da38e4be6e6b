//! Rays and swept shapes against many shapes: a simulation beside parry3d, on the same shapes.
//!
//! `cargo bench -p kinetarium --bench queries` goes up to 10⁵ shapes; `-- 3` stops at 10³. Each figure is the median of its
//! repetitions. Both sides answer the same questions, and the program fails where they differ.

use glam::{DQuat, DVec3, EulerRot};
use kinetarium::prelude::*;
use model::Shape;
use parry3d::math::{Pose as ParryPose, Rotation, Vector};
use parry3d::partitioning::{Bvh, BvhBuildStrategy};
use parry3d::query::{self, ShapeCastOptions};
use parry3d::shape::{Compound, SharedShape};
use std::time::{Duration, Instant};

/// Questions of each kind.
const QUESTIONS: usize = 2048;
/// Work is repeated until this has passed, but at least three times.
const PATIENCE: Duration = Duration::from_millis(300);
/// What rays meet is within this share of the distance, and of a metre, by both.
const AGREEING: f64 = 1e-3;
/// The same of what is swept, which parry3d stops a few millimetres late.
const LATE: f64 = 5e-3;

#[derive(Clone, Copy)]
enum Kind {
    /// Shapes of like size, spread evenly, 8 m³ of space each.
    Uniform,
    /// A hundred shapes in each cluster of some 5 m, sizes from 0.1 to 3 m.
    Clustered,
}

/// Shapes in places, and lines through them.
struct Scene {
    shapes: Vec<(Geometry, Pose)>,
    lines: Vec<(DVec3, DVec3)>,
}

impl Scene {
    fn new(kind: Kind, n: usize) -> Self {
        let mut random = fastrand::Rng::with_seed(n as u64);
        let side = 2.0 * (n as f64).cbrt();
        let mut vector = |side: f64| side * DVec3::from_array([(); 3].map(|()| random.f64()));
        let centers: Vec<_> = (0..n / 100).map(|_| vector(side)).collect();
        let shapes = (0..n).map(|i| {
            let (center, half) = match kind {
                Kind::Uniform => (vector(side), DVec3::splat(0.25) + vector(0.5)),
                Kind::Clustered => {
                    // The sum of three is about normal.
                    let off = vector(4.0) + vector(4.0) + vector(4.0) - 6.0;
                    let half = 0.05 * 30f64.powf(vector(1.0).x);
                    (centers[i % centers.len()] + off, half * (0.5 + vector(1.0)))
                }
            };
            let radius = half.x;
            let geometry = match i % 3 {
                0 => Geometry::Sphere { radius },
                1 => Geometry::Box { half },
                _ => Geometry::Capsule {
                    radius,
                    half_height: 1.5 * radius,
                },
            };
            let turn = vector(6.3);
            let turn = DQuat::from_euler(EulerRot::XYZ, turn.x, turn.y, turn.z);
            (geometry, Pose::new(center, turn))
        });
        let shapes = shapes.collect();
        let line = |_| (vector(side), (vector(2.0) - 1.0).normalize_or(DVec3::X));
        Self {
            shapes,
            lines: (0..QUESTIONS).map(line).collect(),
        }
    }
}

/// Distances of what is met, infinite where nothing is, and the median time of finding them.
struct Answers(Vec<f64>, Duration);

fn measure(mut work: impl FnMut() -> Vec<f64>) -> Answers {
    let begin = Instant::now();
    let mut times = Vec::new();
    let mut found = Vec::new();
    while times.len() < 3 || begin.elapsed() < PATIENCE {
        let start = Instant::now();
        found = work();
        times.push(start.elapsed());
    }
    times.sort();
    Answers(found, times[times.len() / 2])
}

/// A simulation of scenery.
struct Ours(Simulation<f64>);

impl Ours {
    fn new(scene: &Scene) -> Self {
        let mut world = Builder::new("scene");
        let object = world.object("things");
        for (geometry, pose) in &scene.shapes {
            let shape = Shape::new(geometry.clone()).at(*pose);
            object.scenery(shape.without_contact());
        }
        let mass = glam::DMat3::IDENTITY;
        object.body("bob").inertia(1.0, DVec3::ZERO, mass);
        let model = world.build().expect("a valid model");
        let settings = SimulationSettings::new(1, 0.01);
        Self(Simulation::new(model, settings).expect("a simulation"))
    }

    /// How long the first query takes after something has moved.
    fn ready(&mut self) -> Duration {
        let (at, still) = ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [0.0; 6]);
        let Answers(_, time) = measure(|| {
            self.0.set_joint_state(0, &at, &still).expect("a state");
            let hit = self.0.cast_ray(0, DVec3::ZERO, DVec3::X, 0.0);
            vec![f64::from(u8::from(hit.expect("a ray").is_some()))]
        });
        time
    }

    /// One at a time.
    fn rays(&mut self, scene: &Scene) -> Answers {
        measure(|| {
            let lines = scene.lines.iter();
            let hits = lines.map(|(o, d)| self.0.cast_ray(0, *o, *d, f64::INFINITY));
            hits.map(|hit| distance(hit.expect("a ray").map(|hit| hit.distance)))
                .collect()
        })
    }

    fn ray_batch(&mut self, scene: &Scene) -> Answers {
        let rays = scene.lines.iter().map(|(origin, direction)| Ray {
            origin: *origin,
            direction: *direction,
            max_distance: f64::INFINITY,
        });
        let rays = Vec::from_iter(rays);
        measure(|| {
            let hits = self.0.cast_rays(0, &rays).expect("rays");
            let distances = hits.iter().map(|hit| distance(hit.map(|hit| hit.distance)));
            distances.collect()
        })
    }

    /// One at a time, and all at once.
    fn casts(&mut self, scene: &Scene, geometry: &Geometry) -> [Answers; 2] {
        let casts = scene.lines.iter().map(|(position, direction)| ShapeCast {
            geometry,
            pose: Pose::at(*position),
            direction: *direction,
            max_distance: f64::INFINITY,
        });
        let (casts, seen) = (Vec::from_iter(casts), Seen::default());
        let alone = measure(|| {
            let hits = casts.iter().map(|cast| self.0.cast_shape(0, *cast, &seen));
            hits.map(|hit| distance(hit.expect("a cast").map(|hit| hit.distance)))
                .collect()
        });
        let together = measure(|| {
            let hits = self.0.cast_shapes(0, &casts, &seen).expect("casts");
            let distances = hits.iter().map(|hit| distance(hit.map(|hit| hit.distance)));
            distances.collect()
        });
        [alone, together]
    }
}

fn distance(hit: Option<f64>) -> f64 {
    hit.unwrap_or(f64::INFINITY)
}

/// parry3d's shapes under its binary hierarchy, as its documentation says to use them.
struct Parry {
    bvh: Bvh,
    shapes: Vec<(ParryPose, SharedShape)>,
    compound: Compound,
}

fn vector(v: DVec3) -> Vector {
    let v = v.as_vec3();
    Vector::new(v.x, v.y, v.z)
}

fn shared(geometry: &Geometry) -> SharedShape {
    match *geometry {
        Geometry::Sphere { radius } => SharedShape::ball(radius as f32),
        Geometry::Capsule {
            radius,
            half_height,
        } => SharedShape::capsule_y((half_height - radius) as f32, radius as f32),
        Geometry::Box { half } => {
            let half = half.as_vec3();
            SharedShape::cuboid(half.x, half.y, half.z)
        }
        _ => unreachable!("not in the scene"),
    }
}

impl Parry {
    fn new(scene: &Scene) -> Self {
        let shapes = scene.shapes.iter().map(|(geometry, pose)| {
            let [x, y, z, w] = pose.orientation.as_quat().to_array();
            let turn = Rotation::from_xyzw(x, y, z, w).normalize();
            let pose = ParryPose::from_parts(vector(pose.position), turn);
            (pose, shared(geometry))
        });
        let shapes = Vec::from_iter(shapes);
        let boxes = shapes.iter().map(|(pose, shape)| shape.compute_aabb(pose));
        let boxes = Vec::from_iter(boxes);
        Self {
            bvh: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes),
            compound: Compound::new(shapes.clone()),
            shapes,
        }
    }

    fn rays(&self, scene: &Scene) -> Answers {
        let first = |(origin, direction): &(DVec3, DVec3)| {
            let ray = query::Ray::new(vector(*origin), vector(*direction));
            let exact = |i: u32, most| {
                let (pose, shape) = &self.shapes[i as usize];
                shape.cast_ray(pose, &ray, most, true)
            };
            let hit = self.bvh.cast_ray(&ray, f32::MAX, exact);
            distance(hit.map(|(_, time)| f64::from(time)))
        };
        measure(|| scene.lines.iter().map(first).collect())
    }

    fn casts(&self, scene: &Scene, geometry: &Geometry) -> Answers {
        let (moving, options) = (shared(geometry), ShapeCastOptions::default());
        let rest = (ParryPose::identity(), Vector::ZERO);
        let first = |(position, direction): &(DVec3, DVec3)| {
            let start = ParryPose::from_parts(vector(*position), Rotation::IDENTITY);
            let way = vector(*direction);
            let hit = query::cast_shapes(
                &start,
                way,
                &*moving,
                &rest.0,
                rest.1,
                &self.compound,
                options,
            );
            let hit = hit.expect("shapes that can be cast");
            distance(hit.map(|hit| f64::from(hit.time_of_impact)))
        };
        measure(|| scene.lines.iter().map(first).collect())
    }
}

/// Times of both sides [µs a question], if their answers are the same but for what grazes.
fn compared(theirs: &Answers, ours: &[&Answers], agreeing: f64) -> String {
    let alike = |(a, b): (&f64, &f64)| a == b || (a - b).abs() <= agreeing * (1.0 + a.min(*b));
    for ours in ours {
        let pairs = theirs.0.iter().zip(&ours.0);
        let unlike = QUESTIONS - pairs.filter(|pair| alike(*pair)).count();
        assert!(unlike <= QUESTIONS / 100, "{unlike} answers differ");
    }
    let micros = |answers: &Answers| 1e6 * answers.1.as_secs_f64() / QUESTIONS as f64;
    let all = std::iter::once(theirs).chain(ours.iter().copied());
    Vec::from_iter(all.map(|answers| format!("{:.2}", micros(answers)))).join(" | ")
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let largest = arguments.find_map(|a| a.parse().ok()).unwrap_or(5);
    println!(
        "µs a question, medians; from the first to the last of each three: parry3d one by one, Kinetarium one by one, \
         Kinetarium in a batch on all threads. ready: ms of the first query after a body has moved.\n"
    );
    println!(
        "| shapes | ready | ray: parry3d | one | batch | ball: parry3d | one | batch | box: parry3d | one | batch |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|");
    let ball = Geometry::Sphere { radius: 0.2 };
    let half = DVec3::new(0.1, 0.2, 0.3);
    let cuboid = Geometry::Box { half };
    for (kind, name) in [(Kind::Uniform, "uniform"), (Kind::Clustered, "clustered")] {
        for exponent in 2..=largest {
            let scene = Scene::new(kind, 10usize.pow(exponent));
            let (mut ours, theirs) = (Ours::new(&scene), Parry::new(&scene));
            let ready = 1e3 * ours.ready().as_secs_f64();
            let rays = [&ours.rays(&scene), &ours.ray_batch(&scene)];
            let rays = compared(&theirs.rays(&scene), &rays, AGREEING);
            let casts = [&ball, &cuboid].map(|geometry| {
                let [alone, together] = ours.casts(&scene, geometry);
                compared(&theirs.casts(&scene, geometry), &[&alone, &together], LATE)
            });
            let casts = casts.join(" | ");
            println!("| {name}, 10^{exponent} | {ready:.3} | {rays} | {casts} |");
        }
    }
}
