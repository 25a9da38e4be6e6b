//! Text to the terminal, and files into a folder.

use crate::error::Error;
use crate::trajectory::Trajectory;
use crate::{npz, plot, table};
use std::fmt;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// Prints a text. A reader that has gone away, as of `kinetarium info | head`, is no error.
pub fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// The files that a run writes.
#[derive(Debug)]
pub struct Files {
    folder: PathBuf,
    stem: String,
}

impl Files {
    /// Makes the folder, and tries whether it can be written to.
    pub fn new(folder: &Path, stem: &str) -> Result<Self, Error> {
        let failed = |reason| Error::Folder {
            path: folder.to_owned(),
            reason,
        };
        fs::create_dir_all(folder).map_err(failed)?;
        let files = Self {
            folder: folder.to_owned(),
            stem: stem.to_owned(),
        };
        File::create(files.path("npz")).map_err(failed)?;
        Ok(files)
    }

    /// Writes a trajectory and its plots.
    pub fn write(&self, title: &str, trajectory: &Trajectory) -> Result<(), Error> {
        self.file("npz", |file| Ok(npz::write(trajectory, file)?))?;
        self.file("csv", |file| Ok(table::write(trajectory, file)?))?;
        self.file("png", |file| plot::write_png(title, trajectory, file))?;
        self.file("svg", |file| plot::write_svg(title, trajectory, file))
    }

    fn path(&self, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", self.stem))
    }

    fn file(
        &self,
        extension: &str,
        write: impl FnOnce(&mut BufWriter<File>) -> Result<(), Box<dyn std::error::Error + Send + Sync>>,
    ) -> Result<(), Error> {
        let path = self.path(extension);
        let written = || {
            let mut file = BufWriter::new(File::create(&path)?);
            write(&mut file)?;
            Ok(file.flush()?)
        };
        written().map_err(|reason| Error::Write {
            path: path.clone(),
            reason,
        })
    }
}

impl fmt::Display for Files {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = |extension| self.path(extension).display().to_string();
        writeln!(f, "  trajectory        {}, {}", path("npz"), path("csv"))?;
        writeln!(f, "  plot              {}, {}", path("png"), path("svg"))
    }
}
