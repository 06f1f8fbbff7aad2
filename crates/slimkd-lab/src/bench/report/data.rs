//! What `--json` writes. Keys stay; new ones may come.

use crate::basics::machine::Machine;
use crate::basics::median::{median, speed_ratios};
use crate::bench::agree::Agreement;
use crate::bench::built::{Bytes, Interface};
use crate::bench::peers::{EMBREE, STANDARD};
use crate::schema::PeerPoint as Point;
use crate::workload::Kind;
use crate::workload::view::View;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the layout.
pub const SCHEMA: u32 = 1;

/// Everything about one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`SCHEMA`]
    pub schema: u32,
    /// "slimkd-bench" and its version.
    pub tool: String,
    /// Where it ran.
    pub machine: Machine,
    /// What was asked.
    pub settings: Settings,
    /// On what.
    pub scene: SceneReport,
    /// The rays.
    pub workloads: Vec<WorkloadReport>,
    /// Who took part.
    pub contenders: Vec<ContenderReport>,
    /// Who did not, and why.
    pub skipped: Vec<Skipped>,
    /// All figures.
    pub measurements: Vec<Measurement>,
    /// One a contender, interface and number of threads: the size/time plane.
    pub points: Vec<Point>,
}

/// Options and constants that decide what was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Width and height of the picture, pixels.
    pub size: usize,
    /// Random rays asked for.
    pub random_rays: usize,
    /// Rounds.
    pub rounds: usize,
    /// Builds a thread count.
    pub builds: usize,
    /// Thread counts.
    pub threads: Vec<usize>,
    /// Seed of bounce and random rays.
    pub seed: u64,
    /// Instruction set that slimkd uses, and with `--isa` Embree too.
    #[serde(default)]
    pub isa: String,
    /// The camera.
    pub view: View,
    /// Where shadow rays go.
    pub light: [f32; 3],
    /// Lift of origins off their surface, scene diagonals.
    pub lift: f64,
    /// Side of a tile of primary rays, pixels.
    pub tile: usize,
    /// Tolerance of t, relative.
    pub t_relative: f64,
    /// Tolerance of t and of distances to an edge, scene diagonals.
    pub distance: f64,
    /// Cosine below which a ray grazes.
    pub grazing: f64,
    /// Share of wrong rays above which a contender is marked.
    pub marked_share: f64,
}

/// The scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneReport {
    /// What it calls itself.
    pub name: String,
    /// What the command line said.
    pub source: String,
    /// Triangles, degenerate ones included.
    pub triangles: u64,
    /// Vertices.
    pub vertices: u64,
    /// Bytes of the bare indexed mesh.
    pub mesh_bytes: u64,
}

/// A set of rays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkloadReport {
    /// `primary`, `shadow`, `bounce` or `random`.
    pub name: String,
    /// `closest` or `any`.
    pub kind: String,
    /// How many.
    pub rays: u64,
    /// How many hit, says slimkd.
    pub hits: u64,
}

/// A contender that was built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContenderReport {
    /// Unique name.
    pub name: String,
    /// The library.
    pub library: String,
    /// Its version.
    pub version: String,
    /// How it is used.
    pub settings: String,
    /// Its cost constants.
    pub sah: String,
    /// Its size.
    pub bytes: ByteReport,
    /// Its builds.
    pub builds: Vec<Build>,
    /// How it compares with the reference, by workload.
    pub agreement: Vec<WorkloadAgreement>,
    /// Wrong in more than the stated share of some workload's rays.
    pub marked: bool,
    /// For slimkd's presets: every hit is the reference's bit by bit.
    pub identical: Option<bool>,
}

/// A size in bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ByteReport {
    /// Nodes, lists, and triangle blocks inside.
    pub structure: u64,
    /// Triangle data beside it.
    pub copies: u64,
    /// The mesh, where tracing reads it.
    pub mesh_read: u64,
    /// structure + copies
    pub tree: u64,
    /// tree + mesh_read
    pub resident: u64,
    /// `exact`, `own-report` or `counted`.
    pub source: String,
    /// What the Rust allocator had live after the build (C and C++ libraries allocate elsewhere).
    pub counted_live: u64,
    /// What it had live at most during the build.
    pub counted_peak: u64,
}

impl ByteReport {
    /// From what a contender says and what was counted.
    pub fn new(bytes: Bytes, counted: slimkd_util::alloc::Counted) -> Self {
        Self {
            structure: bytes.structure,
            copies: bytes.copies,
            mesh_read: bytes.mesh_read,
            tree: bytes.tree(),
            resident: bytes.resident(),
            source: bytes.source.name().into(),
            counted_live: counted.live,
            counted_peak: counted.peak,
        }
    }
}

/// Builds with one number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Build {
    /// Threads; null where the library takes what it likes.
    pub threads: Option<usize>,
    /// Wall-clock seconds of each, from the indexed mesh to something that traces.
    pub seconds: Vec<f64>,
}

