//! Coherent rays: groups of 64, packets of 16, and strays.
//!
//! Source: Choi, Chang & Ihm 2013 trace 4×4 SIMD packets. Deviation: four of those share one walk; see `walk.rs`.
//!
//! The rays of one walk must be of one class: they agree in the signs of their direction's components and in its longest axis. 64 rays
//! of several classes are walked class by class. A class of fewer than [`FEW`] rays is walked in packets, the rays of one vector
//! each. Where a packet would have fewer than [`FEWEST`] rays, they are strays: the caller traces those as a stream. Every kernel
//! gives the same hits, so these decisions concern speed alone.

mod bundle;
mod group;
mod strays;
mod triangle;
mod walk;

use super::Traced;
use crate::geometry::{Hit, Ray};
use crate::layout::{Nodes, Planes};
use crate::simd::{Kernel, Simd};
use group::{Group, WIDTH};
pub(crate) use strays::{Strays, finish};
use walk::{Eye, Stack, walk};

/// The number of vectors in a group.
const VECTORS: usize = 4;
/// The number of rays in a group.
const RAYS: usize = VECTORS * WIDTH;
/// A class of fewer rays is walked in packets, not as a group.
const FEW: u32 = 16;
/// Fewer rays in a packet are strays.
const FEWEST: u32 = 7;

/// What a hit's place holds before it is written.
const NOTHING: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, triangle: u32::MAX };
/// The offsets in bytes of the hits of a vector's lanes, in an array of hits.
const HIT_PLACES: [u32; WIDTH] = {
    let mut places = [0; WIDTH];
    let mut lane = 0;
    while lane < WIDTH {
        places[lane] = (lane * size_of::<Hit>()) as u32;
        lane += 1;
    }
    places
};

/// Closest hits of coherent rays.
pub(crate) struct ClosestHits<'a, N> {
    pub(crate) tree: Traced<'a, N>,
    pub(crate) rays: &'a [Ray],
    /// The triangle that each ray leaves out, if any do.
    pub(crate) except: Option<&'a [u32]>,
    pub(crate) hits: &'a mut [Option<Hit>],
}

impl<N: Nodes> Kernel for ClosestHits<'_, N> {
    type Output = Strays;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Strays {
        let planes = self.tree.nodes.planes();
        let mut stacks = Stacks::new(self.tree.depth);
        let mut group = Group::new(s);
        let mut found = [NOTHING; RAYS];
        let mut strays = Strays::new();
        let mut first = 0;
        for (rays, hits) in self.rays.chunks(RAYS).zip(self.hits.chunks_mut(RAYS)) {
            let alone = trace::<S, N, false>(
                s,
                self.tree,
                &planes,
                rays,
                self.except,
                first,
                &mut group,
                &mut stacks,
            );
            for g in 0..VECTORS {
                // `limit` is the t of the best hit.
                let rows = [s.cast_u32(group.limit[g]), s.cast_u32(group.u[g]), s.cast_u32(group.v[g])];
                let rows = [rows[0], rows[1], rows[2], group.triangle[g]];
                // SAFETY: a hit is `repr(C)` and holds t, u, v, triangle: 16 bytes. There is one for each lane.
                unsafe { s.store_rows(found[g * WIDTH..].as_mut_ptr().cast(), &HIT_PLACES, rows) };
            }
            for (hit, found) in hits.iter_mut().zip(&found) {
                *hit = (found.triangle != u32::MAX).then_some(*found);
            }
            each(alone, |i| strays.push(first + i));
            first += RAYS;
        }
        strays
    }
}

/// Any-hit answers of coherent rays.
pub(crate) struct AnyHits<'a, N> {
    pub(crate) tree: Traced<'a, N>,
    pub(crate) rays: &'a [Ray],
    /// The triangle that each ray leaves out, if any do.
    pub(crate) except: Option<&'a [u32]>,
    pub(crate) hits: &'a mut [bool],
}

impl<N: Nodes> Kernel for AnyHits<'_, N> {
    type Output = Strays;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Strays {
        let planes = self.tree.nodes.planes();
        let mut stacks = Stacks::new(self.tree.depth);
        let mut group = Group::new(s);
        let mut strays = Strays::new();
        let mut first = 0;
        for (rays, hits) in self.rays.chunks(RAYS).zip(self.hits.chunks_mut(RAYS)) {
            let alone =
                trace::<S, N, true>(s, self.tree, &planes, rays, self.except, first, &mut group, &mut stacks);
            let mut found = 0;
            for g in 0..VECTORS {
                let missed = s.eq_u32(group.triangle[g], s.u32s(u32::MAX));
                found |= u64::from(s.bits(!missed)) << (g * WIDTH);
            }
            for hit in hits {
                *hit = found & 1 == 1;
                found >>= 1;
            }
            each(alone, |i| strays.push(first + i));
            first += RAYS;
        }
        strays
    }
}

/// The stacks of groups and of packets. They are allocated once and used by one walk after the other.
struct Stacks<S: Simd> {
    group: Stack<S, VECTORS>,
    packet: Stack<S, 1>,
}

impl<S: Simd> Stacks<S> {
    #[inline(always)]
    fn new(depth: u32) -> Self {
        let depth = depth as usize;
        Self { group: Vec::with_capacity(depth), packet: Vec::with_capacity(depth) }
    }
}

/// Traces at most [`RAYS`] rays; `first` is the position of the first one in the batch. Afterwards `group` holds their hits. Returns
/// the strays, a bit for each ray.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn trace<S: Simd, N: Nodes, const ANY: bool>(
    s: S,
    tree: Traced<'_, N>,
    planes: &Planes,
    rays: &[Ray],
    except: Option<&[u32]>,
    first: usize,
    group: &mut Group<S, VECTORS>,
    stacks: &mut Stacks<S>,
) -> u64 {
    // 1. Prepare the rays; those that are invalid or miss the bounds are not traced.
    let classes = group.fill(s, rays, tree.bounds, planes);
    group.leave_out(s, except.map(|except| &except[first..first + rays.len()]));
    let mut strays = 0;
    let mut left = if tree.bounds.is_empty() { 0 } else { classes.traced };
    while left != 0 {
        // 2. The class of the first ray that is left, and all rays of that class.
        let leader = left.trailing_zeros();
        let (class, lanes) = classes.of(leader, left);
        left &= !lanes;
        let start = rays[leader as usize].origin;
        let eye = Eye::new(start, planes);
        // 3. Few rays go as packets or are strays; many go as a group, which is faster where all start at one point.
        if lanes.count_ones() < FEW {
            for g in 0..VECTORS {
                let part = lanes >> (g * WIDTH) & 0xffff;
                if part.count_ones() < FEWEST {
                    strays |= part << (g * WIDTH);
                } else {
                    let mut packet = group.part(g);
                    let stack = &mut stacks.packet;
                    walk::<S, N, 1, false, ANY>(s, tree.nodes, &mut packet, class, part, eye, stack);
                    group.take(g, &packet);
                }
            }
        } else if group.all_start_at(s, start, lanes) {
            let stack = &mut stacks.group;
            walk::<S, N, VECTORS, true, ANY>(s, tree.nodes, group, class, lanes, eye, stack);
        } else {
            let stack = &mut stacks.group;
            walk::<S, N, VECTORS, false, ANY>(s, tree.nodes, group, class, lanes, eye, stack);
        }
    }
    strays
}

/// Calls `what` with the position of each bit that is set.
#[inline(always)]
fn each(mut bits: u64, mut what: impl FnMut(usize)) {
    while bits != 0 {
        what(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
