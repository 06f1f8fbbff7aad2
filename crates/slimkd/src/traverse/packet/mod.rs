//! Coherent rays: groups of 64, packets of 16, and what becomes of rays that do not fit in.
//!
//! Source: Choi, Chang & Ihm 2013 trace 4×4 SIMD packets. Deviation: four of those share one walk; see `walk.rs`.
//!
//! Rays of one walk must agree in the signs of their direction and in its longest axis. Those that do not are walked
//! class by class; what is left over goes in packets of 16 and, below [`FEWEST`], ray by ray. Every kernel gives the
//! same hits, so this is about speed alone.

mod group;
mod triangle;
mod walk;

use super::arch::{Kernel, Simd};
use super::sink::{Any, Closest, Sink};
use super::{Hit, Planes, PreparedRay, traverse};
use crate::geometry::{Aabb, Ray};
use crate::tree::Nodes;
use group::{Group, WIDTH};
use walk::{Eye, Stack, walk};

/// Vectors of a group.
const VECTORS: usize = 4;
/// Rays of a group.
const RAYS: usize = VECTORS * WIDTH;
/// Fewer rays than these are walked as packets of 16, not as a group.
const FEW: u32 = 24;
/// Fewer rays than these in a packet are traced one by one.
const FEWEST: u32 = 3;

/// The tree as every kernel needs it.
#[derive(Clone, Copy)]
pub(crate) struct Traced<'a, N> {
    pub(crate) nodes: N,
    pub(crate) depth: u32,
    pub(crate) bounds: &'a Aabb,
}

impl<N: Nodes> Traced<'_, N> {
    /// One ray on its own.
    fn single(&self, ray: &Ray, planes: &Planes, sink: &mut impl Sink) {
        if let Some(prepared) = PreparedRay::new(ray, self.bounds, planes) {
            traverse(self.nodes, self.depth, &prepared, sink);
        }
    }
}

/// Closest hits of coherent rays.
pub(crate) struct ClosestHits<'a, N> {
    pub(crate) tree: Traced<'a, N>,
    pub(crate) rays: &'a [Ray],
    pub(crate) hits: &'a mut [Option<Hit>],
}

impl<N: Nodes> Kernel for ClosestHits<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let planes = self.tree.nodes.planes();
        let mut stacks = Stacks::new(self.tree.depth);
        for (rays, hits) in self.rays.chunks(RAYS).zip(self.hits.chunks_mut(RAYS)) {
            let (group, alone) = trace::<S, N, false>(s, self.tree, &planes, rays, &mut stacks);
            let mut triangle = [[0u32; WIDTH]; VECTORS];
            let [mut t, mut u, mut v] = [[[0.0f32; WIDTH]; VECTORS]; 3];
            for g in 0..VECTORS {
                s.store_u32(group.triangle[g], &mut triangle[g]);
                s.store(group.limit[g], &mut t[g]);
                s.store(group.u[g], &mut u[g]);
                s.store(group.v[g], &mut v[g]);
            }
            let found = triangle.as_flattened().iter().zip(t.as_flattened());
            let found = found.zip(u.as_flattened().iter().zip(v.as_flattened()));
            for (hit, ((&triangle, &t), (&u, &v))) in hits.iter_mut().zip(found) {
                *hit = if triangle == u32::MAX { None } else { Some(Hit { t, u, v, triangle }) };
            }
            each(alone, |i| {
                let mut sink = Closest::new(rays[i].t_max);
                self.tree.single(&rays[i], &planes, &mut sink);
                hits[i] = sink.into_hit();
            });
        }
    }
}

/// Any-hit answers of coherent rays.
pub(crate) struct AnyHits<'a, N> {
    pub(crate) tree: Traced<'a, N>,
    pub(crate) rays: &'a [Ray],
    pub(crate) hits: &'a mut [bool],
}

impl<N: Nodes> Kernel for AnyHits<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let planes = self.tree.nodes.planes();
        let mut stacks = Stacks::new(self.tree.depth);
        for (rays, hits) in self.rays.chunks(RAYS).zip(self.hits.chunks_mut(RAYS)) {
            let (group, alone) = trace::<S, N, true>(s, self.tree, &planes, rays, &mut stacks);
            let mut found = 0;
            for g in 0..VECTORS {
                let missed = s.eq_u32(group.triangle[g], s.u32s(u32::MAX));
                found |= u64::from(s.bits(!missed)) << (g * WIDTH);
            }
            for (i, hit) in hits.iter_mut().enumerate() {
                *hit = found >> i & 1 == 1;
            }
            each(alone, |i| {
                let mut sink = Any { found: false, t_max: rays[i].t_max };
                self.tree.single(&rays[i], &planes, &mut sink);
                hits[i] = sink.found;
            });
        }
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

/// Traces at most [`RAYS`]; returns what they found, and the rays that the caller must trace one by one.
#[inline(always)]
fn trace<S: Simd, N: Nodes, const ANY: bool>(
    s: S,
    tree: Traced<'_, N>,
    planes: &Planes,
    rays: &[Ray],
    stacks: &mut Stacks<S>,
) -> (Group<S, VECTORS>, u64) {
    let (mut group, classes) = Group::new(s, rays, tree.bounds, planes);
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
            walk::<S, N, VECTORS, true, ANY>(s, tree.nodes, &mut group, class, lanes, eye, stack);
        } else {
            let stack = &mut stacks.group;
            walk::<S, N, VECTORS, false, ANY>(s, tree.nodes, &mut group, class, lanes, eye, stack);
        }
    }
    (group, alone)
}

/// Calls `what` with the places of the set bits.
#[inline(always)]
fn each(mut bits: u64, mut what: impl FnMut(usize)) {
    while bits != 0 {
        what(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}
