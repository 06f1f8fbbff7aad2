//! The judge's hierarchy: boxes in f64, split at the middle triangle. Plain rather than fast.

use super::triangle::Frame;
use slimkd::TriangleMesh;

/// Triangles of a leaf.
const LEAF: usize = 4;

struct Node {
    low: [f64; 3],
    high: [f64; 3],
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
        let mut nodes = Vec::new();
        // Ranges to split, and the parent whose right child it is.
        let mut work = vec![(0, ids.len(), None)];
        while let Some((first, last, parent)) = work.pop() {
            if first == last {
                continue;
            }
            if let Some(parent) = parent {
                let here = nodes.len() as u32;
                let node: &mut Node = &mut nodes[parent];
                node.at = here;
            }
            let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
            for corner in ids[first..last].iter().flat_map(|&id| mesh.corners(id)) {
                for k in 0..3 {
                    low[k] = low[k].min(corner[k].into());
                    high[k] = high[k].max(corner[k].into());
                }
            }
            let count = last - first;
            if count <= LEAF {
                nodes.push(Node { low, high, at: first as u32, count: count as u32 });
                continue;
            }
            let extent = |k: usize| high[k] - low[k];
            let axis = (1..3).fold(0, |best, k| if extent(k) > extent(best) { k } else { best });
            let middle = count / 2;
            let key = |&id: &u32| mesh.corners(id).iter().map(|corner| f64::from(corner[axis])).sum::<f64>();
            ids[first..last].select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
            let here = nodes.len();
            nodes.push(Node { low, high, at: 0, count: 0 });
            work.push((first + middle, last, Some(here)));
            work.push((first, first + middle, None));
        }
        Self { nodes, ids }
    }

    /// Calls `visit` for triangles that the ray may hit before `limit` until it says stop; whether it did.
    pub(super) fn visit(&self, frame: &Frame, limit: f64, mut visit: impl FnMut(u32) -> bool) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let limit = limit.min(frame.t_max);
        let mut stack = vec![0u32];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if !node.meets(frame, limit) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.at, at + 1]);
                continue;
            }
            let first = node.at as usize;
            if self.ids[first..first + node.count as usize].iter().any(|&id| visit(id)) {
                return true;
            }
        }
        false
    }
}

impl Node {
    /// Whether the ray meets the box, widened by what corners may move.
    fn meets(&self, frame: &Frame, limit: f64) -> bool {
        // Beyond what f64 rounds.
        let widen = 4.0 * frame.corner;
        let (mut enter, mut exit) = (frame.t_min, limit);
        for k in 0..3 {
            let (low, high) = (self.low[k] - widen - frame.origin[k], self.high[k] + widen - frame.origin[k]);
            let d = frame.direction[k];
            if d == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low / d, high / d);
            enter = enter.max(a.min(b));
            exit = exit.min(a.max(b));
        }
        // An interval that begins at an end of the ray's counts.
        enter <= exit + 1e-6 * exit.abs()
    }
}
