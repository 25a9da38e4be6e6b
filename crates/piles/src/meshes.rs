//! Meshes as a card has them, and for how many of their triangles there is room near what they meet.

use crate::scene::Form;
use collide::mesh::{MeshData, TRIANGLE, VERTICES};
use model::{Geometry, Model, TriangleMesh};
use rigid::impulse::{Collider, Impulse, WORLD};
use std::collections::BTreeSet;

/// The meshes of a model.
#[derive(Debug, Default)]
pub(crate) struct Meshes {
    pub data: MeshData,
    /// Of each colliding shape the range of its groups; of what is no mesh, none.
    pub groups: Vec<[usize; 2]>,
    /// Whether any of them moves.
    moves: bool,
}

/// Numbers of a triangle.
pub(crate) const ROW: usize = TRIANGLE + 3 * VERTICES;
/// What there is room for near a shape, at least and at most.
const FEWEST: usize = 16;
const MOST: usize = 1024;
/// Places on a mesh at which is counted how many are near.
const PLACES: usize = 256;
/// How much farther than a shape is large triangles are counted.
const SPARE: f64 = 1.2;

impl Meshes {
    pub fn new(impulse: &Impulse, model: &Model) -> Self {
        let mut known: Vec<(&TriangleMesh, [usize; 2])> = Vec::new();
        let mut meshes = Self::default();
        for shape in impulse.shapes() {
            let Geometry::Mesh(mesh) = &model.shapes[shape.shape.0].geometry else {
                meshes.groups.push([0; 2]);
                continue;
            };
            meshes.moves |= shape.row != WORLD;
            let same = known.iter().find(|known| known.0 == mesh);
            let range = same.map(|known| known.1).unwrap_or_else(|| {
                let range = meshes.data.add(mesh);
                known.push((mesh, range));
                range
            });
            meshes.groups.push(range);
        }
        meshes
    }

    /// For how many triangles there is room of each mesh of a form near each shape of another: as many as are near the
    /// largest, wherever on a mesh it is.
    pub fn room(&self, impulse: &Impulse, parameters: &[f32], near: Form, of: Form) -> usize {
        let is = |form: Form, shape: &Collider| (shape.kind, shape.corners) == form;
        let shapes = || impulse.shapes().iter().enumerate();
        let meets = |s: &Collider| is(near, s) && (self.moves || s.row != WORLD);
        let met = shapes().filter(|(_, s)| meets(s));
        let radii = met.map(|(i, _)| f64::from(impulse.radius_of(i, parameters)));
        let radius = radii.fold(0.0, f64::max);
        let meshes = shapes().filter(|(_, s)| is(of, s));
        let meshes: BTreeSet<_> = meshes.map(|(i, _)| self.groups[i]).collect();
        let counts = meshes
            .into_iter()
            .map(|mesh| self.most_near(mesh, SPARE * radius));
        let most = counts.max().unwrap_or(0);
        most.next_power_of_two().clamp(FEWEST, MOST)
    }

    /// How many triangles of a mesh a cube of this half size meets at most whose middle is in the box about one of some
    /// triangles.
    fn most_near(&self, mesh: [usize; 2], half: f64) -> usize {
        let ranges = |rows: [usize; 2], of: &[[usize; 2]]| of[rows[0]][0]..of[rows[1] - 1][1];
        let groups: Vec<_> = self.data.groups().map(|(_, clusters)| clusters).collect();
        let clusters: Vec<_> = self.data.clusters().map(|(_, rows)| rows).collect();
        let of_mesh = ranges(mesh, &groups);
        let triangles = ranges([of_mesh.start, of_mesh.end], &clusters);
        let all = &self.data.triangles()[triangles];
        let about = all.iter().step_by(all.len().div_ceil(PLACES));
        let counts = about.map(|t| {
            let [low, high] = t.bounds();
            let (low, high) = (low - half, high + half);
            let near = all.iter().filter(|other| {
                let [least, most] = other.bounds();
                least.cmple(high).all() && most.cmpge(low).all()
            });
            near.count()
        });
        counts.max().unwrap_or(0)
    }
}
