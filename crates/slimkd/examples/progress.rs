//! A build that another thread watches, and could cancel.

use slimkd::{BuildOptions, KdTree, Preset, Progress, TriangleMesh};
use std::time::Duration;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A spiral ribbon of half a million triangles.
    let n = 250_000u32;
    let point = |i: u32, z: f32| {
        let angle = i as f32 * 0.001;
        [angle.cos() * angle, angle.sin() * angle, z]
    };
    let vertices = (0..=n).flat_map(|i| [point(i, 0.0), point(i, 1.0)]).collect();
    let triangles =
        (0..n).flat_map(|i| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 1, 2 * i + 3, 2 * i + 2]]).collect();
    let mesh = TriangleMesh::new(vertices, triangles)?;

    let progress = Progress::new();
    let tree = std::thread::scope(|scope| {
        let build =
            scope.spawn(|| KdTree::build_with_progress(mesh, &BuildOptions::from(Preset::Slim), &progress));
        while !build.is_finished() {
            println!("{:3.0} %", 100.0 * progress.fraction());
            std::thread::sleep(Duration::from_millis(100)); // `progress.cancel()` would end it here
        }
        build.join().expect("the build does not panic")
    })?;
    println!("{} nodes", tree.statistics().nodes.leaf * 2 - 1);
    Ok(())
}
