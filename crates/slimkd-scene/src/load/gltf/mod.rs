//! glTF 2.0, as JSON or GLB: a scene, flattened in depth-first order of its nodes.
//!
//! Followed is the specification, <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>, and the extensions that
//! `extensions.rs` lists. Deviations:
//! 1. Files that break a rule without leaving a doubt are read: zeros as padding of the JSON, chunks that are not padded,
//!    whole numbers as `3.0`, names that were not percent-encoded, base64 without padding or with line ends.
//! 2. The largest index restarts a strip or fan even where `KHR_mesh_primitive_restart` is not named.
//! 3. Animations are left out: nodes, joints and morph targets stand as the file sets them.

mod accessor;
mod container;
mod draco;
mod extensions;
mod flat;
mod json;
mod materials;
mod meshopt;
mod nodes;
mod reader;
mod skin;
mod views;

use super::{
    Format, LoadError, Place, Progress,
    error::{quoted, short},
    source::{FREE_BYTES, Folder, MAX_GROWTH},
    textures::Textures,
    warn,
};
use crate::origin::Frame;
use crate::{Scene, UpAxis, Warning, WarningKind};
use container::Buffers;
use extensions::Known;
use flat::Flat;
use json::Root;
use reader::Reader;

/// Memory that a JSON object may become, bytes: the largest, a material, has less.
const OBJECT: u64 = 640;

/// Reads scene `chosen`, or the one that the file names as its default.
pub(super) fn parse(
    format: Format,
    bytes: &[u8],
    folder: Folder<'_>,
    chosen: Option<usize>,
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let (json, bin) = container::split(format, bytes)?;
    let root = root(format, bytes, json)?;
    let buffers = Buffers::load(&root, bin, folder);
    let reader = Reader::new(format, &root, buffers, bytes.len());
    let placements = reader.placements(chosen, progress)?;
    let mut scene = Scene { up: Some(UpAxis::Y), ..Default::default() };
    notice(&root, chosen, &mut scene.warnings);
    if placements.hidden > 0 {
        let (hidden, all) = (placements.hidden, placements.hidden + placements.list.len());
        let what = "nodes are hidden by KHR_node_visibility and were left out";
        let warning = Warning::counted(WarningKind::Ignored, hidden as u64, all as u64, what);
        warn(&mut scene.warnings, warning);
    }
    let mut textures = Textures::new(folder);
    scene.materials = reader.materials(&mut textures, &mut scene.warnings);
    scene.textures = textures.list;
    for placed in &placements.list {
        reader.view_of_node(&root.nodes[placed.node], &placed.world, frame, &mut scene);
    }
    let mut flat = Flat::new(&reader, frame);
    // Weighed first, so that what is too much is refused before any of it takes memory.
    flat.weigh(&placements.list)?;
    let poses = reader.poses(&placements.list)?;
    let skin = |node: usize| root.nodes[node].mesh.and(root.nodes[node].skin);
    let skins: Vec<usize> = placements.list.iter().filter_map(|placed| Some(skin(placed.node)?.0)).collect();
    let unposed = skins.iter().filter(|&&skin| poses[skin].is_none()).count();
    if unposed > 0 {
        let what = "skinned meshes stand as they were modelled: their joints are not in the scene";
        let warning = Warning::counted(WarningKind::Missing, unposed as u64, skins.len() as u64, what);
        warn(&mut scene.warnings, warning);
    }
    flat.draw(&placements.list, &poses, progress)?;
    flat.finish(scene)
}

/// The JSON, with what it requires checked.
fn root(format: Format, bytes: &[u8], json: &[u8]) -> Result<Root, LoadError> {
    // Each object becomes a struct with all its optional members: "{}," must not become a gigabyte.
    let objects = json.iter().filter(|&&byte| byte == b'{').count() as u64;
    let limit = FREE_BYTES * 4 + MAX_GROWTH / 4 * bytes.len() as u64;
    if objects * OBJECT > limit {
        let (what, input) = ("the list of objects", bytes.len() as u64);
        return Err(LoadError::OutOfProportion { what, limit, input, fix: "join its meshes and nodes" });
    }
    let root: Root = serde_json::from_slice(json).map_err(|error| LoadError::Invalid {
        format,
        place: Place::Line(error.line() as u64),
        what: short(&error),
        fix: "the file was cut off or is no glTF 2.0",
    })?;
    if !root.asset.version.starts_with("2") {
        let what = format!("glTF version {}", quoted(root.asset.version.as_bytes()));
        let fix = "convert it to version 2";
        return Err(LoadError::Unsupported { format, place: Place::Whole, what, fix });
    }
    for (k, name) in root.extensions_required.iter().enumerate() {
        if extensions::known(name) == Known::Unknown {
            let what = format!("the required extension {}", quoted(name.as_bytes()));
            let place = Place::Entry("extensionsRequired", k);
            let fix = "export the file without it";
            return Err(LoadError::Unsupported { format, place, what, fix });
        }
    }
    Ok(root)
}

/// Warns of what a file has and this reader leaves out as a whole.
fn notice(root: &Root, chosen: Option<usize>, warnings: &mut Vec<Warning>) {
    let mut ignored = |what: String| warn(warnings, Warning::new(WarningKind::Ignored, what));
    let mut names: Vec<&String> = root.extensions_used.iter().chain(&root.extensions_required).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let (known, name) = (extensions::known(name), quoted(name.as_bytes()));
        match known {
            Known::Followed => {}
            Known::Harmless => ignored(format!("extension {name} was left out; it moves no triangle")),
            Known::Unknown => ignored(format!("extension {name} is not known; what it adds was left out")),
        }
    }
    if let Some(centre) = &root.extensions.centre {
        let [x, y, z] = centre.center;
        ignored(format!("CESIUM_RTC was left out: the model belongs at ({x}, {y}, {z})"));
    }
    if !root.animations.is_empty() {
        let count = root.animations.len();
        ignored(format!("{count} animations were left out; the model stands as its nodes say"));
    }
    let scenes = root.scenes.len();
    if scenes > 1 && chosen.is_none() {
        let shown = root.scene.map_or(0, |scene| scene.0);
        let what = format!("scenes were left out; this is scene {shown}, --scene-index chooses");
        let warning = Warning::counted(WarningKind::Ignored, scenes as u64 - 1, scenes as u64, what);
        warn(warnings, warning);
    }
}
