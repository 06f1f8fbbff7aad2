//! Streams: one ray in each lane, for rays in any order.
//!
//! Source: none that does the same. One ray in each lane, with lanes that are refilled, is how GPUs trace (Aila & Laine 2009,
//! *Understanding the Efficiency of Ray Traversal on GPUs*, persistent threads); collecting leaf work until it fills vectors follows the
//! idea of Tsakok 2009 (*Faster Incoherent Rays: Multi-BVH Ray Stream Tracing*).
//!
//! 32 rays are in flight, in two groups of 16 lanes that take turns. In a turn each ray visits one node (`walk.rs`). A ray
//! that meets a leaf puts it into a queue and goes on with the top of its stack. When 16 leaves wait, they are read, one after
//! the other, into pairs of a ray and a triangle, and 16 pairs are tested at once (`leaves.rs`, `triangles.rs`). When enough
//! rays have ended, all work in the queue is done, the answers of these rays are given, and new rays take their places
//! (`slots.rs`, `prepare.rs`).
//!
//! Why the hits are those of the single kernel, to the last bit
//! 1. Every node that the single kernel visits is visited: the decisions at a split are the same, in the same f32
//!    operations. A ray that goes on before its leaf is tested has a limit that is too far, never one that is too near.
//! 2. A ray ends when the entry on top of its stack begins behind `cut`. The entries below lie behind it, but may overlap it by
//!    two slacks and rounding. So `cut` is the ray's limit plus `margin`, three times its widest slack: no entry that is
//!    dropped begins before the limit.
//! 3. The triangle test is `Sheared`'s, f32 rejection and f64 decision, operation by operation. Which of two hits is
//!    nearer does not depend on the order in which they come: equal t goes to the lowest id.

mod answers;
mod leaves;
mod prepare;
mod slots;
mod triangles;
mod walk;

pub(crate) use answers::Answers;
pub(super) use prepare::Prepared;

use super::{RayConditions, Traced};
use crate::geometry::Ray;
use crate::layout::{Address, LaneNodes};
use crate::simd::{Kernel, Simd};
use leaves::Queue;
use slots::{SLOTS, Slots};
use walk::Stack;

/// The number of idle slots from which on the walk stops to fill them with new rays.
const REFILL_AT: u32 = 8;
/// The number of waiting leaves from which on they are read.
const LEAVES_AT: usize = 16;

/// A batch of rays on its way through a tree.
///
/// The tree's [`LaneNodes::fit_lanes`] must hold.
pub(crate) struct Stream<'a, N, A> {
    pub(super) tree: Traced<'a, N>,
    pub(super) rays: &'a [Ray],
    pub(super) conditions: RayConditions<'a>,
    pub(super) answers: A,
}

impl<'a, N: LaneNodes, A: Answers> Stream<'a, N, A> {
    /// `None` where lanes cannot address the tree, because it is too small or too large.
    pub(crate) fn new(
        tree: Traced<'a, N>,
        rays: &'a [Ray],
        conditions: RayConditions<'a>,
        answers: A,
    ) -> Option<Self> {
        tree.nodes.fit_lanes().then_some(Self { tree, rays, conditions, answers })
    }
}

impl<N: LaneNodes, A: Answers> Kernel for Stream<'_, N, A> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(mut self, s: S) {
        let Traced { nodes, depth, bounds } = self.tree;
        let planes = nodes.planes();
        // SAFETY: the tree fits lanes, and its root stands at this address.
        let root = unsafe { nodes.fetch(s, &[Address::ROOT.get(); 16]) };
        let mut stack = Stack::new(depth);
        let mut slots = Slots::new(&stack);
        let mut queue = Queue::new();
        let mut ready = Prepared::new();
        let mut next = 0;
        loop {
            // 1. Stop for new rays when enough slots are idle and rays are left, and when every slot is idle.
            let idle = !slots.walking();
            let more = !ready.is_empty() || next < self.rays.len();
            let refill = idle.count_ones() >= REFILL_AT && (more || idle == !0);
            // 2. Do the work in the queue: all of it before answers are given, as an answer is known only when nothing of its ray waits.
            queue.work::<S, N, A>(s, nodes, &self.conditions, &mut slots, refill);
            if refill {
                // 3. Give the answers of rays that have ended, and fill both groups as far as rays are left.
                slots.retire(&mut self.answers);
                let mut group = 0;
                while group < SLOTS / 16 {
                    if slots.live[group] == 0xffff {
                        group += 1;
                    } else if !ready.is_empty() {
                        slots.fill(s, group, &mut ready, root);
                    } else if next < self.rays.len() {
                        ready.load(s, self.rays, next, bounds, &planes, &mut self.answers);
                        next += 16;
                    } else {
                        break;
                    }
                }
                if slots.walking() == 0 {
                    return;
                }
            }
            // 4. Every ray visits one node.
            for group in 0..SLOTS / 16 {
                walk::step::<S, N>(s, nodes, group, &mut slots, &mut stack, &mut queue);
            }
        }
    }
}
