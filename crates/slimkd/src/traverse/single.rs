//! One ray at a time.
//!
//! Source: Havran 2001, *Heuristic Ray Shooting Algorithms*, §4.3 (front-to-back order with a stack of far children).
//!
//! Deviations
//! 1. Split planes are slabs, see `prepared.rs`; so the intervals of both children overlap a little, and a popped
//!    child is skipped only when the best hit lies strictly before its interval.
//! 2. T-references (Choi et al. 2013) are tested as soon as their node is visited, over the ray's whole interval. Such a
//!    hit is never rejected for lying outside the voxel.
//! 3. The stack's size comes from the tree's depth: it lies on the machine's stack up to [`SMALL_DEPTH`], on the heap beyond.
//! 4. Whether a far child stays on the stack is decided by a branch for coherent rays (`Sink::COHERENT`), and for all others by adding
//!    0 or 1 to the top of the stack. The processor predicts the branch well where a ray goes as the last one did, and badly where
//!    not; the addition needs no prediction, but the next pop must wait for it. Compared with the branch, the addition makes bounce rays
//!    7 to 15 % faster and camera rays in tiles up to 14 % slower; docs/kernels.md has the figures.
//!
//! docs/kernels.md lists what else was tried and not kept.

use super::counters::count;
use super::prepared::{PreparedRay, larger, smaller};
use super::sink::Sink;
use crate::layout::{Address, Ids, Nodes, Step};
use std::mem::MaybeUninit;

/// The deepest tree whose far children fit the stack on the machine's stack. The scenes measured so far are 30 to 60 deep.
const SMALL_DEPTH: usize = 64;

/// A far child to come back to, and the ray's interval in it.
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

/// [`traverse`] for rays whose longest axis is `Z`, a constant so that the triangle test needs no lookup of axes.
#[inline(always)]
fn along<const Z: usize>(nodes: impl Nodes, depth: u32, ray: &PreparedRay, sink: &mut impl Sink) {
    if depth as usize <= SMALL_DEPTH {
        walk::<Z, _>(nodes, ray, sink, &mut [MaybeUninit::uninit(); SMALL_DEPTH + 1]);
    } else {
        walk::<Z, _>(nodes, ray, sink, &mut vec![MaybeUninit::uninit(); depth as usize + 1]);
    }
}

/// The walk itself. A far child that may not be needed is written above the top of `stack` all the same, and is kept only where `top`
/// advances (deviation 4); so `stack` has room for one more entry than the tree is deep.
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
        // 1. Go down to the nearest leaf. Far children that the ray meets as well wait on the stack.
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
            // A T-reference is tested at once; a nearer hit shortens the interval.
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
            let middle = (inner.split - ray.plane_origin[axis]) * ray.inverse[axis];
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
                // Where only the near child is met, `exit` is less than `last`, so `smaller` below leaves it as it is.
                top += usize::from(S::COHERENT || !near_only);
                at = near;
                exit = smaller(last, exit);
            }
        };
        // 2. Test the leaf's triangles.
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
        // 3. Go back to the nearest far child that may hold something nearer than the best hit.
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
