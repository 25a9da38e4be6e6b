//! Surfaces.

/// Surface and colour of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Torsional friction coefficient [m].
    pub torsional_friction: f64,
    /// Rolling friction coefficient [m].
    pub rolling_friction: f64,
    /// Restitution: separation speed over approach speed, 0 to 1.
    pub restitution: f64,
    /// Colour: red, green, blue, opacity, each 0 to 1.
    pub color: [f32; 4],
}

impl Default for Material {
    /// Friction 0.5, no rolling or torsional friction, no restitution, grey.
    fn default() -> Self {
        Self {
            friction: 0.5,
            torsional_friction: 0.0,
            rolling_friction: 0.0,
            restitution: 0.0,
            color: [0.7, 0.7, 0.7, 1.0],
        }
    }
}
