//! What `build` and `inspect` say about a tree, for scripts and for people.

use crate::trees::{Tree, thread_count};
use crate::ui::{bytes, grouped};
use serde::Serialize;
use slimkd::{HoistAlgorithm, Layout, Splits, TreeStatistics};
use slimkd_lab::measure::savings::{Savings, four_byte};
use slimkd_lab::schema::{self, Nodes, References};
use slimkd_scene::{MeshCheck, Warning};
use std::fmt::Write;
use std::num::NonZeroUsize;

/// Version of the JSON's keys.
const SCHEMA: u32 = 1;

/// The JSON object. Its keys are an interface: add, never rename.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    schema: u32,
    scene: Scene,
    preset: &'static str,
    threads: usize,
    sah: Sah,
    nodes: Nodes,
    references: References,
    bytes: Bytes,
    tree_bytes_per_triangle: f64,
    max_depth: u32,
    sah_cost: f64,
    seconds: Seconds,
    /// What the scene is warned of, a line each; of several files, each line names its own.
    warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh_check: Option<Check>,
    #[serde(skip_serializing_if = "Option::is_none")]
    savings: Option<Savings>,
}

#[derive(Debug, Serialize)]
struct Scene {
    triangles: u64,
    vertices: u64,
    degenerate: u64,
    /// Where in the world the tree's coordinates are 0.
    origin: [f64; 3],
}

#[derive(Debug, Serialize)]
struct Sah {
    traversal: f32,
    intersection: f32,
    empty_bonus: f32,
}

#[derive(Debug, Serialize)]
struct Bytes {
    #[serde(flatten)]
    parts: schema::Bytes,
    /// No layout of today needs a way back to public ids, copies of triangles or coded geometry; scripts expect the keys.
    id_map: u64,
    triangle_copies: u64,
    mesh: u64,
    geometry: u64,
    resident: u64,
    build_peak: Option<u64>,
}

/// What [`MeshCheck`] found.
#[derive(Debug, Serialize)]
struct Check {
    #[serde(flatten)]
    found: MeshCheck,
    coarse: bool,
}

impl Check {
    fn rows(&self, rows: &mut Rows) {
        let Self { found, coarse } = self;
        rows.add(
            "edges",
            format!(
                "{} open, {} of more than two triangles, {} between triangles that face opposite ways",
                grouped(found.open_edges),
                grouped(found.non_manifold_edges),
                grouped(found.flipped_edges)
            ),
        );
        rows.add(
            "triangles",
            format!(
                "{} duplicate, {} degenerate; {} parts",
                grouped(found.duplicate_triangles),
                grouped(found.degenerate_triangles),
                grouped(found.parts)
            ),
        );
        let [low, high] = [found.minimum, found.maximum].map(|[x, y, z]| format!("{x} {y} {z}"));
        let hint = if *coarse {
            let farthest = found.minimum.iter().chain(&found.maximum).fold(0f32, |far, x| far.max(x.abs()));
            format!(
                ": coordinates of {farthest:e} with f32 steps of {}, edges of {:.3e}: georeferenced, or parts far apart? see --origin",
                found.step, found.mean_edge
            )
        } else {
            format!("; f32 steps of {:.1e}, mean edge {:.3e}", found.step, found.mean_edge)
        };
        rows.add("extent", format!("{low} to {high}{hint}"));
    }
}

#[derive(Debug, Serialize)]
struct Seconds {
    load: f64,
    build: Option<f64>,
}

impl Report {
    /// The report on a tree that `threads` threads worked on.
    pub(crate) fn new(tree: &Tree, threads: Option<NonZeroUsize>) -> Self {
        let statistics = &tree.statistics;
        let TreeStatistics { triangles, degenerate, max_depth, sah_cost, .. } = *statistics;
        let memory = tree.tree.memory();
        let options = tree.tree.options();
        Self {
            schema: SCHEMA,
            scene: Scene {
                triangles,
                vertices: tree.tree.mesh().vertices().len() as u64,
                degenerate,
                origin: tree.tree.mesh().origin(),
            },
            preset: options.preset.name(),
            threads: thread_count(threads),
            sah: Sah {
                traversal: options.sah.traversal,
                intersection: options.sah.intersection,
                empty_bonus: options.sah.empty_bonus,
            },
            nodes: statistics.into(),
            references: statistics.into(),
            bytes: Bytes {
                parts: (&memory).into(),
                id_map: 0,
                triangle_copies: 0,
                mesh: memory.mesh,
                geometry: 0,
                resident: memory.resident(),
                build_peak: tree.cost.map(|cost| cost.peak),
            },
            tree_bytes_per_triangle: memory.tree() as f64 / triangles.max(1) as f64,
            max_depth,
            sah_cost,
            seconds: Seconds { load: tree.origin.load_seconds, build: tree.cost.map(|cost| cost.seconds) },
            warnings: Vec::new(),
            mesh_check: None,
            savings: None,
        }
    }

