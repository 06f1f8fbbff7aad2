//! Ray files and hit files.
//!
//! `rays.f32`: little-endian f32 × 8 a ray, `ox oy oz t_min dx dy dz t_max`; `rays.f64`: the same in f64, which the file's ending says. `hits.bin`: 16 bytes a ray, little-endian
//! `t f32` (+inf on a miss), `triangle u32` (0xFFFFFFFF on a miss), `u f32`, `v f32`; of any-hits t is 0 on a hit and
//! only "hit or not" counts.

use crate::failure::Failure;
use slimkd::{Hit, Ray, RayF64};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Numbers of a ray in a file.
const RAY_NUMBERS: usize = 8;
/// Rays that are read, traced and written at a time: enough for all threads, 12 MiB in all buffers.
pub(crate) const BATCH: usize = 1 << 17;
/// The triangle of a miss.
const NO_TRIANGLE: u32 = u32::MAX;

/// A ray file, read a batch at a time.
pub(crate) struct RayFile {
    file: File,
    path: PathBuf,
    /// Rays in the file; `None` for a pipe.
    count: Option<u64>,
    /// Bytes of a number: 8 in `rays.f64`.
    width: usize,
    bytes: Vec<u8>,
    read: u64,
}

/// A batch of rays, as the file has them.
#[derive(Debug)]
pub(crate) enum Rays {
    F32(Vec<Ray>),
    F64(Vec<RayF64>),
}

impl Rays {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::F32(rays) => rays.len(),
            Self::F64(rays) => rays.len(),
        }
    }
}

impl Default for Rays {
    fn default() -> Self {
        Self::F32(Vec::new())
    }
}

impl RayFile {
    /// Opens it; a regular file whose length is not a whole number of rays is refused at once.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let unreadable = |error: std::io::Error| {
            Failure::at(path, format_args!("cannot read the rays: {error}; check the path given with --rays"))
        };
        let file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        if metadata.is_dir() {
            return Err(unreadable(std::io::ErrorKind::IsADirectory.into()));
        }
        let width =
            if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("f64")) { 8 } else { 4 };
        let ray = (RAY_NUMBERS * width) as u64;
        let count = match metadata.len() {
            length if !metadata.is_file() || length % ray == 0 => metadata.is_file().then_some(length / ray),
            length => return Err(odd_length(path, length, width)),
        };
        let bytes = vec![0; BATCH * RAY_NUMBERS * width];
        Ok(Self { file, path: path.to_owned(), count, width, bytes, read: 0 })
    }

    /// Whether the rays are in f64.
    pub(crate) fn is_f64(&self) -> bool {
        self.width == 8
    }

    /// Rays in the file, where that is known beforehand.
    pub(crate) fn count(&self) -> Option<u64> {
        self.count
    }

    /// Reads the next rays into `rays`; none at the end.
    pub(crate) fn next_batch(&mut self, rays: &mut Rays) -> Result<(), Failure> {
        let mut filled = 0;
        while filled < self.bytes.len() {
            match self.file.read(&mut self.bytes[filled..]) {
                Ok(0) => break,
                Ok(got) => filled += got,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => {
                    let at = self.read + filled as u64;
                    let what = format_args!("cannot read the rays at byte {at}: {error}; check the file");
                    return Err(Failure::at(&self.path, what));
                }
            }
        }
        self.read += filled as u64;
        let ray = RAY_NUMBERS * self.width;
        if filled % ray != 0 {
            return Err(odd_length(&self.path, self.read, self.width));
        }
        let records = self.bytes[..filled].chunks_exact(ray);
        if self.width == 4 && !matches!(rays, Rays::F32(_)) {
            *rays = Rays::F32(Vec::new());
        } else if self.width == 8 && !matches!(rays, Rays::F64(_)) {
            *rays = Rays::F64(Vec::new());
        }
        match rays {
            Rays::F32(rays) => {
                rays.clear();
                rays.extend(records.map(decode));
            }
            Rays::F64(rays) => {
                rays.clear();
                rays.extend(records.map(decode_f64));
            }
        }
        Ok(())
    }
}

fn odd_length(path: &Path, length: u64, width: usize) -> Failure {
    let ray = (RAY_NUMBERS * width) as u64;
    let (whole, bits) = (length / ray * ray, 8 * width);
    let what = format_args!(
        "{length} bytes are not a whole number of rays, the last ends at byte {whole}; write 8 little-endian f{bits} a ray"
    );
    Failure::at(path, what)
}

fn decode(bytes: &[u8]) -> Ray {
    let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
        std::array::from_fn(|k| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte])));
    Ray { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
}

fn decode_f64(bytes: &[u8]) -> RayF64 {
    let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
        std::array::from_fn(|k| f64::from_le_bytes(std::array::from_fn(|byte| bytes[8 * k + byte])));
    RayF64 { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
}

/// A closest hit as the hit file has it.
pub(crate) fn encode_closest(hit: Option<Hit>) -> [u8; 16] {
    match hit {
        Some(Hit { t, u, v, triangle }) => record(t, triangle, u, v),
        None => record(f32::INFINITY, NO_TRIANGLE, 0.0, 0.0),
    }
}

/// An any-hit answer as the hit file has it.
pub(crate) fn encode_any(hit: bool) -> [u8; 16] {
    if hit { record(0.0, 0, 0.0, 0.0) } else { encode_closest(None) }
}

fn record(t: f32, triangle: u32, u: f32, v: f32) -> [u8; 16] {
    bytemuck::cast([t.to_bits().to_le(), triangle.to_le(), u.to_bits().to_le(), v.to_bits().to_le()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_hits_have_the_documented_layout() {
        let bytes: Vec<u8> = (1..=8).flat_map(|k| (k as f32).to_le_bytes()).collect();
        let ray = Ray { origin: [1.0, 2.0, 3.0], t_min: 4.0, direction: [5.0, 6.0, 7.0], t_max: 8.0 };
        assert_eq!(decode(&bytes), ray);
        let hit = encode_closest(Some(Hit { t: 1.0, u: 0.5, v: 0.25, triangle: 7 }));
        assert_eq!(hit, [0, 0, 128, 63, 7, 0, 0, 0, 0, 0, 0, 63, 0, 0, 128, 62]);
        assert_eq!(encode_any(false), [0, 0, 128, 127, 255, 255, 255, 255, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(encode_any(true)[..4], [0; 4]);
    }
}
