//! One step of 16 rays, in which each visits one node. Read `single.rs` first: a lane makes the same decisions as its ray makes there.

use super::leaves::Queue;
use super::slots::{Each, SLOTS, Slots};
use crate::layout::{LaneNodes, LaneStep};
use crate::simd::Simd;
use crate::traverse::counters::count;

/// The deepest tree whose far children fit [`Stack::small`], which lies on the machine's stack.
const SMALL_DEPTH: usize = 64;
/// Entries of a slot beside its far children: the lowest one, which marks the empty stack, and one above the top, which every step
/// writes although only some lanes keep it.
const GUARDS: usize = 2;
/// The size of an entry in bytes.
const ENTRY: u32 = size_of::<Entry>() as u32;

/// A far child to come back to. The four words are its address, where the ray enters it, where the ray leaves it, and one that is not
/// used. An entry is written and read in one access, as a load that spans two stores waits until both have reached the cache.
#[derive(Clone, Copy)]
#[repr(align(16))]
struct Entry(#[expect(dead_code, reason = "accessed through pointers")] [u32; 4]);

/// The stacks of far children of all slots, one slot after the other.
pub(super) struct Stack {
    /// The entries of trees up to [`SMALL_DEPTH`].
    small: [Entry; SLOTS * (SMALL_DEPTH + GUARDS)],
    /// The entries of deeper trees; else empty.
    large: Vec<Entry>,
    /// The number of entries of each slot.
    room: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new(depth: u32) -> Self {
        // The mark of the empty stack: its `enter` is NaN, which is never at or before `cut`, so a ray that pops it ends.
        let empty = Entry([0, f32::NAN.to_bits(), 0, 0]);
        let large = if depth as usize <= SMALL_DEPTH {
            Vec::new()
        } else {
            vec![empty; SLOTS * (depth as usize + GUARDS)]
        };
        let small = [empty; SLOTS * (SMALL_DEPTH + GUARDS)];
        Self { small, large, room: SMALL_DEPTH.max(depth as usize) + GUARDS }
    }

    #[inline(always)]
    fn base(&mut self) -> *mut u8 {
        if self.large.is_empty() { self.small.as_mut_ptr().cast() } else { self.large.as_mut_ptr().cast() }
    }

    /// The offset of every slot's lowest entry, in bytes.
    #[inline(always)]
    pub(super) fn bottoms(&self) -> Each<u32> {
        let mut bottoms = Each([0; SLOTS]);
        for slot in 0..SLOTS {
            bottoms.0[slot] = (slot * self.room) as u32 * ENTRY;
        }
        bottoms
    }
}

/// Lets each of the 16 rays of `group` visit the node that was read for it, and reads the next one.
#[inline(always)]
pub(super) fn step<S: Simd, N: LaneNodes>(
    s: S,
    nodes: N,
    group: usize,
    slots: &mut Slots,
    stack: &mut Stack,
    queue: &mut Queue,
) {
    let at = 16 * group;
    let live = s.mask(slots.live[group]);
    let address = s.load_u32(&slots.address.0[at..]);
    let words = (s.load_u32(&slots.lower.0[at..]), s.load_u32(&slots.upper.0[at..]));
    let node = nodes.decode(s, address, words);
    let limit = s.load(&slots.limit.0[at..]);
    let enter = s.load(&slots.enter.0[at..]);
    let exit = s.smaller(limit, s.load(&slots.exit.0[at..]));
    let top = s.load_u32(&slots.top.0[at..]);

    // 1. Lanes whose node lies behind the ray's limit do not visit it.
    let here = live & s.le(enter, limit);
    let inner = here & !node.leaf;
    count(|c| {
        let visited = u64::from(s.bits(here).count_ones());
        (c.nodes, c.ray_nodes, c.node_lanes) = (c.nodes + visited, c.ray_nodes + visited, c.node_lanes + 16);
    });
    // 2. Leaves and T-references go into the queue, and their lanes go on without waiting for the tests.
    let numbers = s.load_u32(&SLOT_NUMBERS[at..]);
    queue.push_leaves(s, here & node.leaf & node.filled, numbers, address);
    if N::T_REFERENCES {
        // SAFETY: the tree fits lanes, and `words` was read at these nodes.
        let (has, triangle) = unsafe { nodes.t_references(s, inner, words) };
        if s.any(has) {
            queue.push_pairs(s, has, numbers, triangle);
        }
    }

    // 3. At inner nodes: where the ray meets the plane's slab, and so which children it enters.
    let LaneStep { axis, split, left, right, .. } = node;
    let (is_y, is_z) = (s.eq_u32(axis, s.u32s(1)), s.eq_u32(axis, s.u32s(2)));
    let origin = along(s, is_y, is_z, &slots.plane_origin, at);
    let inverse = along(s, is_y, is_z, &slots.inverse, at);
    let slack = along(s, is_y, is_z, &slots.slack, at);
    let middle = (split - origin) * inverse;
    let (first, last) = (middle - slack, middle + slack);
    let near_only = s.lt(exit, first);
    let far_only = s.lt(last, enter) & !near_only;
    let both = inner & !near_only & !far_only;
    let down = s.lt(inverse, s.f32s(0.0));
    let (near, far) = (s.select_u32(down, right, left), s.select_u32(down, left, right));
    // 4. Every lane reads the entry on top of its stack and writes its far child above it. The masks decide afterwards: lanes that enter
    //    both children keep what they wrote, lanes that do not go down use what they read, and for the others neither counts.
    let top_at = &slots.top.0[at..];
    // SAFETY: a ray has at most as many entries as the tree is deep, and there are guards below and above.
    let [popped, popped_enter, popped_exit, _] = unsafe {
        let popped = s.load_rows(stack.base(), top_at);
        let entry = [far, s.cast_u32(s.larger(first, enter)), s.cast_u32(exit), far];
        s.store_rows(stack.base().add(ENTRY as usize), top_at, entry);
        popped
    };
    let (popped_enter, popped_exit) = (s.cast_f32(popped_enter), s.cast_f32(popped_exit));

    // Lanes at a leaf, or at a node that they do not visit, pop their stack. A ray ends where the entry begins behind its `cut`.
    let pop = live & !inner;
    let emptied = pop & !s.le(popped_enter, s.load(&slots.cut.0[at..]));
    slots.live[group] &= !s.bits(emptied);
    let entries = s.u32s(ENTRY);
    let top = s.select_u32(both, top + entries, s.select_u32(pop & !emptied, top - entries, top));
    s.store_u32(top, &mut slots.top.0[at..]);

    // 5. Where each lane goes next.
    let descended = s.select_u32(far_only, far, near);
    let narrowed = s.select(both, s.smaller(last, exit), exit);
    s.store_u32(s.select_u32(inner, descended, popped), &mut slots.address.0[at..]);
    s.store(s.select(inner, enter, popped_enter), &mut slots.enter.0[at..]);
    s.store(s.select(inner, narrowed, popped_exit), &mut slots.exit.0[at..]);
    // 6. Read the next nodes now: the other group's step hides the latency of memory.
    // SAFETY: the tree fits lanes. Every slot's address is the root's, a child's or one popped, and idle slots keep their last one.
    let (lower, upper) = unsafe { nodes.fetch(s, &slots.address.0[at..]) };
    s.store_u32(lower, &mut slots.lower.0[at..]);
    s.store_u32(upper, &mut slots.upper.0[at..]);
}

/// The values of a group on the axis of each lane's split plane.
#[inline(always)]
fn along<S: Simd>(s: S, is_y: S::M, is_z: S::M, of: &[Each<f32>; 3], at: usize) -> S::F {
    let (x, y, z) = (s.load(&of[0].0[at..]), s.load(&of[1].0[at..]), s.load(&of[2].0[at..]));
    s.select(is_z, z, s.select(is_y, y, x))
}

/// 0 to 31.
pub(super) static SLOT_NUMBERS: [u32; SLOTS] = {
    let mut numbers = [0; SLOTS];
    let mut i = 0;
    while i < SLOTS {
        numbers[i] = i as u32;
        i += 1;
    }
    numbers
};
