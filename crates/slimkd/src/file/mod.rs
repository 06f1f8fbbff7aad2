//! The `.skd` file: a tree, the options that it was built with and, unless left out, its mesh. Little-endian.
//!
//! ```text
//! header, 64 bytes (see `table.rs`): "SKDTREE\0", version, number of sections, length of the file, checksum
//! section table, 32 bytes each: kind, offset, length, checksum
//! sections, each from a multiple of 64 bytes, zeros between them
//! ```
//!
//! | section | what | where |
//! |---|---|---|
//! | options | preset and build options | `options.rs` |
//! | shape | counts, bounds, depth, the mesh's hash | `shape.rs` |
//! | vertices, triangles | the mesh; both or neither | here |
//! | origin | where the mesh is in the world; only with a mesh, and where it is not 0 | `shape.rs` |
//! | nodes, indices… | the encoded tree | `sections.rs` |
//!
//! Every build of the same scene with the same options gives the same file: it holds no thread count, time or path, and
//! the sections' order, places and padding follow from their lengths. A section of unknown kind is an error, since a
//! tree without it would be another tree. Attributes of the vertices are not part of the file.
//!
//! [`KdTree::read`] proves everything before it returns: checksums, pointers, ids, order, bounds, depth, and that each
//! triangle that can be hit is somewhere in the tree. So a damaged or hostile file is an error and never a wrong access.
//! Memory is taken as bytes arrive, so a false length takes no more memory than the file has bytes. [`OpenTree`] proves nothing of
//! the arrays and checks each access instead.

mod bytes;
mod open;
mod options;
mod save;
mod sections;
mod shape;
mod table;

use crate::geometry::{MeshError, TriangleMesh};
use crate::layout::Damage;
use crate::tree::{CompletenessError, KdTree, for_each_reference};
pub use open::OpenTree;

use bytes::{Section, le_bytes};
use sections::Parts;
use shape::Shape;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use table::{Kind, Table};
use thiserror::Error;

/// Why a `.skd` file could not be written or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The first bytes are not a `.skd` file's: build one with `slimkd build SCENE -o tree.skd`.
    #[error("not a .skd tree; make one with `slimkd build SCENE -o tree.skd`")]
    NotATree,
    /// Written by another version of the format: build it again from the scene.
    #[error("format version {found}, this build reads {expected}; build the tree again from its scene")]
    Version {
        /// What the file says.
        found: u32,
        /// What is understood.
        expected: u32,
    },
    /// A section that this version does not know: read it with the version that wrote it, or build it again.
    #[error(
        "section of unknown kind {0}; read it with a newer slimkd, or build the tree again from its scene"
    )]
    UnknownSection(u32),
    /// The contents contradict themselves: the file is damaged, build it again from the scene.
    #[error("damaged tree: {0}; build it again from its scene")]
    Damaged(String),
    /// The tree was saved without its mesh: hand it in, with [`KdTree::read_with_mesh`].
    #[error(
        "saved without its mesh of {vertices} vertices and {triangles} triangles; read it together with that mesh"
    )]
    MeshMissing {
        /// Vertices of the mesh that is missing.
        vertices: u64,
        /// Its triangles.
        triangles: u64,
    },
    /// The mesh that was handed in is not the one that the tree was built over: give that one, or build again.
    #[error(
        "this is the tree of another mesh: {vertices} vertices, {triangles} triangles, hash {expected:016x}, and the \
         one given has hash {found:016x}; give the mesh that it was built over, or build the tree again"
    )]
    MeshMismatch {
        /// Vertices of the tree's mesh.
        vertices: u64,
        /// Its triangles.
        triangles: u64,
        /// Its [`TriangleMesh::content_hash`].
        expected: u64,
        /// That of the mesh that was handed in.
        found: u64,
    },
    /// Not proved complete: see [`KdTree::check_complete`].
    #[error(transparent)]
    Incomplete(#[from] CompletenessError),
    /// The operating system could not read or write: its own error says why.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// What was wrong with a file, and which file.
    #[error("{}: {source}", path.display())]
    At {
        /// The file that was to be read or written.
        path: PathBuf,
        /// What was wrong.
        source: Box<FileError>,
    },
}

impl FileError {
    /// This error with the file that it is about.
    fn at(self, path: &Path) -> Self {
        Self::At { path: path.to_owned(), source: Box::new(self) }
    }
}

impl From<Damage> for FileError {
    fn from(damage: Damage) -> Self {
        Self::Damaged(damage.0)
    }
}

impl From<MeshError> for FileError {
    fn from(error: MeshError) -> Self {
        Self::Damaged(error.to_string())
    }
}

pub(super) fn damaged<T>(what: impl Into<String>) -> Result<T, FileError> {
    Err(FileError::Damaged(what.into()))
}

impl KdTree {
    /// Writes the tree and its mesh. Give it a buffered writer, or use [`KdTree::save`].
    ///
    /// # Errors
    /// [`FileError::Io`].
    pub fn write(&self, mut to: impl Write) -> Result<(), FileError> {
        self.write_sections(&mut to, true)
    }

    /// Writes the tree alone, with the [hash](TriangleMesh::content_hash) of the mesh that
    /// [`KdTree::read_with_mesh`] will ask for.
    ///
    /// # Errors
    /// [`FileError::Io`].
    pub fn write_without_mesh(&self, mut to: impl Write) -> Result<(), FileError> {
        self.write_sections(&mut to, false)
    }

