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
//! 4. Four triangles are tested at once ([`Simd::quad`]). Those that may be hit are decided by [`Shear::decide`], as everywhere.
//!
//! [`Shear::decide`]: crate::geometry::Shear::decide

use super::counters::count;
use super::prepared::PreparedRay;
use super::sink::{Any, Closest, Filtered, Sink};
use super::{RayConditions, Traced};
use crate::geometry::{Hit, Ray};
use crate::layout::{Address, Ids, LANES, STEP_BITS, WideNode, WideNodes, WideView};
use crate::simd::{InstructionSet, Kernel, Simd};
use std::mem::MaybeUninit;

/// The deepest tree whose stack lies on the machine's stack.
const SMALL_DEPTH: usize = 24;
/// Children of a node that wait at most.
const WAITING: usize = LANES - 1;
/// Widths up to here, and no distance overflows (deviation 2).
const MOST_WIDTH: f32 = (1u128 << 100) as f32;

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
        let &Traced { nodes, depth, .. } = tree;
        let plain = ray.enter >= 0.0
            && ray.slack[0] < MOST_WIDTH
            && ray.slack[1] < MOST_WIDTH
            && ray.slack[2] < MOST_WIDTH;
        if !plain {
            return walk_in_f64(nodes, ray, sink);
        }
        if (depth as usize) < SMALL_DEPTH {
            Walk::new(self.0, nodes, ray).run(sink, &mut [MaybeUninit::uninit(); SMALL_DEPTH * WAITING]);
        } else {
            let mut stack = vec![MaybeUninit::uninit(); (depth as usize + 1) * WAITING];
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
    pub(crate) ray: &'a PreparedRay,
    pub(crate) sink: &'a mut S,
}

impl<S: Sink> WideWalk<'_, S> {
    /// With the best instructions; a walk that is measured, with the same ones everywhere.
    pub(crate) fn run_best(self) {
        let Self { tree, ray, sink } = self;
        if S::MEASURED || InstructionSet::run_best(WideWalk { tree, ray, sink: &mut *sink }).is_none() {
            Exactly.walk(&tree, ray, sink);
        }
    }
}

impl<S: Sink> Kernel for WideWalk<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        ByLanes(s).walk(&self.tree, self.ray, self.sink);
    }
}

/// The closest hits of a batch, ray by ray.
pub(crate) struct WideClosestHits<'a> {
    pub(crate) tree: Traced<'a, WideView<'a>>,
    pub(crate) rays: &'a [Ray],
    pub(crate) conditions: RayConditions<'a>,
    pub(crate) hits: &'a mut [Option<Hit>],
}

impl WideClosestHits<'_> {
    pub(crate) fn run_with(self, set: InstructionSet) {
        let Self { tree, rays, conditions, hits } = self;
        if set.run(WideClosestHits { tree, rays, conditions, hits: &mut *hits }).is_none() {
            WideClosestHits { tree, rays, conditions, hits }.walk_all(&Exactly);
        }
    }

    #[inline(always)]
    fn walk_all(self, way: &impl Way) {
        let (tree, conditions) = (&self.tree, &self.conditions);
        for (at, (ray, hit)) in self.rays.iter().zip(self.hits).enumerate() {
            *hit = None;
            let Some(prepared) = PreparedRay::new(ray, tree.bounds, tree.nodes.grid()) else { continue };
            let mut sink = Closest::new(ray.t_max, conditions.excepted(at));
            match conditions.filter {
                None => way.walk(tree, &prepared, &mut sink),
                Some(filter) => {
                    let accept = &mut |hit: &Hit| filter(conditions.first + at, hit);
                    way.walk(tree, &prepared, &mut Filtered { sink: &mut sink, accept });
                }
            }
            *hit = sink.into_hit();
        }
    }
}

impl Kernel for WideClosestHits<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        self.walk_all(&ByLanes(s));
    }
}

/// The answers of a batch of any-hit rays, ray by ray.
pub(crate) struct WideAnyHits<'a> {
    pub(crate) tree: Traced<'a, WideView<'a>>,
    pub(crate) rays: &'a [Ray],
    pub(crate) conditions: RayConditions<'a>,
    pub(crate) hits: &'a mut [bool],
}

