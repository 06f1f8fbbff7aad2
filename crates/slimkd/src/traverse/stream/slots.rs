//! The rays in flight.

use super::answers::Answers;
use super::prepare::{Lanes, Prepared};
use super::walk::Stack;
use crate::geometry::Hit;
use crate::simd::Simd;
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
    /// Its lowest entry.
    bottom: Each<u32>,
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
            bottom: stack.bottoms(),
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
    pub(super) fn fill<S: Simd>(&mut self, s: S, group: usize, ready: &mut Prepared, root: (S::U, S::U)) {
        let at = 16 * group;
        let (filled, from) = ready.take(!self.live[group] & 0xffff);
        count(|c| {
            let filled = u64::from(filled.count_ones());
            (c.rays, c.walks) = (c.rays + filled, c.walks + filled);
        });
        self.live[group] |= filled;
        self.held |= filled << at;
        // By whole vectors: fields written lane by lane would have to reach the cache before a step could read them.
        let new = New { mask: s.mask(filled), from: s.load_u32(&from), at };
        let (limit, margin) = (new.take(s, &ready.limit), new.take(s, &ready.margin));
        new.put(s, limit, &mut self.limit);
        new.put(s, margin, &mut self.margin);
        new.put(s, s.larger(limit + margin, limit), &mut self.cut);
        new.put(s, new.take(s, &ready.enter), &mut self.enter);
        new.put(s, new.take(s, &ready.exit), &mut self.exit);
        for k in 0..3 {
            new.put(s, new.take(s, &ready.origin[k]), &mut self.origin[k]);
            new.put(s, new.take(s, &ready.inverse[k]), &mut self.inverse[k]);
            new.put(s, new.take(s, &ready.slack[k]), &mut self.slack[k]);
            new.put(s, new.take(s, &ready.start[k]), &mut self.start[k]);
        }
        new.put(s, new.take(s, &ready.slope[0]), &mut self.slope[0]);
        new.put(s, new.take(s, &ready.slope[1]), &mut self.slope[1]);
        new.put(s, new.take(s, &ready.depth), &mut self.depth);
        new.put(s, new.take(s, &ready.longest), &mut self.longest);
        new.put(s, new.take(s, &ready.t_min), &mut self.t_min);
        new.put(s, new.take(s, &ready.t_max), &mut self.best_t);
        new.put(s, new.take(s, &ready.scale), &mut self.scale);
        new.put_u32(s, s.u32s(ready.first) + new.from, &mut self.ray);
        new.put_u32(s, s.u32s(0), &mut self.address);
        new.put_u32(s, root.0, &mut self.lower);
        new.put_u32(s, root.1, &mut self.upper);
        new.put_u32(s, s.load_u32(&self.bottom.0[at..]), &mut self.top);
        new.put_u32(s, s.u32s(u32::MAX), &mut self.best_triangle);
    }

    /// The position in the batch of the ray in a slot.
    #[inline(always)]
    pub(super) fn ray(&self, slot: usize) -> usize {
        self.ray.0[slot & (SLOTS - 1)] as usize
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

/// Lanes of the group at `at` that get a new ray, and which prepared one.
struct New<S: Simd> {
    mask: S::M,
    from: S::U,
    at: usize,
}

impl<S: Simd> New<S> {
    #[inline(always)]
    fn take(&self, s: S, prepared: &Lanes<f32>) -> S::F {
        s.permute(s.load(&prepared.0), self.from)
    }

    #[inline(always)]
    fn put(&self, s: S, x: S::F, to: &mut Each<f32>) {
        let to = &mut to.0[self.at..];
        s.store(s.select(self.mask, x, s.load(to)), to);
    }

    #[inline(always)]
    fn put_u32(&self, s: S, x: S::U, to: &mut Each<u32>) {
        let to = &mut to.0[self.at..];
        s.store_u32(s.select_u32(self.mask, x, s.load_u32(to)), to);
    }
}
