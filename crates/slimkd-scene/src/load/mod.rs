//! Scene files: PLY, OBJ with MTL, STL, OFF, glTF, GLB, Mitsuba's XML and serialized meshes, CityJSON, and grids of heights, each
//! also compressed by zstd or gzip.
//!
//! A file is read (and decompressed) into one buffer, then parsed in place. Whatever the bytes are, the answer is a
//! scene or a [`LoadError`]: counts are checked against the bytes that are left before anything is allocated, and
//! content that is out of proportion to its file is refused. Triangle ids are face order; a polygon of k corners is
//! k − 2 consecutive triangles (a fan where it is convex), and degenerate triangles keep their ids.

mod cityjson;
mod error;
mod gltf;
mod grid;
mod mitsuba;
mod obj;
mod off;
mod options;
mod ply;
mod polygon;
mod progress;
mod source;
mod stl;
mod text;
mod textures;
mod weld;

pub use error::{LoadError, Place};
pub use options::LoadOptions;
pub use source::Compression;

use crate::origin::Frame;
use crate::{Material, Origin, Scene, warning::warn};
use progress::Loading;
use slimkd::Progress;
use source::Folder;
use std::{fmt, path::Path};

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Stanford PLY: text, or binary of either byte order.
    Ply,
    /// Wavefront OBJ with MTL materials.
    Obj,
    /// STL, text or binary.
    Stl,
    /// glTF 2.0 as JSON.
    Gltf,
    /// glTF 2.0 as one binary file.
    Glb,
    /// Geomview's Object File Format, text.
    Off,
    /// ESRI's ASCII grid of heights.
    AsciiGrid,
    /// A NumPy array of heights, by rows and columns.
    Npy,
    /// A scene of Mitsuba, as XML.
    Mitsuba,
    /// Mitsuba's compressed meshes.
    Serialized,
    /// A city model as JSON.
    CityJson,
    /// A city model as a sequence of JSON texts, one a line.
    CityJsonSeq,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => "PLY",
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Off => "OFF",
            Self::AsciiGrid => "ESRI ASCII grid",
            Self::Npy => "NumPy array",
            Self::Mitsuba => "Mitsuba XML",
            Self::Serialized => "Mitsuba serialized",
            Self::CityJson => "CityJSON",
            Self::CityJsonSeq => "CityJSONSeq",
        })
    }
}

/// A file format and how it is compressed.
///
/// ```
/// use slimkd_scene::{Compression, FileKind, Format};
/// let kind = FileKind::of("hospital.PLY.zst".as_ref());
/// assert_eq!(kind, Some(FileKind { format: Format::Ply, compression: Compression::Zstd }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FileKind {
    /// The format once decompressed.
    pub format: Format,
    /// How it is compressed.
    pub compression: Compression,
}

impl FileKind {
    /// What the name's endings say, in any case; `None` when they are none that is known.
    pub fn of(path: &Path) -> Option<Self> {
        let outer = source::extension(path)?;
        let compression = match outer.as_str() {
            "zst" => Compression::Zstd,
            "gz" => Compression::Gzip,
            _ => Compression::None,
        };
        let inner = match compression {
            Compression::None => outer,
            _ => source::extension(Path::new(path.file_stem()?))?,
        };
        let format = match inner.as_str() {
            "ply" => Format::Ply,
            "obj" => Format::Obj,
            "stl" => Format::Stl,
            "gltf" => Format::Gltf,
            "glb" => Format::Glb,
            "off" => Format::Off,
            "asc" => Format::AsciiGrid,
            "npy" => Format::Npy,
            "xml" => Format::Mitsuba,
            "serialized" => Format::Serialized,
            "json" => Format::CityJson,
            "jsonl" => Format::CityJsonSeq,
            _ => return None,
        };
        Some(Self { format, compression })
    }
}

impl From<Format> for FileKind {
    fn from(format: Format) -> Self {
        Self { format, compression: Compression::None }
    }
}

/// Loads a scene file; its kind is told by the name's endings, see [`FileKind::of`].
///
/// ```no_run
/// let scene = slimkd_scene::load("hospital.ply.zst")?;
/// println!("{} triangles", scene.mesh.len());
/// # Ok::<(), slimkd_scene::LoadError>(())
/// ```
pub fn load(path: impl AsRef<Path>) -> Result<Scene, LoadError> {
    load_with(path, &LoadOptions::new(), &Progress::new())
}

