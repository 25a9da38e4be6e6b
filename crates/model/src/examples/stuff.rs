//! What the bodies of the scenes are made of.

use crate::{Geometry, Material, Object, Shape};

/// A solid stuff: density and surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stuff {
    /// [kg/m³].
    pub density: f64,
    /// Coulomb's, against itself.
    pub friction: f64,
    /// Against itself.
    pub restitution: f64,
    /// Red, green, blue in sRGB; `None` tells bodies apart instead.
    pub color: Option<[f32; 3]>,
}

/// Beech, planed.
pub(super) const WOOD: Stuff = Stuff {
    density: 700.0,
    friction: 0.5,
    restitution: 0.0,
    color: Some([0.76, 0.58, 0.38]),
};
/// The same wood, painted so that bodies are told apart.
pub(super) const PAINTED: Stuff = Stuff {
    color: None,
    ..WOOD
};
/// Cardboard, as of beer mats.
pub(super) const CARD: Stuff = Stuff {
    density: 600.0,
    friction: 0.6,
    restitution: 0.0,
    color: Some([0.90, 0.88, 0.80]),
};
/// Rubber, as of a ball that bounces well.
pub(super) const RUBBER: Stuff = Stuff {
    density: 1100.0,
    friction: 0.9,
    restitution: 0.8,
    color: Some([0.80, 0.25, 0.20]),
};
/// Screed, as of a floor.
pub(super) const STONE: Stuff = Stuff {
    density: 2300.0,
    friction: 0.6,
    restitution: 0.0,
    color: None,
};

/// Nothing in particular: as dense as water, the default surface.
pub(super) const PLAIN: Stuff = Stuff {
    density: 1000.0,
    friction: 0.5,
    restitution: 0.0,
    color: None,
};

impl Stuff {
    /// A solid of it.
    pub fn shape(self, geometry: Geometry) -> Shape {
        let material = Material {
            friction: self.friction,
            restitution: self.restitution,
            ..Material::default()
        };
        let shape = Shape::new(geometry)
            .with_density(self.density)
            .with_material(material);
        match self.color {
            Some([red, green, blue]) => shape.with_color([red, green, blue, 1.0]),
            None => shape,
        }
    }
}

/// An endless floor of it at y = 0.
pub(super) fn floor(object: &mut Object, stuff: Stuff) {
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    object.scenery(stuff.shape(plane).named("floor"));
}
