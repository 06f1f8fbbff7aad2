//! `shaders/plain.wgsl` and `dense.wgsl` in Rust.

use super::Twin;

/// An inner node: axis, plane, children, T-reference.
pub(super) struct Inner {
    pub(super) axis: usize,
    pub(super) split: f32,
    pub(super) left: u32,
    pub(super) right: u32,
    pub(super) triangle: Option<u32>,
}

impl Twin<'_> {
    pub(super) fn word(&self, at: u32) -> u32 {
        self.image.words.get(at as usize).copied().unwrap_or(0)
    }

    fn bytes_at(&self, address: u32) -> u32 {
        let at = self.image.params.nodes + (address >> 2);
        let shift = (address & 3) * 8;
        let low = self.word(at);
        if shift == 0 { low } else { low >> shift | self.word(at + 1) << (32 - shift) }
    }

    /// The lower half of a node, which says whether it is a leaf.
    pub(super) fn lower(&self, address: u32) -> u32 {
        if self.image.dense {
            self.bytes_at(address)
        } else {
            self.word(self.image.params.nodes + 2 * address)
        }
    }

    pub(super) fn inner(&self, address: u32, lower: u32) -> Inner {
        let axis = (lower & 3) as usize;
        if self.image.dense {
            let split = f32::from_bits(lower >> 9 | 0x3f80_0000);
            let near = lower >> 2 & 0x1ff;
            let (left, right) = match near {
                0 => (address + 8, address + self.bytes_at(address + 4)),
                near => (address + 4, address + near),
            };
            return Inner { axis, split, left, right, triangle: None };
        }
        let params = &self.image.params;
        let split = f32::from_bits(self.word(params.nodes + 2 * address + 1));
        let left = lower >> 3;
        let triangle = (lower & 4 != 0).then(|| self.word(params.nodes + 2 * (left + 2)));
        Inner { axis, split, left, right: left + 1, triangle }
    }

    /// Calls `visit` with the leaf's ids; `true` ends it.
    pub(super) fn leaf(&self, address: u32, lower: u32, visit: impl FnMut(u32) -> bool) {
        if self.image.dense {
            self.dense_leaf(address, lower, visit)
        } else {
            self.plain_leaf(address, lower, visit)
        }
    }

    fn plain_leaf(&self, address: u32, lower: u32, mut visit: impl FnMut(u32) -> bool) {
        let params = &self.image.params;
        let upper = self.word(params.nodes + 2 * address + 1);
        let first = lower >> 3;
        if upper >> 30 != 1 {
            let count = upper & 0x3fff_ffff;
            let _ = (first..first + count).any(|at| visit(self.word(params.indices_4byte + at)));
            return;
        }
        let count = upper >> 16 & 0x3fff;
        let _ = (first..first + count).any(|at| {
            let pair = self.word(params.indices_2byte + (at >> 1));
            visit(upper << 16 | pair >> ((at & 1) * 16) & 0xffff)
        });
    }

    fn dense_leaf(&self, address: u32, lower: u32, mut visit: impl FnMut(u32) -> bool) {
        let params = &self.image.params;
        let many = (1 << params.count_bits) - 1;
        let mut left = lower >> 2 & many;
        let mut next = lower >> (2 + params.count_bits) & params.id_mask;
        let mut codes = address + params.header_bytes;
        if left == many {
            left = self.bytes_at(codes);
            codes += 4;
        }
        let mut run = 1;
        while left > 0 {
            if visit(next) {
                return;
            }
            (left, run, next) = (left - 1, run - 1, next + 1);
            if run == 0 && left > 0 {
                let code = self.bytes_at(codes);
                let (gap, size) = match code >> 3 & 31 {
                    29 => (29 + (code >> 8 & 0xff), 2),
                    30 => (code >> 8 & 0xffff, 3),
                    31 => (self.bytes_at(codes + 1), 5),
                    gap => (gap, 1),
                };
                next += gap;
                run = (code & 7) + 1;
                codes += size;
            }
        }
    }

    pub(super) fn vertex(&self, index: u32) -> [f32; 3] {
        self.floats(self.image.params.vertices + 3 * index)
    }

    /// Three words as floats.
    pub(super) fn floats(&self, at: u32) -> [f32; 3] {
        self.triple(at).map(f32::from_bits)
    }

    #[cfg(feature = "render")]
    pub(super) fn float(&self, at: u32) -> f32 {
        f32::from_bits(self.word(at))
    }

    pub(super) fn corners(&self, triangle: u32) -> [[f32; 3]; 3] {
        self.triple(self.image.params.triangles + 3 * triangle).map(|v| self.vertex(v))
    }

    pub(super) fn triple(&self, at: u32) -> [u32; 3] {
        [self.word(at), self.word(at + 1), self.word(at + 2)]
    }
}
