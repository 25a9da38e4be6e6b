//! `<hfield>`: heights over a grid (XML reference, "asset/hfield").
//!
//! Elevations are scaled so that the lowest is 0 and the highest the size's third number. Their first
//! row is that of most y where they are written in the file or are a picture, and that of least y in
//! MuJoCo's binary format: two whole numbers of 32 bits, rows and columns, and a float for each sample,
//! all of them little-endian.

use super::Context;
use crate::error::FormatError;
use crate::meshes::broken;
use crate::xml::Element;
use glam::DVec2;
use model::{HeightFieldError, MeshError, TriangleMesh};
use std::io::Cursor;

/// Rows of elevations, the first of most y.
type Rows = Vec<Vec<f64>>;

/// The surface, along y, with the file's −y for z.
pub(super) fn read(element: &Element, context: &Context<'_>) -> Result<TriangleMesh, FormatError> {
    let remedy = "write four positive numbers of metres: radius-x radius-y elevation base";
    element.require("size")?;
    let size = element.numbers::<4>("size")?.unwrap_or_default();
    if let Some(x) = size.iter().find(|x| **x <= 0.0) {
        return Err(element.invalid_attribute("size", &format!("holds {x}"), remedy));
    }
    let rows = match element.get("file") {
        Some(file) => from_file(file, context).map_err(|problem| broken(element, problem))?,
        None => written(element)?,
    };
    let samples = || rows.iter().flatten().copied();
    let low = samples().fold(f64::INFINITY, f64::min);
    let range = samples().fold(f64::NEG_INFINITY, f64::max) - low;
    let unit = if range > 0.0 { size[2] / range } else { 0.0 };
    let scaled = |row: &Vec<f64>| row.iter().map(|x| (x - low) * unit).collect();
    let heights: Rows = rows.iter().map(scaled).collect();
    let spacing = |length: f64, n: usize| 2.0 * length / (n.max(2) - 1) as f64;
    let columns = heights.first().map_or(0, Vec::len);
    let spacing = DVec2::new(spacing(size[0], columns), spacing(size[1], heights.len()));
    TriangleMesh::height_field(&heights, spacing)
        .map_err(|problem| broken(element, problem.to_string()))
}

/// The attributes `nrow`, `ncol` and `elevation`; level without the last.
fn written(element: &Element) -> Result<Rows, FormatError> {
    let count = |name: &str| -> Result<usize, FormatError> {
        element.require(name)?;
        let number = element.integer(name)?.unwrap_or(0);
        let fits = usize::try_from(number).ok().filter(|n| *n >= 2);
        fits.ok_or_else(|| {
            let problem = format!("is {number}");
            element.invalid_attribute(name, &problem, "write 2 or more")
        })
    };
    let (rows, columns) = (count("nrow")?, count("ncol")?);
    let all = sample_count(rows, columns).map_err(|problem| broken(element, problem))?;
    let elevation = element.list("elevation", all, all)?;
    let elevation = elevation.unwrap_or_else(|| vec![0.0; all]);
    Ok(elevation.chunks(columns).map(<[f64]>::to_vec).collect())
}

/// How many samples there are in so many rows and columns. Asked before anything is made of that size, as a few bytes
/// can say that it is huge.
fn sample_count(rows: usize, columns: usize) -> Result<usize, String> {
    TriangleMesh::height_field_samples(rows, columns).map_err(|error| match error {
        HeightFieldError::Mesh(MeshError::TooMany { triangles, most }) => format!(
            "{rows} × {columns} samples make {triangles} triangles, and at most {most} can be told apart: give \
             fewer, such as 363 × 363"
        ),
        error => error.to_string(),
    })
}

fn from_file(file: &str, context: &Context<'_>) -> Result<Rows, String> {
    let name = context.compiler.mesh_path(file);
    let (path, bytes) = context.meshes.contents("height field", &name)?;
    let is_picture = path.to_lowercase().ends_with(".png");
    let rows = if is_picture {
        picture(&bytes)
    } else {
        binary(&bytes)
    };
    rows.map_err(|problem| format!("the height field {path} is broken: {problem}"))
}

fn binary(bytes: &[u8]) -> Result<Rows, String> {
    let (words, _) = bytes.as_chunks::<4>();
    let [rows, columns, samples @ ..] = words else {
        return Err("it has no numbers of rows and columns".to_owned());
    };
    let [rows, columns] = [rows, columns].map(|n| i32::from_le_bytes(*n));
    let fits = i64::from(rows) * i64::from(columns) == samples.len() as i64;
    if !fits || rows < 2 || columns < 2 || !bytes.len().is_multiple_of(4) {
        let found = bytes.len();
        return Err(format!(
            "it says {rows} × {columns} samples and has {found} bytes"
        ));
    }
    let samples: Vec<_> = samples
        .iter()
        .map(|x| f64::from(f32::from_le_bytes(*x)))
        .collect();
    let rows = samples.chunks(columns as usize);
    Ok(rows.rev().map(<[f64]>::to_vec).collect())
}

/// The greys of a PNG.
fn picture(bytes: &[u8]) -> Result<Rows, String> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let [width, height] = [reader.info().width, reader.info().height].map(|n| n as usize);
    sample_count(height, width)?;
    let (color, depth) = reader.output_color_type();
    if color != png::ColorType::Grayscale {
        return Err("it is no picture in greys without transparency: convert it".to_owned());
    }
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut buffer = vec![0; size];
    let info = reader.next_frame(&mut buffer).map_err(|e| e.to_string())?;
    let rows = buffer
        .chunks_exact(info.line_size)
        .take(info.height as usize);
    let grey = |row: &[u8]| match depth {
        png::BitDepth::Sixteen => {
            let (greys, _) = row.as_chunks::<2>();
            greys
                .iter()
                .map(|x| f64::from(u16::from_be_bytes(*x)))
                .collect()
        }
        _ => row.iter().copied().map(f64::from).collect(),
    };
    Ok(rows.map(grey).collect())
}
