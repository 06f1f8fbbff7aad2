//! Reads of a proven dense tree.

use super::leaf::{LONGEST_RUN, Leaf, LeafCode, read_code};
use super::{Dense, PADDING, word};
use crate::traverse::Planes;
use crate::tree::nodes::{Inner, MeshView, Nodes, Step};
use crate::tree::statistics::LeafMode;
use std::mem::MaybeUninit;

/// Ids of a leaf that are decoded at once: nearly every leaf is one piece.
const PIECE: usize = 64;

/// A proven tree's bytes and its mesh.
#[derive(Clone, Copy)]
pub(crate) struct DenseView<'a> {
    bytes: &'a [u8],
    code: LeafCode,
    planes: &'a Planes,
    mesh: MeshView<'a>,
}

impl<'a> DenseView<'a> {
    pub(in crate::tree) fn new(tree: &'a Dense, mesh: MeshView<'a>) -> Self {
        Self { bytes: &tree.bytes, code: tree.code, planes: &tree.planes, mesh }
    }

    #[inline(always)]
    fn word(&self, address: u32) -> u32 {
        self.long(address) as u32
    }

    #[inline(always)]
    fn long(&self, address: u32) -> u64 {
        debug_assert!(address as usize + PADDING <= self.bytes.len());
        // SAFETY: the address is a node's or a code's of a proven tree, so it lies before the padding, and 8 bytes from
        // there are inside. No alignment is claimed.
        u64::from_le(unsafe { self.bytes.as_ptr().add(address as usize).cast::<u64>().read_unaligned() })
    }
}

impl Nodes for DenseView<'_> {
    type Leaf = Leaf;

    #[inline(always)]
    fn node(self, address: u32) -> Step<Leaf> {
        let word = self.word(address);
        let axis = word & word::LEAF;
        if axis == word::LEAF {
            return Step::Leaf(self.code.leaf(address, word, |at| self.word(at)));
        }
        let near = word::distance(word);
        let (left, right) = if near != 0 {
            (address + 4, address + near)
        } else {
            (address + 8, address + self.word(address + 4))
        };
        let split = word::split(word);
        Step::Inner(Inner { axis: axis as usize, split, left, stride: right - left, t_reference: None })
    }

    #[inline(always)]
    fn triangles(self, leaf: Leaf, mut visit: impl FnMut(u32) -> bool) -> bool {
        let Leaf { mut codes, count, first } = leaf;
        // Ids are decoded ahead of their tests, a whole run at a time: one loop whose end is known, instead of one a run.
        let mut ids = [MaybeUninit::<u32>::uninit(); PIECE + LONGEST_RUN];
        ids[0].write(first);
        let (mut filled, mut next, mut left) = (1, first + 1, count as usize);
        while left > 0 {
            let end = left.min(PIECE);
            while filled < end {
                let (gap, run, size) = read_code(self.long(codes));
                next += gap;
                for k in 0..LONGEST_RUN {
                    ids[filled + k].write(next + k as u32);
                }
                (next, codes, filled) = (next + run, codes + size, filled + run as usize);
            }
            for id in &ids[..end] {
                // SAFETY: everything below `filled`, hence below `end`, was written.
                if visit(unsafe { id.assume_init() }) {
                    return true;
                }
            }
            // A run may reach over the piece's end.
            ids.copy_within(end..end + LONGEST_RUN, 0);
            (filled, left) = (filled - end, left - end);
        }
        false
    }

    fn mode(_: Leaf) -> LeafMode {
        LeafMode::Coded
    }

    #[inline(always)]
    fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        self.mesh.corners(triangle)
    }

    #[inline(always)]
    fn planes(self) -> Planes {
        *self.planes
    }
}
