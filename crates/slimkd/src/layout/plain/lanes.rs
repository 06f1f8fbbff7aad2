//! A plain tree read by 16 lanes.

use super::layout::Packed;
use super::view::{Leaf, PlainView};
use crate::layout::lanes::{LaneNodes, LaneStep};
use crate::layout::nodes::LeafMode;
use crate::layout::nodes::{Address, PIECE, SPILL};
use crate::simd::Simd;

/// Ids that are taken off a leaf at once.
const VECTOR: usize = 16;

// SAFETY: lanes decode the same bits as `Nodes` does, of a proved tree.
unsafe impl LaneNodes for PlainView<'_> {
    const T_REFERENCES: bool = true;

    fn fit_lanes(self) -> bool {
        self.mesh.fits_lanes()
    }

    #[inline(always)]
    unsafe fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U) {
        // SAFETY: addresses of a proven tree lie inside the array; a node is 8 bytes.
        unsafe { s.load_pairs::<8>(self.nodes.as_ptr().cast(), addresses) }
    }

    #[inline(always)]
    fn decode<S: Simd>(self, s: S, _: S::U, (lower, upper): (S::U, S::U)) -> LaneStep<S> {
        let leaf = Packed::lanes_leaf(s, lower);
        let left = lower >> 3;
        LaneStep {
            leaf,
            filled: s.lt_u32(s.u32s(0), upper),
            axis: lower & s.u32s(0b11),
            split: s.cast_f32(upper),
            left,
            right: left + s.u32s(1),
        }
    }

    #[inline(always)]
    unsafe fn t_references<S: Simd>(self, s: S, inner: S::M, (lower, _): (S::U, S::U)) -> (S::M, S::U) {
        let has = inner & Packed::lanes_t_reference(s, lower);
        if !s.any(has) {
            return (has, s.u32s(0));
        }
        // The slot behind the children; lanes without one read the root.
        let slot = s.select_u32(has, (lower >> 3) + s.u32s(2), s.u32s(0));
        // SAFETY: a proven tree's T-reference slots and root lie inside the array, below 2³¹.
        let triangle = unsafe { s.gather_u32::<8>(self.nodes.as_ptr().cast(), slot) };
        (has, s.select_u32(has, triangle, s.u32s(0)))
    }

    #[inline(always)]
    unsafe fn leaf(self, address: Address) -> Leaf {
        // SAFETY: the caller says that a leaf of this tree stands there.
        Leaf::new(unsafe { self.packed(address.get()) })
    }

    #[inline(always)]
    fn is_taken(leaf: &Leaf) -> bool {
        leaf.left == 0
    }

    #[inline(always)]
    unsafe fn write(self, leaf: &mut Leaf, to: &mut [u32; PIECE + SPILL]) -> usize {
        let Leaf { first, left, upper, mode } = *leaf;
        let taken = left.min(VECTOR as u32);
        if mode == LeafMode::FourByte {
            copy(self.indices_4byte, first as usize, left as usize, to, |id| id);
        } else {
            copy(self.indices_2byte, first as usize, left as usize, to, |id| upper | u32::from(id));
        }
        (leaf.first, leaf.left) = (first + taken, left - taken);
        taken as usize
    }

    #[inline(always)]
    unsafe fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        // SAFETY: the caller says so.
        unsafe { self.mesh.lane_corners(s, triangle) }
    }
}

/// Writes the ids from `first` on, at most a vector of the `left` ones: a whole vector at once where the array goes on that far,
/// since a loop over a few costs more.
#[inline(always)]
fn copy<T: Copy>(ids: &[T], first: usize, left: usize, to: &mut [u32; PIECE + SPILL], id: impl Fn(T) -> u32) {
    debug_assert!(first + left <= ids.len());
    if let Some(whole) = ids.get(first..first + VECTOR) {
        for k in 0..VECTOR {
            to[k] = id(whole[k]);
        }
    } else {
        for k in 0..left.min(VECTOR) {
            to[k] = id(ids[first + k]);
        }
    }
}
