//! How much of the sky each point of a surface sees: rays that start on a triangle leave it out, whatever their number.

use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};

/// Directions over the upper half, evenly spread by the golden angle.
fn directions(count: usize) -> impl Iterator<Item = [f32; 3]> {
    (0..count).map(move |i| {
        let up = (i as f32 + 0.5) / count as f32;
        let (radius, angle) = ((1.0 - up * up).sqrt(), 2.399_963 * i as f32);
        [radius * angle.cos(), radius * angle.sin(), up]
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A floor, and a wall along its left edge.
    let vertices = vec![
        [0.0, 0.0, 0.0],
        [4.0, 0.0, 0.0],
        [4.0, 4.0, 0.0],
        [0.0, 4.0, 0.0],
        [0.0, 0.0, 2.0],
        [0.0, 4.0, 2.0],
    ];
    let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]])?;
    let tree = KdTree::build(mesh, &BuildOptions::default())?;

    const RAYS: usize = 256;
    for step in 0..8 {
        let down = Ray::new([0.25 + 0.5 * step as f32, 2.1, 1.0], [0.0, 0.0, -1.0]);
        let hit = tree.closest(&down).ok_or("the floor is below")?;
        let refined = tree.refine(&down, hit.triangle).ok_or("the ray crosses the floor")?;
        let start = refined.point.map(|x| x as f32);
        let rays: Vec<Ray> = directions(RAYS).map(|direction| Ray::new(start, direction)).collect();
        let mut occluded = [false; RAYS];
        tree.batch().except(&[hit.triangle; RAYS]).any(&rays, &mut occluded);
        let sky = occluded.iter().filter(|&&occluded| !occluded).count();
        println!("x = {:.2}: sees {:3} % of the sky", start[0], 100 * sky / RAYS);
    }
    Ok(())
}