impl WideAnyHits<'_> {
    pub(crate) fn run_with(self, set: InstructionSet) {
        let Self { tree, rays, conditions, hits } = self;
        if set.run(WideAnyHits { tree, rays, conditions, hits: &mut *hits }).is_none() {
            WideAnyHits { tree, rays, conditions, hits }.walk_all(&Exactly);
        }
    }

    #[inline(always)]
    fn walk_all(self, way: &impl Way) {
        let (tree, conditions) = (&self.tree, &self.conditions);
        for (at, (ray, hit)) in self.rays.iter().zip(self.hits).enumerate() {
            *hit = false;
            let Some(prepared) = PreparedRay::new(ray, tree.bounds, tree.nodes.grid()) else { continue };
            let mut sink = Any::new(ray.t_max, conditions.excepted(at));
            match conditions.filter {
                None => way.walk(tree, &prepared, &mut sink),
                Some(filter) => {
                    let accept = &mut |hit: &Hit| filter(conditions.first + at, hit);
                    way.walk(tree, &prepared, &mut Filtered { sink: &mut sink, accept });
                }
            }
            *hit = sink.found;
        }
    }
}

impl Kernel for WideAnyHits<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        self.walk_all(&ByLanes(s));
    }
}

/// Children that wait: their node, and a child's distance with its lane, or lanes.
#[derive(Clone, Copy)]
struct Waiting {
    node: Address,
    key: u32,
}

/// What stays the same along a ray.
struct Walk<'a, V: Simd> {
    s: V,
    nodes: WideView<'a>,
    ray: &'a PreparedRay,
    inverse: [V::F; 3],
    /// −origin · 1/d, less and plus the width.
    near: [V::F; 3],
    far: [V::F; 3],
    /// The planes of each axis that the ray meets first and last.
    first: [usize; 3],
    last: [usize; 3],
}

impl<'a, V: Simd> Walk<'a, V> {
    #[inline(always)]
    fn new(s: V, nodes: WideView<'a>, ray: &'a PreparedRay) -> Self {
        let (zero, mut first, mut last) = (s.f32s(0.0), [0; 3], [0; 3]);
        let (mut inverse, mut near, mut far) = ([zero; 3], [zero; 3], [zero; 3]);
        // Loops, since closures that are handed to functions fall out of the inline chain.
        for k in 0..3 {
            let up = (ray.descends[k] & 1) as usize;
            (first[k], last[k]) = (2 * k + up, 2 * k + 1 - up);
            let origin = -(ray.plane_origin[k] * ray.inverse[k]);
            inverse[k] = s.f32s(ray.inverse[k]);
            (near[k], far[k]) = (s.f32s(origin - ray.slack[k]), s.f32s(origin + ray.slack[k]));
        }
        Self { s, nodes, ray, inverse, near, far, first, last }
    }

    /// The children that the ray meets before `exit`, and where it enters each.
    #[inline(always)]
    fn meets(&self, node: &WideNode, enter: V::F, exit: V::F) -> (u32, V::F) {
        let s = self.s;
        let (mut near, mut far) = (enter, exit);
        for k in 0..3 {
            let (low, inverse) = (s.f32s(node.low[k]), self.inverse[k]);
            let step = s.cast_f32(s.u32s(node.steps[k]) & s.u32s(STEP_BITS)) * inverse;
            let first = s.load_u16(&node.planes[self.first[k]]);
            let last = s.load_u16(&node.planes[self.last[k]]);
            near = s.larger(s.bound_mul_add(first, step, s.bound_mul_add(low, inverse, self.near[k])), near);
            far = s.smaller(s.bound_mul_add(last, step, s.bound_mul_add(low, inverse, self.far[k])), far);
        }
        let children = (1u32 << node.children()) - 1;
        (s.bits(s.le(near, far)) & children, near)
    }

