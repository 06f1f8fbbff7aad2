//! The command line, raw and checked.

use crate::bench::built::Interface;
use crate::bench::variant::Variant;
use crate::workload::Kind;
use anyhow::{Result, ensure};
use clap::{Parser, ValueEnum};
use slimkd::{InstructionSet, Preset};
use slimkd_scene::UpAxis;
use std::path::PathBuf;

/// Measures slimkd beside other ray tracing libraries on one scene, in one run. See docs/benchmarking.md.
#[derive(Clone, Debug, Parser)]
#[command(name = "slimkd-bench", version)]
pub struct Args {
    /// A scene file, the name of a built-in scene, or `soup`: triangles scattered through a cube
    pub scene: String,
    /// Number of triangles of a built-in scene or of `soup`
    #[arg(long)]
    pub triangles: Option<usize>,
    /// slimkd presets, comma-separated; `slimkd-standard` always takes part
    #[arg(long, value_delimiter = ',')]
    pub presets: Option<Vec<String>>,
    /// Another tree, `NAME=PRESET[,KEY=VALUE]…`, any number of times; see docs/benchmarking.md for the keys
    #[arg(long = "variant", value_name = "SPEC")]
    pub variants: Vec<Variant>,
    /// Peers, comma-separated beginnings of names such as `embree,obvhs-cwbvh`; `none` for slimkd alone
    #[arg(long, value_delimiter = ',')]
    pub peers: Option<Vec<String>>,
    /// Take in builds that last absurdly long
    #[arg(long)]
    pub all: bool,
    /// Workloads, comma-separated
    #[arg(long, value_delimiter = ',', value_enum, default_value = "primary,shadow,bounce,random")]
    pub workloads: Vec<Kind>,
    /// Width and height of the picture that the primary rays make
    #[arg(long, default_value_t = 1024)]
    pub size: usize,
    /// Number of random rays
    #[arg(long, default_value_t = 1 << 20)]
    pub random_rays: usize,
    /// Rounds; figures to be quoted need at least 5
    #[arg(long, default_value_t = 5)]
    pub rounds: usize,
    /// Thread counts to trace and build with, comma-separated; by default 1 and all
    #[arg(long, value_delimiter = ',')]
    pub threads: Option<Vec<usize>>,
    /// Builds of each structure at each thread count
    #[arg(long, default_value_t = 1)]
    pub builds: usize,
    /// Camera: `ex,ey,ez,tx,ty,tz[,fov]`, the vertical field of view in degrees
    #[arg(long, allow_hyphen_values = true)]
    pub camera: Option<String>,
    /// Interfaces, comma-separated beginnings of names such as `single,packet`; all are checked, these are timed
    #[arg(long, value_delimiter = ',')]
    pub interfaces: Option<Vec<String>>,
    /// Instruction set of slimkd and of Embree; by default the best that the processor has
    #[arg(long, value_enum)]
    pub isa: Option<Isa>,
    /// Which of the scene's views
    #[arg(long, default_value_t = 1, conflicts_with = "camera")]
    pub view: usize,
    /// Which axis points up, where the scene does not say
    #[arg(long, value_enum)]
    pub up: Option<Up>,
    /// Seed of all random rays and of `soup`
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Embree 4's shared library, or a folder to search for it; also SLIMKD_EMBREE
    #[arg(long)]
    pub embree: Option<PathBuf>,
    /// Write all figures to this file
    #[arg(long)]
    pub json: Option<PathBuf>,
}

/// Instruction sets that slimkd and Embree both have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Isa {
    /// 8 lanes
    Avx2,
    /// 16 lanes
    Avx512,
}

impl From<Isa> for InstructionSet {
    fn from(isa: Isa) -> Self {
        match isa {
            Isa::Avx2 => Self::Avx2,
            Isa::Avx512 => Self::Avx512,
        }
    }
}

/// An axis, as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Up {
    /// +x
    X,
    /// +y
    Y,
    /// +z
    Z,
}

impl From<Up> for UpAxis {
    fn from(up: Up) -> Self {
        match up {
            Up::X => Self::X,
            Up::Y => Self::Y,
            Up::Z => Self::Z,
        }
    }
}

