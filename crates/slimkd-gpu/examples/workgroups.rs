//! Which shape of a workgroup is fastest: `cargo run --release -p slimkd-gpu --example workgroups -- SCENE [EDGE [ROUNDS]]`. SCENE is a
//! file or `NAME:TRIANGLES` of a built-in one. Prints the seconds that the kernels of three views take, medians of rounds in
//! which the shapes take turns.

use slimkd::{KdTree, Preset};
use slimkd_gpu::frame::GpuScene;
use slimkd_gpu::{Device, UploadOptions};
use slimkd_render::{RenderSettings, Setup, views};
use slimkd_scene::{load, procedural};
use std::error::Error;
use std::path::Path;

/// Width and height; the first is the paper's.
const SHAPES: [[u32; 2]; 9] = [[4, 32], [4, 16], [4, 8], [8, 4], [8, 8], [8, 16], [16, 8], [32, 4], [128, 1]];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = arguments.first().ok_or("name a scene")?;
    let number = |index: usize, default: u32| arguments.get(index).map_or(Ok(default), |text| text.parse());
    let (edge, rounds) = (number(1, 128)?, number(2, 5)?);
    let scene = match name.split_once(':') {
        Some((name, triangles)) => procedural::generate(name, triangles.parse()?).ok_or("no such scene")?,
        None => load(Path::new(name))?,
    };
    let mut settings = RenderSettings::sized(edge, edge);
    (settings.samples, settings.occlusion) = (1, 0);
    let device = Device::open(None)?;
    println!("{}: {} triangles, {edge} x {edge}, on {}", scene.name, scene.mesh.len(), device.adapter().name);
    for preset in [Preset::Standard, Preset::Slim] {
        let tree = KdTree::build(scene.mesh.clone(), &preset.into())?;
        let cameras = views::of_scene(&scene, &tree, 3);
        let mut uploaded = Vec::new();
        for shape in SHAPES {
            let mut options = UploadOptions::default();
            options.block = shape;
            uploaded.push(GpuScene::upload(&device, &scene, &tree, &options)?);
        }
        let mut seconds = vec![Vec::new(); SHAPES.len()];
        // The first round compiles.
        for round in 0..=rounds as usize {
            for turn in 0..SHAPES.len() {
                let index = (turn + round) % SHAPES.len();
                let mut sum = 0.0;
                for camera in &cameras {
                    let setup = Setup::new(&scene, &tree, camera, &scene.lights, &settings)?;
                    let (_, time) = uploaded[index].render(&setup, &settings, &slimkd::Progress::new())?;
                    sum += time.kernels.as_secs_f64();
                }
                if round > 0 {
                    seconds[index].push(sum);
                }
            }
        }
        for ([x, y], mut seconds) in SHAPES.into_iter().zip(seconds) {
            seconds.sort_by(f64::total_cmp);
            println!("{:<10} {x:>3} x {y:<3} {:>8.3} s", preset.name(), seconds[seconds.len() / 2]);
        }
    }
    Ok(())
}
