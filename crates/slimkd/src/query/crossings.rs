//! How often a ray crosses the surface, and what that says about inside and outside.
//!
//! Each triangle is decided by the exact signs of `geometry/exact.rs`, for the ray displaced by an infinitely small amount; its triangles
//! are all met (`traverse/exact.rs`). What follows holds for every ray whose start o lies on no triangle and whose range is [0, ∞].
//!
//! **Closed meshes.** A mesh is closed where each edge, as a pair of positions, belongs to an even number of triangles; it is oriented as well where
//! as many of these run along it one way as the other. Let c(p) be the number of crossings of the ray from p in the direction d, and s(p) that of
//! the crossings along the turn less those against it. Move p on a path that avoids the surface. A number changes only where the ray passes
//! edges, and a path can be chosen that passes them at inner points, and edges in one plane with d together but no others. There each
//! triangle of such an edge begins or stops to be crossed, but for those that are seen edge-on: these are never crossed. Counted edge by edge, the
//! triangles are an even number; each that is seen edge-on is among them twice, as the ray passes two of its edges, both
//! ahead of p or both behind, since p is not on it. So an even number of triangles changes, and the parity of c stays. Of an oriented mesh,
//! a change of s is the way in which the triangle runs along the edge, up to a common sign: these ways add up to 0 for each edge, and the two
//! edges of a triangle that is seen edge-on run opposite ways. So s stays. Both are thus constant in each region of space that the
//! surface bounds. Far away, where the ray goes away from the mesh, both are 0: the unbounded region has an even number, and s = 0. Where
//! p itself passes through a single triangle, c changes by one and s by its sign. So the parity says whether a point is inside,
//! whatever the direction, and s is the winding number of the surface around it.
//!
//! The displaced ray starts in the same region as o, because o is at a distance from the closed surface and the displacement is
//! smaller; and it meets no edge. So all this holds for it, and the numbers that are reported are its numbers. ∎
//!
//! **Any mesh.** Of two triangles that share an edge, a ray through it crosses one where they lie on different sides of the ray's line as it is seen from
//! the ray, and both or none where they lie on the same side, which is when it grazes a fold. A ray within a triangle's plane does not cross it. A ray
//! through a T-junction whose vertex lies exactly on the long edge loses nothing. Beyond that, what a number of crossings means
//! depends on the mesh: through a hole, it counts what is there.

use super::Tracer;
use crate::geometry::{ExactRay, Ray};
use crate::traverse::{Crossing, ExactQuery};

/// How often a ray crosses the surface, through its faces, edges and vertices, each crossing once: the answer of [`Tracer::crossings`].
///
/// A triangle is crossed *leaving* where the ray goes along its normal `(b − a) × (c − a)` for corners a, b, c in the mesh's order, and
/// *entering* where against it: of a closed mesh whose normals point outwards that is what the words say.
///
/// The numbers are exact: no rounding decides them, for any ray and any mesh. Where a ray meets an edge or a vertex, it is taken to pass
/// beside it by an infinitely small amount, always to the same side. So of a ray that starts beside a closed surface and goes on for ever
///
/// - the number's parity says whether it starts inside: odd inside, even outside, whatever the direction;
/// - where the triangles agree on their side, [`Crossings::signed`] is the surface's winding number around the start: 1 inside.
///
/// A contact without crossing counts 0 or 2: one entering, one leaving. A crossing at exactly `t_min` or `t_max` counts, so that of a start that
/// lies on the surface the number tells nothing.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
/// // A tetrahedron; the ray leaves through the vertex in which three of its faces meet.
/// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
/// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
/// let tree = KdTree::build(TriangleMesh::new(corners, faces)?, &BuildOptions::default())?;
/// let ray = Ray::new([0.5; 3], [-0.5, -0.5, 3.5]);
/// assert_eq!(tree.count(&ray), 3);
/// assert_eq!(tree.count_crossings(&ray), 1);
/// assert_eq!(tree.crossings(&ray).signed(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Crossings {
    /// Crossings against the triangle's normal.
    pub entering: u32,
    /// Crossings along the triangle's normal.
    pub leaving: u32,
}

impl Crossings {
    /// How many crossings there are.
    pub fn count(&self) -> usize {
        self.entering as usize + self.leaving as usize
    }

    /// Those leaving less those entering.
    pub fn signed(&self) -> i64 {
        i64::from(self.leaving) - i64::from(self.entering)
    }

    /// Those of one ray; `found` is room for them.
    pub(super) fn of(tracer: &dyn Tracer, ray: &Ray, found: &mut Vec<Crossing>) -> Self {
        ExactRay::from_ray(ray).map_or_else(Self::default, |ray| Self::of_exact(tracer, ray, found))
    }

    pub(super) fn of_exact(tracer: &dyn Tracer, ray: ExactRay, found: &mut Vec<Crossing>) -> Self {
        let mut query = ExactQuery::crossings(ray, found);
        tracer.exact_with(&mut query);
        query.finish();
        Self::sum(found)
    }

    pub(super) fn sum(found: &[Crossing]) -> Self {
        let leaving = found.iter().filter(|&&(_, sign)| sign > 0).count() as u32;
        Self { entering: found.len() as u32 - leaving, leaving }
    }
}
