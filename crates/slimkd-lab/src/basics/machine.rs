//! What the figures were measured on.

use serde::{Deserialize, Serialize};

/// The machine and how this program was compiled for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Operating system.
    pub os: String,
    /// Architecture.
    pub arch: String,
    /// The processor's name for itself, where the system tells.
    pub cpu: Option<String>,
    /// The GPU that rendered, where one did.
    #[serde(default)]
    pub gpu: Option<String>,
    /// Threads that may run at once.
    pub parallelism: usize,
    /// Vector extensions that the processor has, of those that matter here.
    pub detected: Vec<String>,
    /// Those that this program, and so every peer in Rust, was compiled for. Embree and slimkd choose while running.
    pub compiled_for: Vec<String>,
    /// False in a build with debug assertions: its figures mean nothing.
    pub optimised: bool,
}

macro_rules! features {
    ($($feature:tt),*) => {{
        #[cfg(target_arch = "x86_64")]
        let detected = [$(($feature, std::arch::is_x86_feature_detected!($feature))),*];
        #[cfg(not(target_arch = "x86_64"))]
        let detected = [$(($feature, false)),*];
        let compiled = [$(($feature, cfg!(target_feature = $feature))),*];
        let names = |list: &[(&str, bool)]| {
            list.iter().filter(|entry| entry.1).map(|entry| entry.0.to_owned()).collect::<Vec<_>>()
        };
        (names(&detected), names(&compiled))
    }};
}

impl Machine {
    /// This one.
    pub fn here() -> Self {
        let (detected, compiled_for) = features!("sse4.2", "avx", "avx2", "fma", "avx512f", "avx512vl");
        let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let cpu = information
            .lines()
            .find_map(|line| line.strip_prefix("model name"))
            .map(|rest| rest.trim_start_matches([' ', '\t', ':']).to_owned());
        Self {
            os: std::env::consts::OS.to_owned(),
            arch: std::env::consts::ARCH.to_owned(),
            cpu,
            gpu: None,
            parallelism: std::thread::available_parallelism().map_or(1, usize::from),
            detected,
            compiled_for,
            optimised: !cfg!(debug_assertions),
        }
    }
}
