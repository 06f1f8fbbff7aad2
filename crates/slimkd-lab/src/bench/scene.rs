//! Where the triangles come from.

use crate::basics::soup::soup;
use crate::basics::vector::bounds;
use crate::bench::args::Args;
use crate::workload::view::View;
use anyhow::{Context, Result, bail, ensure};
use slimkd::KdTree;
use slimkd_render::views;
use slimkd_scene::{Scene, procedural};
use std::path::Path;

/// Triangles of `soup` where no number is given.
const SOUP_TRIANGLES: usize = 10_000;

/// Loads or makes what the command line names.
pub fn open(args: &Args) -> Result<Scene> {
    let mut scene = if args.scene == "soup" {
        let triangles = u32::try_from(args.triangles.unwrap_or(SOUP_TRIANGLES))
            .ok()
            .filter(|&count| count < u32::MAX / 3)
            .context("--triangles is more than 32-bit ids can name")?;
        Scene { name: "soup".into(), mesh: soup(triangles, args.seed).into(), ..Scene::default() }
    } else if let Some(built_in) = procedural::find(&args.scene) {
        procedural::generate(built_in.name, args.triangles.unwrap_or(built_in.triangles))
            .context("--triangles is more than 32-bit ids can name")?
    } else {
        let path = Path::new(&args.scene);
        ensure!(
            path.exists(),
            "{}: neither a file nor a built-in scene ({})",
            args.scene,
            procedural::list().iter().map(|scene| scene.name).collect::<Vec<_>>().join(", ")
        );
        slimkd_scene::load(path)?
    };
    ensure!(!bounds(&scene.mesh).is_empty(), "{}: no valid triangle, nothing to measure", args.scene);
    if let Some(up) = args.up {
        scene.up = Some(up.into());
    }
    Ok(scene)
}

/// The view that the command line asks for: its camera, else the scene's, else one found by looking around.
pub fn view(args: &Args, scene: &Scene, tree: &KdTree) -> Result<View> {
    if let Some(text) = &args.camera {
        let up = scene.up.unwrap_or_else(|| views::guess_up(&scene.mesh));
        return View::parse(text, up).map_err(anyhow::Error::msg);
    }
    let cameras = views::of_scene(scene, tree, views::VIEWS.max(scene.cameras.len()));
    match args.view.checked_sub(1).and_then(|index| cameras.get(index)) {
        Some(&camera) => Ok(camera.into()),
        None => bail!("--view {}: there are {} views; or use --camera", args.view, cameras.len()),
    }
}
