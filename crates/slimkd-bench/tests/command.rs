//! The program itself: what it prints, what it writes.

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

#[test]
fn a_file_that_cannot_be_written_is_refused_before_measuring() {
    let output = command(&["none", "--json", "no/such/folder/figures.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.lines().count() == 1 && said.contains("folder that exists"), "{said}");
}
