//! Streams: rays in any order that take turns on one thread, so that one computes while others wait for memory and for long instructions.
//!
//! Source: none that does the same. Tsakok 2009 (*Faster Incoherent Rays: Multi-BVH Ray Stream Tracing*) has the idea of many rays in flight
//! over wide nodes; here each of them keeps a stack of its own, and goes its own way.
//!
//! [`SLOTS`] rays are in flight. A round has two halves: all rays that have come to a node test its 16 children, and all that have come to a leaf test
//! its triangles. After each half, these rays go to the nearest child that waits. Each of these four loops does the same for one ray after the
//! other, and no step of one ray needs that of another; so a processor has several of them under way at once. Where a ray goes, to a node or to a
//! leaf, is found without a branch. Rays that end make room for others.
//!
//! Why the hits are those of the single kernel, to the last bit
//! 1. A child is left out only where the bounds of `mod.rs` say that the ray misses its box, or that the box begins behind the best hit:
//!    [`Slot::meets`] computes them as deviation 1 there says.
//! 2. Distances of children that wait have the lane in their four lowest bits, so they may be larger than they were by less than 16 units in the last
//!    place. The end that they are compared with, `cut`, has all of these bits set: whatever began before the end still does.
//! 3. The order in which triangles are tested changes no answer: see `sink.rs`.

use super::kept::{Asking, Taking};
use super::leaf::leaf;
use super::{is_plain, walk_in_f64};
use crate::geometry::Ray;
use crate::layout::{Address, LANES, STEP_BITS, WideNode, WideView};
use crate::simd::{Kernel, Simd};
use crate::traverse::conditions::NO_TRIANGLE;
use crate::traverse::counters::count;
use crate::traverse::prepared::{PreparedRay, larger, smaller};
use crate::traverse::sink::Sink;
use crate::traverse::stream::Prepared;
use crate::traverse::{RayConditions, Traced};
use std::mem::MaybeUninit;

/// Rays in flight.
const SLOTS: usize = 16;
/// The bits of a distance that its lane takes.
pub(super) const LANE_BITS: u32 = LANES as u32 - 1;
/// The lane of the child that waits in the frame below all others, from which a ray ends.
const END: u32 = LANES as u32;

/// A batch on its way through a tree.
pub(super) struct WideStream<'a, A> {
    pub(super) tree: Traced<'a, WideView<'a>>,
    pub(super) rays: &'a [Ray],
    pub(super) conditions: RayConditions<'a>,
    pub(super) answers: A,
}

/// A ray in flight.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Slot<K> {
    /// For each axis: distance a grid unit; −origin · 1/d, less and plus the width. The fourth ones are 0.
    inverse: [f32; 4],
    near: [f32; 4],
    far: [f32; 4],
    /// Where in a node the planes of each axis are that the ray meets first, and last.
    first: [u32; 3],
    enter: f32,
    /// The end of the ray, or the best hit, as deviation 2 says.
    cut: f32,
    /// The frame above the ray's top one.
    top: u32,
    /// The node to visit, or that of the leaf to test, and the leaf's lane.
    at: Address,
    lane: u32,
    ray: PreparedRay,
    kept: K,
    /// Position in the batch.
    place: usize,
}

/// A node of which children wait.
#[derive(Clone, Copy)]
struct Frame {
    at: Address,
    /// The lanes that wait, for any-hit rays; for others, those that did at first.
    lanes: u32,
}

/// Where a ray enters the children of a node that wait, with their lanes; infinite where none waits. Any-hit rays have none.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Keys([f32; LANES]);

/// Slots, in some order.
#[derive(Clone, Copy)]
struct List {
    slots: [u32; SLOTS],
    count: usize,
}

impl List {
    const EMPTY: Self = Self { slots: [0; SLOTS], count: 0 };

    /// Puts a slot behind the last one where `which`.
    #[inline(always)]
    fn push(&mut self, slot: usize, which: bool) {
        self.slots[self.count & (SLOTS - 1)] = slot as u32;
        self.count += usize::from(which);
    }
}

