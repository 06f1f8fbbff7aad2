//! The dense layout: 4-byte inner nodes and byte-coded leaves in one run of bytes, in preorder.
//!
//! Sources: planes on a grid after Segovia & Ernst, *Memory Efficient Ray Tracing with Hierarchical Mesh Quantization*,
//! 2010, for the idea that traversal bounds may be coarse as long as they are conservative; the byte code of gaps and
//! runs is the usual one of inverted indexes.
//!
//! ```text
//!                    bit 31 .............. 11 10 ........ 2 1 0
//! inner              | P: plane, 21 bits     | D: 9 bits   |axis|   left child at +4, right child at +D
//! inner, far         | P: plane, 21 bits     | 0           |axis|   then D as u32; left child at +8
//! leaf               first byte ends in 11; see `leaf.rs`; an empty leaf is that one byte
//! ```
//!
//! A node stands at any byte, little-endian; children follow their parent, left first; the root is at 0. What a pruned
//! tree spends: 4 bytes an inner node (1 to 2 % need 8), 3 a leaf, and well below one a reference, because files keep
//! neighbours together: 40 to 75 % of a leaf's ids are the next id.
//!
//! Why quantised planes lose nothing: a traversal treats every plane as a slab (`traverse/prepared.rs`), which is
//! widened here by the grid's cell. Which triangles a leaf holds was decided with the exact plane. So hits are the same
//! to the last bit, and a ray descends into one child too many only when it crosses within a cell of the plane.

mod checked;
mod encode;
mod lanes;
mod leaf;
mod validate;
mod view;
mod word;

pub(crate) use checked::CheckedDense;
use encode::fits;
pub(crate) use encode::{encode, holds, size};
pub(crate) use validate::validate;
pub(crate) use view::DenseView;
pub(super) use word::grid;

use leaf::LeafCode;

/// Bytes behind the last node, so that reading 8 bytes at any node stays inside.
const PADDING: usize = 8;

/// The encoded tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dense {
    /// Nodes, then [`PADDING`] zeros.
    pub(crate) bytes: Vec<u8>,
    /// Bytes of it that code ids beyond the first of each leaf; a figure for reports.
    pub(crate) index_bytes: u64,
    code: LeafCode,
    planes: crate::layout::Planes,
}

impl Dense {
    /// What others read the bytes by.
    pub(crate) fn view(&self) -> super::EncodedTree<'_> {
        let (header_bytes, count_bits, id_mask) = self.code.widths();
        let crate::layout::Planes { low, scale, unscale, cell, .. } = self.planes;
        let cell = unscale.map(|unscale| cell * unscale);
        super::EncodedTree::Dense { bytes: &self.bytes, header_bytes, count_bits, id_mask, low, scale, cell }
    }

    /// Bytes that hold nothing.
    pub(crate) fn padding(&self) -> u64 {
        PADDING as u64
    }
}
