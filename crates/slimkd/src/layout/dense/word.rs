//! The inner node's 32 bits, and the grid that its plane counts in.

use crate::geometry::Aabb;
use crate::layout::Planes;
use crate::simd::Simd;
use std::ops::RangeInclusive;

/// Bits of a plane's position.
pub(super) const PLANE_BITS: u32 = 21;
/// Bits of the near form's distance to the right child, bytes.
pub(super) const DISTANCE_BITS: u32 = 32 - PLANE_BITS - 2;
/// The two low bits that say "leaf" where an axis would stand.
pub(super) const LEAF: u32 = 0b11;

/// Junk of the distance below the plane's bits stays in the float's mantissa: it is part of the cell.
const PLANE_TO_FLOAT: u32 = 9;
const ONE: u32 = 0x3f80_0000;

/// The plane as a float in [1, 2), at most one cell above its true place.
#[inline(always)]
pub(super) fn split(word: u32) -> f32 {
    f32::from_bits(word >> PLANE_TO_FLOAT | ONE)
}

/// The near form's distance; 0 says that it follows the word.
#[inline(always)]
pub(super) fn distance(word: u32) -> u32 {
    word >> 2 & ((1 << DISTANCE_BITS) - 1)
}

/// [`split`] of a word a lane.
#[inline(always)]
pub(super) fn lanes_split<S: Simd>(s: S, word: S::U) -> S::F {
    s.cast_f32((word >> PLANE_TO_FLOAT) | s.u32s(ONE))
}

/// [`distance`] of a word a lane.
#[inline(always)]
pub(super) fn lanes_distance<S: Simd>(s: S, word: S::U) -> S::U {
    (word >> 2) & s.u32s((1 << DISTANCE_BITS) - 1)
}

/// An inner node whose right child stands `distance` bytes on, or elsewhere where that does not fit.
pub(super) fn inner(axis: u8, plane: u32, distance: u32) -> u32 {
    debug_assert!(plane < 1 << PLANE_BITS);
    let near = if distance < 1 << DISTANCE_BITS { distance } else { 0 };
    plane << (32 - PLANE_BITS) | near << 2 | u32::from(axis)
}

/// Shortest and longest grid, scene units, so that all of [`Planes`] are normal numbers and `1/d · unscale`, with
/// `1/d` above ½, is. A thinner scene is divided less finely; a longer one has no grid.
const SPAN: RangeInclusive<f64> = 7.888_609_052_210_118e-31..=8.507_059_173_023_462e37;

/// The grid over a scene: per axis, the power of two at or above the extent has 2^21 cells. `None` where f32 cannot hold
/// its scales.
pub(in crate::layout) fn grid(bounds: &Aabb) -> Option<Planes> {
    let mut planes = Planes::WORLD;
    if bounds.is_empty() {
        return Some(planes);
    }
    for (k, extent) in bounds.extent().into_iter().enumerate() {
        // An extent of 0 has no planes; any grid does.
        let span = if extent > 0.0 { extent.log2().ceil().exp2() } else { 1.0 };
        let span = if span < extent { 2.0 * span } else { span };
        if span > *SPAN.end() {
            return None;
        }
        let span = span.max(*SPAN.start());
        planes.low[k] = bounds.min[k];
        planes.scale[k] = (1.0 / span) as f32;
        planes.unscale[k] = span as f32;
    }
    planes.shift = 1.0;
    planes.cell = 1.0 / (1u32 << PLANE_BITS) as f32;
    Some(planes)
}

/// The cell of a plane inside the bounds.
pub(super) fn cell(planes: &Planes, axis: usize, position: f32) -> u32 {
    let part = (f64::from(position) - f64::from(planes.low[axis])) * f64::from(planes.scale[axis]);
    let last = (1u32 << PLANE_BITS) - 1;
    ((part * f64::from(1u32 << PLANE_BITS)) as u32).min(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decoded_plane_lies_within_a_cell() {
        let bounds = Aabb { min: [-3.0, 0.0, 1e-20], max: [5.0, 1e20, 3e-20] };
        let planes = grid(&bounds).unwrap();
        for k in 0..3 {
            for i in 1..100 {
                let position = bounds.min[k] + (bounds.max[k] - bounds.min[k]) * (i as f32 / 100.0);
                for distance in [5, 300, 511, 512, 100_000] {
                    let word = inner(k as u8, cell(&planes, k, position), distance);
                    let decoded =
                        f64::from(split(word) - 1.0) / f64::from(planes.scale[k]) + f64::from(planes.low[k]);
                    let error = (decoded - f64::from(position)).abs()
                        / (f64::from(planes.cell) / f64::from(planes.scale[k]));
                    assert!(error <= 1.0, "{error} cells on axis {k}");
                    assert_eq!(word & 3, k as u32);
                    assert_eq!(super::distance(word), if distance < 512 { distance } else { 0 });
                }
            }
        }
    }

    #[test]
    fn scales_beyond_f32_have_no_grid() {
        assert!(grid(&Aabb { min: [-3e38; 3], max: [3e38; 3] }).is_none());
        let thin = grid(&Aabb { min: [0.0; 3], max: [1e-40, 1.0, 8e37] }).unwrap();
        assert!(thin.scale.iter().chain(&thin.unscale).all(|x| x.is_normal()));
        assert!(grid(&Aabb { min: [0.0; 3], max: [0.0, 1.0, 1.0] }).is_some());
    }
}
