//! How a tree is built: the preset, and whatever is set in place of its own choices.

use super::parse::{
    TreeSize, bytes, clipping, fraction, layout, not_negative, positive, splits, threads, tree_budget, within,
};
use crate::failure::Failure;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use slimkd::{BuildOptions, Clipping, HoistAlgorithm, Hoisting, Layout, Preset, Splits};
use std::num::NonZeroUsize;

/// Everything that shapes one tree.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Tree")]
pub(crate) struct TreeArgs {
    #[arg(long, value_name = "P", value_parser = preset(), help = preset_help())]
    pub(crate) preset: Option<Preset>,
    #[command(flatten)]
    pub(crate) tuning: TuningArgs,
    /// Threads to work with, 1 to 1024; all cores unless given. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// The most memory that building may take above the mesh: bytes, with a unit such as MiB or GB. What would take more ends
    /// with an error before
    #[arg(long, value_name = "SIZE", value_parser = bytes)]
    max_build_bytes: Option<u64>,
}

/// What replaces the preset's own choices.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Tree")]
pub(crate) struct TuningArgs {
    #[command(flatten)]
    sah: SahArgs,
    #[command(flatten)]
    hoisting: HoistingArgs,
    #[command(flatten)]
    shape: ShapeArgs,
}

/// Constants of the surface area heuristic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Tree")]
struct SahArgs {
    /// Cost of a traversal step in the surface area heuristic, in any unit, 1e-37 to 3.4e38; the preset's unless given
    #[arg(long, value_name = "COST", value_parser = positive, allow_negative_numbers = true)]
    sah_traversal: Option<f32>,
    /// Cost of a triangle test in the surface area heuristic, in the same unit and limits; the preset's unless given
    #[arg(long, value_name = "COST", value_parser = positive, allow_negative_numbers = true)]
    sah_intersection: Option<f32>,
    /// Factor on the cost of a split with an empty side, 1e-37 to 3.4e38: 1 is no bonus; the preset's unless given
    #[arg(long, value_name = "FACTOR", value_parser = positive, allow_negative_numbers = true)]
    empty_bonus: Option<f32>,
}

/// T-references: which triangles move up into inner nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Tree")]
struct HoistingArgs {
    #[arg(long, value_name = "X", value_parser = fraction, allow_negative_numbers = true, help = occupancy_help())]
    occupancy: Option<f32>,
    #[arg(long, value_name = "X", value_parser = fraction, allow_negative_numbers = true, help = frequency_help())]
    frequency: Option<f32>,
    /// Hoist by building subtrees anew, the paper's way: slower to build than stripping the finished tree
    #[arg(long)]
    rebuild: bool,
}

/// Leaves and splits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Tree")]
struct ShapeArgs {
    /// Turn subtrees into leaves where the surface area heuristic finds those no dearer
    #[arg(long)]
    collapse: bool,
    /// Collapse for bytes too: halving the tree may cost rays L/2 of their SAH cost. 0 is rays alone, 3.4e38 the most
    #[arg(long, value_name = "L", value_parser = not_negative, allow_negative_numbers = true)]
    byte_weight: Option<f32>,
    /// Nodes of at most that many triangles, 0 to 4294967295, become leaves at once; the preset's unless given
    #[arg(long, value_name = "N", value_parser = within::<u32>(0..=u32::MAX), allow_negative_numbers = true)]
    leaf_at_most: Option<u32>,
    /// How triangles across a split are bounded: exactly, by their boxes, or exactly in nodes of N triangles and more;
    /// the preset's unless given
    #[arg(long, value_name = "exact|box|N", value_parser = clipping, allow_negative_numbers = true)]
    clipping: Option<Clipping>,
    /// How the tree is written: 8-byte nodes with 4-byte or also 2-byte references; the dense layout; or wide nodes of 16 child boxes,
    /// fast for one ray at a time, on the CPU alone. Each of the last two holds no T-references: a tree that has some is
    /// written as two-byte, and hoisting options exclude them. The preset's unless given
    #[arg(long, value_name = "four-byte|two-byte|dense|wide", value_parser = layout)]
    layout: Option<Layout>,
    /// What divides the nodes of a wide tree: planes and sets of triangles, whichever is cheaper, or planes alone, a kd-tree's cells;
    /// with --layout wide. Both unless given
    #[arg(long, value_name = "both|space", value_parser = splits)]
    splits: Option<Splits>,
    /// The fastest tree of at most SIZE: bytes, with a unit such as KiB or MB, bytes a triangle, as in 6/tri, or none. Found from
    /// one build, by raising the byte weight; the preset's unless given
    #[arg(long, value_name = "SIZE", value_parser = tree_budget)]
    max_tree_bytes: Option<TreeSize>,
}

