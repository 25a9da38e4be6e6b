//! Robots that touch nothing but the ground.

use kinetarium::model::{Model, ModelError};

/// A model whose bodies pass through each other.
pub fn on_the_ground(model: Model) -> Result<Model, ModelError> {
    let mut parts = model.into_parts();
    for shape in parts.shapes.iter_mut().filter(|s| s.body.is_some()) {
        (shape.membership, shape.collides_with) = (2, 1);
    }
    Model::new(parts)
}
