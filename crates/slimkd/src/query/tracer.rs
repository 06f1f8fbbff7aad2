//! The interface of everything that can be traced.

use super::batch::BatchJob;
use super::{Batch, Crossings, Query, Segment, inside};
use crate::geometry::{Aabb, ExactRay, Hit, HitF64, Ray, RayF64, RefinedHit};
use crate::traverse::{Conditions, ExactQuery, NearestPoint};

/// Anything that rays can be traced through: a [`KdTree`](crate::KdTree), an [`OpenTree`](crate::OpenTree) or a
/// [`BruteForce`](crate::BruteForce). All of them give the same hits, to the last bit.
///
/// The verbs on this trait ask about one ray. [`Tracer::query`] asks the same with an excluded triangle or a filter, and
/// [`Tracer::batch`] asks about many rays at once, which is several times faster.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
///
/// let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
/// let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
/// let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
///
/// assert_eq!(tree.closest(&ray).unwrap().triangle, 1);
/// assert!(tree.any(&ray));
/// assert_eq!(tree.count(&ray), 2);
/// assert_eq!(tree.query().except(1).closest(&ray).unwrap().triangle, 0);
/// assert_eq!(tree.nearest([0.2, 0.2, 0.1], f32::INFINITY).unwrap().triangle, 0);
///
/// let rays = [ray; 100];
/// let mut hits = [None; 100];
/// tree.batch().closest(&rays, &mut hits);
/// assert_eq!(hits[99], tree.closest(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The trait is sealed: only this crate implements it. It can be used as `dyn Tracer`.
pub trait Tracer: Send + Sync {
    /// Bounds of every triangle that can be hit, in scene units; empty where there is none.
    fn bounds(&self) -> Aabb;

    /// Where in the world the mesh's coordinates are 0: [`TriangleMesh::origin`](crate::TriangleMesh::origin). Only the verbs that end in
    /// `_f64` take world coordinates.
    fn origin(&self) -> [f64; 3];

    /// The corners of a triangle, in coordinates of the mesh; `None` where no triangle has this id.
    fn corners(&self, triangle: u32) -> Option<[[f32; 3]; 3]>;

