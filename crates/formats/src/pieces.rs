//! Meshes in convex pieces.

use model::{Geometry, Hull, Model, ModelError, ShapeId, TriangleMesh};
use std::cell::RefCell;
use std::collections::HashSet;

/// How much hollowness a piece may keep, of 1, and voxels along the longest side of a mesh.
#[cfg(feature = "decomposition")]
const FINE: (f64, u32) = (0.01, 64);

/// Meshes that were read to come apart, and the pieces of each.
#[derive(Default)]
pub(crate) struct Pieces(RefCell<Vec<(TriangleMesh, Vec<Hull>)>>);

impl Pieces {
    /// Finds those of a mesh, unless they are known.
    pub fn find(&self, name: &str, mesh: &TriangleMesh) -> Result<(), String> {
        if self.0.borrow().iter().any(|(known, _)| known == mesh) {
            return Ok(());
        }
        let pieces = decompose(name, mesh)?;
        self.0.borrow_mut().push((mesh.clone(), pieces));
        Ok(())
    }

    /// Gives the shapes that touch and are such meshes one piece each, and adds shapes like them for the others. What was
    /// said of pairs of shapes holds for all pieces.
    ///
    /// # Errors
    /// None but those of the model that comes in.
    pub fn take_apart(&self, model: Model) -> Result<Model, ModelError> {
        let known = self.0.borrow();
        if known.is_empty() {
            return Ok(model);
        }
        let mut parts = model.into_parts();
        let of_pairs = parts.contact_pairs.iter().map(|pair| pair.shapes);
        let paired: HashSet<_> = of_pairs.flat_map(|(a, b)| [a, b]).collect();
        let mut rows: Vec<_> = (0..parts.shapes.len()).map(|i| vec![ShapeId(i)]).collect();
        for rows in &mut rows {
            let whole = parts.shapes[rows[0].0].clone();
            if !whole.collides && !paired.contains(&rows[0]) {
                continue;
            }
            let is_of = |(mesh, _): &&(TriangleMesh, _)| matches!(&whole.geometry, Geometry::Mesh(m) if m == mesh);
            let Some((_, pieces)) = known.iter().find(is_of) else {
                continue;
            };
            for (number, piece) in pieces.iter().enumerate() {
                let mut shape = whole.clone();
                shape.geometry = Geometry::Hull(piece.clone());
                if number == 0 {
                    parts.shapes[rows[0].0] = shape;
                    continue;
                }
                if !shape.name.is_empty() {
                    shape.name = format!("{}_{number}", whole.name);
                }
                rows.push(ShapeId(parts.shapes.len()));
                parts.shapes.push(shape);
            }
        }
        for pair in std::mem::take(&mut parts.contact_pairs) {
            for &a in &rows[pair.shapes.0.0] {
                let others = rows[pair.shapes.1.0].iter();
                parts.contact_pairs.extend(others.map(|&b| {
                    let mut pair = pair.clone();
                    pair.shapes = (a, b);
                    pair
                }));
            }
        }
        Model::new(parts)
    }
}

#[cfg(feature = "decomposition")]
fn decompose(name: &str, mesh: &TriangleMesh) -> Result<Vec<Hull>, String> {
    let (concavity, resolution) = FINE;
    let pieces = decomposition::convex_decomposition(mesh, concavity, resolution);
    pieces.map_err(|e| format!("the mesh {name} has no convex pieces: {e}"))
}

#[cfg(not(feature = "decomposition"))]
fn decompose(name: &str, _: &TriangleMesh) -> Result<Vec<Hull>, String> {
    Err(format!(
        "convex pieces, as of the mesh {name}, are not in this build: build it with the feature \
         `decomposition` (cargo's --features decomposition), or take meshes as they are (--meshes exact)"
    ))
}
