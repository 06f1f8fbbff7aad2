//! Up to 16·G rays of one class through wide nodes together. Read `packet/mod.rs` first: it makes the groups.
//!
//! Sources: Reshetov, Soupikov & Hurley 2005, *Multi-Level Ray Tracing Algorithm*, for intervals around all rays; Wald et al. 2001 for packets.
//!
//! 1. At a node, intervals around all rays ([`Bundle`]) are compared with the boxes of all 16 children at once. Children that no ray can meet are left out;
//!    the others wait, nearest first.
//! 2. When a child's turn comes, its box alone is compared with the rays, 16 at a time: so those that are tested are compared with the best hits by then.
//!
//! Why no hit is lost. With the errors of `mod.rs`: planes are computed here as `low + plane · step`, a product that is exact and a sum that is off by 2
//! units of 2⁻²⁴·M (a plane lies at most 2M from the lower bound). A ray's distances are `plane · 1/d + (−origin · 1/d ∓ width)`: 1 for the hit's t, 5
//! for its point; 5 for the origin in grid units, 1 for its product with 1/d, 1 for 1/d itself; 2 for the plane, and 2 for its product and 2 for its
//! 1/d; 1 and 3 for the sums: 23 of the width's 32. The intervals are those of `(plane − origin) · 1/d ∓ width`, whose errors are 1 + 5 + 5 + 2 and 2 for the difference, 2
//! for the product and 2 for 1/d, 3 for the width's sum: 22; rounding is monotonic, so the ends of the intervals bound what each ray has. Distances at which
//! children wait have their lane in the lowest bits, and ends have these bits set, as in `stream.rs`. Rays whose widths are beyond [`MOST_WIDTH`], or that begin before
//! t = 0, are not taken.

use super::MOST_WIDTH;
use super::stream::{LANE_BITS, cut};
use crate::layout::{Address, Ids, LANES, Planes, STEP_BITS, WideView};
use crate::simd::Simd;
use crate::traverse::counters::count;
use crate::traverse::packet::{Bundle, Class, Eye, Group, Grouped, WIDTH, test_all};
use crate::traverse::prepared::smaller;

/// The children of one node that wait.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Frame {
    /// Where the first ray may enter them, with their lanes; infinite where none waits.
    keys: [f32; LANES],
    /// The planes of their boxes, as in the node but in grid units.
    places: [[f32; LANES]; 6],
    /// The rays that met the node.
    rays: u64,
    at: Address,
}

impl Grouped for WideView<'_> {
    const PACKETS: bool = false;
    type Stack<S: Simd, const G: usize> = Vec<Frame>;

    fn stack<S: Simd, const G: usize>(depth: u32) -> Vec<Frame> {
        // Made at once, and written in place: a frame has 464 bytes.
        let none = Frame { keys: [0.0; LANES], places: [[0.0; LANES]; 6], rays: 0, at: Address::ROOT };
        vec![none; depth as usize + 1]
    }

    fn few(mixed: u32) -> u32 {
        // Beside a large class, even a few rays are faster as a group than as strays; where all classes are small, they are not.
        if mixed < 64 { 4 } else { 16 }
    }

    fn coordinates(self) -> Planes {
        *self.grid()
    }

    #[inline(always)]
    fn takes<S: Simd, const G: usize>(self, s: S, group: &Group<S, G>) -> u64 {
        let mut taken = 0;
        for g in 0..G {
            let most = s.f32s(MOST_WIDTH);
            let tame =
                s.lt(group.slack[0][g], most) & s.lt(group.slack[1][g], most) & s.lt(group.slack[2][g], most);
            taken |= u64::from(s.bits(tame & s.le(s.f32s(0.0), group.enter[g]))) << (g * WIDTH);
        }
        taken
    }

    #[inline(always)]
    fn walk<S: Simd, const G: usize, const COMMON: bool, const ANY: bool>(
        self,
        s: S,
        group: &mut Group<S, G>,
        class: Class,
        rays: u64,
        eye: Eye,
        stack: &mut Vec<Frame>,
    ) {
        count(|c| (c.rays, c.walks) = (c.rays + u64::from(rays.count_ones()), c.walks + 1));
        Walk::<S, G> {
            s,
            nodes: self,
            bundle: Bundle::new(s, group, class, rays),
            near: [[s.f32s(0.0); G]; 3],
            far: [[s.f32s(0.0); G]; 3],
            enter: 0.0,
            cut: 0.0,
            stack,
            top: 0,
        }
        .run::<COMMON, ANY>(group, class, rays, eye);
    }
}

