//! A `.skd` file as it lies in memory, mapped or read. It is traced without being proved first, so every access is checked.

use super::bytes::Section;
use super::sections::{DENSE, INDICES_2BYTE, INDICES_4BYTE, NODES, WIDE_LEAVES, WIDE_NODES};
use super::shape::{self, Shape};
use super::table::{Entry, Kind, Table};
use super::{FileError, damaged, options};
use crate::geometry::{Aabb, Ray};
use crate::job::Progress;
use crate::layout::checked::{CheckedMesh, Guard};
use crate::layout::dense::CheckedDense;
use crate::layout::plain::CheckedPlain;
use crate::layout::wide::CheckedWide;
use crate::layout::{Nodes, Planes, WideNode, WideNodes};
use crate::options::BuildOptions;
use crate::query::{Walk, tracer};
use crate::traverse::{
    ExactQuery, PreparedRay, Search, Sink, Traced, search_tree, search_wide, traverse, traverse_exactly,
    traverse_wide_exactly, walk_in_f64,
};
use crate::tree::KdTree;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// The deepest tree that is traced unproved. The stack is allocated for the depth that the file states, so that must have a bound;
/// trees of real scenes are less than 100 deep.
const DEEPEST: u32 = 1 << 16;

/// A saved tree over bytes that someone else owns: a `Vec`, a slice, or a memory map (`memmap2::Mmap`). Nothing is copied.
///
/// Opening checks the header, the section table and the small sections, whatever the file's size. All else may still be
/// damaged or forged, so every access is checked. Where a query meets bytes that no tree holds, its answer is wrong, mostly a miss, and
/// [`OpenTree::check`] then returns an error; a query never panics, reads outside the bytes or runs for ever. [`OpenTree::verify`]
/// proves the whole file and makes a [`KdTree`], which traces faster. An open tree traces batches ray by ray, on as many threads
/// as [`Batch::threads`](crate::Batch::threads) says.
///
/// Queries are in the trait [`Tracer`](crate::Tracer). The file holds no attributes: keep them beside it, and find the vertices of a hit by
/// [`OpenTree::triangle`].
///
/// ```
/// use slimkd::{BuildOptions, KdTree, OpenTree, Ray, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let path = std::env::temp_dir().join(format!("slimkd-open-{}.skd", std::process::id()));
/// KdTree::build(mesh, &BuildOptions::default())?.save(&path)?;
///
/// // With the crate `memmap2`, these bytes are `unsafe { memmap2::Mmap::map(&std::fs::File::open(&path)?)? }`.
/// let tree = OpenTree::open(std::fs::read(&path)?)?;
/// let ray = Ray::new([0.25, 0.5, 1.0], [0.0, 0.0, -1.0]);
/// let hit = tree.closest(&ray).expect("the ray points at the triangle");
/// let normal = tree.refine(&ray, hit.triangle).expect("the ray crosses the triangle's plane").normal;
/// assert_eq!(normal, [0.0, 0.0, 1.0]);
///
/// let heat = [[10.0], [20.0], [30.0]]; // of each vertex
/// let vertices = tree.triangle(hit.triangle).expect("a hit names a triangle");
/// assert_eq!(hit.interpolate(vertices.map(|vertex| heat[vertex as usize])), [22.5]);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The same hits as from the tree that was saved, and a proof when there is time for it:
///
/// ```
/// use slimkd::{BuildOptions, KdTree, OpenTree, Ray, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let mut bytes = Vec::new();
/// tree.write(&mut bytes)?;
/// let open = OpenTree::open(bytes)?;
/// let ray = Ray::new([0.2, 0.2, 1.0], [0.0, 0.0, -1.0]);
/// assert_eq!(open.closest(&ray), tree.closest(&ray));
/// open.check()?;
/// assert_eq!(open.verify()?.closest(&ray), tree.closest(&ray));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A memory map shares its file with every other process: where one of them cuts the file short while it is mapped, reading the lost
/// part ends this process by a signal (SIGBUS). Replace saved trees, as [`KdTree::save`] does, and never write into them.
#[derive(Debug)]
pub struct OpenTree<B> {
    bytes: B,
    tree: Sections,
    /// Whether any query met bytes that no tree holds.
    broken: AtomicBool,
}

/// Where everything lies, and what the small sections say.
#[derive(Clone, Debug)]
struct Sections {
    options: BuildOptions,
    shape: Shape,
    origin: [f64; 3],
    vertices: Range<usize>,
    triangles: Range<usize>,
    layout: Layout,
}

/// Where the encoded tree lies.
#[derive(Clone, Debug)]
enum Layout {
    Plain { nodes: Range<usize>, indices_4byte: Range<usize>, indices_2byte: Range<usize> },
    Dense { bytes: Range<usize>, planes: Planes },
    Wide { nodes: Range<usize>, leaves: Range<usize>, planes: Planes },
}

