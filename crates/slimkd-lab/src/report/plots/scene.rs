//! Which plots there are.

use super::bars::{Bar, bars};
use super::chart::{Axis, Series, chart};
use super::{Figure, frontier};
use crate::basics::number::{Json, Number};
use crate::report::tables::{METHODS, MIB, SceneJson, effects, grouped, interval};

/// A preset's colour wherever it appears.
fn colour(preset: &str) -> usize {
    ["standard", "paper-fast", "paper-small", "slim", "tiny"]
        .iter()
        .position(|name| *name == preset)
        .unwrap_or(5)
}

fn figure(id: String, title: &str, note: String, svg: String) -> Figure {
    Figure { id, title: title.to_owned(), note, svg }
}

/// The parts of a tree's bytes, with their colours.
const PARTS: [(&str, usize); 4] = [("nodes", 2), ("T-references", 6), ("indices", 4), ("other", 5)];

/// Bytes a triangle of those parts, and of all, of the tree whose bytes are at `pointer`.
fn bytes_a_triangle(scene: &SceneJson<'_>, pointer: &str) -> (Vec<Number>, Number) {
    let part = |key: &str| scene.number(&format!("{pointer}/{key}")) / scene.number("/triangles");
    (["nodes", "t_references", "indices", "other"].map(part).to_vec(), part("tree"))
}

/// A series for each of the scene's trees, which `points` has the points of.
fn of_trees(scene: &SceneJson<'_>, points: impl Fn(usize) -> Vec<(f64, Number)>) -> Vec<Series> {
    let trees = scene.trees().into_iter().enumerate();
    trees.map(|(tree, name)| Series::line(name, colour(name), points(tree))).collect()
}

/// Bytes a triangle by part, of every preset.
pub fn sizes(scene: &SceneJson<'_>) -> Figure {
    let own = scene.trees().into_iter().enumerate().map(|(index, name)| {
        let (parts, total) = bytes_a_triangle(scene, &format!("/trees/{index}/shape/bytes"));
        let saved = scene.tree(index, "/shape/bytes/tree").saved_of(&scene.tree(0, "/shape/bytes/tree"));
        let saved = if index > 0 { format!(" (−{} %)", grouped(saved.value, 0)) } else { String::new() };
        Bar {
            name: name.to_owned(),
            published: false,
            parts,
            remark: format!("{}{saved}", grouped(total.value, 1)),
        }
    });
    let mut all: Vec<_> = own.collect();
    let theirs = METHODS
        .iter()
        .filter_map(|(method, preset)| Some((preset, scene.published_row("tree_size", Some(method))?)));
    for (preset, at) in theirs {
        let number = |key: &str| scene.json.number(&format!("{at}/{key}"));
        let bytes = number("memory_mib") * MIB.into() / number("triangles");
        let indices = (number("indices_4byte") * 4.0.into() + number("indices_2byte") * 2.0.into())
            / number("triangles");
        let remark = grouped(bytes.value, 1);
        let nodes = bytes - indices.clone();
        let name = format!("{preset}, published");
        all.push(Bar { name, published: true, parts: vec![nodes, 0.0.into(), indices], remark });
    }
    let svg = bars("Bytes a triangle of every tree, by part", "tree, bytes a triangle", &PARTS, &all);
    let mut note = "What the tree adds to the indexed mesh.".to_owned();
    if scene.published().is_some() {
        note.push_str(&format!(
            " Pale: {}, whose nodes include their T-references.",
            scene.published_label().replace("published, ", "the published ")
        ));
    }
    figure(format!("{}-sizes", scene.slug()), "Tree size by part", note, svg)
}

/// Bytes a triangle on every scene.
pub fn sizes_of_all(json: Json<'_>) -> Figure {
    let count = json.list("/scenes").len();
    let scenes: Vec<_> = (0..count).map(|index| SceneJson { json, index }).collect();
    let names = scenes.iter().map(|scene| scene.name().to_owned()).collect();
    let mut presets: Vec<&str> = Vec::new();
    for name in scenes.iter().flat_map(SceneJson::trees) {
        if !presets.contains(&name) {
            presets.push(name);
        }
    }
    let series: Vec<_> = presets
        .into_iter()
        .map(|preset| {
            let point = |(index, scene): (usize, &SceneJson<'_>)| {
                let tree = scene.trees().into_iter().position(|name| name == preset)?;
                let bytes = scene.tree(tree, "/shape/bytes/tree") / scene.number("/triangles");
                Some((index as f64, bytes))
            };
            let points = scenes.iter().enumerate().filter_map(point).collect();
            Series { connected: false, ..Series::line(preset, colour(preset), points) }
        })
        .collect();
    let (x, y) = (Axis::named("scene", names), Axis::log("tree, bytes a triangle"));
    let svg = chart("Bytes a triangle of every tree on every scene", &x, &y, &series, "B/triangle");
    let note = "What the tree adds to the indexed mesh; logarithmic.".to_owned();
    figure("sizes".to_owned(), "Tree size on every scene", note, svg)
}

