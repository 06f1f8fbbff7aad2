//! What is wrong with the input or the command line is said in one line, with the right exit status.

mod common;

use common::{Tool, ply, square};

const SCENE_COMMANDS: &[&str] = &[
    "build {} --json",
    "inspect {} --json",
    "render {} --size 8x8",
    "bench {} --rays 100",
    "trace {} --rays none.f32 --out hits.bin",
];

/// Tries `scene` with every command that takes one, and checks that no file appeared.
fn refused(tool: &Tool, scene: &str, words: &[&str]) {
    tool.file("none.f32", b"");
    let before = tool.files();
    for command in SCENE_COMMANDS {
        tool.fails(&command.replace("{}", scene), 1, words);
    }
    assert_eq!(tool.files(), before);
}

#[test]
fn missing_files_and_unknown_names() {
    let tool = Tool::new();
    refused(&tool, "nothing.ply", &["nothing.ply", "neither a file nor a built-in scene"]);
    refused(&tool, "kitchn", &["kitchn", "take one of kitchen"]);
    tool.fails("scene kitchn -o a.ply", 1, &["kitchn", "kitchen"]);
}

#[test]
fn empty_truncated_and_foreign_files() {
    let tool = Tool::new();
    tool.file("empty.ply", b"");
    refused(&tool, "empty.ply", &["empty.ply", "empty"]);
    tool.file("magic.ply", square().replacen("ply", "plx", 1));
    refused(&tool, "magic.ply", &["magic.ply"]);
    let whole = square();
    tool.file("short.ply", &whole[..whole.len() - 12]);
    refused(&tool, "short.ply", &["short.ply"]);
    tool.file("text.txt", b"hello");
    refused(&tool, "text.txt", &["text.txt", ".ply"]);
    tool.file("noise.ply.zst", b"this is not zstd");
    refused(&tool, "noise.ply.zst", &["noise.ply.zst"]);

    tool.ok("scene kitchen --triangles 3000 -o kitchen.ply");
    let bytes = std::fs::read(tool.path("kitchen.ply")).unwrap();
    tool.file("cut.ply", &bytes[..bytes.len() / 2]);
    refused(&tool, "cut.ply", &["cut.ply"]);
}

#[test]
fn lies_about_counts_and_indices() {
    let tool = Tool::new();
    let huge = square().replacen("vertex 4", "vertex 1152921504606846976", 1);
    tool.file("huge.ply", huge);
    refused(&tool, "huge.ply", &["huge.ply"]);
    tool.file("range.ply", ply(&["0 0 0", "1 0 0", "0 1 0"], &["3 0 1 3"]));
    refused(&tool, "range.ply", &["range.ply"]);
}

#[test]
fn scenes_without_a_valid_triangle() {
    let tool = Tool::new();
    tool.file("none.ply", ply(&["0 0 0"], &[]));
    refused(&tool, "none.ply", &["none", "no triangle"]);
    tool.file("line.ply", ply(&["0 0 0", "1 1 1", "2 2 2"], &["3 0 1 2", "3 0 0 1"]));
    refused(&tool, "line.ply", &["line", "all 2 triangles are collinear or not finite"]);
    tool.file("nan.ply", ply(&["nan 0 0", "1 1 1", "2 2 2"], &["3 0 1 2"]));
    refused(&tool, "nan.ply", &["nan", "all 1 triangles are collinear or not finite"]);
}

#[test]
fn broken_triangles_among_good_ones_are_counted() {
    let tool = Tool::new();
    let vertices = ["0 0 0", "1 0 0", "0 1 0", "nan 0 0", "2 0 0", "inf 1 1"];
    tool.file("some.ply", ply(&vertices, &["3 0 1 3", "3 0 1 2", "3 0 1 4", "3 5 1 2"]));
    let json = tool.json("build some.ply --json");
    assert_eq!(json["scene"]["triangles"], 4);
    assert_eq!(json["scene"]["degenerate"], 3);
    for command in
        ["build some.ply", "inspect some.ply", "render some.ply --size 8x8", "bench some.ply --rays 64"]
    {
        assert!(tool.ok(command).stderr.contains("3 of 4 triangles"), "{command}");
    }
    assert_eq!(tool.ok("build some.ply --quiet").stderr, "");
}

#[test]
fn directories() {
    let tool = Tool::new();
    std::fs::create_dir(tool.path("folder.ply")).unwrap();
    refused(&tool, "folder.ply", &["folder.ply"]);
    std::fs::create_dir(tool.path("folder.skd")).unwrap();
    tool.fails("inspect folder.skd", 1, &["folder.skd"]);
    tool.file("square.ply", square());
    tool.fails("build square.ply -o folder.skd", 1, &["folder.skd", "directory"]);
    tool.fails("trace square.ply --rays folder.ply --out a", 1, &["folder.ply"]);
}

