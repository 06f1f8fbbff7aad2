//! The corners of triangles, read without bounds checks: for one ray, and for 16 lanes.

use crate::geometry::TriangleMesh;
use crate::simd::Simd;

/// The mesh behind a proven tree.
#[derive(Clone, Copy)]
pub(crate) struct MeshView<'a> {
    triangles: &'a [[u32; 3]],
    vertices: &'a [[f32; 3]],
}

impl<'a> MeshView<'a> {
    pub(crate) fn new(mesh: &'a TriangleMesh) -> Self {
        Self { triangles: mesh.triangles(), vertices: mesh.vertices() }
    }

    /// Corners of a triangle.
    ///
    /// # Safety
    /// The mesh must have it.
    #[inline(always)]
    pub(crate) unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        debug_assert!((triangle as usize) < self.triangles.len());
        // SAFETY: the caller says that the triangle exists, and the mesh's vertex indices were checked when it was made.
        unsafe {
            // Written out: an array's `map` falls out of the inline chain of kernels.
            let [a, b, c] = *self.triangles.get_unchecked(triangle as usize);
            let vertices = self.vertices;
            [
                *vertices.get_unchecked(a as usize),
                *vertices.get_unchecked(b as usize),
                *vertices.get_unchecked(c as usize),
            ]
        }
    }

    /// Where the corners of a triangle stand.
    ///
    /// # Safety
    /// The mesh must have it.
    #[inline(always)]
    pub(crate) unsafe fn corner_pointers(self, triangle: u32) -> [*const [f32; 3]; 3] {
        debug_assert!((triangle as usize) < self.triangles.len());
        // SAFETY: the caller says that the triangle exists, and the mesh's vertex indices were checked when it was made.
        unsafe {
            let (vertices, [a, b, c]) =
                (self.vertices.as_ptr(), *self.triangles.get_unchecked(triangle as usize));
            [vertices.add(a as usize), vertices.add(b as usize), vertices.add(c as usize)]
        }
    }

    /// Whether lanes can address both arrays: they count in 4-byte units below 2³¹.
    pub(crate) fn fits_lanes(self) -> bool {
        const REACH: usize = (1 << 31) / 3;
        !self.triangles.is_empty() && self.triangles.len() < REACH && self.vertices.len() < REACH
    }

    /// x, y, z of the corners of a triangle a lane.
    ///
    /// # Safety
    /// [`MeshView::fits_lanes`] must hold, and the mesh must have every lane's triangle.
    #[inline(always)]
    pub(crate) unsafe fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        let (triangles, vertices) =
            (self.triangles.as_ptr().cast::<u8>(), self.vertices.as_ptr().cast::<u8>());
        let (last_triangle, last_vertex) = (self.triangles.len() as u32 - 1, self.vertices.len() as u32 - 1);
        // SAFETY: the ids name triangles, and the mesh's vertex indices were checked when it was made.
        unsafe {
            let [a, b, c] = lane_entries(s, triangles, last_triangle, triangle);
            let a = lane_entries(s, vertices, last_vertex, a);
            let b = lane_entries(s, vertices, last_vertex, b);
            let c = lane_entries(s, vertices, last_vertex, c);
            [lane_floats(s, a), lane_floats(s, b), lane_floats(s, c)]
        }
    }
}

/// The three u32 of 12-byte entries.
///
/// # Safety
/// Indices must be at most `last`, the last entry of the array; the array must be as [`MeshView::fits_lanes`] says.
#[inline(always)]
unsafe fn lane_entries<S: Simd>(s: S, base: *const u8, last: u32, index: S::U) -> [S::U; 3] {
    let at = index + (index << 1);
    // SAFETY: 16 bytes are read where another entry follows, else 12; all offsets are below 2³¹ of 4 bytes.
    unsafe {
        if s.any(s.eq_u32(index, s.u32s(last))) {
            let (x, y) = s.gather_pairs::<4>(base, at);
            return [x, y, s.gather_u32::<4>(base, at + s.u32s(2))];
        }
        let [x, y, z, _] = s.gather_rows::<4>(base, at);
        [x, y, z]
    }
}

#[inline(always)]
fn lane_floats<S: Simd>(s: S, [x, y, z]: [S::U; 3]) -> [S::F; 3] {
    [s.cast_f32(x), s.cast_f32(y), s.cast_f32(z)]
}