    #[inline(always)]
    fn run<S: Sink>(&self, sink: &mut S, stack: &mut [MaybeUninit<Waiting>]) {
        let (s, nodes, ray) = (self.s, self.nodes, self.ray);
        let mut top = 0;
        let mut at = Address::ROOT;
        // −0 would be larger than all other distances, by its bits.
        let enter = s.f32s(ray.enter + 0.0);
        let mut limit = ray.exit;
        let mut keys = [0u32; LANES];
        let lanes = s.load_u32(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
        count(|c| (c.rays, c.walks) = (c.rays + 1, c.walks + 1));
        loop {
            sink.visit();
            count(|c| {
                (c.nodes, c.ray_nodes, c.node_lanes) = (c.nodes + 1, c.ray_nodes + 1, c.node_lanes + 1)
            });
            // SAFETY: `at` is the root or an inner child of a node of this tree.
            let node = unsafe { nodes.node(at) };
            let (met, near) = self.meets(node, enter, s.f32s(limit));
            let (mut from, mut lane) = (node, 0);
            let mut found = met != 0;
            if found {
                // 1. The child to go to; the others wait, the nearest on top.
                lane = met.trailing_zeros() as usize;
                if met & (met - 1) != 0 {
                    if S::COHERENT {
                        stack[top].write(Waiting { node: at, key: met & (met - 1) });
                        top += 1;
                    } else {
                        let near = (s.cast_u32(near) & s.u32s(!(LANES as u32 - 1))) | lanes;
                        let met = s.compress(s.mask(met), near, &mut keys);
                        let nearest = order(&mut keys[..met]);
                        for &key in &keys[..met - 1] {
                            stack[top].write(Waiting { node: at, key });
                            top += 1;
                        }
                        lane = (nearest & (LANES as u32 - 1)) as usize;
                    }
                }
            }
            loop {
                // 2. Else the nearest one that waits and may hold something nearer than the best hit.
                while !found {
                    if top == 0 {
                        return;
                    }
                    // SAFETY: every entry below the top was written.
                    let waiting = unsafe { stack[top - 1].assume_init_mut() };
                    if S::COHERENT {
                        lane = waiting.key.trailing_zeros() as usize;
                        at = waiting.node;
                        waiting.key &= waiting.key - 1;
                        top -= usize::from(waiting.key == 0);
                        found = true;
                    } else {
                        top -= 1;
                        lane = (waiting.key & (LANES as u32 - 1)) as usize;
                        at = waiting.node;
                        found = f32::from_bits(waiting.key & !(LANES as u32 - 1)) <= limit;
                    }
                    // SAFETY: a node with waiting children is one of this tree.
                    from = unsafe { nodes.node(at) };
                }
                // 3. An inner child is the next node; a leaf's triangles are tested.
                if lane < from.inner() {
                    // SAFETY: the lane is that of an inner child.
                    at = unsafe { nodes.child(from, lane) };
                    break;
                }
                // SAFETY: the lane is that of a leaf.
                if unsafe { self.leaf(from, lane, sink) } {
                    return;
                }
                let limit_now = sink.limit() * ray.scale;
                limit = if limit_now < limit { limit_now } else { limit };
                found = false;
            }
        }
    }

    /// Tests the triangles of a leaf; `true` ends the walk.
    ///
    /// # Safety
    /// The node must come from this tree, and the lane must be that of a leaf.
    #[inline(always)]
    unsafe fn leaf<S: Sink>(&self, node: &WideNode, lane: usize, sink: &mut S) -> bool {
        let mut buffer = Ids::new();
        // SAFETY: the caller's promise.
        let ids = unsafe { self.nodes.ids(node, lane, &mut buffer) };
        let mut at = 0;
        while at < ids.len() {
            let (four, left) = (at, ids.len() - at);
            at += 4;
            let mut corners = [[std::ptr::null(); 3]; 4];
            for (k, corners) in corners.iter_mut().enumerate() {
                // Where there are fewer than four, the first one again. SAFETY: a leaf of this tree names triangles of the mesh.
                *corners =
                    unsafe { self.nodes.mesh.corner_pointers(ids[four + if k < left { k } else { 0 }]) };
            }
            let these = (1u32 << if left < 4 { left } else { 4 }) - 1;
            // SAFETY: these are corners.
            let mut may_hit = unsafe { self.s.quad(&self.ray.shear, &corners) } & these;
            count(|c| {
                (c.triangles, c.ray_triangles, c.triangle_lanes) =
                    (c.triangles + 1, c.ray_triangles + u64::from(these.count_ones()), c.triangle_lanes + 4);
            });
            for _ in 0..these.count_ones() {
                sink.test();
            }
            while may_hit != 0 {
                let id = ids[four + may_hit.trailing_zeros() as usize];
                may_hit &= may_hit - 1;
                if sink.knows(id) {
                    continue;
                }
                // SAFETY: a leaf of this tree names the triangle.
                let corners = unsafe { self.nodes.mesh.corners(id) };
                if self.ray.hand_over(self.ray.shear.decide(&corners), id, sink) {
                    return true;
                }
            }
        }
        false
    }
}

/// Brings keys into descending order; returns the last, which is the least.
#[inline(always)]
fn order(keys: &mut [u32]) -> u32 {
    let count = keys.len();
    for i in 1..count {
        let key = keys[i];
        let mut j = i;
        while j > 0 && keys[j - 1] < key {
            keys[j] = keys[j - 1];
            j -= 1;
        }
        keys[j] = key;
    }
    keys[count - 1]
}

/// The walk in f64: for rays that the other one does not take, since no value overflows; for trees that are not proved; and where there
/// are no vectors.
#[inline(never)]
pub(crate) fn walk_in_f64(nodes: impl WideNodes, ray: &PreparedRay, sink: &mut impl Sink) {
    let mut pending = vec![(Address::ROOT, f64::NEG_INFINITY)];
    // Lanes that the ray meets, and where it enters them.
    let mut met: Vec<(usize, f64)> = Vec::with_capacity(LANES);
    while let Some((at, enter)) = pending.pop() {
        let limit = f64::from(sink.limit()) * f64::from(ray.scale);
        if enter > limit {
            continue;
        }
        sink.visit();
        // SAFETY: pending addresses are the root and inner children of nodes of this tree.
        let node = unsafe { nodes.read(at) };
        met.clear();
        for lane in 0..node.children() {
            let (mut near, mut far) = (f64::from(ray.enter), f64::from(ray.exit).min(limit));
            for k in 0..3 {
                let step = f64::from(f32::from_bits(node.steps[k] & STEP_BITS));
                let along = |plane: usize| {
                    let place = f64::from(node.low[k]) + f64::from(node.planes[2 * k + plane][lane]) * step;
                    (place - f64::from(ray.plane_origin[k])) * f64::from(ray.inverse[k])
                };
                let (a, b) = (along(0), along(1));
                let (first, last) = if ray.descends[k] == 0 { (a, b) } else { (b, a) };
                // A width that is infinite, or a distance that is none, bounds nothing.
                let width = f64::from(ray.slack[k]);
                (near, far) = (near.max(first - width), far.min(last + width));
            }
            if near <= far {
                met.push((lane, near));
            }
        }
        met.sort_by(|a, b| a.1.total_cmp(&b.1));
        // Leaves first, the nearest of them first: they shorten the walk. Then the nearest inner child, which is pushed last.
        for &(lane, _) in met.iter().filter(|&&(lane, _)| lane >= node.inner()) {
            let mut buffer = Ids::new();
            // SAFETY: the lane is that of a leaf.
            for &id in unsafe { nodes.ids(&node, lane, &mut buffer) } {
                if sink.knows(id) {
                    continue;
                }
                sink.test();
                // SAFETY: a leaf of this tree names the triangle.
                let corners = unsafe { nodes.corners(id) };
                if let Some(done) = sink.decide(&corners, id) {
                    if done {
                        return;
                    }
                    continue;
                }
                if ray.hand_over(ray.shear.decide(&corners), id, sink) {
                    return;
                }
            }
        }
        for &(lane, near) in met.iter().rev().filter(|&&(lane, _)| lane < node.inner()) {
            // SAFETY: the lane is that of an inner child.
            pending.push((unsafe { nodes.child(&node, lane) }, near));
        }
    }
}
