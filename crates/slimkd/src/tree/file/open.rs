//! A `.skd` file as it lies in memory, mapped or read: ready at once, proved by nobody, safe all the same.

use super::bytes::Section;
use super::sections::{DENSE, INDICES_2BYTE, INDICES_4BYTE, NODES};
use super::shape::{self, Shape};
use super::table::{Entry, Kind, Table};
use super::{FileError, damaged, options};
use crate::build::{BuildOptions, Progress};
use crate::geometry::{Aabb, Ray};
use crate::traverse::{All, Any, Closest, Filtered, Hit, Planes, PreparedRay, Sink, sort_hits, traverse};
use crate::tree::KdTree;
use crate::tree::checked::{CheckedMesh, Guard};
use crate::tree::dense::CheckedDense;
use crate::tree::nodes::Nodes;
use crate::tree::plain::CheckedPlain;
use std::ops::Range;

/// Deepest tree that is traced unproved: the stack is made for what the file says. Real ones end below 100.
const DEEPEST: u32 = 1 << 16;

/// A saved tree over bytes that someone else owns: a `Vec`, a slice, or a memory map (`memmap2::Mmap`). Nothing is copied.
///
/// Opening checks the header, the section table and the small sections, whatever the file's size. All else may still be
/// damaged or forged. So every access is checked: a query on what is no tree is an error or answers wrongly, and never
/// panics, reads elsewhere or goes on for ever. [`OpenTree::verify`] proves the whole and makes the [`KdTree`] that traces
/// faster, in batches too.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, OpenTree, Ray, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let mut bytes = Vec::new();
/// tree.write(&mut bytes)?;
/// let open = OpenTree::open(bytes)?;
/// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
/// assert_eq!(open.closest_hit(&ray)?, tree.closest_hit(&ray));
/// assert_eq!(open.verify()?.closest_hit(&ray), tree.closest_hit(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct OpenTree<B> {
    bytes: B,
    options: BuildOptions,
    shape: Shape,
    vertices: Range<usize>,
    triangles: Range<usize>,
    layout: Layout,
}

/// Where the encoded tree lies.
#[derive(Clone, Debug)]
enum Layout {
    Plain { nodes: Range<usize>, indices_4byte: Range<usize>, indices_2byte: Range<usize> },
    Dense { bytes: Range<usize>, planes: Planes },
}

impl<B: AsRef<[u8]>> OpenTree<B> {
    /// Opens what [`KdTree::write`] wrote, in time that does not depend on its size.
    ///
    /// # Errors
    /// [`FileError::NotATree`], [`FileError::Version`], [`FileError::UnknownSection`], [`FileError::MeshMissing`], and
    /// [`FileError::Damaged`] for what can be seen from the table and the small sections.
    pub fn open(bytes: B) -> Result<Self, FileError> {
        let all = bytes.as_ref();
        let table = Table::read(&mut &all[..])?;
        let end = table.entries.last().map_or(table.end(), |entry| entry.offset + entry.length);
        if end != all.len() as u64 {
            return damaged("its length is wrong");
        }
        let (mut build_options, mut shape) = (None, None);
        let [mut vertices, mut triangles, mut nodes, mut wide, mut narrow, mut dense] = [const { None }; 6];
        for entry in &table.entries {
            let range = entry.offset as usize..(entry.offset + entry.length) as usize;
            match entry.kind {
                Kind::OPTIONS => build_options = options::get(&small(all, entry, options::LIMIT)?),
                Kind::SHAPE => shape = Some(Shape::get(&small(all, entry, shape::LENGTH)?)?),
                Kind::VERTICES => vertices = Some(range),
                Kind::TRIANGLES => triangles = Some(range),
                NODES => nodes = Some(range),
                INDICES_4BYTE => wide = Some(range),
                INDICES_2BYTE => narrow = Some(range),
                DENSE => dense = Some(range),
                Kind(other) => return Err(FileError::UnknownSection(other)),
            }
        }
        let (Some(options), Some(shape)) = (build_options, shape) else {
            return damaged("a section is missing or makes no sense");
        };
        let (Some(vertices), Some(triangles)) = (vertices, triangles) else {
            return Err(FileError::MeshMissing { vertices: shape.vertices, triangles: shape.triangles });
        };
        let counts = [(&vertices, shape.vertices), (&triangles, shape.triangles)];
        if counts.iter().any(|(range, count)| count.checked_mul(12) != Some(range.len() as u64)) {
            return damaged("its mesh is not as large as it says");
        }
        if shape.depth > DEEPEST {
            return damaged("it is too deep to be traced before it is proved");
        }
        let layout = match (nodes, dense) {
            (Some(nodes), None) => Layout::Plain {
                nodes,
                indices_4byte: wide.unwrap_or_default(),
                indices_2byte: narrow.unwrap_or_default(),
            },
            (None, Some(bytes)) if wide.is_none() && narrow.is_none() => {
                match CheckedDense::grid(bytes.len(), &shape.bounds, triangles.len() / 12) {
                    Some(planes) => Layout::Dense { bytes, planes },
                    None => return damaged("its layout does not fit the mesh"),
                }
            }
            _ => return damaged("it has no tree, or two"),
        };
        Ok(Self { bytes, options, shape, vertices, triangles, layout })
    }

    /// Proves everything, as [`KdTree::read`] does, and copies it into memory of its own.
    ///
    /// # Errors
    /// As [`KdTree::read`].
    pub fn verify(&self) -> Result<KdTree, FileError> {
        KdTree::read(&mut self.bytes.as_ref())
    }

