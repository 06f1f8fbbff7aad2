//! Where a secondary ray starts, so that it does not hit the triangle that it leaves.
//!
//! After Wächter & Binder, *A Fast and Robust Method for Avoiding Self-Intersection*, Ray Tracing Gems (2019), ch. 6:
//! the point moves along the geometric normal by a number of units in the last place. Deviations:
//! 1. The magnitude is that of the triangle's corners and not of the point alone: the rounding of an intersection
//!    grows with the corners (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 3rd ed., §3.9), and a large
//!    triangle through the origin needs its offset there too.
//! 2. It is relative everywhere; their constant 1/65536 near the origin would be too much in a scene of tiny extent.
//! 3. The point also moves as far towards the triangle's centre. Else a point on the edge between a floor and a wall
//!    may be rounded to behind the wall, and light leaks in.
//! 4. The point is interpolated in f64, so that 32 units do where they take 256: contact shadows stay.

use glam::{DVec3, Vec3};

/// Offset over the largest absolute coordinate of a triangle: 32 units in the last place (2⁻²⁴).
const RELATIVE: f32 = 1.0 / (1 << 19) as f32;

/// How far to move off a triangle with these corners, scene units.
pub(crate) fn distance(corners: &[Vec3; 3]) -> f32 {
    let magnitude = corners.iter().fold(0.0_f32, |max, corner| max.max(corner.abs().max_element()));
    magnitude * RELATIVE
}

/// `point` moved by `distance` towards `center`, at most up to it.
pub(crate) fn inwards(point: DVec3, center: DVec3, distance: f32) -> Vec3 {
    let way = center - point;
    (point + way * (f64::from(distance) / way.length().max(f64::MIN_POSITIVE)).min(1.0)).as_vec3()
}

/// `point` moved by `distance` to the side of `normal` on which `direction` goes.
pub(crate) fn leave(point: Vec3, normal: Vec3, distance: f32, direction: Vec3) -> Vec3 {
    if direction.dot(normal) >= 0.0 { point + normal * distance } else { point - normal * distance }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{hash, unit};
    use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};

    /// Triangles of all sizes, near and far, needles too: no ray that leaves one hits it again.
    #[test]
    fn a_ray_that_leaves_a_triangle_does_not_hit_it() {
        let mut counter = 0;
        let mut random = || {
            counter += 1;
            2.0 * unit(hash(counter, 3, 9)) - 1.0
        };
        for round in 0..600 {
            let size = 10.0_f32.powi(round % 9 - 4);
            let far = size * [0.0, 1.0, 100.0, 1000.0][round as usize % 4];
            let thin = [1.0, 0.01][round as usize % 2];
            let mut point = |scale: f32| Vec3::new(random(), random(), random()) * scale;
            let base = point(far);
            let corners = [base, base + point(size), base + point(size * thin)];
            let mesh = TriangleMesh::new(corners.map(|c| c.to_array()).to_vec(), vec![[0, 1, 2]]).unwrap();
            let tree = KdTree::build(mesh, &BuildOptions::default()).unwrap();
            let [a, b, c] = corners.map(Vec3::as_dvec3);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            for _ in 0..40 {
                let (u, v) = (f64::from(random().abs()), f64::from(random().abs()));
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let hit = (a * (1.0 - u - v) + b * u + c * v).as_vec3();
                let mut direction = Vec3::new(random(), random(), random()).normalize();
                if round % 3 == 0 {
                    // Grazing.
                    direction = ((b - a).normalize().as_vec3() + direction * 1e-3).normalize();
                }
                let origin = leave(hit, normal.as_vec3(), distance(&corners), direction);
                assert!(!tree.any(&Ray::new(origin, direction)), "{corners:?} {hit} {direction}");
            }
        }
    }
}
