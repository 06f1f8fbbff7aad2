//! Build once, keep the tree in a file, read it back.

use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    let tree = KdTree::build(mesh, &BuildOptions::default())?;

    let path = std::env::temp_dir().join("slimkd-example.skd");
    tree.save(&path)?; // whatever happens meanwhile, there is the old file or the new one
    let again = KdTree::load(&path)?; // proves checksums and every pointer before it returns
    std::fs::remove_file(&path)?;

    let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
    assert_eq!(again.closest(&ray), tree.closest(&ray));
    println!("{} bytes of tree, the same hits", again.memory().tree());
    Ok(())
}
