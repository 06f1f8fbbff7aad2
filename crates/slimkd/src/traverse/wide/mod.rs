//! One ray at a time through wide nodes: a step is one ray against 16 child boxes.
//!
//! Sources: Wald, Benthin & Boulos 2008, *Getting Rid of Packets*; Ernst & Greiner 2008, for the test of all children at once.
//!
//! Deviations
//! 1. The ray's distances to the planes are `plane · (step · 1/d) + (low · 1/d − origin · 1/d ∓ width)`. Why no hit is lost: with M, the
//!    width and the slack of `prepared.rs`, a found hit point lies within `5·2⁻²⁴·M` of its triangle, and so of a box that holds the
//!    triangle there. Its t is rounded once more: 1. The origin in grid units is off by 5; its product with 1/d by 1, and 1/d itself by 1;
//!    `low · 1/d`, a distance of at most 2M, by 2; the sums by 1 and 3; `step · 1/d` is exact but for 1/d, the step being a power of two;
//!    `plane ·` that by 2, and the last sum by 1, all in units of 2⁻²⁴·M·|1/d|. These are 22 at most, and the width is 32 of them.
//!    So the near side of every such box is at most t, and its far side at least t, and no lane that holds the triangle is passed over.
//! 2. Rays whose widths are beyond 2¹⁰⁰, or that begin before t = 0, take [`walk_in_f64`], with f64: no value above can
//!    overflow, and distances order as their bits do.
//! 3. Pending children are kept with the distance at which the ray enters them, the lane in its four lowest bits: that is lower than
//!    the true distance, so nothing is dropped too early. Any-hit rays keep the lanes alone, and take them in their order.
//! 4. Four triangles are tested at once ([`Simd::quad`]). Of those that may be hit, f32 says how far at least and at most the hit is
//!    (`geometry/estimate.rs` has the bound and its proof). [`Shear::decide`] alone finds hits, in f64, but it is asked only for hits that
//!    f32 cannot order, and once at the end ([`Sink::consider`], [`Sink::settle`]).
//!
//! Batches go through wide nodes as streams (`stream.rs`) and as coherent groups (`group.rs`).
//!
//! [`Shear::decide`]: crate::geometry::Shear::decide

mod group;
mod in_f64;
mod kept;
mod leaf;
mod stream;
mod walk;

pub(crate) use in_f64::walk_in_f64;

use super::prepared::PreparedRay;
use super::sink::Sink;
use super::{LEAST_STREAM, RayConditions, Traced};
use crate::geometry::Ray;
use crate::layout::WideView;
use crate::simd::{InstructionSet, Kernel, Simd};
use kept::{Asking, Taking};
use std::mem::MaybeUninit;
use stream::WideStream;
use walk::{WAITING, Walk};

/// The deepest tree whose stack lies on the machine's stack.
const SMALL_DEPTH: usize = 24;
/// Widths up to here, and no distance overflows (deviation 2).
const MOST_WIDTH: f32 = (1u128 << 100) as f32;

/// Whether the walk with vectors takes a ray (deviation 2).
#[inline(always)]
fn is_plain(ray: &PreparedRay) -> bool {
    ray.enter >= 0.0 && ray.slack[0] < MOST_WIDTH && ray.slack[1] < MOST_WIDTH && ray.slack[2] < MOST_WIDTH
}

/// How one ray goes through a tree.
trait Way {
    /// Offers every triangle that the ray may hit to `sink`, nearer boxes first.
    fn walk(&self, tree: &Traced<'_, WideView<'_>>, ray: &PreparedRay, sink: &mut impl Sink);
}

/// With vectors.
struct ByLanes<V>(V);

impl<V: Simd> Way for ByLanes<V> {
    #[inline(always)]
    fn walk(&self, tree: &Traced<'_, WideView<'_>>, ray: &PreparedRay, sink: &mut impl Sink) {
        // By reference: a copy of what was just written would keep the processor waiting for it.
        let Traced { nodes, depth, .. } = tree;
        if !is_plain(ray) {
            return walk_in_f64(*nodes, ray, sink);
        }
        if (*depth as usize) < SMALL_DEPTH {
            Walk::new(self.0, nodes, ray).run(sink, &mut [MaybeUninit::uninit(); SMALL_DEPTH * WAITING]);
        } else {
            let mut stack = vec![MaybeUninit::uninit(); (*depth as usize + 1) * WAITING];
            Walk::new(self.0, nodes, ray).run(sink, &mut stack);
        }
    }
}

/// With numbers.
struct Exactly;

impl Way for Exactly {
    fn walk(&self, tree: &Traced<'_, WideView<'_>>, ray: &PreparedRay, sink: &mut impl Sink) {
        walk_in_f64(tree.nodes, ray, sink);
    }
}

/// One ray through a tree.
pub(crate) struct WideWalk<'a, S> {
    pub(crate) tree: Traced<'a, WideView<'a>>,
    pub(crate) ray: &'a Ray,
    pub(crate) sink: &'a mut S,
}

impl<S: Sink> WideWalk<'_, S> {
    /// With the best instructions; a walk that is measured, with the same ones everywhere.
    pub(crate) fn run_best(self) {
        let Self { tree, ray, sink } = self;
        if (S::MEASURED || InstructionSet::run_best(WideWalk { tree, ray, sink: &mut *sink }).is_none())
            && let Some(prepared) = PreparedRay::new(ray, tree.bounds, tree.nodes.grid())
        {
            Exactly.walk(&tree, &prepared, sink);
        }
    }
}

impl<S: Sink> Kernel for WideWalk<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        // Inside the kernel, so that it is prepared with the same instructions.
        if let Some(prepared) = PreparedRay::moved(self.ray, 0.0, self.tree.bounds, self.tree.nodes.grid()) {
            ByLanes(s).walk(&self.tree, &prepared, self.sink);
        }
    }
}

/// The answers of a batch in any order: as a stream, few rays one by one.
pub(crate) struct WideBatch<'a, A> {
    pub(crate) tree: Traced<'a, WideView<'a>>,
    pub(crate) rays: &'a [Ray],
    pub(crate) conditions: RayConditions<'a>,
    pub(crate) answers: A,
}

impl<A: Asking> WideBatch<'_, A> {
    pub(crate) fn run_with(mut self, set: InstructionSet) {
        let WideBatch { tree, rays, conditions, .. } = self;
        if rays.len() >= LEAST_STREAM
            && set.run(WideStream { tree, rays, conditions, answers: self.answers.reborrow() }).is_some()
        {
            return;
        }
        if set.run(WideBatch { tree, rays, conditions, answers: self.answers.reborrow() }).is_none() {
            self.walk_all(&Exactly);
        }
    }

    #[inline(always)]
    fn walk_all(mut self, way: &impl Way) {
        let (tree, conditions) = (&self.tree, &self.conditions);
        for (place, ray) in self.rays.iter().enumerate() {
            let mut kept = A::begin(ray.t_max, conditions.excepted(place));
            if let Some(prepared) = PreparedRay::new(ray, tree.bounds, tree.nodes.grid()) {
                if conditions.filter.is_none() {
                    way.walk(tree, &prepared, &mut kept);
                } else {
                    way.walk(tree, &prepared, &mut Taking { kept: &mut kept, place, conditions });
                }
            }
            self.answers.put(place, A::hit(&kept));
        }
    }
}

impl<A: Asking> Kernel for WideBatch<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        self.walk_all(&ByLanes(s));
    }
}
