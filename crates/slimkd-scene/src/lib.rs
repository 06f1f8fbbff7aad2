//! Scenes: files, materials, cameras, lights, and procedural scenes of any size.
//!
//! [`load`] reads a scene file. Its [`Scene::mesh`] is what a [`slimkd::KdTree`] is built over, and the attributes of its vertices stay
//! in the scene. A tree's file does not hold them: keep the scene where a tree is saved and read again.
//!
//! ```no_run
//! use slimkd::{BuildOptions, KdTree, Ray, Tracer};
//! let scene = slimkd_scene::load("model.ply")?;
//! let tree = KdTree::build(scene.mesh.clone(), &BuildOptions::default())?; // clones an `Arc`: the mesh is shared
//! let ray = Ray::new([0.0, 0.0, 5.0], [0.0, 0.0, -1.0]);
//! if let Some(hit) = tree.closest(&ray) {
//!     let normal = tree.refine(&ray, hit.triangle).map(|refined| refined.normal); // the triangle's own
//!     let vertices = scene.mesh.triangles()[hit.triangle as usize];
//!     let corners = scene.normals.as_ref().and_then(|normals| normals.corners(hit.triangle, vertices));
//!     let shading = corners.map(|corners| hit.interpolate(corners)); // that of the file, if it has any
//!     println!("{normal:?} {shading:?}");
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod camera;
mod check;
mod light;
mod load;
mod material;
mod merge;
mod origin;
pub mod procedural;
mod save;
mod scene;
mod warning;

pub use camera::{Camera, UpAxis};
pub use check::MeshCheck;
pub use light::Light;
pub use load::{
    Compression, FileKind, Format, LoadError, LoadOptions, Place, load, load_bytes, load_bytes_with,
    load_with,
};
pub use material::{Material, Texture};
pub use origin::{Origin, UnknownOrigin};
pub use save::write_ply;
pub use scene::{Attribute, Scene};
pub use warning::{Warning, WarningKind};
