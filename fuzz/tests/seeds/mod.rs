//! Seeds: small sound inputs of every target, made here.

mod scenes;

use super::folder;
use slimkd::{BuildOptions, KdTree, Preset};
use slimkd_util::Rng;
use std::fs;

fn put(target: &str, name: &str, data: &[u8]) {
    fs::write(folder(target).join(name), data).unwrap();
}

/// Writes every seed.
pub fn write() {
    let mut rng = Rng::new(1);
    let mut noise = |length: usize| (0..length).map(|_| rng.bits() as u8).collect::<Vec<_>>();
    for k in 0..6 {
        put("soup", &format!("seed-{k}"), &noise(100 << k));
        put("rays", &format!("seed-{k}"), &noise(32 * (k + 1)));
    }
    let floats =
        |rays: &[[f32; 8]]| rays.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    put(
        "rays",
        "seed-plain",
        &floats(&[
            [0.1, 0.2, 9.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY],
            [-9.0, 0.1, 0.1, 0.0, 1.0, 0.0, 0.0, 99.0],
        ]),
    );
    for (k, &preset) in Preset::ALL.iter().enumerate() {
        let mesh = slimkd_fuzz::small_mesh(&noise(300 + 100 * k));
        let tree = KdTree::build(mesh, &BuildOptions::from(preset)).unwrap();
        for signed in [0, 1] {
            let mut file = vec![signed];
            tree.write(&mut file).unwrap();
            put("skd", &format!("seed-{k}-{signed}"), &file);
        }
    }
    scenes::write();
}
