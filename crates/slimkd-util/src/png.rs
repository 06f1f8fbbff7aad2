//! PNG files: RGB of 8 or 16 bits a channel written, all kinds read as RGB of 8 bits.

use std::io::{self, Cursor, Write};

/// Whether bytes begin as a PNG does.
pub fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG")
}

/// Writes a picture of 8 bits a channel, rows from the top.
pub fn write(to: impl Write, [width, height]: [u32; 2], rgb: &[u8]) -> io::Result<()> {
    encode(to, [width, height], ::png::BitDepth::Eight, rgb)
}

/// Writes a picture of 16 bits a channel, rows from the top.
pub fn write_16(to: impl Write, [width, height]: [u32; 2], rgb: &[u16]) -> io::Result<()> {
    let bytes: Vec<u8> = rgb.iter().flat_map(|channel| channel.to_be_bytes()).collect();
    encode(to, [width, height], ::png::BitDepth::Sixteen, &bytes)
}

fn encode(to: impl Write, [width, height]: [u32; 2], depth: ::png::BitDepth, bytes: &[u8]) -> io::Result<()> {
    let mut encoder = ::png::Encoder::new(to, width, height);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_depth(depth);
    encoder.set_compression(::png::Compression::Fast);
    encoder.set_filter(::png::Filter::Adaptive);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    Ok(writer.finish()?)
}

/// A picture's width and height in pixels, and its pixels in rows from the top.
pub type Pixels = ([u32; 2], Vec<[u8; 3]>);

/// Reads a picture; grey becomes RGB, opacity is left out, 16 bits are rounded to 8. `allow` hears the size before anything is decoded: it
/// says how many bytes the decoder may take, or why the picture is refused.
///
/// # Errors
/// What is wrong with the bytes, or what `allow` says.
pub fn read(bytes: &[u8], allow: impl FnOnce([u32; 2]) -> Result<u64, String>) -> Result<Pixels, String> {
    let mut decoder = ::png::Decoder::new(Cursor::new(bytes));
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(::png::Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(|error| error.to_string())?;
    let size = [header.width, header.height];
    let most = usize::try_from(allow(size)?).unwrap_or(usize::MAX);
    decoder.set_limits(::png::Limits { bytes: most });
    let mut reader = decoder.read_info().map_err(|error| error.to_string())?;
    let length = reader.output_buffer_size().filter(|&length| length <= most);
    let mut data = vec![0; length.ok_or("the picture is too large")?];
    let frame = reader.next_frame(&mut data).map_err(|error| error.to_string())?;
    data.truncate(frame.buffer_size());
    if frame.bit_depth == ::png::BitDepth::Sixteen {
        let narrow = |pair: &[u8]| ((u32::from(pair[0]) * 256 + u32::from(pair[1]) + 128) / 257) as u8;
        data = data.chunks_exact(2).map(narrow).collect();
    }
    let samples = frame.color_type.samples();
    let pixels = data.chunks_exact(samples).map(|pixel| match pixel {
        [r, g, b, ..] => [*r, *g, *b],
        _ => [pixel[0]; 3],
    });
    Ok((size, pixels.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let pixels: Vec<[u8; 3]> = (0..12).map(|k| [k, 100 + k, 255 - k]).collect();
        let (mut narrow, mut wide) = (Vec::new(), Vec::new());
        write(&mut narrow, [4, 3], pixels.as_flattened()).unwrap();
        let words: Vec<u16> =
            pixels.as_flattened().iter().map(|&x| (u16::from(x) * 257).saturating_add(100)).collect();
        write_16(&mut wide, [4, 3], &words).unwrap();
        for bytes in [&narrow, &wide] {
            assert!(is_png(bytes));
            assert_eq!(read(bytes, |_| Ok(1 << 20)), Ok(([4, 3], pixels.clone())));
        }
        let refused = |[width, height]: [u32; 2]| Err(format!("{width} x {height}"));
        assert_eq!(read(&narrow, refused), Err("4 x 3".to_owned()));
        assert!(read(&narrow[..30], |_| Ok(1 << 20)).is_err() && read(&narrow, |_| Ok(1)).is_err());
    }

    #[test]
    fn grey_of_few_bits_becomes_rgb() {
        let mut bytes = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut bytes, 2, 1);
        encoder.set_color(::png::ColorType::Grayscale);
        encoder.set_depth(::png::BitDepth::Four);
        encoder.write_header().unwrap().write_image_data(&[0xf1]).unwrap();
        assert_eq!(read(&bytes, |_| Ok(1 << 20)), Ok(([2, 1], vec![[255; 3], [17; 3]])));
    }
}