    /// The report with what the scene is warned of.
    pub(crate) fn with_warnings<'a>(self, warnings: impl Iterator<Item = &'a Warning>) -> Self {
        Self { warnings: warnings.map(Warning::to_string).collect(), ..self }
    }

    /// The report with what is wrong with the mesh.
    pub(crate) fn with_mesh_check(self, check: &MeshCheck) -> Self {
        let check = Check { found: *check, coarse: check.is_coarse() };
        Self { mesh_check: Some(check), ..self }
    }

    /// The report with what makes the tree small.
    pub(crate) fn with_savings(self, savings: Option<Savings>) -> Self {
        Self { savings, ..self }
    }

    /// The report as a table.
    pub(crate) fn table(&self, tree: &Tree) -> String {
        let Self { scene, sah, nodes, references, bytes: size, seconds, .. } = self;
        let per_triangle = |count: u64| count as f64 / scene.triangles.max(1) as f64;
        let mut rows = Rows::default();
        rows.add(
            "scene",
            format!(
                "{}: {} triangles ({} degenerate), {} vertices",
                tree.origin.name,
                grouped(scene.triangles),
                grouped(scene.degenerate),
                grouped(scene.vertices)
            ),
        );
        if let Some(check) = &self.mesh_check {
            check.rows(&mut rows);
        }
        rows.add(
            "preset",
            format!(
                "{} (SAH costs {} a step, {} a triangle, empty bonus {})",
                self.preset, sah.traversal, sah.intersection, sah.empty_bonus
            ),
        );
        rows.add("options", choices(tree));
        rows.add(
            "nodes",
            format!(
                "{} inner, {} inner with a T-reference, {} leaves ({} empty)",
                grouped(nodes.inner),
                grouped(nodes.t_inner),
                grouped(nodes.leaf),
                grouped(nodes.empty_leaf)
            ),
        );
        rows.add(
            "references",
            format!(
                "{} in 4-byte leaves, {} in 2-byte leaves, {} in others, {} T-references; {:.2} a triangle",
                grouped(references.leaf_4byte),
                grouped(references.leaf_2byte),
                grouped(references.leaf_other),
                grouped(references.t),
                tree.statistics.redundancy()
            ),
        );
        rows.add("depth", format!("{} at most; SAH cost {:.1}", self.max_depth, self.sah_cost));
        for (name, count) in [
            ("nodes", size.parts.nodes),
            ("T-references", size.parts.t_references),
            ("indices", size.parts.indices),
            ("other", size.parts.other),
        ] {
            if count > 0 {
                rows.add(&format!("  {name}"), amount(count, per_triangle(count)));
            }
        }
        rows.add("tree", amount(size.parts.tree, per_triangle(size.parts.tree)));
        rows.add("mesh", amount(size.mesh, per_triangle(size.mesh)));
        rows.add("resident", amount(size.resident, per_triangle(size.resident)));
        if let Some(peak) = size.build_peak {
            rows.add("build peak", format!("{} above the mesh", amount(peak, per_triangle(peak))));
        }
        let built = seconds.build.map_or_else(String::new, |build| {
            let rate = scene.triangles as f64 / build.max(1e-9) / 1e3;
            format!(", build {build:.3} s on {} threads ({rate:.0} k triangles/s)", self.threads)
        });
        rows.add("time", format!("load {:.3} s{built}", seconds.load));
        rows.finish()
            + &self.savings.map_or_else(String::new, |savings| savings_table(&savings, scene.triangles))
    }
}

