//! Reads of a proven dense tree.

use super::leaf::{Leaf, LeafCode};
use super::{Dense, PADDING, word};
use crate::layout::Planes;
use crate::layout::mesh::MeshView;
use crate::layout::nodes::LeafMode;
use crate::layout::nodes::{Address, Ids, Inner, MOST_IDS, Nodes, SPILL, Step};
use crate::layout::runs::{LONGEST_RUN, read_code};

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
    pub(crate) fn new(tree: &'a Dense, mesh: MeshView<'a>) -> Self {
        Self { bytes: &tree.bytes, code: tree.code, planes: &tree.planes, mesh }
    }

    /// Takes ids off a leaf until [`MOST_IDS`] are taken: how many. Calls `run` with a place and the id to write there and seven
    /// more behind it: a whole run at once, whatever its length; the next ones write over what is too much.
    ///
    /// # Safety
    /// The leaf must come from this tree.
    #[inline(always)]
    pub(super) unsafe fn spell(self, leaf: &mut Leaf, mut write: impl FnMut(usize, u32)) -> usize {
        let Leaf { mut codes, mut left, mut next, mut run } = *leaf;
        let mut filled = 0;
        while left > 0 && filled < MOST_IDS {
            write(filled, next);
            (filled, next, left) = (filled + run as usize, next + run, left - run);
            if left > 0 {
                // SAFETY: of a proved tree, a leaf that has ids left has a code here.
                let (gap, length, size) = read_code(unsafe { self.long(codes) });
                (next, run, codes) = (next + gap, length, codes + size);
            }
        }
        *leaf = Leaf { codes, left, next, run };
        filled
    }

    /// The four bytes from an address on.
    ///
    /// # Safety
    /// A node, a leaf or a part of them must begin there.
    #[inline(always)]
    pub(super) unsafe fn word(&self, address: u32) -> u32 {
        // SAFETY: the caller says so.
        unsafe { self.long(address) as u32 }
    }

    /// The eight bytes from an address on.
    ///
    /// # Safety
    /// A node, a leaf or a part of them must begin there.
    #[inline(always)]
    unsafe fn long(&self, address: u32) -> u64 {
        debug_assert!(address as usize + PADDING <= self.bytes.len());
        // SAFETY: such an address lies before the padding, so 8 bytes from there are inside. No alignment is claimed.
        u64::from_le(unsafe { self.bytes.as_ptr().add(address as usize).cast::<u64>().read_unaligned() })
    }
}

// SAFETY: a proved tree's distances lead to nodes, and its ids name triangles of the mesh.
unsafe impl Nodes for DenseView<'_> {
    type Leaf = Leaf;

    #[inline(always)]
    unsafe fn node(self, address: Address) -> Step<Leaf> {
        let address = address.get();
        // SAFETY: the caller says that a node of this tree stands there; a far distance follows its node, and a long leaf's count
        // its header.
        let word_at = |at| unsafe { self.word(at) };
        let word = word_at(address);
        let axis = word & word::LEAF;
        if axis == word::LEAF {
            return Step::Leaf(self.code.leaf(address, word, word_at));
        }
        let near = word::distance(word);
        let (left, right) = if near != 0 {
            (address + 4, address + near)
        } else {
            (address + 8, address + word_at(address + 4))
        };
        // SAFETY: of a proved tree, both children stand there.
        Step::Inner(unsafe { Inner::new(axis as usize, word::split(word), left, right - left, None) })
    }

    #[inline(always)]
    unsafe fn take<'b>(self, leaf: &mut Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b,
    {
        let write = |at: usize, first: u32| {
            for k in 0..SPILL {
                buffer.0[at + k].write(first + k as u32);
            }
        };
        // SAFETY: the caller says that the leaf comes from this tree.
        let filled = unsafe { self.spell(leaf, write) };
        // SAFETY: all before `filled` were written.
        unsafe { buffer.written(filled) }
    }

    fn mode(_: Leaf) -> LeafMode {
        LeafMode::Coded
    }

    #[inline(always)]
    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        // SAFETY: the caller says that this tree names the triangle.
        unsafe { self.mesh.corners(triangle) }
    }

    #[inline(always)]
    fn planes(self) -> Planes {
        *self.planes
    }
}
