//! How long pictures and builds take, and what rays cost.

use super::scene::METHODS;
use super::{Cell, SceneJson, Table, row};
use crate::basics::number::Number;

/// Of a mean over nothing.
const UNKNOWN: f64 = f64::NAN;

/// How much longer than `base` something takes, per cent: what the paper calls degradation (0.867 frames a second
/// to 0.794 are 9.2 %).
pub(super) fn slower(seconds: &Number, base: &Number) -> Number {
    Number::from(100.0) * seconds.clone() / base.clone() - Number::from(100.0)
}

/// A frame unit's medians: the tree's and standard's, and how `device` and threads are called.
fn frame(scene: &SceneJson<'_>, unit: usize, tree: usize) -> (Number, Number) {
    let median =
        |tree: usize| scene.json.median(&scene.at(&format!("/frames/{unit}/presets/{tree}/seconds")));
    (median(tree), median(0))
}

/// Mean over the views on the CPU, on the fewest threads that were measured.
pub(super) fn mean_slower(scene: &SceneJson<'_>, tree: usize) -> Number {
    let on_cpu = || {
        let units = scene.json.list(&scene.at("/frames")).iter().enumerate();
        units.filter(|(_, unit)| unit["device"] == "cpu")
    };
    let fewest = on_cpu().filter_map(|(_, unit)| unit["threads"].as_u64()).min();
    let mut all = on_cpu().filter(|(_, unit)| unit["threads"].as_u64() == fewest).map(|(unit, _)| {
        let (own, base) = frame(scene, unit, tree);
        slower(&own, &base)
    });
    let Some(first) = all.next() else { return UNKNOWN.into() };
    let (sum, count) = all.fold((first, 1.0), |(sum, count), next| (sum + next, count + 1.0));
    sum / count.into()
}

/// Pictures a second.
pub fn frames(scene: &SceneJson<'_>) -> Table {
    let edge = scene.json.number("/options/frame_edge").value as u32;
    let mut table = Table::new(
        format!("{}-frames", scene.slug()),
        "Frame rate",
        &format!(
            "Whitted-style pictures of {edge} × {edge} pixels a second, one sample a pixel; medians of alternating rounds, after \
             the pictures were compared. Slower: what a picture takes longer than with standard, the paper's degradation."
        ),
        &["view", "device", "threads"],
    );
    let trees = scene.trees();
    for (index, name) in trees.iter().enumerate() {
        table.columns.push(format!("{name}, frames/s"));
        if index > 0 {
            table.columns.push("slower, %".to_owned());
        }
    }
    let units = scene.json.list(&scene.at("/frames"));
    for (unit, value) in units.iter().enumerate() {
        let mut cells = row![
            format!("view {}", value["view"]),
            value["device"].as_str().unwrap_or_default(),
            scene.number(&format!("/frames/{unit}/threads")),
        ];
        for tree in 0..trees.len() {
            let (own, base) = frame(scene, unit, tree);
            cells.push((Number::from(1.0) / own.clone(), 3).into());
            if tree > 0 {
                cells.push((slower(&own, &base), 1).into());
            }
        }
        table.ours(cells);
    }
    if scene.published_row("frame_rate", None).is_some() {
        for view in 1..=3 {
            for (device, threads, key) in
                [("cpu", 1.0, "cpu1"), ("cpu", 12.0, "cpu12"), ("gpu", UNKNOWN, "gpu")]
            {
                let rate = |method: &str| {
                    let at = scene.published_row("frame_rate", Some(method)).unwrap_or_default();
                    scene.json.number(&format!("{at}/view{view}_{key}"))
                };
                let mut cells: Vec<Cell> =
                    row![format!("view {view}, {}", scene.published_label()), device, Number::from(threads)];
                for (index, tree) in trees.iter().enumerate() {
                    match METHODS.iter().find(|(_, preset)| preset == tree) {
                        Some((method, _)) => {
                            cells.push((rate(method), 3).into());
                            if index > 0 {
                                // Rates are the inverse of times.
                                cells.push((slower(&rate("standard"), &rate(method)), 1).into());
                            }
                        }
                        None => cells.extend(row!["", ""]),
                    }
                }
                table.published(cells);
            }
        }
    }
    table
}

