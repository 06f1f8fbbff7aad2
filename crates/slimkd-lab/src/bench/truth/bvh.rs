//! The judge's hierarchy: boxes in f64, split by the surface area heuristic, or in two halves where that finds nothing. As
//! plain as 10⁸ rays allow.
//!
//! Source: Wald, *On fast Construction of SAH-based Bounding Volume Hierarchies*, RT 2007, for the bins.

use super::triangle::Frame;
use slimkd::TriangleMesh;

/// Triangles of a leaf.
const LEAF: usize = 4;
/// Bins that a split lies between.
const BINS: usize = 16;

#[derive(Clone, Copy)]
struct Box3 {
    low: [f64; 3],
    high: [f64; 3],
}

impl Box3 {
    const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    fn of(mesh: &TriangleMesh, id: u32) -> Self {
        let mut bounds = Self::EMPTY;
        for corner in mesh.corners(id) {
            let point = corner.map(f64::from);
            bounds.grow(&Self { low: point, high: point });
        }
        bounds
    }

    fn grow(&mut self, other: &Self) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(other.low[k]);
            self.high[k] = self.high[k].max(other.high[k]);
        }
    }

    fn extent(&self, k: usize) -> f64 {
        self.high[k] - self.low[k]
    }

    /// Half the surface; 0 when nothing is in it.
    fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|k| self.extent(k).max(0.0));
        x * y + y * z + z * x
    }
}

struct Node {
    bounds: Box3,
    /// Leaves: the first triangle. Inner nodes: the right child; the left one follows its parent.
    at: u32,
    /// Triangles of a leaf; 0 in inner nodes.
    count: u32,
}

pub(super) struct Bvh {
    nodes: Vec<Node>,
    ids: Vec<u32>,
}

impl Bvh {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        // A triangle with a corner that is not finite is never hit.
        let finite = |&id: &u32| mesh.corners(id).iter().flatten().all(|x| x.is_finite());
        let mut ids: Vec<u32> = (0..mesh.len() as u32).filter(finite).collect();
        let mut nodes: Vec<Node> = Vec::new();
        // Ranges to split, and the parent whose right child it is.
        let mut work = vec![(0, ids.len(), None)];
        while let Some((first, last, parent)) = work.pop() {
            if first == last {
                continue;
            }
            let here = nodes.len();
            if let Some(parent) = parent {
                nodes[parent as usize].at = here as u32;
            }
            let range = &mut ids[first..last];
            let mut bounds = Box3::EMPTY;
            range.iter().for_each(|&id| bounds.grow(&Box3::of(mesh, id)));
            if range.len() <= LEAF {
                nodes.push(Node { bounds, at: first as u32, count: range.len() as u32 });
                continue;
            }
            let middle = first + split(mesh, range, &bounds);
            nodes.push(Node { bounds, at: 0, count: 0 });
            work.push((middle, last, Some(here as u32)));
            work.push((first, middle, None));
        }
        Self { nodes, ids }
    }

    /// Calls `visit` for triangles that the ray may hit before `limit` until it says stop; whether it did.
    pub(super) fn visit(&self, frame: &Frame, limit: f64, mut visit: impl FnMut(u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let limit = limit.min(frame.t_max);
        let mut stack = Vec::with_capacity(64);
        stack.push(0u32);
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !node.meets(frame, limit) {
                continue;
            }
            if node.count == 0 {
                stack.push(node.at);
                stack.push(at + 1);
                continue;
            }
            let first = node.at as usize;
            for &id in &self.ids[first..first + node.count as usize] {
                if visit(id) {
                    return true;
                }
            }
        }
        false
    }
}

/// Orders two triangles or more by side; how many go left, at least one and not all.
fn split(mesh: &TriangleMesh, ids: &mut [u32], bounds: &Box3) -> usize {
    let middle = |id: u32, axis: usize| {
        let bounds = Box3::of(mesh, id);
        0.5 * bounds.low[axis] + 0.5 * bounds.high[axis]
    };
    let bin = |id: u32, axis: usize| {
        let at = (middle(id, axis) - bounds.low[axis]) / bounds.extent(axis);
        ((at * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best = (f64::INFINITY, 0, 0, 0);
    for axis in 0..3 {
        let mut bins = [(0usize, Box3::EMPTY); BINS];
        for &id in &*ids {
            let (count, all) = &mut bins[bin(id, axis)];
            *count += 1;
            all.grow(&Box3::of(mesh, id));
        }
        // Count times area of what lies right of each border.
        let (mut count, mut all, mut right) = (0, Box3::EMPTY, [0.0; BINS]);
        for at in (1..BINS).rev() {
            count += bins[at].0;
            all.grow(&bins[at].1);
            right[at] = count as f64 * all.area();
        }
        let (mut count, mut all) = (0, Box3::EMPTY);
        for at in 1..BINS {
            count += bins[at - 1].0;
            all.grow(&bins[at - 1].1);
            let cost = count as f64 * all.area() + right[at];
            if 0 < count && count < ids.len() && cost < best.0 {
                best = (cost, axis, at, count);
            }
        }
    }
    let (_, axis, border, lefts) = best;
    if lefts == 0 {
        let axis = (1..3).fold(0, |best, k| if bounds.extent(k) > bounds.extent(best) { k } else { best });
        let half = ids.len() / 2;
        ids.select_nth_unstable_by(half, |&a, &b| middle(a, axis).total_cmp(&middle(b, axis)));
        return half;
    }
    ids.sort_by_key(|&id| bin(id, axis) >= border);
    lefts
}

impl Node {
    /// Whether the ray meets the box, widened by what corners may move.
    #[inline(always)]
    fn meets(&self, frame: &Frame, limit: f64) -> bool {
        let (mut enter, mut exit) = (frame.t_min, limit);
        for k in 0..3 {
            let low = (self.bounds.low[k] - frame.above[k]) * frame.inverse[k];
            let high = (self.bounds.high[k] - frame.below[k]) * frame.inverse[k];
            let (first, last) = if frame.inverse[k] < 0.0 { (high, low) } else { (low, high) };
            // NaN, where the ray runs in a face, says nothing.
            enter = if first > enter { first } else { enter };
            exit = if last < exit { last } else { exit };
        }
        // An interval that begins at an end of the ray's counts.
        enter <= exit + 1e-6 * exit.abs()
    }
}
