//! What rays cost: nodes visited and triangles tested, counted, so that no clock is needed.

use super::pictures::{save_png, slug};
use super::session::Session;
use super::trees::Trees;
use crate::basics::ReportError;
use crate::basics::palette::heat_colour;
use crate::schema::{Heat, HeatPreset, View};
use glam::{UVec2, Vec3};
use rayon::prelude::*;
use slimkd::{KdTree, Preset, Ray, RayCost, Tracer};
use slimkd_render::{PinholeFrame, RenderError};

/// The scale ends where this share of all pixels, of all presets, lies below: a few extreme pixels would darken the rest.
const SCALE_SHARE: f64 = 0.995;

/// A view's heat maps; without a view, the cost of random rays.
pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    presets: &[Preset],
    view: Option<&View>,
) -> Result<Heat, ReportError> {
    trees.ensure_all(presets)?;
    let edge = session.options.heat_edge;
    let rays = match view {
        None => random(trees.get(presets[0]), session.options.seed, session.options.random_rays),
        Some(view) => pixels(trees, view, edge)?,
    };
    let mut costs = Vec::new();
    for &preset in presets {
        session.check()?;
        let tree = trees.get(preset);
        costs.push(rays.par_iter().map(|ray| tree.cost(ray).1).collect::<Vec<_>>());
    }
    let sum = |cost: &RayCost| cost.nodes + cost.tests;
    let mut all: Vec<u32> = costs.iter().flatten().map(sum).collect();
    let at = (all.len().saturating_sub(1) as f64 * SCALE_SHARE) as usize;
    let scale_end = if all.is_empty() { 1 } else { (*all.select_nth_unstable(at).1).max(1) };
    let mut out = Vec::new();
    for (preset, costs) in presets.iter().zip(&costs) {
        let picture = match view {
            None => None,
            Some(view) => {
                let colours =
                    costs.iter().map(|cost| heat_colour(f64::from(sum(cost)) / f64::from(scale_end)));
                let name = format!(
                    "pictures/{}-heat-{}-{}.png",
                    slug(&trees.scene.name),
                    view.number,
                    preset.name()
                );
                save_png(session.store.folder(), &name, edge, colours.flatten().collect())?;
                Some(name)
            }
        };
        out.push(HeatPreset {
            name: preset.name().to_owned(),
            rays: costs.len() as u64,
            nodes: costs.iter().map(|cost| u64::from(cost.nodes)).sum(),
            tests: costs.iter().map(|cost| u64::from(cost.tests)).sum(),
            picture,
        });
    }
    Ok(Heat { view: view.map_or(0, |view| view.number), scale_end, presets: out })
}

/// A ray through the middle of every pixel, rows from the top.
pub(super) fn pixels(trees: &Trees<'_>, view: &View, edge: u32) -> Result<Vec<Ray>, ReportError> {
    let frame = PinholeFrame::new(&view.camera(), 1.0).map_err(|error| ReportError::Render {
        scene: trees.scene.name.clone(),
        view: view.number,
        error: RenderError::Camera(error).into(),
    })?;
    let places = (0..edge * edge).map(|pixel| UVec2::new(pixel % edge, pixel / edge).as_vec2());
    Ok(places.map(|place| frame.ray((place + 0.5) / edge as f32)).collect())
}

/// Lines between random points of the scene's bounds.
fn random(tree: &KdTree, seed: u64, count: usize) -> Vec<Ray> {
    let mut random = fastrand::Rng::with_seed(seed);
    let (min, extent) = (Vec3::from(tree.bounds().min), tree.bounds().extent());
    let mut point = || {
        let inside = extent.map(|extent| (extent * random.f64()) as f32);
        min + Vec3::from(inside)
    };
    (0..count).map(|_| (point(), point())).map(|(from, to)| Ray::new(from, to - from)).collect()
}
