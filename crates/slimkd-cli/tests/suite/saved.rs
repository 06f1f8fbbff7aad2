//! Trees that `build -o` saved.

use crate::common::{Tool, keys, ray_file};
use slimkd::{Preset, Ray};

const SCENE: &str = "kitchen --triangles 3000";

#[test]
fn a_saved_tree_reports_what_its_build_did() {
    let tool = Tool::new();
    for preset in Preset::ALL {
        let constants = format!("--preset {} --sah-traversal 12 --threads 2 --json", preset.name());
        let mut built = tool.json(&format!("build {SCENE} {constants} -o tree.skd"));
        let mut read = tool.json("inspect tree.skd --threads 2 --json");
        // Only `inspect` looks at the mesh.
        read.as_object_mut().unwrap().remove("mesh_check").unwrap();
        assert_eq!(keys(&read), keys(&built));
        assert!(read["bytes"]["build_peak"].is_null() && read["seconds"]["build"].is_null());
        for report in [&mut built, &mut read] {
            report["bytes"]["build_peak"].take();
            report["seconds"].take();
        }
        assert_eq!(read, built);
    }
    assert!(tool.ok("inspect tree.skd").stdout.contains("B/triangle"));
    assert!(tool.ok("inspect tree.skd --complete").stderr.contains("no triangle is missing"));
    let run = tool.ok("inspect tree.skd --preset standard");
    assert!(
        run.stderr.contains("tree.skd: --preset is ignored: a saved tree keeps the options"),
        "{}",
        run.stderr
    );
    let run = tool.ok("inspect tree.skd --collapse --layout dense --threads 2");
    assert!(run.stderr.contains("--collapse and --layout are ignored"), "{}", run.stderr);
}

#[test]
fn the_file_is_the_same_at_any_thread_count() {
    let tool = Tool::new();
    tool.ok(&format!("build {SCENE} --threads 1 -o one.skd"));
    tool.ok(&format!("build {SCENE} --threads 3 -o three.skd"));
    assert!(std::fs::read(tool.path("one.skd")).unwrap() == std::fs::read(tool.path("three.skd")).unwrap());
}

#[test]
fn a_saved_tree_traces_like_its_scene() {
    let tool = Tool::new();
    let rays: Vec<_> = (0..500)
        .map(|k| Ray::new([0.01 * k as f32 - 2.5, 1.5, 0.0], [0.3, -0.2, 0.1 * (k % 7) as f32]))
        .collect();
    ray_file(&tool.path("rays.f32"), &rays);
    tool.ok(&format!("build {SCENE} -o tree.skd"));
    for kind in ["closest", "any"] {
        tool.ok(&format!("trace {SCENE} --rays rays.f32 --out scene.bin --kind {kind}"));
        tool.ok(&format!("trace tree.skd --rays rays.f32 --out tree.bin --kind {kind}"));
        assert!(
            std::fs::read(tool.path("scene.bin")).unwrap() == std::fs::read(tool.path("tree.bin")).unwrap()
        );
    }
}

#[test]
fn a_tree_that_is_not_verified_traces_alike_and_damage_is_an_error() {
    let tool = Tool::new();
    let rays: Vec<_> = (0..3000)
        .map(|k| Ray::new([0.01 * (k % 500) as f32 - 2.5, 1.5, 0.0], [0.3, -0.2, 0.1 * (k % 7) as f32]))
        .collect();
    ray_file(&tool.path("rays.f32"), &rays);
    for preset in ["slim", "paper-small"] {
        tool.ok(&format!("build {SCENE} --preset {preset} -o tree.skd"));
        for kind in ["closest", "any"] {
            let line = format!("trace tree.skd --rays rays.f32 --kind {kind}");
            tool.ok(&format!("{line} --out proved.bin"));
            tool.ok(&format!("{line} --out open.bin --no-verify"));
            let read = |name: &str| std::fs::read(tool.path(name)).unwrap();
            assert!(read("proved.bin") == read("open.bin"), "{preset} {kind}");
        }
    }
    let mut bent = std::fs::read(tool.path("tree.skd")).unwrap();
    let end = bent.len() - 2000;
    bent[end / 2..end].fill(0xff);
    tool.file("bent.skd", bent);
    tool.fails("trace bent.skd --rays rays.f32 --out none.bin --no-verify", 1, &["damaged tree"]);
    assert!(!tool.files().contains("none.bin"));
    tool.fails("trace kitchen --rays rays.f32 --out none.bin --no-verify", 2, &["only a saved tree"]);
    assert_eq!(tool.run("trace tree.skd --rays rays.f32 --out a.bin --no-verify --kernel packet").status, 2);
}

