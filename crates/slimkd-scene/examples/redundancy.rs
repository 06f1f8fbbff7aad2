//! Prints how often a standard SAH kd-tree refers to a triangle, for the built-in scenes at several sizes; 3 to 14 is
//! what Choi et al. (2013) found in theirs.
//!
//! `cargo run --release --example redundancy [SCENE]`

use slimkd::{BuildOptions, KdTree, Preset};
use slimkd_scene::procedural;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let only = std::env::args().nth(1);
    println!("{:<12} {:>10} {:>10} {:>6} {:>9}", "scene", "triangles", "redundancy", "depth", "SAH cost");
    for built_in in procedural::list() {
        if only.as_deref().is_some_and(|name| name != built_in.name) {
            continue;
        }
        for triangles in [10_000, 100_000, built_in.triangles] {
            let Some(scene) = procedural::generate(built_in.name, triangles) else { continue };
            let tree = KdTree::build(scene.mesh, &BuildOptions::from(Preset::Standard))?;
            let statistics = tree.statistics();
            println!(
                "{:<12} {:>10} {:>10.2} {:>6} {:>9.1}",
                built_in.name,
                statistics.triangles,
                statistics.redundancy(),
                statistics.max_depth,
                statistics.sah_cost
            );
        }
    }
    Ok(())
}
