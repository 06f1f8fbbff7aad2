//! The walk of up to 16·G rays together. Read `single.rs` first: this is the same walk, with an interval for each lane.
//!
//! Sources: Wald et al., *Interactive Rendering with Coherent Ray Tracing*, EG 2001, for packets. The comparisons are those of
//! `single.rs`: a lane's interval takes the same values here as there.
//!
//! A worked example with four lanes, at an inner node whose plane x = 5 is crossed by rays that go up in x; numbers are distances
//! along each ray, the slab's width is left out:
//!
//! ```text
//! lane                      0        1        2        3
//! interval [enter, exit]    [2, 9]   [2, 4]   [6, 9]   [3, 1]  empty: this ray has ended
//! meets the plane at        5        7        4        6
//! near child  [enter, min]  [2, 5]   [2, 4]   [6, 4]   [3, 1]  lanes 0 and 1 enter it
//! far child   [max, exit]   [5, 9]   [7, 4]   [6, 9]   [6, 1]  lanes 0 and 2 enter it
//! ```
//!
//! Some lane enters each child, so the far child's four intervals go to the stack and the walk goes on into the near child, where lane 2
//! is empty now. When the stack gives the far child back, each `exit` is cut to the lane's best hit so far: a hit of lane 0 at 4.5
//! leaves [5, 4.5], empty, and if lane 2 has ended too, the child is passed over. Intervals around all lanes ([`Span`], [`Bundle`])
//! decide most nodes before any lane is looked at.
//!
//! Deviations
//! 1. No mask says which rays are active: a ray is active where its interval is not empty. The slab rule of
//!    `prepared.rs` empties exactly the intervals of the children that the single walk leaves out. Where a plane's distance is NaN,
//!    no interval becomes empty, as in the single walk.
//! 2. G vectors share one walk: a node is fetched and decoded once for 64 rays.
//! 3. With a common origin the distance to a plane and to a triangle's corners is computed once for all rays.
//! 4. A triangle is fetched while the one before it is tested.

use super::bundle::Bundle;
use super::group::{Class, Group, Lanes, WIDTH};
use super::triangle::test;
use crate::layout::{Address, Ids, Nodes, Planes, Step};
use crate::simd::Simd;
use crate::traverse::counters::count;
use crate::traverse::prepared::{larger, smaller};

/// A far child to come back to, with the interval of each lane in it.
pub(crate) struct Far<S: Simd, const G: usize> {
    enter: Lanes<S::F, G>,
    exit: Lanes<S::F, G>,
    /// An interval around all of these.
    span: Span,
    node: Address,
}

/// An interval around the intervals of all rays of a walk, in scaled units. It may be longer than needed, as it is not shortened when
/// rays find hits.
#[derive(Clone, Copy)]
struct Span {
    enter: f32,
    exit: f32,
}

/// Far children, nearest last.
pub(crate) type Stack<S, const G: usize> = Vec<Far<S, G>>;

/// The point at which all rays of a walk with `COMMON` start, in scene units and in plane coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Eye {
    at: [f32; 3],
    plane_origin: [f32; 3],
}

impl Eye {
    #[inline(always)]
    pub(crate) fn new(at: [f32; 3], planes: &Planes) -> Self {
        let mut plane_origin = at;
        for k in 0..3 {
            plane_origin[k] = (at[k] - planes.low[k]) * planes.scale[k] + planes.shift;
        }
        Self { at, plane_origin }
    }
}

