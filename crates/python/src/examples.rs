//! Scenes of the engine that need no file.

use crate::count::natural;
use crate::error;
use crate::model::Model;
use kinetarium::model::examples;
use pyo3::prelude::*;

/// Functions of Python that make an example of the same name, with or without a size.
macro_rules! scenes {
    ($($(#[$doc:meta])* $name:ident ($($size:ident = $default:literal)?);)*) => {$(
        $(#[$doc])*
        #[pyfunction]
        #[pyo3(signature = ($($size = $default)?))]
        pub fn $name($($size: i64)?) -> PyResult<Model> {
            $(let $size = natural(concat!("example ", stringify!($name)), stringify!($size), $size)?;)?
            Ok(examples::$name($($size)?).map_err(error::model)?.into())
        }
    )*};
}

scenes! {
    /// A chain of links on hinges, hanging from the world.
    n_pendula(links = 3);
    /// A body on a ball joint with drives.
    ball_joint();
    /// A slide with a drive.
    prismatic();
    /// Five balls that bounce, each by its restitution.
    balls();
    /// Elastic balls on a smooth table.
    billiards();
    /// A row of dominoes, the first of which falls.
    dominoes(count = 20);
    /// A pyramid of boxes.
    pyramid(rows = 10);
    /// A heap of solids of all kinds.
    pile(count = 50);
    /// A house of cards.
    card_house(storeys = 3);
    /// An arch of stones that hold each other.
    arch(stones = 9);
    /// People made of capsules and hinges, falling.
    ragdolls(people = 8);
    /// Rings of triangles on a peg, and a chain of them.
    rings(count = 4);
    /// A machine that walks on closed loops of bars.
    linkage(pairs = 3);
    /// A room with things in it.
    room();
    /// A vehicle with wheels on springs.
    rover();
}
