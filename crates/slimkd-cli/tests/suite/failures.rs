//! What is wrong with the input or the command line is said in one line, with the right exit status.

use crate::common::{Tool, ply, ray_file, square};
use slimkd::Ray;

const SCENE_COMMANDS: &[&str] = &[
    "build {} --json",
    "inspect {} --json",
    "render {} --size 8x8",
    "bench {} --rays 100",
    "trace {} --rays none.f32 --out hits.bin",
    "convert {} -o converted.ply",
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
    refused(&tool, "none.ply", &["none.ply: ", "no triangle"]);
    tool.file("line.ply", ply(&["0 0 0", "1 1 1", "2 2 2"], &["3 0 1 2", "3 0 0 1"]));
    refused(&tool, "./line.ply", &["./line.ply: all 2 triangles are collinear or not finite"]);
    tool.file("nan.ply", ply(&["nan 0 0", "1 1 1", "2 2 2"], &["3 0 1 2"]));
    refused(&tool, "nan.ply", &["nan.ply: all 1 triangles are collinear or not finite"]);
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
    tool.file("rays.f32", b"");
    for command in [
        "build some.ply -o tree.skd",
        "inspect some.ply",
        "render some.ply --size 8x8",
        "bench some.ply --rays 64",
        "trace some.ply --rays rays.f32 --out hits.bin",
        "convert some.ply -o converted.ply",
    ] {
        tool.fails(&format!("{command} --quiet --strict"), 1, &["some.ply: 3 of 4 triangles", "--strict"]);
    }
    for command in ["build", "inspect"] {
        let warnings = &tool.json(&format!("{command} some.ply --json"))["warnings"];
        assert_eq!(warnings.as_array().unwrap().len(), 1, "{command}");
        assert!(warnings[0].as_str().unwrap().starts_with("3 of 4 triangles"), "{command}: {warnings}");
    }
    assert_eq!(tool.files().len(), 3, "{:?}", tool.files());
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
        let run = tool.fails(&format!("scene kitchen -o {place}.ply"), 1, &[place, "cannot write"]);
        assert!(!run.stderr.contains(".part"), "{}", run.stderr);
    }
    tool.fails(
        "build missing.ply -o none/a.skd",
        1,
        &["none/a.skd: cannot write: no such file", "make its folder"],
    );
    assert_eq!(tool.files(), before);
}

#[test]
fn names_say_what_is_written() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    for name in ["square.ply", "other.ply", "tree", "tree.skd.gz", "."] {
        tool.fails(&format!("build square.ply -o {name}"), 2, &[name, "end the name in .skd"]);
    }
    tool.fails("render square.ply -o picture.jpg", 2, &["picture.jpg", ".png"]);
    tool.fails("scene kitchen -o a.obj", 2, &["a.obj", ".ply"]);
    assert_eq!(tool.files().len(), 1);
    assert_eq!(std::fs::read(tool.path("square.ply")).unwrap(), square().as_bytes());
    tool.ok("build square.ply -o TREE.SKD");
    for line in ["trace square.ply --rays square.ply --out -", "render square.ply -o -"] {
        tool.fails(line, 2, &["- is no name for standard output", "./-"]);
    }
}

#[test]
fn inputs_are_never_overwritten() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    ray_file(&tool.path("rays.f32"), &[Ray::new([0.5, 0.5, 1.0], [0.0, 0.0, -1.0])]);
    tool.ok("build square.ply -o tree.skd");
    tool.ok("build square.ply -o alone.skd --no-mesh");
    std::fs::create_dir(tool.path("report")).unwrap();
    tool.file("report/raw.json", b"{}");
    let contents = || -> Vec<_> {
        let names = ["square.ply", "rays.f32", "tree.skd", "alone.skd", "report/raw.json"];
        names.iter().map(|name| std::fs::read(tool.path(name)).unwrap()).collect()
    };
    let (before, files) = (contents(), tool.files());
    for line in [
        "trace square.ply --rays rays.f32 --out rays.f32",
        "trace square.ply --rays rays.f32 --out report/../rays.f32",
        "trace square.ply --rays rays.f32 --out square.ply",
        "trace tree.skd --rays rays.f32 --out tree.skd",
        "trace tree.skd --rays rays.f32 --out ./tree.skd --no-verify",
        "trace alone.skd --mesh square.ply --rays rays.f32 --out square.ply",
        "build tree.skd -o tree.skd",
        "build alone.skd --mesh square.ply -o alone.skd",
        "report --quick -o report --peers report/raw.json",
    ] {
        tool.fails(line, 2, &["would overwrite the input", "name another"]);
    }
    assert!(contents() == before && tool.files() == files);
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        std::fs::hard_link(tool.path("rays.f32"), tool.path("second.f32")).unwrap();
        tool.fails(
            "trace square.ply --rays rays.f32 --out second.f32",
            2,
            &["would overwrite", "second.f32"],
        );
        symlink(tool.path("rays.f32"), tool.path("link.f32")).unwrap();
        tool.fails("trace square.ply --rays link.f32 --out rays.f32", 2, &["would overwrite", "link.f32"]);
        tool.fails("trace square.ply --rays rays.f32 --out link.f32", 2, &["would overwrite"]);
        tool.file("picture.png", square());
        symlink(tool.path("picture.png"), tool.path("link.ply")).unwrap();
        tool.fails("render link.ply --size 8x8 -o picture.png", 2, &["would overwrite", "link.ply"]);
    }
    assert!(contents() == before);
    // A built-in scene reads no file, whatever lies there.
    tool.file("kitchen", b"");
    tool.ok("trace kitchen --triangles 3000 --rays rays.f32 --out kitchen");
}

