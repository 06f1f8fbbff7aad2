//! Arrows point down inside the measuring crate too.

#[path = "../../../slimkd/tests/common/layers.rs"]
#[allow(unreachable_pub)]
mod arrows;

use arrows::{assert_arrows_point_down, rooms_of_page};
use std::fs;
use std::path::Path;

/// The rooms of `src`, lowest first, as `ARCHITECTURE.md` lists them.
const ROOMS: [&str; 6] = ["basics", "schema", "workload", "measure", "report", "bench"];

#[test]
fn arrows_point_down() {
    assert_arrows_point_down(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &ROOMS);
}

#[test]
fn the_architecture_page_is_up_to_date() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ARCHITECTURE.md");
    let page = fs::read_to_string(page).unwrap();
    assert_eq!(rooms_of_page(&page, "where", "## Inside `slimkd-lab`"), ROOMS);
}
