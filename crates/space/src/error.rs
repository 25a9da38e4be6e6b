//! What can be wrong with objects and queries.

/// Why objects or a query are refused. The space is as before.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SpaceError {
    /// A box has a NaN in it.
    #[error(
        "the box of object {object} has a NaN ({min} to {max}): check the object's pose, or remove the object"
    )]
    NotANumber {
        /// Index of the object.
        object: usize,
        /// Its lower corner.
        min: glam::Vec3,
        /// Its upper corner.
        max: glam::Vec3,
    },
    /// A box's lower corner lies above its upper one.
    #[error(
        "the box of object {object} is inside out ({min} to {max}): give the lower corner first"
    )]
    InsideOut {
        /// Index of the object.
        object: usize,
        /// Its lower corner.
        min: glam::Vec3,
        /// Its upper corner.
        max: glam::Vec3,
    },
    /// No object has this index.
    #[error("object {object} does not exist: it was never inserted, or has been removed")]
    NoSuchObject {
        /// The index given.
        object: usize,
    },
    /// An update does not fit the objects.
    #[error(
        "an update has {given} boxes, but there are {expected} objects (removed ones count): give one box each"
    )]
    Count {
        /// Boxes given.
        given: usize,
        /// Objects that ever were.
        expected: usize,
    },
    /// More objects than indices.
    #[error("{given} objects are too many: at most {limit} fit into one space; use several")]
    TooMany {
        /// Objects given.
        given: usize,
        /// The most that fit.
        limit: usize,
    },
    /// A number of a query makes no sense.
    #[error("{what} is {value}: it must be {remedy}")]
    Query {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        remedy: &'static str,
    },
}
