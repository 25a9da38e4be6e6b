//! Trajectories as numpy archives.
//!
//! An `.npz` is a zip of `.npy` files, and each of those a header and the numbers
//! (NumPy Enhancement Proposal 1, version 1.0): the magic, the length of the header, and the
//! header as a Python dictionary, filled up with blanks to a multiple of 64 bytes.

use crate::trajectory::Trajectory;
use std::io::{self, Seek, Write};
use zip::write::{SimpleFileOptions, ZipWriter};
use zip::{CompressionMethod, result::ZipResult};

/// Writes a trajectory, T rows of W worlds.
pub fn write(trajectory: &Trajectory, file: impl Write + Seek) -> ZipResult<()> {
    let t = trajectory;
    let (rows, worlds) = (t.rows(), t.worlds);
    let (coordinates, dofs, bodies) = (t.coordinates.len(), t.dof_names.len(), t.body_names.len());
    let energy: Vec<f64> = t.energy().collect();
    let coordinate_names: Vec<&str> = t.coordinates.iter().map(|c| c.name.as_str()).collect();

    let mut archive = Archive {
        zip: ZipWriter::new(file),
    };
    archive.numbers("time", &[rows], &t.time)?;
    archive.numbers(
        "joint_position",
        &[rows, worlds, coordinates],
        &t.joint_position,
    )?;
    archive.numbers("joint_velocity", &[rows, worlds, dofs], &t.joint_velocity)?;
    archive.numbers(
        "body_position",
        &[rows, worlds, bodies, 3],
        &t.body_position,
    )?;
    archive.numbers(
        "body_orientation",
        &[rows, worlds, bodies, 4],
        &t.body_orientation,
    )?;
    archive.numbers("energy", &[rows, worlds], &energy)?;
    archive.numbers("kinetic_energy", &[rows, worlds], &t.kinetic_energy)?;
    archive.numbers("potential_energy", &[rows, worlds], &t.potential_energy)?;
    archive.numbers("diverged_at", &[worlds], &t.diverged_at)?;
    archive.names("coordinate_names", &coordinate_names)?;
    archive.names("dof_names", &t.dof_names)?;
    archive.names("body_names", &t.body_names)?;
    archive.zip.finish()?.flush()?;
    Ok(())
}

struct Archive<W: Write + Seek> {
    zip: ZipWriter<W>,
}

impl<W: Write + Seek> Archive<W> {
    /// An array of double-precision numbers, the last index running fastest.
    fn numbers(&mut self, name: &str, shape: &[usize], numbers: &[f64]) -> ZipResult<()> {
        self.start(name, "<f8", shape, size_of_val(numbers))?;
        Ok(numbers
            .iter()
            .try_for_each(|x| self.zip.write_all(&x.to_le_bytes()))?)
    }

    /// A list of texts: as many UTF-32 characters each as the longest has, filled up with zeros.
    fn names(&mut self, name: &str, names: &[impl AsRef<str>]) -> ZipResult<()> {
        let longest = names
            .iter()
            .map(|n| n.as_ref().chars().count())
            .max()
            .unwrap_or(0)
            .max(1);
        let bytes = 4 * longest * names.len();
        self.start(name, &format!("<U{longest}"), &[names.len()], bytes)?;
        for name in names {
            let padded = name
                .as_ref()
                .chars()
                .chain(std::iter::repeat('\0'))
                .take(longest);
            padded
                .map(u32::from)
                .try_for_each(|c| self.zip.write_all(&c.to_le_bytes()))?;
        }
        Ok(())
    }

    fn start(&mut self, name: &str, kind: &str, shape: &[usize], bytes: usize) -> ZipResult<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(bytes > u32::MAX as usize / 2);
        self.zip.start_file(format!("{name}.npy"), options)?;
        Ok(header(&mut self.zip, kind, shape)?)
    }
}

fn header(file: &mut impl Write, kind: &str, shape: &[usize]) -> io::Result<()> {
    const BEFORE: usize = 10;
    // A Python tuple of one has a comma behind it; more commas do no harm.
    let shape: String = shape.iter().map(|n| format!("{n}, ")).collect();
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
    let blanks = 63 - (BEFORE + text.len()) % 64;
    text.extend(std::iter::repeat_n(' ', blanks));
    text.push('\n');
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&(text.len() as u16).to_le_bytes())?;
    file.write_all(text.as_bytes())
}
