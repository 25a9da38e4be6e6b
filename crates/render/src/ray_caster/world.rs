//! A scene in one world, as its camera and its sun see it.

use super::placed::{Placed, Ray};
use crate::Light;
use crate::lamp::PlacedLamp;
use crate::scene::Scene;
use crate::view::View;
use glam::{DMat3, DVec2, DVec3};
use model::Pose;

/// Everything that the rays of one world ask for.
pub(super) struct World<'a> {
    pub scene: &'a Scene,
    pub view: &'a View,
    pub light: &'a Light,
    pub lamps: Vec<PlacedLamp<'a>>,
    /// Edge of the squares on planes [m]; 0 is none.
    pub checker: f64,
    /// The nearest to the camera first, as far as balls about them tell.
    pub shapes: Vec<Seen<'a>>,
    /// Where the camera is [m].
    pub eye: DVec3,
    /// In the world, from there to depth 1 m: of the image's upper left corner, and of a pixel to the
    /// right and downwards.
    corner: DVec3,
    right: DVec3,
    down: DVec3,
    /// Width of a pixel at depth 1 m [m].
    pub pixel: f64,
    /// Rows: two directions across the sun's, and the one towards it.
    pub sun: DMat3,
}

/// A shape and what it may cover.
pub(super) struct Seen<'a> {
    pub placed: Placed<'a>,
    /// Distance from the camera [m] from which on it may be met.
    pub nearest: f64,
    /// About it in the image [pixel].
    pub low: DVec2,
    pub high: DVec2,
    /// Middle and half of the box about it along the sun's axes [m].
    pub lit_center: DVec3,
    pub lit_half: DVec3,
}

impl Seen<'_> {
    /// Whether it may be between the sun, of which the edge is seen under this tangent, and a point of
    /// a box along the sun's axes.
    pub fn shadows(&self, [low, high]: [DVec3; 2], spread: f64) -> bool {
        let above = self.lit_center.z + self.lit_half.z - low.z;
        let reach = self.lit_half + spread * above;
        let gap = |axis: usize| {
            let to = self.lit_center[axis];
            (to - to.clamp(low[axis], high[axis])).abs() <= reach[axis]
        };
        above > 0.0 && self.placed.radius.is_finite() && gap(0) && gap(1)
    }

    /// Whether it may be within reach [m] of a point of a box.
    pub fn is_near(&self, [low, high]: [DVec3; 2], reach: f64) -> bool {
        let gap = self.placed.center.clamp(low, high) - self.placed.center;
        gap.length() < self.placed.radius + reach
    }
}

/// Where a ray meets a shape.
#[derive(Clone, Copy)]
pub(super) struct Hit {
    /// Its place in [`World::shapes`].
    pub shape: usize,
    /// From the ray's origin [m].
    pub distance: f64,
    /// Unit vector out of the surface, world axes.
    pub normal: DVec3,
}

impl<'a> World<'a> {
    pub fn new(scene: &'a Scene, view: &'a View, bodies: &[Pose]) -> Self {
        let eye = view.camera.placed(bodies);
        let eye = Pose::new(eye.position, eye.orientation.normalize());
        let light = view.light(scene);
        let to_sun = light.to_sun.normalize();
        let (a, b) = to_sun.any_orthonormal_pair();
        let sun = DMat3::from_cols(a, b, to_sun).transpose();
        let seen = |item| {
            let placed = Placed::new(item, bodies);
            let [low, high] = image_bounds(&placed, &eye, view);
            Seen {
                nearest: placed.center.distance(eye.position) - placed.radius,
                low,
                high,
                lit_center: sun * placed.center,
                lit_half: placed.half_along(sun),
                placed,
            }
        };
        let mut shapes: Vec<Seen> = scene.items.iter().map(seen).collect();
        shapes.sort_by(|a, b| a.nearest.total_cmp(&b.nearest));
        let towards = |u, v| eye.direction(view.camera.unproject(DVec2::new(u, v)));
        let corner = towards(0.0, 0.0);
        Self {
            scene,
            view,
            light,
            lamps: light
                .lamps
                .iter()
                .map(|lamp| PlacedLamp::new(lamp, bodies))
                .collect(),
            checker: view.checker(scene),
            shapes,
            eye: eye.position,
            corner,
            right: towards(1.0, 0.0) - corner,
            down: towards(0.0, 1.0) - corner,
            pixel: 1.0 / view.camera.focal().min_element(),
            sun,
        }
    }

    /// Tangent of the angle from the middle of the sun to its edge, as far as samples see it.
    pub fn sun_spread(&self) -> f64 {
        if self.view.samples > 1 {
            self.light.sun_radius.tan()
        } else {
            0.0
        }
    }

    /// From the camera to a point of the image [pixel]: a unit vector, and how far along it [m] depth is
    /// 1 m.
    pub fn towards(&self, pixel: DVec2) -> (DVec3, f64) {
        let way = self.corner + pixel.x * self.right + pixel.y * self.down;
        let length = way.length();
        (way / length, length)
    }

    /// The ray along such a direction.
    pub fn ray(&self, (direction, length): (DVec3, f64)) -> Ray {
        let camera = &self.view.camera;
        Ray {
            origin: self.eye,
            direction,
            from: camera.near * length,
            to: camera.far * length,
        }
    }

    /// What a ray meets first of some shapes, which are in their order here. Of equally near shapes the
    /// first of the model.
    ///
    /// Inlined, with what it calls: a result that goes through memory, written by numbers and read by pairs of them,
    /// takes longer than to meet a plane.
    #[inline(always)]
    pub fn first(&self, ray: &Ray, shapes: &[usize]) -> Option<Hit> {
        let row = |shape: usize| self.shapes[shape].placed.item.shape;
        let (mut nearest, mut best, mut normal) = (f64::INFINITY, None, DVec3::ZERO);
        for &shape in shapes {
            let seen = &self.shapes[shape];
            if nearest < seen.nearest {
                break;
            }
            let Some((distance, outwards)) = seen.placed.meet(ray) else {
                continue;
            };
            let before = |best| distance == nearest && row(shape) < row(best);
            if distance < nearest || best.is_some_and(before) {
                (nearest, best, normal) = (distance, Some(shape), outwards);
            }
        }
        best.map(|shape| Hit {
            shape,
            distance: nearest,
            normal,
        })
    }
}

/// About a shape in the image, lower and upper corner [pixel]: the projection of the corners of its box,
/// or everything if one of them is beside or behind the camera.
fn image_bounds(placed: &Placed, eye: &Pose, view: &View) -> [DVec2; 2] {
    let everything = [DVec2::NEG_INFINITY, DVec2::INFINITY];
    let inverse = eye.inverse();
    let corners = placed.corners().map(|corner| inverse.point(corner));
    let ahead = |p: &DVec3| p.is_finite() && -p.z >= view.camera.near;
    if !corners.iter().all(ahead) {
        return everything;
    }
    let seen = corners.iter().filter_map(|p| view.camera.project(*p));
    let around = seen
        .map(|p| [p, p])
        .reduce(|[low, high], [p, q]| [low.min(p), high.max(q)]);
    // Corners are rounded, and so are the rays.
    around.map_or(everything, |[low, high]| [low - 1e-3, high + 1e-3])
}
