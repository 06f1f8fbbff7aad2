//! A Whitted-style renderer on top of slimkd: a scene, its tree and a camera in, a [`Film`] out.
//!
//! ```
//! use slimkd::{BuildOptions, KdTree, Progress, TriangleMesh};
//! use slimkd_render::{RenderSettings, render};
//! use slimkd_scene::{Camera, Scene};
//!
//! let mesh = TriangleMesh::new(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
//! let scene = Scene { mesh: mesh.into(), ..Scene::default() };
//! let tree = KdTree::build(scene.mesh.clone(), &BuildOptions::default())?;
//! let camera = Camera { eye: [0.0, 0.5, 3.0].into(), target: [0.0; 3].into(), up: [0.0, 1.0, 0.0].into(), fov: 45.0 };
//!
//! // No lights named: a set that suits the camera is chosen.
//! let film = render(&scene, &tree, &camera, &[], &RenderSettings::sized(64, 48), &Progress::new())?;
//! assert_eq!((film.width(), film.height()), (64, 48));
//! assert_eq!(film.rays().primary, 64 * 48 * 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod film;
mod fresnel;
mod lighting;
mod lights;
mod offset;
mod render;
mod sampling;
mod settings;
mod setup;
mod shade;
mod statistics;
mod surface;
mod tile;
mod tone;
pub mod views;
mod waves;

pub use camera::{CameraError, PinholeFrame};
pub use film::{BitDepth, Film, FilmError};
pub use fresnel::{dielectric_reflectance, refract};
pub use lights::default_lights;
pub use render::{RenderError, render};
pub use settings::{RenderSettings, Sky};
pub use setup::Setup;
pub use statistics::RenderStatistics;
pub use tone::{Development, ToneMap};