#[test]
fn damaged_trees_are_refused() {
    let tool = Tool::new();
    tool.ok(&format!("build {SCENE} -o tree.skd"));
    let whole = std::fs::read(tool.path("tree.skd")).unwrap();
    for kept in [1, 7, 8, 12, 40, 100, whole.len() / 2, whole.len() - 1] {
        tool.file("cut.skd", &whole[..kept]);
        tool.fails("inspect cut.skd", 1, &["cut.skd", "build"]);
    }
    for place in (0..whole.len()).step_by(whole.len() / 24) {
        let mut bytes = whole.clone();
        bytes[place] ^= 0x55;
        tool.file("bent.skd", &bytes);
        // Refused or, where the byte is a coordinate's, read; never a crash.
        let run = tool.run("inspect bent.skd --json");
        assert!(matches!(run.status, 0 | 1), "byte {place}: {}", run.stderr);
    }
}

#[test]
fn every_command_takes_a_saved_tree() {
    let tool = Tool::new();
    ray_file(&tool.path("rays.f32"), &[Ray::new([0.0, 1.5, 0.0], [0.3, -0.2, 0.1])]);
    tool.ok(&format!("build {SCENE} --preset tiny -o tree.skd"));
    tool.ok("render tree.skd --size 8x8 --up y -o tree.png");
    tool.ok("trace tree.skd --rays rays.f32 --out hits.bin");
    let presets = |line: &str| {
        let report = tool.json(line);
        let results = report["results"].as_array().unwrap().clone();
        let mut presets: Vec<_> = results.iter().map(|rate| rate["preset"].to_string()).collect();
        presets.sort();
        presets.dedup();
        presets
    };
    assert_eq!(presets("bench tree.skd --rays 64 --json"), ["\"tiny\""]);
    assert_eq!(presets("bench tree.skd --rays 64 --presets tiny,slim --json"), ["\"slim\"", "\"tiny\""]);
    // A build from a saved tree is a build from its mesh.
    tool.ok(&format!("build {SCENE} --preset slim -o slim.skd"));
    tool.ok("build tree.skd --preset slim -o again.skd");
    assert!(std::fs::read(tool.path("slim.skd")).unwrap() == std::fs::read(tool.path("again.skd")).unwrap());
}

#[test]
fn a_tree_without_its_mesh_wants_the_right_one() {
    let tool = Tool::new();
    tool.ok("scene kitchen --triangles 3000 -o kitchen.ply");
    tool.ok("scene kitchen --triangles 3500 -o other.ply");
    tool.ok("build kitchen.ply -o whole.skd");
    tool.ok("build kitchen.ply -o alone.skd --no-mesh");
    let length = |name: &str| std::fs::metadata(tool.path(name)).unwrap().len();
    assert!(length("alone.skd") * 2 < length("whole.skd"));
    ray_file(&tool.path("rays.f32"), &[Ray::new([0.0, 1.5, 0.0], [0.3, -0.2, 0.1])]);
    for command in [
        "inspect alone.skd",
        "build alone.skd",
        "render alone.skd --size 8x8",
        "bench alone.skd --rays 64",
        "trace alone.skd --rays rays.f32 --out hits.bin",
    ] {
        tool.fails(command, 1, &["alone.skd", "without its mesh", "--mesh"]);
        tool.fails(&format!("{command} --mesh other.ply"), 1, &["alone.skd", "another mesh", "hash"]);
        tool.fails(&format!("{command} --mesh missing.ply"), 1, &["missing.ply"]);
        tool.fails(&format!("{command} --mesh whole.skd"), 2, &["whole.skd", "scene"]);
        tool.ok(&format!("{command} --mesh kitchen.ply"));
    }
    let line = "trace alone.skd --rays rays.f32 --out hits.bin --no-verify";
    tool.fails(
        line,
        1,
        &["alone.skd: saved without its mesh", "leave out --no-verify and give it with --mesh FILE"],
    );
    tool.fails(&format!("{line} --mesh kitchen.ply"), 2, &["--no-verify", "--mesh"]);
    // The mesh inside is held against the one that is given, too.
    tool.ok("inspect whole.skd --mesh kitchen.ply");
    tool.fails("inspect whole.skd --mesh other.ply", 1, &["another mesh"]);
    let report = tool.json("inspect alone.skd --json --mesh kitchen.ply");
    assert_eq!(report["bytes"], tool.json("inspect whole.skd --json")["bytes"]);
}
