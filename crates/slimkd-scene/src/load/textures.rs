//! Textures: PNG and JPEG to linear RGB.

use super::source::{Folder, MAX_GROWTH};
use crate::{Texture, Warning, WarningKind};
use slimkd_util::png;
use std::collections::HashMap;
use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

/// Texels of all textures together that are never out of proportion, bytes: four of 2048 × 2048.
const FREE_BYTES: u64 = 192 << 20;
/// Bytes of a decoded texel.
const TEXEL: u64 = 12;

/// The textures of a scene while it is loaded.
pub(super) struct Textures<'a> {
    pub(super) folder: Folder<'a>,
    pub(super) list: Vec<Texture>,
    /// What was asked for, so that nothing is decoded twice; `None`: it failed.
    known: HashMap<String, Option<u32>>,
    /// Bytes that texels may still take.
    left: u64,
}

impl<'a> Textures<'a> {
    pub(super) fn new(folder: Folder<'a>) -> Self {
        Self { folder, list: Vec::new(), known: HashMap::new(), left: FREE_BYTES }
    }

    /// The index of the texture known by `key`, whose encoded bytes `read` gives.
    pub(super) fn get(
        &mut self,
        key: &str,
        warnings: &mut Vec<Warning>,
        read: impl FnOnce() -> Result<Vec<u8>, String>,
    ) -> Option<u32> {
        if let Some(&known) = self.known.get(key) {
            return known;
        }
        let decoded = read().and_then(|bytes| {
            self.left = self.left.saturating_add(bytes.len() as u64 * MAX_GROWTH);
            decode(&bytes, &mut self.left)
        });
        let index = match decoded {
            Ok(texture) => {
                self.list.push(texture);
                Some(self.list.len() as u32 - 1)
            }
            Err(why) => {
                let key = super::error::quoted(key.as_bytes());
                let what = format!("texture {key} was left out: {}", one_line(&why));
                super::warn(warnings, Warning::new(WarningKind::Missing, what));
                None
            }
        };
        self.known.insert(key.to_owned(), index);
        index
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Decodes an image into texels that fit into `left` bytes, which it lessens.
fn decode(bytes: &[u8], left: &mut u64) -> Result<Texture, String> {
    let mut rest = *left;
    let allow = |[width, height]: [u32; 2]| {
        let needed = u64::from(width).saturating_mul(u64::from(height)).saturating_mul(TEXEL);
        rest = rest.checked_sub(needed).ok_or_else(|| {
            format!(
                "{width} × {height} texels out of {} bytes are out of proportion; make it smaller",
                bytes.len()
            )
        })?;
        // The decoder holds at most 8 bytes a texel (RGBA of 16 bits) and its own buffers.
        Ok(needed + (64 << 20))
    };
    let ([width, height], pixels) = match bytes {
        bytes if png::is_png(bytes) => png::read(bytes, allow)?,
        [0xff, 0xd8, 0xff, ..] => read_jpeg(bytes, allow)?,
        _ => return Err("neither a PNG nor a JPEG; convert it".to_owned()),
    };
    let linear: Vec<f32> = (0..=255u8).map(|value| linear(f32::from(value) / 255.0)).collect();
    let texels = pixels.into_iter().map(|pixel| pixel.map(|value| linear[usize::from(value)])).collect();
    *left = rest;
    Ok(Texture { width, height, texels })
}

/// Like [`png::read`].
fn read_jpeg(
    bytes: &[u8],
    allow: impl FnOnce([u32; 2]) -> Result<u64, String>,
) -> Result<png::Pixels, String> {
    let options = DecoderOptions::default().set_strict_mode(false);
    let options = options.set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|error| error.to_string())?;
    let (width, height) = decoder.dimensions().ok_or("the JPEG has no size")?;
    allow([width as u32, height as u32])?;
    let is_grey = decoder.input_colorspace() == Some(ColorSpace::Luma);
    let space = if is_grey { ColorSpace::Luma } else { ColorSpace::RGB };
    decoder.set_options(decoder.options().jpeg_set_out_colorspace(space));
    let data = decoder.decode().map_err(|error| error.to_string())?;
    let pixels: Vec<[u8; 3]> = match is_grey {
        true => data.into_iter().map(|value| [value; 3]).collect(),
        false => data.as_chunks().0.to_vec(),
    };
    if pixels.len() != width * height {
        return Err("the JPEG is cut off; write it again".to_owned());
    }
    Ok(([width as u32, height as u32], pixels))
}

/// sRGB (IEC 61966-2-1) to linear.
pub(super) fn linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