impl Args {
    /// Checks what clap does not.
    pub fn validate(&self) -> Result<()> {
        for (name, value) in [("size", self.size), ("rounds", self.rounds), ("builds", self.builds)] {
            ensure!(value > 0, "--{name} must be at least 1");
        }
        ensure!(self.size <= 1 << 14, "--size must be at most 16384");
        ensure!(!self.workloads.is_empty(), "--workloads names none");
        ensure!(!self.thread_counts().contains(&0), "--threads must be at least 1");
        if let Some(isa) = self.instruction_set() {
            ensure!(isa.is_available(), "--isa {}: this processor lacks it", isa.name());
        }
        if let Some(path) = &self.json {
            // Said before hours of measuring, not after.
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            ensure!(
                folder.is_none_or(|folder| folder.is_dir()) && !path.is_dir(),
                "--json {} cannot be written there; name a file in a folder that exists",
                path.display()
            );
        }
        self.own_trees().map(drop)
    }

    /// The presets to build, `standard` first: it is what others are compared with.
    pub fn chosen_presets(&self) -> Result<Vec<Preset>> {
        let mut presets = vec![Preset::Standard];
        let Some(names) = &self.presets else {
            presets.extend(Preset::ALL.iter().filter(|&&preset| preset != Preset::Standard));
            return Ok(presets);
        };
        for name in names {
            let preset: Preset = name.parse().map_err(|error| anyhow::anyhow!("--presets: {error}"))?;
            if !presets.contains(&preset) {
                presets.push(preset);
            }
        }
        Ok(presets)
    }

    /// The presets and the other trees.
    pub fn own_trees(&self) -> Result<Vec<Variant>> {
        let mut trees: Vec<Variant> = self.chosen_presets()?.into_iter().map(Variant::from).collect();
        for variant in &self.variants {
            ensure!(
                trees.iter().all(|tree| tree.name != variant.name),
                "two trees are called {}",
                variant.name
            );
            trees.push(variant.clone());
        }
        Ok(trees)
    }

    /// Whether a peer of this name takes part.
    pub fn wants_peer(&self, name: &str) -> bool {
        self.peers.as_ref().is_none_or(|wanted| wanted.iter().any(|start| name.starts_with(start.as_str())))
    }

    /// Whether an interface is timed.
    pub fn wants_interface(&self, interface: Interface) -> bool {
        let name = interface.name();
        self.interfaces
            .as_ref()
            .is_none_or(|wanted| wanted.iter().any(|start| name.starts_with(start.as_str())))
    }

    /// What `--isa` asks for.
    pub fn instruction_set(&self) -> Option<InstructionSet> {
        self.isa.map(InstructionSet::from)
    }

    /// Thread counts, ascending, each once.
    pub fn thread_counts(&self) -> Vec<usize> {
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        let mut counts = self.threads.clone().unwrap_or_else(|| vec![1, all]);
        counts.sort_unstable();
        counts.dedup();
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(words: &str) -> Args {
        Args::try_parse_from(["slimkd-bench"].into_iter().chain(words.split(' '))).unwrap()
    }

    #[test]
    fn clap_is_content() {
        use clap::CommandFactory;
        Args::command().debug_assert();
    }

    #[test]
    fn presets_and_peers() {
        assert_eq!(parse("soup").chosen_presets().unwrap().len(), Preset::ALL.len());
        let args = parse("soup --presets paper-small,standard --peers embree,obvhs-cw --threads 2,1,2");
        assert_eq!(args.chosen_presets().unwrap(), [Preset::Standard, Preset::PaperSmall]);
        assert!(args.wants_peer("embree-high") && !args.wants_peer("obvhs-bvh2-medium"));
        assert!(!parse("soup --peers none").wants_peer("bvh"));
        assert_eq!(args.thread_counts(), [1, 2]);
        assert!(parse("soup --presets fast").validate().unwrap_err().to_string().contains("standard"));
    }

    #[test]
    fn impossible_figures_are_refused() {
        for words in [
            "soup --rounds 0",
            "soup --size 0",
            "soup --builds 0",
            "soup --threads 0",
            "soup --json no/such/a.json",
        ] {
            assert!(parse(words).validate().is_err(), "{words}");
        }
        assert!(parse("soup").validate().is_ok());
    }
}
