//! A camera that has everything in its image.

use crate::light::axes;
use crate::ray_caster::sees;
use crate::{Camera, Scene};
use glam::{DMat3, DQuat, DVec2, DVec3};
use model::Pose;

/// From the upper to the lower edge of the image [rad].
const FIELD_OF_VIEW: f64 = 0.6;
/// How far the camera stands to the right [rad].
const AZIMUTH: f64 = 0.6;
/// How high it stands [rad]: the first from which most is seen.
const ELEVATIONS: [f64; 4] = [0.35, 0.6, 0.9, 1.3];
/// Share of the image, along each axis, that the model fills at most.
const FILLED: f64 = 0.85;

impl Camera {
    /// A free camera that has all bodies, placed so, in its image, or all shapes that end somewhere
    /// if there are no bodies; from in front, a little from the right and from above, or from higher
    /// up where that is hidden by what belongs to the world. If there is nothing, it sees the origin
    /// from 5 m.
    ///
    /// # Panics
    /// If there is not a pose for each body.
    pub fn framing(scene: &Scene, bodies: &[Pose], width: usize, height: usize) -> Self {
        let boxes = scene.outline(bodies);
        let middles = boxes
            .iter()
            .map(|corners| 0.125 * corners.iter().sum::<DVec3>());
        let middles: Vec<DVec3> = middles.collect();
        let points = boxes.concat();
        let from =
            |elevation| Self::new(width, height, FIELD_OF_VIEW).around(scene, &points, elevation);
        let seen = |camera: &Self| {
            let eye = camera.pose.position;
            let seen = middles.iter().filter(|p| sees(scene, bodies, eye, **p));
            4 * seen.count() >= 3 * middles.len()
        };
        let [first, ..] = ELEVATIONS;
        ELEVATIONS
            .map(from)
            .into_iter()
            .find(seen)
            .unwrap_or(from(first))
    }

    /// The same where it sees all points, from a height [rad].
    fn around(self, scene: &Scene, points: &[DVec3], elevation: f64) -> Self {
        let (right, front) = axes(scene.up());
        let across = AZIMUTH.sin() * right + AZIMUTH.cos() * front;
        let back = elevation.cos() * across + elevation.sin() * scene.up();
        let right = scene.up().cross(back).normalize();
        let turn = DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back));
        if points.is_empty() {
            return self.at(Pose::new(5.0 * back, turn));
        }
        let seen: Vec<DVec3> = points.iter().map(|p| turn.conjugate() * *p).collect();
        let most = FILLED * self.principal() / self.focal();
        self.at(Pose::new(turn * eye(&seen, most), turn))
    }
}

/// The nearest place from which points of the camera's frame are all seen within tangents ±`most`.
///
/// Along x, a point p is within the right edge where p.x − x ≤ m (z − p.z), and within the left one
/// where x − p.x ≤ m (z − p.z). So with a = max(p.x + m p.z) and b = max(−p.x + m p.z) the nearest place
/// is x = (a − b) / 2, z = (a + b) / 2m; likewise along y. The axis that asks for less room is centred
/// all the same.
fn eye(points: &[DVec3], most: DVec2) -> DVec3 {
    let place = |axis: usize, m: f64| {
        let farthest = |side: f64| {
            let reach = points.iter().map(|p| side * p[axis] + m * p.z);
            reach.fold(f64::NEG_INFINITY, f64::max)
        };
        let (a, b) = (farthest(1.0), farthest(-1.0));
        (0.5 * (a - b), 0.5 * (a + b) / m)
    };
    let ((x, wide), (y, high)) = (place(0, most.x), place(1, most.y));
    DVec3::new(x, y, wide.max(high))
}
