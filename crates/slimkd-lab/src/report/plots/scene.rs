//! Which plots there are.

use super::bars::{Bar, bars};
use super::chart::{Axis, Series, chart};
use super::{Figure, frontier};
use crate::basics::number::{Json, Number};
use crate::report::tables::{METHODS, MIB, SceneJson, effects, grouped};

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

/// Bytes a triangle by part, of every preset.
pub fn sizes(scene: &SceneJson<'_>) -> Figure {
    let triangles = scene.number("/triangles");
    let own = scene.trees().into_iter().enumerate().map(|(index, name)| {
        let part = |key: &str| scene.tree(index, &format!("/shape/bytes/{key}")) / triangles.clone();
        let total = part("tree");
        let parts = vec![part("nodes"), part("t_references"), part("indices"), part("other")];
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
    let parts = [("nodes", 2), ("T-references", 6), ("indices", 4), ("other", 5)];
    let svg = bars("Bytes a triangle of every tree, by part", "tree, bytes a triangle", &parts, &all);
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
        .map(|preset| Series {
            name: preset.to_owned(),
            colour: colour(preset),
            published: false,
            connected: false,
            marked: true,
            points: scenes
                .iter()
                .enumerate()
                .filter_map(|(index, scene)| {
                    let tree = scene.trees().into_iter().position(|name| name == preset)?;
                    let bytes = scene.tree(tree, "/shape/bytes/tree") / scene.number("/triangles");
                    Some((index as f64, bytes))
                })
                .collect(),
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
        let (from, to) = (rows[row]["from"].as_u64().unwrap_or(0), rows[row]["to"].as_u64().unwrap_or(0));
        if to >= u64::from(u32::MAX) {
            format!("over {}", grouped(from as f64 - 1.0, 0))
        } else {
            format!("{}–{}", grouped(from as f64, 0), grouped(to as f64, 0))
        }
    });
    let names: Vec<_> = names.collect();
    let mut series: Vec<_> = scene
        .trees()
        .into_iter()
        .enumerate()
        .map(|(tree, name)| Series {
            name: name.to_owned(),
            colour: colour(name),
            published: false,
            connected: true,
            marked: true,
            points: order
                .iter()
                .enumerate()
                .map(|(at, row)| (at as f64, scene.tree(tree, &format!("/longest_edges/{row}/triangles"))))
                .collect(),
        })
        .collect();
    if scene.published().is_some() {
        let column = scene.published_column();
        series.push(Series {
            name: format!("standard, {}", scene.published_label()),
            colour: 0,
            published: true,
            connected: true,
            marked: true,
            points: order
                .iter()
                .enumerate()
                .map(|(at, row)| {
                    let pointer = format!("/published/longest_edges/{row}/{column}_triangles");
                    (at as f64, scene.json.number(&pointer))
                })
                .collect(),
        });
    }
    let (x, y) = (Axis::named("references to a triangle", names), Axis::log("triangles"));
    let svg = chart("Triangles by number of references", &x, &y, &series, "triangles");
    let note = "Before and after; T-references included. No mark: no such triangle. Logarithmic.".to_owned();
    figure(format!("{}-duplication", scene.slug()), "How often triangles are repeated", note, svg)
}

/// Leaves by depth.
pub fn depths(scene: &SceneJson<'_>) -> Figure {
    let series: Vec<_> = scene
        .trees()
        .into_iter()
        .enumerate()
        .map(|(tree, name)| {
            let leaves = scene.json.list(&scene.at(&format!("/trees/{tree}/leaf_depths"))).len();
            Series {
                name: name.to_owned(),
                colour: colour(name),
                published: false,
                connected: true,
                marked: leaves < 12,
                points: (0..leaves)
                    .map(|depth| (depth as f64, scene.tree(tree, &format!("/leaf_depths/{depth}"))))
                    .collect(),
            }
        })
        .collect();
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
    let series: Vec<_> = scene
        .trees()
        .into_iter()
        .enumerate()
        .map(|(tree, name)| Series {
            name: name.to_owned(),
            colour: colour(name),
            published: false,
            connected: false,
            marked: true,
            points: (0..units.len())
                .map(|unit| {
                    let median = |tree: usize| {
                        scene.json.median(&scene.at(&format!("/frames/{unit}/presets/{tree}/seconds")))
                    };
                    (unit as f64, Number::from(100.0) * median(0) / median(tree))
                })
                .collect(),
        })
        .collect();
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
        let line = |(row, value): (usize, &serde_json::Value)| Series {
            name: format!("occupancy {}", grouped(value["occupancy"].as_f64().unwrap_or(0.0), 1)),
            colour: row % 7,
            published: false,
            connected: true,
            marked: true,
            points: (0..value["points"].as_array().map_or(0, Vec::len))
                .map(|point| {
                    let (saved, lost) = effects(scene, row, point);
                    let frequency = value["points"][point]["frequency"].as_f64().unwrap_or(0.0);
                    ((frequency * 1e4).round() / 1e4, if loss { lost } else { saved })
                })
                .collect(),
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
    let triangles = scene.number("/triangles");
    let steps = scene.json.list(&scene.at("/ablation/steps"));
    let all: Vec<_> = steps
        .iter()
        .enumerate()
        .map(|(index, step)| {
            let part = |key: &str| {
                scene.number(&format!("/ablation/steps/{index}/shape/bytes/{key}")) / triangles.clone()
            };
            let remark = grouped(part("tree").value, 1);
            let parts = vec![part("nodes"), part("t_references"), part("indices"), part("other")];
            Bar {
                name: step["name"].as_str().unwrap_or_default().to_owned(),
                published: false,
                parts,
                remark,
            }
        })
        .collect();
    let parts = [("nodes", 2), ("T-references", 6), ("indices", 4), ("other", 5)];
    let svg = bars("Bytes a triangle, step by step", "tree, bytes a triangle", &parts, &all);
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
                None => series.push(Series {
                    name,
                    colour: colour(tree),
                    published: *threads != 1,
                    connected: true,
                    marked: true,
                    points: vec![(triangles, number)],
                }),
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
