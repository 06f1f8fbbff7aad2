//! Questions about one ray or one point, with options.

use super::Tracer;
use crate::geometry::{Hit, Ray};
use crate::traverse::{Conditions, NearestPoint};

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

    /// [`Tracer::nearest`] with these options.
    pub fn nearest(self, point: [f32; 3], max_distance: f32) -> Option<NearestPoint> {
        self.tracer.nearest_with(point, max_distance, self.conditions)
    }
}
