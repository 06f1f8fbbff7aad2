//! One step of 16 rays: each visits its node.

use super::leaves::Queue;
use super::slots::{Each, SLOTS, Slots};
use crate::traverse::arch::Simd;
use crate::traverse::counters::count;
use crate::tree::{LaneNodes, LaneStep};

/// Deepest tree whose stack stands in the frame.
const SMALL_DEPTH: usize = 64;
/// Entries below a ray's first: one that is only read, one for the ray's end.
const GUARDS: usize = 2;

/// Far children to come back to: (address, where the ray enters it), slot after slot.
pub(super) struct Stack {
    small: [u64; SLOTS * (SMALL_DEPTH + GUARDS)],
    large: Vec<u64>,
    /// Entries of a slot.
    room: usize,
}

impl Stack {
    #[inline(always)]
    pub(super) fn new(depth: u32) -> Self {
        let large = if depth as usize <= SMALL_DEPTH {
            Vec::new()
        } else {
            vec![0; SLOTS * (depth as usize + GUARDS)]
        };
        Self {
            small: [0; SLOTS * (SMALL_DEPTH + GUARDS)],
            large,
            room: SMALL_DEPTH.max(depth as usize) + GUARDS,
        }
    }

    #[inline(always)]
    fn base(&mut self) -> *mut u64 {
        if self.large.is_empty() { self.small.as_mut_ptr() } else { self.large.as_mut_ptr() }
    }

    /// Empties a slot's stack; the ray ends at `exit`. Returns the place of its lowest entry.
    #[inline(always)]
    pub(super) fn begin(&mut self, slot: usize, exit: f32) -> u32 {
        let entries = if self.large.is_empty() { &mut self.small[..] } else { &mut self.large[..] };
        let first = slot * self.room;
        entries[first + 1] = u64::from(exit.to_bits()) << 32;
        (first + 1) as u32
    }
}

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

    let here = live & s.le(enter, limit);
    let inner = here & !node.leaf;
    count(|c| {
        let visited = u64::from(s.bits(here).count_ones());
        (c.nodes, c.ray_nodes, c.node_lanes) = (c.nodes + visited, c.ray_nodes + visited, c.node_lanes + 16);
    });
    let numbers = s.load_u32(&SLOT_NUMBERS[at..]);
    queue.push_leaves(s, here & node.leaf & node.filled, numbers, address);
    if N::T_REFERENCES {
        let (has, triangle) = nodes.t_references(s, inner, words);
        if s.any(has) {
            queue.push_pairs(s, has, numbers, triangle);
        }
    }

    let LaneStep { axis, split, left, stride, .. } = node;
    let (is_y, is_z) = (s.eq_u32(axis, s.u32s(1)), s.eq_u32(axis, s.u32s(2)));
    let origin = along(s, is_y, is_z, &slots.origin, at);
    let inverse = along(s, is_y, is_z, &slots.inverse, at);
    let slack = along(s, is_y, is_z, &slots.slack, at);
    let middle = (split - origin) * inverse;
    let (first, last) = (middle - slack, middle + slack);
    let near_only = s.lt(exit, first);
    let far_only = s.lt(last, enter) & !near_only;
    let both = inner & !near_only & !far_only;
    let down = s.lt(inverse, s.f32s(0.0));
    let right = left + stride;
    let (near, far) = (s.select_u32(down, right, left), s.select_u32(down, left, right));
    // SAFETY: a ray has at most as many entries as the tree is deep, so its next place lies on the stack.
    unsafe {
        let entry = s.cast_u32(s.larger(first, enter));
        s.scatter_pairs(both, stack.base().cast(), top, far, entry);
    }

    // All others take what their stack has; the entry below says where that ends.
    let pop = live & !inner;
    let bottom = s.load_u32(&slots.bottom.0[at..]);
    let under = s.select_u32(live, top - s.u32s(1), bottom);
    // SAFETY: a live ray's stack is at most empty, so there are the two guards below its next place.
    let [_, below, popped, popped_enter] =
        unsafe { s.gather_rows::<8>(stack.base().cast(), under - s.u32s(1)) };
    let (below, popped_enter) = (s.cast_f32(below), s.cast_f32(popped_enter));
    let emptied = pop & (s.eq_u32(under, bottom) | s.lt(s.load(&slots.cut.0[at..]), popped_enter));
    slots.live[group] &= !s.bits(emptied);

    let descended = s.select_u32(far_only, far, near);
    let narrowed = s.select(both, s.smaller(last, exit), exit);
    let margin = s.load(&slots.margin.0[at..]);
    let address = s.select_u32(inner, descended, popped);
    s.store_u32(address, &mut slots.address.0[at..]);
    s.store(s.select(inner, enter, popped_enter), &mut slots.enter.0[at..]);
    s.store(s.select(inner, narrowed, below + margin), &mut slots.exit.0[at..]);
    let pushed = s.select_u32(both, top + s.u32s(1), top);
    s.store_u32(s.select_u32(inner, pushed, under), &mut slots.top.0[at..]);
    // Read here for the next step: the other group's step hides the memory's latency.
    let (lower, upper) = nodes.fetch(s, address);
    s.store_u32(lower, &mut slots.lower.0[at..]);
    s.store_u32(upper, &mut slots.upper.0[at..]);
}

/// A group's values along each lane's axis.
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
