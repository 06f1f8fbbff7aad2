//! The report as text for a terminal.

use super::{ContenderReport, Measurement, Report};
use crate::basics::median::median;
use crate::bench::agree::{Agreement, MARKED_SHARE};
use crate::bench::built::Interface;
use crate::bench::peers::{EMBREE, STANDARD};
use std::fmt::Write as _;

/// Columns of text, the first to the left and the rest to the right, as wide as they must be.
struct Grid(Vec<Vec<String>>);

impl Grid {
    fn new(head: &[&str]) -> Self {
        Self(vec![head.iter().map(|&cell| cell.to_owned()).collect()])
    }

    fn print(&self, out: &mut String) {
        let columns = self.0[0].len();
        let width = |k: usize| self.0.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for row in &self.0 {
            let mut line = format!("{:<1$}", row[0], widths[0]);
            for (cell, width) in row.iter().zip(&widths).skip(1) {
                let _ = write!(line, "  {cell:>width$}");
            }
            let _ = writeln!(out, "{}", line.trim_end());
        }
        out.push('\n');
    }
}

fn figure(value: Option<f64>) -> String {
    match value {
        None => "-".into(),
        Some(x) if x < 10.0 => format!("{x:.2}"),
        Some(x) if x < 100.0 => format!("{x:.1}"),
        Some(x) => format!("{x:.0}"),
    }
}

/// The whole report.
pub fn table(report: &Report) -> String {
    let mut out = String::new();
    head(report, &mut out);
    contenders(report, &mut out);
    agreement(report, &mut out);
    for &threads in &report.settings.threads {
        rates(report, threads, &mut out);
    }
    let _ = writeln!(
        out,
        "x std: times as fast as {STANDARD}; x emb: as {EMBREE}; medians of the rounds' ratios\n"
    );
    for contender in &report.contenders {
        let ContenderReport { name, library, version, settings, sah, .. } = contender;
        let _ = writeln!(out, "{name}: {library} {version}; {settings}. SAH: {sah}.");
    }
    for skipped in &report.skipped {
        let _ = writeln!(out, "skipped {}: {}", skipped.name, skipped.reason);
    }
    out
}

fn head(report: &Report, out: &mut String) {
    let (scene, machine, settings) = (&report.scene, &report.machine, &report.settings);
    let _ = writeln!(
        out,
        "{}: {} triangles, {} vertices, mesh {:.1} B/tri. {}, {} threads; compiled for {}.",
        scene.name,
        scene.triangles,
        scene.vertices,
        scene.mesh_bytes as f64 / scene.triangles.max(1) as f64,
        machine.cpu.as_deref().unwrap_or("unknown processor"),
        machine.parallelism,
        if machine.compiled_for.is_empty() { "the baseline".into() } else { machine.compiled_for.join(" ") },
    );
    let [from, to] = [settings.view.eye, settings.view.target].map(|p| format!("{},{},{}", p[0], p[1], p[2]));
    let _ = writeln!(out, "camera: --camera {from},{to},{}", settings.view.fov);
    for workload in &report.workloads {
        let share = 100.0 * workload.hits as f64 / workload.rays.max(1) as f64;
        let _ = writeln!(
            out,
            "{}: {} rays, {} hit asked, {share:.1} % hit",
            workload.name, workload.rays, workload.kind
        );
    }
    if settings.rounds < 5 || !machine.optimised {
        let _ =
            writeln!(out, "A SMOKE RUN (few rounds or debug assertions): its figures are not to be quoted.");
    }
    let has = |list: &[String]| list.iter().any(|feature| feature == "avx2");
    if has(&machine.detected) && !has(&machine.compiled_for) {
        let _ = writeln!(
            out,
            "The peers in Rust are compiled without AVX2, which this processor has: build with \
             RUSTFLAGS=\"-C target-cpu=native\" before quoting them."
        );
    }
    out.push('\n');
}

