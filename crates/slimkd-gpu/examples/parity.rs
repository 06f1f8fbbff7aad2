//! Rays on a GPU against the CPU, every preset: `cargo run --release -p slimkd-gpu --example parity -- SCENE [RAYS]`. SCENE is a
//! file or `NAME:TRIANGLES` of a built-in one. Prints how many hits are the same to the bit, how many are another triangle or t
//! within the bound, and how many are neither, which must be 0.

use slimkd::{KdTree, Preset, Ray, Tracer};
use slimkd_gpu::{Device, GpuTree, UploadOptions, t_bound};
use slimkd_scene::{Scene, load, procedural};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = arguments.first().ok_or("name a scene")?;
    let count = arguments.get(1).map_or(Ok(1_000_000), |text| text.parse())?;
    let scene = scene(name)?;
    let device = Device::open(None)?;
    println!("{name}: {} triangles, on {}", scene.mesh.len(), device.adapter().name);
    println!("preset       tree bytes shards       same  in bound   else  kernel Mrays/s");
    let mut failed = false;
    for &preset in Preset::ALL {
        let tree = KdTree::build(scene.mesh.clone(), &preset.into())?;
        let gpu = GpuTree::upload(&device, &tree, &UploadOptions::default())?;
        let rays = rays(&tree, count);
        let (mut wanted, mut found) = (vec![None; count], vec![None; count]);
        tree.batch().closest(&rays, &mut wanted);
        let time = gpu.closest(&rays, &mut found)?;
        let (mut same, mut near, mut neither) = (0, 0, 0);
        for ((ray, wanted), found) in rays.iter().zip(&wanted).zip(&found) {
            let close = |a: f32, b: f32| (a - b).abs() <= t_bound(ray, &tree.bounds(), a);
            let at_an_end = |t: f32| close(t, ray.t_min) || close(t, ray.t_max);
            match (wanted, found) {
                (a, b) if a == b => same += 1,
                (Some(a), Some(b)) if close(a.t, b.t) => near += 1,
                (a, b) if a.or(*b).is_some_and(|hit| at_an_end(hit.t)) => near += 1,
                _ => neither += 1,
            }
        }
        failed |= neither > 0;
        let rate = count as f64 / time.kernels.as_secs_f64() / 1e6;
        let (bytes, shards) = (tree.memory().tree(), gpu.shards());
        println!(
            "{:<12} {bytes:>10} {shards:>6} {same:>10} {near:>9} {neither:>6} {rate:>15.3}",
            preset.name()
        );
    }
    if failed { Err("some hits are beyond the bound".into()) } else { Ok(()) }
}

fn scene(name: &str) -> Result<Scene, Box<dyn Error>> {
    if let Some((name, triangles)) = name.split_once(':') {
        return procedural::generate(name, triangles.parse()?).ok_or_else(|| "no such scene".into());
    }
    Ok(load(std::path::Path::new(name))?)
}

/// Half segments across the scene, half rays from where those hit to anywhere.
fn rays(tree: &KdTree, count: usize) -> Vec<Ray> {
    let mut random = fastrand::Rng::with_seed(3);
    let bounds = tree.bounds();
    let mut point = || -> [f32; 3] {
        std::array::from_fn(|k| bounds.min[k] + random.f32() * (bounds.max[k] - bounds.min[k]))
    };
    (0..count)
        .map(|k| {
            let (from, to) = (point(), point());
            let ray = Ray::new(from, std::array::from_fn::<_, 3, _>(|k| to[k] - from[k]));
            match tree.closest(&ray) {
                Some(hit) if k % 2 == 1 => {
                    let (start, end) = (ray.at(hit.t), point());
                    Ray::new(start, std::array::from_fn::<_, 3, _>(|k| end[k] - start[k]))
                        .with_range(1e-4, f32::INFINITY)
                }
                _ => ray.with_range(0.0, 1.0),
            }
        })
        .collect()
}
