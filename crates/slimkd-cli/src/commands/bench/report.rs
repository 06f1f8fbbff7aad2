//! What `bench` says.

use crate::args::Size;
use crate::ui::grouped;
use serde::Serialize;
use std::fmt::Write;

/// The JSON object. Its keys are an interface: add, never rename.
#[derive(Default, Serialize)]
pub(super) struct Report {
    pub(super) results: Vec<Rate>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) frames: Option<Vec<FrameRate>>,
}

#[derive(Serialize)]
pub(super) struct Rate {
    pub(super) preset: String,
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
    pub(super) preset: String,
    pub(super) device: &'static str,
    pub(super) threads: usize,
    pub(super) view: usize,
    pub(super) frames_per_s: f64,
}

impl Report {
    /// Rates a workload, each beside its share of the first preset's; pictures of `size`.
    pub(super) fn table(&self, size: Size) -> String {
        let mut out = String::new();
        let mut group = None;
        let mut base = f64::NAN;
        for rate in &self.results {
            let of = (rate.workload, rate.device, rate.threads);
            if group != Some(of) {
                (group, base) = (Some(of), rate.mrays_per_s);
                let share = 100.0 * rate.hits as f64 / rate.rays.max(1) as f64;
                let _ = writeln!(
                    out,
                    "{} ({} rays, {share:.1} % hit, {})",
                    rate.workload,
                    grouped(rate.rays as u64),
                    place(rate.device, rate.threads)
                );
            }
            let (rate, preset) = (rate.mrays_per_s, &rate.preset);
            let _ = writeln!(out, "  {preset:<12} {rate:>9.3} Mrays/s {:>7.3} x", rate / base);
        }
        let mut group = None;
        for frame in self.frames.iter().flatten() {
            let of = (frame.view, frame.device, frame.threads);
            if group != Some(of) {
                (group, base) = (Some(of), frame.frames_per_s);
                let _ = writeln!(
                    out,
                    "view {}, {} ({} x {}, 1 sample a pixel, no ambient occlusion; in brackets: degradation)",
                    frame.view,
                    place(frame.device, frame.threads),
                    size.width,
                    size.height
                );
            }
            let (rate, preset) = (frame.frames_per_s, &frame.preset);
            // As in the paper: 0.867 frames/s to 0.794 are 9.2 %.
            let loss = 100.0 * (base / rate - 1.0);
            let _ = writeln!(out, "  {preset:<12} {rate:>9.3} frames/s {:>10}", format!("({loss:.1} %)"));
        }
        out
    }
}

fn place(device: &str, threads: usize) -> String {
    match (device, threads) {
        ("gpu", _) => "GPU".to_owned(),
        (_, 1) => "1 thread".to_owned(),
        _ => format!("{threads} threads"),
    }
}
