//! Whatever becomes of a process or of its disk, a saved tree is the old one or the new one.
#![cfg(unix)]

use crate::common::{Tool, until};
use std::process::{Command, Stdio};

/// Large enough that writing takes a while.
const SCENE: &str = "building --triangles 20000";

fn read(tool: &Tool, name: &str) -> Vec<u8> {
    std::fs::read(tool.path(name)).unwrap()
}

/// Runs the tool within a limit of the shell.
fn limited(tool: &Tool, limit: &str, line: &str) -> (i32, String) {
    let script = format!("{limit}; exec \"$0\" {line}");
    let output = Command::new("sh")
        .args(["-c", &script, env!("CARGO_BIN_EXE_slimkd")])
        .current_dir(tool.path(""))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    (output.status.code().unwrap_or(-1), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn killed_at_any_moment() {
    let tool = Tool::new();
    tool.ok(&format!("build {SCENE} --preset slim -o old.skd"));
    tool.ok(&format!("build {SCENE} --preset standard -o new.skd"));
    let (old, new) = (read(&tool, "old.skd"), read(&tool, "new.skd"));
    std::fs::copy(tool.path("old.skd"), tool.path("tree.skd")).unwrap();
    // `scripts/kill-loop` does this hundreds of times at random moments.
    for attempt in 0..12 {
        let (preset, other) = if attempt % 2 == 0 { ("standard", &new) } else { ("slim", &old) };
        let before = read(&tool, "tree.skd");
        let mut child = tool.command(&format!("build {SCENE} --preset {preset} -o tree.skd --quiet"));
        let mut child = child.stdout(Stdio::null()).spawn().unwrap();
        // By the work that it has done, so that a slow machine kills at the same places; at once where that cannot be seen.
        let _ = until(&child, |state| state.ticks >= 2 * attempt);
        child.kill().unwrap();
        child.wait().unwrap();
        let after = read(&tool, "tree.skd");
        assert!(after == before || after == *other, "attempt {attempt}");
    }
    tool.ok("inspect tree.skd");
}

#[test]
fn a_full_disk_leaves_the_old_file() {
    let tool = Tool::new();
    tool.ok("build kitchen --triangles 3000 -o tree.skd");
    let (before, files) = (read(&tool, "tree.skd"), tool.files());
    // 8 blocks of 512 bytes: the limit stands for a full disk.
    let (status, error) = limited(&tool, "ulimit -f 8", "build kitchen --triangles 5000 -o tree.skd");
    assert_eq!((status, error.lines().count()), (1, 1), "{error}");
    assert!(error.contains("tree.skd: cannot write") && error.contains("too large"), "{error}");
    assert!(read(&tool, "tree.skd") == before && tool.files() == files);
    let (status, error) = limited(&tool, "true", "build kitchen --triangles 3000 -o /dev/full");
    assert_eq!(status, 1, "{error}");
    assert!(error.contains("/dev/full: cannot write") && error.contains("space"), "{error}");
}

#[test]
fn a_folder_that_cannot_be_written_is_said_at_once() {
    use std::os::unix::fs::PermissionsExt;
    let tool = Tool::new();
    let folder = tool.path("folder");
    std::fs::create_dir(&folder).unwrap();
    tool.ok("build kitchen --triangles 3000 -o folder/tree.skd");
    let before = read(&tool, "folder/tree.skd");
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser may write anyway; then there is nothing to see here.
    if std::fs::write(folder.join("probe"), b"").is_err() {
        tool.fails("build missing.ply -o folder/tree.skd", 1, &["folder/tree.skd", "permission denied"]);
    }
    std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o755)).unwrap();
    assert!(read(&tool, "folder/tree.skd") == before);
    // The kernel's own folder refuses everyone.
    if std::path::Path::new("/proc/self").exists() {
        tool.fails("build missing.ply -o /proc/tree.skd", 1, &["/proc/tree.skd", "cannot write"]);
    }
}
