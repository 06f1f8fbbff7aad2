//! One ray at a time.
//!
//! Source: Havran 2001, *Heuristic Ray Shooting Algorithms*, §4.3 (front-to-back order with a stack of far children).
//!
//! Deviations
//! 1. Split planes are slabs, see `prepared.rs`; so the intervals of both children overlap a little, and a popped
//!    child is skipped only when the best hit lies strictly before its interval.
//! 2. T-references (Choi et al. 2013): tested as soon as their node is visited, over the ray's whole interval. Such a
//!    hit is never rejected for lying outside the voxel.
//! 3. The stack's size comes from the built depth: on the machine's stack up to [`SMALL_DEPTH`], on the heap beyond.
//! 4. Whether a far child is kept is a branch where rays go side by side, and else a number added to the stack's top: a
//!    branch is cheap where the last ray foretells it and dear where not, the sum always costs a wait at the next pop.
//!    Bounce rays gain 7 to 15 %, camera rays in tiles lose up to 14 %; docs/kernels.md has the figures.
//!
//! docs/kernels.md lists what was tried and left.

use super::counters::count;
use super::prepared::{PreparedRay, larger, smaller};
use super::sink::Sink;
use crate::layout::{Address, Ids, Nodes, Step};
use std::mem::MaybeUninit;

/// Deepest tree whose far children fit the stack in the frame; scenes measured so far end at depth 30 to 60.
const SMALL_DEPTH: usize = 64;

/// A far child to come back to.
#[derive(Clone, Copy)]
struct Far {
    node: Address,
    enter: f32,
    exit: f32,
}

/// Offers every triangle that the ray may hit to `sink`, nearer voxels first.
#[inline(always)]
pub(crate) fn traverse(nodes: impl Nodes, depth: u32, ray: &PreparedRay, sink: &mut impl Sink) {
    match ray.shear.axes[2] {
        0 => along::<0>(nodes, depth, ray, sink),
        1 => along::<1>(nodes, depth, ray, sink),
        _ => along::<2>(nodes, depth, ray, sink),
    }
}

#[inline(always)]
fn along<const Z: usize>(nodes: impl Nodes, depth: u32, ray: &PreparedRay, sink: &mut impl Sink) {
    if depth as usize <= SMALL_DEPTH {
        walk::<Z, _>(nodes, ray, sink, &mut [MaybeUninit::uninit(); SMALL_DEPTH + 1]);
    } else {
        walk::<Z, _>(nodes, ray, sink, &mut vec![MaybeUninit::uninit(); depth as usize + 1]);
    }
}

/// `stack` has room for one more than the depth: the far child is written whether or not it is kept, so that this is no branch, and
/// kept only where `top` advances.
#[inline(always)]
fn walk<const Z: usize, S: Sink>(
    nodes: impl Nodes,
    ray: &PreparedRay,
    sink: &mut S,
    stack: &mut [MaybeUninit<Far>],
) {
    let mut top = 0;
    let mut buffer = Ids::new();
    let mut at = Address::ROOT;
    let (mut enter, mut exit) = (ray.enter, ray.exit);
    count(|c| (c.rays, c.walks) = (c.rays + 1, c.walks + 1));
    loop {
        // Down to the nearest leaf; far children that the ray meets too wait on the stack.
        let mut leaf = loop {
            sink.visit();
            count(|c| {
                (c.nodes, c.ray_nodes, c.node_lanes) = (c.nodes + 1, c.ray_nodes + 1, c.node_lanes + 1)
            });
            // SAFETY: `at` is the root or a child of a node of this tree.
            let inner = match unsafe { nodes.node(at) } {
                Step::Inner(inner) => inner,
                Step::Leaf(leaf) => break leaf,
            };
            if let Some(triangle) = inner.t_reference
                && !sink.knows(triangle)
            {
                sink.test();
                // SAFETY: an inner node of this tree names the triangle.
                if ray.offer::<Z>(&unsafe { nodes.corners(triangle) }, triangle, sink) {
                    return;
                }
                exit = smaller(sink.limit() * ray.scale, exit);
            }
            // The plane is a slab: the ray leaves the near child at `last` and enters the far one at `first`.
            let axis = inner.axis;
            let middle = (inner.split - ray.origin[axis]) * ray.inverse[axis];
            let (first, last) = (middle - ray.slack[axis], middle + ray.slack[axis]);
            let (near, far) = inner.near_and_far(ray.descends[axis]);
            let near_only = exit < first;
            if S::COHERENT && near_only {
                at = near;
            } else if last < enter {
                at = far;
            } else {
                let Some(place) = stack.get_mut(top) else { return nodes.too_deep() };
                place.write(Far { node: far, enter: larger(first, enter), exit });
                // Where only the near child is met, `exit` lies before `last` and stays.
                top += usize::from(S::COHERENT || !near_only);
                at = near;
                exit = smaller(last, exit);
            }
        };
        loop {
            // SAFETY: the leaf comes from this tree.
            let ids = unsafe { nodes.take(&mut leaf, &mut buffer) };
            if ids.is_empty() {
                break;
            }
            for &id in ids {
                if sink.knows(id) {
                    continue;
                }
                sink.test();
                // SAFETY: a leaf of this tree names the triangle.
                if ray.offer::<Z>(&unsafe { nodes.corners(id) }, id, sink) {
                    return;
                }
            }
        }
        // Back to the nearest far child that may hold something nearer than the best hit.
        let limit = sink.limit() * ray.scale;
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            // SAFETY: every entry below the top was written before the top went beyond it.
            let far = unsafe { stack[top].assume_init() };
            if far.enter <= limit {
                at = far.node;
                enter = far.enter;
                exit = smaller(limit, far.exit);
                break;
            }
        }
    }
}