struct Walk<'a, S: Simd, const G: usize> {
    s: S,
    nodes: WideView<'a>,
    bundle: Bundle,
    /// −origin · 1/d of each ray, less and plus the width.
    near: [[S::F; G]; 3],
    far: [[S::F; G]; 3],
    /// Where the first ray begins, and where the last one ends by now.
    enter: f32,
    cut: f32,
    /// Frames below `top` have children that wait.
    stack: &'a mut [Frame],
    top: usize,
}

impl<S: Simd, const G: usize> Walk<'_, S, G> {
    #[inline(always)]
    fn run<const COMMON: bool, const ANY: bool>(
        &mut self,
        group: &mut Group<S, G>,
        class: Class,
        mut rays: u64,
        eye: Eye,
    ) {
        let s = self.s;
        // 1. What the rays have along each axis, and where they end.
        for k in 0..3 {
            for g in 0..G {
                let origin = group.plane_origin[k][g] * group.inverse[k][g];
                let origin = s.f32s(0.0) - origin;
                self.near[k][g] = origin - group.slack[k][g];
                self.far[k][g] = origin + group.slack[k][g];
            }
        }
        self.enter = f32::INFINITY;
        for g in 0..G {
            let mask = s.mask((rays >> (g * WIDTH)) as u32);
            self.enter = smaller(s.least(s.select(mask, group.enter[g], s.f32s(f32::INFINITY))), self.enter);
        }
        // −0 would be larger than all other distances, by its bits.
        self.enter += 0.0;
        self.shorten(group, rays);
        self.visit(class, Address::ROOT, rays);
        let mut buffer = Ids::new();
        // 2. The nearest child that waits in the last node.
        while self.top > 0 {
            let frame = &mut self.stack[self.top - 1];
            let keys = s.load(&frame.keys);
            let waiting = s.bits(s.le(keys, s.f32s(self.cut)));
            if waiting == 0 {
                self.top -= 1;
                continue;
            }
            let lane = (s.least(keys).to_bits() & LANE_BITS) as usize;
            frame.keys[lane] = f32::INFINITY;
            // 3. Which rays meet its box.
            let frame = &self.stack[self.top - 1];
            let active = self.active(group, frame, lane, if ANY { frame.rays & rays } else { frame.rays });
            let at = frame.at;
            self.top -= usize::from(waiting & (waiting - 1) == 0);
            if active == 0 {
                continue;
            }
            // SAFETY: frames are those of nodes of this tree.
            let node = unsafe { self.nodes.node(at) };
            if lane < node.inner() {
                // SAFETY: the lane is that of an inner child.
                let child = unsafe { self.nodes.child(node, lane) };
                self.visit(class, child, active);
                continue;
            }
            // 4. The triangles of a leaf.
            // SAFETY: the lane is that of a leaf.
            let ids = unsafe { self.nodes.ids(node, lane, &mut buffer) };
            let mut lanes = [s.mask(0); G];
            for g in 0..G {
                lanes[g] = s.mask((active >> (g * WIDTH)) as u32);
            }
            count(|c| c.triangles += ids.len() as u64);
            let mut hit = false;
            // SAFETY: a leaf of this tree names the triangles.
            let mut next = unsafe { self.nodes.mesh.corners(ids[0]) };
            for index in 0..ids.len() {
                let corners = next;
                if let Some(&after) = ids.get(index + 1) {
                    // SAFETY: as above.
                    next = unsafe { self.nodes.mesh.corners(after) };
                }
                hit |= test_all::<S, G, COMMON, ANY>(s, group, class, eye, &corners, ids[index], &mut lanes);
            }
            if hit {
                if ANY {
                    for g in 0..G {
                        let missed = s.eq_u32(group.triangle[g], s.u32s(u32::MAX));
                        rays &= !(u64::from(s.bits(!missed)) << (g * WIDTH));
                    }
                    if rays == 0 {
                        return;
                    }
                }
                self.shorten(group, rays);
            }
        }
    }

    /// Finds where the last ray ends by now.
    #[inline(always)]
    fn shorten(&mut self, group: &mut Group<S, G>, rays: u64) {
        let s = self.s;
        let mut last = s.f32s(f32::NEG_INFINITY);
        for g in 0..G {
            let mask = s.mask((rays >> (g * WIDTH)) as u32);
            group.exit[g] = s.smaller(group.limit[g] * group.scale[g], group.exit[g]);
            last = s.larger(s.select(mask, group.exit[g], last), last);
        }
        self.cut = cut(s.most(last));
    }

    /// Lets the children that a ray may meet wait.
    #[inline(always)]
    fn visit(&mut self, class: Class, at: Address, rays: u64) {
        let s = self.s;
        count(|c| {
            c.nodes += 1;
            c.ray_nodes += u64::from(rays.count_ones());
            c.node_lanes += (G * WIDTH) as u64;
        });
        // SAFETY: the address is the root's or that of an inner child of a node of this tree.
        let node = unsafe { self.nodes.node(at) };
        let frame = &mut self.stack[self.top];
        (frame.rays, frame.at) = (rays, at);
        let (mut near, mut far) = (s.f32s(self.enter), s.f32s(self.cut));
        for k in 0..3 {
            let up = class.descends[k] as usize;
            let (low, step) = (s.f32s(node.low[k]), s.cast_f32(s.u32s(node.steps[k] & STEP_BITS)));
            let first = s.bound_mul_add(s.load_u16(&node.planes[2 * k + up]), step, low);
            let last = s.bound_mul_add(s.load_u16(&node.planes[2 * k + 1 - up]), step, low);
            s.store(first, &mut frame.places[2 * k]);
            s.store(last, &mut frame.places[2 * k + 1]);
            let (start, [a, b]) = (self.bundle.plane_origin[k], self.bundle.inverse[k]);
            let (a, b, slack) = (s.f32s(a), s.f32s(b), s.f32s(self.bundle.slack[k]));
            let nearest = first - s.f32s(start[0]);
            let farthest = last - s.f32s(start[1]);
            near = s.larger(s.smaller(nearest * a, nearest * b) - slack, near);
            far = s.smaller(s.larger(farthest * a, farthest * b) + slack, far);
        }
        let met = s.le(near, far) & s.mask((1u32 << node.children()) - 1);
        let lanes = s.load_u32(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
        let keys = s.cast_f32((s.cast_u32(near) & s.u32s(!LANE_BITS)) | lanes);
        s.store(s.select(met, keys, s.f32s(f32::INFINITY)), &mut frame.keys);
        self.top += usize::from(s.any(met));
    }

    /// The rays among some that meet the box of a child that waits.
    #[inline(always)]
    fn active(&self, group: &Group<S, G>, frame: &Frame, lane: usize, rays: u64) -> u64 {
        let s = self.s;
        let mut active = 0;
        for g in 0..G {
            let among = (rays >> (g * WIDTH)) as u32 & 0xffff;
            if among == 0 {
                continue;
            }
            let (mut near, mut far) = (group.enter[g], group.exit[g]);
            for k in 0..3 {
                let (first, last) =
                    (s.f32s(frame.places[2 * k][lane]), s.f32s(frame.places[2 * k + 1][lane]));
                let inverse = group.inverse[k][g];
                near = s.larger(s.bound_mul_add(first, inverse, self.near[k][g]), near);
                far = s.smaller(s.bound_mul_add(last, inverse, self.far[k][g]), far);
            }
            active |= u64::from(s.bits(s.le(near, far)) & among) << (g * WIDTH);
        }
        active
    }
}
