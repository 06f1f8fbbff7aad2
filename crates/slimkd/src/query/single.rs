//! Questions about one ray or one point, with options.

use super::Tracer;
use crate::geometry::{ExactRay, Hit, HitF64, Ray, RayF64};
use crate::traverse::{Conditions, ExactQuery, NearestPoint};

/// A question about one ray or one point, with options: make it by [`Tracer::query`], set options, then call a verb.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
/// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
/// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
/// let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
/// let masks = [0b01u8, 0b10]; // one for each triangle
/// let seen = tree.query().filter(&mut |hit| masks[hit.triangle as usize] & 0b01 != 0).closest(&ray);
/// assert_eq!(seen.unwrap().triangle, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a query does nothing until a verb such as `closest` is called"]
pub struct Query<'a> {
    tracer: &'a (dyn Tracer + 'a),
    conditions: Conditions<'a>,
}

impl<'a> Query<'a> {
    pub(super) fn new(tracer: &'a (dyn Tracer + 'a)) -> Self {
        Self { tracer, conditions: Conditions::none() }
    }

    /// Leaves out one triangle: the one that the ray starts on. Unlike a `t_min` above 0, this loses no other hit, however near. A
    /// neighbouring triangle that shares the starting point is still hit, at `t` near 0.
    pub fn except(mut self, triangle: u32) -> Self {
        self.conditions.except = triangle;
        self
    }

    /// Counts only hits for which `accept` returns `true`. It is called for hits within the ray's range, in no particular order; it may
    /// be called twice for one hit, and not at all for hits behind the nearest accepted one. For [`Query::nearest`] its argument is
    /// the candidate as a hit whose `t` is the distance.
    pub fn filter(mut self, accept: &'a mut dyn FnMut(&Hit) -> bool) -> Self {
        self.conditions.filter = Some(accept);
        self
    }

    /// [`Tracer::closest`] with these options.
    pub fn closest(self, ray: &Ray) -> Option<Hit> {
        self.tracer.closest_with(ray, self.conditions)
    }

    /// [`Tracer::any`] with these options.
    pub fn any(self, ray: &Ray) -> bool {
        self.tracer.any_with(ray, self.conditions)
    }

    /// [`Tracer::all`] with these options.
    pub fn all(self, ray: &Ray) -> Vec<Hit> {
        let mut hits = Vec::new();
        self.first(ray, usize::MAX, &mut hits);
        hits
    }

    /// The first `most` hits along the ray, in the order of [`Tracer::all`], written over what `hits` held. Nothing is allocated
    /// where `hits` has room. The walk ends as soon as no nearer hit can follow.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
    /// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
    /// let mut hits = Vec::with_capacity(8);
    /// tree.query().first(&Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]), 1, &mut hits);
    /// assert_eq!(hits[0].triangle, 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn first(self, ray: &Ray, most: usize, hits: &mut Vec<Hit>) {
        hits.clear();
        self.tracer.first_with(ray, most, self.conditions, hits);
    }

    /// [`Tracer::count`] with these options.
    pub fn count(self, ray: &Ray) -> usize {
        self.all(ray).len()
    }

    /// [`Tracer::closest_f64`] with these options. A filter gets the hit rounded to f32.
    pub fn closest_f64(self, ray: &RayF64) -> Option<HitF64> {
        let ray = ExactRay::in_world(ray, self.tracer.origin())?;
        let mut query = ExactQuery::closest(ray, self.conditions);
        self.tracer.exact_with(&mut query);
        query.into_hit()
    }

    /// [`Tracer::any_f64`] with these options. A filter gets the hit rounded to f32.
    pub fn any_f64(self, ray: &RayF64) -> bool {
        let Some(ray) = ExactRay::in_world(ray, self.tracer.origin()) else { return false };
        let mut query = ExactQuery::any(ray, self.conditions);
        self.tracer.exact_with(&mut query);
        query.into_hit().is_some()
    }

    /// The first `most` hits along the ray, in the order of [`Tracer::all_f64`], written over what `hits` held. A filter gets the hit
    /// rounded to f32.
    pub fn first_f64(self, ray: &RayF64, most: usize, hits: &mut Vec<HitF64>) {
        hits.clear();
        let Some(ray) = ExactRay::in_world(ray, self.tracer.origin()) else { return };
        let mut query = ExactQuery::first(ray, most, self.conditions, std::mem::take(hits));
        self.tracer.exact_with(&mut query);
        *hits = query.into_hits();
    }

    /// The `most` triangles that are nearest to `point` and no farther than `max_distance` (scene units, inclusive, may be infinite), each by
    /// its own nearest point, written over what `found` held: nearest first, and equal distances by id. With `usize::MAX` these are all
    /// triangles within a radius.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Tracer, TriangleMesh};
    /// # let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// # let tree = KdTree::build(TriangleMesh::new(corners, vec![[0, 1, 2], [3, 4, 5]])?, &BuildOptions::default())?;
    /// let mut found = Vec::new();
    /// tree.query().nearest_several([0.2, 0.2, 0.8], f32::INFINITY, 2, &mut found);
    /// assert_eq!([found[0].triangle, found[1].triangle], [1, 0]);
    /// tree.query().nearest_several([0.2, 0.2, 0.8], 0.5, usize::MAX, &mut found);
    /// assert_eq!(found.len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nearest_several(
        self,
        point: [f32; 3],
        max_distance: f32,
        most: usize,
        found: &mut Vec<NearestPoint>,
    ) {
        found.clear();
        self.tracer.several_with(point, max_distance, most, self.conditions, found);
    }

    /// [`Tracer::nearest`] with these options.
    pub fn nearest(self, point: [f32; 3], max_distance: f32) -> Option<NearestPoint> {
        self.tracer.nearest_with(point, max_distance, self.conditions)
    }
}
