//! Which triangles of a mesh are near what may touch it.
//!
//! They are looked for in a box about the other shape that is somewhat wider than the step asks for, and looked for
//! again when the ways of the two shapes ([`Odometers`](super::odometers::Odometers)) may have led out of it.

use super::broad_phase::reach;
use super::narrow_phase::{ROUNDING, Scene, vec3};
use collide::kind;
use collide::mesh::OrientedBox;
use glam::{DMat3, DQuat, DVec3};
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{MARGIN, placed, solid};
use space::Aabb;

/// By how much the box is wider, against the thickness of what it is about.
const SPARE: f64 = 0.1;

/// What is kept of pairs with meshes, in the order of the pairs.
#[derive(Debug, Default)]
pub(super) struct MidPhase {
    pairs: Vec<MeshPair>,
}

/// Two shapes, of which the second is a mesh.
#[derive(Debug)]
pub(super) struct MeshPair {
    pub shapes: [u32; 2],
    /// The numbers of the triangles of each that are near the other; of what is no mesh, none.
    pub near: [Vec<u32>; 2],
    /// What both odometers show when others may touch [m].
    until: f64,
}

impl MeshPair {
    fn new(shapes: [u32; 2]) -> Self {
        Self {
            shapes,
            near: [Vec::new(), Vec::new()],
            until: f64::NEG_INFINITY,
        }
    }
    /// Whether there is anything to touch.
    pub fn is_near(&self) -> bool {
        !self.near[1].is_empty()
    }
    /// How far [m] they are apart at least, if nothing is near; both have gone so far [m].
    pub fn gap(&self, gone: f64) -> f64 {
        // Of infinite ways nothing is known.
        (self.until - gone).max(0.0)
    }
    fn key(&self) -> [u32; 2] {
        let [a, b] = self.shapes;
        [a.min(b), a.max(b)]
    }
}

impl MidPhase {
    /// What is near in each of the pairs, which come in the order of their lower shapes. A thread takes so many as
    /// a part at a time.
    pub fn find<T: Float>(
        &mut self,
        scene: &Scene<'_, T>,
        pairs: impl Iterator<Item = [u32; 2]>,
        part: usize,
    ) -> &[MeshPair] {
        let mut old = std::mem::take(&mut self.pairs).into_iter().peekable();
        self.pairs.extend(pairs.map(|shapes| {
            let new = MeshPair::new(shapes);
            while old.next_if(|kept| kept.key() < new.key()).is_some() {}
            old.next_if(|kept| kept.shapes == shapes).unwrap_or(new)
        }));
        if scene.threads {
            let pairs = self.pairs.par_iter_mut().with_min_len(part);
            pairs.for_each(|kept| scene.look(kept));
        } else {
            self.pairs.iter_mut().for_each(|kept| scene.look(kept));
        }
        &self.pairs
    }
}

impl<T: Float> Scene<'_, T> {
    /// Looks for the triangles of a pair, unless those that it has will do.
    fn look(&self, kept: &mut MeshPair) {
        let shapes = kept.shapes;
        // As far as the kernels look, that what is found is all that they would find.
        let looked = reach(self.shapes, shapes) + MARGIN;
        let gone = self.gone(shapes);
        // Infinite ways, of planes that turn, never are short enough.
        if gone + looked < kept.until {
            return;
        }
        let looked = looked + SPARE * self.thickness(shapes[0]);
        kept.until = gone + looked;
        let margin = self.impulse.margin(shapes, self.parameters).to_f64();
        self.triangles(shapes, looked + margin, &mut kept.near);
    }

    /// What both odometers show now [m].
    pub fn gone(&self, shapes: [u32; 2]) -> f64 {
        let [a, b] = shapes.map(|s| self.ways[s as usize]);
        a + b
    }

    /// The least half of a shape's sizes [m]; of a plane, none.
    fn thickness(&self, shape: u32) -> f64 {
        if self.impulse.shapes()[shape as usize].kind == kind::PLANE {
            return 0.0;
        }
        let solid = self.impulse.solid_of(shape as usize, self.parameters);
        vec3(solid, solid::EXTENT).min_element()
    }

    /// The triangles of two shapes, of which the second is a mesh, that are near the other, within the slack [m].
    fn triangles(&self, shapes: [u32; 2], slack: f64, near: &mut [Vec<u32>; 2]) {
        near.iter_mut().for_each(Vec::clear);
        let [near_a, near_b] = near;
        let b = &self.shapes[shapes[1] as usize].placed;
        let [mesh_a, mesh_b] = shapes.map(|s| self.meshes[s as usize].as_ref());
        let Some(mesh_b) = mesh_b else {
            return;
        };
        let around_a = self.box_about(shapes[0], b, slack);
        let in_b = bounds(&around_a);
        mesh_b.near(&in_b, near_b);
        let Some(mesh_a) = mesh_a else {
            near_b.retain(|t| around_a.may_meet(mesh_b.triangle(*t)));
            return;
        };
        let boxes = near_b.iter().map(|t| mesh_b.triangle(*t).bounds());
        if let Some([low, high]) = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) {
            let low = low.max(in_b.min.as_dvec3());
            let high = high.min(in_b.max.as_dvec3());
            let axes = axes(b);
            let place = vec3(b, placed::POSITION) + axes * (0.5 * (low + high));
            let from = &self.shapes[shapes[0] as usize].placed;
            let around_b = seen(from, place, axes, 0.5 * (high - low) + slack);
            mesh_a.near(&bounds(&around_b), near_a);
        }
    }

    /// The box along a shape's own axes that holds it, wider by a slack [m] on all sides, as seen from another shape.
    fn box_about(&self, shape: u32, from: &[T], slack: f64) -> OrientedBox {
        let placed = &self.shapes[shape as usize].placed;
        let solid = self.impulse.solid_of(shape as usize, self.parameters);
        let half = vec3(solid, solid::EXTENT) + slack;
        seen(from, vec3(placed, placed::POSITION), axes(placed), half)
    }
}

/// The axes of a shape in its place, as columns.
fn axes<T: Float>(shape: &[T]) -> DMat3 {
    let turn = [0, 1, 2, 3].map(|i| shape[placed::ORIENTATION + i].to_f64());
    DMat3::from_quat(DQuat::from_array(turn))
}

/// A box of the world as seen from a shape: its centre, its axes, and half of it along these.
fn seen<T: Float>(from: &[T], center: DVec3, of: DMat3, half: DVec3) -> OrientedBox {
    let to_frame = axes(from).transpose();
    let center = to_frame * (center - vec3(from, placed::POSITION));
    let rounding = ROUNDING * (center.abs() + half).max_element();
    OrientedBox {
        center,
        axes: to_frame * of,
        half: half + rounding,
    }
}

/// The box along the axes of the frame about one that stands at any angle.
fn bounds(around: &OrientedBox) -> Aabb {
    let OrientedBox { center, axes, half } = *around;
    let half = axes.abs() * half;
    Aabb::enclosing(center - half, center + half)
}
