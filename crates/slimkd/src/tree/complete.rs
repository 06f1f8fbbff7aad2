//! Proof that a tree lacks no triangle: wherever a triangle reaches, the leaf there or a node above names it.
//!
//! An encoder's trees are complete by construction, and checksums find accidents. A file that was forged on purpose, with
//! right checksums, needs this. Each triangle walks down the tree alone, cut at every plane as a build would cut it:
//!
//! - what lies left of the plane goes left, what lies right of it right;
//! - what lies within `reach` of it goes left, and where no leaf there names the triangle, what is left over goes right: a
//!   wall within a plane is on one side only, and which one is the builder's choice.
//!
//! `reach` is what the layout may have moved the plane by (`Planes::exact`), and [`NEAR`]. That covers a builder's rounding,
//! so a tree that was built is never refused; and the traversal visits both children of a plane that a hit is so near to
//! (`traverse/prepared.rs`: its slack has room for 17 parts of 2⁻²⁴ of M more; [`NEAR`] and [`NARROW`] together stay below one
//! where the largest coordinate is below 2¹⁷ M). So a complete tree answers rays as brute force does.

use super::{KdTree, walk};
use crate::geometry::{Polygon, TriangleMesh};
use crate::job::Progress;
use crate::layout::{Address, Inner, Nodes, Step, with_nodes};
use crate::threads;
use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering::Relaxed};
use thiserror::Error;

/// Nearer to a plane than this part of the triangle's largest coordinate on its axis is on both sides of it. A builder cuts
/// with less than a dozen roundings of 2⁻⁵³.
pub(super) const NEAR: f64 = 1.0 / (1u64 << 47) as f64;
/// Strips of a triangle narrower than this, where each axis is measured in the triangle's largest coordinate, are passed over.
const NARROW: f64 = 1.0 / (1u64 << 42) as f64;
/// Steps for each 8 bytes, reference and triangle, on average, before a tree is refused. Trees that were
/// built took 27 at most; without a bound, a forged tree could take the square of its size.
pub(super) const STEPS: u64 = 256;
/// Triangles that a thread takes at a time.
const TRIANGLES_A_TASK: usize = 1024;

/// Why a tree was not proved complete.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum CompletenessError {
    /// Rays can pass through this triangle: the file was forged, or a build is wrong. Build the tree again from its scene.
    #[error(
        "forged tree: triangle {triangle} is missing from a leaf that it reaches into; build the tree again from its scene"
    )]
    Missing {
        /// The first such triangle.
        triangle: u32,
    },
    /// No tree that was built takes so long to prove: build it again from its scene.
    #[error("forged tree: its planes lie so densely that no proof ends; build the tree again from its scene")]
    TooLong,
    /// The proof needs 4 bytes a reference and 8 a triangle: free memory, or trust the file.
    #[error("no memory for {bytes} bytes to prove the tree complete; free memory, or do without this proof")]
    OutOfMemory {
        /// What was asked for.
        bytes: u64,
    },
    /// [`Progress::cancel`] was called.
    #[error("cancelled")]
    Cancelled,
}

impl KdTree {
    /// Proves that no triangle is missing anywhere, so that rays are answered as by [`BruteForce`](crate::BruteForce).
    ///
    /// A tree from [`KdTree::build`] is complete. [`KdTree::read`] proves of a file that it is safe to trace, and finds all
    /// damage by its checksums; one that was forged on purpose may still leave triangles out of leaves, and only this
    /// finds that. It takes a few seconds per million triangles and core, on the current rayon pool.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Progress, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let mut file = Vec::new();
    /// KdTree::build(mesh, &BuildOptions::default())?.write(&mut file)?;
    /// let tree = KdTree::read(&mut &file[..])?;
    /// tree.check_complete(&Progress::new())?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Any [`CompletenessError`].
    pub fn check_complete(&self, progress: &Progress) -> Result<(), CompletenessError> {
        with_nodes!(self, nodes => check(self, nodes, progress), wide => super::covered::check(self, wide, progress))
    }
}

fn check<N: Nodes + Sync>(tree: &KdTree, nodes: N, progress: &Progress) -> Result<(), CompletenessError> {
    let listing = Listing::of(nodes, tree.mesh.len())?;
    let (valid, _) = tree.mesh.valid_triangles();
    let size = tree.encoded.bytes() / 8 + listing.leaves.len() as u64 + valid.len() as u64;
    let left = AtomicI64::new(i64::try_from(STEPS * size).unwrap_or(i64::MAX));
    progress.begin(1.0);
    let share = TRIANGLES_A_TASK as f64 / valid.len().max(1) as f64;
    // The first chunk with an error; those behind it need not be looked at.
    let first = AtomicUsize::new(usize::MAX);
    let found = threads::map(valid.chunks(TRIANGLES_A_TASK).enumerate(), |(number, ids)| {
        if number > first.load(Relaxed) {
            return Ok(None);
        }
        let found = check_chunk(tree, nodes, &listing, ids, &left, progress).err();
        if found.is_some() {
            first.fetch_min(number, Relaxed);
        }
        progress.advance(share);
        Ok::<_, CompletenessError>(found)
    })?;
    if let Some(error) = found.into_iter().flatten().next() {
        return Err(error);
    }
    progress.finish();
    Ok(())
}

