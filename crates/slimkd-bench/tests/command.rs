//! The program itself: what it prints, what it writes.

#[path = "../../slimkd-cli/tests/suite/common/keys.rs"]
#[allow(unreachable_pub)]
mod keys;

use keys::{keys, set};
use slimkd_lab::bench::report::Report;
use std::process::{Command, Output};

const SMALL: [&str; 12] = [
    "soup",
    "--triangles",
    "200",
    "--size",
    "8",
    "--random-rays",
    "50",
    "--rounds",
    "1",
    "--threads",
    "1",
    "--peers",
];

fn command(more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_slimkd-bench")).args(SMALL).args(more).output().unwrap()
}

#[test]
fn the_table_goes_to_stdout_and_the_figures_to_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figures.json");
    let output = command(&["parry3d", "--json", path.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let report: Report = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    assert!(report.contenders.iter().any(|contender| contender.name == "parry3d"));
    assert!(report.measurements.iter().all(|m| m.seconds.len() == 1));
    let table = String::from_utf8(output.stdout).unwrap();
    for word in ["--camera ", "= resident", "x std", "SMOKE RUN", "hits bit-identical", "T-references at"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("building slimkd-standard") && said.contains("figures.json"), "{said}");
}

/// All keys but those of the processor's extensions, which some have none of. Scripts rely on them: add, never rename.
const KEYS: &str = "schema tool machine.arch machine.cpu machine.gpu machine.optimised machine.os machine.parallelism \
    settings.builds settings.distance settings.grazing settings.isa settings.lift settings.light[] settings.marked_share \
    settings.random_rays settings.rounds settings.seed settings.size settings.t_relative settings.threads[] settings.tile \
    settings.view.eye[] settings.view.fov settings.view.target[] settings.view.up[] scene.mesh_bytes scene.name scene.source \
    scene.triangles scene.vertices workloads[].hits workloads[].kind workloads[].name workloads[].rays \
    contenders[].agreement[].elsewhere contenders[].agreement[].excused contenders[].agreement[].extra \
    contenders[].agreement[].hits contenders[].agreement[].interface contenders[].agreement[].missing \
    contenders[].agreement[].rays contenders[].agreement[].same contenders[].agreement[].workload \
    contenders[].builds[].seconds[] contenders[].builds[].threads contenders[].bytes.copies contenders[].bytes.counted_live \
    contenders[].bytes.counted_peak contenders[].bytes.mesh_read contenders[].bytes.resident contenders[].bytes.source \
    contenders[].bytes.structure contenders[].bytes.tree contenders[].identical contenders[].library contenders[].marked \
    contenders[].name contenders[].sah contenders[].settings contenders[].version skipped[].name skipped[].reason \
    measurements[].contender measurements[].interface measurements[].mrays_per_s measurements[].ratio_to_embree \
    measurements[].ratio_to_packets measurements[].ratio_to_standard measurements[].rays measurements[].seconds[] \
    measurements[].threads measurements[].workload points[].bytes_resident points[].bytes_tree points[].interface \
    points[].marked points[].mrays.bounce points[].mrays.primary points[].mrays.random points[].mrays.shadow points[].name \
    points[].ratio_to_standard.bounce points[].ratio_to_standard.primary points[].ratio_to_standard.random \
    points[].ratio_to_standard.shadow points[].threads";

#[test]
fn the_file_has_exactly_the_documented_keys() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("figures.json");
    let output = command(&["parry3d,embree", "--embree", "no/such/folder", "--json", path.to_str().unwrap()]);
    assert!(output.status.success(), "{output:?}");
    let mut json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
    let machine = json["machine"].as_object_mut().unwrap();
    assert!(machine.remove("detected").is_some() && machine.remove("compiled_for").is_some());
    assert_eq!(keys(&json), set(KEYS));
}

#[test]
fn a_file_that_cannot_be_written_is_refused_before_measuring() {
    let output = command(&["none", "--json", "no/such/folder/figures.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.lines().count() == 1 && said.contains("folder that exists"), "{said}");
}