fn contenders(report: &Report, out: &mut String) {
    let threads = &report.settings.threads;
    let builds: Vec<String> = threads.iter().map(|n| format!("build s, {n} thr")).collect();
    let mut titles =
        vec!["bytes a triangle", "structure", "+ copies", "= tree", "+ mesh read", "= resident", "source"];
    titles.extend(builds.iter().map(String::as_str));
    let mut grid = Grid::new(&titles);
    for contender in &report.contenders {
        let bytes = &contender.bytes;
        let each = |bytes: u64| figure(Some(bytes as f64 / report.scene.triangles.max(1) as f64));
        let mut row = vec![
            contender.name.clone(),
            each(bytes.structure),
            each(bytes.copies),
            each(bytes.tree),
            each(bytes.mesh_read),
            each(bytes.resident),
            bytes.source.clone(),
        ];
        for n in threads {
            let own = contender.builds.iter().find(|build| build.threads == Some(*n));
            let free = contender.builds.iter().find(|build| build.threads.is_none());
            row.push(match (own, free) {
                (Some(build), _) => figure(median(&build.seconds)),
                (None, Some(build)) => format!("{}*", figure(median(&build.seconds))),
                (None, None) => "-".into(),
            });
        }
        grid.0.push(row);
    }
    grid.print(out);
    if report.contenders.iter().flat_map(|c| &c.builds).any(|build| build.threads.is_none()) {
        out.push_str("* takes as many threads as it likes\n\n");
    }
}

fn agreement(report: &Report, out: &mut String) {
    let mut titles = vec!["wrong + excused rays"];
    titles.extend(report.workloads.iter().map(|workload| workload.name.as_str()));
    let mut grid = Grid::new(&titles);
    for contender in report.contenders.iter().filter(|c| c.identical != Some(true)) {
        let mut interfaces: Vec<&str> = Vec::new();
        for a in &contender.agreement {
            if !interfaces.contains(&a.interface.as_str()) {
                interfaces.push(&a.interface);
            }
        }
        for interface in interfaces {
            let mut row = vec![through(contender, interface)];
            for workload in &report.workloads {
                let counts = contender
                    .agreement
                    .iter()
                    .find(|a| (&a.workload, a.interface.as_str()) == (&workload.name, interface));
                let text = |a: &Agreement| format!("{} + {}", a.wrong(), a.excused);
                row.push(counts.map_or("-".into(), |a| text(&a.agreement)));
            }
            grid.0.push(row);
        }
    }
    if grid.0.len() > 1 {
        grid.print(out);
    }
    let identical: Vec<&str> =
        report.contenders.iter().filter(|c| c.identical == Some(true)).map(|c| c.name.as_str()).collect();
    let _ = writeln!(out, "hits bit-identical to those of {STANDARD}: {}", identical.join(", "));
    if report.contenders.iter().any(|c| c.marked) {
        let _ = writeln!(out, "! wrong in more than {MARKED_SHARE:e} of some workload's rays");
    }
    out.push('\n');
}

fn mark(contender: &ContenderReport) -> String {
    format!("{}{}", contender.name, if contender.marked { " !" } else { "" })
}

/// A contender, and how rays are handed to it unless it is one call a ray.
fn through(contender: &ContenderReport, interface: &str) -> String {
    let name = mark(contender);
    if interface == Interface::Single.name() { name } else { format!("{name} {interface}") }
}

fn rates(report: &Report, threads: usize, out: &mut String) {
    let has_embree = report.contenders.iter().any(|c| c.name == EMBREE);
    let first = format!("{threads} thread{}", if threads == 1 { "" } else { "s" });
    let mut titles = vec![first];
    for workload in &report.workloads {
        titles.push(format!("{} Mrays/s", workload.name));
        titles.push("x std".into());
        if has_embree {
            titles.push("x emb".into());
            titles.push("x pkt".into());
        }
    }
    let mut grid = Grid::new(&titles.iter().map(String::as_str).collect::<Vec<_>>());
    let mut rows: Vec<(&ContenderReport, &str)> = Vec::new();
    for contender in &report.contenders {
        for m in report.measurements.iter().filter(|m| m.contender == contender.name) {
            if !rows.iter().any(|row| row.0.name == contender.name && row.1 == m.interface) {
                rows.push((contender, &m.interface));
            }
        }
    }
    for (contender, interface) in rows {
        let mut row = vec![through(contender, interface)];
        for workload in &report.workloads {
            let found = report.measurements.iter().find(|m: &&Measurement| {
                (&m.contender, &m.workload) == (&contender.name, &workload.name)
                    && m.interface == interface
                    && m.threads == threads
            });
            row.push(figure(found.map(|m| m.mrays_per_s)));
            row.push(figure(found.and_then(|m| m.ratio_to_standard)));
            if has_embree {
                row.push(figure(found.and_then(|m| m.ratio_to_embree)));
                row.push(figure(found.and_then(|m| m.ratio_to_packets)));
            }
        }
        grid.0.push(row);
    }
    grid.print(out);
}