/// Loads a scene file as [`load`] does, with choices of the caller, and reports to `progress`, which can also cancel it.
///
/// ```no_run
/// use slimkd::Progress;
/// use slimkd_scene::{LoadOptions, load_with};
/// let second = load_with("model.glb", &LoadOptions::new().scene_index(1), &Progress::new())?;
/// # Ok::<(), slimkd_scene::LoadError>(())
/// ```
pub fn load_with(
    path: impl AsRef<Path>,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let path = path.as_ref();
    progress.reach(0.0)?;
    let kind = FileKind::of(path);
    if kind.is_none() && path.is_dir() {
        return Err(LoadError::NotAFile { path: path.to_owned() });
    }
    let kind = kind.ok_or_else(|| LoadError::UnknownFormat { path: path.to_owned() })?;
    let bytes = source::read(path, kind.compression, progress)?;
    let folder =
        Folder { path: Some(path.parent().unwrap_or(Path::new(""))), allow_outside: options.allow_outside };
    let mut scene = parse(kind.format, &bytes, folder, options, progress)?;
    let stem = path.file_stem().map(Path::new);
    let stem = if kind.compression == Compression::None {
        stem
    } else {
        stem.and_then(|s| s.file_stem()).map(Path::new)
    };
    let name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    // City models end in `.city.json`.
    let is_city = matches!(kind.format, Format::CityJson | Format::CityJsonSeq);
    let bare = name.strip_suffix(".city").filter(|bare| is_city && !bare.is_empty());
    scene.name = bare.map_or_else(|| name.clone(), str::to_owned);
    Ok(scene)
}

/// Loads a scene from memory. Files that it names (materials, textures, buffers) count as missing.
///
/// ```
/// use slimkd_scene::{Format, load_bytes};
/// let ply = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
///     element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// assert_eq!(load_bytes(Format::Ply, ply)?.mesh.triangles(), [[0, 1, 2]]);
/// # Ok::<(), slimkd_scene::LoadError>(())
/// ```
pub fn load_bytes(kind: impl Into<FileKind>, bytes: &[u8]) -> Result<Scene, LoadError> {
    load_bytes_with(kind, bytes, &LoadOptions::new())
}

/// Loads a scene from memory as [`load_bytes`] does, with choices of the caller.
pub fn load_bytes_with(
    kind: impl Into<FileKind>,
    bytes: &[u8],
    options: &LoadOptions,
) -> Result<Scene, LoadError> {
    let (kind, progress) = (kind.into(), Progress::new());
    match kind.compression {
        Compression::None => parse(kind.format, bytes, Folder::NONE, options, &progress),
        compression => parse(
            kind.format,
            &source::decompress(compression, bytes, &progress)?,
            Folder::NONE,
            options,
            &progress,
        ),
    }
}

fn parse(
    format: Format,
    bytes: &[u8],
    folder: Folder<'_>,
    options: &LoadOptions,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    if bytes.is_empty() {
        return Err(LoadError::Empty);
    }
    progress.reach(progress::READ_SHARE)?;
    if let Some(index) = options.scene_index.filter(|&index| index > 0)
        && !matches!(format, Format::Gltf | Format::Glb)
    {
        let what = format!("there is no scene {index}: the format has one scene");
        return Err(LoadError::Invalid {
            format,
            place: Place::Whole,
            what,
            fix: "leave the scene's index out",
        });
    }
    let read = |frame: &Frame| match format {
        Format::Ply => ply::parse(bytes, frame, progress),
        Format::Obj => obj::parse(bytes, folder, frame, progress),
        Format::Stl => stl::parse(bytes, frame, progress),
        Format::Off => off::parse(bytes, frame, progress),
        Format::AsciiGrid => grid::parse_ascii(bytes, frame, progress),
        Format::Npy => grid::parse_npy(bytes, frame, progress),
        Format::Mitsuba => mitsuba::parse(bytes, folder, frame, progress),
        Format::Serialized => mitsuba::serialized::parse(bytes, frame, progress),
        Format::CityJson => cityjson::parse(bytes, frame, progress),
        Format::CityJsonSeq => cityjson::parse_sequence(bytes, frame, progress),
        Format::Gltf | Format::Glb => {
            gltf::parse(format, bytes, folder, options.scene_index, frame, progress)
        }
    };
    let mut frame = Frame::default();
    if let Origin::At(origin) = options.origin {
        frame = Frame::new(origin);
    }
    let mut scene = read(&frame)?;
    if options.origin == Origin::Auto {
        let origin = options.origin.choose(&scene.mesh);
        if origin != [0.0; 3] {
            // Far from 0: read again, as exactly as the file says it.
            frame = Frame::new(origin);
            drop(scene);
            scene = read(&frame)?;
        }
    }
    frame.finish(&mut scene);
    if scene.materials.is_empty() {
        scene.materials.push(Material::default());
    }
    progress.reach(1.0)?;
    Ok(scene)
}
