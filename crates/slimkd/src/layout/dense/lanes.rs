//! A dense tree read by 16 lanes.

use super::leaf::Leaf;
use super::view::DenseView;
use super::word;
use crate::layout::lanes::{LaneNodes, LaneStep};
use crate::layout::nodes::{Address, PIECE, SPILL};
use crate::simd::Simd;

// SAFETY: lanes decode the same bits as `Nodes` does, of a proved tree.
unsafe impl LaneNodes for DenseView<'_> {
    const T_REFERENCES: bool = false;

    fn fit_lanes(self) -> bool {
        self.mesh.fits_lanes()
    }

    #[inline(always)]
    unsafe fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U) {
        // SAFETY: a node of a proven tree lies before the padding, so 8 bytes from there are inside.
        unsafe { s.load_pairs::<1>(self.bytes.as_ptr(), addresses) }
    }

    #[inline(always)]
    fn decode<S: Simd>(self, s: S, address: S::U, (lower, upper): (S::U, S::U)) -> LaneStep<S> {
        let near = word::lanes_distance(s, lower);
        let far = s.eq_u32(near, s.u32s(0));
        let axis = lower & s.u32s(word::LEAF);
        LaneStep {
            leaf: s.eq_u32(axis, s.u32s(word::LEAF)),
            filled: s.lt_u32(s.u32s(0), lower & s.u32s(self.code.count_mask())),
            axis,
            split: word::lanes_split(s, lower),
            left: address + s.select_u32(far, s.u32s(8), s.u32s(4)),
            right: address + s.select_u32(far, upper, near),
        }
    }

    #[inline(always)]
    unsafe fn t_references<S: Simd>(self, s: S, _: S::M, _: (S::U, S::U)) -> (S::M, S::U) {
        (s.mask(0), s.u32s(0))
    }

    #[inline(always)]
    unsafe fn leaf(self, address: Address) -> Leaf {
        let address = address.get();
        // SAFETY: the caller says that a leaf of this tree stands there; a long leaf's count follows its header.
        let word_at = |at| unsafe { self.word(at) };
        self.code.leaf(address, word_at(address), word_at)
    }

    #[inline(always)]
    fn is_taken(leaf: &Leaf) -> bool {
        leaf.left == 0
    }

    #[inline(always)]
    unsafe fn write(self, leaf: &mut Leaf, to: &mut [u32; PIECE + SPILL]) -> usize {
        let write = |at: usize, first: u32| {
            for k in 0..SPILL {
                to[at + k] = first + k as u32;
            }
        };
        // SAFETY: the caller says that the leaf comes from this tree.
        unsafe { self.spell(leaf, write) }
    }

    #[inline(always)]
    unsafe fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        // SAFETY: the caller says so.
        unsafe { self.mesh.lane_corners(s, triangle) }
    }
}
