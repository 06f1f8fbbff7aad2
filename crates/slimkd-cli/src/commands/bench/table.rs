//! What `bench` says to people.

use crate::args::Size;
use crate::ui::grouped;
use slimkd_lab::schema::RatesReport;
use std::fmt::Write;

/// Rates a workload, each beside its share of the first preset's; pictures of `size`.
pub(super) fn table(report: &RatesReport, size: Size) -> String {
    let mut out = String::new();
    let mut group = None;
    let mut base = f64::NAN;
    for rate in &report.results {
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
    for frame in report.frames.iter().flatten() {
        let of = (frame.view, frame.device.as_str(), frame.threads);
        if group != Some(of) {
            (group, base) = (Some(of), frame.frames_per_s);
            let _ = writeln!(
                out,
                "view {}, {} ({} x {}, 1 sample a pixel, no ambient occlusion; in brackets: degradation)",
                frame.view,
                place(&frame.device, frame.threads),
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

fn place(device: &str, threads: usize) -> String {
    match (device, threads) {
        ("gpu", _) => "GPU".to_owned(),
        (_, 1) => "1 thread".to_owned(),
        _ => format!("{threads} threads"),
    }
}
