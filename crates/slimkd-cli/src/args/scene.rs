//! Which scene.

use super::parse::triangles;
use clap::Args;
use slimkd_scene::Origin;
use std::num::NonZeroU32;
use std::path::PathBuf;

/// A scene, or a tree made from one.
#[derive(Clone, Debug, Args)]
pub(crate) struct SceneArgs {
    /// A scene file, a built-in scene's name (`slimkd scene --list`), or a tree saved by `slimkd build -o`
    #[arg(value_name = "SCENE|tree.skd")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) details: SceneDetails,
}

/// More models of one scene.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct MoreScenes {
    /// More scene files: all become one scene, with triangle ids in this order
    #[arg(value_name = "SCENE")]
    pub(crate) more: Vec<PathBuf>,
}

/// What belongs to a scene beside its name.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct SceneDetails {
    /// How many triangles a built-in scene gets, 1 to 100000000; of several, each
    #[arg(long, value_name = "N", value_parser = triangles)]
    pub(crate) triangles: Option<NonZeroU32>,
    /// The scene that a tree.skd was built from: needed where it was saved with --no-mesh, and brings its materials
    #[arg(long, value_name = "SCENE")]
    pub(crate) mesh: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) files: FileDetails,
}

/// How scene files are read.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct FileDetails {
    /// Read what a scene names (materials, textures, buffers, shapes) outside its file's folder as well
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Which scene of a glTF file with several, from 0; without it the one that the file names as its default
    #[arg(long, value_name = "N")]
    pub(crate) scene_index: Option<usize>,
    /// Which point of the file's coordinates becomes 0 in the tree: auto is one near a scene that is far from 0 compared with its size
    /// (georeferenced ones), none keeps f32 steps of centimetres there. Rays, cameras and hits stay where the file is
    #[arg(long, value_name = "auto|none|x,y,z", allow_hyphen_values = true)]
    pub(crate) origin: Option<Origin>,
}
