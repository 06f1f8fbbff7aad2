//! The view of a scene: what the command line says, else the file's cameras, else views found by looking around.

use crate::args::CameraArgs;
use crate::failure::Failure;
use crate::scenes::Loaded;
use slimkd::KdTree;
use slimkd_render::views;
use slimkd_scene::{Camera, Scene};

/// How many views a scene has.
pub(crate) const VIEWS: usize = 3;

/// One of a scene's views.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    /// From 1.
    pub(crate) number: usize,
    /// Where it is seen from.
    pub(crate) camera: Camera,
}

/// Settles which way is up: as the command line says, else as the file says, else by a guess.
pub(crate) fn settle_up(args: &CameraArgs, scene: &mut Scene) {
    scene.up = args.up().or(scene.up).or_else(|| Some(views::guess_up(&scene.mesh)));
}

/// The view that is named, or else the first `count`. Up is settled by then.
pub(crate) fn choose(
    args: &CameraArgs,
    Loaded { scene, place, .. }: &Loaded,
    tree: &KdTree,
    count: usize,
) -> Result<Vec<View>, Failure> {
    let up = scene.up.unwrap_or_default();
    if let Some(camera) = args.camera(up, scene.mesh.origin()) {
        return Ok(vec![View { number: 1, camera }]);
    }
    let count = args.view.map_or(count, usize::from);
    let cameras = views::of_scene(scene, tree, count);
    let views = cameras.into_iter().enumerate().map(|(index, camera)| View { number: index + 1, camera });
    let views: Vec<_> =
        views.filter(|view| args.view.is_none_or(|named| view.number == usize::from(named))).collect();
    if views.is_empty() {
        let what = "found no such view of it; give one with --camera";
        return Err(Failure::work(format_args!("{place}: {what}")));
    }
    Ok(views)
}