/// Lines below the table.
fn savings_table(savings: &Savings, triangles: u64) -> String {
    let per_triangle = |bytes: u64| bytes as f64 / triangles.max(1) as f64;
    let Savings { baseline, hoisting, collapse, layout } = *savings;
    let mut rows = Rows::default();
    rows.add("standard-style", amount(baseline, per_triangle(baseline)));
    for (step, saved) in [("hoisting", hoisting), ("collapse", collapse), ("layout", layout)] {
        let sign = if saved < 0 { '+' } else { '-' };
        let size = saved.unsigned_abs();
        let share = 100.0 * size as f64 / baseline.max(1) as f64;
        let amount = amount(size, per_triangle(size));
        rows.add(&format!("{sign} {step}"), format!("{amount}  {share:>5.1} % of it"));
    }
    rows.finish()
}

/// The line that stands for the savings where nothing was built for them.
pub(crate) fn savings_hint(statistics: &TreeStatistics, bytes: u64) -> String {
    let mut rows = Rows::default();
    let by_layout = crate::ui::bytes(four_byte(statistics).saturating_sub(bytes));
    rows.add(
        "savings",
        format!("{by_layout} by the layout; --savings builds again to show the rest, each apart"),
    );
    rows.finish()
}

/// What a tree was built with, costs aside.
fn choices(tree: &Tree) -> String {
    let options = tree.tree.options();
    let mut out = match &options.hoisting {
        None => "no hoisting".to_owned(),
        Some(hoisting) => format!(
            "hoisting above occupancy {}, frequency {} ({})",
            hoisting.occupancy,
            hoisting.frequency,
            match hoisting.algorithm {
                HoistAlgorithm::Rebuild => "rebuilt",
                _ => "stripped",
            }
        ),
    };
    out.push_str(match (options.collapse, options.byte_weight > 0.0) {
        (false, _) => ", no collapse",
        (true, false) => ", collapse",
        (true, true) => ", collapse at byte weight ",
    });
    if options.collapse && options.byte_weight > 0.0 {
        let _ = write!(out, "{}", options.byte_weight);
    }
    out.push_str(match options.layout {
        Layout::FourByte => ", 4-byte leaves alone",
        Layout::TwoByte => ", 2-byte leaves",
        // Whatever the dense layout cannot hold is written like that.
        Layout::Dense if tree.statistics.leaf_references.other == 0 => {
            ", 2-byte leaves (the dense layout cannot hold it)"
        }
        Layout::Wide if tree.statistics.leaf_references.other == 0 => {
            ", 2-byte leaves (the wide layout cannot hold it)"
        }
        Layout::Wide if options.splits == Splits::Space => ", wide layout, split by planes alone",
        Layout::Wide => ", wide layout",
        _ => ", dense layout",
    });
    out
}

/// Triangles by their number of references and leaves by depth, as the paper's slides show them.
pub(crate) fn histograms(statistics: &TreeStatistics) -> String {
    let mut out = String::from("\nreferences of a triangle   triangles\n");
    for (&(low, high), &count) in TreeStatistics::DUPLICATION_INTERVALS.iter().zip(&statistics.duplication) {
        if count > 0 {
            let interval = match (low, high) {
                (low, high) if low == high => low.to_string(),
                (low, u32::MAX) => format!("{low} and more"),
                _ => format!("{low} to {high}"),
            };
            let _ = writeln!(out, "{interval:<24} {:>11}", grouped(count));
        }
    }
    out.push_str("\ndepth of a leaf               leaves\n");
    for (depth, &count) in statistics.leaf_depths.iter().enumerate() {
        if count > 0 {
            let _ = writeln!(out, "{depth:<24} {:>11}", grouped(count));
        }
    }
    out
}

/// Bytes, and bytes a triangle.
fn amount(count: u64, per_triangle: f64) -> String {
    format!("{:>10}  {per_triangle:8.2} B/triangle", bytes(count))
}

/// Lines of a name and a value.
#[derive(Default)]
struct Rows(String);

impl Rows {
    /// Adds a line.
    fn add(&mut self, name: &str, value: impl std::fmt::Display) {
        let _ = writeln!(self.0, "{name:<18} {value}");
    }

    /// The lines.
    fn finish(self) -> String {
        self.0
    }
}
