//! The raw measurements: all that a page is made of. Keys stay; new ones may come.
//!
//! Whatever two runs on one machine differ in is called `seconds`, `seconds_*` or `date`.

pub(crate) mod published;
mod rates;
mod sizes;

use crate::basics::machine::Machine;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

pub use rates::{FrameRate, Rate, RatesReport};
pub use sizes::{Bytes, Nodes, References};

/// Version of the keys.
pub const SCHEMA: u32 = 1;

/// One report.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Raw {
    /// [`SCHEMA`]
    pub schema: u32,
    /// "slimkd report" and its version.
    pub tool: String,
    /// Day on which the page was made, UTC.
    pub date: String,
    /// Where it ran.
    pub machine: Machine,
    /// What decides what was measured.
    pub options: Options,
    /// In the order of the command line.
    pub scenes: Vec<Scene>,
    /// Builds of one procedural scene at several sizes.
    pub scaling: Vec<ScalingPoint>,
    /// Files of `slimkd-bench --json`, cut to what the plots show.
    pub peers: Vec<Peers>,
    /// The paper's figures, rows by table.
    pub published: Value,
}

/// What was asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    /// Fewer and smaller measurements.
    pub quick: bool,
    /// Edge of the pictures whose rates are measured, pixels.
    pub frame_edge: u32,
    /// Rounds that medians are taken of.
    pub rounds: usize,
    /// Thread counts of frames and builds.
    pub threads: Vec<usize>,
    /// Builds of each tree at each thread count.
    pub builds: usize,
    /// Occupancy thresholds of the sweep.
    pub occupancies: Vec<f32>,
    /// Frequency thresholds of the sweep.
    pub frequencies: Vec<f32>,
    /// Edge of the pictures of the sweep and the ablation, pixels.
    pub sweep_edge: u32,
    /// Edge of the heat maps, pixels.
    pub heat_edge: u32,
    /// Edge of rendered pictures, pixels.
    pub picture_edge: u32,
    /// Sizes of the scaling curve, triangles.
    pub scaling: Vec<u32>,
    /// Seed of the random rays whose cost is counted.
    pub seed: u64,
    /// How many random rays.
    pub random_rays: usize,
}

impl Options {
    /// The full report's, with these thread counts.
    pub fn full(threads: Vec<usize>) -> Self {
        Self {
            quick: false,
            frame_edge: 1024,
            rounds: 5,
            threads,
            builds: 3,
            occupancies: vec![0.1, 0.3, 0.5, 0.7, 0.9],
            frequencies: vec![0.1, 0.3, 0.5, 0.7, 0.9],
            sweep_edge: 256,
            heat_edge: 384,
            picture_edge: 512,
            scaling: vec![31_250, 62_500, 125_000, 250_000, 500_000, 1_000_000],
            seed: 2013,
            random_rays: 20_000,
        }
    }

    /// A report in a fraction of the time, to look at what it is like.
    pub fn quick(threads: Vec<usize>) -> Self {
        Self {
            quick: true,
            frame_edge: 256,
            rounds: 3,
            builds: 1,
            occupancies: vec![0.1, 0.5, 0.9],
            frequencies: vec![0.1, 0.5, 0.9],
            sweep_edge: 96,
            heat_edge: 160,
            picture_edge: 256,
            scaling: vec![8_000, 16_000, 32_000, 64_000],
            random_rays: 5_000,
            ..Self::full(threads)
        }
    }
}

/// One scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Scene {
    /// What it calls itself.
    pub name: String,
    /// xxh3 of its mesh and of what its pictures depend on, hexadecimal.
    pub hash: String,
    /// Degenerate ones included.
    pub triangles: u64,
    /// Of the mesh.
    pub vertices: u64,
    /// Collinear or not finite.
    pub degenerate: u64,
    /// 12 a vertex, 12 a triangle.
    pub mesh_bytes: u64,
    /// True for the very large scene, of which less is measured.
    pub very_large: bool,
    /// The scene of the paper that it is, or is of the kind of.
    pub published: Option<Published>,
    /// From where it is seen.
    pub views: Vec<View>,
    /// The presets' trees.
    pub trees: Vec<Tree>,
    /// Pictures a second.
    pub frames: Vec<Frames>,
    /// Thresholds.
    pub sweep: Vec<SweepRow>,
    /// From `standard` to `tiny`, step by step.
    pub ablation: Option<Ablation>,
    /// What rays cost.
    pub heat: Vec<Heat>,
    /// Rendered pictures.
    pub pictures: Vec<Picture>,
}

/// A scene of the paper.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// Its name there.
    pub name: String,
    /// True where it is the very scene, false where it is of its kind.
    pub same: bool,
}

/// A camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// From 1.
    pub number: usize,
    /// Position.
    pub eye: [f32; 3],
    /// What it looks at.
    pub target: [f32; 3],
    /// Up.
    pub up: [f32; 3],
    /// Vertical field of view, degrees.
    pub fov: f32,
}

