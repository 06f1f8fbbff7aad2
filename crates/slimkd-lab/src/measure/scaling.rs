//! How build time grows.

use super::session::Session;
use super::trees::time_builds;
use crate::basics::ReportError;
use crate::schema::ScalingPoint;
use slimkd::Preset;

/// The procedural scene that is built.
pub(super) const SCENE: &str = "building";

pub(super) fn measure(session: &Session<'_>, triangles: u32) -> Result<Vec<ScalingPoint>, ReportError> {
    let Some(scene) = slimkd_scene::procedural::generate(SCENE, triangles as usize) else {
        return Ok(Vec::new());
    };
    [Preset::Standard, Preset::Slim]
        .into_iter()
        .map(|preset| {
            Ok(ScalingPoint {
                scene: SCENE.to_owned(),
                triangles: scene.mesh.len() as u64,
                tree: preset.name().to_owned(),
                builds: time_builds(session, SCENE, &scene.mesh, preset, session.options.builds)?,
            })
        })
        .collect()
}
