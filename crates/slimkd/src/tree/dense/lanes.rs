//! A dense tree read by 16 lanes.

use super::leaf::read_codes;
use super::view::DenseView;
use super::word;
use crate::traverse::Simd;
use crate::tree::lanes::{LaneNodes, LaneStep};

/// Leaves in reading.
pub(crate) struct Leaves<S: Simd> {
    codes: S::U,
    left: S::U,
    /// The next id, and how many more are its successors.
    next: S::U,
    run: S::U,
}

impl LaneNodes for DenseView<'_> {
    const T_REFERENCES: bool = false;
    type Leaves<S: Simd> = Leaves<S>;

    fn fit_lanes(self) -> bool {
        self.mesh.fits_lanes()
    }

    #[inline(always)]
    fn fetch<S: Simd>(self, s: S, addresses: &[u32]) -> (S::U, S::U) {
        // SAFETY: a node of a proven tree lies before the padding, so 8 bytes from there are inside.
        unsafe { s.load_pairs::<1>(self.bytes.as_ptr(), addresses) }
    }

    #[inline(always)]
    fn decode<S: Simd>(self, s: S, address: S::U, (lower, upper): (S::U, S::U)) -> LaneStep<S> {
        let near = word::lanes_distance(s, lower);
        let far = s.eq_u32(near, s.u32s(0));
        let size = s.select_u32(far, s.u32s(8), s.u32s(4));
        let (count, _, _) = self.code.lanes(s, lower);
        let axis = lower & s.u32s(word::LEAF);
        LaneStep {
            leaf: s.eq_u32(axis, s.u32s(word::LEAF)),
            filled: s.lt_u32(s.u32s(0), count),
            axis,
            split: word::lanes_split(s, lower),
            left: address + size,
            stride: s.select_u32(far, upper, near) - size,
        }
    }

    #[inline(always)]
    fn t_references<S: Simd>(self, s: S, _: S::M, _: (S::U, S::U)) -> (S::M, S::U) {
        (s.mask(0), s.u32s(0))
    }

    #[inline(always)]
    fn open<S: Simd>(self, s: S, valid: S::M, addresses: &[u32]) -> Leaves<S> {
        let address = s.load_u32(addresses);
        let (count, first, many) = self.code.lanes(s, self.fetch(s, addresses).0);
        let many = many & valid;
        let mut codes = address + s.u32s(self.code.header_bytes);
        let mut left = count;
        if s.any(many) {
            // SAFETY: the address of a node is read where there is no count behind the header, else that count.
            let after =
                unsafe { s.gather_pairs::<1>(self.bytes.as_ptr(), s.select_u32(many, codes, s.u32s(0))).0 };
            left = s.select_u32(many, after, left);
            codes = s.select_u32(many, codes + s.u32s(4), codes);
        }
        let none = s.u32s(0);
        Leaves {
            codes: s.select_u32(valid, codes, none),
            left: s.select_u32(valid, left, none),
            next: s.select_u32(valid, first, none),
            run: s.u32s(1),
        }
    }

    #[inline(always)]
    fn next<S: Simd>(self, s: S, leaves: &mut Leaves<S>) -> (S::M, S::U) {
        let (none, one) = (s.u32s(0), s.u32s(1));
        let has = s.lt_u32(none, leaves.left);
        let id = leaves.next;
        leaves.left = s.select_u32(has, leaves.left - one, none);
        leaves.run = leaves.run - one;
        let more = s.lt_u32(none, leaves.left);
        leaves.next = s.select_u32(more, id + one, none);
        let ended = more & s.eq_u32(leaves.run, none);
        if s.any(ended) {
            // SAFETY: a leaf with triangles left has a code there; elsewhere the root is read.
            let (lower, upper) =
                unsafe { s.gather_pairs::<1>(self.bytes.as_ptr(), s.select_u32(ended, leaves.codes, none)) };
            let (gap, run, size) = read_codes(s, lower, upper);
            leaves.next = s.select_u32(ended, leaves.next + gap, leaves.next);
            leaves.run = s.select_u32(ended, run, leaves.run);
            leaves.codes = s.select_u32(ended, leaves.codes + size, leaves.codes);
        }
        (has, id)
    }

    #[inline(always)]
    fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        self.mesh.lane_corners(s, triangle)
    }
}
