//! What trees look like inside.

use super::scene::METHODS;
use super::{Cell, SceneJson, Table, grouped};
use crate::basics::number::Number;

/// An interval of references, as the slides write it.
pub(crate) fn interval(from: u64, to: u64) -> String {
    let text = |number: u64| grouped(number as f64, 0);
    match (from, to) {
        (from, to) if from == to => text(from),
        (from, to) if to >= u64::from(u32::MAX) => format!("over {}", text(from - 1)),
        _ => format!("{} to {}", text(from), text(to)),
    }
}

/// Triangles by number of references, before and after.
pub fn duplication(scene: &SceneJson<'_>) -> Table {
    let trees = scene.trees();
    let methods: &[_] = if scene.published().is_some() { &METHODS } else { &[] };
    let mut columns = vec!["references".to_owned()];
    columns.extend(trees.iter().map(|&name| name.to_owned()));
    let label = scene.published_label();
    columns.extend(methods.iter().map(|(_, preset)| format!("{preset}, {label}")));
    let mut table = Table::new(
        format!("{}-duplication", scene.slug()),
        "How often triangles are repeated",
        "Triangles by their number of references, T-references included, in the slides' intervals. The last line is the mean.",
        &[],
    );
    table.columns = columns;
    let published = scene.json.list("/published/duplication_histogram");
    let column = scene.published_column();
    for row in 0..scene.json.list(&scene.at("/trees/0/duplication")).len() {
        let place = |tree: usize, key: &str| scene.tree(tree, &format!("/duplication/{row}/{key}"));
        let (from, to) = (place(0, "from").value as u64, place(0, "to").value as u64);
        let mut numbers: Vec<_> = (0..trees.len()).map(|tree| place(tree, "triangles")).collect();
        let theirs = published.iter().position(|row| row["references_from"].as_u64() == Some(from));
        for (method, _) in methods {
            let at = theirs.map(|row| format!("/published/duplication_histogram/{row}/{column}_{method}"));
            numbers.push(at.map_or(Number::from(f64::NAN), |at| scene.json.number(&at)));
        }
        if numbers.iter().any(|number| number.value > 0.0) {
            let cells = numbers.into_iter().map(Cell::from);
            table.ours(std::iter::once(interval(from, to).into()).chain(cells).collect());
        }
    }
    let mut mean: Vec<Cell> = vec!["references a triangle".into()];
    for tree in 0..trees.len() {
        let kind = |kind: &str| scene.tree(tree, &format!("/shape/references/{kind}"));
        let all = kind("leaf_4byte") + kind("leaf_2byte") + kind("leaf_other") + kind("t");
        mean.push((all / scene.number("/triangles"), 2).into());
    }
    for (method, _) in methods {
        let number = scene.published_row("tree_size", Some(method)).map(|at| {
            let number = |key: &str| scene.json.number(&format!("{at}/{key}"));
            (number("indices_4byte") + number("indices_2byte") + number("t_inner_nodes"))
                / number("triangles")
        });
        mean.push((number.unwrap_or(f64::NAN.into()), 2).into());
    }
    table.ours(mean);
    table
}

/// Large triangles are the repeated ones.
pub fn longest_edges(scene: &SceneJson<'_>) -> Table {
    let trees = scene.trees();
    let shown: Vec<usize> =
        (0..trees.len()).filter(|&tree| ["standard", "paper-small", "slim"].contains(&trees[tree])).collect();
    let theirs = scene.published().is_some();
    let mut table = Table::new(
        format!("{}-longest-edges", scene.slug()),
        "Which triangles are repeated",
        "Triangles by their number of references, and the mean length of their longest edges in scene units: large and \
         skinny triangles are the trouble.",
        &["references"],
    );
    for &tree in &shown {
        table.columns.push(format!("{}: triangles", trees[tree]));
        table.columns.push("mean longest edge".to_owned());
    }
    if theirs {
        table.columns.push(format!("standard, {}: triangles", scene.published_label()));
        table.columns.push("mean longest edge (published)".to_owned());
    }
    for row in 0..scene.json.list(&scene.at("/trees/0/longest_edges")).len() {
        let place = |tree: usize, key: &str| scene.tree(tree, &format!("/longest_edges/{row}/{key}"));
        let mut cells: Vec<Cell> =
            vec![interval(place(0, "from").value as u64, place(0, "to").value as u64).into()];
        for &tree in &shown {
            cells.push(place(tree, "triangles").into());
            cells.push((place(tree, "mean_longest_edge"), 3).into());
        }
        if theirs {
            let at = format!("/published/longest_edges/{row}/{}", scene.published_column());
            cells.push(scene.json.number(&format!("{at}_triangles")).into());
            cells.push((scene.json.number(&format!("{at}_mean_longest_edge")), 3).into());
        }
        table.ours(cells);
    }
    table
}

/// Depths.
pub fn depths(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-depths", scene.slug()),
        "Depth",
        "Of the deepest leaf; the root has depth 0. SAH cost: of a random ray that meets the scene's bounds, at each tree's own \
         constants.",
        &["tree", "depth", "leaves", "empty leaves", "SAH cost"],
    );
    for (index, name) in scene.trees().into_iter().enumerate() {
        let shape = |key: &str| scene.tree(index, &format!("/shape/{key}"));
        table.ours(super::row![
            name,
            shape("max_depth"),
            shape("nodes/leaf"),
            shape("nodes/empty_leaf"),
            (shape("sah_cost"), 1),
        ]);
    }
    if let Some(at) = scene.published_row("max_depth", None) {
        for (method, preset) in METHODS {
            let depth = scene.json.number(&format!("{at}/{method}"));
            table.published(super::row![format!("{preset}, {}", scene.published_label()), depth, "", "", ""]);
        }
    }
    table
}
