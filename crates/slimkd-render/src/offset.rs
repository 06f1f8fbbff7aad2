//! Where a secondary ray starts, so that it does not hit the triangle that it leaves.
//!
//! After Wächter & Binder, *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems (2019), ch. 6:
//! the point moves along the geometric normal by a number of units in the last place. Deviations:
//! 1. The magnitude is that of the triangle's corners and not of the point alone: the rounding of an intersection
//!    grows with the corners (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 3rd ed., §3.9), and a large
//!    triangle through the origin needs its offset there too.
//! 2. It is relative everywhere; their constant 1/65536 near the origin would be too much in a scene of tiny extent.
//! 3. The point is interpolated in f64, so that 32 units do where they take 256: contact shadows stay.

use glam::Vec3;

/// Offset over the largest absolute coordinate of a triangle: 32 units in the last place (2⁻²⁴).
const RELATIVE: f32 = 1.0 / (1 << 19) as f32;

/// How far to move off a triangle with these corners, scene units.
pub(crate) fn distance(corners: &[Vec3; 3]) -> f32 {
    let magnitude = corners.iter().fold(0.0_f32, |max, corner| max.max(corner.abs().max_element()));
    magnitude * RELATIVE
}

/// `point` moved by `distance` to the side of `normal` on which `direction` goes.
pub(crate) fn leave(point: Vec3, normal: Vec3, distance: f32, direction: Vec3) -> Vec3 {
    if direction.dot(normal) >= 0.0 { point + normal * distance } else { point - normal * distance }
}
