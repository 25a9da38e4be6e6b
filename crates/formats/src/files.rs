//! Where the text of a file, and of the files it includes, comes from.

use crate::error::FormatError;
use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Largest file that is read [bytes].
const MAX_BYTES: u64 = 64 << 20;

/// Finds the texts of files by their names, as those stand in the main file.
pub trait Files {
    /// The text of a file.
    ///
    /// # Errors
    /// The file is not there, too large, or not UTF-8.
    fn read(&self, name: &str) -> io::Result<String>;

    /// The contents of a file, such as a mesh.
    ///
    /// # Errors
    /// The file is not there, or too large.
    fn bytes(&self, name: &str) -> io::Result<Vec<u8>>;

    /// Whether a file is there, such as a mesh that others will read.
    fn exists(&self, name: &str) -> bool {
        self.bytes(name).is_ok()
    }

    /// What to do where meshes are not there.
    fn remedy(&self) -> &str {
        "correct their paths (a package is a folder beside this file, or above)"
    }

    /// The path of a file that others will open later, such as a mesh.
    fn path(&self, name: &str) -> String;
}

/// Reads the text of `name`; the error names the file.
pub(crate) fn read(files: &dyn Files, name: &str) -> Result<String, FormatError> {
    files.read(name).map_err(|source| FormatError::Read {
        file: files.path(name),
        source,
    })
}

/// Files in a folder on disk.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// Names are looked up in `folder`, unless they are absolute.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self(folder.into())
    }

    /// The folder a file lies in, and the file's name in it.
    pub(crate) fn around(path: &Path) -> (Self, String) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_name().unwrap_or(path.as_os_str());
        (Self::new(folder), name.to_string_lossy().into_owned())
    }
}

impl Files for Folder {
    fn read(&self, name: &str) -> io::Result<String> {
        let no_text = |e| io::Error::new(io::ErrorKind::InvalidData, e);
        String::from_utf8(self.bytes(name)?).map_err(no_text)
    }

    fn bytes(&self, name: &str) -> io::Result<Vec<u8>> {
        // Read up to the limit: what is no plain file, as a pipe, does not tell its length.
        let mut bytes = Vec::new();
        let file = std::fs::File::open(self.0.join(name))?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(io::Error::new(
                io::ErrorKind::FileTooLarge,
                format!("more than {MAX_BYTES} bytes"),
            ));
        }
        Ok(bytes)
    }

    fn exists(&self, name: &str) -> bool {
        self.0.join(name).is_file()
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_string_lossy().into_owned()
    }
}

/// Files held in memory, by name.
#[derive(Clone, Debug, Default)]
pub struct InMemory(HashMap<String, String>);

impl InMemory {
    /// Names and texts.
    pub fn new<N: Into<String>, T: Into<String>>(files: impl IntoIterator<Item = (N, T)>) -> Self {
        Self(
            files
                .into_iter()
                .map(|(name, text)| (name.into(), text.into()))
                .collect(),
        )
    }
}

impl Files for InMemory {
    fn read(&self, name: &str) -> io::Result<String> {
        self.0
            .get(name)
            .cloned()
            .ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn bytes(&self, name: &str) -> io::Result<Vec<u8>> {
        Ok(self.read(name)?.into_bytes())
    }

    fn exists(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    fn path(&self, name: &str) -> String {
        name.to_owned()
    }
}
