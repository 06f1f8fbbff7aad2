//! Build once, keep the tree in a file, read it back.

use slimkd::{BuildOptions, KdTree, Ray, TriangleMesh};
use std::fs::File;
use std::io::{BufReader, BufWriter};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    let tree = KdTree::build(mesh, &BuildOptions::default())?;

    let path = std::env::temp_dir().join("slimkd-example.skd");
    tree.write(&mut BufWriter::new(File::create(&path)?))?;
    let again = KdTree::read(&mut BufReader::new(File::open(&path)?))?; // proves every pointer before it returns
    std::fs::remove_file(&path)?;

    let ray = Ray::new([0.2, 0.2, 5.0], [0.0, 0.0, -1.0]);
    assert_eq!(again.closest_hit(&ray), tree.closest_hit(&ray));
    println!("{} bytes of tree, the same hits", again.memory().tree());
    Ok(())
}
