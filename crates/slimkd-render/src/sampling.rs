//! Where the samples of a pixel lie: stratified, and a function of pixel and sample alone, so that a picture does not
//! depend on who renders which tile when.
//!
//! The points are Hammersley's with random digit scrambling per pixel (Kollig & Keller, *Efficient Multidimensional
//! Sampling*, Computer Graphics Forum 21(3), 2002, §3): with 2^m samples, each of the 2^m strata of every shape
//! 2^-k × 2^(k-m) holds exactly one.

use glam::Vec2;

/// A hash of three words with good avalanche: two rounds of PCG (Jarzynski & Olano, *Hash Functions for GPU Rendering*,
/// JCGT 9(3), 2020).
pub(crate) fn hash(x: u32, y: u32, z: u32) -> u32 {
    let pcg = |v: u32| {
        let state = v.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    pcg(x.wrapping_add(pcg(y.wrapping_add(pcg(z)))))
}

/// 32 random bits as a float in [0, 1).
pub(crate) fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// Sample `index` of `count` in the unit square; a single sample lies in the middle.
pub(crate) fn pixel_sample(pixel: (u32, u32), index: u32, count: u32) -> Vec2 {
    if count <= 1 {
        return Vec2::splat(0.5);
    }
    stratified(hash(pixel.0, pixel.1, 0), index, count)
}

/// Point `index` of `count` of the scrambled set that `seed` names.
pub(crate) fn stratified(seed: u32, index: u32, count: u32) -> Vec2 {
    let jitter = unit(hash(seed, index, 1));
    let x = (index as f32 + jitter) / count as f32;
    let y = unit(index.reverse_bits() ^ hash(seed, 0, 2));
    Vec2::new(x.min(1.0 - f32::EPSILON), y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stratum_once() {
        for pixel in [(0, 0), (17, 4), (1023, 1023)] {
            for (columns, rows) in [(1, 16), (2, 8), (4, 4), (16, 1)] {
                let mut seen = [false; 16];
                for index in 0..16 {
                    let p = pixel_sample(pixel, index, 16);
                    let cell = (p.x * columns as f32) as usize * rows + (p.y * rows as f32) as usize;
                    assert!(!std::mem::replace(&mut seen[cell], true), "{pixel:?} {columns}x{rows}");
                }
            }
        }
    }

    #[test]
    fn neighbours_differ() {
        assert_ne!(pixel_sample((3, 4), 0, 4), pixel_sample((4, 3), 0, 4));
        assert_eq!(pixel_sample((3, 4), 0, 1), Vec2::splat(0.5));
    }
}