/// Traces the rays of `lanes`, which are all of one class, and with `COMMON` all start at `eye`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
pub(crate) fn walk<S: Simd, N: Nodes, const G: usize, const COMMON: bool, const ANY: bool>(
    s: S,
    nodes: N,
    group: &mut Group<S, G>,
    class: Class,
    lanes: u64,
    eye: Eye,
    stack: &mut Stack<S, G>,
) {
    // 1. The intervals of rays that do not take part in this walk are empty.
    let (mut enter, mut exit) = (group.enter, group.exit);
    for g in 0..G {
        let mask = s.mask((lanes >> (g * WIDTH)) as u32);
        enter[g] = s.select(mask, enter[g], s.f32s(f32::INFINITY));
        exit[g] = s.select(mask, exit[g], s.f32s(f32::NEG_INFINITY));
    }
    // 2. Intervals around all rays decide most nodes at once.
    let bundle = Bundle::new(s, group, class, lanes);
    let mut span = Span { enter: f32::INFINITY, exit: f32::NEG_INFINITY };
    for g in 0..G {
        span.enter = smaller(s.least(enter[g]), span.enter);
        span.exit = larger(s.most(exit[g]), span.exit);
    }
    stack.clear();
    let mut buffer = Ids::new();
    count(|c| (c.rays, c.walks) = (c.rays + u64::from(lanes.count_ones()), c.walks + 1));
    let mut address = Address::ROOT;
    loop {
        // SAFETY: the address is the root's or that of a child of a node of this tree.
        let mut step = unsafe { nodes.node(address) };
        count(|c| {
            c.nodes += 1;
            c.node_lanes += (G * WIDTH) as u64;
            for g in 0..G {
                c.ray_nodes += u64::from(s.bits(s.le(enter[g], exit[g])).count_ones());
            }
        });
        // 3. The triangles of this node: those of a leaf, or a T-reference. Leaves and inner nodes share the code that tests them, since
        //    it is inlined and is most of the kernel.
        let reference;
        let mut ids = match &mut step {
            // SAFETY: the leaf comes from this tree.
            Step::Leaf(leaf) => unsafe { nodes.take(leaf, &mut buffer) },
            Step::Inner(node) => match node.t_reference {
                None => &[],
                Some(id) => {
                    reference = [id];
                    &reference[..]
                }
            },
        };
        if !ids.is_empty() {
            while !ids.is_empty() {
                // SAFETY: a node of this tree names the triangles.
                unsafe { offer::<S, N, G, COMMON, ANY>(s, nodes, group, class, eye, ids, &enter, &exit) };
                ids = match &mut step {
                    // SAFETY: the leaf comes from this tree.
                    Step::Leaf(leaf) => unsafe { nodes.take(leaf, &mut buffer) },
                    Step::Inner(_) => &[],
                };
            }
            for g in 0..G {
                exit[g] = s.smaller(group.limit[g] * group.scale[g], exit[g]);
            }
        }
        // 4. At an inner node, the walk goes into one child, or into the near one with the far one on the stack.
        if let Step::Inner(node) = step {
            let axis = node.axis;
            let (near, far) = node.near_and_far(class.descends[axis].wrapping_neg());
            let (first, last) = bundle.slab(axis, node.split);
            if span.exit < first {
                count(|c| c.whole += 1);
                address = near;
                continue;
            }
            if last < span.enter {
                count(|c| c.whole += 1);
                address = far;
                continue;
            }
            // The intervals around all rays did not decide it, so each lane is looked at.
            let from_eye = s.f32s(node.split - eye.plane_origin[axis]);
            let split = s.f32s(node.split);
            let (mut far_enter, mut near_exit) = (enter, exit);
            let (mut into_near, mut into_far) = (s.mask(0), s.mask(0));
            for g in 0..G {
                let distance = if COMMON { from_eye } else { split - group.plane_origin[axis][g] };
                let middle = distance * group.inverse[axis][g];
                let slack = group.slack[axis][g];
                far_enter[g] = s.larger(middle - slack, enter[g]);
                near_exit[g] = s.smaller(middle + slack, exit[g]);
                into_near = into_near | s.le(enter[g], near_exit[g]);
                into_far = into_far | s.le(far_enter[g], exit[g]);
            }
            if !s.any(into_far) {
                address = near;
                continue;
            }
            if !s.any(into_near) {
                address = far;
                continue;
            }
            let beyond = Span { enter: larger(first, span.enter), exit: span.exit };
            stack.push(Far { enter: far_enter, exit, span: beyond, node: far });
            exit = near_exit;
            span.exit = smaller(last, span.exit);
            address = near;
            continue;
        }
        // 5. At a leaf, the walk goes back to the nearest far child in which some ray may still find a nearer hit.
        loop {
            let Some(far) = stack.pop() else { return };
            let mut active = s.mask(0);
            for g in 0..G {
                enter[g] = far.enter[g];
                exit[g] = s.smaller(group.limit[g] * group.scale[g], far.exit[g]);
                active = active | s.le(enter[g], exit[g]);
            }
            if s.any(active) {
                (address, span) = (far.node, far.span);
                break;
            }
        }
    }
}

/// Tests triangles against every vector that has active rays.
///
/// # Safety
/// The ids must come from the tree behind `nodes`.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
unsafe fn offer<S: Simd, N: Nodes, const G: usize, const COMMON: bool, const ANY: bool>(
    s: S,
    nodes: N,
    group: &mut Group<S, G>,
    class: Class,
    eye: Eye,
    ids: &[u32],
    enter: &Lanes<S::F, G>,
    exit: &Lanes<S::F, G>,
) {
    let mut active = [s.mask(0); G];
    for g in 0..G {
        active[g] = s.le(enter[g], exit[g]);
    }
    count(|c| c.triangles += ids.len() as u64);
    // SAFETY: the caller says that the ids come from this tree.
    let mut next = unsafe { nodes.corners(ids[0]) };
    for index in 0..ids.len() {
        let id = ids[index];
        let at = next;
        if let Some(&after) = ids.get(index + 1) {
            // SAFETY: the caller says that the ids come from this tree.
            next = unsafe { nodes.corners(after) };
        }
        test_all::<S, G, COMMON, ANY>(s, group, class, eye, &at, id, &mut active);
    }
}

/// Tests a triangle against every vector that has active rays; says whether any hit it. With `ANY`, those are active no longer.
#[inline(always)]
#[allow(clippy::too_many_arguments)]
pub(crate) fn test_all<S: Simd, const G: usize, const COMMON: bool, const ANY: bool>(
    s: S,
    group: &mut Group<S, G>,
    class: Class,
    eye: Eye,
    at: &[[f32; 3]; 3],
    id: u32,
    active: &mut Lanes<S::M, G>,
) -> bool {
    // The corners in the order of the class's axes, and relative to the common origin if there is one.
    let mut corners = *at;
    for i in 0..3 {
        for k in 0..3 {
            let x = at[i][class.axes[k]];
            corners[i][k] = if COMMON { x - eye.at[class.axes[k]] } else { x };
        }
    }
    let mut any = false;
    for g in 0..G {
        if s.any(active[g]) {
            count(|c| {
                c.triangle_lanes += WIDTH as u64;
                c.ray_triangles += u64::from(s.bits(active[g]).count_ones());
            });
            let hit = test::<S, G, COMMON, ANY>(s, group, g, active[g], class, &corners, id);
            any |= s.any(hit);
            if ANY {
                active[g] = active[g] & !hit;
            }
        }
    }
    any
}
