//! Ray files and hit files.
//!
//! `rays.f32`: little-endian f32 × 8 a ray, `ox oy oz t_min dx dy dz t_max`. `hits.bin`: 16 bytes a ray, little-endian
//! `t f32` (+inf on a miss), `triangle u32` (0xFFFFFFFF on a miss), `u f32`, `v f32`; of any-hits t is 0 on a hit and
//! only "hit or not" counts.

use crate::failure::Failure;
use slimkd::{Hit, Ray};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes of a ray in a file.
const RAY_BYTES: usize = 32;
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
    bytes: Vec<u8>,
    read: u64,
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
        let count = match metadata.len() {
            length if !metadata.is_file() || length % RAY_BYTES as u64 == 0 => {
                metadata.is_file().then_some(length / RAY_BYTES as u64)
            }
            length => return Err(odd_length(path, length)),
        };
        Ok(Self { file, path: path.to_owned(), count, bytes: vec![0; BATCH * RAY_BYTES], read: 0 })
    }

    /// Rays in the file, where that is known beforehand.
    pub(crate) fn count(&self) -> Option<u64> {
        self.count
    }

    /// Reads the next rays into `rays`; none at the end.
    pub(crate) fn next_batch(&mut self, rays: &mut Vec<Ray>) -> Result<(), Failure> {
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
        if filled % RAY_BYTES != 0 {
            return Err(odd_length(&self.path, self.read));
        }
        rays.clear();
        rays.extend(self.bytes[..filled].chunks_exact(RAY_BYTES).map(decode));
        Ok(())
    }
}

fn odd_length(path: &Path, length: u64) -> Failure {
    let whole = length / RAY_BYTES as u64 * RAY_BYTES as u64;
    let what = format_args!(
        "{length} bytes are not a whole number of rays, the last ends at byte {whole}; write 8 little-endian f32 a ray"
    );
    Failure::at(path, what)
}

fn decode(bytes: &[u8]) -> Ray {
    let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
        std::array::from_fn(|k| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte])));
    Ray { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
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
