//! What a picture follows from, checked before any ray.

use crate::camera::PinholeFrame;
use crate::lights::default_lights;
use crate::render::RenderError;
use crate::settings::RenderSettings;
use crate::tile::TILE;
use glam::Vec3;
use rayon::prelude::*;
use slimkd::{KdTree, Tracer};
use slimkd_scene::{Camera, Light, Scene};
use std::borrow::Cow;

/// Ambient occlusion looks this far, as a share of the scene's diagonal.
const OCCLUSION_REACH: f32 = 0.05;

/// A picture before its first ray: all that [`crate::render`] works out from scene, camera and settings, for whoever renders
/// it elsewhere.
#[derive(Clone, Debug)]
pub struct Setup<'a> {
    /// Its primary rays.
    pub frame: PinholeFrame,
    /// Up, a unit vector.
    pub up: Vec3,
    /// What lights it: the lights that were named, or those that [`default_lights`] chooses.
    pub lights: Cow<'a, [Light]>,
    /// Whether any material lets shadow rays pass.
    pub transparent: bool,
    /// How far ambient occlusion reaches, scene units.
    pub occlusion_reach: f32,
}

impl<'a> Setup<'a> {
    /// Checks everything that shading will index, so that it cannot panic on a broken scene.
    ///
    /// # Errors
    /// As [`crate::render`], cancelling and threads aside.
    pub fn new(
        scene: &Scene,
        tree: &KdTree,
        camera: &Camera,
        lights: &'a [Light],
        settings: &RenderSettings,
    ) -> Result<Self, RenderError> {
        check_settings(settings)?;
        check_scene(scene, tree)?;
        check_lights(lights)?;
        let frame = PinholeFrame::new(camera, f64::from(settings.width) / f64::from(settings.height))?;
        let up = scene.up.map_or_else(|| camera.up.as_dvec3().normalize().as_vec3(), |axis| axis.vector());
        let lights = match lights {
            [] => Cow::Owned(default_lights(tree, camera, up)),
            lights => Cow::Borrowed(lights),
        };
        Ok(Self {
            frame,
            up,
            lights,
            transparent: scene.materials.iter().any(|material| material.transmission > 0.0),
            occlusion_reach: OCCLUSION_REACH * diagonal(tree).max(f32::MIN_POSITIVE),
        })
    }
}

/// Length of the scene's diagonal; 0 when nothing can be hit.
fn diagonal(tree: &KdTree) -> f32 {
    let [x, y, z] = tree.bounds().extent();
    glam::DVec3::new(x, y, z).length() as f32
}

fn check_settings(settings: &RenderSettings) -> Result<(), RenderError> {
    let check = |what, value: f64, ok: bool, range| {
        if ok { Ok(()) } else { Err(RenderError::Setting { what, value, range }) }
    };
    let samples = settings.samples;
    check("samples per pixel", samples.into(), (1..=1 << 16).contains(&samples), "1 to 65536")?;
    let depth = settings.max_depth;
    check("the recursion limit", depth.into(), depth <= 64, "0 to 64")?;
    let cut = settings.min_contribution;
    check("the contribution cut-off", cut.into(), (0.0..=1.0).contains(&cut), "0 to 1")?;
    let occlusion = settings.occlusion;
    check("occlusion rays", occlusion.into(), occlusion <= 4096, "0 to 4096")?;
    for side in [settings.width, settings.height] {
        check("a side of the picture", side.into(), side <= u32::MAX - TILE, "smaller")?;
    }
    Ok(())
}

fn check_lights(lights: &[Light]) -> Result<(), RenderError> {
    let valid = |light: &Light| match *light {
        Light::Point { position, intensity } => position.is_finite() && intensity.is_finite(),
        Light::Directional { direction, irradiance } => {
            direction.is_finite() && direction != Vec3::ZERO && irradiance.is_finite()
        }
    };
    lights.iter().position(|light| !valid(light)).map_or(Ok(()), |index| Err(RenderError::Light(index)))
}

/// Everything that shading would index must be there: it must not panic on a broken scene.
fn check_scene(scene: &Scene, tree: &KdTree) -> Result<(), RenderError> {
    let triangles = scene.mesh.len();
    if tree.mesh().len() != triangles {
        return Err(RenderError::WrongTree { tree: tree.mesh().len(), scene: triangles });
    }
    let broken = |what| Err(RenderError::Scene { what });
    let materials = scene.materials.len();
    if materials > 0 && scene.material_ids.par_iter().any(|&id| id as usize >= materials) {
        return broken("material ids");
    }
    let short = |indices: Option<&Vec<[u32; 3]>>| indices.is_some_and(|list| list.len() < triangles);
    if short(scene.normals.as_ref().and_then(|n| n.indices.as_ref())) {
        return broken("normal indices");
    }
    if short(scene.uvs.as_ref().and_then(|uv| uv.indices.as_ref())) {
        return broken("texture coordinate indices");
    }
    let textures = scene.textures.len();
    if scene.materials.iter().filter_map(|m| m.texture).any(|texture| texture as usize >= textures) {
        return broken("materials' textures");
    }
    let sized = |t: &slimkd_scene::Texture| t.texels.len() as u64 == u64::from(t.width) * u64::from(t.height);
    if !scene.textures.iter().all(sized) {
        return broken("texture sizes");
    }
    Ok(())
}