/// Proves triangles complete, one after the other; `left` are the steps that all threads may still take.
fn check_chunk<N: Nodes>(
    tree: &KdTree,
    nodes: N,
    listing: &Listing,
    ids: &[u32],
    left: &AtomicI64,
    progress: &Progress,
) -> Result<(), CompletenessError> {
    let mut walk = Walk::new(nodes, listing);
    for &triangle in ids {
        if progress.is_cancelled() {
            return Err(CompletenessError::Cancelled);
        }
        // Threads may each take what is left, so it can fall below 0.
        let before = left.load(Relaxed).max(0);
        walk.steps = before as u64;
        let complete = walk.run(&tree.mesh, triangle);
        left.fetch_sub(before - walk.steps as i64, Relaxed);
        match complete {
            Some(true) => {}
            Some(false) => return Err(CompletenessError::Missing { triangle }),
            None => return Err(CompletenessError::TooLong),
        }
    }
    Ok(())
}

/// The leaves that name each triangle, by their addresses, ascending.
struct Listing {
    /// Where each triangle's leaves begin; those of the last end with the array.
    starts: Vec<usize>,
    leaves: Vec<u32>,
}

impl Listing {
    fn of<N: Nodes>(nodes: N, triangles: usize) -> Result<Self, CompletenessError> {
        let mut starts = zeros(triangles)?;
        let each = |visit: &mut dyn FnMut(u32, u32)| {
            walk::for_each(nodes, crate::geometry::Aabb::EMPTY, |at, node| {
                if let Step::Leaf(leaf) = node {
                    // SAFETY: the leaf comes from this tree.
                    unsafe { nodes.for_each(leaf, |id| visit(id, at.address.get())) };
                }
            });
        };
        each(&mut |id, _| starts[id as usize] += 1);
        let mut total = 0;
        for end in &mut starts {
            total += *end;
            *end = total;
        }
        let mut leaves = zeros(total)?;
        each(&mut |id, leaf| {
            let at = &mut starts[id as usize];
            *at -= 1;
            leaves[*at] = leaf;
        });
        let mut listing = Self { starts, leaves };
        for id in 0..triangles {
            let range = listing.range(id);
            listing.leaves[range].sort_unstable();
        }
        Ok(listing)
    }

    fn range(&self, id: usize) -> std::ops::Range<usize> {
        self.starts[id]..self.starts.get(id + 1).copied().unwrap_or(self.leaves.len())
    }

    fn names(&self, leaf: u32, triangle: u32) -> bool {
        self.leaves[self.range(triangle as usize)].binary_search(&leaf).is_ok()
    }
}

fn zeros<T: Copy + Default>(count: usize) -> Result<Vec<T>, CompletenessError> {
    let mut items = Vec::new();
    let bytes = count as u64 * size_of::<T>() as u64;
    items.try_reserve_exact(count).map_err(|_| CompletenessError::OutOfMemory { bytes })?;
    items.resize(count, T::default());
    Ok(items)
}

/// A part of a triangle on its way down.
struct Piece {
    polygon: Polygon,
    node: Address,
    /// Where it goes if the leaf that it comes to does not name the triangle: an index into the rescues.
    rescue: Option<u32>,
}

/// The other side of a plane that a piece lies within, and what comes after that.
#[derive(Clone, Copy)]
struct Rescue {
    node: Address,
    next: Option<u32>,
}

/// One triangle at a time.
struct Walk<'a, N> {
    nodes: N,
    listing: &'a Listing,
    measure: Measure,
    pieces: Vec<Piece>,
    rescues: Vec<Rescue>,
    /// How many steps may still be taken.
    steps: u64,
}

impl<'a, N: Nodes> Walk<'a, N> {
    fn new(nodes: N, listing: &'a Listing) -> Self {
        Self {
            nodes,
            listing,
            measure: Measure { largest: [0.0; 3] },
            pieces: Vec::new(),
            rescues: Vec::new(),
            steps: 0,
        }
    }

