//! All options of a build, the presets, and the errors of a build.

mod error;
mod hoisting;
mod names;
mod preset;

pub use error::{BuildError, Countable};
pub use hoisting::{HoistAlgorithm, Hoisting};
pub use names::UnknownName;
pub use preset::Preset;

use std::num::NonZeroUsize;

/// Costs of the surface area heuristic, in arbitrary common units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct SahConstants {
    /// Cost of one traversal step, K_T.
    pub traversal: f32,
    /// Cost of one ray-triangle test, K_I.
    pub intersection: f32,
    /// The factor on the cost of a split with an empty side: 1 is no bonus, a smaller factor favours cutting off empty space.
    pub empty_bonus: f32,
}

impl SahConstants {
    /// Costs of a traversal step and of a triangle test, and the factor on splits with an empty side.
    pub fn new(traversal: f32, intersection: f32, empty_bonus: f32) -> Self {
        Self { traversal, intersection, empty_bonus }
    }
}

/// How a triangle that straddles a split plane is bounded in the children.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Clipping {
    /// By the bounds of the part that lies in each child's voxel ("perfect splits", Wald & Havran 2006).
    Exact,
    /// As [`Clipping::Exact`] in nodes of at least this many triangles, as [`Clipping::Box`] in smaller ones. The paper's slides do
    /// not say which it uses; 10,000 comes nearest to their rows for the Kitchen.
    ExactFrom(u32),
    /// By the triangle's bounding box, cut to the child's voxel.
    Box,
}

impl Clipping {
    pub(crate) fn is_exact_for(self, triangles: u32) -> bool {
        match self {
            Self::Exact => true,
            Self::ExactFrom(least) => triangles >= least,
            Self::Box => false,
        }
    }
}

/// How nodes and leaves are written. Hits are the same in all of them, to the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[repr(u8)]
pub enum Layout {
    /// 8-byte nodes, 4 bytes a reference.
    FourByte = 0,
    /// 8-byte nodes, 2 bytes a reference in leaves whose ids share their upper 16 bits, as in the paper; 4 bytes in other leaves.
    TwoByte = 1,
    /// 4-byte nodes with planes on a grid, and byte-coded leaves. This layout cannot hold T-references, nor a scene whose extent is
    /// beyond 8·10^37: such trees are written as [`Layout::TwoByte`].
    Dense = 2,
    /// Nodes of 16 child boxes in 256 bytes, and byte-coded leaves, built by splits of space and of objects. It has no T-references,
    /// and cannot hold a scene whose extent is beyond 8·10^37: such trees are written as [`Layout::TwoByte`]. Where
    /// [`BuildOptions::max_tree`] has no room for one node, as with a handful of triangles, a tree is written as [`Layout::Dense`]. One ray
    /// at a time goes through it 1.3 to 1.9 times as fast as through [`Layout::Dense`]; batches go ray by ray, and GPUs do not trace it yet.
    Wide = 3,
}

/// What divides the nodes of a [`Layout::Wide`] tree; other layouts know planes alone, whatever this says. Hits are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
#[repr(u8)]
pub enum Splits {
    /// Planes, which cut triangles, or sets of whole triangles, whichever is cheaper: the boxes of sibling nodes may overlap.
    #[default]
    Both = 0,
    /// Planes alone: a kd-tree's cells, which do not overlap, each with a tight box around what is in it. More references, and so
    /// larger trees. Only what no plane separates is divided as a set, where it is too much for a leaf.
    Space = 1,
}

/// A bound on the bytes of a tree, as [`MemoryReport::tree`](crate::MemoryReport::tree) counts them.
///
/// ```
/// use slimkd::{BuildOptions, TreeBudget};
/// let mut options = BuildOptions::default();
/// options.max_tree = Some(TreeBudget::Bytes(64 << 20));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum TreeBudget {
    /// Bytes of the whole tree.
    Bytes(u64),
    /// Bytes for each triangle of the mesh, degenerate ones included, and 64 bytes on top. It must be finite and above 0.
    BytesPerTriangle(f32),
}

impl TreeBudget {
    /// The bytes that the tree over a mesh of this many triangles may take.
    pub(crate) fn bytes(self, triangles: usize) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::BytesPerTriangle(each) => 64 + (f64::from(each) * triangles as f64) as u64,
        }
    }
}

