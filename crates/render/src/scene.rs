//! What there is to see of a model.

use crate::error::RenderError;
use crate::light::Light;
use crate::mesh::Triangles;
use collide::ray::{Face, faces};
use glam::{DVec3, Vec3};
use model::{BodyId, Geometry, Model, Pose, Shape, ShapeId, TriangleMesh};
use std::sync::Arc;

/// The shapes of a model that are seen, ready to be drawn in any number of worlds.
///
/// Seen are all shapes, those that collide and those that do not, but for sensors and what has opacity
/// 0; and of all of them the outside: a camera inside a solid looks through its surface, and a plane
/// or a triangle from behind is not there. The files of meshes that are only seen are read.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What lights it; at first [the model's lamps](Light::of), or a sunny day.
    pub light: Light,
    /// Edge of the squares of the checker pattern on planes [m], in their frames from their origins; 0 is
    /// none. At first 1, 2 or 5 times a power of ten, between a tenth and a quarter of what the
    /// bodies extend over.
    pub checker: f64,
    pub(crate) items: Vec<Item>,
    pub(crate) up: DVec3,
    /// What the bodies extend over where they start [m].
    pub(crate) extent: f64,
    bodies: usize,
}

/// A shape that is seen.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub shape: ShapeId,
    pub body: Option<BodyId>,
    pub pose: Pose,
    pub form: Form,
    /// Linear.
    pub color: Vec3,
    pub opacity: f32,
    /// The middle of the box about it, in its frame.
    pub center: DVec3,
    /// Half of that box [m]; infinite where a plane is endless.
    pub half: DVec3,
}

/// What is drawn.
#[derive(Clone, Debug)]
pub(crate) enum Form {
    /// Seen from outside.
    Solid(Geometry),
    /// What is behind all of these faces, seen from outside.
    Hull {
        faces: Arc<[Face]>,
        #[cfg(feature = "gpu")]
        hull: model::Hull,
    },
    /// Seen from above: at y = 0, within the item's box.
    Plane,
    /// Seen from the front.
    Mesh(Arc<Triangles>),
}

impl Scene {
    /// What there is to see of a model; nothing is shared with it but its meshes.
    ///
    /// # Errors
    /// The file of a mesh cannot be read.
    pub fn new(model: &Model) -> Result<Self, RenderError> {
        let mut meshes = Vec::new();
        let mut items = Vec::new();
        for (row, shape) in model.shapes.iter().enumerate() {
            if !shape.sensor && shape.drawn_color()[3] > 0.0 {
                items.push(item(ShapeId(row), shape, &mut meshes)?);
            }
        }
        let up = model.up_axis.direction();
        let mut scene = Self {
            light: Light::of(up, &model.lamps),
            checker: 1.0,
            items,
            up,
            extent: 8.0,
            bodies: model.bodies.len(),
        };
        let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
        let around = scene.outline(&poses).into_iter().flatten().map(|p| [p, p]);
        let bounds = around.reduce(|[low, high], [p, q]| [low.min(p), high.max(q)]);
        if let Some([low, high]) = bounds {
            scene.extent = (high - low).max_element();
            scene.checker = round_down(scene.extent / 4.0);
        }
        Ok(scene)
    }

    /// Number of bodies of the model.
    pub fn bodies(&self) -> usize {
        self.bodies
    }

    /// Upwards, world axes.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The corners [m] of the boxes about the shapes of all bodies that are placed so; of a model without
    /// bodies, about all shapes that end somewhere.
    pub(crate) fn outline(&self, bodies: &[Pose]) -> Vec<[DVec3; 8]> {
        let finite = || self.items.iter().filter(|item| item.half.is_finite());
        let of_bodies = finite().any(|item| item.body.is_some());
        let counted = finite().filter(|item| item.body.is_some() || !of_bodies);
        counted
            .map(|item| item.corners(&item.placed(bodies)))
            .collect()
    }
}

impl Item {
    /// Where it is, on bodies that are placed so.
    pub fn placed(&self, bodies: &[Pose]) -> Pose {
        let carrier = self.body.map_or(Pose::IDENTITY, |body| {
            let Pose {
                position,
                orientation,
            } = bodies[body.0];
            Pose::new(position, orientation.normalize())
        });
        carrier * self.pose
    }
    /// Of the box about it, where it is placed so, in the outer frame.
    pub fn corners(&self, pose: &Pose) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let arm = DVec3::new(sign(0), sign(1), sign(2)) * self.half;
            pose.point(self.center + arm)
        })
    }
    /// Whether no part of it can be in the shadow of another.
    pub fn is_convex(&self) -> bool {
        !matches!(self.form, Form::Mesh(_))
    }
}

fn item(
    id: ShapeId,
    shape: &Shape,
    meshes: &mut Vec<(TriangleMesh, Arc<Triangles>)>,
) -> Result<Item, RenderError> {
    let [red, green, blue, opacity] = shape.drawn_color();
    let mut item = Item {
        shape: id,
        body: shape.body,
        pose: shape.pose,
        form: Form::Solid(shape.geometry.clone()),
        color: Vec3::new(red, green, blue).map(linear),
        opacity,
        center: shape.geometry.center(),
        half: shape.geometry.half_extents().unwrap_or(DVec3::INFINITY),
    };
    match &shape.geometry {
        Geometry::Plane { half_x, half_z } => {
            let size = |half: f64| if half > 0.0 { half } else { f64::INFINITY };
            item.half = DVec3::new(size(*half_x), 0.0, size(*half_z));
            item.form = Form::Plane;
        }
        Geometry::Hull(hull) => {
            item.form = Form::Hull {
                faces: faces(hull).collect(),
                #[cfg(feature = "gpu")]
                hull: hull.clone(),
            }
        }
        Geometry::Mesh(mesh) => item.form = Form::Mesh(triangles(mesh, meshes)),
        Geometry::MeshFile { file, scale } => {
            let mesh = collide::mesh::load(file, *scale).map_err(|source| RenderError::Mesh {
                shape: id.0,
                name: shape.name.clone(),
                source,
            })?;
            (item.center, item.half) = (mesh.center(), mesh.half_extents());
            item.form = Form::Mesh(triangles(&mesh, meshes));
        }
        _ => {}
    }
    Ok(item)
}

/// Of a mesh; of equal ones the same.
fn triangles(
    mesh: &TriangleMesh,
    known: &mut Vec<(TriangleMesh, Arc<Triangles>)>,
) -> Arc<Triangles> {
    if let Some((_, triangles)) = known.iter().find(|(other, _)| other == mesh) {
        return Arc::clone(triangles);
    }
    let triangles = Arc::new(Triangles::new(mesh));
    known.push((mesh.clone(), Arc::clone(&triangles)));
    triangles
}

/// Of a part of a colour in sRGB (IEC 61966-2-1).
fn linear(part: f32) -> f32 {
    if part <= 0.04045 {
        part / 12.92
    } else {
        ((part + 0.055) / 1.055).powf(2.4)
    }
}

/// The largest of 1, 2 and 5 times powers of ten that is not larger.
fn round_down(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    let times = [5.0, 2.0, 1.0].into_iter().find(|times| times * power <= x);
    times.unwrap_or(1.0) * power
}
