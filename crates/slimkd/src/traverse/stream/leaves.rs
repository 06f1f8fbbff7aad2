//! Work that the walk leaves behind: leaves to read, pairs of ray and triangle to test.

use super::LEAVES_AT;
use super::answers::Answers;
use super::slots::{SLOTS, Slots};
use super::triangles::test;
use crate::traverse::arch::Simd;
use crate::tree::LaneNodes;

/// Room for leaves: those that wait, and a step's of all groups; compressing writes 16 more.
const LEAF_ROOM: usize = LEAVES_AT + SLOTS + 16;
/// Room for pairs: fewer than 16 that wait, a step's T-references of all groups, and 16 more.
const PAIR_ROOM: usize = 16 + SLOTS + 16;

/// The work in waiting.
pub(super) struct Queue {
    leaves: usize,
    slot: [u32; LEAF_ROOM],
    address: [u32; LEAF_ROOM],

    pairs: usize,
    pair_slot: [u32; PAIR_ROOM],
    pair_triangle: [u32; PAIR_ROOM],
}

impl Queue {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let none = [0; LEAF_ROOM];
        Self {
            leaves: 0,
            slot: none,
            address: none,
            pairs: 0,
            pair_slot: [0; PAIR_ROOM],
            pair_triangle: [0; PAIR_ROOM],
        }
    }

    #[inline(always)]
    pub(super) fn push_leaves<S: Simd>(&mut self, s: S, which: S::M, slots: S::U, address: S::U) {
        let at = self.leaves;
        s.compress(which, address, &mut self.address[at..]);
        self.leaves += s.compress(which, slots, &mut self.slot[at..]);
    }

    #[inline(always)]
    pub(super) fn push_pairs<S: Simd>(&mut self, s: S, which: S::M, slot: S::U, triangle: S::U) {
        let at = self.pairs;
        s.compress(which, slot, &mut self.pair_slot[at..]);
        self.pairs += s.compress(which, triangle, &mut self.pair_triangle[at..]);
    }

    /// Reads leaves and tests pairs as long as 16 of them wait; with `all`, until nothing waits.
    ///
    /// One loop with one place for each kind of work, because all of it is inlined: called where it is wanted, it made
    /// the crate compile six times as long.
    #[inline(always)]
    pub(super) fn work<S: Simd, N: LaneNodes, A: Answers>(
        &mut self,
        s: S,
        nodes: N,
        slots: &mut Slots,
        all: bool,
    ) {
        let least = if all { 1 } else { LEAVES_AT };
        let mut slot = s.u32s(0);
        let mut reading = None;
        loop {
            if self.pairs < 16 {
                if let Some(leaves) = &mut reading {
                    let (has, triangle) = nodes.next(s, leaves);
                    if s.any(has) {
                        self.push_pairs(s, has, slot, triangle);
                    } else {
                        reading = None;
                    }
                    continue;
                }
                if self.leaves >= least {
                    let count = self.leaves.min(16);
                    self.leaves -= count;
                    slot = s.load_u32(&self.slot[self.leaves..]);
                    let valid = s.mask((1 << count) - 1);
                    reading = Some(nodes.open(s, valid, &self.address[self.leaves..]));
                    continue;
                }
                if !all || self.pairs == 0 {
                    return;
                }
            }
            let count = self.pairs.min(16);
            self.pairs -= count;
            let slot = s.load_u32(&self.pair_slot[self.pairs..]);
            let triangle = s.load_u32(&self.pair_triangle[self.pairs..]);
            test::<S, N, A>(s, nodes, slots, slot, triangle, count);
        }
    }
}
