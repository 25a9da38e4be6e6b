//! Paths of meshes: as the file gives them, resolved against the file's folder.

use crate::files::Files;
use model::{Geometry, Parts};

/// Resolves the path of every mesh. URLs of packages that are not found stay as they are.
pub(crate) fn resolve(parts: &mut Parts, files: &dyn Files) {
    for shape in &mut parts.shapes {
        if let Geometry::MeshFile { file, .. } = &mut shape.geometry {
            *file = resolved(file, files);
        }
    }
}

/// The path of a mesh, or its URL.
pub(crate) fn resolved(file: &str, files: &dyn Files) -> String {
    match file.contains("://") {
        true => file.to_owned(),
        false => files.path(file),
    }
}
