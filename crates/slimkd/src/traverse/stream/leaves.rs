//! The queue of work that the walk leaves behind: leaves to read, and pairs of a ray and a triangle to test.

use super::LEAVES_AT;
use super::answers::Answers;
use super::slots::{SLOTS, Slots};
use super::triangles::test;
use crate::layout::{Address, LaneNodes, MOST_IDS, SPILL};
use crate::simd::Simd;
use crate::traverse::RayConditions;

/// Room for the leaves that wait and those that one step of every slot adds; `compress` may write 16 more behind these.
const LEAF_ROOM: usize = LEAVES_AT + SLOTS + 16;
/// Once so many pairs wait, some are tested before another leaf is read.
const MANY: usize = 128;
/// Room for these pairs, the ids that are taken off a leaf at once, and one more vector.
const PAIR_ROOM: usize = MANY + MOST_IDS + SPILL + 16;

/// The work that waits.
pub(super) struct Queue {
    /// How many leaves wait; of each, the slot of the ray that met it, and its address.
    leaves: usize,
    slot: [u32; LEAF_ROOM],
    address: [u32; LEAF_ROOM],

    /// How many pairs wait; of each, the slot of the ray, and the triangle.
    pairs: usize,
    pair_slot: [u32; PAIR_ROOM],
    pair_triangle: [u32; PAIR_ROOM],
}

impl Queue {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let (leaf, pair) = ([0; LEAF_ROOM], [0; PAIR_ROOM]);
        Self { leaves: 0, slot: leaf, address: leaf, pairs: 0, pair_slot: pair, pair_triangle: pair }
    }

    /// Adds the leaves at the addresses in the lanes of `which`.
    #[inline(always)]
    pub(super) fn push_leaves<S: Simd>(&mut self, s: S, which: S::M, slots: S::U, address: S::U) {
        let at = self.leaves;
        s.compress(which, address, &mut self.address[at..]);
        self.leaves += s.compress(which, slots, &mut self.slot[at..]);
    }

    /// Adds the pairs in the lanes of `which`.
    #[inline(always)]
    pub(super) fn push_pairs<S: Simd>(&mut self, s: S, which: S::M, slot: S::U, triangle: S::U) {
        let at = self.pairs;
        s.compress(which, slot, &mut self.pair_slot[at..]);
        self.pairs += s.compress(which, triangle, &mut self.pair_triangle[at..]);
    }

    /// Does nothing while fewer than 16 leaves and fewer than 16 pairs wait. Else it reads all leaves, and tests pairs as long as there
    /// are 16 of them. With `all`, it goes on until nothing waits.
    ///
    /// One loop has one place for each kind of work, because all of it is inlined: with a call in several places, the crate took
    /// six times as long to compile.
    #[inline(always)]
    pub(super) fn work<S: Simd, N: LaneNodes, A: Answers>(
        &mut self,
        s: S,
        nodes: N,
        conditions: &RayConditions<'_>,
        slots: &mut Slots,
        all: bool,
    ) {
        if self.leaves < LEAVES_AT && self.pairs < 16 && !all {
            return;
        }
        // How many leaves have been read, and the next one where a part of its ids has been taken.
        let mut read = 0;
        let mut reading: Option<N::Leaf> = None;
        loop {
            // 1. Read leaves into pairs.
            while self.pairs < MANY {
                let mut leaf = match reading {
                    Some(leaf) => leaf,
                    // SAFETY: only leaves of this tree are pushed.
                    None if read < self.leaves => unsafe { nodes.leaf(Address::new(self.address[read])) },
                    None => break,
                };
                let to = &mut self.pair_triangle[self.pairs..];
                let Some(to) = to.first_chunk_mut() else { break };
                // SAFETY: the leaf comes from this tree.
                let taken = unsafe { nodes.write(&mut leaf, to) };
                let slot = s.u32s(self.slot[read]);
                let mut at = 0;
                while at < taken {
                    s.store_u32(slot, &mut self.pair_slot[self.pairs + at..]);
                    at += 16;
                }
                self.pairs += taken;
                if N::is_taken(&leaf) {
                    reading = None;
                    read += 1;
                } else {
                    reading = Some(leaf);
                }
            }
            // 2. Test 16 pairs at a time; at the very end, fewer.
            let rest = all && read == self.leaves;
            let mut tested = 0;
            loop {
                let count = (self.pairs - tested).min(16);
                if count < 16 && !(rest && count > 0) {
                    break;
                }
                let valid = s.mask((1 << count) - 1);
                let slot = s.load_u32(&self.pair_slot[tested..]);
                let triangle = s.load_u32(&self.pair_triangle[tested..]);
                // Lanes behind the last pair hold any value: they get triangle 0, and `test` ignores them by `count`.
                let triangle = s.select_u32(valid, triangle, s.u32s(0));
                // SAFETY: the tree fits lanes. The slots and triangles of pairs were pushed or come from leaves of this tree, and
                // 0 is a triangle too, since a mesh that fits lanes has one.
                unsafe { test::<S, N, A>(s, nodes, conditions, slots, slot, triangle, count) };
                tested += count;
            }
            // 3. Move the pairs that are left, fewer than 16, to the front.
            let slot = s.load_u32(&self.pair_slot[tested..]);
            let triangle = s.load_u32(&self.pair_triangle[tested..]);
            s.store_u32(slot, &mut self.pair_slot);
            s.store_u32(triangle, &mut self.pair_triangle);
            self.pairs -= tested;
            if read == self.leaves {
                self.leaves = 0;
                return;
            }
        }
    }
}
