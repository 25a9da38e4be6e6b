//! A shape of a scene in a world, and where rays meet it.

use crate::scene::{Form, Item};
use collide::ray::{Line, Span};
use glam::{DMat3, DVec3};
use model::Pose;

/// A part of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub origin: DVec3,
    /// Of unit length.
    pub direction: DVec3,
    /// Distances from the origin [m] between which it counts.
    pub from: f64,
    pub to: f64,
}

impl Ray {
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + distance * self.direction
    }
}

/// An item where it is.
#[derive(Debug)]
pub(super) struct Placed<'a> {
    pub item: &'a Item,
    pose: Pose,
    /// From the world's axes to its own.
    turn: DMat3,
    /// Of the middle of its box, in the world [m].
    pub center: DVec3,
    /// About the middle [m]; infinite for an endless plane.
    pub radius: f64,
}

impl<'a> Placed<'a> {
    pub fn new(item: &'a Item, bodies: &[Pose]) -> Self {
        let pose = item.placed(bodies);
        Self {
            item,
            pose,
            turn: DMat3::from_quat(pose.orientation).transpose(),
            center: pose.point(item.center),
            radius: item.half.length(),
        }
    }

    /// Half of the box about it along other axes, the rows of a matrix.
    pub fn half_along(&self, axes: DMat3) -> DVec3 {
        let own = axes * self.turn.transpose();
        let [x, y, z] = [own.x_axis, own.y_axis, own.z_axis].map(DVec3::abs);
        let half = self.item.half;
        x * half.x + y * half.y + z * half.z
    }

    /// Of the box about it, in the world [m].
    pub fn corners(&self) -> [DVec3; 8] {
        self.item.corners(&self.pose)
    }

    /// A point of the world in its frame.
    pub fn inside(&self, point: DVec3) -> DVec3 {
        self.item.center + self.turn * (point - self.center)
    }

    /// A direction of the world along its axes.
    pub fn along(&self, direction: DVec3) -> DVec3 {
        self.turn * direction
    }

    /// Where a ray first meets its outside: distance [m], and unit normal in the world.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray) -> Option<(f64, DVec3)> {
        if let Form::Plane = self.item.form {
            return self.meet_plane(ray);
        }
        let near = self.near(ray)?;
        let (line, foot) = (&near.line, near.foot);
        let (distance, normal) = match &self.item.form {
            Form::Solid(geometry) => {
                let span = line.within(geometry)?;
                (foot + span.enter, span.normal.normalize())
            }
            Form::Hull { faces, .. } => {
                let span = line.behind(faces.iter().copied())?;
                (foot + span.enter, span.normal)
            }
            Form::Plane => return None,
            Form::Mesh(triangles) => {
                let line = self.beside_middle(line);
                let (distance, normal) = triangles.first(&line, near.from, near.to)?;
                (foot + distance, normal)
            }
        };
        let counts = distance > ray.from && distance < ray.to;
        counts.then(|| (distance, self.turn.transpose() * normal))
    }

    #[inline(always)]
    fn meet_plane(&self, ray: &Ray) -> Option<(f64, DVec3)> {
        let normal = self.turn.row(1);
        let speed = ray.direction.dot(normal);
        let distance = (self.center - ray.origin).dot(normal) / speed;
        let counts = speed < 0.0 && distance > ray.from && distance < ray.to;
        (counts && self.spans(ray.at(distance))).then_some((distance, normal))
    }

    /// Whether the rectangle that a plane is reaches to a point of its surface.
    fn spans(&self, point: DVec3) -> bool {
        let arm = (self.turn * (point - self.center)).abs();
        let half = self.item.half;
        arm.x <= half.x && arm.z <= half.z
    }

    /// Whether it keeps light from passing along a ray. Endless planes keep none, nor do solids that the ray ends
    /// in: they hold what it comes from.
    pub fn blocks(&self, ray: &Ray) -> bool {
        let Some(Near {
            line,
            foot,
            from,
            to,
        }) = self.near(ray)
        else {
            return false;
        };
        let passes = |span: Option<Span>| {
            span.is_some_and(|span| foot + span.leave > ray.from && foot + span.leave < ray.to)
        };
        match &self.item.form {
            Form::Solid(geometry) => passes(line.within(geometry)),
            Form::Hull { faces, .. } => passes(line.behind(faces.iter().copied())),
            Form::Plane => {
                let distance = foot - line.origin.y / line.direction.y;
                let crossed = distance > ray.from && distance < ray.to;
                crossed && self.radius.is_finite() && self.spans(ray.at(distance))
            }
            Form::Mesh(triangles) => triangles.any(&self.beside_middle(&line), from, to),
        }
    }

    /// The line of a ray in its frame, from the point nearest to its middle, so that far origins cost no
    /// more digits than they must; `None` if the ray does not meet the ball about it.
    #[inline]
    fn near(&self, ray: &Ray) -> Option<Near> {
        let arm = ray.origin - self.center;
        let foot = -arm.dot(ray.direction);
        let nearest = arm + foot * ray.direction;
        let (from, to) = (
            ray.from.max(foot - self.radius),
            ray.to.min(foot + self.radius),
        );
        if nearest.length_squared() > self.radius * self.radius || from > to {
            return None;
        }
        Some(Near {
            line: Line {
                origin: self.item.center + self.turn * nearest,
                direction: self.turn * ray.direction,
            },
            foot,
            from: from - foot,
            to: to - foot,
        })
    }

    /// The line from the middle of the box, as triangles are kept.
    fn beside_middle(&self, line: &Line) -> Line {
        let origin = line.origin - self.item.center;
        Line { origin, ..*line }
    }
}

/// A line near an item.
struct Near {
    /// From the point nearest to the item's middle.
    line: Line,
    /// How far that is from the ray's origin [m].
    foot: f64,
    /// What of the line counts [m].
    from: f64,
    to: f64,
}
