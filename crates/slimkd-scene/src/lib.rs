//! Scenes: files, materials, cameras, lights, and procedural scenes of any size.

mod camera;
mod light;
mod load;
mod material;
pub mod procedural;
mod scene;
mod warning;

pub use camera::{Camera, UpAxis};
pub use light::Light;
pub use load::{
    Compression, FileKind, Format, LoadError, LoadOptions, LoadProgress, Place, load, load_bytes,
    load_bytes_with, load_with,
};
pub use material::{Material, Texture};
pub use scene::{Attribute, Scene};
pub use warning::{Warning, WarningKind};