    /// The nearest hit with `t_min ≤ t ≤ t_max`. Equal `t` goes to the lowest triangle id. An invalid ray has none.
    fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_with(ray, Conditions::none())
    }

    /// Whether the ray hits anything with `t_min ≤ t ≤ t_max`. This is faster than [`Tracer::closest`].
    fn any(&self, ray: &Ray) -> bool {
        self.any_with(ray, Conditions::none())
    }

    /// All hits with `t_min ≤ t ≤ t_max`, each triangle once, sorted by `t` and then by triangle id.
    fn all(&self, ray: &Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.first_with(ray, usize::MAX, Conditions::none(), &mut hits);
        hits
    }

    /// The number of triangles that the ray hits with `t_min ≤ t ≤ t_max`. Both neighbours of an edge that the ray meets count; for
    /// inside and outside, ask [`Tracer::crossings`].
    fn count(&self, ray: &Ray) -> usize {
        self.all(ray).len()
    }

    /// How often the ray crosses the surface with `t_min ≤ t ≤ t_max`, and which way: exactly, each crossing once, through edges and vertices
    /// too. See [`Crossings`]. An invalid ray crosses nothing.
    fn crossings(&self, ray: &Ray) -> Crossings {
        Crossings::of(self.as_dyn(), ray, &mut Vec::new())
    }

    /// The number of [`Tracer::crossings`]. Of a ray that starts beside a closed surface and does not end it is odd exactly where the ray
    /// starts inside.
    fn count_crossings(&self, ray: &Ray) -> usize {
        self.crossings(ray).count()
    }

    /// Whether a point is inside the surface or on it, exactly: whether a ray from it crosses the surface an odd number of times. Normals do
    /// not matter; what lies within two closed parts is outside. Points that are not finite are outside.
    ///
    /// Of a mesh that is not closed ([`TriangleMesh::surface`]) this is the parity along one ray, to the nearest side of the bounds:
    /// right away from holes, and wrong in their shadow. [`WindingNumbers`] are made for such meshes.
    ///
    /// [`TriangleMesh::surface`]: crate::TriangleMesh::surface
    /// [`WindingNumbers`]: crate::WindingNumbers
    fn contains(&self, point: [f32; 3]) -> bool {
        inside::contains(self.as_dyn(), point.map(f64::from), &mut Vec::new())
    }

    /// The distance to the nearest point of the surface, negative inside ([`Tracer::contains`]); `None` where there is no triangle, and
    /// for a point that is not finite. The sign is exact, the distance is rounded once from f64.
    fn signed_distance(&self, point: [f32; 3]) -> Option<f32> {
        let distance = inside::signed_distance(self.as_dyn(), point, &mut Vec::new());
        (!distance.is_nan()).then_some(distance)
    }

    /// Whether nothing lies between two points. The segment is open at both ends: a triangle on which one of the points lies, up to
    /// the rounding of its coordinates, hides nothing. See [`Batch::visible`] for many segments, and for closed ones.
    fn visible(&self, from: [f32; 3], to: [f32; 3]) -> bool {
        let mut visible = [false];
        self.batch().visible(&[Segment { from, to }], &mut visible);
        visible[0]
    }

    /// The point of all triangles that is nearest to `point`, if it is no farther than `max_distance` (scene units, inclusive, may
    /// be infinite). Equal distances go to the lowest triangle id. The answer is decided in f64.
    fn nearest(&self, point: [f32; 3], max_distance: f32) -> Option<NearestPoint> {
        self.nearest_with(point, max_distance, Conditions::none())
    }

    /// A hit in f64: `t`, `u`, `v`, the point, the unit normal and the side, computed from the triangle's own corners. Call it with the
    /// [`Hit::triangle`] that another verb found for this ray; it does not ask whether the ray meets the triangle or only its plane.
    /// `None` where `triangle` does not exist, where the ray runs within its plane, or where numbers leave the range of f64.
    fn refine(&self, ray: &Ray, triangle: u32) -> Option<RefinedHit> {
        RefinedHit::new(ray, &self.corners(triangle)?)
    }

    /// The nearest hit of a ray in f64, in world coordinates: see [`RayF64`]. Equal `t` goes to the lowest triangle id.
    fn closest_f64(&self, ray: &RayF64) -> Option<HitF64> {
        self.query().closest_f64(ray)
    }

    /// Whether the ray hits anything with `t_min ≤ t ≤ t_max`, in f64 and in world coordinates.
    fn any_f64(&self, ray: &RayF64) -> bool {
        self.query().any_f64(ray)
    }

    /// All hits with `t_min ≤ t ≤ t_max`, in f64 and in world coordinates, each triangle once, sorted by `t` and then by triangle id.
    fn all_f64(&self, ray: &RayF64) -> Vec<HitF64> {
        let mut hits = Vec::new();
        self.query().first_f64(ray, usize::MAX, &mut hits);
        hits
    }

    /// [`Tracer::crossings`] of a ray in f64, in world coordinates.
    fn crossings_f64(&self, ray: &RayF64) -> Crossings {
        let ray = ExactRay::in_world(ray, self.origin());
        ray.map_or_else(Crossings::default, |ray| Crossings::of_exact(self.as_dyn(), ray, &mut Vec::new()))
    }

    /// [`Tracer::contains`] of a point in world coordinates.
    fn contains_f64(&self, point: [f64; 3]) -> bool {
        let origin = self.origin();
        inside::contains(self.as_dyn(), [0, 1, 2].map(|k| point[k] - origin[k]), &mut Vec::new())
    }

    /// [`Tracer::refine`] of a hit that a verb which ends in `_f64` found; the point is in world coordinates.
    fn refine_f64(&self, ray: &RayF64, triangle: u32) -> Option<RefinedHit> {
        RefinedHit::in_world(ray, self.origin(), &self.corners(triangle)?)
    }

    /// Asks about one ray or point with options: see [`Query`].
    fn query(&self) -> Query<'_> {
        Query::new(self.as_dyn())
    }

    /// Asks about many rays or points: see [`Batch`].
    fn batch(&self) -> Batch<'_> {
        Batch::new(self.as_dyn())
    }

    #[doc(hidden)]
    fn as_dyn(&self) -> &(dyn Tracer + '_);

    #[doc(hidden)]
    fn closest_with(&self, ray: &Ray, conditions: Conditions<'_>) -> Option<Hit>;

    #[doc(hidden)]
    fn any_with(&self, ray: &Ray, conditions: Conditions<'_>) -> bool;

    #[doc(hidden)]
    fn first_with(&self, ray: &Ray, most: usize, conditions: Conditions<'_>, hits: &mut Vec<Hit>);

    #[doc(hidden)]
    fn exact_with(&self, query: &mut ExactQuery<'_>);

    #[doc(hidden)]
    fn nearest_with(
        &self,
        point: [f32; 3],
        max_distance: f32,
        conditions: Conditions<'_>,
    ) -> Option<NearestPoint>;

    #[doc(hidden)]
    fn several_with(
        &self,
        point: [f32; 3],
        max_distance: f32,
        most: usize,
        conditions: Conditions<'_>,
        found: &mut Vec<NearestPoint>,
    );

    #[doc(hidden)]
    fn closest_batch(&self, job: BatchJob<'_>, hits: &mut [Option<Hit>]);

    #[doc(hidden)]
    fn any_batch(&self, job: BatchJob<'_>, hits: &mut [bool]);
}