#[test]
fn advice_is_not_what_is_done_already() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    let said = |line: &str| tool.fails(line, 1, &["square.ply: ", "allow more with --max-"]).stderr;
    let tree = |options: &str| said(&format!("build square.ply --max-tree-bytes 10 {options}"));
    assert!(!tree("").contains("dense") && !tree("--preset standard --layout dense").contains("dense"));
    assert!(tree("--preset standard").contains("take --layout dense"));
    let build = |options: &str| said(&format!("build square.ply --max-build-bytes 10 {options}"));
    assert!(!build("").contains("preset") && !build("--preset tiny").contains("preset"));
    assert!(build("--preset paper-fast").contains("the preset slim or tiny"));
}

#[test]
fn reports_look_at_every_name_first() {
    let tool = Tool::new();
    tool.file("square.ply", square());
    tool.file("text.txt", b"hello");
    tool.file("broken.ply", &square()[..60]);
    tool.ok("build square.ply -o tree.skd");
    let before = tool.files();
    for (scenes, word) in [
        ("nosuch.ply", "neither a file"),
        ("kitchen tree.skd", "tree.skd: a report builds trees of its own"),
        ("kitchen text.txt", "no known extension"),
        ("kitchen .", "not a regular file"),
        ("broken.ply", "broken.ply"),
    ] {
        // Nothing was measured: that would have left files.
        tool.fails(&format!("report {scenes} --quick --threads 1 -o out"), 1, &[word]);
        assert_eq!(tool.files(), before, "{scenes}");
    }
    std::fs::create_dir(tool.path("out")).unwrap();
    tool.fails("report broken.ply --quick --threads 1 -o out", 1, &["broken.ply"]);
    assert_eq!(std::fs::read_dir(tool.path("out")).unwrap().count(), 0);
    tool.fails("report --from nosuch.json -o out", 1, &["nosuch.json: cannot read", "--from", "raw.json"]);
    tool.fails("report --peers nosuch.json -o out", 1, &["nosuch.json: cannot read", "slimkd-bench --json"]);
    tool.fails("report square.ply -o square.ply", 1, &["square.ply/measured", "choose another folder"]);
}

#[test]
fn fewer_triangles_than_a_scene_has_are_noted() {
    let tool = Tool::new();
    let run = tool.ok("scene kitchen --triangles 1 -o a.ply");
    assert!(run.stderr.contains("kitchen: 2,670 triangles, the fewest"), "{}", run.stderr);
    assert_eq!(tool.ok("scene kitchen --triangles 3000 -o a.ply").stderr.lines().count(), 1);
    assert_eq!(tool.ok("scene kitchen --triangles 1 -o a.ply --quiet").stderr, "");
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
        ("bench square.ply --predict", &["unexpected argument", "--predict"]),
        ("build square.ply --leaf-at-most -1", &["--leaf-at-most"]),
        ("build square.ply --triangles 10", &["--triangles", "built-in"]),
        ("render square.ply --size 0x10", &["--size"]),
        ("render square.ply --view 4", &["--view", "expected a number from 1 to 3"]),
        ("render square.ply --spp 0", &["--spp", "expected a number from 1 to 4096"]),
        ("render square.ply --bounces 65", &["--bounces", "expected a number from 0 to 64"]),
        ("render square.ply --occlusion 2000", &["--occlusion", "expected a number from 0 to 1024"]),
        ("render square.ply --exposure nan", &["--exposure", "expected a number from -100 to 100"]),
        ("bench square.ply --rounds 3", &["--rounds", "expected a number from 5 to 1000"]),
        ("bench square.ply --rays 0", &["--rays", "expected a number from 1 to 1048576"]),
        ("report square.ply --rounds 2 -o out", &["--rounds", "expected a number from 3 to 1000"]),
        ("build square.ply --sah-intersection 1e300", &["expected a number from 1e-37 to 3.4e38"]),
        ("build square.ply --foo", &["'--foo' found; to pass"]),
        ("build square.ply --prese slim", &["'--prese' found; a similar argument"]),
        (
            "build square.ply --layout dense --occupancy 0.5",
            &["leave out --occupancy, or take --layout two-byte"],
        ),
        ("inspect square.ply --layout dense --rebuild", &["T-references", "--rebuild"]),
        ("render square.ply --layout dense --frequency 0.5", &["--frequency"]),
        ("trace square.ply --rays a --out b --layout dense --rebuild", &["--rebuild"]),
        ("bench square.ply --layout dense --occupancy 1", &["--occupancy"]),
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
    for (command, words) in [
        ("build", &["holds no T-references", "1 to 1024", "1 to 100000000", "1e-37 to 3.4e38"][..]),
        ("trace", &["Excludes --mesh, --triangles, --kernel and --device"]),
        ("render", &["1 to 4096", "1 to 3", "each 1 to 16384"]),
        ("bench", &["5 to 1000", "1 to 1048576"]),
        ("report", &["3 to 1000", "Width and height", "14 GB, 10 to 20 minutes"]),
    ] {
        let help = tool.ok(&format!("{command} --help")).stdout;
        let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
        for word in words {
            assert!(help.contains(word), "{command}: no {word:?} in {help}");
        }
    }
}
