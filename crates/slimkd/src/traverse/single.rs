//! One ray at a time through the 8-byte nodes.
//!
//! Source: Havran 2001, *Heuristic Ray Shooting Algorithms*, §4.3 (front-to-back order with a stack of far children).
//!
//! Deviations
//! 1. Split planes are slabs, see `prepared.rs`; so the intervals of both children overlap a little, and a popped
//!    child is skipped only when the best hit lies strictly before its interval.
//! 2. T-references (Choi et al. 2013): tested as soon as their node is visited, over the ray's whole interval. Such a
//!    hit is never rejected for lying outside the voxel.
//! 3. The stack's size comes from the built depth: on the machine's stack up to [`SMALL_DEPTH`], on the heap beyond.
//!
//! Tried and left: leaf tests four triangles at a time by SSE2 gathers from the bare mesh (5–12 % slower: the shuffles
//! eat what the lanes gain), projecting a candidate's corners again instead of keeping them (25 % slower).

use super::prepared::{PreparedRay, larger, smaller};
use super::sink::Sink;
use crate::tree::{Packed, TreeView};

/// Deepest tree whose far children fit the stack in the frame; scenes measured so far end at depth 30 to 60.
const SMALL_DEPTH: usize = 64;

/// A far child to come back to.
#[derive(Clone, Copy, Default)]
struct Far {
    node: u32,
    enter: f32,
    exit: f32,
}

/// Offers every triangle that the ray may hit to `sink`, nearer voxels first.
pub(crate) fn traverse(tree: TreeView<'_>, depth: u32, ray: &PreparedRay, sink: &mut impl Sink) {
    match ray.shear.axes[2] {
        0 => along::<0>(tree, depth, ray, sink),
        1 => along::<1>(tree, depth, ray, sink),
        _ => along::<2>(tree, depth, ray, sink),
    }
}

fn along<const Z: usize>(tree: TreeView<'_>, depth: u32, ray: &PreparedRay, sink: &mut impl Sink) {
    if depth as usize <= SMALL_DEPTH {
        walk::<Z>(tree, ray, sink, &mut [Far::default(); SMALL_DEPTH]);
    } else {
        walk::<Z>(tree, ray, sink, &mut vec![Far::default(); depth as usize]);
    }
}

#[inline(always)]
fn walk<const Z: usize>(tree: TreeView<'_>, ray: &PreparedRay, sink: &mut impl Sink, stack: &mut [Far]) {
    let mut top = 0;
    let mut node = tree.node(0);
    let (mut enter, mut exit) = (ray.enter, ray.exit);
    loop {
        while !node.is_leaf() {
            let axis = node.axis();
            let children = node.pointer();
            if node.has_t_reference() {
                let triangle = tree.node(children + 2).triangle();
                if ray.offer::<Z>(&tree.corners(triangle), triangle, sink) {
                    return;
                }
                exit = smaller(sink.limit() * ray.scale, exit);
            }
            let middle = (node.split() - ray.shear.origin[axis]) * ray.inverse[axis];
            let (first, last) = (middle - ray.slack[axis], middle + ray.slack[axis]);
            let near = ray.near[axis];
            if exit < first {
                node = tree.node(children + near);
            } else if last < enter {
                node = tree.node(children + (near ^ 1));
            } else {
                stack[top] = Far { node: children + (near ^ 1), enter: larger(first, enter), exit };
                top += 1;
                node = tree.node(children + near);
                exit = smaller(last, exit);
            }
        }
        if test_leaf::<Z>(tree, ray, node, sink) {
            return;
        }
        let limit = sink.limit() * ray.scale;
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            let far = stack[top];
            if far.enter <= limit {
                node = tree.node(far.node);
                enter = far.enter;
                exit = smaller(limit, far.exit);
                break;
            }
        }
    }
}

#[inline(always)]
fn test_leaf<const Z: usize>(
    tree: TreeView<'_>,
    ray: &PreparedRay,
    node: Packed,
    sink: &mut impl Sink,
) -> bool {
    let first = node.pointer();
    if node.is_2byte() {
        let upper = node.upper();
        for &lower in tree.indices_2byte(first, node.count_2byte()) {
            let id = upper | u32::from(lower);
            if ray.offer::<Z>(&tree.corners(id), id, sink) {
                return true;
            }
        }
    } else {
        for &id in tree.indices_4byte(first, node.count_4byte()) {
            if ray.offer::<Z>(&tree.corners(id), id, sink) {
                return true;
            }
        }
    }
    false
}
