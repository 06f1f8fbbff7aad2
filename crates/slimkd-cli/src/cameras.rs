//! The view of a scene: what the command line says, else the file's cameras, else views found by looking around.

use crate::args::CameraArgs;
use crate::failure::Failure;
use slimkd::KdTree;
use slimkd_scene::{Camera, Scene};

/// How many views a scene has.
pub(crate) const VIEWS: usize = 3;

/// The views that are asked for: the one that is named, or all three. `--up` is in `scene.up` by then.
pub(crate) fn choose(args: &CameraArgs, scene: &Scene, tree: &KdTree) -> Result<Vec<Camera>, Failure> {
    let up = scene.up.unwrap_or_default();
    if let Some(camera) = args.camera(up) {
        return Ok(vec![camera]);
    }
    let mut cameras: Vec<_> = scene.cameras.iter().copied().take(VIEWS).collect();
    if cameras.len() < args.view.map_or(VIEWS, usize::from) {
        cameras.extend(find_views(tree, up));
        cameras.truncate(VIEWS);
    }
    match args.view {
        None => Ok(cameras),
        Some(view) => match cameras.get(usize::from(view) - 1) {
            Some(&camera) => Ok(vec![camera]),
            None => Err(Failure::work(format_args!(
                "{}: there are only {} views; give one with --camera",
                scene.name,
                cameras.len()
            ))),
        },
    }
}

fn find_views(tree: &KdTree, up: slimkd_scene::UpAxis) -> Vec<Camera> {
    let bounds = tree.bounds();
    let target = glam::Vec3::from(bounds.center());
    let half = (glam::Vec3::from(bounds.max) - target).length();
    let up = up.vector();
    let eye = target + (glam::Vec3::new(1.0, 1.0, 1.0) + up * -0.4) * (1.6 * half);
    vec![Camera { eye, target, up, fov: 45.0 }]
}
