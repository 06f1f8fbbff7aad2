//! The walk with vectors. The head of `mod.rs` says why it loses no hit.

use crate::layout::{Address, Ids, LANES, STEP_BITS, WideNode, WideView};
use crate::simd::Simd;
use crate::traverse::counters::count;
use crate::traverse::prepared::PreparedRay;
use crate::traverse::sink::Sink;
use std::mem::MaybeUninit;

/// Children of a node that wait at most.
pub(super) const WAITING: usize = LANES - 1;

/// Children that wait: their node, and a child's distance with its lane, or lanes.
#[derive(Clone, Copy)]
pub(super) struct Waiting {
    node: Address,
    key: u32,
}

/// What stays the same along a ray.
pub(super) struct Walk<'a, V: Simd> {
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
    pub(super) fn new(s: V, nodes: WideView<'a>, ray: &'a PreparedRay) -> Self {
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
    pub(super) fn run<S: Sink>(&self, sink: &mut S, stack: &mut [MaybeUninit<Waiting>]) {
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
