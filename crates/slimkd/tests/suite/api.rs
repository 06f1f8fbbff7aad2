//! The public interface as it was agreed on: a change of it is meant, or it is found here.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Signatures of all that is public. The lint `unreachable_pub` sees to it that `pub` means public.
fn interface(folder: &Path, out: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            interface(&path, out);
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        let mut owner = String::new();
        let mut lines = code.lines().peekable();
        while let Some(line) = lines.next() {
            if line.starts_with("impl") || line.starts_with("pub trait") {
                owner = line.trim_end_matches(" {").trim_end_matches(" {}").to_owned();
            } else if line.starts_with("pub struct") || line.starts_with("pub enum") {
                owner = line.split(['{', '(']).next().unwrap().trim().trim_start_matches("pub ").to_owned();
            }
            let inside = line.starts_with("    ");
            let trimmed = line.trim();
            let is_item = trimmed.starts_with("pub ") && !trimmed.starts_with("pub use");
            let is_verb = inside && owner.starts_with("pub trait") && trimmed.starts_with("fn ");
            if !is_item && !is_verb {
                continue;
            }
            let mut item = trimmed.to_owned();
            while !item.ends_with('{') && !item.ends_with(';') && !item.ends_with(',') && !item.ends_with('}')
            {
                let Some(next) = lines.next() else { break };
                item = format!("{item} {}", next.trim());
            }
            let item =
                item.trim_end_matches(['{', ';', ',']).trim_end().replace("( ", "(").replace(", )", ")");
            let of = if inside { format!("{owner}: ") } else { String::new() };
            out.insert(format!("{of}{item}"));
        }
    }
}

#[test]
fn the_public_interface_is_the_one_that_was_agreed_on() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = BTreeSet::new();
    interface(&package.join("src"), &mut found);
    let found = found.into_iter().collect::<Vec<_>>().join("\n") + "\n";
    let kept = package.join("tests/api.txt");
    if std::env::var_os("SLIMKD_API").is_some() {
        fs::write(&kept, &found).unwrap();
    }
    let agreed = fs::read_to_string(&kept).unwrap_or_default();
    let (old, new): (BTreeSet<_>, BTreeSet<_>) = (agreed.lines().collect(), found.lines().collect());
    let gone: Vec<_> = old.difference(&new).map(|line| format!("- {line}")).collect();
    let come: Vec<_> = new.difference(&old).map(|line| format!("+ {line}")).collect();
    assert!(
        gone.is_empty() && come.is_empty(),
        "the public interface changed:\n{}\nIf that is meant, say so in CHANGELOG.md and run this test with SLIMKD_API=1.",
        [gone, come].concat().join("\n")
    );
}
