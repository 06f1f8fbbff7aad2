//! How a tree is built. The one place for options of the build.

use super::parse::{positive, threads};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use slimkd::{BuildOptions, Preset};
use std::num::NonZeroUsize;

/// Everything that shapes one tree.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Tree")]
pub(crate) struct TreeArgs {
    #[arg(long, value_name = "P", value_parser = preset(), help = preset_help())]
    pub(crate) preset: Option<Preset>,
    #[command(flatten)]
    pub(crate) tuning: TuningArgs,
    /// Threads to work with; all cores unless given. Results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

/// Constants that replace the preset's own.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Tree")]
pub(crate) struct TuningArgs {
    /// Cost of a traversal step in the surface area heuristic; the preset's unless given
    #[arg(long, value_name = "COST", value_parser = positive, allow_negative_numbers = true)]
    sah_traversal: Option<f32>,
    /// Cost of a triangle test in the surface area heuristic; the preset's unless given
    #[arg(long, value_name = "COST", value_parser = positive, allow_negative_numbers = true)]
    sah_intersection: Option<f32>,
    /// Factor on the cost of a split with an empty side: 1 is no bonus; the preset's unless given
    #[arg(long, value_name = "FACTOR", value_parser = positive, allow_negative_numbers = true)]
    empty_bonus: Option<f32>,
}

impl TreeArgs {
    /// True when anything was said about the tree's shape.
    pub(crate) fn is_given(&self) -> bool {
        self.preset.is_some() || self.tuning != TuningArgs::default()
    }

    /// The library's options.
    pub(crate) fn options(&self) -> BuildOptions {
        self.tuning.options(self.preset.unwrap_or_default(), self.threads)
    }
}

impl TuningArgs {
    /// The options of a preset with these constants in place of its own.
    pub(crate) fn options(&self, preset: Preset, threads: Option<NonZeroUsize>) -> BuildOptions {
        let mut options = BuildOptions::from(preset);
        options.threads = threads;
        let set = |value: &mut f32, given: Option<f32>| *value = given.unwrap_or(*value);
        set(&mut options.sah.traversal, self.sah_traversal);
        set(&mut options.sah.intersection, self.sah_intersection);
        set(&mut options.sah.empty_bonus, self.empty_bonus);
        options
    }
}

fn preset_help() -> String {
    format!("Which tree to build; {} unless given", Preset::default().name())
}

/// Parses a preset's name; the error and the help list them all.
pub(crate) fn preset() -> impl TypedValueParser<Value = Preset> {
    PossibleValuesParser::new(Preset::ALL.iter().map(|preset| preset.name()))
        .try_map(|name| Preset::from_name(&name).ok_or("unknown preset"))
}

/// What a ray asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// The nearest hit
    Closest,
    /// Whether there is a hit
    Any,
}