    fn write_sections(&self, to: &mut impl Write, with_mesh: bool) -> Result<(), FileError> {
        let mut sections = vec![
            (Kind::OPTIONS, options::put(&self.options).into()),
            (Kind::SHAPE, Shape::of(self).put().into()),
        ];
        if with_mesh {
            sections.push((Kind::VERTICES, le_bytes(self.mesh.vertices())));
            sections.push((Kind::TRIANGLES, le_bytes(self.mesh.triangles())));
            if self.mesh.origin() != [0.0; 3] {
                sections.push((Kind::ORIGIN, shape::put_origin(self.mesh.origin()).into()));
            }
        }
        sections.extend(sections::put(&self.encoded));
        table::write(to, &sections)?;
        to.flush()?;
        Ok(())
    }

    /// Reads and proves what [`KdTree::write`] wrote.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let mut bytes = Vec::new();
    /// tree.write(&mut bytes)?;
    /// assert_eq!(KdTree::read(&bytes[..])?.memory(), tree.memory());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Any [`FileError`] but [`FileError::MeshMismatch`].
    pub fn read(mut from: impl Read) -> Result<Self, FileError> {
        read(&mut from, None)
    }

    /// Reads and proves a tree over a mesh that is already there, whether or not the file holds it too.
    ///
    /// ```
    /// # use slimkd::{BuildOptions, KdTree, TriangleMesh};
    /// # use std::sync::Arc;
    /// # let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// # let mesh = Arc::new(mesh);
    /// let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::default())?;
    /// let mut bytes = Vec::new();
    /// tree.write_without_mesh(&mut bytes)?;
    /// assert!(KdTree::read(&bytes[..]).is_err());
    /// assert!(KdTree::read_with_mesh(&bytes[..], mesh).is_ok());
    /// assert!(KdTree::read_with_mesh(&bytes[..], TriangleMesh::default()).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Any [`FileError`] but [`FileError::MeshMissing`].
    pub fn read_with_mesh(
        mut from: impl Read,
        mesh: impl Into<Arc<TriangleMesh>>,
    ) -> Result<Self, FileError> {
        read(&mut from, Some(mesh.into()))
    }
}

fn read(from: &mut impl Read, given: Option<Arc<TriangleMesh>>) -> Result<KdTree, FileError> {
    let table = Table::read(from)?;
    let mut position = table.end();
    let (mut build_options, mut shape) = (None, None);
    let (mut vertices, mut triangles) = (None::<Vec<[f32; 3]>>, None::<Vec<[u32; 3]>>);
    let mut origin = None;
    let mut parts = Parts::default();
    for entry in &table.entries {
        let section = Section::start(from, &mut position, entry)?;
        match entry.kind {
            Kind::OPTIONS => {
                let block = section.read_at_most(options::LIMIT)?;
                build_options =
                    Some(options::get(&block).map_or_else(|| damaged("its options make no sense"), Ok)?);
            }
            Kind::SHAPE => shape = Some(Shape::get(&section.read_at_most(shape::LENGTH)?)?),
            Kind::VERTICES if given.is_none() => vertices = Some(section.read()?),
            Kind::TRIANGLES if given.is_none() => triangles = Some(section.read()?),
            Kind::ORIGIN if given.is_none() => {
                origin = Some(shape::get_origin(&section.read_at_most(shape::ORIGIN_LENGTH)?)?);
            }
            Kind::VERTICES | Kind::TRIANGLES | Kind::ORIGIN => section.skip()?,
            _ => sections::take(&mut parts, section)?,
        }
    }
    if from.read(&mut [0])? != 0 {
        return damaged("there are bytes behind the end");
    }
    let (Some(build_options), Some(shape)) = (build_options, shape) else {
        return damaged("a section is missing");
    };
    let mesh = match (given, vertices, triangles) {
        (Some(mesh), ..) => mesh,
        (None, Some(vertices), Some(triangles)) => {
            let mesh = TriangleMesh::new(vertices, triangles)?;
            Arc::new(mesh.with_origin(origin.unwrap_or_default()))
        }
        (None, None, None) if origin.is_none() => {
            return Err(FileError::MeshMissing { vertices: shape.vertices, triangles: shape.triangles });
        }
        _ => return damaged("half of its mesh is missing"),
    };
    shape.check_mesh(&mesh)?;
    let (valid, bounds) = mesh.valid_triangles();
    let (encoded, depth) = parts.prove(&bounds, mesh.len())?;
    shape.check_facts(&mesh, valid.len(), &bounds, depth)?;
    let degenerate = (mesh.len() - valid.len()) as u64;
    let tree = KdTree { mesh, options: build_options, bounds, encoded, depth, degenerate };
    check_references(&tree, &valid)?;
    Ok(tree)
}

/// Proves that the tree names every triangle of `valid` and no other.
fn check_references(tree: &KdTree, valid: &[u32]) -> Result<(), FileError> {
    const DEGENERATE: u8 = 0;
    const MISSING: u8 = 1;
    const SEEN: u8 = 2;
    let mut state = vec![DEGENERATE; tree.mesh.len()];
    valid.iter().for_each(|&id| state[id as usize] = MISSING);
    let mut wrong = false;
    for_each_reference(tree, |id| {
        let state = &mut state[id as usize];
        wrong |= *state == DEGENERATE;
        *state = SEEN;
    });
    if wrong {
        return damaged("it names a triangle that can never be hit");
    }
    if state.contains(&MISSING) { damaged("a triangle is in no leaf") } else { Ok(()) }
}
