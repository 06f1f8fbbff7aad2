//! The little vector arithmetic that rays and checks need, in double precision where a judgement hangs on it.

use slimkd::{Aabb, TriangleMesh};

/// A vector in double precision.
pub type Vec64 = [f64; 3];

/// Widens.
pub fn wide(a: [f32; 3]) -> Vec64 {
    a.map(f64::from)
}

/// Narrows to the nearest f32.
pub fn narrow(a: Vec64) -> [f32; 3] {
    a.map(|x| x as f32)
}

/// a − b
pub fn sub(a: Vec64, b: Vec64) -> Vec64 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + s·b
pub fn add_scaled(a: Vec64, s: f64, b: Vec64) -> Vec64 {
    [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]]
}

/// a · b
pub fn dot(a: Vec64, b: Vec64) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b
pub fn cross(a: Vec64, b: Vec64) -> Vec64 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// |a|
pub fn length(a: Vec64) -> f64 {
    dot(a, a).sqrt()
}

/// a / |a|, or `None` for a zero or not finite vector.
pub fn normalized(a: Vec64) -> Option<Vec64> {
    let l = length(a);
    (l > 0.0 && l.is_finite()).then(|| a.map(|x| x / l))
}

/// Distance from point `p` to the segment from `a` to `b`.
pub fn segment_distance(p: Vec64, a: Vec64, b: Vec64) -> f64 {
    let (ab, ap) = (sub(b, a), sub(p, a));
    let square = dot(ab, ab);
    let s = if square > 0.0 { (dot(ap, ab) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(sub(p, add_scaled(a, s, ab)))
}

/// Bounds of all triangles whose corners are finite; empty without one.
pub fn bounds(mesh: &TriangleMesh) -> Aabb {
    let mut bounds = Aabb::EMPTY;
    for id in 0..mesh.len() as u32 {
        let corners = mesh.corners(id);
        if corners.iter().flatten().all(|x| x.is_finite()) {
            corners.into_iter().for_each(|corner| bounds.include(corner));
        }
    }
    bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_to_a_segment() {
        let (a, b) = ([0.0; 3], [2.0, 0.0, 0.0]);
        assert_eq!(segment_distance([1.0, 3.0, 0.0], a, b), 3.0);
        assert_eq!(segment_distance([5.0, 4.0, 0.0], a, b), 5.0);
        assert_eq!(segment_distance([0.0, 0.0, 2.0], a, a), 2.0);
        assert_eq!(normalized([0.0; 3]), None);
    }
}
