//! `slimkd trace`, from files to files, against brute force on every ray.

#[path = "../../../slimkd/tests/common/mod.rs"]
mod rays;

use crate::common::{Tool, ray_file};
use rayon::prelude::*;
use slimkd::{BruteForce, Hit, Preset, Tracer, TriangleMesh};
use slimkd_scene::{load, procedural};
use std::path::Path;

/// Rays a scene.
const RAYS: usize = 10_000;
/// Record of a miss: t, triangle, u, v.
const MISS: [u32; 4] = [f32::INFINITY.to_bits(), u32::MAX, 0, 0];

/// `t, triangle, u, v` of each record.
fn records(path: &Path) -> Vec<[u32; 4]> {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(bytes.len() % 16, 0);
    let words = bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()));
    words.collect::<Vec<_>>().chunks_exact(4).map(|record| record.try_into().unwrap()).collect()
}

/// The nearest of these hits and whether several share its t: then it is the one with the lowest id.
fn nearest(all: &[Hit]) -> (Option<Hit>, bool) {
    let t = all.iter().map(|hit| hit.t).fold(f32::INFINITY, f32::min);
    let best = all.iter().filter(|hit| hit.t == t).min_by_key(|hit| hit.triangle);
    (best.copied(), all.iter().filter(|hit| hit.t == t).count() > 1)
}

/// Traces hard rays through `scene`, as the command line names it.
fn check(scene: &str, mesh: &TriangleMesh) {
    let tool = Tool::new();
    let rays = rays::hard_rays(mesh, RAYS, 11);
    ray_file(&tool.path("rays.f32"), &rays);
    let oracle = BruteForce::new(mesh);
    let expected: Vec<_> = rays.par_iter().map(|ray| nearest(&oracle.all(ray))).collect();
    let hits = expected.iter().filter(|(hit, _)| hit.is_some()).count();
    let ties = expected.iter().filter(|(_, tie)| *tie).count();
    assert!(hits > RAYS / 2 && hits < RAYS && ties > 0, "{scene}: {hits} hits, {ties} ties prove too little");

    for preset in Preset::ALL {
        let line = |kind: &str| {
            let files = "--rays rays.f32 --out hits.bin --quiet";
            format!("trace {scene} {files} --kind {kind} --preset {}", preset.name())
        };
        tool.ok(&line("closest"));
        let closest = records(&tool.path("hits.bin"));
        tool.ok(&line("any"));
        let any = records(&tool.path("hits.bin"));
        assert_eq!((closest.len(), any.len()), (RAYS, RAYS));
        for (i, (hit, _)) in expected.iter().enumerate() {
            let record = hit.map_or(MISS, |h| [h.t.to_bits(), h.triangle, h.u.to_bits(), h.v.to_bits()]);
            let context = || format!("{scene}, {}, ray {i}: {:?}", preset.name(), rays[i]);
            assert_eq!(closest[i], record, "{}", context());
            assert_eq!(any[i][1] != u32::MAX, hit.is_some(), "{}", context());
            assert_eq!(any[i][0], if hit.is_some() { 0 } else { MISS[0] }, "{}", context());
        }
    }
}

#[test]
fn a_built_in_scene() {
    let mesh = procedural::generate("kitchen", 8_000).unwrap().mesh;
    check("kitchen --triangles 8000", &mesh);
}

#[test]
fn real_scenes() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    for name in ["sponza_dabrovic.ply.zst", "bart_kitchen_101015.ply.zst"] {
        let path = folder.join(name);
        if !path.is_file() {
            println!("skipped: no {name}");
            continue;
        }
        let path = path.canonicalize().unwrap();
        let scene = path.to_str().unwrap();
        if scene.contains(char::is_whitespace) {
            println!("skipped: the path of {name} holds a space");
            continue;
        }
        check(scene, &load(&path).unwrap().mesh);
    }
}
