//! What a body looks like on a page. None of it touches the physics.

use crate::protocol::{self, FileFormat, Gauge};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use model::{ModelError, hint};
use std::fs::File;
use std::hash::{DefaultHasher, Hasher};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use thiserror::Error;

/// Longest file of a skin [bytes].
pub const LONGEST_FILE: usize = 16 << 20;

/// What a body looks like on a page.
///
/// ```
/// use kinetarium_session::Skin;
///
/// assert_eq!(Skin::named("plain")?, Skin::Plain);
/// assert!(Skin::named("sped").unwrap_err().to_string().contains("did you mean \"speed\"?"));
/// # Ok::<(), kinetarium_session::SkinError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Skin {
    /// The colours of its shapes.
    Plain,
    /// One colour and opacity, sRGB, each from 0 to 1.
    Color([f32; 4]),
    /// A colour for each replica.
    Replica,
    /// A colour that follows its state.
    Gauge(Gauge),
    /// A picture on its shapes, or a GLB model in their place.
    File {
        /// The picture or model.
        file: SkinFile,
        /// Whether a model is fitted to the body's shapes; else it is as large as in its file. Pictures always are.
        fitted: bool,
    },
}

/// Skins that have a name.
const NAMED: [(&str, Skin); 6] = [
    ("plain", Skin::Plain),
    ("replica", Skin::Replica),
    ("speed", Skin::Gauge(Gauge::Speed)),
    ("spin", Skin::Gauge(Gauge::Spin)),
    ("force", Skin::Gauge(Gauge::Force)),
    ("height", Skin::Gauge(Gauge::Height)),
];

impl Skin {
    /// `plain`, `replica`, or the gauges `speed`, `spin`, `force` and `height`.
    ///
    /// # Errors
    /// [`SkinError::Name`], with a name that is alike.
    pub fn named(name: &str) -> Result<Self, SkinError> {
        let found = NAMED.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, skin)| skin).ok_or_else(|| SkinError::Name {
            name: name.into(),
            hint: hint(name, &NAMED.map(|(known, _)| known)),
        })
    }

    /// Refuses a colour that is none, as whoever wears it does.
    ///
    /// # Errors
    /// [`SkinError::Color`].
    pub fn check(&self) -> Result<(), SkinError> {
        match self {
            Self::Color(color) if !color.iter().all(|x| (0.0..=1.0).contains(x)) => {
                Err(SkinError::Color { color: *color })
            }
            _ => Ok(()),
        }
    }
    /// As pages are told of it.
    pub(crate) fn told(&self) -> protocol::Skin {
        match self {
            Self::Plain => protocol::Skin::Plain {},
            Self::Color(color) => protocol::Skin::Color { color: *color },
            Self::Replica => protocol::Skin::Replica {},
            Self::Gauge(gauge) => protocol::Skin::Gauge { gauge: *gauge },
            Self::File { file, fitted } => protocol::Skin::File {
                file: file.id().into(),
                fitted: *fitted,
            },
        }
    }
    /// The file that it is of, if it is of one.
    pub(crate) fn file(&self) -> Option<&SkinFile> {
        match self {
            Self::File { file, .. } => Some(file),
            _ => None,
        }
    }
}

/// A picture (PNG, JPEG, WebP) or a model (GLB). Copies share what is in it; equal contents are equal files.
#[derive(Clone, Debug)]
pub struct SkinFile(Arc<protocol::SkinFile>);

impl SkinFile {
    /// Reads a file.
    ///
    /// # Errors
    /// A file that cannot be read, is longer than [`LONGEST_FILE`], or is neither a picture nor a model.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SkinError> {
        let path = path.as_ref();
        let mut bytes = Vec::new();
        // No more than tells that it is too long.
        let most = LONGEST_FILE as u64 + 1;
        let read = File::open(path).and_then(|file| file.take(most).read_to_end(&mut bytes));
        read.map_err(|source| SkinError::Read {
            path: path.into(),
            source,
        })?;
        let name = path.file_name().unwrap_or(path.as_os_str());
        Self::new(&name.to_string_lossy(), &bytes)
    }

    /// What is in a file. What it is, its first bytes tell; the name is for messages.
    ///
    /// # Errors
    /// One that is longer than [`LONGEST_FILE`], or is neither a picture nor a model.
    pub fn new(name: &str, bytes: &[u8]) -> Result<Self, SkinError> {
        let name = name.to_owned();
        if bytes.len() > LONGEST_FILE {
            return Err(SkinError::Long { name });
        }
        let Some(format) = format(bytes) else {
            return Err(SkinError::Format { name });
        };
        let mut hasher = DefaultHasher::new();
        hasher.write(bytes);
        Ok(Self(Arc::new(protocol::SkinFile {
            id: format!("{:016x}", hasher.finish()),
            name,
            format,
            data: STANDARD.encode(bytes),
        })))
    }

    /// What tells it from others: equal for equal contents.
    pub(crate) fn id(&self) -> &str {
        &self.0.id
    }
    /// As pages are told of it.
    pub(crate) fn told(&self) -> protocol::SkinFile {
        protocol::SkinFile::clone(&self.0)
    }
}

impl PartialEq for SkinFile {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id()
    }
}

/// What a file is, by its first bytes.
fn format(bytes: &[u8]) -> Option<FileFormat> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        Some(FileFormat::Png)
    } else if bytes.starts_with(b"\xff\xd8\xff") {
        Some(FileFormat::Jpeg)
    } else if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") {
        Some(FileFormat::Webp)
    } else if bytes.starts_with(b"glTF") {
        Some(FileFormat::Glb)
    } else {
        None
    }
}

/// Why a body cannot be dressed. All is as before.
#[derive(Debug, Error)]
pub enum SkinError {
    /// There is no such body.
    #[error(transparent)]
    Body(#[from] ModelError),
    /// A number of a colour is none, or beyond its range.
    #[error(
        "the colour {color:?} is none: give red, green, blue and opacity, each from 0 to 1, such as [0.3, 0.55, 0.84, 1]"
    )]
    Color {
        /// What was given.
        color: [f32; 4],
    },
    /// There is no skin of this name.
    #[error("there is no skin named \"{name}\"; {hint}")]
    Name {
        /// What was asked for.
        name: String,
        /// One that is alike, or all that there are.
        hint: String,
    },
    /// A file cannot be read.
    #[error("the skin {} cannot be read: {source}", path.display())]
    Read {
        /// Where it should be.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file is neither a picture nor a model.
    #[error(
        "{name} is no picture (PNG, JPEG, WebP) and no model (GLB), as its first bytes tell: save it as one of these"
    )]
    Format {
        /// Of the file.
        name: String,
    },
    /// A file is too long.
    #[error("{name} is longer than {} MB: make the picture or model smaller", LONGEST_FILE >> 20)]
    Long {
        /// Of the file.
        name: String,
    },
}