#[test]
fn outputs_are_checked_before_the_work() {
    let tool = Tool::new();
    tool.file("file", b"");
    tool.file("square.ply", square());
    tool.file("rays.f32", b"");
    let before = tool.files();
    for place in ["file/under", "no/such/folder/out"] {
        // The scene does not exist: the output is looked at first.
        tool.fails(&format!("build missing.ply -o {place}.skd"), 1, &[place, "cannot write"]);
        tool.fails(&format!("render missing.ply -o {place}.png"), 1, &[place, "cannot write"]);
        tool.fails(&format!("trace missing.ply --rays rays.f32 --out {place}"), 1, &[place, "cannot write"]);
        tool.fails(&format!("scene kitchen -o {place}.ply"), 1, &[place, "cannot write"]);
    }
    tool.fails("render square.ply -o picture.jpg", 1, &["picture.jpg", ".png"]);
    assert_eq!(tool.files(), before);
}

#[test]
fn ray_files_of_odd_length() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    for length in [1, 31, 33, 100] {
        tool.file("rays.f32", vec![0; length]);
        tool.fails(
            "trace square.ply --rays rays.f32 --out hits.bin",
            1,
            &["rays.f32", "whole number of rays"],
        );
    }
    tool.fails("trace square.ply --rays none.f32 --out hits.bin", 1, &["none.f32"]);
    assert!(!tool.files().contains("hits.bin"));
}

#[test]
fn saved_trees() {
    let tool = Tool::new();
    tool.file("noise.skd", b"this is not a tree");
    tool.fails("inspect noise.skd --json", 1, &["noise.skd"]);
    tool.file("empty.skd", b"");
    tool.fails("inspect empty.skd", 1, &["empty.skd"]);
    tool.fails("inspect missing.skd", 1, &["missing.skd"]);
    tool.fails("render noise.skd", 1, &["noise.skd", "not a .skd tree"]);
    tool.file("square.ply", square());
    tool.fails("inspect square.ply --mesh square.ply", 2, &["--mesh", "saved tree"]);
    tool.fails("render --mesh square.ply", 2, &["--mesh"]);
    tool.fails("build square.ply --no-mesh", 2, &["--output"]);
    tool.fails("inspect noise.skd --triangles 10", 2, &["--triangles"]);
}

#[test]
fn wrong_usage() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    for (line, words) in [
        ("", &["Usage"][..]),
        ("fly", &["fly"]),
        ("build", &["SCENE"]),
        ("build square.ply --preset huge", &["huge", "standard", "paper-fast", "paper-small"]),
        ("bench square.ply --presets standard,huge", &["huge", "standard", "paper-small"]),
        ("build square.ply --threads 0", &["--threads"]),
        ("build square.ply --sah-traversal -1", &["--sah-traversal"]),
        ("build square.ply --empty-bonus nan", &["--empty-bonus"]),
        ("build square.ply --occupancy 1.5", &["--occupancy", "0 to 1"]),
        ("trace square.ply --rays a --out b --frequency -1", &["--frequency"]),
        ("render square.ply --byte-weight -0.5", &["--byte-weight"]),
        ("inspect square.ply --clipping loose", &["--clipping", "exact", "box"]),
        ("bench square.ply --rebuild --predict", &["--rebuild", "--predict"]),
        ("build square.ply --leaf-at-most -1", &["--leaf-at-most"]),
        ("build square.ply --triangles 10", &["--triangles", "built-in"]),
        ("render square.ply --size 0x10", &["--size"]),
        ("render square.ply --view 4", &["--view"]),
        ("render square.ply --camera 1,2,3", &["--camera"]),
        ("render square.ply --view 1 --camera 0,0,1,0,0,0", &["--view", "--camera"]),
        ("render square.ply --up w", &["--up"]),
        ("trace square.ply --rays a", &["--out"]),
        ("trace square.ply --rays a --out b --kind all", &["--kind", "closest", "any"]),
        ("trace square.ply --rays a --out b --kernel gpu", &["--kernel", "single", "packet", "stream"]),
        ("scene", &["NAME"]),
        ("scene kitchen", &["--output"]),
        ("scene kitchen --triangles 0 -o a.ply", &["--triangles"]),
        ("scene kitchen -o a.obj", &["a.obj", ".ply"]),
        ("completions cobol", &["cobol", "bash"]),
    ] {
        tool.fails(line, 2, words);
    }
    assert_eq!(tool.files().len(), 1);
}

#[test]
fn help_is_no_failure() {
    let tool = Tool::new();
    assert!(tool.ok("--version").stdout.starts_with("slimkd "));
    for command in ["", "render", "build", "inspect", "trace", "bench", "scene", "completions"] {
        let help = tool.ok(&format!("{command} --help")).stdout;
        assert!(help.contains("Examples:") && help.contains("Usage:"), "{command}");
    }
}
