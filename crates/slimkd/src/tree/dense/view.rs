//! Reads of a proven dense tree.

use super::leaf::{LONGEST_RUN, Leaf, LeafCode, read_code};
use super::{Dense, PADDING, word};
use crate::traverse::Planes;
use crate::tree::nodes::{Ids, Inner, MeshView, Nodes, PIECE, SPILL, Step};
use crate::tree::statistics::LeafMode;

const _: () = assert!(LONGEST_RUN <= SPILL, "a run may begin at the last id of a piece");

/// A proven tree's bytes and its mesh.
#[derive(Clone, Copy)]
pub(crate) struct DenseView<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) code: LeafCode,
    planes: &'a Planes,
    pub(super) mesh: MeshView<'a>,
}

impl<'a> DenseView<'a> {
    pub(in crate::tree) fn new(tree: &'a Dense, mesh: MeshView<'a>) -> Self {
        Self { bytes: &tree.bytes, code: tree.code, planes: &tree.planes, mesh }
    }

    /// Takes ids off a leaf until [`PIECE`] are taken: how many. Calls `run` with a place and the id to write there and seven
    /// more behind it: a whole run at once, whatever its length; the next ones write over what is too much.
    #[inline(always)]
    pub(super) fn spell(self, leaf: &mut Leaf, mut write: impl FnMut(usize, u32)) -> usize {
        let Leaf { mut codes, mut left, mut next, mut run } = *leaf;
        let mut filled = 0;
        while left > 0 && filled < PIECE {
            write(filled, next);
            (filled, next, left) = (filled + run as usize, next + run, left - run);
            if left > 0 {
                let (gap, length, size) = read_code(self.long(codes));
                (next, run, codes) = (next + gap, length, codes + size);
            }
        }
        *leaf = Leaf { codes, left, next, run };
        filled
    }

    #[inline(always)]
    pub(super) fn word(&self, address: u32) -> u32 {
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
    fn take<'b>(self, leaf: &mut Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b,
    {
        let filled = self.spell(leaf, |at, first| {
            for k in 0..SPILL {
                buffer.0[at + k].write(first + k as u32);
            }
        });
        // SAFETY: all before `filled` were written.
        unsafe { buffer.written(filled) }
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
