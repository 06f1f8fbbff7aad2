//! The corpus and mutations of it through every target: seconds, no libFuzzer, the same on every machine.
//!
//! `SLIMKD_FUZZ_SEEDS=1` writes the seeds anew; `SLIMKD_FUZZ_TIMES=100` makes a hundred times as many mutations.

use slimkd_util::Rng;
use std::fs;
use std::path::PathBuf;

mod seeds;

type Target = (&'static str, fn(&[u8]), usize);
/// With mutations of each corpus entry.
const TARGETS: [Target; 14] = [
    ("scene", slimkd_fuzz::scene, 60),
    ("ply", slimkd_fuzz::ply, 60),
    ("obj", slimkd_fuzz::obj, 60),
    ("stl", slimkd_fuzz::stl, 60),
    ("off", slimkd_fuzz::off, 60),
    ("gltf", slimkd_fuzz::gltf, 60),
    ("meshopt", slimkd_fuzz::meshopt, 60),
    ("draco", slimkd_fuzz::draco, 60),
    ("mitsuba", slimkd_fuzz::mitsuba, 60),
    ("cityjson", slimkd_fuzz::cityjson, 60),
    ("grids", slimkd_fuzz::grids, 60),
    ("skd", slimkd_fuzz::skd, 60),
    ("soup", slimkd_fuzz::soup, 6),
    ("rays", slimkd_fuzz::rays, 4),
];

fn folder(target: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

fn mutate(data: &mut Vec<u8>, rng: &mut Rng) {
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(data.len());
        match rng.below(6) {
            0 if at < data.len() => data[at] ^= 1 << rng.below(8),
            1 if at < data.len() => data[at] = rng.bits() as u8,
            2 if at < data.len() => data[at] = [0, 1, 0x7f, 0x80, 0xff][rng.below(5)],
            3 => data.truncate(at),
            4 => data.insert(at, rng.bits() as u8),
            _ => {
                let piece: Vec<u8> = data[at..].iter().take(1 + rng.below(16)).copied().collect();
                let to = rng.below(data.len() + 1);
                data.splice(to..to, piece);
            }
        }
    }
}

#[test]
fn nothing_breaks_a_target() {
    if std::env::var_os("SLIMKD_FUZZ_SEEDS").is_some() {
        seeds::write();
    }
    let times = std::env::var("SLIMKD_FUZZ_TIMES").map_or(1, |times| times.parse().expect("a number"));
    for (name, target, mutations) in TARGETS {
        let mut files: Vec<_> =
            fs::read_dir(folder(name)).unwrap().map(|file| file.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{name}");
        let mut rng = Rng::new(7);
        for file in files {
            let seed = fs::read(&file).unwrap();
            target(&seed);
            for _ in 0..mutations * times {
                let mut data = seed.clone();
                mutate(&mut data, &mut rng);
                target(&data);
            }
        }
    }
}
