//! Prints what scene files hold and how long they took to load: `cargo run --release --example load -- FILE…`

use slimkd_scene::load;
use std::{env, path::Path, process::ExitCode, time::Instant};

fn main() -> ExitCode {
    let paths: Vec<_> = env::args_os().skip(1).collect();
    if paths.is_empty() {
        eprintln!("usage: load FILE…");
        return ExitCode::from(2);
    }
    let mut status = ExitCode::SUCCESS;
    for path in &paths {
        let path = Path::new(path);
        let start = Instant::now();
        let scene = match load(path) {
            Ok(scene) => scene,
            Err(error) => {
                eprintln!("{}: {error}", path.display());
                status = ExitCode::FAILURE;
                continue;
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let mesh = &scene.mesh;
        println!(
            "{}: {} triangles, {} vertices, {seconds:.3} s",
            scene.name,
            mesh.len(),
            mesh.vertices().len()
        );
        println!(
            "  normals {}, texture coordinates {}, {} materials, {} textures, {} cameras, {} lights",
            if scene.normals.is_some() { "yes" } else { "no" },
            if scene.uvs.is_some() { "yes" } else { "no" },
            scene.materials.len(),
            scene.textures.len(),
            scene.cameras.len(),
            scene.lights.len(),
        );
        for warning in &scene.warnings {
            println!("  warning: {warning}");
        }
    }
    status
}
