//! The oracle: every query by testing every triangle.

use super::nearest::search_all;
use super::sink::{All, Any, Closest, Sink, sort_hits};
use super::{ClosestPoint, Filtered, Hit, Planes, PreparedRay, Search};
use crate::geometry::{Aabb, Ray, TriangleMesh};

/// Answers queries without a tree, in O(triangles). What it says is what every tree must say, to the last bit.
///
/// ```
/// use slimkd::{BruteForce, BuildOptions, KdTree, Ray, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
/// let oracle = BruteForce::new(&mesh);
/// assert_eq!(oracle.closest_hit(&ray), KdTree::build(mesh.clone(), &BuildOptions::default())?.closest_hit(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BruteForce<'a> {
    mesh: &'a TriangleMesh,
    triangles: Vec<u32>,
    bounds: Aabb,
}

impl<'a> BruteForce<'a> {
    /// Sorts out the triangles that can never hit.
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        let (triangles, bounds) = mesh.valid_triangles();
        Self { mesh, triangles, bounds }
    }

    /// As [`crate::KdTree::closest_hit`].
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut sink = Closest::new(ray.t_max);
        self.offer_all(ray, &mut sink);
        sink.into_hit()
    }

    /// As [`crate::KdTree::any_hit`].
    pub fn any_hit(&self, ray: &Ray) -> bool {
        let mut sink = Any { found: false, t_max: ray.t_max };
        self.offer_all(ray, &mut sink);
        sink.found
    }

    /// As [`crate::KdTree::all_hits`].
    pub fn all_hits(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.offer_all(ray, &mut All { hits: &mut hits, t_max: ray.t_max });
        sort_hits(&mut hits);
        hits
    }

    /// As [`crate::KdTree::closest_hit_where`].
    pub fn closest_hit_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut sink = Filtered { sink: Closest::new(ray.t_max), accept };
        self.offer_all(ray, &mut sink);
        sink.sink.into_hit()
    }

    /// As [`crate::KdTree::closest_point`].
    pub fn closest_point(&self, point: impl Into<[f32; 3]>, max_distance: f32) -> Option<ClosestPoint> {
        self.closest_point_where(point, max_distance, |_| true)
    }

    /// As [`crate::KdTree::closest_point_where`].
    pub fn closest_point_where(
        &self,
        point: impl Into<[f32; 3]>,
        max_distance: f32,
        accept: impl FnMut(u32) -> bool,
    ) -> Option<ClosestPoint> {
        let mut search = Search::new(point.into(), max_distance, &self.bounds, accept)?;
        search_all(self.mesh, &self.triangles, &mut search);
        search.into_closest()
    }

    fn offer_all(&self, ray: &Ray, sink: &mut impl Sink) {
        let Some(prepared) = PreparedRay::new(ray, &self.bounds, &Planes::WORLD) else { return };
        match prepared.shear.axes[2] {
            0 => self.offer_along::<0>(&prepared, sink),
            1 => self.offer_along::<1>(&prepared, sink),
            _ => self.offer_along::<2>(&prepared, sink),
        }
    }

    fn offer_along<const Z: usize>(&self, ray: &PreparedRay, sink: &mut impl Sink) {
        for &id in &self.triangles {
            let found = ray.shear.intersect::<Z>(&self.mesh.corners(id));
            if ray.hand_over(found, id, sink) {
                return;
            }
        }
    }
}
