//! Where the triangles come from.

use crate::args::Args;
use crate::soup::soup;
use crate::vector::bounds;
use crate::view::{DEFAULT_FOV, View};
use anyhow::{Context, Result, bail, ensure};
use slimkd::{Aabb, KdTree};
use slimkd_scene::{LoadProgress, Scene, UpAxis, procedural};
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
        slimkd_scene::load(path, &LoadProgress::new())?
    };
    ensure!(!bounds(&scene.mesh).is_empty(), "{}: no valid triangle, nothing to measure", args.scene);
    if let Some(up) = args.up {
        scene.up = Some(up.into());
    }
    Ok(scene)
}

/// The view that the command line asks for: its camera, else the scene's, else one found by looking around.
pub fn view(args: &Args, scene: &Scene, _tree: &KdTree) -> Result<View> {
    let up = scene.up.unwrap_or_default();
    if let Some(text) = &args.camera {
        return View::parse(text, up);
    }
    let mut views: Vec<View> = scene.cameras.iter().copied().map(View::from).collect();
    views.extend(outside(&bounds(&scene.mesh), up));
    match args.view.checked_sub(1).and_then(|index| views.get(index)) {
        Some(view) => Ok(*view),
        None => bail!("--view {}: there are {} views; or use --camera", args.view, views.len()),
    }
}

/// Three looks at the whole scene from a little above.
fn outside(bounds: &Aabb, up: UpAxis) -> Vec<View> {
    let centre: [f32; 3] = std::array::from_fn(|k| (bounds.min[k] + bounds.max[k]) / 2.0);
    let half = (0..3).map(|k| (bounds.max[k] - bounds.min[k]).powi(2)).sum::<f32>().sqrt() / 2.0;
    let up = up.vector().to_array();
    [[1.0, 0.6, 0.8], [-0.8, 0.5, 1.0], [-1.0, 0.7, -0.6]]
        .into_iter()
        .map(|way: [f32; 3]| {
            // Lift is along `up`; the two others span the ground.
            let vertical = up.iter().position(|&x| x != 0.0).unwrap_or(1);
            let mut offset = [0.0; 3];
            offset[vertical] = way[1];
            offset[(vertical + 1) % 3] = way[0];
            offset[(vertical + 2) % 3] = way[2];
            let eye = std::array::from_fn(|k| centre[k] + 1.4 * half * offset[k]);
            View { eye, target: centre, up, fov: DEFAULT_FOV }
        })
        .collect()
}
