//! The interface by which walks and kernels read a tree, whatever its layout.

use super::Planes;
use std::mem::MaybeUninit;

/// The place of a node in a tree. Only a view makes addresses, from its own tree, so that reading there needs no check of bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Address(u32);

impl Address {
    /// The root of every tree.
    pub(crate) const ROOT: Self = Self(0);

    /// # Safety
    /// A node of the tree that it will be used with must stand at `at`.
    #[inline(always)]
    pub(crate) unsafe fn new(at: u32) -> Self {
        Self(at)
    }

    /// The place in the unit of the tree's layout: bytes or nodes.
    #[inline(always)]
    pub(crate) fn get(self) -> u32 {
        self.0
    }
}

/// How a leaf writes its ids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeafMode {
    FourByte,
    TwoByte,
    Coded,
}

/// What stands at an address: one node, decoded.
#[derive(Clone, Copy)]
pub(crate) enum Step<L> {
    Inner(Inner),
    Leaf(L),
}

/// An inner node.
#[derive(Clone, Copy)]
pub(crate) struct Inner {
    pub(crate) axis: usize,
    /// The split plane's position on that axis, in the layout's plane coordinates, see [`Planes`].
    pub(crate) split: f32,
    left: Address,
    /// How far behind the left child the right one stands.
    stride: u32,
    pub(crate) t_reference: Option<u32>,
}

impl Inner {
    /// # Safety
    /// The children must stand at `left` and at `left + stride` in the tree that this node belongs to.
    #[inline(always)]
    pub(super) unsafe fn new(
        axis: usize,
        split: f32,
        left: u32,
        stride: u32,
        t_reference: Option<u32>,
    ) -> Self {
        Self { axis, split, left: Address(left), stride, t_reference }
    }

    #[inline(always)]
    pub(crate) fn left(&self) -> Address {
        self.left
    }

    #[inline(always)]
    pub(crate) fn right(&self) -> Address {
        Address(self.left.0 + self.stride)
    }

    /// The child that a ray enters first, and the other one. `descends` is all ones where the ray goes down its axis, else 0.
    #[inline(always)]
    pub(crate) fn near_and_far(&self, descends: u32) -> (Address, Address) {
        let near = descends & self.stride;
        (Address(self.left.0 + near), Address(self.left.0 + (self.stride - near)))
    }
}

/// A tree as walks read it: one that was proved, whose reads are unchecked, or one whose view checks every access.
///
/// A proved tree comes only from an encoder, which writes valid addresses and ids by construction, or from a file, which is proved on
/// reading. It cannot change afterwards. Leaving out the checks, together with making the ray's longest axis a constant, made every
/// ray a sixth faster.
///
/// # Safety
/// [`Address::ROOT`] must be a node of this tree, every [`Address`] in an [`Inner`] that [`Nodes::node`] returns must be one, and every
/// id that a leaf or an inner node names must be a triangle of the mesh, or reading at any address and id must be checked.
pub(crate) unsafe trait Nodes: Copy {
    type Leaf: Copy;

    /// Decodes the node at an address.
    ///
    /// # Safety
    /// The address must come from this tree: the root, or a child of a node that this returned.
    unsafe fn node(self, address: Address) -> Step<Self::Leaf>;

    /// Takes the next ids off a leaf, ascending; none when all are taken. They lie in `buffer` or in the tree.
    ///
    /// # Safety
    /// The leaf must come from this tree.
    unsafe fn take<'b>(self, leaf: &mut Self::Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b;

    /// Calls `visit` for each of a leaf's ids, ascending.
    ///
    /// # Safety
    /// The leaf must come from this tree.
    #[inline(always)]
    unsafe fn for_each(self, mut leaf: Self::Leaf, mut visit: impl FnMut(u32)) {
        let mut buffer = Ids::new();
        loop {
            // SAFETY: the caller says that the leaf comes from this tree.
            let ids = unsafe { self.take(&mut leaf, &mut buffer) };
            if ids.is_empty() {
                return;
            }
            ids.iter().for_each(|&id| visit(id));
        }
    }

    /// How the leaf's ids are written.
    fn mode(leaf: Self::Leaf) -> LeafMode;

    /// The corners of a triangle.
    ///
    /// # Safety
    /// The id must come from this tree: from a leaf or from an inner node.
    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3];

    /// The coordinates in which the tree gives its split planes.
    fn planes(self) -> Planes;

    /// Is called when a walk needs more stack than the recorded depth. Only a tree that was not proved can cause it.
    #[cold]
    fn too_deep(self) {}
}

/// The most ids that are taken off a leaf at once. Nearly every leaf has no more.
pub(crate) const MOST_IDS: usize = 64;
/// How many ids a layout may write behind those that it reports, since it decodes several at a time.
pub(crate) const SPILL: usize = 8;

/// Room for the ids that are taken at once. It is not initialised, so making it takes no time.
pub(crate) struct Ids(pub(super) [MaybeUninit<u32>; MOST_IDS + SPILL]);

impl Ids {
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self([MaybeUninit::uninit(); MOST_IDS + SPILL])
    }

    /// Writes `first` and the [`SPILL`] − 1 ids after it to place `at` and those behind it.
    #[inline(always)]
    pub(super) fn write_run(&mut self, at: usize, first: u32) {
        // One check and one store, not eight.
        let to: &mut [MaybeUninit<u32>; SPILL] =
            (&mut self.0[at..at + SPILL]).try_into().expect("a slice of that length");
        for k in 0..SPILL {
            to[k].write(first.wrapping_add(k as u32));
        }
    }

    /// The first `count` ids, and with the last of them again up to a multiple of four. There are at most [`MOST_IDS`], and at least one.
    ///
    /// # Safety
    /// They were written.
    #[inline(always)]
    pub(super) unsafe fn fours(&mut self, count: usize) -> &[[u32; 4]] {
        // SAFETY: the caller wrote them.
        let last = unsafe { self.0[count - 1].assume_init() };
        let to: &mut [MaybeUninit<u32>; 3] =
            (&mut self.0[count..count + 3]).try_into().expect("a slice of that length");
        *to = [MaybeUninit::new(last); 3];
        let fours = count.div_ceil(4);
        // SAFETY: less than four ids follow `count` before a multiple of four; `MaybeUninit<u32>` has the layout of `u32`.
        unsafe { std::slice::from_raw_parts(self.0.as_ptr().cast(), fours) }
    }

    /// The first `count` ids.
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
