//! The 8-byte node, bit by bit. Nothing else in the crate knows where a bit lives.
//!
//! Sources: Wald 2004, *Realtime Ray Tracing and Interactive Global Illumination*, §7.2, for the 8-byte node; Choi,
//! Chang & Ihm 2013, "Compact Node Layouts", for type-II inner nodes, T-reference nodes and the 2-byte leaf mode
//! (A = `011`, E = `01`, F pointer, H count, I shared upper 16 bits).
//!
//! ```text
//!                bit 63 ........................ 32 31 ................... 3 2 1 0
//! inner, type I  | split position, f32             | index of the child pair | 0axis |
//! inner, type II | split position, f32             | index of the child pair | 1axis |
//! leaf, 4-byte   | 00 | count, 30 bits             | F: first 32-bit index   | 0 1 1 |
//! leaf, 2-byte   | 01 | H: 14 bits | I: 16 bits    | F: first 16-bit index   | 0 1 1 |
//! T-reference    | 0, 32 bits                      | triangle id, 32 bits            |
//! ```
//!
//! Children of one node stand side by side, left first. A type-II node's T-reference follows its child pair, so it
//! needs no pointer of its own. The root is node 0.
//!
//! Deviation: the slides show the field widths of the 2-byte leaf only; the rest of the order is ours.

use crate::layout::Damage;
use crate::simd::Simd;

/// Entries that the 29-bit pointers can address: nodes, 4-byte indices, 2-byte indices.
pub(crate) const POINTER_LIMIT: u64 = 1 << 29;
/// References that a 4-byte leaf can count.
pub(crate) const COUNT_LIMIT_4BYTE: u64 = 1 << 30;
/// References that a 2-byte leaf can count.
pub(crate) const COUNT_LIMIT_2BYTE: usize = (1 << 14) - 1;

const KIND_LEAF: u64 = 0b011;
const KIND_TYPE_II: u64 = 0b100;
const MODE_2BYTE: u64 = 0b01;

/// What 8 bytes say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Node {
    Inner { axis: usize, split: f32, children: u32, t_reference: bool },
    Leaf4 { first: u32, count: u32 },
    Leaf2 { first: u32, count: u32, upper: u32 },
}

/// An encoded node. Fields are read straight from the bits: hot loops use these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub(crate) struct Packed(pub(crate) u64);

impl Packed {
    #[inline(always)]
    pub(crate) fn is_leaf(self) -> bool {
        self.0 & 0b11 == KIND_LEAF
    }

    /// Of an inner node.
    #[inline(always)]
    pub(crate) fn axis(self) -> usize {
        (self.0 & 0b11) as usize
    }

    /// Of an inner node.
    #[inline(always)]
    pub(crate) fn has_t_reference(self) -> bool {
        self.0 & KIND_TYPE_II != 0
    }

    /// Of an inner node.
    #[inline(always)]
    pub(crate) fn split(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }

    /// Index of the left child, or of a leaf's first entry.
    #[inline(always)]
    pub(crate) fn pointer(self) -> u32 {
        self.0 as u32 >> 3
    }

    /// Of a leaf.
    #[inline(always)]
    pub(crate) fn is_2byte(self) -> bool {
        self.0 >> 62 == MODE_2BYTE
    }

    /// Of a 4-byte leaf.
    #[inline(always)]
    pub(crate) fn count_4byte(self) -> u32 {
        (self.0 >> 32) as u32 & 0x3fff_ffff
    }

    /// Of a 2-byte leaf.
    #[inline(always)]
    pub(crate) fn count_2byte(self) -> u32 {
        (self.0 >> 48) as u32 & 0x3fff
    }

    /// Of a 2-byte leaf: the shared upper half of its ids, in place.
    #[inline(always)]
    pub(crate) fn upper(self) -> u32 {
        ((self.0 >> 32) as u32 & 0xffff) << 16
    }

    /// Of a T-reference node.
    #[inline(always)]
    pub(crate) fn triangle(self) -> u32 {
        self.0 as u32
    }

