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

    /// Every hit but those on `triangle`.
    pub fn all_hits_except(&self, ray: &Ray, triangle: u32) -> Vec<Hit> {
        self.all_hits_where(ray, |hit| hit.triangle != triangle)
    }

    /// [`KdTree::closest_hits`] with a filter, which is told the ray's place in the batch too: for masks of each ray, groups,
    /// and rays that start on a surface. Asked as in [`KdTree::closest_hit_where`]; the hits are the same to the last bit.
    ///
    /// As fast as without where it says yes to the nearest hit; a ray whose nearest hit it refuses is traced again alone.
    ///
    /// ```
    /// # use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
    /// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
    /// let rays = [Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]); 2];
    /// let (of_triangle, of_ray) = ([0b01u8, 0b10], [0b11u8, 0b01]);
    /// let mut hits = [None; 2];
    /// tree.closest_hits_where(&rays, &mut hits, |ray, hit| of_triangle[hit.triangle as usize] & of_ray[ray] != 0);
    /// assert_eq!(hits.map(|hit| hit.unwrap().triangle), [1, 0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest_hits_where(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        accept: impl FnMut(usize, &Hit) -> bool,
    ) {
        self.closest_hits(rays, hits);
        self.ask_again(rays, hits, accept);
    }

    /// [`KdTree::closest_hits_coherent`] with a filter, as [`KdTree::closest_hits_where`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn closest_hits_coherent_where(
        &self,
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        accept: impl FnMut(usize, &Hit) -> bool,
    ) {
        self.closest_hits_coherent(rays, hits);
        self.ask_again(rays, hits, accept);
    }

    /// The nearest hit that counts is the nearest of all, if that counts.
    fn ask_again(&self, rays: &[Ray], hits: &mut [Option<Hit>], mut accept: impl FnMut(usize, &Hit) -> bool) {
        for (at, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            if hit.is_some_and(|hit| !accept(at, &hit)) {
                *hit = self.closest_hit_where(ray, |hit| accept(at, hit));
            }
        }
    }

    /// [`KdTree::any_hits`] with a filter, as [`KdTree::closest_hits_where`]. Rays that hit nothing cost as much as without, the
    /// others are traced again alone.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any_hits_where(&self, rays: &[Ray], hits: &mut [bool], accept: impl FnMut(usize, &Hit) -> bool) {
        self.any_hits(rays, hits);
        self.ask_any_again(rays, hits, accept);
    }

    /// [`KdTree::any_hits_coherent`] with a filter, as [`KdTree::any_hits_where`].
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn any_hits_coherent_where(
        &self,
        rays: &[Ray],
        hits: &mut [bool],
        accept: impl FnMut(usize, &Hit) -> bool,
    ) {
        self.any_hits_coherent(rays, hits);
        self.ask_any_again(rays, hits, accept);
    }

    fn ask_any_again(&self, rays: &[Ray], hits: &mut [bool], mut accept: impl FnMut(usize, &Hit) -> bool) {
        for (at, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            *hit = *hit && self.any_hit_where(ray, |hit| accept(at, hit));
        }
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
        self.closest_point_where(point, max_distance, |_| true)
    }

    /// The same among the triangles that `accept` says yes to.
    ///
    /// ```
    /// # use slimkd::{BuildOptions, KdTree, TriangleMesh};
    /// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
    /// let found = tree.closest_point_where([0.2, 0.2, 0.1], f32::INFINITY, |triangle| triangle != 0).unwrap();
    /// assert_eq!((found.triangle, found.distance), (1, 0.9));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn closest_point_where(
        &self,
        point: impl Into<[f32; 3]>,
        max_distance: f32,
        accept: impl FnMut(u32) -> bool,
    ) -> Option<ClosestPoint> {
        let mut search = Search::new(point.into(), max_distance, &self.bounds, accept)?;
        with_nodes!(self, nodes => search_tree(nodes, self.depth, &self.bounds, &mut search));
        search.into_closest()
    }
}
