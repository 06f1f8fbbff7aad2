//! Arrows between the rooms of a crate, read from its sources.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            out.push(path);
        }
    }
}

/// The code of a file: without comments, since documentation may point anywhere.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// The rooms that code names by `crate::room` or `$crate::room`.
fn used(code: &str) -> BTreeSet<&str> {
    let names = code.split("crate::").skip(1);
    names.map(|rest| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("")).collect()
}

/// Checks that each room of `src` uses only itself and those before it in `rooms`, and that there are no others.
pub fn assert_arrows_point_down(src: &Path, rooms: &[&str]) {
    let mut files = Vec::new();
    sources(src, &mut files);
    let (mut upward, mut seen) = (Vec::new(), BTreeSet::new());
    for file in files {
        let inside = file.strip_prefix(src).unwrap();
        let room = inside.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        if room == "lib" {
            continue;
        }
        let floor = rooms.iter().position(|name| *name == room);
        let floor =
            floor.unwrap_or_else(|| panic!("{room} is no room: add it to this list and to ARCHITECTURE.md"));
        seen.insert(room.to_owned());
        let text = fs::read_to_string(&file).unwrap();
        for name in used(&code(&text)) {
            match rooms.iter().position(|other| *other == name) {
                Some(other) if other > floor => upward.push(format!("{}: uses {name}", inside.display())),
                Some(_) => {}
                // A re-export of the root hides which room it is from.
                None => upward.push(format!("{}: names crate::{name}, which is no room", inside.display())),
            }
        }
    }
    assert_eq!(seen.len(), rooms.len(), "a room of the list has no file");
    assert!(upward.is_empty(), "arrows that point up:\n{}", upward.join("\n"));
}

/// The rooms in the table of `ARCHITECTURE.md` whose first column is called so.
pub fn rooms_of_page<'a>(page: &'a str, first_column: &str, heading: &str) -> Vec<&'a str> {
    let table = page.lines().skip_while(|line| *line != heading);
    let rows = table.skip_while(|line| !line.starts_with(&format!("| {first_column} |"))).skip(2);
    rows.map_while(|line| {
        line.strip_prefix("| `")?.split_once('`').map(|(name, _)| name.trim_end_matches('/'))
    })
    .collect()
}