/// Build times.
pub fn builds(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-builds", scene.slug()),
        "Build time",
        "Wall time with reduction and encoding, medians. Theirs: a 3.1 GHz Xeon of 8 cores.",
        &["tree"],
    );
    let threads = scene.json.list(&scene.at("/trees/0/builds"));
    for build in threads {
        let unit = if build["threads"] == 1 { "thread" } else { "threads" };
        table.columns.push(format!("{} {unit}, s", build["threads"]));
        table.columns.push("× standard".to_owned());
    }
    for (index, name) in scene.trees().into_iter().enumerate() {
        let mut cells = row![name];
        for build in 0..threads.len() {
            let median =
                |tree: usize| scene.json.median(&scene.at(&format!("/trees/{tree}/builds/{build}/seconds")));
            cells.push((median(index), 3).into());
            cells.push((median(index) / median(0), 2).into());
        }
        table.ours(cells);
    }
    if let Some(at) = scene.published_row("build_time", None) {
        for (method, preset) in METHODS {
            let seconds = |method: &str| scene.json.number(&format!("{at}/{method}_s"));
            let mut cells = row![format!("{preset}, {}", scene.published_label())];
            // Their threads are not ours: the column of all of ours is the nearest.
            for build in 0..threads.len() {
                let last = build + 1 == threads.len();
                cells.push(if last { (seconds(method), 1).into() } else { "".into() });
                let ratio = (seconds(method) / seconds("standard"), 2);
                cells.push(if last { ratio.into() } else { "".into() });
            }
            table.published(cells);
        }
    }
    table
}

/// Nodes and tests a ray.
pub fn costs(scene: &SceneJson<'_>) -> Table {
    let mut table = Table::new(
        format!("{}-costs", scene.slug()),
        "What a ray costs",
        "Nodes visited and triangles tested by a single ray on its way to the nearest hit, means: counted, so the same on any \
         machine.",
        &["tree"],
    );
    let units = scene.json.list(&scene.at("/heat"));
    for unit in units {
        let rays = match unit["view"].as_u64() {
            Some(0) => "random rays".to_owned(),
            view => format!("view {}", view.unwrap_or_default()),
        };
        table.columns.push(format!("{rays}: nodes"));
        table.columns.push("tests".to_owned());
    }
    for (index, name) in scene.trees().into_iter().enumerate() {
        let mut cells = row![name];
        for unit in 0..units.len() {
            let number = |key: &str| scene.number(&format!("/heat/{unit}/presets/{index}/{key}"));
            cells.push((number("nodes") / number("rays"), 1).into());
            cells.push((number("tests") / number("rays"), 1).into());
        }
        table.ours(cells);
    }
    table
}

/// Step by step.
pub fn ablation(scene: &SceneJson<'_>) -> Table {
    let edge = scene.json.number("/options/sweep_edge").value as u32;
    let mut table = Table::new(
        format!("{}-ablation", scene.slug()),
        "Step by step",
        &format!(
            "Where the size goes. Slower: against standard; view 1, {edge} × {edge} pixels, one thread, medians of \
             alternating rounds."
        ),
        &["tree", "nodes", "indices in leaves", "T-references", "tree, B/triangle", "saved, %", "slower, %"],
    );
    for (index, step) in scene.json.list(&scene.at("/ablation/steps")).iter().enumerate() {
        let number = |step: usize, key: &str| scene.number(&format!("/ablation/steps/{step}/shape/{key}"));
        let seconds = |step: usize| scene.json.median(&scene.at(&format!("/ablation/steps/{step}/seconds")));
        let nodes =
            number(index, "nodes/inner") + number(index, "nodes/t_inner") + number(index, "nodes/leaf");
        let leaves = number(index, "references/leaf_4byte")
            + number(index, "references/leaf_2byte")
            + number(index, "references/leaf_other");
        let bytes = number(index, "bytes/tree");
        table.ours(row![
            step["name"].as_str().unwrap_or_default(),
            nodes,
            leaves,
            number(index, "references/t"),
            (bytes.clone() / scene.number("/triangles"), 2),
            (bytes.saved_of(&number(0, "bytes/tree")), 1),
            (slower(&seconds(index), &seconds(0)), 1),
        ]);
    }
    table
}
