//! Queries beyond the nearest hit: with a filter, without a triangle, nearest to a point.

use super::nodes::with_nodes;
use super::{KdTree, walk};
use crate::geometry::Ray;
use crate::traverse::{
    All, Any, Closest, ClosestPoint, Costed, Filtered, Hit, RayCost, Search, search_tree, sort_hits,
};

impl KdTree {
    /// The nearest hit that `accept` says yes to; equal t goes to the lowest id. It is asked about hits in `[t_min, t_max]`
    /// in no particular order, about some of them twice, about those behind the nearest accepted one perhaps never.
    ///
    /// Masks and groups are filters:
    ///
    /// ```
    /// # use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
    /// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
    /// let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
    /// let masks = [0b01u8, 0b10]; // of each triangle
    /// let seen = tree.closest_hit_where(&ray, |hit| masks[hit.triangle as usize] & 0b01 != 0).unwrap();
    /// assert_eq!((tree.closest_hit(&ray).unwrap().triangle, seen.triangle), (1, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_hit_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut sink = Filtered { sink: Closest::new(ray.t_max), accept };
        self.offer_all(ray, &mut sink);
        sink.sink.into_hit()
    }

    /// Whether there is a hit that `accept` says yes to; asked as in [`KdTree::closest_hit_where`].
    pub fn any_hit_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> bool {
        let mut sink = Filtered { sink: Any { found: false, t_max: ray.t_max }, accept };
        self.offer_all(ray, &mut sink);
        sink.sink.found
    }

    /// Every hit that `accept` says yes to, sorted by (t, id), each triangle once; asked as in
    /// [`KdTree::closest_hit_where`], but about every hit.
    pub fn all_hits_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.offer_all(ray, &mut Filtered { sink: All { hits: &mut hits, t_max: ray.t_max }, accept });
        sort_hits(&mut hits);
        hits
    }

    /// The nearest hit but those on `triangle`: for rays that start on it. Unlike an offset of `t_min` it loses no other
    /// hit, however near; a neighbour that shares the starting point is hit at t ≈ 0.
    pub fn closest_hit_except(&self, ray: &Ray, triangle: u32) -> Option<Hit> {
        self.closest_hit_where(ray, |hit| hit.triangle != triangle)
    }

    /// Whether anything but `triangle` is hit.
    pub fn any_hit_except(&self, ray: &Ray, triangle: u32) -> bool {
        self.any_hit_where(ray, |hit| hit.triangle != triangle)
    }

    /// [`KdTree::closest_hit`], and the nodes and triangles that it took. Slower than without; the same hit. An invalid ray
    /// costs nothing.
    pub fn closest_hit_cost(&self, ray: &Ray) -> (Option<Hit>, RayCost) {
        let mut sink = Costed::new(ray.t_max);
        self.offer_all(ray, &mut sink);
        sink.into_parts()
    }

    /// How often each triangle of the mesh is referred to, by leaves and by T-references; 0 for degenerate ones.
    pub fn references_per_triangle(&self) -> Vec<u32> {
        let mut counts = vec![0; self.mesh.len()];
        walk::for_each_reference(self, |id| counts[id as usize] += 1);
        counts
    }

    /// The point of the mesh that is nearest to `point`, if it is no farther than `max_distance` (scene units, inclusive, may
    /// be `+inf`); equal distances go to the lowest id. Collinear triangles and those that are not finite are passed over. The
    /// same to the last bit for every preset; decided in f64.
    pub fn closest_point(&self, point: impl Into<[f32; 3]>, max_distance: f32) -> Option<ClosestPoint> {
        let mut search = Search::new(point.into(), max_distance, &self.bounds)?;
        with_nodes!(self, nodes => search_tree(nodes, self.depth, &self.bounds, &mut search));
        search.into_closest()
    }
}
