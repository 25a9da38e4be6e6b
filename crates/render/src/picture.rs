//! Images as files.

use crate::error::RenderError;
use std::io::Write;

/// Writes one image of a row of 3 × `width` bytes a pixel line, `height` of them, as PNG: `rgb` of
/// [`Images`](crate::Images) with one world.
///
/// # Errors
/// What `rgb` holds is not width × height × 3 bytes, or the file cannot be written.
pub fn write_png(
    file: impl Write,
    rgb: &[u8],
    width: usize,
    height: usize,
) -> Result<(), RenderError> {
    let mut encoder = png::Encoder::new(file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    Ok(writer.finish()?)
}
