//! The view of a scene: what the command line says, else the file's cameras, else views found by looking around.

use crate::args::CameraArgs;
use crate::failure::Failure;
use crate::scenes::Loaded;
use slimkd::KdTree;
use slimkd_render::views;
use slimkd_scene::{Camera, Scene};

/// Settles which way is up: as the command line says, else as the file says, else by a guess.
pub(crate) fn settle_up(args: &CameraArgs, scene: &mut Scene) {
    scene.up = args.up().or(scene.up).or_else(|| Some(views::guess_up(&scene.mesh)));
}

/// The view that is named, or else the first `count`: their numbers, from 1, and cameras. Up is settled by then.
pub(crate) fn choose(
    args: &CameraArgs,
    Loaded { scene, place, .. }: &Loaded,
    tree: &KdTree,
    count: usize,
) -> Result<Vec<(usize, Camera)>, Failure> {
    let up = scene.up.unwrap_or_default();
    if let Some(camera) = args.camera(up, scene.mesh.origin()) {
        return Ok(vec![(1, camera)]);
    }
    let count = args.view.map_or(count, usize::from);
    let cameras = views::of_scene(scene, tree, count);
    let views: Vec<_> = (1..)
        .zip(cameras)
        .filter(|&(number, _)| args.view.is_none_or(|named| number == usize::from(named)))
        .collect();
    if views.is_empty() {
        let what = "found no such view of it; give one with --camera";
        return Err(Failure::work(format_args!("{place}: {what}")));
    }
    Ok(views)
}
