//! The presets: named sets of options, with their constants.

use super::names::UnknownName;
use super::{BuildOptions, Clipping, Hoisting, Layout, SahConstants, Splits, TreeBudget};
use std::fmt;
use std::str::FromStr;

/// A named set of [`BuildOptions`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Preset {
    /// Wald & Havran 2006 as in the paper: no T-reference, no collapse, 4-byte leaves only, file order.
    Standard,
    /// The paper's tree at (occupancy, frequency) = (0.9, 0.7).
    PaperFast,
    /// The paper's tree at (0.5, 0.4).
    PaperSmall,
    /// Ours: as small as a tree can be at about the speed of [`Preset::Standard`]; at most 10 bytes a triangle.
    #[default]
    Slim,
    /// Ours: smaller than [`Preset::Slim`] at nearly its speed; at most 7 bytes a triangle.
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
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Preset {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let known = Self::ALL.iter().copied().find(|preset| preset.name() == name);
        known.ok_or_else(|| UnknownName::new("preset", name, Self::ALL.iter().map(|preset| preset.name())))
    }
}

impl From<Preset> for BuildOptions {
    fn from(preset: Preset) -> Self {
        // Calibrated on the slides' Kitchen rows, see docs/paper-tree.md: cost of a step from Wald & Havran 2006 §5.
        let paper = Self {
            preset,
            sah: SahConstants { traversal: 15.0, intersection: 20.0, empty_bonus: 0.85 },
            leaf_at_most: 4,
            clipping: Clipping::ExactFrom(10_000),
            layout: Layout::TwoByte,
            splits: Splits::Both,
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