    /// As [`Packed::is_leaf`], of lower halves.
    #[inline(always)]
    pub(super) fn lanes_leaf<S: Simd>(s: S, lower: S::U) -> S::M {
        s.eq_u32(lower & s.u32s(0b11), s.u32s(KIND_LEAF as u32))
    }

    /// As [`Packed::has_t_reference`], of lower halves.
    #[inline(always)]
    pub(super) fn lanes_t_reference<S: Simd>(s: S, lower: S::U) -> S::M {
        s.eq_u32(lower & s.u32s(KIND_TYPE_II as u32), s.u32s(KIND_TYPE_II as u32))
    }

    pub(crate) fn t_reference(triangle: u32) -> Self {
        Self(u64::from(triangle))
    }

    /// The fields must be within the limits above; the encoder checks them once for the whole tree.
    pub(crate) fn encode(node: Node) -> Self {
        let pointer = |index: u32| {
            debug_assert!(u64::from(index) < POINTER_LIMIT);
            u64::from(index) << 3
        };
        Self(match node {
            Node::Inner { axis, split, children, t_reference } => {
                let kind = axis as u64 | if t_reference { KIND_TYPE_II } else { 0 };
                u64::from(split.to_bits()) << 32 | pointer(children) | kind
            }
            Node::Leaf4 { first, count } => u64::from(count) << 32 | pointer(first) | KIND_LEAF,
            Node::Leaf2 { first, count, upper } => {
                MODE_2BYTE << 62
                    | u64::from(count) << 48
                    | u64::from(upper) << 16
                    | pointer(first)
                    | KIND_LEAF
            }
        })
    }

    /// Every bit pattern decodes or is refused: reserved bits must be clear.
    pub(crate) fn decode(self) -> Result<Node, Damage> {
        if !self.is_leaf() {
            let (axis, split, children) = (self.axis(), self.split(), self.pointer());
            if !split.is_finite() {
                return Err(Damage("a split plane is not finite".into()));
            }
            return Ok(Node::Inner { axis, split, children, t_reference: self.has_t_reference() });
        }
        match (self.0 & 0b111, self.0 >> 62) {
            (KIND_LEAF, 0) => Ok(Node::Leaf4 { first: self.pointer(), count: self.count_4byte() }),
            (KIND_LEAF, MODE_2BYTE) => {
                Ok(Node::Leaf2 { first: self.pointer(), count: self.count_2byte(), upper: self.upper() })
            }
            _ => Err(Damage("a leaf of unknown mode".into())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_survives_the_round_trip() {
        let last = POINTER_LIMIT as u32 - 1;
        for node in [
            Node::Inner { axis: 0, split: -0.5, children: 1, t_reference: false },
            Node::Inner { axis: 2, split: 1e30, children: last, t_reference: true },
            Node::Leaf4 { first: last, count: (COUNT_LIMIT_4BYTE - 1) as u32 },
            Node::Leaf4 { first: 0, count: 0 },
            Node::Leaf2 { first: last, count: COUNT_LIMIT_2BYTE as u32, upper: 0xffff_0000 },
        ] {
            assert_eq!(Packed::encode(node).decode().unwrap(), node);
        }
    }

    #[test]
    fn the_slides_bits_of_a_2byte_leaf() {
        let bits = Packed::encode(Node::Leaf2 { first: 5, count: 3, upper: 0xabcd_0000 }).0;
        assert_eq!(bits & 0b111, 0b011, "A");
        assert_eq!(bits >> 62, 0b01, "E");
        assert_eq!(bits >> 3 & 0x1fff_ffff, 5, "F");
        assert_eq!(bits >> 48 & 0x3fff, 3, "H");
        assert_eq!(bits >> 32 & 0xffff, 0xabcd, "I");
    }

    #[test]
    fn damage_is_refused() {
        assert!(Packed(KIND_LEAF | 0b10 << 62).decode().is_err());
        assert!(Packed(KIND_LEAF | KIND_TYPE_II).decode().is_err());
        assert!(Packed(u64::from(f32::NAN.to_bits()) << 32).decode().is_err());
    }
}