/// Triangles by number of references.
pub fn duplication(scene: &SceneJson<'_>) -> Figure {
    let rows = scene.json.list(&scene.at("/trees/0/longest_edges"));
    // Fewest references first.
    let order: Vec<usize> = (0..rows.len()).rev().collect();
    let names = order.iter().map(|&row| {
        let end = |key: &str| rows[row][key].as_u64().unwrap_or(0);
        interval(end("from"), end("to"))
    });
    let names: Vec<_> = names.collect();
    let points = |number: &dyn Fn(usize) -> Number| -> Vec<_> {
        order.iter().enumerate().map(|(at, &row)| (at as f64, number(row))).collect()
    };
    let mut series =
        of_trees(scene, |tree| points(&|row| scene.tree(tree, &format!("/longest_edges/{row}/triangles"))));
    if scene.published().is_some() {
        let column = scene.published_column();
        let name = format!("standard, {}", scene.published_label());
        let number = |row| scene.json.number(&format!("/published/longest_edges/{row}/{column}_triangles"));
        series.push(Series { published: true, ..Series::line(name, 0, points(&number)) });
    }
    let (x, y) = (Axis::named("references to a triangle", names), Axis::log("triangles"));
    let svg = chart("Triangles by number of references", &x, &y, &series, "triangles");
    let note = "Before and after; T-references included. No mark: no such triangle. Logarithmic.".to_owned();
    figure(format!("{}-duplication", scene.slug()), "How often triangles are repeated", note, svg)
}

/// Leaves by depth.
pub fn depths(scene: &SceneJson<'_>) -> Figure {
    let mut series = of_trees(scene, |tree| {
        let leaves = scene.json.list(&scene.at(&format!("/trees/{tree}/leaf_depths"))).len();
        (0..leaves).map(|depth| (depth as f64, scene.tree(tree, &format!("/leaf_depths/{depth}")))).collect()
    });
    // Many marks would hide the line.
    series.iter_mut().for_each(|series| series.marked = series.points.len() < 12);
    let (x, y) = (Axis::linear("depth of a leaf", Some(0.0)), Axis::linear("leaves", Some(0.0)));
    let svg = chart("Leaves by depth", &x, &y, &series, "leaves");
    let note = "Smaller trees are less deep, and their leaves lie higher.".to_owned();
    figure(format!("{}-depths", scene.slug()), "Depths of leaves", note, svg)
}

/// Rates relative to standard.
pub fn frames(scene: &SceneJson<'_>) -> Figure {
    let units = scene.json.list(&scene.at("/frames"));
    let names = units.iter().map(|unit| {
        let on = if unit["device"] == "gpu" { "GPU".to_owned() } else { format!("{} thr.", unit["threads"]) };
        format!("view {}, {on}", unit["view"])
    });
    let names = names.collect();
    let mut series = of_trees(scene, |tree| {
        let relative = |unit: usize| {
            let median =
                |tree: usize| scene.json.median(&scene.at(&format!("/frames/{unit}/presets/{tree}/seconds")));
            (unit as f64, Number::from(100.0) * median(0) / median(tree))
        };
        (0..units.len()).map(relative).collect()
    });
    series.iter_mut().for_each(|series| series.connected = false);
    let x = Axis::named("view and device", names);
    let y = Axis::linear("frame rate, % of standard", Some(100.0));
    let svg = chart("Frame rate relative to standard", &x, &y, &series, "%");
    let note = "Medians of alternating rounds; above 100 is faster than standard.".to_owned();
    figure(format!("{}-frames", scene.slug()), "Frame rate", note, svg)
}