impl<B: AsRef<[u8]>> OpenTree<B> {
    /// Opens what [`KdTree::write`] or [`KdTree::save`] wrote, in time that does not depend on its size. The mesh must be in the file: one
    /// that was written without it is read by [`KdTree::read_with_mesh`].
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
        let (mut build_options, mut shape, mut origin) = (None, None, [0.0; 3]);
        let [mut vertices, mut triangles, mut nodes, mut wide, mut narrow, mut dense] = [const { None }; 6];
        let [mut wide_nodes, mut wide_leaves] = [const { None }; 2];
        for entry in &table.entries {
            let range = entry.offset as usize..(entry.offset + entry.length) as usize;
            match entry.kind {
                Kind::OPTIONS => build_options = options::get(&small(all, entry, options::LIMIT)?),
                Kind::SHAPE => shape = Some(Shape::get(&small(all, entry, shape::LENGTH)?)?),
                Kind::ORIGIN => origin = shape::get_origin(&small(all, entry, shape::ORIGIN_LENGTH)?)?,
                Kind::VERTICES => vertices = Some(range),
                Kind::TRIANGLES => triangles = Some(range),
                NODES => nodes = Some(range),
                INDICES_4BYTE => wide = Some(range),
                INDICES_2BYTE => narrow = Some(range),
                DENSE => dense = Some(range),
                WIDE_NODES => wide_nodes = Some(range),
                WIDE_LEAVES => wide_leaves = Some(range),
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
        let no_ids = wide.is_none() && narrow.is_none();
        let count = triangles.len() / 12;
        let misfit = "its layout does not fit the mesh";
        let layout = match (nodes, dense, wide_nodes, wide_leaves) {
            (Some(nodes), None, None, None) => Layout::Plain {
                nodes,
                indices_4byte: wide.unwrap_or_default(),
                indices_2byte: narrow.unwrap_or_default(),
            },
            (None, Some(bytes), None, None) if no_ids => {
                match CheckedDense::grid(bytes.len(), &shape.bounds, count) {
                    Some(planes) => Layout::Dense { bytes, planes },
                    None => return damaged(misfit),
                }
            }
            (None, None, Some(nodes), Some(leaves)) if no_ids => {
                match CheckedWide::grid(leaves.len(), &shape.bounds, count) {
                    Some(planes) => Layout::Wide { nodes, leaves, planes },
                    None => return damaged(misfit),
                }
            }
            _ => return damaged("it has no tree, or two"),
        };
        let tree = Sections { options, shape, origin, vertices, triangles, layout };
        Ok(Self { bytes, tree, broken: AtomicBool::new(false) })
    }

    /// Proves everything, as [`KdTree::read`] does. The tree that it returns is a copy and does not need these bytes.
    ///
    /// # Errors
    /// Those of [`KdTree::read`].
    pub fn verify(&self) -> Result<KdTree, FileError> {
        KdTree::read(self.bytes.as_ref())
    }

    /// Proves what [`OpenTree::verify`] proves, and that no triangle is missing anywhere ([`KdTree::check_complete`]): then the
    /// answers are right even if the file was forged.
    ///
    /// # Errors
    /// Those of [`KdTree::read`], and [`FileError::Incomplete`].
    pub fn verify_complete(&self, progress: &Progress) -> Result<KdTree, FileError> {
        let tree = self.verify()?;
        tree.check_complete(progress)?;
        Ok(tree)
    }

    /// The options that the file says it was built with.
    pub fn options(&self) -> &BuildOptions {
        &self.tree.options
    }

    /// Returns an error once any query met bytes that no tree holds; answers may have been wrong since then, mostly misses. Call this
    /// after a batch, and build the tree again from its scene when it returns an error.
    ///
    /// # Errors
    /// [`FileError::Damaged`].
    pub fn check(&self) -> Result<(), FileError> {
        if self.broken.load(Relaxed) { damaged("a query met what no tree holds") } else { Ok(()) }
    }

    /// The number of triangles of the mesh in the file.
    pub fn triangle_count(&self) -> usize {
        self.tree.triangles.len() / 12
    }

    /// The vertex indices of a triangle, for attributes that are kept beside the tree; `None` where no triangle has this id.
    pub fn triangle(&self, id: u32) -> Option<[u32; 3]> {
        self.opened().mesh().indices(id)
    }

    fn opened(&self) -> Opened<'_> {
        Opened { all: self.bytes.as_ref(), tree: &self.tree, broken: &self.broken }
    }

    /// Gives back the owner of the bytes.
    pub fn into_inner(self) -> B {
        self.bytes
    }
}

