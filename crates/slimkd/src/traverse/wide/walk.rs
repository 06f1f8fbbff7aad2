//! The walk with vectors. The head of `mod.rs` says why it loses no hit.

use crate::layout::{Address, Ids, LANES, STEP_BITS, WideNode, WideView};
use crate::simd::{Four, Quad, Simd};
use crate::traverse::counters::count;
use crate::traverse::prepared::PreparedRay;
use crate::traverse::sink::Sink;
use std::hint::black_box;
use std::mem::MaybeUninit;

/// Children of a node that wait at most.
pub(super) const WAITING: usize = LANES - 1;

/// Children that wait: a child's distance with its lane, or lanes; and the address of their node.
pub(super) type Waiting = [u32; 2];

/// What stays the same along a ray.
pub(super) struct Walk<'a, V: Simd> {
    s: V,
    nodes: &'a WideView<'a>,
    ray: &'a PreparedRay,
    frame: V::Frame,
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
    pub(super) fn new(s: V, nodes: &'a WideView<'a>, ray: &'a PreparedRay) -> Self {
        let (slack, distance) = (Four::new(ray.slack), Four::new(ray.plane_origin) * Four::new(ray.inverse));
        let starts = (Four::all(0.0) - distance - slack).lanes();
        let ends = (Four::all(0.0) - distance + slack).lanes();
        let (zero, mut first, mut last) = (s.f32s(0.0), [0; 3], [0; 3]);
        let (mut inverse, mut near, mut far) = ([zero; 3], [zero; 3], [zero; 3]);
        // Loops, since closures that are handed to functions fall out of the inline chain.
        for k in 0..3 {
            let up = (ray.descends[k] & 1) as usize;
            (first[k], last[k]) = (2 * k + up, 2 * k + 1 - up);
            (inverse[k], near[k], far[k]) = (s.f32s(ray.inverse[k]), s.f32s(starts[k]), s.f32s(ends[k]));
        }
        // The compiler would compute with the one number that all lanes hold, and spread each result: a step a number, where reading it
        // spread from the node costs nothing.
        let inverse = black_box(inverse);
        let frame = s.frame(&ray.shear);
        Self { s, nodes, ray, frame, inverse, near, far, first, last }
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
        let mut quad = Quad::new();
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
                        stack[top].write([met & (met - 1), at.get()]);
                        top += 1;
                    } else {
                        let near = (s.cast_u32(near) & s.u32s(!(LANES as u32 - 1))) | lanes;
                        debug_assert!(top + LANES <= stack.len());
                        // SAFETY: a tree of this depth leaves room for all children of a node.
                        let nearest = unsafe {
                            s.least_and_others(met, near, at.get(), stack.as_mut_ptr().add(top).cast())
                        };
                        top += met.count_ones() as usize - 1;
                        lane = (nearest & (LANES as u32 - 1)) as usize;
                    }
                }
            }
            loop {
                // 2. Else the nearest one that waits and may hold something nearer than the best hit.
                while !found {
                    if top == 0 {
                        sink.settle(ray, &self.nodes.mesh);
                        return;
                    }
                    // SAFETY: there is an entry below the top, and it was written.
                    let waiting = unsafe { stack.get_unchecked_mut(top - 1).assume_init_mut() };
                    let [key, node] = *waiting;
                    if S::COHERENT {
                        lane = key.trailing_zeros() as usize;
                        waiting[0] = key & (key - 1);
                        top -= usize::from(waiting[0] == 0);
                        found = true;
                    } else {
                        top -= 1;
                        lane = (key & (LANES as u32 - 1)) as usize;
                        found = f32::from_bits(key & !(LANES as u32 - 1)) <= limit;
                    }
                    // SAFETY: a node with waiting children is one of this tree.
                    from = unsafe { nodes.node(Address::new(node)) };
                }
                // 3. An inner child is the next node; a leaf's triangles are tested.
                if lane < from.inner() {
                    // SAFETY: the lane is that of an inner child.
                    at = unsafe { nodes.child(from, lane) };
                    break;
                }
                // SAFETY: the lane is that of a leaf.
                if unsafe { self.leaf(from, lane, &mut quad, sink) } {
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
    unsafe fn leaf<S: Sink>(&self, node: &WideNode, lane: usize, quad: &mut Quad, sink: &mut S) -> bool {
        let mut buffer = Ids::new();
        // SAFETY: the caller's promise.
        let fours = unsafe { self.nodes.fours(node, lane, &mut buffer) };
        for ids in fours {
            let mut corners = [[std::ptr::null(); 3]; 4];
            for (corners, &id) in corners.iter_mut().zip(ids) {
                // SAFETY: a leaf of this tree names triangles of the mesh.
                *corners = unsafe { self.nodes.mesh.corner_pointers(id) };
            }
            // SAFETY: these are corners.
            let mut may_hit = unsafe { self.s.quad(&self.frame, &corners, sink.limit(), quad) };
            count(|c| {
                let different = 1 + ids.windows(2).filter(|two| two[0] != two[1]).count() as u64;
                (c.triangles, c.ray_triangles, c.triangle_lanes) =
                    (c.triangles + 1, c.ray_triangles + different, c.triangle_lanes + 4);
            });
            while may_hit != 0 {
                let place = (may_hit.trailing_zeros() & 3) as usize;
                let id = ids[place];
                may_hit &= may_hit - 1;
                if sink.knows(id) {
                    continue;
                }
                if sink.consider(self.ray, quad.estimate(place), id, &self.nodes.mesh) {
                    return true;
                }
            }
        }
        false
    }
}
