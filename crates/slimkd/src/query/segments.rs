//! Whether anything lies between two points.
//!
//! A segment is open at both ends: a triangle on which an end lies does not hide one end from the other. An end that was computed lies
//! beside its surface by the rounding of its coordinates. So a triangle counts as one on which an end lies where the end is no
//! farther from it than four units in the last place of the segment's largest coordinate: that is asked of the triangles that the segment hits only.

use crate::geometry::{Ray, nearest_on_triangle};

/// How far an end may lie beside its triangle, relative to the largest coordinate of both ends.
const NEAR: f32 = 1.0 / (1 << 22) as f32;

/// Two points; the question is what lies between them.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Segment, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let lamp = [0.2, 0.2, 5.0];
/// let segments = [Segment { from: [0.2, 0.2, 0.0], to: lamp }, Segment { from: [0.2, 0.2, -1.0], to: lamp }];
/// let mut visible = [false; 2];
/// tree.batch().visible(&segments, &mut visible);
/// assert_eq!(visible, [true, false]); // the first one starts on the triangle
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Segment {
    /// One end, scene units.
    pub from: [f32; 3],
    /// The other end, scene units.
    pub to: [f32; 3],
}

impl Segment {
    /// The ray from end to end, over the range [0, 1].
    pub(super) fn ray(&self) -> Ray {
        let direction: [f32; 3] = std::array::from_fn(|k| self.to[k] - self.from[k]);
        Ray::new(self.from, direction).with_range(0.0, 1.0)
    }

    /// Whether an end lies on the triangle, up to the rounding of its coordinates.
    pub(super) fn ends_on(&self, corners: &[[f32; 3]; 3]) -> bool {
        let largest = self.from.iter().chain(&self.to).fold(0.0f32, |most, x| most.max(x.abs()));
        let near = f64::from(NEAR * largest);
        [self.from, self.to].iter().any(|end| nearest_on_triangle(*end, corners).square <= near * near)
    }
}
