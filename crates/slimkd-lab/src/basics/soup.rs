//! A mesh for tests and first runs: small triangles scattered through a cube.

use slimkd::TriangleMesh;
use slimkd_util::Rng;

/// `triangles` random triangles in the unit cube: edges of about 5 % of it, and shorter where there are many, so that
/// each box meets few others.
pub fn soup(triangles: u32, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let reach = (0.5 / (triangles.max(1) as f32).cbrt()).min(0.05);
    let mut vertices = Vec::with_capacity(3 * triangles as usize);
    for _ in 0..triangles {
        let centre: [f32; 3] = std::array::from_fn(|_| rng.unit());
        for _ in 0..3 {
            vertices.push(centre.map(|x| x + rng.between(-reach, reach)));
        }
    }
    let indices = (0..triangles).map(|id| [3 * id, 3 * id + 1, 3 * id + 2]).collect();
    TriangleMesh::new(vertices, indices).expect("indices are counted up with the vertices")
}