impl TreeArgs {
    /// What was said about the tree's shape, by the options' names.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let preset = self.preset.map(|_| "--preset");
        preset.into_iter().chain(self.tuning.given()).collect()
    }

    /// The library's options.
    pub(crate) fn options(&self) -> BuildOptions {
        self.options_of(self.preset.unwrap_or_default())
    }

    /// The same with another preset.
    pub(crate) fn options_of(&self, preset: Preset) -> BuildOptions {
        let mut options = self.tuning.options(preset, self.threads);
        options.max_build_bytes = self.max_build_bytes;
        options
    }
}

impl TuningArgs {
    /// Refuses what no tree can be, before there is any work.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let hoisting = self.hoisting.given();
        if let Some(layout @ (Layout::Dense | Layout::Wide)) = self.shape.layout
            && !hoisting.is_empty()
        {
            return Err(Failure::usage(format_args!(
                "--layout {layout} holds no T-references; leave out {}, or take --layout two-byte",
                listed(&hoisting)
            )));
        }
        if self.shape.splits.is_some() && self.shape.layout != Some(Layout::Wide) {
            return Err(Failure::usage(
                "--splits is a choice of wide trees, and others are divided by planes; add --layout wide, or leave it out",
            ));
        }
        Ok(())
    }

    /// The options that were given, by their names.
    pub(crate) fn given(&self) -> Vec<&'static str> {
        let Self { sah, hoisting, shape } = self;
        let SahArgs { sah_traversal, sah_intersection, empty_bonus } = sah;
        let ShapeArgs { collapse, byte_weight, leaf_at_most, clipping, layout, splits, max_tree_bytes } =
            shape;
        let costs = [
            ("--sah-traversal", sah_traversal.is_some()),
            ("--sah-intersection", sah_intersection.is_some()),
            ("--empty-bonus", empty_bonus.is_some()),
        ];
        let shape = [
            ("--collapse", *collapse),
            ("--byte-weight", byte_weight.is_some()),
            ("--leaf-at-most", leaf_at_most.is_some()),
            ("--clipping", clipping.is_some()),
            ("--layout", layout.is_some()),
            ("--splits", splits.is_some()),
            ("--max-tree-bytes", max_tree_bytes.is_some()),
        ];
        [named(&costs), hoisting.given(), named(&shape)].concat()
    }

    /// The options of a preset with these choices in place of its own.
    pub(crate) fn options(&self, preset: Preset, threads: Option<NonZeroUsize>) -> BuildOptions {
        let mut options = BuildOptions::from(preset);
        options.threads = threads;
        let Self { sah, hoisting, shape } = self;
        set(&mut options.sah.traversal, sah.sah_traversal);
        set(&mut options.sah.intersection, sah.sah_intersection);
        set(&mut options.sah.empty_bonus, sah.empty_bonus);
        hoisting.apply(&mut options.hoisting);
        set(&mut options.byte_weight, shape.byte_weight);
        set(&mut options.leaf_at_most, shape.leaf_at_most);
        set(&mut options.clipping, shape.clipping);
        options.collapse |= shape.collapse || shape.byte_weight.is_some();
        set(&mut options.layout, shape.layout);
        set(&mut options.splits, shape.splits);
        if let Some(most) = shape.max_tree_bytes {
            options.max_tree = most.0;
        }
        options
    }
}