/// The thresholds' effects: on size, and on rate.
pub fn thresholds(scene: &SceneJson<'_>) -> Vec<Figure> {
    let rows = scene.json.list(&scene.at("/sweep"));
    let series = |loss: bool| -> Vec<Series> {
        let line = |(row, value): (usize, &serde_json::Value)| {
            let point = |point: usize| {
                let (saved, lost) = effects(scene, row, point);
                let frequency = value["points"][point]["frequency"].as_f64().unwrap_or(0.0);
                ((frequency * 1e4).round() / 1e4, if loss { lost } else { saved })
            };
            let name = format!("occupancy {}", grouped(value["occupancy"].as_f64().unwrap_or(0.0), 1));
            let points = (0..value["points"].as_array().map_or(0, Vec::len)).map(point).collect();
            Series::line(name, row % 7, points)
        };
        rows.iter().enumerate().map(line).collect()
    };
    let x = || Axis::linear("frequency threshold", None);
    let size = chart(
        "Bytes saved by threshold",
        &x(),
        &Axis::linear("bytes saved, %", Some(0.0)),
        &series(false),
        "%",
    );
    let rate = chart(
        "Time lost by threshold",
        &x(),
        &Axis::linear("slower than standard, %", Some(0.0)),
        &series(true),
        "%",
    );
    let slug = scene.slug();
    vec![
        figure(
            format!("{slug}-thresholds-size"),
            "Thresholds and size",
            "Against standard. Low thresholds move more triangles up.".to_owned(),
            size,
        ),
        figure(
            format!("{slug}-thresholds-rate"),
            "Thresholds and frame rate",
            "Against standard, view 1, one thread; below 0 is faster.".to_owned(),
            rate,
        ),
    ]
}

/// The ablation's sizes.
pub fn steps(scene: &SceneJson<'_>) -> Figure {
    let steps = scene.json.list(&scene.at("/ablation/steps")).iter().enumerate();
    let all: Vec<_> = steps
        .map(|(index, step)| {
            let (parts, total) = bytes_a_triangle(scene, &format!("/ablation/steps/{index}/shape/bytes"));
            let name = step["name"].as_str().unwrap_or_default().to_owned();
            Bar { name, published: false, parts, remark: grouped(total.value, 1) }
        })
        .collect();
    let svg = bars("Bytes a triangle, step by step", "tree, bytes a triangle", &PARTS, &all);
    let note = "From standard to tiny: what each step takes off.".to_owned();
    figure(format!("{}-ablation", scene.slug()), "Step by step", note, svg)
}

/// Build time against size.
pub fn scaling(json: Json<'_>) -> Figure {
    let points = json.list("/scaling");
    let mut series: Vec<Series> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        let (tree, triangles) =
            (point["tree"].as_str().unwrap_or_default(), point["triangles"].as_f64().unwrap_or(1.0));
        for (build, value) in point["builds"].as_array().into_iter().flatten().enumerate() {
            let threads = &value["threads"];
            let unit = if *threads == 1 { "thread" } else { "threads" };
            let name = format!("{tree}, {threads} {unit}");
            let number = json.median(&format!("/scaling/{index}/builds/{build}/seconds"));
            match series.iter_mut().find(|series| series.name == name) {
                Some(series) => series.points.push((triangles, number)),
                None => {
                    let line = Series::line(name, colour(tree), vec![(triangles, number)]);
                    series.push(Series { published: *threads != 1, ..line });
                }
            }
        }
    }
    let svg = chart("Build time by size", &Axis::log("triangles"), &Axis::log("build, s"), &series, "s");
    let note =
        format!("The built-in scene {}. Hollow and dashed: all threads.", json.text("/scaling/0/scene"));
    figure("scaling".to_owned(), "Build time against scene size", note, svg)
}

/// Size against speed beside other libraries, a figure a scene.
pub fn peers(json: Json<'_>) -> Vec<Figure> {
    let mut figures = Vec::new();
    for index in 0..json.list("/peers").len() {
        let Ok(peers) = serde_json::from_value(json.value(&format!("/peers/{index}")).clone()) else {
            continue;
        };
        let panel = frontier::Panel::new(&peers, "bounce", "best", true);
        let horizontal = "bytes a triangle that must stay in memory, mesh included";
        let svg = frontier::figure(&panel, "diffuse bounce rays, million a second", horizontal);
        let title = format!("Beside other libraries: {}", panel.title());
        let note = "One thread; each contender's fastest interface. Left and up is better.".to_owned();
        figures.push(figure(format!("peers-{}", crate::measure::slug(&peers.scene.name)), &title, note, svg));
    }
    figures
}
