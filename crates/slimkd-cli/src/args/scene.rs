//! Which scene.

use super::parse::triangles;
use clap::Args;
use std::num::NonZeroU32;
use std::path::PathBuf;

/// A scene.
#[derive(Clone, Debug, Args)]
pub(crate) struct SceneArgs {
    /// A scene file, or a built-in scene's name (`slimkd scene --list`)
    #[arg(value_name = "SCENE")]
    pub(crate) scene: PathBuf,
    /// How many triangles a built-in scene gets
    #[arg(long, value_name = "N", value_parser = triangles)]
    pub(crate) triangles: Option<NonZeroU32>,
}

/// A scene, or a tree made from one.
#[derive(Clone, Debug, Args)]
pub(crate) struct SourceArgs {
    /// A scene file, a built-in scene's name, or a tree saved by `slimkd build -o`
    #[arg(value_name = "SCENE|tree.skd")]
    pub(crate) source: PathBuf,
    /// How many triangles a built-in scene gets
    #[arg(long, value_name = "N", value_parser = triangles)]
    pub(crate) triangles: Option<NonZeroU32>,
}