/// The names of what is true.
fn named(options: &[(&'static str, bool)]) -> Vec<&'static str> {
    options.iter().filter(|option| option.1).map(|option| option.0).collect()
}

/// Names as in a sentence.
pub(crate) fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

impl HoistingArgs {
    fn given(&self) -> Vec<&'static str> {
        let Self { occupancy, frequency, rebuild } = *self;
        named(&[
            ("--occupancy", occupancy.is_some()),
            ("--frequency", frequency.is_some()),
            ("--rebuild", rebuild),
        ])
    }

    /// Any of these options turns hoisting on where the preset has none.
    fn apply(&self, hoisting: &mut Option<Hoisting>) {
        if *self == Self::default() {
            return;
        }
        let hoisting = hoisting.get_or_insert_with(usual_hoisting);
        set(&mut hoisting.occupancy, self.occupancy);
        set(&mut hoisting.frequency, self.frequency);
        if self.rebuild {
            hoisting.algorithm = HoistAlgorithm::Rebuild;
        }
    }
}

/// What hoists where the preset says nothing.
fn usual_hoisting() -> Hoisting {
    BuildOptions::from(Preset::PaperFast).hoisting.unwrap_or_else(|| Hoisting::new(0.9, 0.7))
}

fn set<T>(value: &mut T, given: Option<T>) {
    if let Some(given) = given {
        *value = given;
    }
}

fn occupancy_help() -> String {
    threshold_help(
        "share of the leaves' surface under a node that the triangle occupies",
        usual_hoisting().occupancy,
    )
}

fn frequency_help() -> String {
    threshold_help("share of the leaves under a node that hold the triangle", usual_hoisting().frequency)
}

fn threshold_help(what: &str, usual: f32) -> String {
    format!(
        "Least {what} for it to move up there, 0 to 1; the preset's unless given, {usual} where the preset moves none"
    )
}

fn preset_help() -> String {
    format!("Which tree to build; {} unless given", Preset::default().name())
}

/// Parses a preset's name; the error and the help list them all.
pub(crate) fn preset() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::ALL.iter().map(|preset| preset.name()))
        .try_map(|name| name.parse::<Preset>())
}

