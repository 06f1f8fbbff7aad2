//! The triangle test for peers that bring none that fits: two-sided Möller-Trumbore over three corners.
//!
//! Möller & Trumbore, *Fast, Minimum Storage Ray/Triangle Intersection*, Journal of Graphics Tools 2(1), 1997.

use slimkd::{Ray, TriangleMesh};

/// Three corners, 36 bytes.
pub(super) type Corners = [[f32; 3]; 3];

/// Every triangle's corners, by id.
pub(super) fn all_corners(mesh: &TriangleMesh) -> Vec<Corners> {
    (0..mesh.len() as u32).map(|id| mesh.corners(id)).collect()
}

/// Where `ray` hits within its range, else `+inf`.
#[inline(always)]
pub(super) fn intersect(corners: &Corners, ray: &Ray) -> f32 {
    let sub = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [f32; 3], b: [f32; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (e1, e2) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
    let p = cross(ray.direction, e2);
    let det = dot(e1, p);
    if det == 0.0 {
        return f32::INFINITY;
    }
    let inverse = 1.0 / det;
    let s = sub(ray.origin, corners[0]);
    let u = dot(s, p) * inverse;
    let q = cross(s, e1);
    let v = dot(ray.direction, q) * inverse;
    let t = dot(e2, q) * inverse;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= ray.t_min && t <= ray.t_max { t } else { f32::INFINITY }
}
