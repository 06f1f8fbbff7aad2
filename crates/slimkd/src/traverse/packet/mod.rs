//! Coherent rays: groups of 64, packets of 16, and what becomes of rays that do not fit in.
//!
//! Source: Choi, Chang & Ihm 2013 trace 4×4 SIMD packets. Deviation: four of those share one walk; see `walk.rs`.
//!
//! Rays of one walk must agree in the signs of their direction and in its longest axis. Those that do not are walked
//! class by class; what is left over goes in packets of 16 and, below [`FEWEST`], back to the caller, who makes a stream
//! of it. Every kernel gives the same hits, so this is about speed alone.

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

/// Vectors of a group.
const VECTORS: usize = 4;
/// Rays of a group.
const RAYS: usize = VECTORS * WIDTH;
/// Fewer rays than these are walked as packets of 16, not as a group.
const FEW: u32 = 16;
/// Fewer rays than these in a packet are left to streams.
const FEWEST: u32 = 7;

/// What a hit's place holds before it is written.
const NOTHING: Hit = Hit { t: 0.0, u: 0.0, v: 0.0, triangle: u32::MAX };
/// Where the hits of a vector's lanes lie, bytes.
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

/// Of groups and of packets; kept from one to the next.
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

/// Traces at most [`RAYS`], the first of which stands at `first` in the batch; `group` then holds what they found. Returns the rays that are left to streams.
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
    let classes = group.fill(s, rays, tree.bounds, planes);
    group.leave_out(s, except.map(|except| &except[first..first + rays.len()]));
    let mut alone = 0;
    let mut left = if tree.bounds.is_empty() { 0 } else { classes.traced };
    while left != 0 {
        let first = left.trailing_zeros();
        let (class, lanes) = classes.of(first, left);
        left &= !lanes;
        let at = rays[first as usize].origin;
        let eye = Eye::new(at, planes);
        if lanes.count_ones() < FEW {
            for g in 0..VECTORS {
                let part = lanes >> (g * WIDTH) & 0xffff;
                if part.count_ones() < FEWEST {
                    alone |= part << (g * WIDTH);
                } else {
                    let mut packet = group.part(g);
                    let stack = &mut stacks.packet;
                    walk::<S, N, 1, false, ANY>(s, tree.nodes, &mut packet, class, part, eye, stack);
                    group.take(g, &packet);
                }
            }
        } else if group.all_start_at(s, at, lanes) {
            let stack = &mut stacks.group;
            walk::<S, N, VECTORS, true, ANY>(s, tree.nodes, group, class, lanes, eye, stack);
        } else {
            let stack = &mut stacks.group;
            walk::<S, N, VECTORS, false, ANY>(s, tree.nodes, group, class, lanes, eye, stack);
        }
    }
    alone
}

/// Calls `what` with the places of the set bits.
#[inline(always)]
fn each(mut bits: u64, mut what: impl FnMut(usize)) {
    while bits != 0 {
        what(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
