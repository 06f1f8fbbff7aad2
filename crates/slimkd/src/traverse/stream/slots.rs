//! The rays in flight, each in a slot: what the kernel knows of them, how new ones come in, and how answers go out.

use super::answers::Answers;
use super::prepare::{Lanes, Prepared};
use super::walk::Stack;
use crate::geometry::Hit;
use crate::simd::Simd;
use crate::traverse::counters::count;
use crate::traverse::prepared::larger;

/// Rays in flight: two groups of 16 lanes.
pub(super) const SLOTS: usize = 32;

/// One value for each slot.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Each<T>(pub(super) [T; SLOTS]);

/// Everything that the kernel reads of the rays in flight, as one array for each field.
pub(super) struct Slots {
    /// Which slots of each group hold a ray whose walk goes on.
    pub(super) live: [u32; 2],
    /// Which slots hold a ray whose answer is still to be given.
    held: u32,

    /// The address of the node to visit, and the two words that were read there.
    pub(super) address: Each<u32>,
    pub(super) lower: Each<u32>,
    pub(super) upper: Each<u32>,
    /// The ray's interval in that node, in scaled units.
    pub(super) enter: Each<f32>,
    pub(super) exit: Each<f32>,
    /// The offset in bytes of the entry on top of the slot's stack.
    pub(super) top: Each<u32>,
    /// The offset in bytes of the slot's lowest entry.
    bottom: Each<u32>,
    /// The largest distance that still matters, in scaled units: the best hit's, at first the ray's end.
    pub(super) limit: Each<f32>,
    /// Once the entry on top of the stack begins behind this, no entry of the stack matters: `limit + margin`.
    pub(super) cut: Each<f32>,
    /// A bound on how far the intervals of two entries may overlap, see the module head of `mod.rs`.
    margin: Each<f32>,

    pub(super) plane_origin: [Each<f32>; 3],
    pub(super) inverse: [Each<f32>; 3],
    pub(super) slack: [Each<f32>; 3],

    /// The frame origin, the slopes of the shear, the direction's component on its longest axis, and that axis.
    pub(super) frame_origin: [Each<f32>; 3],
    pub(super) slope: [Each<f32>; 2],
    pub(super) along: Each<f32>,
    pub(super) longest: Each<f32>,
    pub(super) t_min: Each<f32>,
    /// The best hit. At first its `t` is the ray's end, and it has no triangle (`u32::MAX`).
    pub(super) best_t: Each<f32>,
    best_u: Each<f32>,
    best_v: Each<f32>,
    best_triangle: Each<u32>,
    scale: Each<f32>,
    /// The ray's position in the batch.
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
            plane_origin: [none; 3],
            inverse: [none; 3],
            slack: [none; 3],
            frame_origin: [none; 3],
            slope: [none; 2],
            along: none,
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

    /// A bit for each slot: whether it holds a ray whose walk goes on.
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

    /// Fills idle slots of a group with prepared rays, as many as there are; `root` holds the two words of the root.
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
        // Fields are written as whole vectors: a step would have to wait until single values had reached the cache.
        let new = New { mask: s.mask(filled), from: s.load_u32(&from), at };
        let (limit, margin) = (new.take(s, &ready.limit), new.take(s, &ready.margin));
        new.put(s, limit, &mut self.limit);
        new.put(s, margin, &mut self.margin);
        new.put(s, s.larger(limit + margin, limit), &mut self.cut);
        new.put(s, new.take(s, &ready.enter), &mut self.enter);
        new.put(s, new.take(s, &ready.exit), &mut self.exit);
        for k in 0..3 {
            new.put(s, new.take(s, &ready.plane_origin[k]), &mut self.plane_origin[k]);
            new.put(s, new.take(s, &ready.inverse[k]), &mut self.inverse[k]);
            new.put(s, new.take(s, &ready.slack[k]), &mut self.slack[k]);
            new.put(s, new.take(s, &ready.frame_origin[k]), &mut self.frame_origin[k]);
        }
        new.put(s, new.take(s, &ready.slope[0]), &mut self.slope[0]);
        new.put(s, new.take(s, &ready.slope[1]), &mut self.slope[1]);
        new.put(s, new.take(s, &ready.along), &mut self.along);
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

    /// Takes a hit within the ray's range. It becomes the best one where it is nearer, or as near and of a lower id.
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
            // `larger` gives the limit where the sum is NaN: a limit of −∞ and an infinite margin.
            self.cut.0[slot] = larger(limit + self.margin.0[slot], limit);
        }
    }
}

/// New rays for the lanes of a group.
struct New<S: Simd> {
    /// The lanes that get a new ray.
    mask: S::M,
    /// For each lane, the lane of the prepared ray that it gets.
    from: S::U,
    /// The group's first slot.
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
