//! Arrows point down: a room of the library uses only itself and the rooms below it.

use crate::common::layers::{assert_arrows_point_down, rooms_of_page};
use std::fs;
use std::path::Path;

/// The rooms of `src`, lowest first, as `ARCHITECTURE.md` lists them.
const ROOMS: [&str; 13] = [
    "threads",
    "geometry",
    "simd",
    "options",
    "job",
    "plan",
    "layout",
    "construct",
    "reduce",
    "traverse",
    "query",
    "tree",
    "file",
];

#[test]
fn arrows_point_down() {
    assert_arrows_point_down(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &ROOMS);
}

/// `ARCHITECTURE.md` names every room, in this order, and no file of its walk is missing.
#[test]
fn the_architecture_page_is_up_to_date() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let page = fs::read_to_string(crates.join("../ARCHITECTURE.md")).unwrap();
    assert_eq!(rooms_of_page(&page, "room", "## Inside `slimkd`: rooms, lowest floor first"), ROOMS);
    let walk = page.lines().skip_while(|line| !line.starts_with("| step |")).skip(2);
    let mut files = 0;
    for line in walk.take_while(|line| line.starts_with('|')) {
        let mut folder = String::from("slimkd/src");
        for part in line.split_once(" | ").unwrap().1.split(['`', ';', ',', '|']).map(str::trim) {
            if part.ends_with(".rs") {
                let named = [
                    format!("{folder}/{part}"),
                    format!("slimkd/src/{part}"),
                    part.replacen('/', "/src/", 1),
                ];
                let found = named.iter().any(|name| crates.join(name).exists());
                assert!(found, "{part} of the walk in ARCHITECTURE.md does not exist");
                files += 1;
            } else if let Some((first, rest)) = part.split_once('/') {
                folder = if first.starts_with("slimkd") {
                    format!("{first}/src/{rest}")
                } else {
                    format!("slimkd/src/{part}")
                };
            } else if part.starts_with("slimkd-") {
                folder = format!("{part}/src");
            } else if crates.join("slimkd/src").join(part).is_dir() && !part.is_empty() {
                folder = format!("slimkd/src/{part}");
            }
        }
    }
    assert!(files <= 60, "{files} files from a mesh to a pixel");
    assert!(page.contains(&format!("file by file; {files} in all")), "the walk has {files} files");
}
