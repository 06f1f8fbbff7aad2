//! Everything that shapes a tree, and the named points of that space.

use crate::reduce::{HoistAlgorithm, Hoisting};
use std::num::NonZeroUsize;
use thiserror::Error;

/// A named set of [`BuildOptions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Preset {
    /// Wald & Havran 2006 as in the paper: no T-reference, no collapse, 4-byte leaves only, file order.
    Standard,
    /// The paper's tree at (occupancy, frequency) = (0.9, 0.7).
    PaperFast,
    /// The paper's tree at (0.5, 0.4).
    PaperSmall,
    /// Ours: as small as it gets at the speed of [`Preset::Standard`].
    #[default]
    Slim,
    /// Ours: smaller still, for a few per cent of speed.
    Tiny,
}

impl Preset {
    /// All presets, in the order in which tables show them.
    pub const ALL: &[Self] = &[Self::Standard, Self::PaperFast, Self::PaperSmall, Self::Slim, Self::Tiny];

    /// The name on the command line and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::PaperFast => "paper-fast",
            Self::PaperSmall => "paper-small",
            Self::Slim => "slim",
            Self::Tiny => "tiny",
        }
    }

    /// The preset of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|preset| preset.name() == name)
    }
}

/// Costs of the surface area heuristic, in arbitrary common units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SahConstants {
    /// Cost of one traversal step, K_T.
    pub traversal: f32,
    /// Cost of one ray-triangle test, K_I.
    pub intersection: f32,
    /// Factor on the cost of a split with an empty side: 1 is no bonus, smaller favours cutting off empty space.
    pub empty_bonus: f32,
}

/// How a triangle that straddles a split plane is bounded in the children.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// Which planes of a node are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sweep {
    /// All: the split is the exact sweep's, to the last bit.
    Exact,
    /// In nodes of at least that many triangles, those in the bins on both sides of the cheapest border between up to 1,024
    /// bins an axis; all below. Nodes of up to 32 triangles are always exact. `docs/construction.md` has what it gains and loses.
    BinnedFrom(u32),
}

impl Sweep {
    pub(crate) fn is_binned_for(self, triangles: u32) -> bool {
        matches!(self, Self::BinnedFrom(least) if triangles >= least)
    }
}

/// How nodes and leaves are written. Hits are the same in all of them, to the last bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
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

/// All knobs of a build. Start from a [`Preset`].
#[derive(Clone, Debug, PartialEq)]
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
    /// Which planes are looked at.
    pub sweep: Sweep,
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

impl From<Preset> for BuildOptions {
    fn from(preset: Preset) -> Self {
        // Calibrated on the slides' Kitchen rows, see docs/paper-tree.md: cost of a step from Wald & Havran 2006 §5.
        let paper = Self {
            preset,
            sah: SahConstants { traversal: 15.0, intersection: 20.0, empty_bonus: 0.85 },
            leaf_at_most: 4,
            clipping: Clipping::ExactFrom(10_000),
            sweep: Sweep::Exact,
            layout: Layout::TwoByte,
            hoisting: None,
            collapse: false,
            byte_weight: 0.0,
            max_tree: None,
            max_build_bytes: None,
            threads: None,
        };
        // Measured on Kitchen, Sponza, hospital_structure and clinic_architectural; the other scenes of docs/presets.md check them.
        let ours = Self {
            sah: SahConstants { traversal: 15.0, intersection: 12.0, empty_bonus: 0.85 },
            leaf_at_most: 1,
            clipping: Clipping::Exact,
            collapse: true,
            layout: Layout::Dense,
            ..paper.clone()
        };
        match preset {
            Preset::Standard => Self { layout: Layout::FourByte, ..paper },
            Preset::PaperFast => Self { hoisting: Some(Hoisting::new(0.9, 0.7)), ..paper },
            Preset::PaperSmall => Self { hoisting: Some(Hoisting::new(0.5, 0.4)), ..paper },
            Preset::Slim => {
                Self { byte_weight: 0.05, max_tree: Some(TreeBudget::BytesPerTriangle(10.0)), ..ours }
            }
            Preset::Tiny => {
                Self { byte_weight: 0.2, max_tree: Some(TreeBudget::BytesPerTriangle(7.0)), ..ours }
            }
        }
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Preset::default().into()
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

/// Why a build ended without a tree.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`super::Progress::cancel`] was called: nothing is left behind, build again when wanted.
    #[error("the build was cancelled")]
    Cancelled,
    /// A constant is out of its range: set it to a finite number above 0 (a byte weight may be 0).
    #[error("the {name} is {value}; set it to a finite number above 0")]
    InvalidOption {
        /// Which constant.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// A threshold is out of its range: set it between 0 and 1.
    #[error("the {name} threshold is {value}; set it between 0 and 1")]
    InvalidThreshold {
        /// Which threshold.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// Even one leaf of all triangles is larger than [`BuildOptions::max_tree`]: allow more bytes, or use [`Layout::Dense`] if
    /// that is not the layout yet.
    #[error("the smallest tree takes {needed} bytes, {limit} are allowed; allow more")]
    TreeTooLarge {
        /// Bytes of the smallest tree.
        needed: u64,
        /// Bytes that were allowed.
        limit: u64,
    },
    /// The build would hold more than [`BuildOptions::max_build_bytes`]: allow more, or use [`Preset::Slim`] or [`Preset::Tiny`]
    /// in place of the others, since these also take less memory to build.
    #[error("the build needs {needed} bytes or more, {limit} are allowed; allow more")]
    BuildTooLarge {
        /// Bytes that it would have held, as far as it had come.
        needed: u64,
        /// Bytes that were allowed.
        limit: u64,
    },
    /// There was no memory for a block of the build: free some, or use [`Preset::Slim`] or [`Preset::Tiny`] in place of the
    /// others.
    #[error("no memory for a block of {bytes} bytes; free some")]
    OutOfMemory {
        /// Bytes of the block.
        bytes: u64,
    },
    /// The operating system gave no threads: ask for fewer.
    #[error("cannot start the build's threads ({0}); ask for fewer")]
    Threads(String),
    /// A layout's field cannot address the tree: use a smaller preset, a higher traversal cost, or split the mesh.
    #[error(
        "the tree needs {needed} {what}, the layout holds {limit}; use a smaller preset or split the mesh"
    )]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many the tree needs.
        needed: u64,
        /// How many fit.
        limit: u64,
    },
}