/// All that is in flight.
struct Flight<'a, V: Simd, A: Asking> {
    s: V,
    nodes: WideView<'a>,
    conditions: RayConditions<'a>,
    slots: Vec<Slot<A::Kept>>,
    /// The slots that have had a ray.
    used: usize,
    frames: Box<[MaybeUninit<Frame>]>,
    keys: Box<[MaybeUninit<Keys>]>,
    /// Frames of a slot.
    room: usize,
    /// Slots that are at a node, at a leaf, and at their end.
    walking: List,
    testing: List,
    ended: List,
    lanes: V::U,
    answers: A,
}

impl<A: Asking> Kernel for WideStream<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<V: Simd>(self, s: V) {
        let Self { tree, rays, conditions, mut answers } = self;
        if tree.bounds.is_empty() {
            return (0..rays.len()).for_each(|ray| answers.put(ray, None));
        }
        // A frame for each node of the deepest path, and the lowest one; an odd number, so that frames do not share few lines of the cache.
        let room = (tree.depth as usize + 2) | 1;
        let mut flight = Flight::<V, A> {
            s,
            nodes: tree.nodes,
            conditions,
            slots: vec![Slot::empty(A::begin(0.0, NO_TRIANGLE)); SLOTS],
            used: 0,
            frames: Box::new_uninit_slice(SLOTS * room),
            keys: Box::new_uninit_slice(if A::ANY { 0 } else { SLOTS * room }),
            room,
            walking: List::EMPTY,
            testing: List::EMPTY,
            ended: List::EMPTY,
            lanes: s.load_u32(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]),
            answers,
        };
        let mut ready = Prepared::new();
        let mut next = 0;
        loop {
            // 1. New rays in the places of those that have ended.
            while flight.ended.count > 0 || flight.used < SLOTS {
                if flight.begin(&mut ready) {
                    continue;
                }
                if next < rays.len() {
                    ready.load(s, rays, next, tree.bounds, tree.nodes.grid(), &mut flight.answers);
                    next += 16;
                } else {
                    break;
                }
            }
            if flight.walking.count + flight.testing.count == 0 {
                while flight.ended.count > 0 {
                    flight.ended.count -= 1;
                    flight.answer(flight.ended.slots[flight.ended.count & (SLOTS - 1)] as usize);
                }
                return;
            }
            // 2. All rays at nodes visit these.
            let walking = flight.walking;
            flight.walking.count = 0;
            for k in 0..walking.count {
                flight.visit(walking.slots[k & (SLOTS - 1)] as usize);
            }
            for k in 0..walking.count {
                flight.go(walking.slots[k & (SLOTS - 1)] as usize);
            }
            // 3. All rays at leaves test these.
            let testing = flight.testing;
            flight.testing.count = 0;
            for k in 0..testing.count {
                flight.test(testing.slots[k & (SLOTS - 1)] as usize);
            }
            for k in 0..testing.count {
                flight.go(testing.slots[k & (SLOTS - 1)] as usize);
            }
        }
    }
}

