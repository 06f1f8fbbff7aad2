//! Everything that shapes a tree, and the named points of that space.

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
    /// Factor on the cost of a split with an empty side: 1 is no bonus, smaller favours cutting off empty space.
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
    /// By what each child's voxel really holds of it ("perfect splits", Wald & Havran 2006).
    Exact,
    /// Exactly in nodes of at least that many triangles, by its box below. The slides leave open what the paper did;
    /// 10,000 comes nearest to its Kitchen rows.
    ExactFrom(u32),
    /// By its box, cut to the voxel.
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
    /// 8-byte nodes, 2 bytes a reference in leaves whose ids share their upper 16 bits (the paper's).
    TwoByte = 1,
    /// 4-byte nodes with planes on a grid, and byte-coded leaves. Holds no T-references and no scene whose extent is beyond
    /// 8·10^37: these are written as [`Layout::TwoByte`].
    Dense = 2,
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
    /// For the whole tree.
    Bytes(u64),
    /// Bytes a triangle of the mesh, degenerate ones included, and 64 for the whole: above 0.
    BytesPerTriangle(f32),
}

impl TreeBudget {
    /// For a mesh of that many triangles.
    pub(crate) fn bytes(self, triangles: usize) -> u64 {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::BytesPerTriangle(each) => 64 + (f64::from(each) * triangles as f64) as u64,
        }
    }
}

/// All knobs of a build. Start from a [`Preset`], then set what is to be otherwise.
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
    /// The preset that these options started from; a label, it changes nothing.
    pub preset: Preset,
    /// Constants of the surface area heuristic.
    pub sah: SahConstants,
    /// A node of at most that many triangles becomes a leaf without further ado.
    pub leaf_at_most: u32,
    /// How straddling triangles are bounded.
    pub clipping: Clipping,
    /// How the tree is written.
    pub layout: Layout,
    /// The paper's T-references; `None` keeps every triangle in the leaves.
    pub hoisting: Option<Hoisting>,
    /// Whether subtrees that SAH finds no cheaper than a leaf become one.
    pub collapse: bool,
    /// How much bytes count beside rays when [`BuildOptions::collapse`] decides, 0 and up: at weight ℓ, halving the tree
    /// may raise its SAH cost by ℓ/2 of the whole. 0 (default): rays alone.
    pub byte_weight: f32,
    /// The most that the tree may take; `None` sets no bound. Where the tree at [`BuildOptions::byte_weight`] is larger,
    /// the weight is raised until it fits: the fastest tree of that size, from one build. The tree's own options then
    /// hold that weight.
    pub max_tree: Option<TreeBudget>,
    /// The most that a build may hold at a time, bytes above the mesh: what would take more ends with
    /// [`BuildError::BuildTooLarge`] before the memory is taken. `None` sets no bound. The account leaves out some MB of buffers.
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
