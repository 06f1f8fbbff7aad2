//! `slimkd trace` answers as the library does.

use crate::common::{Tool, ray_file};
use slimkd::{KdTree, Preset, Ray, Tracer};

const SCENE: &str = "kitchen --triangles 3000";

/// Rays all over the scene, some of them invalid.
fn rays(tree: &KdTree, count: usize) -> Vec<Ray> {
    let mut random = fastrand::Rng::with_seed(7);
    let bounds = tree.bounds();
    let mut point = || -> [f32; 3] {
        std::array::from_fn(|k| bounds.min[k] + random.f32() * (bounds.max[k] - bounds.min[k]))
    };
    let mut rays: Vec<_> = (0..count)
        .map(|_| {
            let (from, to) = (point(), point());
            Ray::new(from, std::array::from_fn::<_, 3, _>(|k| to[k] - from[k])).with_range(0.0, 1.0)
        })
        .collect();
    rays[1].direction = [0.0; 3];
    rays[2].origin[0] = f32::NAN;
    rays[3].t_max = -1.0;
    rays[4].t_max = f32::INFINITY;
    rays
}

fn tree() -> KdTree {
    let scene = slimkd_scene::procedural::generate("kitchen", 3000).unwrap();
    KdTree::build(scene.mesh, &Preset::Standard.into()).unwrap()
}

/// `t, triangle, u, v` of each record.
fn records(bytes: &[u8]) -> Vec<[u32; 4]> {
    assert_eq!(bytes.len() % 16, 0);
    let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap());
    bytes.chunks_exact(16).map(|b| [word(&b[..4]), word(&b[4..8]), word(&b[8..12]), word(&b[12..])]).collect()
}

#[test]
fn closest_hits_are_the_library_s_bit_by_bit() {
    let (tool, tree) = (Tool::new(), tree());
    let rays = rays(&tree, 5000);
    ray_file(&tool.path("rays.f32"), &rays);
    let expected: Vec<_> = rays
        .iter()
        .map(|ray| match tree.closest(ray) {
            Some(hit) => [hit.t.to_bits(), hit.triangle, hit.u.to_bits(), hit.v.to_bits()],
            None => [f32::INFINITY.to_bits(), u32::MAX, 0, 0],
        })
        .collect();
    let found = expected.iter().filter(|record| record[1] != u32::MAX).count();
    assert!(found > 1000 && found < 5000, "{found}");
    for preset in Preset::ALL {
        for options in ["--threads 1", "--threads 3", "--kernel packet", "--kernel stream", "--kernel single"]
        {
            let line =
                format!("trace {SCENE} --rays rays.f32 --out hits.bin --preset {} {options}", preset.name());
            let run = tool.ok(&line);
            assert!(run.stderr.contains("5,000 rays"), "{}", run.stderr);
            assert_eq!(records(&std::fs::read(tool.path("hits.bin")).unwrap()), expected, "{line}");
        }
    }
}

#[test]
fn any_hits_are_the_library_s() {
    let (tool, tree) = (Tool::new(), tree());
    let rays = rays(&tree, 5000);
    ray_file(&tool.path("rays.f32"), &rays);
    tool.ok(&format!("trace {SCENE} --rays rays.f32 --out hits.bin --kind any --quiet"));
    let records = records(&std::fs::read(tool.path("hits.bin")).unwrap());
    assert_eq!(records.len(), rays.len());
    for (record, ray) in records.iter().zip(&rays) {
        let hit = tree.any(ray);
        assert_eq!(record[0], if hit { 0 } else { f32::INFINITY.to_bits() });
        assert_eq!(record[1] != u32::MAX, hit);
    }
}

#[test]
fn files_longer_than_a_batch_and_empty_ones() {
    let (tool, tree) = (Tool::new(), tree());
    let few = rays(&tree, 1000);
    let many: Vec<_> = few.iter().copied().cycle().take(300_001).collect();
    ray_file(&tool.path("few.f32"), &few);
    ray_file(&tool.path("many.f32"), &many);
    tool.ok(&format!("trace {SCENE} --rays few.f32 --out few.bin"));
    tool.ok(&format!("trace {SCENE} --rays many.f32 --out many.bin"));
    let read = |name: &str| records(&std::fs::read(tool.path(name)).unwrap());
    let expected: Vec<_> = read("few.bin").into_iter().cycle().take(300_001).collect();
    assert!(read("many.bin") == expected);

    tool.file("none.f32", b"");
    tool.ok(&format!("trace {SCENE} --rays none.f32 --out none.bin"));
    assert_eq!(read("none.bin").len(), 0);
}