/// What a ray asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// The nearest hit
    Closest,
    /// Whether there is a hit
    Any,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use slimkd::TreeBudget;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        tree: TreeArgs,
    }

    fn options(line: &str) -> Result<BuildOptions, String> {
        let words = std::iter::once("tool").chain(line.split_whitespace());
        Line::try_parse_from(words).map(|line| line.tree.options()).map_err(|error| error.to_string())
    }

    #[test]
    fn nothing_given_is_the_preset() {
        assert_eq!(options(""), Ok(BuildOptions::default()));
        for &preset in Preset::ALL {
            assert_eq!(options(&format!("--preset {}", preset.name())), Ok(preset.into()));
        }
    }

    #[test]
    fn hoisting_is_turned_on_or_bent() {
        let hoisting = |line: &str| options(line).unwrap().hoisting.unwrap();
        let usual = BuildOptions::from(Preset::PaperFast).hoisting.unwrap();
        let standard = hoisting("--preset standard --occupancy 0.3");
        assert_eq!(standard, Hoisting::new(0.3, usual.frequency));
        assert_eq!(hoisting("--preset standard --frequency 0"), Hoisting::new(usual.occupancy, 0.0));
        assert_eq!(hoisting("--preset paper-small --frequency 1").occupancy, 0.5);
        assert_eq!(hoisting("--preset standard --rebuild").algorithm, HoistAlgorithm::Rebuild);
    }

    #[test]
    fn leaves_and_splits() {
        let standard = |line: &str| options(&format!("--preset standard {line}")).unwrap();
        assert!(standard("--collapse").collapse);
        let weighed = standard("--byte-weight 0.25 --leaf-at-most 0");
        assert!(weighed.collapse);
        assert_eq!((weighed.byte_weight, weighed.leaf_at_most), (0.25, 0));
        assert_eq!(standard("").layout, Layout::FourByte);
        assert_eq!(standard("--layout two-byte").layout, Layout::TwoByte);
        assert_eq!(standard("--layout dense").layout, Layout::Dense);
        assert_eq!(standard("--max-tree-bytes 1.5MiB").max_tree, Some(TreeBudget::Bytes(3 << 19)));
        assert_eq!(options("--preset slim --max-tree-bytes none").unwrap().max_tree, None);
        assert_eq!(standard("--max-build-bytes 2GB").max_build_bytes, Some(2_000_000_000));
        assert_eq!(standard("--max-tree-bytes 6/tri").max_tree, Some(TreeBudget::BytesPerTriangle(6.0)));
        assert_eq!(standard("--clipping box").clipping, Clipping::Box);
        assert_eq!(standard("--clipping exact").clipping, Clipping::Exact);
        assert_eq!(standard("--clipping 10000").clipping, Clipping::ExactFrom(10_000));
    }

    #[test]
    fn dense_trees_hoist_nothing() {
        let check = |line: &str| {
            let words = std::iter::once("tool").chain(line.split_whitespace());
            Line::try_parse_from(words).unwrap().tree.tuning.check().map_err(|failure| failure.to_string())
        };
        let refused = check("--layout dense --frequency 0.4 --occupancy 0.5 --rebuild").unwrap_err();
        assert!(refused.contains("leave out --occupancy, --frequency and --rebuild"), "{refused}");
        for fine in [
            "--layout dense",
            "--occupancy 0.5",
            "--layout two-byte --rebuild",
            "--preset paper-fast --layout dense",
        ] {
            assert_eq!(check(fine), Ok(()), "{fine}");
        }
    }

    #[test]
    fn splits_are_of_wide_trees() {
        let check = |line: &str| {
            let words = std::iter::once("tool").chain(line.split_whitespace());
            Line::try_parse_from(words).unwrap().tree.tuning.check().map_err(|failure| failure.to_string())
        };
        assert_eq!(check("--layout wide --splits space"), Ok(()));
        assert_eq!(options("--layout wide --splits space").unwrap().splits, Splits::Space);
        assert_eq!(options("--layout wide").unwrap().splits, Splits::Both);
        for wrong in ["--splits space", "--layout dense --splits both"] {
            let refused = check(wrong).unwrap_err();
            assert!(refused.contains("add --layout wide"), "{refused}");
        }
    }

    #[test]
    fn what_is_given_has_names() {
        let line =
            "--rebuild --preset tiny --clipping 40 --sah-traversal 3 --threads 2 --max-build-bytes 1GB";
        let words = std::iter::once("tool").chain(line.split_whitespace());
        let given = Line::try_parse_from(words).unwrap().tree.given();
        assert_eq!(given, ["--preset", "--sah-traversal", "--rebuild", "--clipping"]);
        assert_eq!(listed(&given[..2]), "--preset and --sah-traversal");
    }

    #[test]
    fn what_is_out_of_range_is_refused() {
        for wrong in [
            "--occupancy 1.1",
            "--occupancy -0.1",
            "--frequency nan",
            "--byte-weight -1",
            "--byte-weight inf",
            "--leaf-at-most -1",
            "--layout small",
            "--splits objects",
            "--max-tree-bytes 0",
            "--max-build-bytes none",
            "--max-tree-bytes 5MiBs",
            "--max-tree-bytes -1/tri",
            "--clipping tight",
            "--clipping -3",
            "--sah-traversal 0",
            "--empty-bonus -2",
        ] {
            assert!(options(wrong).is_err(), "{wrong}");
        }
    }
}