    /// Whether the triangle is named wherever it reaches; `None` when that takes too many steps.
    fn run(&mut self, mesh: &TriangleMesh, triangle: u32) -> Option<bool> {
        self.pieces.clear();
        self.rescues.clear();
        let polygon = Polygon::new(&mesh.corners(triangle));
        self.measure = Measure::of(&polygon);
        self.pieces.push(Piece { polygon, node: Address::ROOT, rescue: None });
        while let Some(piece) = self.pieces.pop() {
            self.steps = self.steps.checked_sub(1)?;
            // SAFETY: the node is the root or a child of a node of this tree.
            match unsafe { self.nodes.node(piece.node) } {
                Step::Inner(Inner { t_reference, .. }) if t_reference == Some(triangle) => {}
                Step::Inner(inner) => self.split(&piece, &inner),
                Step::Leaf(_) if self.listing.names(piece.node.get(), triangle) => {}
                Step::Leaf(_) => match piece.rescue {
                    Some(rescue) => {
                        let Rescue { node, next } = self.rescues[rescue as usize];
                        self.pieces.push(Piece { node, rescue: next, ..piece });
                    }
                    None if self.measure.is_narrow(&piece.polygon) => {}
                    None => return Some(false),
                },
            }
        }
        Some(true)
    }

    /// Sends the parts of a piece to the children.
    fn split(&mut self, piece: &Piece, inner: &Inner) {
        let (axis, left, right) = (inner.axis, inner.left(), inner.right());
        let &Piece { ref polygon, rescue, .. } = piece;
        let (place, cell) = self.nodes.planes().exact(axis, inner.split);
        let reach = cell + NEAR * self.measure.largest[axis];
        let (first, last) = (place - reach, place + reach);
        let along = polygon.corners().iter().map(|corner| corner[axis]);
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let mut middle = *polygon;
        if low < first {
            if high <= first {
                return self.pieces.push(Piece { polygon: *polygon, node: left, rescue });
            }
            self.push_clipped(polygon, axis, first, -1.0, left, rescue);
            polygon.clip(axis, first, 1.0, &mut middle);
        }
        if high > last {
            if low >= last {
                return self.pieces.push(Piece { polygon: *polygon, node: right, rescue });
            }
            self.push_clipped(polygon, axis, last, 1.0, right, rescue);
            let above = middle;
            above.clip(axis, last, -1.0, &mut middle);
        }
        // A strip across a slanting triangle is at most as much wider than the slab as the triangle is longer than high.
        let (slab, height) =
            (2.0 * reach / self.measure.largest[axis], (high - low) / self.measure.largest[axis]);
        let passed_over = slab * self.measure.diameter(polygon) <= NARROW * height;
        if !passed_over {
            self.rescues.push(Rescue { node: right, next: rescue });
            let rescue = Some(self.rescues.len() as u32 - 1);
            self.pieces.push(Piece { polygon: middle, node: left, rescue });
        }
    }

    fn push_clipped(
        &mut self,
        polygon: &Polygon,
        axis: usize,
        at: f64,
        sign: f64,
        node: Address,
        rescue: Option<u32>,
    ) {
        let mut part = *polygon;
        polygon.clip(axis, at, sign, &mut part);
        self.pieces.push(Piece { polygon: part, node, rescue });
    }
}

/// What a triangle's pieces are measured by.
pub(super) struct Measure {
    /// The triangle's largest coordinate per axis, scene units.
    pub(super) largest: [f64; 3],
}

impl Measure {
    pub(super) fn of(whole: &Polygon) -> Self {
        Self { largest: [0, 1, 2].map(|k| whole.corners().iter().fold(0.0, |a, b| b[k].abs().max(a))) }
    }

    /// The corners, each axis in units of the triangle's largest coordinate.
    fn scaled(&self, polygon: &Polygon) -> impl Iterator<Item = [f64; 3]> {
        let scale = self.largest.map(|largest| if largest > 0.0 { 1.0 / largest } else { 0.0 });
        polygon.corners().iter().map(move |corner| std::array::from_fn(|k| corner[k] * scale[k]))
    }

    /// At least the largest distance between two corners, at most √3 of it; in scaled units.
    fn diameter(&self, polygon: &Polygon) -> f64 {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in self.scaled(polygon) {
            (0..3).for_each(|k| (low[k], high[k]) = (low[k].min(corner[k]), high[k].max(corner[k])));
        }
        (0..3).map(|k| high[k] - low[k]).sum()
    }

    /// Whether a polygon is a strip about as narrow as [`NARROW`], or nothing.
    pub(super) fn is_narrow(&self, polygon: &Polygon) -> bool {
        let mut corners = self.scaled(polygon);
        let Some(first) = corners.next() else { return true };
        let minus = |a: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - first[k]) };
        let (mut normal, mut before) = ([0.0; 3], [0.0; 3]);
        for corner in corners.map(minus) {
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                normal[k] += before[i] * corner[j] - before[j] * corner[i];
            }
            before = corner;
        }
        // Twice the area is at least the diameter times the width.
        normal.iter().map(|x| x * x).sum::<f64>().sqrt() <= NARROW * self.diameter(polygon)
    }
}