/// Size and shape of a tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Nodes by kind.
    pub nodes: Nodes,
    /// References by mode.
    pub references: References,
    /// Bytes by part.
    pub bytes: Bytes,
    /// Of the deepest leaf; the root has depth 0.
    pub max_depth: u32,
    /// Divided by the root's area.
    pub sah_cost: f64,
}

/// A preset's tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tree {
    /// The preset.
    pub name: String,
    /// Size and shape.
    pub shape: Shape,
    /// Leaves by depth.
    pub leaf_depths: Vec<u64>,
    /// Triangles by number of references, in the slides' intervals, with 0 and what is above.
    pub duplication: Vec<Interval>,
    /// The mean of the triangles' longest edges, in the slides' coarser intervals, most references first.
    pub longest_edges: Vec<EdgeInterval>,
    /// Builds.
    pub builds: Vec<Build>,
}

/// Triangles with so many references.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Inclusive.
    pub from: u32,
    /// Inclusive; 4294967295 for no end.
    pub to: u32,
    /// How many.
    pub triangles: u64,
}

/// Triangles with so many references.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeInterval {
    /// Inclusive.
    pub from: u32,
    /// Inclusive; 4294967295 for no end.
    pub to: u32,
    /// How many.
    pub triangles: u64,
    /// Scene units; null for none.
    pub mean_longest_edge: Option<f64>,
}

/// Builds with one number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Build {
    /// How many.
    pub threads: usize,
    /// Wall time of each, with reduction and encoding.
    pub seconds: Vec<f64>,
}

/// Pictures of one view by all presets in turns, compared before any was timed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frames {
    /// Number of the view.
    pub view: usize,
    /// `cpu` or `gpu`.
    pub device: String,
    /// Of the CPU.
    pub threads: usize,
    /// By preset.
    pub presets: Vec<Timed>,
}

/// A tree's times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Timed {
    /// The tree.
    pub name: String,
    /// Of one picture, each round.
    pub seconds: Vec<f64>,
}

/// Trees of one occupancy threshold, and `standard` beside them, in turns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepRow {
    /// The threshold.
    pub occupancy: f32,
    /// Bytes of `standard`.
    pub standard_bytes: u64,
    /// Seconds of its pictures.
    pub standard_seconds: Vec<f64>,
    /// By frequency threshold.
    pub points: Vec<SweepPoint>,
}

/// A tree of the sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepPoint {
    /// The threshold.
    pub frequency: f32,
    /// Size and shape.
    pub shape: Shape,
    /// Seconds of its pictures of view 1.
    pub seconds: Vec<f64>,
}

/// Trees step by step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ablation {
    /// The first is the base.
    pub steps: Vec<AblationStep>,
}

/// One tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AblationStep {
    /// What it is.
    pub name: String,
    /// Size and shape.
    pub shape: Shape,
    /// Seconds of its pictures of view 1.
    pub seconds: Vec<f64>,
}

/// What the camera's rays cost, a picture a preset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Heat {
    /// Number of the view; 0 for random rays through the scene's bounds, which have no picture.
    pub view: usize,
    /// Nodes and tests of a pixel that the scale ends at.
    pub scale_end: u32,
    /// By preset.
    pub presets: Vec<HeatPreset>,
}

/// What rays cost in one tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeatPreset {
    /// The tree.
    pub name: String,
    /// Rays counted.
    pub rays: u64,
    /// Nodes that they visited.
    pub nodes: u64,
    /// Triangles that they were tested against.
    pub tests: u64,
    /// File below the report's folder.
    pub picture: Option<String>,
}

/// A picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Number of the view.
    pub view: usize,
    /// `render`, or `duplication` for triangles coloured by their references.
    pub kind: String,
    /// The tree, where it matters.
    pub tree: Option<String>,
    /// File below the report's folder.
    pub picture: String,
}

/// Builds of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScalingPoint {
    /// The procedural scene.
    pub scene: String,
    /// Triangles.
    pub triangles: u64,
    /// The preset.
    pub tree: String,
    /// By thread count.
    pub builds: Vec<Build>,
}

/// A scene on which libraries were compared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Peers {
    /// The scene.
    pub scene: PeerScene,
    /// Sizes and rates.
    pub points: Vec<PeerPoint>,
}

/// The scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerScene {
    /// What it calls itself.
    pub name: String,
    /// Degenerate ones included.
    pub triangles: u64,
}

/// A library's place in the plane of size and time: one of the `points` of `slimkd-bench --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeerPoint {
    /// The contender's name.
    pub name: String,
    /// How rays were handed over.
    pub interface: String,
    /// Threads that traced.
    pub threads: usize,
    /// Everything added to the bare mesh.
    pub bytes_tree: u64,
    /// Everything that must stay in memory.
    pub bytes_resident: u64,
    /// Million rays a second by workload.
    pub mrays: BTreeMap<String, f64>,
    /// Times as fast as slimkd's `standard` by workload.
    #[serde(default)]
    pub ratio_to_standard: BTreeMap<String, f64>,
    /// Its hits are not trustworthy.
    pub marked: bool,
}
