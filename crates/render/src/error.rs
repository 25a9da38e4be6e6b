//! What can be wrong with what is to be drawn.

use thiserror::Error;

/// Why nothing was drawn, with the remedy.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A number of the camera or the light is out of its range.
    #[error("{what} is {value}: it must be {must}")]
    OutOfRange {
        /// Such as "the camera's width".
        what: &'static str,
        /// The number.
        value: String,
        /// What it must be.
        must: &'static str,
    },
    /// A lamp of the light is out of its range, or on no body.
    #[error(transparent)]
    Lamp(#[from] model::ModelError),
    /// The camera's body is not of the scene.
    #[error("the camera is on body {body}, but the scene has {bodies}, counted from 0")]
    NoSuchBody {
        /// The body asked for.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A world has too few or too many poses.
    #[error(
        "world {world} has {poses} poses: give one for each of the {bodies} bodies of the scene"
    )]
    WrongPoses {
        /// Which world.
        world: usize,
        /// How many poses it has.
        poses: usize,
        /// How many bodies the scene has.
        bodies: usize,
    },
    /// A pose is no placement.
    #[error(
        "the pose of body {body} in world {world} is not finite or not of unit length: give the poses of \
         a world that has not diverged"
    )]
    BadPose {
        /// Which world.
        world: usize,
        /// Which body.
        body: usize,
    },
    /// There is no world to look at.
    #[error("there are no worlds to draw: give the poses of at least one")]
    NoWorlds,
    /// More pixels than are drawn at once.
    #[error(
        "{worlds} images of {width} × {height} pixels are more than the {most} that are drawn at once: ask \
         for fewer worlds or smaller images"
    )]
    TooLarge {
        /// How many worlds.
        worlds: usize,
        /// Pixels of a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Most pixels of all images together.
        most: usize,
    },
    /// The images are more than there is memory for.
    #[error(
        "there is too little memory for {worlds} images of {width} × {height} pixels: ask for fewer worlds, \
         smaller images or fewer channels"
    )]
    NoMemory {
        /// How many worlds.
        worlds: usize,
        /// Pixels of a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The file of a mesh that is only seen cannot be read.
    #[error(
        "shape {shape} (\"{name}\") cannot be drawn: {source}; {}give the shape opacity 0",
        remedy(.source)
    )]
    Mesh {
        /// Row of the shape.
        shape: usize,
        /// Its name.
        name: String,
        /// Why.
        source: collide::mesh::LoadError,
    },
    /// There is no such device.
    #[error(
        "unknown device `{0}` for images; known are cpu, auto, gpu, and gpu:NAME with a part of the card's name"
    )]
    UnknownDevice(String),
    /// This build has no part for cards.
    #[error(
        "this build draws no images on graphics cards: build it with the feature gpu, or take the device cpu"
    )]
    NotBuilt,
    /// There is no such card; which there are.
    #[error("{0}")]
    NoCard(String),
    /// A card does not draw this, or fails.
    #[error("{0}")]
    Card(String),
    /// A picture cannot be written.
    #[error("cannot write the picture: {0}")]
    Picture(#[from] png::EncodingError),
}

/// What helps besides making a shape invisible; errors of what is in a file say it themselves.
fn remedy(source: &collide::mesh::LoadError) -> &'static str {
    match source {
        collide::mesh::LoadError::Read { .. } => "correct the path, or ",
        _ => "or ",
    }
}

/// An error unless `holds`.
pub(crate) fn require(
    holds: bool,
    what: &'static str,
    value: impl ToString,
    must: &'static str,
) -> Result<(), RenderError> {
    if holds {
        return Ok(());
    }
    let value = value.to_string();
    Err(RenderError::OutOfRange { what, value, must })
}