#[cfg(unix)]
#[test]
fn rays_may_come_through_a_pipe() {
    use std::io::Write;
    use std::process::Stdio;
    let (tool, tree) = (Tool::new(), tree());
    let rays = rays(&tree, 1000);
    ray_file(&tool.path("rays.f32"), &rays);
    let bytes = std::fs::read(tool.path("rays.f32")).unwrap();
    for (length, status) in [(bytes.len(), 0), (bytes.len() - 1, 1)] {
        let line = format!("trace {SCENE} --rays /dev/stdin --out {length}.bin");
        let mut child = tool.command(&line).stdin(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        child.stdin.take().unwrap().write_all(&bytes[..length]).unwrap();
        assert_eq!(child.wait_with_output().unwrap().status.code(), Some(status));
        assert_eq!(tool.files().contains(&format!("{length}.bin")), status == 0);
    }
}

#[test]
fn a_gpu_finds_what_the_library_finds() {
    let (tool, tree) = (Tool::new(), tree());
    let listed = tool.run("devices");
    assert_eq!(listed.status, 0);
    if !listed.stdout.contains("gpu  ") {
        slimkd_util::missing("gpu", "Debian: apt-get install mesa-vulkan-drivers");
        return;
    }
    let rays = rays(&tree, 2000);
    ray_file(&tool.path("rays.f32"), &rays);
    for kind in ["closest", "any"] {
        let line = format!("trace {SCENE} --rays rays.f32 --out hits.bin --device gpu --kind {kind}");
        assert_eq!(tool.run(&line).status, 0, "{line}");
        let records = records(&std::fs::read(tool.path("hits.bin")).unwrap());
        let unlike = records.iter().zip(&rays).filter(|(record, ray)| {
            let wanted = tree.closest(ray).map_or(u32::MAX, |hit| hit.triangle);
            if kind == "any" { (record[1] == u32::MAX) != (wanted == u32::MAX) } else { record[1] != wanted }
        });
        // Triangles at the same t may change places.
        assert!(unlike.count() <= 2, "{kind}");
    }
    assert_eq!(
        tool.run(&format!("trace {SCENE} --rays rays.f32 --out h --device gpu --kernel packet")).status,
        2
    );
}

/// A tree that is cut short while it is traced ends the command with its one line. The rays come through a pipe, so that the file is cut
/// after it was mapped and before a ray is traced.
#[cfg(target_os = "linux")]
#[test]
fn a_mapped_tree_that_is_cut_short_is_one_line() {
    use std::fs::{File, OpenOptions};
    use std::io::Write;
    let tool = Tool::new();
    tool.ok("build kitchen --triangles 20000 --quiet -o tree.skd");
    let pipe = tool.path("rays.f32");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut command = tool.command("trace tree.skd --no-verify --rays rays.f32 --out hits.bin");
    let child =
        command.stderr(std::process::Stdio::piped()).stdout(std::process::Stdio::piped()).spawn().unwrap();
    // Opens once the command opens its end.
    let mut rays: File = OpenOptions::new().write(true).open(&pipe).unwrap();
    let maps = format!("/proc/{}/maps", child.id());
    while !std::fs::read_to_string(&maps).unwrap().contains("tree.skd") {
        std::thread::yield_now();
    }
    OpenOptions::new().write(true).open(tool.path("tree.skd")).unwrap().set_len(4096).unwrap();
    let ray = [0.0f32, 1.0, 0.0, 0.0, 0.3, 0.1, 0.9, f32::INFINITY].map(f32::to_le_bytes).concat();
    // The command may be gone before it read them all.
    let _ = rays.write_all(&ray.repeat(100));
    drop(rays);
    let output = child.wait_with_output().unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    assert!(stderr.contains("tree.skd: was cut short while it was traced"), "{stderr}");
}

/// A wall in UTM coordinates, and rays that start a centimetre beside it: away from it, and into it.
#[test]
fn rays_in_f64_are_on_the_right_side_of_a_far_wall() {
    let tool = Tool::new();
    let wall = "v 528980.85 183526.1 0\nv 528980.85 183526.1 3\nv 528982.3 183523.55 0\nv 528982.3 183523.55 3\nf 2 1 3\nf 2 3 4\n";
    tool.file("wall.obj", wall);
    let start = [528_981.583_692_901_2, 183_524.829_943_022_25, 1.0];
    let away = [0.869_290_118_919_176_4, 0.494_302_224_503_879_8, 0.0];
    let ray = |sign: f64| {
        let direction = away.map(|x| sign * x);
        [&start[..], &[0.0], &direction, &[f64::INFINITY]].concat().into_iter().flat_map(f64::to_le_bytes)
    };
    tool.file("rays.f64", ray(1.0).chain(ray(-1.0)).collect::<Vec<u8>>());
    let run = tool.ok("build wall.obj -o wall.skd --json");
    assert!(run.stderr.contains("origin 528980,183524,0"), "{}", run.stderr);
    let json: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(json["scene"]["origin"], serde_json::json!([528_980.0, 183_524.0, 0.0]));
    for scene in ["wall.obj", "wall.skd", "wall.skd --no-verify", "wall.obj --origin 528000,183000,0"] {
        for kind in ["closest", "any"] {
            tool.ok(&format!("trace {scene} --rays rays.f64 --out hits.bin --kind {kind} --threads 2"));
            let records = records(&std::fs::read(tool.path("hits.bin")).unwrap());
            assert_eq!(records.len(), 2);
            assert_eq!((records[0][1], records[1][1] != u32::MAX), (u32::MAX, true), "{scene} {kind}");
            let t = f32::from_bits(records[1][0]);
            assert!(kind == "any" || (t - 0.01).abs() < 1e-4, "{scene}: {t}");
        }
    }
    // Rays of f32 are in the file's coordinates, too.
    ray_file(&tool.path("rays.f32"), &[Ray::new([528_990.0, 183_530.0, 1.0], [-0.87, -0.49, 0.0])]);
    tool.ok("trace wall.obj --rays rays.f32 --out hits.bin");
    assert_ne!(records(&std::fs::read(tool.path("hits.bin")).unwrap())[0][1], u32::MAX);
    // What is written again is where it was.
    tool.ok("convert wall.obj -o wall.ply");
    let json = tool.json("inspect wall.ply --json");
    assert_eq!(json["scene"]["origin"], serde_json::json!([528_980.0, 183_524.0, 0.0]));
    let none = tool.json("build wall.obj --origin none --json");
    assert_eq!(none["scene"]["origin"], serde_json::json!([0.0, 0.0, 0.0]));
    tool.fails("build wall.skd --origin none", 2, &["--origin"]);
    tool.fails("build kitchen --origin 1,2,3", 2, &["--origin"]);
    tool.file("odd.f64", [0; 72]);
    tool.fails("trace wall.obj --rays odd.f64 --out h", 1, &["byte 64", "f64"]);
}
