//! The JSON of `slimkd bench`. Its keys are an interface: add, never rename.

use serde::Serialize;

/// What `slimkd bench` measured.
#[derive(Clone, Debug, Default, Serialize)]
pub struct RatesReport {
    /// Rays a second.
    pub results: Vec<Rate>,
    /// Pictures a second, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<Vec<FrameRate>>,
    /// What the scene is warned of, a line each.
    pub warnings: Vec<String>,
}

/// The rate of one tree at one workload.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    /// The tree.
    pub preset: String,
    /// `single`, `packet` or `stream`.
    pub kernel: &'static str,
    /// `cpu` or `gpu`.
    pub device: &'static str,
    /// Of the CPU.
    pub threads: usize,
    /// `primary`, `shadow`, `bounce` or `random`.
    pub workload: &'static str,
    /// Its rays.
    pub rays: usize,
    /// How many of them hit.
    pub hits: usize,
    /// Million rays a second, the median of all rounds.
    pub mrays_per_s: f64,
}

/// The rate of one tree's pictures of one view.
#[derive(Clone, Debug, Serialize)]
pub struct FrameRate {
    /// The tree.
    pub preset: String,
    /// `cpu` or `gpu`.
    pub device: String,
    /// Of the CPU.
    pub threads: usize,
    /// Number of the view.
    pub view: usize,
    /// Pictures a second, by the median of all rounds.
    pub frames_per_s: f64,
}