    /// Proves what [`OpenTree::verify`] proves, and that no triangle is missing anywhere ([`KdTree::check_complete`]): then the
    /// answers are right even if the file was forged.
    ///
    /// # Errors
    /// As [`KdTree::read`], and [`FileError::Incomplete`].
    pub fn verify_complete(&self, progress: &Progress) -> Result<KdTree, FileError> {
        let tree = self.verify()?;
        tree.check_complete(progress)?;
        Ok(tree)
    }

    /// As [`KdTree::closest_hit`].
    ///
    /// # Errors
    /// [`FileError::Damaged`] when the ray met something that no tree holds.
    pub fn closest_hit(&self, ray: &Ray) -> Result<Option<Hit>, FileError> {
        let mut sink = Closest::new(ray.t_max);
        self.offer_all(ray, &mut sink)?;
        Ok(sink.into_hit())
    }

    /// As [`KdTree::any_hit`].
    ///
    /// # Errors
    /// As [`OpenTree::closest_hit`].
    pub fn any_hit(&self, ray: &Ray) -> Result<bool, FileError> {
        let mut sink = Any { found: false, t_max: ray.t_max };
        self.offer_all(ray, &mut sink)?;
        Ok(sink.found)
    }

    /// As [`KdTree::all_hits`].
    ///
    /// # Errors
    /// As [`OpenTree::closest_hit`].
    pub fn all_hits(&self, ray: &Ray) -> Result<Vec<Hit>, FileError> {
        let mut hits = Vec::new();
        self.offer_all(ray, &mut All { hits: &mut hits, t_max: ray.t_max })?;
        sort_hits(&mut hits);
        Ok(hits)
    }

    /// As [`KdTree::closest_hit_where`].
    ///
    /// # Errors
    /// As [`OpenTree::closest_hit`].
    pub fn closest_hit_where(
        &self,
        ray: &Ray,
        accept: impl FnMut(&Hit) -> bool,
    ) -> Result<Option<Hit>, FileError> {
        let mut sink = Filtered { sink: Closest::new(ray.t_max), accept };
        self.offer_all(ray, &mut sink)?;
        Ok(sink.sink.into_hit())
    }

    /// As [`KdTree::any_hit_where`].
    ///
    /// # Errors
    /// As [`OpenTree::closest_hit`].
    pub fn any_hit_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Result<bool, FileError> {
        let mut sink = Filtered { sink: Any { found: false, t_max: ray.t_max }, accept };
        self.offer_all(ray, &mut sink)?;
        Ok(sink.sink.found)
    }

    /// As [`KdTree::all_hits_where`].
    ///
    /// # Errors
    /// As [`OpenTree::closest_hit`].
    pub fn all_hits_where(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Result<Vec<Hit>, FileError> {
        let mut hits = Vec::new();
        let sink = All { hits: &mut hits, t_max: ray.t_max };
        self.offer_all(ray, &mut Filtered { sink, accept })?;
        sort_hits(&mut hits);
        Ok(hits)
    }

    /// The options that the file says it was built with.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// The bounds that the file says it has.
    pub fn bounds(&self) -> Aabb {
        self.shape.bounds
    }

    /// The owner of the bytes.
    pub fn into_inner(self) -> B {
        self.bytes
    }

    fn offer_all(&self, ray: &Ray, sink: &mut impl Sink) -> Result<(), FileError> {
        let all = self.bytes.as_ref();
        // An owner may answer otherwise the next time.
        let part = |range: &Range<usize>| all.get(range.clone()).unwrap_or_default();
        let mesh = CheckedMesh { vertices: part(&self.vertices), triangles: part(&self.triangles) };
        match &self.layout {
            Layout::Plain { nodes, indices_4byte, indices_2byte } => {
                let (wide, narrow) = (indices_4byte.len() as u64 / 4, indices_2byte.len() as u64 / 2);
                let guard = Guard::new(nodes.len() as u64 / 8, wide + narrow);
                let nodes = CheckedPlain {
                    nodes: part(nodes),
                    indices_4byte: part(indices_4byte),
                    indices_2byte: part(indices_2byte),
                    mesh,
                    guard: &guard,
                };
                self.trace(nodes, ray, sink, &guard)
            }
            Layout::Dense { bytes, planes } => {
                // A byte is at most a node, or a code of eight references.
                let guard = Guard::new(bytes.len() as u64, 8 * bytes.len() as u64);
                let triangles = self.triangles.len() / 12;
                let nodes = CheckedDense::new(part(bytes), triangles, planes, mesh, &guard);
                self.trace(nodes, ray, sink, &guard)
            }
        }
    }

    fn trace(
        &self,
        nodes: impl Nodes,
        ray: &Ray,
        sink: &mut impl Sink,
        guard: &Guard,
    ) -> Result<(), FileError> {
        if let Some(prepared) = PreparedRay::new(ray, &self.shape.bounds, &nodes.planes()) {
            traverse(nodes, self.shape.depth, &prepared, sink);
        }
        if guard.is_broken() { damaged("a ray met what no tree holds") } else { Ok(()) }
    }
}

/// A section that is never long, once its checksum is right.
fn small(all: &[u8], entry: &Entry, limit: usize) -> Result<Vec<u8>, FileError> {
    let mut from = all.get(entry.offset as usize..).unwrap_or_default();
    let mut position = entry.offset;
    Section::start(&mut from, &mut position, entry)?.read_at_most(limit)
}