impl<V: Simd, A: Asking> Flight<'_, V, A> {
    /// Gives the answer of the ray in a slot.
    #[inline(always)]
    fn answer(&mut self, slot: usize) {
        let ended = &self.slots[slot];
        self.answers.put(ended.place, A::hit(&ended.kept));
    }

    /// Puts a ray that is ready at the root; `false` where none is.
    #[inline(always)]
    fn begin(&mut self, ready: &mut Prepared) -> bool {
        // 1. A slot whose ray has ended, or that had none yet.
        if ready.is_empty() {
            return false;
        }
        let slot = if self.ended.count > 0 {
            self.ended.count -= 1;
            let slot = self.ended.slots[self.ended.count & (SLOTS - 1)] as usize;
            self.answer(slot);
            slot
        } else {
            self.used += 1;
            self.used - 1
        };
        let new = &mut self.slots[slot];
        let Some(place) = ready.take_one(&mut new.ray) else { return false };
        let ray = &new.ray;
        new.place = place;
        new.kept = A::begin(ray.t_max, self.conditions.excepted(place));
        let lowest = slot * self.room;
        new.top = lowest as u32 + 1;
        self.frames[lowest].write(Frame { lanes: 1 << END, at: Address::ROOT });
        if !A::ANY {
            self.keys[lowest].write(Keys([0.0; LANES]));
        }
        // 2. What its steps need. −0 would be larger than all other distances, by its bits.
        for k in 0..3 {
            let origin = -(ray.plane_origin[k] * ray.inverse[k]);
            (new.near[k], new.far[k]) = (origin - ray.slack[k], origin + ray.slack[k]);
            new.inverse[k] = ray.inverse[k];
            new.first[k] = 2 * k as u32 + (ray.descends[k] & 1);
        }
        (new.enter, new.cut) = (ray.enter + 0.0, cut(ray.exit));
        new.at = Address::ROOT;
        if is_plain(ray) {
            self.walking.push(slot, true);
            count(|c| (c.rays, c.walks) = (c.rays + 1, c.walks + 1));
        } else {
            let mut taking = Taking { kept: &mut new.kept, place, conditions: &self.conditions };
            walk_in_f64(self.nodes, &new.ray, &mut taking);
            self.ended.push(slot, true);
        }
        true
    }

    /// Lets a ray visit the node that it has come to.
    #[inline(always)]
    fn visit(&mut self, slot: usize) {
        let s = self.s;
        count(|c| (c.nodes, c.ray_nodes, c.node_lanes) = (c.nodes + 1, c.ray_nodes + 1, c.node_lanes + 1));
        // SAFETY: slots in lists are those of rays.
        let ray = unsafe { self.slots.get_unchecked_mut(slot) };
        // SAFETY: `at` is the root or an inner child of a node of this tree.
        let node = unsafe { self.nodes.node(ray.at) };
        let (met, near) = ray.meets(s, node);
        let lanes = s.bits(met);
        // SAFETY: a ray has no more frames than the tree is deep, and that was counted when the tree was proved.
        unsafe {
            self.frames.get_unchecked_mut(ray.top as usize).write(Frame { at: ray.at, lanes });
            if !A::ANY {
                let keys = s.cast_f32((s.cast_u32(near) & s.u32s(!LANE_BITS)) | self.lanes);
                let keys = s.select(met, keys, s.f32s(f32::INFINITY));
                s.store(keys, &mut (*self.keys.get_unchecked_mut(ray.top as usize).as_mut_ptr()).0);
            }
        }
        ray.top += u32::from(lanes != 0);
    }

    /// Sends a ray to the nearest child that waits.
    #[inline(always)]
    fn go(&mut self, slot: usize) {
        let s = self.s;
        // SAFETY: slots in lists are those of rays.
        let ray = unsafe { self.slots.get_unchecked_mut(slot) };
        let (lane, at) = loop {
            // SAFETY: there is the lowest frame, which always has a child that waits; all below the top were written.
            let frame = unsafe { self.frames.get_unchecked_mut(ray.top as usize - 1).assume_init_mut() };
            if A::ANY {
                let lane = frame.lanes.trailing_zeros();
                if lane == END {
                    self.ended.push(slot, true);
                    return;
                }
                frame.lanes &= frame.lanes - 1;
                ray.top -= u32::from(frame.lanes == 0);
                break (lane, frame.at);
            }
            // SAFETY: as above.
            let at = unsafe { self.keys.get_unchecked_mut(ray.top as usize - 1).assume_init_mut() };
            let keys = s.load(&at.0);
            let waiting = s.bits(s.le(keys, s.f32s(ray.cut)));
            if waiting != 0 {
                if frame.lanes == 1 << END {
                    self.ended.push(slot, true);
                    return;
                }
                let lane = s.least(keys).to_bits() & LANE_BITS;
                at.0[lane as usize] = f32::INFINITY;
                ray.top -= u32::from(waiting & (waiting - 1) == 0);
                break (lane, frame.at);
            }
            ray.top -= 1;
        };
        // SAFETY: frames are those of nodes of this tree.
        let node = unsafe { self.nodes.node(at) };
        let is_inner = (lane as usize) < node.inner();
        // SAFETY: only used as a node's where the lane is that of an inner child.
        let child = unsafe { Address::new(node.nodes.wrapping_add(lane)) };
        ray.at = if is_inner { child } else { at };
        ray.lane = lane;
        self.walking.push(slot, is_inner);
        self.testing.push(slot, !is_inner);
    }

    /// Tests the leaf that a ray has come to.
    #[inline(always)]
    fn test(&mut self, slot: usize) {
        // SAFETY: slots in lists are those of rays.
        let ray = unsafe { self.slots.get_unchecked_mut(slot) };
        let mut taking = Taking { kept: &mut ray.kept, place: ray.place, conditions: &self.conditions };
        // SAFETY: the node is one of this tree, and the lane that of a leaf.
        let done = unsafe {
            let (node, lane) = (self.nodes.node(ray.at), ray.lane as usize);
            leaf(self.s, self.nodes, &ray.ray, node, lane, &mut taking)
        };
        if done {
            // The frame from which a ray ends.
            ray.top = (slot * self.room) as u32 + 1;
        }
        if !A::ANY {
            ray.cut = cut(smaller(ray.kept.limit() * ray.ray.scale, ray.ray.exit));
        }
    }
}

