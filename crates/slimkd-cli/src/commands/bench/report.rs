//! What `bench` says.

use serde::Serialize;
use std::fmt::Write;

/// The JSON object. Its keys are an interface: add, never rename.
#[derive(Serialize)]
pub(super) struct Report {
    pub(super) results: Vec<Rate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frames: Option<Vec<FrameRate>>,
}

#[derive(Serialize)]
pub(super) struct Rate {
    pub(super) preset: &'static str,
    pub(super) kernel: &'static str,
    pub(super) device: &'static str,
    pub(super) threads: usize,
    pub(super) workload: &'static str,
    pub(super) rays: usize,
    pub(super) hits: usize,
    pub(super) mrays_per_s: f64,
}

#[derive(Serialize)]
pub(super) struct FrameRate {
    pub(super) preset: &'static str,
    pub(super) device: &'static str,
    pub(super) threads: usize,
    pub(super) view: usize,
    pub(super) frames_per_s: f64,
}

impl Report {
    /// Rates a workload, each beside its share of the first preset's.
    pub(super) fn table(&self) -> String {
        let mut out = String::new();
        let mut workload = "";
        let mut base = f64::NAN;
        for rate in &self.results {
            if rate.workload != workload {
                (workload, base) = (rate.workload, rate.mrays_per_s);
                let share = 100.0 * rate.hits as f64 / rate.rays.max(1) as f64;
                let _ = writeln!(
                    out,
                    "{workload} ({} rays, {share:.1} % hit)",
                    crate::ui::grouped(rate.rays as u64)
                );
            }
            let (rate, preset) = (rate.mrays_per_s, rate.preset);
            let _ = writeln!(out, "  {preset:<12} {rate:>9.3} Mrays/s {:>7.3} x", rate / base);
        }
        let mut view = 0;
        for frame in self.frames.iter().flatten() {
            if frame.view != view {
                (view, base) = (frame.view, frame.frames_per_s);
                let _ = writeln!(
                    out,
                    "pictures of view {view} (1024 x 1024, 1 sample a pixel, no ambient occlusion)"
                );
            }
            let (rate, preset) = (frame.frames_per_s, frame.preset);
            let _ = writeln!(out, "  {preset:<12} {rate:>9.3} frames/s {:>6.3} x", rate / base);
        }
        out
    }
}
