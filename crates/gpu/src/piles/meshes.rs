//! Meshes as a card has them, and for how many of their triangles there is room near a solid.

use collide::mesh::{MeshData, TRIANGLE, VERTICES};
use model::{Geometry, Model, TriangleMesh};
use rigid::impulse::{Impulse, WORLD};
use std::collections::BTreeSet;

/// The meshes of a model.
#[derive(Debug, Default)]
pub(super) struct Meshes {
    pub data: MeshData,
    /// Of each colliding shape the range of its groups; of what is no mesh, none.
    pub groups: Vec<[usize; 2]>,
    /// Whether any of them moves.
    moves: bool,
}

/// Numbers of a triangle.
pub(super) const ROW: usize = TRIANGLE + 3 * VERTICES;
/// What there is room for near a solid, at least and at most.
const FEWEST: usize = 16;
const MOST: usize = 1024;
/// Places on a mesh at which is counted how many are near.
const PLACES: usize = 256;
/// How much farther than a solid is large triangles are counted.
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

    /// For how many triangles there is room near each solid of a form: as many as are near the largest, wherever on a mesh
    /// it is.
    pub fn room(&self, impulse: &Impulse, parameters: &[f32], form: (usize, usize)) -> usize {
        let shapes = impulse.shapes().iter().enumerate();
        let of_form = shapes.filter(|(_, s)| {
            let meets = self.moves || s.row != WORLD;
            (s.kind, s.corners) == form && meets
        });
        let radii = of_form.map(|(i, _)| f64::from(impulse.radius_of(i, parameters)));
        let radius = radii.fold(0.0, f64::max);
        let most = self.most_near(SPARE * radius);
        most.next_power_of_two().clamp(FEWEST, MOST)
    }

    /// How many triangles a cube of this half size meets at most whose middle is in the box about one of some triangles.
    fn most_near(&self, half: f64) -> usize {
        let ranges = |rows: [usize; 2], of: &[[usize; 2]]| of[rows[0]][0]..of[rows[1] - 1][1];
        let groups: Vec<_> = self.data.groups().map(|(_, clusters)| clusters).collect();
        let clusters: Vec<_> = self.data.clusters().map(|(_, rows)| rows).collect();
        let meshes: BTreeSet<_> = self.groups.iter().filter(|range| range[1] > 0).collect();
        let mut most = 0;
        for mesh in meshes {
            let of_mesh = ranges(*mesh, &groups);
            let triangles = ranges([of_mesh.start, of_mesh.end], &clusters);
            let all = &self.data.triangles()[triangles];
            for t in all.iter().step_by(all.len().div_ceil(PLACES)) {
                let [low, high] = t.bounds();
                let (low, high) = (low - half, high + half);
                let near = all.iter().filter(|other| {
                    let [least, most] = other.bounds();
                    least.cmple(high).all() && most.cmpge(low).all()
                });
                most = most.max(near.count());
            }
        }
        most
    }
}
