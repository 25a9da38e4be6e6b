//! What can be wrong with a file, where, and what to do about it.

use model::ModelError;
use std::fmt;
use std::sync::Arc;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    /// The file, as it was named to the reader.
    pub file: Arc<str>,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The file is not there, or not readable as text.
    #[error("{file}: cannot be read ({source}); check the path, and that it is a UTF-8 text")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The text is not XML.
    #[error("{place}: not well-formed XML ({problem}); correct the text there")]
    Xml {
        /// Where.
        place: Place,
        /// What the XML parser says.
        problem: String,
    },
    /// An element says something that the format does not allow.
    #[error("{place}: <{element}>: {problem}; {remedy}")]
    Invalid {
        /// Where.
        place: Place,
        /// Name of the element.
        element: String,
        /// What is wrong.
        problem: String,
        /// What to do.
        remedy: String,
    },
    /// An element asks for physics that is not there.
    #[error(
        "{place}: <{element}>: {feature} is not supported, and leaving it out would change the \
         physics; {remedy}, or load leniently (--lenient) to go on without it"
    )]
    Unsupported {
        /// Where.
        place: Place,
        /// Name of the element.
        element: String,
        /// What is not supported.
        feature: String,
        /// What to do.
        remedy: String,
    },
    /// The file of a mesh or height field is not what it should be, or has no convex hull.
    #[error("{place}: <{element}>: {problem}")]
    Mesh {
        /// Where it is used.
        place: Place,
        /// Name of the element.
        element: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// The file is well formed, but no model can be made of what it describes.
    #[error("{file}: {source}")]
    Model {
        /// The file; with line and column where the culprit is known to stand.
        file: String,
        /// What is wrong with the model, and what to do.
        source: ModelError,
    },
}
