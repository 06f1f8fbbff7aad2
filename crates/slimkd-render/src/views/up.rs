//! Which way is up in a file that does not say.

use glam::DVec3;
use slimkd::TriangleMesh;
use slimkd_scene::UpAxis;

/// A normal counts as axis-parallel from this cosine on.
const PARALLEL: f64 = 0.98;

/// Guesses the up axis: floors, ceilings, roofs and ground make the axis with the most surface across it, and the
/// scene lies rather than stands. Without flat surfaces, y.
pub fn guess_up(mesh: &TriangleMesh) -> UpAxis {
    let [x, y, z] = scores(mesh);
    // Few programs use x.
    if x > 2.0 * y.max(z) {
        UpAxis::X
    } else if z > 1.15 * y {
        UpAxis::Z
    } else {
        UpAxis::Y
    }
}

/// How much speaks for each axis.
fn scores(mesh: &TriangleMesh) -> [f64; 3] {
    let mut flat = [0.0; 3];
    let mut total = 0.0;
    let mut bounds = slimkd::Aabb::EMPTY;
    for id in 0..mesh.len() as u32 {
        let corners = mesh.corners(id);
        let [a, b, c] = corners.map(|corner| DVec3::from(corner.map(f64::from)));
        let normal = (b - a).cross(c - a);
        let area = normal.length();
        if !area.is_finite() || area == 0.0 {
            continue;
        }
        corners.into_iter().for_each(|corner| bounds.include(corner));
        total += area;
        let normal = normal / area;
        for axis in 0..3 {
            if normal[axis].abs() >= PARALLEL {
                flat[axis] += area;
            }
        }
    }
    let extent = bounds.extent();
    let largest = extent.into_iter().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    std::array::from_fn(|axis| {
        let share = if total > 0.0 { flat[axis] / total } else { 0.0 };
        // 0.05: what an object without flat sides has on every axis.
        (share + 0.05) * (1.0 - 0.5 * extent[axis] / largest)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with these half extents.
    fn hall(half: [f32; 3]) -> TriangleMesh {
        let vertices = (0..8)
            .map(|k| std::array::from_fn(|axis| if k >> axis & 1 == 1 { half[axis] } else { -half[axis] }));
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriangleMesh::new(vertices.collect(), triangles).unwrap()
    }

    #[test]
    fn halls_lie_flat() {
        assert_eq!(guess_up(&hall([10.0, 3.0, 8.0])), UpAxis::Y);
        assert_eq!(guess_up(&hall([10.0, 8.0, 3.0])), UpAxis::Z);
        assert_eq!(guess_up(&hall([1.0, 10.0, 8.0])), UpAxis::X);
    }

    #[test]
    fn nothing_to_go_by_is_y() {
        assert_eq!(guess_up(&TriangleMesh::default()), UpAxis::Y);
        assert_eq!(guess_up(&hall([1.0; 3])), UpAxis::Y);
        let broken =
            TriangleMesh::new(vec![[f32::NAN; 3], [0.0; 3], [f32::MAX; 3]], vec![[0, 1, 2], [1, 2, 2]]);
        assert_eq!(guess_up(&broken.unwrap()), UpAxis::Y);
    }
}
