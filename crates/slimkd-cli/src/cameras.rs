//! The view of a scene: what the command line says, else the file's cameras, else views found by looking around.

use crate::args::CameraArgs;
use crate::failure::Failure;
use slimkd::KdTree;
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

/// The views that are asked for: the one that is named, or all of them. `--up` is in `scene.up` by then.
pub(crate) fn choose(args: &CameraArgs, scene: &Scene, tree: &KdTree) -> Result<Vec<View>, Failure> {
    let up = scene.up.unwrap_or_default();
    let mut cameras: Vec<_> = match args.camera(up) {
        Some(camera) => vec![camera],
        None => scene.cameras.iter().copied().take(VIEWS).collect(),
    };
    let wanted = args.view.map_or(1, usize::from);
    if cameras.len() < wanted || (cameras.len() < VIEWS && !args.is_one()) {
        cameras.extend(find_views(tree, up));
        cameras.truncate(VIEWS);
    }
    let views = cameras.into_iter().enumerate().map(|(index, camera)| View { number: index + 1, camera });
    let views: Vec<_> =
        views.filter(|view| args.view.is_none_or(|named| view.number == usize::from(named))).collect();
    if views.is_empty() {
        let what = "found no such view of it; give one with --camera";
        return Err(Failure::work(format_args!("{}: {what}", scene.name)));
    }
    Ok(views)
}

fn find_views(tree: &KdTree, up: slimkd_scene::UpAxis) -> Vec<Camera> {
    let bounds = tree.bounds();
    let target = glam::Vec3::from(bounds.center());
    let half = (glam::Vec3::from(bounds.max) - target).length();
    let up = up.vector();
    let eye = target + (glam::Vec3::new(1.0, 1.0, 1.0) + up * -0.4) * (1.6 * half);
    vec![Camera { eye, target, up, fov: 45.0 }]
}
