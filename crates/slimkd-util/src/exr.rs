//! OpenEXR pictures of linear light, written: one part of scan lines, RGB as f32, compressed without loss (ZIP).
//!
//! After the format's description, <https://openexr.com/en/latest/OpenEXRFileLayout.html>. The crate `exr` does much more, with what it needs
//! to compile; it reads the tests' pictures back.

use flate2::{Compression, write::ZlibEncoder};
use std::io::{self, Seek, SeekFrom, Write};

/// Lines that are compressed together.
const BLOCK: usize = 16;
/// Compressing harder takes longer than it saves.
const LEVEL: Compression = Compression::new(4);

/// Writes a picture, rows from the top.
pub fn write(mut to: impl Write + Seek, [width, height]: [u32; 2], rgb: &[[f32; 3]]) -> io::Result<()> {
    let start = to.stream_position()?;
    to.write_all(&header([width, height]))?;
    // Where each block begins; known when all are written.
    let table = to.stream_position()?;
    let mut offsets = vec![0; (height as usize).div_ceil(BLOCK)];
    write_all(&mut to, &offsets)?;
    let blocks = rgb.chunks((BLOCK * width as usize).max(1));
    for (k, (offset, block)) in offsets.iter_mut().zip(blocks).enumerate() {
        *offset = to.stream_position()? - start;
        let data = compress(block, width as usize)?;
        to.write_all(&((k * BLOCK) as u32).to_le_bytes())?;
        to.write_all(&(data.len() as u32).to_le_bytes())?;
        to.write_all(&data)?;
    }
    let end = to.stream_position()?;
    to.seek(SeekFrom::Start(table))?;
    write_all(&mut to, &offsets)?;
    to.seek(SeekFrom::Start(end)).map(|_| ())
}

fn write_all(to: &mut impl Write, offsets: &[u64]) -> io::Result<()> {
    offsets.iter().try_for_each(|offset| to.write_all(&offset.to_le_bytes()))
}

/// The magic number, the version, and what the picture is.
fn header([width, height]: [u32; 2]) -> Vec<u8> {
    let mut out = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        for word in [name, kind] {
            out.extend(word.bytes().chain([0]));
        }
        out.extend((value.len() as u32).to_le_bytes());
        out.extend(value);
    };
    let mut channels = Vec::new();
    for name in ["B", "G", "R"] {
        channels.extend(name.bytes().chain([0]));
        // Floats; not perceptually linear, and three bytes that mean nothing; each pixel across and down.
        channels.extend([2, 0, 1, 1].map(u32::to_le_bytes).as_flattened());
    }
    channels.push(0);
    let window = [0, 0, width.saturating_sub(1), height.saturating_sub(1)].map(u32::to_le_bytes);
    let one = 1f32.to_le_bytes();
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", window.as_flattened());
    attribute("displayWindow", "box2i", window.as_flattened());
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &one);
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &one);
    out.push(0);
    out
}

/// The bytes of some lines: all of one channel of a line, then the next channel, then the next line.
fn compress(pixels: &[[f32; 3]], width: usize) -> io::Result<Vec<u8>> {
    let lines = pixels.chunks(width);
    let values =
        lines.flat_map(|line| [2, 1, 0].into_iter().flat_map(|k| line.iter().map(move |pixel| pixel[k])));
    let raw: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    // Bytes at even places come first, and each is written as its difference to the one before.
    let split = raw.iter().step_by(2).chain(raw.iter().skip(1).step_by(2));
    let mut before = 128;
    let differences: Vec<u8> = split
        .map(|&byte| byte.wrapping_sub(std::mem::replace(&mut before, byte)).wrapping_add(128))
        .collect();
    let mut encoder = ZlibEncoder::new(Vec::new(), LEVEL);
    encoder.write_all(&differences)?;
    let packed = encoder.finish()?;
    // As the format wants it: what does not get smaller stays as it is.
    Ok(if packed.len() < raw.len() { packed } else { raw })
}
