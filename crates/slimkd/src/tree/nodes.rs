//! What walks and kernels see of a tree, whatever its layout.

use super::dense::DenseView;
use super::plain::PlainView;
use super::statistics::LeafMode;
use super::{Encoded, KdTree};
use crate::geometry::TriangleMesh;
use crate::traverse::{Planes, Simd};
use std::mem::MaybeUninit;

/// One node.
#[derive(Clone, Copy)]
pub(crate) enum Step<L> {
    Inner(Inner),
    Leaf(L),
}

/// An inner node. The right child stands `stride` behind the left one.
#[derive(Clone, Copy)]
pub(crate) struct Inner {
    pub(crate) axis: usize,
    /// In the layout's plane coordinates, see [`Planes`].
    pub(crate) split: f32,
    pub(crate) left: u32,
    pub(crate) stride: u32,
    pub(crate) t_reference: Option<u32>,
}

/// A proven tree, or one whose view checks every access: every address that comes from it can be read without bounds checks. The root's is 0.
///
/// A [`KdTree`] comes only from an encoder, whose output holds by construction, or from a file, which is proved on reading.
/// None of it can change afterwards. Leaving the checks out and making the ray's axis a constant took a sixth off every
/// ray together.
pub(crate) trait Nodes: Copy {
    type Leaf: Copy;

    /// Decodes the node at an address of this tree.
    fn node(self, address: u32) -> Step<Self::Leaf>;

    /// Takes the next ids off a leaf, ascending; none when all are taken. They lie in `buffer` or in the tree.
    fn take<'b>(self, leaf: &mut Self::Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b;

    /// Calls `visit` for each of a leaf's ids, ascending.
    #[inline(always)]
    fn for_each(self, mut leaf: Self::Leaf, mut visit: impl FnMut(u32)) {
        let mut buffer = Ids::new();
        loop {
            let ids = self.take(&mut leaf, &mut buffer);
            if ids.is_empty() {
                return;
            }
            ids.iter().for_each(|&id| visit(id));
        }
    }

    /// How the leaf's ids are written.
    fn mode(leaf: Self::Leaf) -> LeafMode;

    /// The corners of a triangle that this tree names.
    fn corners(self, triangle: u32) -> [[f32; 3]; 3];

    /// The coordinates of its split planes.
    fn planes(self) -> Planes;

    /// Is told that a path is longer than the tree is deep: what was not proved may be so.
    #[cold]
    fn too_deep(self) {}
}

/// Ids that are taken off a leaf at once, at most; nearly every leaf is one piece.
pub(crate) const PIECE: usize = 64;
/// Ids that a layout may write behind a piece.
pub(crate) const SPILL: usize = 8;

/// Room for a piece. Costs nothing to make.
pub(crate) struct Ids(pub(super) [MaybeUninit<u32>; PIECE + SPILL]);

impl Ids {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self([MaybeUninit::uninit(); PIECE + SPILL])
    }

    /// The first `count`.
    ///
    /// # Safety
    /// They were written.
    #[inline(always)]
    pub(super) unsafe fn written(&self, count: usize) -> &[u32] {
        debug_assert!(count <= self.0.len());
        // SAFETY: the caller wrote them; `MaybeUninit<u32>` has the layout of `u32`.
        unsafe { std::slice::from_raw_parts(self.0.as_ptr().cast(), count) }
    }
}

/// The mesh behind a proven tree.
#[derive(Clone, Copy)]
pub(super) struct MeshView<'a> {
    triangles: &'a [[u32; 3]],
    vertices: &'a [[f32; 3]],
}

impl<'a> MeshView<'a> {
    pub(super) fn new(mesh: &'a TriangleMesh) -> Self {
        Self { triangles: mesh.triangles(), vertices: mesh.vertices() }
    }

    /// Corners of a triangle that a proven tree names.
    #[inline(always)]
    pub(super) fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        debug_assert!((triangle as usize) < self.triangles.len());
        // SAFETY: a proven tree names existing triangles only, and the mesh's vertex indices were checked when it was made.
        unsafe {
            self.triangles.get_unchecked(triangle as usize).map(|v| *self.vertices.get_unchecked(v as usize))
        }
    }

    /// Whether lanes can address both arrays: they count in 4-byte units below 2³¹.
    pub(super) fn fits_lanes(self) -> bool {
        const REACH: usize = (1 << 31) / 3;
        !self.triangles.is_empty() && self.triangles.len() < REACH && self.vertices.len() < REACH
    }

    /// x, y, z of the corners of a triangle a lane. Needs [`MeshView::fits_lanes`] and ids below the mesh's length.
    #[inline(always)]
    pub(super) fn lane_corners<S: Simd>(self, s: S, triangle: S::U) -> [[S::F; 3]; 3] {
        let (triangles, vertices) =
            (self.triangles.as_ptr().cast::<u8>(), self.vertices.as_ptr().cast::<u8>());
        let (last_triangle, last_vertex) = (self.triangles.len() as u32 - 1, self.vertices.len() as u32 - 1);
        // SAFETY: the ids name triangles, and the mesh's vertex indices were checked when it was made.
        unsafe {
            let [a, b, c] = lane_entries(s, triangles, last_triangle, triangle);
            let a = lane_entries(s, vertices, last_vertex, a);
            let b = lane_entries(s, vertices, last_vertex, b);
            let c = lane_entries(s, vertices, last_vertex, c);
            [lane_floats(s, a), lane_floats(s, b), lane_floats(s, c)]
        }
    }
}

/// The three u32 of 12-byte entries.
///
/// # Safety
/// Indices must be at most `last`, the last entry of the array; the array must be as [`MeshView::fits_lanes`] says.
#[inline(always)]
unsafe fn lane_entries<S: Simd>(s: S, base: *const u8, last: u32, index: S::U) -> [S::U; 3] {
    let at = index + (index << 1);
    // SAFETY: 16 bytes are read where another entry follows, else 12; all offsets are below 2³¹ of 4 bytes.
    unsafe {
        if s.any(s.eq_u32(index, s.u32s(last))) {
            let (x, y) = s.gather_pairs::<4>(base, at);
            return [x, y, s.gather_u32::<4>(base, at + s.u32s(2))];
        }
        let [x, y, z, _] = s.gather_rows::<4>(base, at);
        [x, y, z]
    }
}

#[inline(always)]
fn lane_floats<S: Simd>(s: S, [x, y, z]: [S::U; 3]) -> [S::F; 3] {
    [s.cast_f32(x), s.cast_f32(y), s.cast_f32(z)]
}

/// A tree's view in its own layout: what every query dispatches on, once.
pub(crate) enum View<'a> {
    Plain(PlainView<'a>),
    Dense(DenseView<'a>),
}

impl<'a> View<'a> {
    pub(crate) fn new(tree: &'a KdTree) -> Self {
        let mesh = MeshView::new(&tree.mesh);
        match &tree.encoded {
            Encoded::Plain(plain) => Self::Plain(PlainView::new(plain, mesh)),
            Encoded::Dense(dense) => Self::Dense(DenseView::new(dense, mesh)),
        }
    }
}

/// Runs `$body` with `$nodes` bound to the tree's view, whichever layout it has.
macro_rules! with_nodes {
    ($tree:expr, $nodes:ident => $body:expr) => {
        match $crate::tree::View::new($tree) {
            $crate::tree::View::Plain($nodes) => $body,
            $crate::tree::View::Dense($nodes) => $body,
        }
    };
}
pub(crate) use with_nodes;
