//! A scanner in a hilly field: many rays over all threads, every return along each of them.

use rayon::prelude::*;
use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};

/// A field of `n` × `n` cells of one metre, hills of two metres.
fn field(n: u32) -> TriangleMesh {
    let height = |x: u32, y: u32| (x as f32 * 0.11).sin() + (y as f32 * 0.07).cos();
    let vertices = (0..=n).flat_map(|y| (0..=n).map(move |x| [x as f32, y as f32, height(x, y)])).collect();
    let row = n + 1;
    let triangles = (0..n)
        .flat_map(|y| (0..n).map(move |x| y * row + x))
        .flat_map(|a| [[a, a + 1, a + row], [a + 1, a + row + 1, a + row]])
        .collect();
    TriangleMesh::new(vertices, triangles).expect("all indices are inside")
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tree = KdTree::build(field(400), &BuildOptions::default())?;
    println!("{:.1} bytes of tree a triangle", tree.memory().tree() as f64 / tree.mesh().len() as f64);

    // One turn of the mirror a degree of elevation; the range is 150 m, since directions have length 1.
    let returns: Vec<usize> = (0..360 * 60)
        .into_par_iter()
        .map(|i| {
            let (azimuth, elevation) = ((i % 360) as f32, -0.5 * (i / 360) as f32);
            let (a, e) = (azimuth.to_radians(), elevation.to_radians());
            let ray = Ray::new([200.0, 200.0, 6.0], [a.cos() * e.cos(), a.sin() * e.cos(), e.sin()]);
            tree.all(&ray.with_range(0.5, 150.0)).len()
        })
        .collect();
    for count in 0..=3 {
        println!("{count} returns: {} pulses", returns.iter().filter(|&&n| n == count).count());
    }
    Ok(())
}
