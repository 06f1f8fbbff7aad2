//! A plain tree read by 16 lanes.

use super::layout::Packed;
use super::view::PlainView;
use crate::traverse::Simd;
use crate::tree::lanes::{LaneNodes, LaneStep};

/// Leaves in reading.
pub(crate) struct Leaves<S: Simd> {
    is_2byte: S::M,
    /// Position of the next id in its array.
    at: S::U,
    left: S::U,
    upper: S::U,
}

impl LaneNodes for PlainView<'_> {
    const T_REFERENCES: bool = true;
    type Leaves<S: Simd> = Leaves<S>;

    fn fit_lanes(self) -> bool {
        // A 2-byte index is read as half of a pair.
        self.indices_2byte.len() != 1 && self.mesh.fits_lanes()
    }

    #[inline(always)]
    fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U) {
        // SAFETY: addresses of a proven tree lie inside the array; a node is 8 bytes.
        unsafe { s.load_pairs::<8>(self.nodes.as_ptr().cast(), addresses) }
    }

    #[inline(always)]
    fn decode<S: Simd>(self, s: S, _: S::U, (lower, upper): (S::U, S::U)) -> LaneStep<S> {
        let leaf = Packed::lanes_leaf(s, lower);
        let (_, count, _) = Packed::lanes_mode(s, upper);
        LaneStep {
            leaf,
            filled: s.lt_u32(s.u32s(0), count),
            axis: lower & s.u32s(0b11),
            split: s.cast_f32(upper),
            left: lower >> 3,
            stride: s.u32s(1),
        }
    }

    #[inline(always)]
    fn t_references<S: Simd>(self, s: S, inner: S::M, (lower, _): (S::U, S::U)) -> (S::M, S::U) {
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
    fn open<S: Simd>(self, s: S, valid: S::M, addresses: &[u32]) -> Leaves<S> {
        let (lower, upper) = self.fetch(s, addresses);
        let (is_2byte, count, shared) = Packed::lanes_mode(s, upper);
        let left = s.select_u32(valid, count, s.u32s(0));
        Leaves { is_2byte, at: lower >> 3, left, upper: shared }
    }

    #[inline(always)]
    fn next<S: Simd>(self, s: S, leaves: &mut Leaves<S>) -> (S::M, S::U) {
        let Leaves { is_2byte, at, left, upper } = *leaves;
        let (none, one) = (s.u32s(0), s.u32s(1));
        let has = s.lt_u32(none, left);
        let (narrow, wide) = (has & is_2byte, has & !is_2byte);
        let mut id = none;
        if s.any(wide) {
            let at = s.select_u32(wide, at, none);
            // SAFETY: a proven tree's leaf ranges lie inside the array, which is not empty if any leaf uses it.
            id = s.select_u32(wide, unsafe { s.gather_u32::<4>(self.indices_4byte.as_ptr().cast(), at) }, id);
        }
        if s.any(narrow) {
            // The pair that ends with it; the first of all is read as the lower half of the first pair.
            let at = s.select_u32(narrow, at, none);
            let first = s.eq_u32(at, none);
            let pair = s.select_u32(first, none, at - one);
            // SAFETY: as above; the array has at least two entries, see `fit_lanes`.
            let pair = unsafe { s.gather_u32::<2>(self.indices_2byte.as_ptr().cast(), pair) };
            let low = s.select_u32(first, pair & s.u32s(0xffff), pair >> 16);
            id = s.select_u32(narrow, upper | low, id);
        }
        leaves.at = at + one;
        leaves.left = s.select_u32(has, left - one, none);
        (has, id)
    }

    #[inline(always)]
    fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        self.mesh.lane_corners(s, triangle)
    }
}
