//! What a voxel holds of a triangle: its id and the bounds of that part.
//!
//! Source: Wald & Havran 2006 §4.2 sort the bounds' faces as events once and keep them sorted.
//!
//! Deviation: a node is an unsorted list of these boxes, 32 bytes a triangle instead of six events of 8 bytes. Every decision
//! about a node follows from the set of its boxes; `search.rs` finds the same best plane without sorted lists.

use crate::geometry::{Aabb, Clipper, TriangleMesh};

/// Triangles that a build can name.
pub(crate) const TRIANGLE_LIMIT: u64 = 1 << 30;

/// The part of one triangle that lies in a voxel. Two rows of four, so that a load or a comparison takes all axes at once.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(16))]
pub(crate) struct Fragment {
    /// Lower corner, then the triangle's id as bits.
    pub(crate) low: [f32; 4],
    /// Upper corner, then nothing.
    pub(crate) high: [f32; 4],
}

impl Fragment {
    #[inline(always)]
    pub(crate) fn new(triangle: u32, bounds: &Aabb) -> Self {
        let ([a, b, c], [d, e, f]) = (bounds.min, bounds.max);
        Self { low: [a, b, c, f32::from_bits(triangle)], high: [d, e, f, 0.0] }
    }

    /// A whole triangle.
    pub(crate) fn whole(mesh: &TriangleMesh, triangle: u32) -> Self {
        Self::new(triangle, &triangle_bounds(mesh, triangle))
    }

    /// What a voxel holds of a triangle that is in it.
    pub(crate) fn in_voxel(mesh: &TriangleMesh, triangle: u32, voxel: &Aabb, exact: bool) -> Self {
        let bounds = if exact {
            Clipper::default().bounds(&mesh.corners(triangle), voxel)
        } else {
            triangle_bounds(mesh, triangle).cut_to(voxel)
        };
        Self::new(triangle, &bounds)
    }

    #[inline(always)]
    pub(crate) fn triangle(&self) -> u32 {
        self.low[3].to_bits()
    }
}

/// Bounds of a whole triangle.
pub(crate) fn triangle_bounds(mesh: &TriangleMesh, id: u32) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    mesh.corners(id).into_iter().for_each(|corner| bounds.include(corner));
    bounds
}
