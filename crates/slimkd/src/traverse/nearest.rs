//! The point of the mesh that is nearest to a point: branch and bound over the voxels, nearer child first.
//!
//! Why the answer does not depend on the tree: a triangle's distance is decided by `geometry/closest_point.rs` alone, its
//! error stays below 2⁻⁴⁸ of the distance to the farthest corner of the bounds, and a voxel is passed by only when it lies
//! farther than the best by 2⁻⁴⁰ of that. The triangle's nearest point lies in a voxel whose leaf, or a node above it,
//! holds the triangle, as every point of it does; a plane that its layout keeps coarsely counts as a cell nearer. Equal distances go to the lowest id.
//! The same holds for several triangles, where the best is the last of those that are kept.

use super::{Conditions, Traced};
use crate::geometry::{Aabb, Hit, Nearest, nearest_on_triangle};
use crate::layout::{Address, Ids, LANES, Nodes, Step, WideNodes};

/// The widening of voxels relative to the farthest corner of the bounds; derived in the module head.
const SLACK: f64 = 1.0 / (1u64 << 40) as f64;

/// A point on the mesh.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let found = tree.nearest([0.25, 0.5, 3.0], f32::INFINITY).unwrap();
/// assert_eq!((found.point, found.distance, found.triangle), ([0.25, 0.5, 0.0], 3.0, 0));
/// assert_eq!(tree.nearest([0.25, 0.5, 3.0], 2.5), None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct NearestPoint {
    /// Where it is, scene units, rounded once from f64.
    pub point: [f32; 3],
    /// How far that is, scene units, rounded once from f64.
    pub distance: f32,
    /// Barycentric weight of vertex 1.
    pub u: f32,
    /// Barycentric weight of vertex 2.
    pub v: f32,
    /// The triangle that it lies on.
    pub triangle: u32,
}

/// The best so far.
pub(crate) struct Search<'a> {
    point: [f32; 3],
    best: Nearest,
    triangle: u32,
    slack: f64,
    /// Voxels whose squared distance is larger hold nothing better.
    limit: f64,
    conditions: Conditions<'a>,
    /// Where several triangles are asked for: how many at most, and the best of them in their order.
    several: Option<(usize, Vec<(u32, Nearest)>)>,
}

impl<'a> Search<'a> {
    /// `None` for a point or a distance that is not a number, and where there is no triangle.
    pub(crate) fn new(
        point: [f32; 3],
        max_distance: f32,
        bounds: &Aabb,
        conditions: Conditions<'a>,
    ) -> Option<Self> {
        if !point.iter().all(|x| x.is_finite())
            || max_distance.is_nan()
            || max_distance < 0.0
            || bounds.is_empty()
        {
            return None;
        }
        let reach = |k: usize| {
            let at = f64::from(point[k]);
            (f64::from(bounds.min[k]) - at).abs().max((f64::from(bounds.max[k]) - at).abs())
        };
        let slack = SLACK * (reach(0) + reach(1) + reach(2));
        let square = f64::from(max_distance) * f64::from(max_distance);
        let best = Nearest { square, offset: [0.0; 3], u: 0.0, v: 0.0 };
        let mut search =
            Self { point, best, triangle: u32::MAX, slack, limit: 0.0, conditions, several: None };
        search.tighten();
        Some(search)
    }

    /// This search for the `most` triangles that are nearest, 1 at least.
    pub(crate) fn several(mut self, most: usize) -> Self {
        self.several = Some((most, Vec::new()));
        self
    }

    fn tighten(&mut self) {
        let distance = self.best.square.sqrt() + self.slack;
        self.limit = distance * distance;
    }

    pub(crate) fn offer(&mut self, corners: &[[f32; 3]; 3], triangle: u32) {
        let found = nearest_on_triangle(self.point, corners);
        if let Some((most, list)) = &mut self.several {
            // Until the list is full, `best` is the largest distance that was asked for, and any id is below its own.
            let at = list.partition_point(|(id, other)| (other.square, *id) < (found.square, triangle));
            let most = *most;
            if found.square > self.best.square
                || at >= most
                || list.get(at).is_some_and(|(id, _)| *id == triangle)
                || triangle == self.conditions.except
                || !self.accepts(&found, triangle)
            {
                return;
            }
            let Some((_, list)) = &mut self.several else { return };
            list.truncate(most - 1);
            list.insert(at, (triangle, found));
            if list.len() == most
                && let Some((_, last)) = list.last()
            {
                self.best = *last;
                self.tighten();
            }
            return;
        }
        let better =
            found.square < self.best.square || (found.square == self.best.square && triangle < self.triangle);
        if better && triangle != self.conditions.except && self.accepts(&found, triangle) {
            (self.best, self.triangle) = (found, triangle);
            self.tighten();
        }
    }