/// An [`OpenTree`] with its bytes as a slice. It is not generic, so that its walks are compiled once.
struct Opened<'a> {
    all: &'a [u8],
    tree: &'a Sections,
    broken: &'a AtomicBool,
}

tracer!(Opened<'_>);

/// Runs `$body` with `$nodes` bound to a view that checks every access, whichever layout the tree has.
macro_rules! with_checked_nodes {
    ($opened:expr, $nodes:ident => $body:expr, $wide:ident => $other:expr $(,)?) => {{
        let opened = $opened;
        let sections = opened.tree;
        match &sections.layout {
            Layout::Plain { nodes, indices_4byte, indices_2byte } => {
                let (wide, narrow) = (indices_4byte.len() as u64 / 4, indices_2byte.len() as u64 / 2);
                let guard = Guard::new(nodes.len() as u64 / 8, wide + narrow);
                let $nodes = CheckedPlain {
                    nodes: opened.part(nodes),
                    indices_4byte: opened.part(indices_4byte),
                    indices_2byte: opened.part(indices_2byte),
                    mesh: opened.mesh(),
                    guard: &guard,
                };
                $body;
                opened.remember(&guard);
            }
            Layout::Dense { bytes, planes } => {
                // A byte is at most a node, or a code of eight references.
                let guard = Guard::new(bytes.len() as u64, 8 * bytes.len() as u64);
                let triangles = sections.triangles.len() / 12;
                let $nodes = CheckedDense::new(opened.part(bytes), triangles, planes, opened.mesh(), &guard);
                $body;
                opened.remember(&guard);
            }
            Layout::Wide { nodes, leaves, planes } => {
                let guard = Guard::new((nodes.len() / size_of::<WideNode>()) as u64, 8 * leaves.len() as u64);
                let $wide = CheckedWide {
                    nodes: opened.part(nodes),
                    leaves: opened.part(leaves),
                    grid: planes,
                    triangles: sections.triangles.len() / 12,
                    mesh: opened.mesh(),
                    guard: &guard,
                };
                $other;
                opened.remember(&guard);
            }
        }
    }};
}

impl<'a> Opened<'a> {
    /// The bytes of a section; fewer where the owner of the bytes answers otherwise than the first time.
    fn part(&self, range: &Range<usize>) -> &'a [u8] {
        self.all.get(range.clone()).unwrap_or_default()
    }

    fn mesh(&self) -> CheckedMesh<'a> {
        CheckedMesh { vertices: self.part(&self.tree.vertices), triangles: self.part(&self.tree.triangles) }
    }

    fn remember(&self, guard: &Guard) {
        if guard.is_broken() {
            self.broken.store(true, Relaxed);
        }
    }
}

impl Walk for Opened<'_> {
    fn extent(&self) -> Aabb {
        self.tree.shape.bounds
    }

    fn place(&self) -> [f64; 3] {
        self.tree.origin
    }

    fn triangle(&self, id: u32) -> Option<[[f32; 3]; 3]> {
        self.mesh().find(id)
    }

    fn walk(&self, ray: &Ray, sink: &mut impl Sink) {
        let shape = &self.tree.shape;
        with_checked_nodes!(self, nodes => {
            if let Some(prepared) = PreparedRay::new(ray, &shape.bounds, &nodes.planes()) {
                traverse(nodes, shape.depth, &prepared, sink);
            }
        }, wide => {
            if let Some(prepared) = PreparedRay::new(ray, &shape.bounds, &wide.planes()) {
                walk_in_f64(wide, &prepared, sink);
            }
        });
    }

    fn walk_exact(&self, query: &mut ExactQuery<'_>) {
        let Shape { depth, ref bounds, .. } = self.tree.shape;
        with_checked_nodes!(self, nodes => traverse_exactly(Traced { nodes, depth, bounds }, query), wide => {
            traverse_wide_exactly(wide, bounds, query)
        });
    }

    fn search(&self, search: &mut Search<'_>) {
        let Shape { depth, ref bounds, .. } = self.tree.shape;
        with_checked_nodes!(self, nodes => search_tree(Traced { nodes, depth, bounds }, search), wide => search_wide(wide, search));
    }
}

tracer!([B: AsRef<[u8]> + Send + Sync] OpenTree<B>: |tree| tree.opened());

/// The bytes of a section that is at most `limit` long; its checksum is checked.
fn small(all: &[u8], entry: &Entry, limit: usize) -> Result<Vec<u8>, FileError> {
    let mut from = all.get(entry.offset as usize..).unwrap_or_default();
    let mut position = entry.offset;
    Section::start(&mut from, &mut position, entry)?.read_at_most(limit)
}
