//! The picture in memory, and its files.

use crate::statistics::RenderStatistics;
use crate::tone::Development;
use glam::Vec3;
use slimkd_util::{exr, png, whole_file};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Linear RGB (sRGB primaries), rows from the top. Films are equal that show the same, whatever rays they took.
#[derive(Clone, Debug)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
    rays: RenderStatistics,
}

impl PartialEq for Film {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height) && self.pixels == other.pixels
    }
}

/// Bits per channel of a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BitDepth {
    /// 8 bits.
    #[default]
    Eight,
    /// 16 bits.
    Sixteen,
}

/// Why a picture was not written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FilmError {
    /// The file name does not say which format: end it in `.png` or `.exr`.
    #[error("{}: unknown picture format; end the name in .png or .exr", .0.display())]
    UnknownFormat(PathBuf),
    /// The file cannot be written: see the reason, and choose another place.
    #[error("{}: cannot write the picture: {reason}; choose a folder that exists and is writable", path.display())]
    Write {
        /// The target.
        path: PathBuf,
        /// What the system or the encoder said.
        reason: String,
    },
    /// The picture's size is zero or more than memory holds: ask for fewer pixels.
    #[error("a picture of {width} x {height} pixels cannot be held; ask for at least 1 x 1 and fewer pixels")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
}

impl Film {
    /// A black film.
    pub fn new(width: u32, height: u32) -> Result<Self, FilmError> {
        let error = || FilmError::Size { width, height };
        let count = (width as usize).checked_mul(height as usize).filter(|&n| n > 0).ok_or_else(error)?;
        let mut pixels = Vec::new();
        pixels.try_reserve_exact(count).map_err(|_| error())?;
        pixels.resize(count, [0.0; 3]);
        Ok(Self { width, height, pixels, rays: RenderStatistics::default() })
    }

    /// Width, pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height, pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Linear RGB, rows from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The same, to change.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// The rays that were traced for it.
    pub fn rays(&self) -> RenderStatistics {
        self.rays
    }

    /// Adds to the rays that were traced for it; for whoever renders it.
    pub fn add_rays(&mut self, rays: RenderStatistics) {
        self.rays += rays;
    }

    /// The colour at column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Vec3 {
        assert!(x < self.width && y < self.height, "pixel {x}, {y} of {} x {}", self.width, self.height);
        self.pixels[y as usize * self.width as usize + x as usize].into()
    }

    /// The developed picture, sRGB bytes, rows from the top.
    pub fn to_srgb8(&self, development: &Development) -> Vec<u8> {
        self.developed(development, 255.0).map(|x| x as u8).collect()
    }

    /// Share of the pixels that, developed, differ from another picture's by more than 1/255 in a channel; 1 for another size.
    pub fn share_apart(&self, other: &Self) -> f64 {
        if (self.width, self.height) != (other.width, other.height) {
            return 1.0;
        }
        let [a, b] = [self, other].map(|film| film.to_srgb8(&Development::default()));
        let pixels = a.chunks_exact(3).zip(b.chunks_exact(3));
        let apart = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
        apart as f64 / self.pixels.len() as f64
    }

    fn developed(&self, development: &Development, scale: f32) -> impl Iterator<Item = f32> {
        let development = *development;
        self.pixels
            .iter()
            .flat_map(move |&pixel| (development.develop(pixel.into()) * scale).round().to_array())
    }

    /// Refuses a name that [`Film::save`] would refuse, so that it is known before the work.
    pub fn check_format(path: &Path) -> Result<(), FilmError> {
        FileFormat::of(path).map(|_| ())
    }

    /// Writes the picture; the name's end says how: `.png` is developed to sRGB, `.exr` keeps the linear light and
    /// ignores development and depth. It appears under its name only once it is whole.
    pub fn save(&self, path: &Path, development: &Development, depth: BitDepth) -> Result<(), FilmError> {
        let format = FileFormat::of(path)?;
        let fail = |reason: String| FilmError::Write { path: path.to_owned(), reason };
        if path.is_dir() {
            return Err(fail("it is a folder".into()));
        }
        let mut file = whole_file::beside(path).map_err(|e| fail(e.to_string()))?;
        let mut to = BufWriter::new(file.as_file_mut());
        match format {
            FileFormat::Png => self.write_png(&mut to, development, depth),
            FileFormat::Exr => {
                exr::write(&mut to, [self.width, self.height], &self.pixels).map_err(|e| e.to_string())
            }
        }
        .and_then(|()| to.flush().map_err(|e| e.to_string()))
        .map_err(fail)?;
        drop(to);
        let put = file.as_file().sync_all().and_then(|()| whole_file::appear(file, path));
        put.map_err(|e| fail(e.to_string()))
    }

    /// Encodes a PNG.
    fn write_png(
        &self,
        to: &mut impl Write,
        development: &Development,
        depth: BitDepth,
    ) -> Result<(), String> {
        let size = [self.width, self.height];
        match depth {
            BitDepth::Eight => png::write(to, size, &self.to_srgb8(development)),
            BitDepth::Sixteen => {
                let words: Vec<u16> = self.developed(development, 65535.0).map(|x| x as u16).collect();
                png::write_16(to, size, &words)
            }
        }
        .map_err(|e| e.to_string())
    }
}

/// Formats of [`Film::save`].
enum FileFormat {
    Png,
    Exr,
}

impl FileFormat {
    fn of(path: &Path) -> Result<Self, FilmError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(FilmError::UnknownFormat(path.to_owned())),
        }
    }
}
