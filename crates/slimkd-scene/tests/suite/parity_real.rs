//! Every real scene at hand, on every preset, against brute force.
//!
//! `SLIMKD_PARITY_TRIANGLES` raises the limit on a scene's size, for those who have the time.

use crate::oracle::{check_invariants, compare, setting};
use slimkd::{KdTree, Preset};
use slimkd_scene::load;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Triangles of the largest scene that brute force takes on in an ordinary run.
const TRIANGLES: usize = 500_000;

/// How many triangles a compressed PLY's header promises.
fn triangles_of(path: &Path) -> usize {
    let mut decoder = zstd::Decoder::new(std::fs::File::open(path).unwrap()).unwrap();
    decoder.window_log_max(27).unwrap();
    let mut head = Vec::new();
    decoder.take(1024).read_to_end(&mut head).unwrap();
    let head = String::from_utf8_lossy(&head);
    let count = head.lines().find_map(|line| line.strip_prefix("element face "));
    count.and_then(|count| count.trim().parse().ok()).unwrap_or_else(|| panic!("{path:?}: no face count"))
}

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = paths.filter(|path| path.to_string_lossy().ends_with(".ply.zst")).collect();
    paths.sort();
    paths
}

#[test]
fn real_scenes_agree_with_brute_force() {
    let scenes = scenes();
    if scenes.is_empty() {
        println!("skipped: no scenes folder");
    }
    let limit = setting("SLIMKD_PARITY_TRIANGLES", TRIANGLES);
    for path in scenes {
        let triangles = triangles_of(&path);
        if triangles > limit {
            println!("skipped: {} has {triangles} triangles", path.display());
            continue;
        }
        let scene = load(&path).unwrap();
        assert_eq!(scene.mesh.len(), triangles, "{}", scene.name);
        let build = |preset: &Preset| KdTree::build(Arc::clone(&scene.mesh), &(*preset).into()).unwrap();
        let trees: Vec<_> = Preset::ALL.iter().map(|p| (p.name().to_owned(), build(p))).collect();
        for (preset, tree) in &trees {
            check_invariants(&scene.name, preset, tree);
        }
        compare(&scene.mesh, &trees).verdict(&scene.name);
    }
}
