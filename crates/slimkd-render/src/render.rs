//! The whole picture: tiles on threads.

use crate::camera::{CameraError, PinholeFrame};
use crate::film::{Film, FilmError};
use crate::settings::RenderSettings;
use crate::setup::Setup;
use crate::shade::Shader;
use crate::tile::{Tile, trace_tile};
use rayon::prelude::*;
use slimkd::{KdTree, Progress};
use slimkd_scene::{Camera, Light, Material, Scene};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use thiserror::Error;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// [`Progress::cancel`] was called.
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

/// Renders a picture. Without lights, [`default_lights`](crate::default_lights) chooses some. Up is the scene's, or else the
/// camera's. `progress` tells the share of the tiles that are done, and can end the render.
pub fn render(
    scene: &Scene,
    tree: &KdTree,
    camera: &Camera,
    lights: &[Light],
    settings: &RenderSettings,
    progress: &Progress,
) -> Result<Film, RenderError> {
    let setup = Setup::new(scene, tree, camera, lights, settings)?;
    let mut film = Film::new(settings.width, settings.height)?;
    let shader = Shader {
        scene,
        tree,
        lights: &setup.lights,
        settings,
        up: setup.up,
        transparent: setup.transparent,
        fallback: Material::default(),
        occlusion_reach: setup.occlusion_reach,
    };
    match settings.threads {
        None => tiles(&mut film, &setup.frame, &shader, progress)?,
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.get())
            .build()
            .map_err(|error| RenderError::Threads(error.to_string()))?
            .install(|| tiles(&mut film, &setup.frame, &shader, progress))?,
    }
    progress.set(1.0);
    Ok(film)
}

/// Renders all tiles into `film`.
fn tiles(
    film: &mut Film,
    frame: &PinholeFrame,
    shader: &Shader<'_>,
    progress: &Progress,
) -> Result<(), RenderError> {
    let (width, height) = (film.width(), film.height());
    let count = Tile::count(width, height);
    let done = AtomicUsize::new(0);
    // Held for one small copy a tile only.
    let film = Mutex::new(film);
    (0..count).into_par_iter().with_max_len(1).try_for_each(|index| {
        let tile = Tile::of_picture(index, width, height);
        let (colours, rays) = trace_tile(tile, frame, shader, progress).ok_or(RenderError::Cancelled)?;
        let mut film = film.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        film.add_rays(rays);
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
