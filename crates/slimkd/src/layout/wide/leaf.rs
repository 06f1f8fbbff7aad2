//! A wide tree's leaf: a header with the count and the first id, then the codes of `layout/runs.rs`.
//!
//! ```text
//! header, 3 or 4 bytes   | first id: 19 or 27 bits | count − 1: 5 bits |
//! ```
//! Three bytes where the mesh has at most 2¹⁹ triangles. Leaves are never empty.

use crate::layout::runs::{LONGEST_RUN, code_size, for_each_code, read_code, write_code};
use crate::layout::{Ids, MOST_IDS, SPILL};
use crate::plan::MOST;

const COUNT_BITS: u32 = 5;
/// Triangles that a header can name.
pub(super) const TRIANGLE_LIMIT: u64 = 1 << (32 - COUNT_BITS);

const _: () = assert!(MOST == 1 << COUNT_BITS && MOST <= MOST_IDS && LONGEST_RUN <= SPILL);

/// How all leaves of one tree are written; it follows from the number of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LeafCode {
    header_bytes: u32,
}

impl LeafCode {
    pub(crate) fn new(triangles: usize) -> Self {
        Self { header_bytes: if triangles <= 1 << (24 - COUNT_BITS) { 3 } else { 4 } }
    }

    /// Bytes of a header.
    pub(crate) fn header_bytes(self) -> u32 {
        self.header_bytes
    }

    /// Appends a leaf of ascending ids.
    pub(super) fn write(self, out: &mut Vec<u8>, ids: &[u32]) {
        let header = ids[0] << COUNT_BITS | (ids.len() as u32 - 1);
        out.extend_from_slice(&header.to_le_bytes()[..self.header_bytes as usize]);
        for_each_code(ids[0], &ids[1..], |gap, run| write_code(out, gap, run));
    }

    /// Bytes of what [`LeafCode::write`] appends.
    pub(crate) fn size(self, ids: &[u32]) -> u64 {
        let mut size = self.header_bytes.into();
        for_each_code(ids[0], &ids[1..], |gap, _| size += code_size(gap));
        size
    }

    /// The first id, the count and the bytes of the header that begins these 8 bytes.
    #[inline(always)]
    pub(super) fn header(self, long: u64) -> (u32, u32, u32) {
        let header = long as u32 & (u32::MAX >> (32 - 8 * self.header_bytes));
        (header >> COUNT_BITS, (header & ((1 << COUNT_BITS) - 1)) + 1, self.header_bytes)
    }

    /// The ids of the leaf at `at`; `long` reads 8 bytes there. They lie in `buffer`, and three more of any value may be read.
    #[inline(always)]
    pub(crate) fn read(self, at: u32, buffer: &mut Ids, long: impl Fn(u32) -> u64) -> usize {
        let (first, count, header_bytes) = self.header(long(at));
        let count = count as usize;
        buffer.0[0].write(first);
        let mut next = first.wrapping_add(1);
        let (mut filled, mut codes) = (1, at + header_bytes);
        while filled < count {
            let (gap, run, size) = read_code(long(codes));
            next = next.wrapping_add(gap);
            buffer.write_run(filled, next);
            (filled, next, codes) = (filled + run as usize, next.wrapping_add(run), codes + size);
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read() {
        let mut state = 7u64;
        let mut below = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        for triangles in [40, 1 << 19, (1 << 19) + 1, 1 << 27] {
            let code = LeafCode::new(triangles);
            for _ in 0..500 {
                let mut ids: Vec<u32> = (0..1 + below(MOST as u64))
                    .map(|_| {
                        let reach = [40, 400, triangles as u64][below(3) as usize];
                        below(reach.min(triangles as u64)) as u32
                    })
                    .collect();
                ids.sort_unstable();
                ids.dedup();
                let mut bytes = vec![0; 3];
                code.write(&mut bytes, &ids);
                assert_eq!(code.size(&ids), bytes.len() as u64 - 3);
                bytes.extend_from_slice(&[0; 8]);
                let long =
                    |at: u32| u64::from_le_bytes(bytes[at as usize..at as usize + 8].try_into().unwrap());
                let mut buffer = Ids::new();
                let count = code.read(3, &mut buffer, long);
                // SAFETY: that many were written.
                assert_eq!(unsafe { buffer.written(count) }, ids);
            }
        }
    }
}
