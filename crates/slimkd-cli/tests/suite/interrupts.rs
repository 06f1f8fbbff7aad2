//! Ctrl-C, and readers that hang up.
#![cfg(unix)]

use crate::common::{State, Tool, until};
use std::fs::File;
use std::process::{Command, Stdio};

/// Processor time after which the tool is at work, ticks of usually 10 ms.
const AT_WORK: u64 = 20;

/// Sends Ctrl-C into work that takes much longer than the test.
fn interrupted(line: &str) {
    let tool = Tool::new();
    let mut child = tool.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let Some(()) = until(&child, |state: &State| state.listens && state.ticks >= AT_WORK) else {
        println!("skipped: no /proc");
        child.kill().unwrap();
        child.wait().unwrap();
        return;
    };
    assert!(child.try_wait().unwrap().is_none(), "{line} was too quick for this test");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(130), "{line}: {stderr}");
    assert!(stderr.ends_with("slimkd: error: interrupted\n"), "{stderr}");
    assert!(tool.files().is_empty(), "{line} left {:?}", tool.files());
}

#[test]
fn a_build_leaves_nothing() {
    interrupted("build kitchen --triangles 4000000 -o tree.skd");
}

#[test]
fn a_picture_leaves_nothing() {
    interrupted("render kitchen --triangles 3000 --size 8192x8192 --spp 64 -o out.png");
}

#[test]
fn a_trace_leaves_nothing() {
    // Zeros are rays that miss, without end.
    interrupted("trace kitchen --triangles 3000 --rays /dev/zero --out hits.bin");
}

#[test]
fn a_bench_stops() {
    interrupted("bench kitchen --triangles 3000 --rays 1000000 --rounds 1000");
}

#[test]
fn a_scene_leaves_nothing() {
    interrupted("scene kitchen --triangles 50000000 -o scene.ply");
}

#[test]
fn a_reader_that_hangs_up_is_no_failure() {
    let tool = Tool::new();
    for line in [
        "completions bash",
        "scene --list",
        "build kitchen --triangles 3000 --json",
        "inspect kitchen --triangles 3000",
        "--help",
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = tool.command(line).stdout(writer).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_full_disk_is_one() {
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    let tool = Tool::new();
    let output = tool.command("scene --list").stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("slimkd: error: stdout"));
}
