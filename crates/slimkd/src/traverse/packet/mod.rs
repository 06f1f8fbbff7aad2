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
pub(super) use bundle::Bundle;
pub(super) use group::{Class, Group, WIDTH};
pub(crate) use strays::{Strays, finish};
pub(super) use walk::{Eye, test_all};
use walk::{Stack, walk};

/// The number of vectors in a group.
const VECTORS: usize = 4;
/// The number of rays in a group.
const RAYS: usize = VECTORS * WIDTH;
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

/// A tree that groups of rays of one class go through.
pub(crate) trait Grouped: Copy {
    /// A class of fewer rays does not walk as a group. `mixed` says how much the directions of the 64 rays differ: [`Classes::mixed`].
    fn few(mixed: u32) -> u32;
    /// Whether it then walks in packets, the rays of one vector each; else its rays are strays.
    const PACKETS: bool;
    /// What a walk needs beside the group. It is made once and used by one walk after the other.
    type Stack<S: Simd, const G: usize>;

    fn stack<S: Simd, const G: usize>(depth: u32) -> Self::Stack<S, G>;

    /// The coordinates in which rays are prepared.
    fn coordinates(self) -> Planes;

    /// The rays of a group that its walks take, a bit each.
    fn takes<S: Simd, const G: usize>(self, _: S, _: &Group<S, G>) -> u64 {
        u64::MAX
    }

    /// Traces the rays of `lanes`, which are all of one class, and with `COMMON` all start at `eye`.
    #[allow(clippy::too_many_arguments)]
    fn walk<S: Simd, const G: usize, const COMMON: bool, const ANY: bool>(
        self,
        s: S,
        group: &mut Group<S, G>,
        class: Class,
        lanes: u64,
        eye: Eye,
        stack: &mut Self::Stack<S, G>,
    );
}

/// A class of fewer rays is walked in packets, not as a group.
const FEW: u32 = 16;

impl<N: Nodes> Grouped for N {
    const PACKETS: bool = true;
    type Stack<S: Simd, const G: usize> = Stack<S, G>;

    fn stack<S: Simd, const G: usize>(depth: u32) -> Stack<S, G> {
        Vec::with_capacity(depth as usize)
    }

    fn few(_: u32) -> u32 {
        FEW
    }

    fn coordinates(self) -> Planes {
        self.planes()
    }

    #[inline(always)]
    fn walk<S: Simd, const G: usize, const COMMON: bool, const ANY: bool>(
        self,
        s: S,
        group: &mut Group<S, G>,
        class: Class,
        lanes: u64,
        eye: Eye,
        stack: &mut Stack<S, G>,
    ) {
        walk::<S, N, G, COMMON, ANY>(s, self, group, class, lanes, eye, stack);
    }
}

/// Closest hits of coherent rays.
pub(crate) struct ClosestHits<'a, N> {
    pub(crate) tree: Traced<'a, N>,
    pub(crate) rays: &'a [Ray],
    /// The triangle that each ray leaves out, if any do.
    pub(crate) except: Option<&'a [u32]>,
    pub(crate) hits: &'a mut [Option<Hit>],
}

impl<N: Grouped> Kernel for ClosestHits<'_, N> {
    type Output = Strays;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Strays {
        let planes = self.tree.nodes.coordinates();
        let mut stacks = Stacks::<S, N>::new(self.tree.depth);
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

impl<N: Grouped> Kernel for AnyHits<'_, N> {
    type Output = Strays;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Strays {
        let planes = self.tree.nodes.coordinates();
        let mut stacks = Stacks::<S, N>::new(self.tree.depth);
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
struct Stacks<S: Simd, N: Grouped> {
    group: N::Stack<S, VECTORS>,
    packet: N::Stack<S, 1>,
}

impl<S: Simd, N: Grouped> Stacks<S, N> {
    #[inline(always)]
    fn new(depth: u32) -> Self {
        Self { group: N::stack::<S, VECTORS>(depth), packet: N::stack::<S, 1>(depth) }
    }
}

/// Traces at most [`RAYS`] rays; `first` is the position of the first one in the batch. Afterwards `group` holds their hits. Returns
/// the strays, a bit for each ray.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn trace<S: Simd, N: Grouped, const ANY: bool>(
    s: S,
    tree: Traced<'_, N>,
    planes: &Planes,
    rays: &[Ray],
    except: Option<&[u32]>,
    first: usize,
    group: &mut Group<S, VECTORS>,
    stacks: &mut Stacks<S, N>,
) -> u64 {
    // 1. Prepare the rays; those that are invalid or miss the bounds are not traced.
    let classes = group.fill(s, rays, tree.bounds, planes);
    group.leave_out(s, except.map(|except| &except[first..first + rays.len()]));
    let mut left = if tree.bounds.is_empty() { 0 } else { classes.traced };
    let taken = tree.nodes.takes(s, group);
    let few = N::few(classes.mixed());
    let mut strays = left & !taken;
    left &= taken;
    while left != 0 {
        // 2. The class of the first ray that is left, and all rays of that class.
        let leader = left.trailing_zeros();
        let (class, lanes) = classes.of(leader, left);
        left &= !lanes;
        let start = rays[leader as usize].origin;
        let eye = Eye::new(start, planes);
        // 3. Few rays go as packets or are strays; many go as a group, which is faster where all start at one point.
        if lanes.count_ones() < few {
            for g in 0..VECTORS {
                let part = lanes >> (g * WIDTH) & 0xffff;
                if part.count_ones() < FEWEST || !N::PACKETS {
                    strays |= part << (g * WIDTH);
                } else {
                    let mut packet = group.part(g);
                    let stack = &mut stacks.packet;
                    tree.nodes.walk::<S, 1, false, ANY>(s, &mut packet, class, part, eye, stack);
                    group.take(g, &packet);
                }
            }
        } else if group.all_start_at(s, start, lanes) {
            let stack = &mut stacks.group;
            tree.nodes.walk::<S, VECTORS, true, ANY>(s, group, class, lanes, eye, stack);
        } else {
            let stack = &mut stacks.group;
            tree.nodes.walk::<S, VECTORS, false, ANY>(s, group, class, lanes, eye, stack);
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
