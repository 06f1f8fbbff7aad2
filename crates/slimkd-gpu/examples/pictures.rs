//! Pictures on a GPU against the CPU's: `cargo run --release -p slimkd-gpu --example pictures -- SCENE [EDGE [SAMPLES [FOLDER]]]`.
//! SCENE is a file or `NAME:TRIANGLES` of a built-in one; its first three views are rendered with every preset's tree. Prints the
//! share of the pixels that differ by more than 1/255, which must be at most 0.1 %; with FOLDER, both pictures are saved there.
//! SLIMKD_BLOCK=4x32 sets the shape of a workgroup.

use slimkd::{KdTree, Preset};
use slimkd_gpu::frame::GpuScene;
use slimkd_gpu::{Device, UploadOptions};
use slimkd_render::{BitDepth, Development, RenderSettings, Setup, render, views};
use slimkd_scene::{load, procedural};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let name = arguments.first().ok_or("name a scene")?;
    let number = |index: usize, default: u32| arguments.get(index).map_or(Ok(default), |text| text.parse());
    let (edge, samples, folder) = (number(1, 256)?, number(2, 1)?, arguments.get(3));
    let scene = match name.split_once(':') {
        Some((name, triangles)) => procedural::generate(name, triangles.parse()?).ok_or("no such scene")?,
        None => load(Path::new(name))?,
    };
    let mut options = UploadOptions::default();
    if let Some((x, y)) =
        std::env::var("SLIMKD_BLOCK").ok().as_deref().and_then(|block| block.split_once('x'))
    {
        options.block = [x.parse()?, y.parse()?];
    }
    let mut settings = RenderSettings::sized(edge, edge);
    settings.samples = samples;
    let device = Device::open(None)?;
    let [x, y] = options.block;
    println!(
        "{}: {} triangles, {edge} x {edge}, {samples} samples, on {}, workgroups of {x} x {y}",
        scene.name,
        scene.mesh.len(),
        device.adapter().name
    );
    println!("view preset       shards unlike, %     rays    rays (GPU)  CPU, s  GPU kernels, s");
    let mut failed = false;
    for &preset in Preset::ALL {
        let tree = KdTree::build(scene.mesh.clone(), &preset.into())?;
        let gpu = GpuScene::upload(&device, &scene, &tree, &options)?;
        for (view, camera) in views::of_scene(&scene, &tree, 3).iter().enumerate() {
            let started = Instant::now();
            let wanted = render(&scene, &tree, camera, &scene.lights, &settings, &slimkd::Progress::new())?;
            let seconds = started.elapsed().as_secs_f64();
            let setup = Setup::new(&scene, &tree, camera, &scene.lights, &settings)?;
            let (film, time) = gpu.render(&setup, &settings, &slimkd::Progress::new())?;
            let apart = wanted.share_apart(&film);
            failed |= apart > 1e-3;
            println!(
                "{:<4} {:<12} {:>6} {:>9.3} {:>12} {:>12} {seconds:>7.3} {:>9.3}",
                view + 1,
                preset.name(),
                gpu.shards(),
                100.0 * apart,
                wanted.rays().total(),
                film.rays().total(),
                time.kernels.as_secs_f64()
            );
            for (film, by) in [(&wanted, "cpu"), (&film, "gpu")] {
                if let Some(folder) = folder {
                    let name = format!("{}-{}-{}-{by}.png", scene.name, view + 1, preset.name());
                    film.save(&Path::new(folder).join(name), &Development::default(), BitDepth::Eight)?;
                }
            }
        }
    }
    if failed { Err("more than 0.1 % of a picture's pixels differ".into()) } else { Ok(()) }
}
