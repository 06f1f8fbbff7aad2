//! The rays in flight.

use super::answers::Answers;
use super::prepare::Prepared;
use super::walk::Stack;
use crate::traverse::Hit;
use crate::traverse::arch::Simd;
use crate::traverse::counters::count;
use crate::traverse::prepared::larger;

/// Rays in flight: two groups of 16 lanes.
pub(super) const SLOTS: usize = 32;

/// A value a slot.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Each<T>(pub(super) [T; SLOTS]);

/// All that kernels read of the rays in flight, by field.
pub(super) struct Slots {
    /// Which slots of each group are walking.
    pub(super) live: [u32; 2],
    /// Which slots hold a ray whose answer is still to be given.
    held: u32,

    /// The node to visit, and what stands there.
    pub(super) address: Each<u32>,
    pub(super) lower: Each<u32>,
    pub(super) upper: Each<u32>,
    pub(super) enter: Each<f32>,
    pub(super) exit: Each<f32>,
    /// The entry on top of the stack, bytes.
    pub(super) top: Each<u32>,
    /// The end of what still matters, scaled units.
    pub(super) limit: Each<f32>,
    /// Nothing on the stack matters once an entry begins behind this.
    pub(super) cut: Each<f32>,
    /// How far an interval may reach into its neighbour.
    margin: Each<f32>,

    pub(super) origin: [Each<f32>; 3],
    pub(super) inverse: [Each<f32>; 3],
    pub(super) slack: [Each<f32>; 3],

    /// The origin in the ray's frame, its slopes, the direction along the longest axis, and that axis.
    pub(super) start: [Each<f32>; 3],
    pub(super) slope: [Each<f32>; 2],
    pub(super) depth: Each<f32>,
    pub(super) longest: Each<f32>,
    pub(super) t_min: Each<f32>,
    /// The best hit; at first the ray's end and no triangle.
    pub(super) best_t: Each<f32>,
    best_u: Each<f32>,
    best_v: Each<f32>,
    best_triangle: Each<u32>,
    scale: Each<f32>,
    /// Position in the batch.
    ray: Each<u32>,
}

impl Slots {
    #[inline(always)]
    pub(super) fn new(stack: &Stack) -> Self {
        let (none, zero) = (Each([0.0; SLOTS]), Each([0; SLOTS]));
        Self {
            live: [0; 2],
            held: 0,
            address: zero,
            lower: zero,
            upper: zero,
            enter: none,
            exit: none,
            top: stack.bottoms(),
            limit: none,
            cut: none,
            margin: none,
            origin: [none; 3],
            inverse: [none; 3],
            slack: [none; 3],
            start: [none; 3],
            slope: [none; 2],
            depth: none,
            longest: none,
            t_min: none,
            best_t: none,
            best_u: none,
            best_v: none,
            best_triangle: zero,
            scale: none,
            ray: zero,
        }
    }

    #[inline(always)]
    pub(super) fn walking(&self) -> u32 {
        self.live[0] | self.live[1] << 16
    }

    /// Gives the answers of the rays that have ended.
    #[inline(always)]
    pub(super) fn retire(&mut self, answers: &mut impl Answers) {
        let mut ended = self.held & !self.walking();
        self.held &= !ended;
        while ended != 0 {
            let slot = ended.trailing_zeros() as usize & (SLOTS - 1);
            ended &= ended - 1;
            let hit = Hit {
                t: self.best_t.0[slot],
                u: self.best_u.0[slot],
                v: self.best_v.0[slot],
                triangle: self.best_triangle.0[slot],
            };
            answers.put(self.ray.0[slot] as usize, (hit.triangle != u32::MAX).then_some(hit));
        }
    }

    /// Fills empty slots of a group with prepared rays, as many as there are; `root` is what stands at address 0.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        s: S,
        group: usize,
        ready: &mut Prepared,
        root: (S::U, S::U),
        stack: &Stack,
    ) {
        let at = 16 * group;
        let (mut empty, mut filled) = (!self.live[group] & 0xffff, 0u32);
        while empty != 0 {
            let Some(from) = ready.take() else { break };
            let lane = empty.trailing_zeros() as usize & 15;
            empty &= empty - 1;
            filled |= 1 << lane;
            let slot = at + lane;
            let ray = &*ready;
            self.top.0[slot] = stack.bottom(slot);
            self.enter.0[slot] = ray.enter.0[from];
            self.exit.0[slot] = ray.exit.0[from];
            self.limit.0[slot] = ray.limit.0[from];
            self.margin.0[slot] = ray.margin.0[from];
            for k in 0..3 {
                self.origin[k].0[slot] = ray.origin[k].0[from];
                self.inverse[k].0[slot] = ray.inverse[k].0[from];
                self.slack[k].0[slot] = ray.slack[k].0[from];
                self.start[k].0[slot] = ray.start[k].0[from];
            }
            self.slope[0].0[slot] = ray.slope[0].0[from];
            self.slope[1].0[slot] = ray.slope[1].0[from];
            self.depth.0[slot] = ray.depth.0[from];
            self.longest.0[slot] = ray.longest.0[from];
            self.t_min.0[slot] = ray.t_min.0[from];
            self.best_t.0[slot] = ray.t_max.0[from];
            self.scale.0[slot] = ray.scale.0[from];
            self.ray.0[slot] = ready.first + from as u32;
        }
        count(|c| {
            let filled = u64::from(filled.count_ones());
            (c.rays, c.walks) = (c.rays + filled, c.walks + filled);
        });
        self.live[group] |= filled;
        self.held |= filled << at;
        let new = s.mask(filled);
        let limit = s.load(&self.limit.0[at..]);
        let cut = s.larger(limit + s.load(&self.margin.0[at..]), limit);
        let cut = s.select(new, cut, s.load(&self.cut.0[at..]));
        s.store(cut, &mut self.cut.0[at..]);
        set(s, new, s.u32s(0), &mut self.address, at);
        set(s, new, root.0, &mut self.lower, at);
        set(s, new, root.1, &mut self.upper, at);
        set(s, new, s.u32s(u32::MAX), &mut self.best_triangle, at);
    }

    /// A hit within the ray's interval and not behind its best one.
    #[inline(always)]
    pub(super) fn offer<A: Answers>(&mut self, slot: usize, hit: Hit) {
        // Before the first hit, `best_t` is the ray's end and the id is the largest.
        let slot = slot & (SLOTS - 1);
        let t = self.best_t.0[slot];
        if hit.t < t || (hit.t == t && hit.triangle < self.best_triangle.0[slot]) {
            self.best_t.0[slot] = hit.t;
            self.best_u.0[slot] = hit.u;
            self.best_v.0[slot] = hit.v;
            self.best_triangle.0[slot] = hit.triangle;
            let limit = if A::ANY { f32::NEG_INFINITY } else { hit.t * self.scale.0[slot] };
            self.limit.0[slot] = limit;
            // Not the sum where that is NaN, infinity and its opposite.
            self.cut.0[slot] = larger(limit + self.margin.0[slot], limit);
        }
    }
}

/// `to[i] = x[i]` for the new lanes of the group at `at`.
#[inline(always)]
fn set<S: Simd>(s: S, new: S::M, x: S::U, to: &mut Each<u32>, at: usize) {
    let to = &mut to.0[at..];
    s.store_u32(s.select_u32(new, x, s.load_u32(to)), to);
}
