//! Trees that `slimkd build -o` saved, in place of a scene.

use crate::args::SceneDetails;
use crate::failure::Failure;
use crate::interrupt::Interruptible;
use crate::scenes::{self, Loaded};
use crate::ui::{Ui, grouped};
use memmap2::Mmap;
use slimkd::FileError;
use slimkd::{KdTree, OpenTree};
use slimkd_scene::{Material, Scene};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// True for the name of a saved tree.
pub(crate) fn is_saved(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("skd"))
}

/// Reads a tree and proves it whole. Its scene has the materials of `--mesh`, or a single one.
pub(crate) fn load(path: &Path, details: &SceneDetails, ui: Ui) -> Result<Loaded, Failure> {
    let file = open(path)?;
    let given = details.mesh.as_deref().map(|mesh| {
        if is_saved(mesh) {
            return Err(Failure::Usage(format!(
                "--mesh {}: this is a tree; give the scene that the tree was built from",
                mesh.display()
            )));
        }
        let alone = SceneDetails { mesh: None, ..details.clone() };
        scenes::load(mesh, &alone, ui)
    });
    let given = given.transpose()?;
    if given.is_none() && details.triangles.is_some() {
        return Err(scenes::fixed_size(path));
    }
    let started = Instant::now();
    let mut file = BufReader::with_capacity(1 << 20, Interruptible(file));
    let tree = match &given {
        Some(given) => KdTree::read_with_mesh(&mut file, Arc::clone(&given.scene.mesh)),
        None => KdTree::read(&mut file),
    }
    .map_err(|error| unread(path, &error, "give it with --mesh FILE"))?;
    let (mut scene, before) = match given {
        Some(given) => (given.scene, given.seconds),
        None => {
            let (mesh, materials) = (Arc::clone(tree.mesh()), vec![Material::default()]);
            (Scene { mesh, materials, ..Scene::default() }, 0.0)
        }
    };
    scene.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let place = path.display().to_string();
    Ok(Loaded { scene, place, seconds: before + started.elapsed().as_secs_f64(), tree: Some(tree) })
}

/// Maps a tree into memory and proves nothing of it but its table: ready at once.
pub(crate) fn map(path: &Path) -> Result<OpenTree<Mmap>, Failure> {
    let file = open(path)?;
    // SAFETY: the bytes may change while another process writes to the file, which `slimkd` itself never does to a file in
    // place. `OpenTree` believes none of them, copies what it decides by, and checks every access.
    let bytes = unsafe { Mmap::map(&file) }
        .map_err(|error| Failure::at(path, format_args!("cannot map: {error}; leave out --no-verify")))?;
    OpenTree::open(bytes)
        .map_err(|error| unread(path, &error, "leave out --no-verify and give it with --mesh FILE"))
}

/// The error for a tree that cannot be used; `with_mesh` says how the command line gets at a mesh that is not inside.
fn unread(path: &Path, error: &FileError, with_mesh: &str) -> Failure {
    match error {
        FileError::MeshMissing { vertices, triangles } => {
            let (vertices, triangles) = (grouped(*vertices), grouped(*triangles));
            let what =
                format_args!("saved without its mesh of {vertices} vertices and {triangles} triangles");
            Failure::at(path, format_args!("{what}; {with_mesh}"))
        }
        other => Failure::at(path, other),
    }
}

/// Opens a regular file: a pipe could block for ever.
fn open(path: &Path) -> Result<File, Failure> {
    let unreadable = |error| Failure::at(path, format_args!("cannot read: {error}; check the path"));
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(Failure::at(path, "not a regular file; give a tree saved by `slimkd build -o`"));
    }
    File::open(path).map_err(unreadable)
}
