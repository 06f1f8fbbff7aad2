//! A leaf's bytes: a header with the count and the first id, then gaps and runs.
//!
//! ```text
//! header, 3 or 4 bytes   | first id: `id_bits` | count: `count_bits` | 1 1 |    count 0: one byte, nothing follows
//!                        count at its maximum: the true count follows as u32
//! ```
//! The first id is a run of 1; the codes that follow are those of `layout/runs.rs`. The count ends the leaf.

use super::word::LEAF;
use crate::layout::runs::{code_size, for_each_code, write_code};

/// Most bits of the count: they must lie in the first byte, which stands alone where a leaf is empty.
const COUNT_BITS: u32 = 6;
/// Triangles that a header can name.
pub(super) const TRIANGLE_LIMIT: u64 = 1 << 27;

/// Field widths of all leaves of one tree; they follow from the number of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LeafCode {
    pub(super) header_bytes: u32,
    count_bits: u32,
    id_mask: u32,
}

/// A leaf in reading: where its codes start, and what the header said.
#[derive(Clone, Copy)]
pub(crate) struct Leaf {
    pub(super) codes: u32,
    /// Ids still to come.
    pub(super) left: u32,
    /// The next of them, and how many follow it without a gap, itself included.
    pub(super) next: u32,
    pub(super) run: u32,
}

impl LeafCode {
    /// For ids below `triangles`, at most [`TRIANGLE_LIMIT`].
    pub(super) fn new(triangles: usize) -> Self {
        let id_bits = (triangles.max(2) - 1).ilog2() + 1;
        let header_bytes = if id_bits <= 19 { 3 } else { 4 };
        let count_bits = COUNT_BITS.min(8 * header_bytes - 2 - id_bits);
        Self { header_bytes, count_bits, id_mask: (1 << id_bits) - 1 }
    }

    /// Bytes of the header, bits of its count, mask of its first id.
    pub(super) fn widths(self) -> (u32, u32, u32) {
        (self.header_bytes, self.count_bits, self.id_mask)
    }

    /// The largest count, which says that the true one follows.
    #[inline(always)]
    fn many(self) -> u32 {
        (1 << self.count_bits) - 1
    }

    /// The count's bits in a header's word.
    #[inline(always)]
    pub(super) fn count_mask(self) -> u32 {
        self.many() << 2
    }

    /// Reads the header that starts with `word` at `address`; `next` reads a u32 at an address.
    #[inline(always)]
    pub(super) fn leaf(self, address: u32, word: u32, next: impl FnOnce(u32) -> u32) -> Leaf {
        let count = word >> 2 & self.many();
        let first = word >> (2 + self.count_bits) & self.id_mask;
        let codes = address + self.header_bytes;
        if count == self.many() {
            return Leaf { codes: codes + 4, left: next(codes), next: first, run: 1 };
        }
        Leaf { codes, left: count, next: first, run: 1 }
    }

    /// Appends a leaf of ascending ids.
    pub(super) fn write(self, out: &mut Vec<u8>, ids: &[u32]) {
        let Some((&first, rest)) = ids.split_first() else {
            out.push(LEAF as u8);
            return;
        };
        let count = (ids.len() as u32).min(self.many());
        let header = first << (2 + self.count_bits) | count << 2 | LEAF;
        out.extend_from_slice(&header.to_le_bytes()[..self.header_bytes as usize]);
        if count == self.many() {
            out.extend_from_slice(&(ids.len() as u32).to_le_bytes());
        }
        for_each_code(first, rest, |gap, run| write_code(out, gap, run));
    }

    /// Bytes of what [`LeafCode::write`] appends.
    pub(super) fn size(self, ids: &[u32]) -> u64 {
        let Some((&first, rest)) = ids.split_first() else { return 1 };
        let counted = if ids.len() as u32 >= self.many() { 4 } else { 0 };
        let mut size = u64::from(self.header_bytes) + counted;
        for_each_code(first, rest, |gap, _| size += code_size(gap));
        size
    }
}
