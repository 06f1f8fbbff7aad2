//! The whole picture: checks, lights, tiles on threads.

use crate::camera::{CameraError, PinholeFrame};
use crate::film::{Film, FilmError};
use crate::lights::default_lights;
use crate::progress::RenderProgress;
use crate::settings::RenderSettings;
use crate::shade::Shader;
use crate::tile::{TILE, Tile, trace_tile};
use glam::Vec3;
use rayon::prelude::*;
use slimkd::KdTree;
use slimkd_scene::{Camera, Light, Material, Scene};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use thiserror::Error;

/// Ambient occlusion looks this far, as a share of the scene's diagonal.
const OCCLUSION_REACH: f32 = 0.05;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// [`RenderProgress::cancel`] was called.
    #[error("the render was cancelled")]
    Cancelled,
    /// The camera cannot take a picture.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The picture's size is impossible.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A setting is out of its range.
    #[error("{what} is {value}; it must be {range}")]
    Setting {
        /// Its name.
        what: &'static str,
        /// What it was.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// A light is not finite or has no direction: check its numbers.
    #[error("light {0} has no direction or a number that is not finite; check it")]
    Light(usize),
    /// The tree was built over another mesh: build it from `scene.mesh`.
    #[error("the tree holds {tree} triangles, the scene {scene}; build the tree from this scene's mesh")]
    WrongTree {
        /// Triangles of the tree's mesh.
        tree: usize,
        /// Triangles of the scene's mesh.
        scene: usize,
    },
    /// The scene points past one of its own lists: mend whatever made it.
    #[error("the scene's {what} point past the end of a list; mend the scene's loader")]
    Scene {
        /// Which part.
        what: &'static str,
    },
    /// The system gave no threads: ask for fewer.
    #[error("cannot start the threads to render with: {0}; ask for fewer")]
    Threads(String),
}

/// Renders a picture. Without lights, [`default_lights`] chooses some. Up is the scene's, or else the camera's.
pub fn render(
    scene: &Scene,
    tree: &KdTree,
    camera: &Camera,
    lights: &[Light],
    settings: &RenderSettings,
    progress: &RenderProgress,
) -> Result<Film, RenderError> {
    check_settings(settings)?;
    check_scene(scene, tree)?;
    check_lights(lights)?;
    let mut film = Film::new(settings.width, settings.height)?;
    let aspect = f64::from(settings.width) / f64::from(settings.height);
    let frame = PinholeFrame::new(camera, aspect)?;

    let up = scene.up.map_or_else(|| camera.up.as_dvec3().normalize().as_vec3(), |axis| axis.vector());
    let chosen;
    let lights = if lights.is_empty() {
        chosen = default_lights(tree, camera, up);
        &chosen
    } else {
        lights
    };
    let shader = Shader {
        scene,
        tree,
        lights,
        settings,
        up,
        transparent: scene.materials.iter().any(|material| material.transmission > 0.0),
        fallback: Material::default(),
        occlusion_reach: OCCLUSION_REACH * diagonal(tree).max(f32::MIN_POSITIVE),
    };
    match settings.threads {
        None => tiles(&mut film, &frame, &shader, progress)?,
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build()
            .map_err(|error| RenderError::Threads(error.to_string()))?
            .install(|| tiles(&mut film, &frame, &shader, progress))?,
    }
    progress.set(1.0);
    Ok(film)
}

/// Renders all tiles into `film`.
fn tiles(
    film: &mut Film,
    frame: &PinholeFrame,
    shader: &Shader<'_>,
    progress: &RenderProgress,
) -> Result<(), RenderError> {
    let (width, height) = (film.width(), film.height());
    let count = Tile::count(width, height);
    let done = AtomicUsize::new(0);
    // Held for one small copy a tile only.
    let film = Mutex::new(film);
    (0..count).into_par_iter().with_max_len(1).try_for_each(|index| {
        let tile = Tile::of_picture(index, width, height);
        let colours = trace_tile(tile, frame, shader, progress).ok_or(RenderError::Cancelled)?;
        let mut film = film.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        for (row, colours) in colours.chunks_exact(tile.width as usize).enumerate() {
            let start = (tile.y as usize + row) * width as usize + tile.x as usize;
            let to = &mut film.pixels_mut()[start..start + colours.len()];
            to.iter_mut().zip(colours).for_each(|(pixel, colour)| *pixel = colour.to_array());
        }
        drop(film);
        progress.set((done.fetch_add(1, Relaxed) + 1) as f64 / count as f64);
        Ok(())
    })
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
