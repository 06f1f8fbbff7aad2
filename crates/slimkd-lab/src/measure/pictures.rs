//! Pictures of a view: rendered, and with the triangles coloured by how often a tree repeats them.

use super::heat::pixels;
use super::session::Session;
use super::store;
use super::trees::Trees;
use crate::basics::ReportError;
use crate::basics::palette::duplication_colour;
use crate::schema::{Picture, View};
use glam::Vec3;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use rayon::prelude::*;
use slimkd::{Preset, Tracer};
use slimkd_render::{Development, RenderError, RenderSettings, render};
use slimkd_util::png;
use std::path::Path;

/// Of a rendered picture: smooth walls show no blocks.
const JPEG_QUALITY: u8 = 88;

/// The trees whose duplication is shown.
const SHOWN: [Preset; 3] = [Preset::Standard, Preset::PaperSmall, Preset::Slim];

pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    view: &View,
) -> Result<Vec<Picture>, ReportError> {
    let edge = session.options.picture_edge;
    trees.ensure(Preset::Standard)?;
    let scene = trees.scene;
    let settings = RenderSettings::sized(edge, edge);
    let progress = session.progress.piece();
    let tree = trees.get(Preset::Standard);
    let film =
        render(scene, tree, &view.camera(), &scene.lights, &settings, &progress).map_err(
            |error| match error {
                RenderError::Cancelled => ReportError::Cancelled,
                error => {
                    ReportError::Render { scene: scene.name.clone(), view: view.number, error: error.into() }
                }
            },
        )?;
    let name = format!("pictures/{}-view-{}.jpg", slug(&scene.name), view.number);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, JPEG_QUALITY);
    encoder.set_sampling_factor(SamplingFactor::F_1_1);
    let rgb = film.to_srgb8(&Development::default());
    u16::try_from(edge)
        .map_err(|error| error.to_string())
        .and_then(|edge| encoder.encode(&rgb, edge, edge, ColorType::Rgb).map_err(|error| error.to_string()))
        .map_err(ReportError::Picture)?;
    store::write(&session.store.folder().join(&name), &bytes)?;
    let mut out = vec![Picture { view: view.number, kind: "render".to_owned(), tree: None, picture: name }];
    trees.ensure_all(&SHOWN)?;
    let rays = pixels(trees, view, edge)?;
    for preset in SHOWN {
        session.check()?;
        let tree = trees.get(preset);
        let references = tree.references_per_triangle();
        let colour = |ray: &slimkd::Ray| {
            let Some(hit) = tree.closest(ray) else { return [0xf4, 0xf4, 0xf2] };
            let [a, b, c] = tree.mesh().corners(hit.triangle).map(Vec3::from);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let facing = normal.dot(Vec3::from(ray.direction).normalize_or_zero()).abs();
            duplication_colour(references[hit.triangle as usize], 0.45 + 0.55 * facing)
        };
        let colours: Vec<[u8; 3]> = rays.par_iter().map(colour).collect();
        let name =
            format!("pictures/{}-duplication-{}-{}.png", slug(&scene.name), view.number, preset.name());
        save_png(session.store.folder(), &name, edge, colours.into_iter().flatten().collect())?;
        out.push(Picture {
            view: view.number,
            kind: "duplication".to_owned(),
            tree: Some(preset.name().to_owned()),
            picture: name,
        });
    }
    Ok(out)
}

pub(super) fn save_png(folder: &Path, name: &str, edge: u32, rgb: Vec<u8>) -> Result<(), ReportError> {
    let mut bytes = Vec::new();
    png::write(&mut bytes, [edge, edge], &rgb).map_err(|error| ReportError::Picture(error.to_string()))?;
    store::write(&folder.join(name), &bytes)
}

/// A name that any file system takes.
pub(crate) fn slug(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
}