/// What is computed of a node for one ray: for each axis, the distance a step, and the distances to its lower corner.
#[repr(C, align(16))]
struct Terms {
    step: [f32; 4],
    near: [f32; 4],
    far: [f32; 4],
}

impl<K> Slot<K> {
    /// Without a ray.
    #[inline(always)]
    fn empty(kept: K) -> Self {
        Self {
            inverse: [0.0; 4],
            near: [0.0; 4],
            far: [0.0; 4],
            first: [0; 3],
            enter: 0.0,
            cut: 0.0,
            top: 0,
            at: Address::ROOT,
            lane: 0,
            ray: PreparedRay::NONE,
            kept,
            place: 0,
        }
    }

    /// The children that the ray meets before its end, and where it enters each.
    #[inline(always)]
    fn meets<V: Simd>(&self, s: V, node: &WideNode) -> (V::M, V::F) {
        let (mut step, mut near, mut far) = ([0.0; 4], [0.0; 4], [0.0; 4]);
        let (low, steps) = node.corner_and_steps();
        for k in 0..4 {
            step[k] = f32::from_bits(steps[k] & STEP_BITS) * self.inverse[k];
        }
        for k in 0..4 {
            near[k] = low[k] * self.inverse[k] + self.near[k];
        }
        for k in 0..4 {
            far[k] = low[k] * self.inverse[k] + self.far[k];
        }
        let terms = Terms { step, near, far };
        // From memory, a value comes into all lanes as it is loaded; from a lane of a register it takes a shuffle each.
        let terms = std::hint::black_box(&terms);
        let (enter, exit) = (s.f32s(self.enter), s.f32s(self.cut));
        let (mut near, mut far) = (enter, exit);
        for k in 0..3 {
            // SAFETY: `first` are the planes of the three axes.
            let (first, last) = unsafe { (node.plane(self.first[k]), node.plane(self.first[k] ^ 1)) };
            let (first, last) = (s.load_u16(first), s.load_u16(last));
            let step = s.f32s(terms.step[k]);
            near = s.larger(s.bound_mul_add(first, step, s.f32s(terms.near[k])), near);
            far = s.smaller(s.bound_mul_add(last, step, s.f32s(terms.far[k])), far);
        }
        (s.le(near, far) & s.mask((1u32 << node.children()) - 1), near)
    }
}

/// The end that distances with lanes are compared with: finite, neither negative nor −0, and with all bits set that lanes take.
#[inline(always)]
pub(super) fn cut(end: f32) -> f32 {
    f32::from_bits(larger(smaller(end, f32::MAX), 0.0).to_bits() | LANE_BITS)
}
