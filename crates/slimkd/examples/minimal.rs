//! The shortest useful program: a mesh, a tree, a ray.

use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    let tree = KdTree::build(mesh, &BuildOptions::default())?;

    let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
    match tree.closest(&ray) {
        Some(hit) => println!("triangle {} at t = {}, point {:?}", hit.triangle, hit.t, ray.at(hit.t)),
        None => println!("nothing there"),
    }
    Ok(())
}
