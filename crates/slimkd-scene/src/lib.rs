//! Scenes: files, materials, cameras, lights, and procedural scenes of any size.

mod camera;
mod check;
mod light;
mod load;
mod material;
mod merge;
pub mod procedural;
mod save;
mod scene;
mod warning;

pub use camera::{Camera, UpAxis};
pub use check::MeshCheck;
pub use light::Light;
pub use load::{
    Compression, FileKind, Format, LoadError, LoadOptions, LoadProgress, Place, load, load_bytes,
    load_bytes_with, load_with,
};
pub use material::{Material, Texture};
pub use save::write_ply;
pub use scene::{Attribute, Scene};
pub use warning::{Warning, WarningKind};