    fn accepts(&mut self, found: &Nearest, triangle: u32) -> bool {
        let Nearest { square, u, v, .. } = *found;
        let hit = Hit { t: square.sqrt() as f32, u: u as f32, v: v as f32, triangle };
        self.conditions.filter.as_mut().is_none_or(|accept| accept(&hit))
    }

    pub(crate) fn into_nearest(self) -> Option<NearestPoint> {
        (self.triangle != u32::MAX).then(|| rounded(self.point, self.best, self.triangle))
    }

    /// The answers of [`Search::several`], nearest first, added to `found`.
    pub(crate) fn add_to(self, found: &mut Vec<NearestPoint>) {
        let list = self.several.map_or_else(Vec::new, |(_, list)| list);
        found.extend(list.into_iter().map(|(triangle, nearest)| rounded(self.point, nearest, triangle)));
    }
}

fn rounded(point: [f32; 3], Nearest { square, offset, u, v }: Nearest, triangle: u32) -> NearestPoint {
    NearestPoint {
        point: std::array::from_fn(|k| (f64::from(point[k]) + offset[k]) as f32),
        distance: square.sqrt() as f32,
        u: u as f32,
        v: v as f32,
        triangle,
    }
}

/// A voxel to come back to.
struct Far {
    node: Address,
    /// Distances to the voxel per axis.
    apart: [f64; 3],
}

fn square(apart: [f64; 3]) -> f64 {
    apart[0] * apart[0] + apart[1] * apart[1] + apart[2] * apart[2]
}

/// Offers every triangle that may be nearest.
pub(crate) fn search_tree<N: Nodes>(tree: Traced<'_, N>, search: &mut Search<'_>) {
    let Traced { nodes, depth, bounds } = tree;
    let point = search.point.map(f64::from);
    let planes = nodes.planes();
    let apart = std::array::from_fn(|k| {
        (f64::from(bounds.min[k]) - point[k]).max(point[k] - f64::from(bounds.max[k])).max(0.0)
    });
    let mut pending = Vec::with_capacity(depth as usize + 1);
    pending.push(Far { node: Address::ROOT, apart });
    while let Some(Far { mut node, apart }) = pending.pop() {
        if square(apart) > search.limit {
            continue;
        }
        let leaf = loop {
            // SAFETY: the node is the root or a child of a node of this tree.
            let inner = match unsafe { nodes.node(node) } {
                Step::Inner(inner) => inner,
                Step::Leaf(leaf) => break leaf,
            };
            if let Some(triangle) = inner.t_reference {
                // SAFETY: an inner node of this tree names the triangle.
                search.offer(&unsafe { nodes.corners(triangle) }, triangle);
            }
            let (place, cell) = planes.exact(inner.axis, inner.split);
            let beyond = place - point[inner.axis];
            let (near, far) = inner.near_and_far(if beyond < 0.0 { u32::MAX } else { 0 });
            let mut far_apart = apart;
            far_apart[inner.axis] = far_apart[inner.axis].max(beyond.abs() - cell);
            if square(far_apart) <= search.limit {
                pending.push(Far { node: far, apart: far_apart });
            }
            // The near half is as far as the whole: its face that the point may be beside is the voxel's own.
            node = near;
        };
        // SAFETY: the leaf and its ids come from this tree.
        unsafe { nodes.for_each(leaf, |id| search.offer(&nodes.corners(id), id)) };
    }
}

/// [`search_tree`] in a wide tree: nearer boxes first.
pub(crate) fn search_wide(nodes: impl WideNodes, search: &mut Search<'_>) {
    let grid = nodes.planes();
    let point = search.point.map(f64::from);
    let mut pending = vec![(Address::ROOT, 0.0)];
    let mut children: Vec<(usize, f64)> = Vec::with_capacity(LANES);
    while let Some((at, apart)) = pending.pop() {
        if apart > search.limit {
            continue;
        }
        // SAFETY: the address is the root's or that of an inner child of a node of this tree.
        let node = unsafe { nodes.read(at) };
        children.clear();
        for lane in 0..node.children() {
            let [low, high] = node.bounds(lane, &grid);
            let apart = square([0, 1, 2].map(|k| (low[k] - point[k]).max(point[k] - high[k]).max(0.0)));
            if apart <= search.limit {
                children.push((lane, apart));
            }
        }
        // Leaves at once, so that they shorten the search; then inner children, the farthest first.
        children.sort_by(|a, b| a.1.total_cmp(&b.1));
        for &(lane, apart) in children.iter().filter(|&&(lane, _)| lane >= node.inner()) {
            if apart > search.limit {
                break;
            }
            // SAFETY: the lane is that of a leaf, and its ids come from this tree.
            unsafe {
                for &id in nodes.ids(&node, lane, &mut Ids::new()) {
                    search.offer(&nodes.corners(id), id);
                }
            }
        }
        for &(lane, apart) in children.iter().rev().filter(|&&(lane, _)| lane < node.inner()) {
            // SAFETY: the lane is that of an inner child.
            pending.push((unsafe { nodes.child(&node, lane) }, apart));
        }
    }
}