/// Agreement on one workload.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkloadAgreement {
    /// The workload's name.
    pub workload: String,
    /// How rays were handed over.
    #[serde(default)]
    pub interface: String,
    /// The counts.
    #[serde(flatten)]
    pub agreement: Agreement,
}

/// Somebody who was left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Skipped {
    /// Who.
    pub name: String,
    /// Why.
    pub reason: String,
}

/// One contender at one workload.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// The contender's name.
    pub contender: String,
    /// How rays were handed over.
    pub interface: String,
    /// The workload's name.
    pub workload: String,
    /// Threads that traced.
    pub threads: usize,
    /// Rays a round.
    pub rays: u64,
    /// Wall-clock seconds of each round.
    pub seconds: Vec<f64>,
    /// Median over the rounds.
    pub mrays_per_s: f64,
    /// Times as fast as slimkd's `standard`: median of the rounds' ratios.
    pub ratio_to_standard: Option<f64>,
    /// Times as fast as Embree MEDIUM, where it took part.
    pub ratio_to_embree: Option<f64>,
    /// Times as fast as Embree MEDIUM's packets: with the coherent flag on primary and shadow rays, else with default flags.
    #[serde(default)]
    pub ratio_to_packets: Option<f64>,
}

impl Measurement {
    /// Derives the rate from the seconds; ratios come from [`Measurement::fill_ratios`].
    pub fn new(
        contender: &str,
        interface: &str,
        workload: &str,
        threads: usize,
        rays: u64,
        seconds: Vec<f64>,
    ) -> Self {
        let rates: Vec<f64> = seconds.iter().map(|s| rays as f64 / 1e6 / s).collect();
        Self {
            contender: contender.into(),
            interface: interface.into(),
            workload: workload.into(),
            threads,
            rays,
            seconds,
            mrays_per_s: median(&rates).unwrap_or(0.0),
            ratio_to_standard: None,
            ratio_to_embree: None,
            ratio_to_packets: None,
        }
    }

    /// Fills the ratios of all, each within its workload, threads and round. The base is the one-call-a-ray interface,
    /// and Embree's packets.
    pub fn fill_ratios(all: &mut [Self]) {
        let bases: Vec<Self> =
            all.iter().filter(|m| m.contender == STANDARD || m.contender == EMBREE).cloned().collect();
        for own in all {
            let ratio = |base: &str, interface: Interface| {
                let base = bases.iter().find(|m| {
                    (m.contender.as_str(), m.interface.as_str()) == (base, interface.name())
                        && m.workload == own.workload
                        && m.threads == own.threads
                })?;
                median(&speed_ratios(&base.seconds, &own.seconds))
            };
            own.ratio_to_standard = ratio(STANDARD, Interface::Single);
            own.ratio_to_embree = ratio(EMBREE, Interface::Single);
            let coherent = [Kind::Primary, Kind::Shadow].iter().any(|kind| kind.name() == own.workload);
            let packets = if coherent { Interface::PacketCoherent } else { Interface::PacketDefault };
            own.ratio_to_packets = ratio(EMBREE, packets);
        }
    }
}

/// All points of a run.
pub fn points(contenders: &[ContenderReport], measurements: &[Measurement]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    for m in measurements {
        let Some(contender) = contenders.iter().find(|c| c.name == m.contender) else { continue };
        let same = |p: &Point| p.name == m.contender && p.interface == m.interface && p.threads == m.threads;
        let index = points.iter().position(same).unwrap_or_else(|| {
            points.push(Point {
                name: m.contender.clone(),
                interface: m.interface.clone(),
                threads: m.threads,
                bytes_tree: contender.bytes.tree,
                bytes_resident: contender.bytes.resident,
                mrays: BTreeMap::new(),
                ratio_to_standard: BTreeMap::new(),
                marked: contender.marked,
            });
            points.len() - 1
        });
        points[index].mrays.insert(m.workload.clone(), m.mrays_per_s);
        if let Some(ratio) = m.ratio_to_standard {
            points[index].ratio_to_standard.insert(m.workload.clone(), ratio);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measurement(name: &str, workload: &str, seconds: &[f64]) -> Measurement {
        Measurement::new(name, "single", workload, 1, 2_000_000, seconds.to_vec())
    }

    #[test]
    fn ratios_stay_within_a_round_and_a_workload() {
        let mut all = [
            measurement(STANDARD, "primary", &[1.0, 4.0, 1.0]),
            measurement("other", "primary", &[0.5, 2.0, 0.5]),
            measurement("other", "random", &[1.0, 1.0, 1.0]),
        ];
        Measurement::fill_ratios(&mut all);
        assert_eq!(all[0].mrays_per_s, 2.0);
        assert_eq!(all[0].ratio_to_standard, Some(1.0));
        assert_eq!(all[1].ratio_to_standard, Some(2.0));
        assert_eq!(all[1].ratio_to_embree, None);
        assert_eq!(all[2].ratio_to_standard, None);
    }
}
