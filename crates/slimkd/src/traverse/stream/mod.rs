//! Streams: a ray a lane, for rays that go anywhere.
//!
//! Source: none that does the same. A ray a lane with refilled lanes is how GPUs trace (Aila & Laine 2009, *Understanding
//! the Efficiency of Ray Traversal on GPUs*, persistent threads); collecting leaf work until it fills vectors follows the
//! idea of Tsakok 2009 (*Faster Incoherent Rays: Multi-BVH Ray Stream Tracing*).
//!
//! 32 rays are in flight, in two groups of 16 lanes that take turns. In a turn each ray visits one node (`walk.rs`). A ray
//! that meets a leaf leaves it in a queue and goes on with what its stack has. When 16 leaves wait they are read, one after
//! the other, into pairs of a ray and a triangle; 16 pairs are one triangle test (`leaves.rs`, `triangles.rs`). When enough
//! rays have ended, all that waits is done, their answers are given, and new rays take their places (`slots.rs`,
//! `prepare.rs`).
//!
//! Why the hits are those of the single kernel, to the last bit
//! 1. Every node that the single kernel visits is visited: the decisions at a split are the same, in the same f32
//!    operations. Going on before a leaf is tested means a later limit, never an earlier one.
//! 2. A ray is over when the entry on top of its stack begins behind its limit by more than entries may overlap: the
//!    width of two slabs, and what rounding adds (`margin`, three times the ray's widest one, gives `cut`).
//! 3. The triangle test is `Sheared`'s, f32 rejection and f64 decision, operation by operation. Which of two hits is
//!    nearer does not depend on the order in which they come: equal t goes to the lowest id.

mod answers;
mod leaves;
mod prepare;
mod slots;
mod triangles;
mod walk;

pub(crate) use answers::Answers;

use super::{RayConditions, Traced};
use crate::geometry::Ray;
use crate::layout::{Address, LaneNodes};
use crate::simd::{Kernel, Simd};
use leaves::Queue;
use prepare::Prepared;
use slots::{SLOTS, Slots};
use walk::Stack;

/// Slots without a ray that make it worth while to stop for new ones.
const REFILL_AT: u32 = 8;
/// Leaves that are worth reading together.
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
    /// `None` where lanes cannot address the tree.
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
            let idle = !slots.walking();
            let more = !ready.is_empty() || next < self.rays.len();
            let refill = idle.count_ones() >= REFILL_AT && (more || idle == !0);
            // An answer is known when nothing of its ray waits any more.
            queue.work::<S, N, A>(s, nodes, &self.conditions, &mut slots, refill);
            if refill {
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
            for group in 0..SLOTS / 16 {
                walk::step::<S, N>(s, nodes, group, &mut slots, &mut stack, &mut queue);
            }
        }
    }
}