/// All options of a build. Start from a [`Preset`], then change single options by the setters or by the fields.
///
/// ```
/// use slimkd::{BuildOptions, Preset, TreeBudget};
/// let options = BuildOptions::from(Preset::Slim).with_threads(2).with_max_tree(TreeBudget::BytesPerTriangle(6.0));
/// assert_eq!(options.threads.unwrap().get(), 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildOptions {
    /// The preset that these options started from. It is only a label: changing it changes no other option.
    pub preset: Preset,
    /// Constants of the surface area heuristic.
    pub sah: SahConstants,
    /// A node of at most this many triangles becomes a leaf, whatever the SAH says.
    pub leaf_at_most: u32,
    /// How straddling triangles are bounded.
    pub clipping: Clipping,
    /// How the tree is written.
    pub layout: Layout,
    /// What divides nodes, where the layout is [`Layout::Wide`].
    pub splits: Splits,
    /// The paper's T-references; `None` keeps every triangle in the leaves.
    pub hoisting: Option<Hoisting>,
    /// Whether a subtree becomes a leaf where the leaf's cost is no higher. Its cost is the SAH cost, and at a
    /// [`BuildOptions::byte_weight`] above 0 its bytes too.
    pub collapse: bool,
    /// How much bytes count beside rays where [`BuildOptions::collapse`] is set; 0 or more. At weight ℓ, a change that halves the tree
    /// is accepted when it raises the tree's SAH cost by at most the fraction ℓ/2. At 0, only rays count.
    pub byte_weight: f32,
    /// The most bytes that the tree may take; `None` sets no bound. Where the tree at [`BuildOptions::byte_weight`] is larger,
    /// the weight is raised until the tree fits: one build finds about the fastest tree of that size. [`KdTree::options`] of the
    /// finished tree then holds the raised weight.
    ///
    /// [`KdTree::options`]: crate::KdTree::options
    pub max_tree: Option<TreeBudget>,
    /// The most bytes that a build may hold at a time, without the mesh; `None` sets no bound. A build that needs more ends with
    /// [`BuildError::BuildTooLarge`] before it takes the memory. Some MB of buffers are not counted.
    pub max_build_bytes: Option<u64>,
    /// Threads to build with; `None` uses the current rayon pool. The tree is the same at any count.
    pub threads: Option<NonZeroUsize>,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Preset::default().into()
    }
}

/// Setters, one for each field; each returns the options with that field changed.
impl BuildOptions {
    /// Sets [`BuildOptions::sah`].
    #[must_use]
    pub fn with_sah(mut self, sah: SahConstants) -> Self {
        self.sah = sah;
        self
    }

    /// Sets [`BuildOptions::leaf_at_most`].
    #[must_use]
    pub fn with_leaf_at_most(mut self, triangles: u32) -> Self {
        self.leaf_at_most = triangles;
        self
    }

    /// Sets [`BuildOptions::clipping`].
    #[must_use]
    pub fn with_clipping(mut self, clipping: Clipping) -> Self {
        self.clipping = clipping;
        self
    }

    /// Sets [`BuildOptions::layout`].
    #[must_use]
    pub fn with_layout(mut self, layout: Layout) -> Self {
        self.layout = layout;
        self
    }

    /// Sets [`BuildOptions::splits`].
    #[must_use]
    pub fn with_splits(mut self, splits: Splits) -> Self {
        self.splits = splits;
        self
    }

    /// Sets [`BuildOptions::hoisting`].
    #[must_use]
    pub fn with_hoisting(mut self, hoisting: impl Into<Option<Hoisting>>) -> Self {
        self.hoisting = hoisting.into();
        self
    }

    /// Sets [`BuildOptions::byte_weight`], and [`BuildOptions::collapse`], without which it has no effect.
    #[must_use]
    pub fn with_byte_weight(mut self, weight: f32) -> Self {
        (self.collapse, self.byte_weight) = (true, weight);
        self
    }

    /// Sets [`BuildOptions::max_tree`]; `None` takes the preset's bound away.
    #[must_use]
    pub fn with_max_tree(mut self, most: impl Into<Option<TreeBudget>>) -> Self {
        self.max_tree = most.into();
        self
    }

    /// Sets [`BuildOptions::max_build_bytes`].
    #[must_use]
    pub fn with_max_build_bytes(mut self, bytes: impl Into<Option<u64>>) -> Self {
        self.max_build_bytes = bytes.into();
        self
    }

    /// Sets [`BuildOptions::threads`]; 0 uses the current rayon pool.
    #[must_use]
    pub fn with_threads(mut self, count: usize) -> Self {
        self.threads = NonZeroUsize::new(count);
        self
    }
}

impl BuildOptions {
    /// Without T-references, subtrees are collapsed as soon as they are built.
    pub(crate) fn collapses_while_building(&self) -> bool {
        self.collapse && self.hoisting.is_none()
    }

    /// Whether the finished plan must know how many triangles each node had.
    pub(crate) fn needs_counts(&self) -> bool {
        self.hoisting.as_ref().is_some_and(|hoisting| hoisting.algorithm == HoistAlgorithm::Strip)
    }

    pub(crate) fn validate(&self) -> Result<(), BuildError> {
        let SahConstants { traversal, intersection, empty_bonus } = self.sah;
        for (name, value) in
            [("traversal cost", traversal), ("intersection cost", intersection), ("empty bonus", empty_bonus)]
        {
            if !(value.is_finite() && value > 0.0) {
                return Err(BuildError::InvalidOption { name, value: value.into() });
            }
        }
        if !(self.byte_weight.is_finite() && self.byte_weight >= 0.0) {
            let (name, value) = ("byte weight", self.byte_weight.into());
            return Err(BuildError::InvalidOption { name, value });
        }
        if let Some(TreeBudget::BytesPerTriangle(each)) = self.max_tree
            && !(each.is_finite() && each > 0.0)
        {
            return Err(BuildError::InvalidOption { name: "bytes a triangle", value: each.into() });
        }
        for (name, value) in self.hoisting.iter().flat_map(Hoisting::thresholds) {
            if !(0.0..=1.0).contains(&value) {
                return Err(BuildError::InvalidThreshold { name, value: value.into() });
            }
        }
        Ok(())
    }
}
