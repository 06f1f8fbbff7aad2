//! Tables over all scenes, and what they were made with.

use super::speed::mean_slower;
use super::{SceneJson, Table, row};
use crate::basics::number::Json;

/// The key table.
pub fn summary(json: Json<'_>) -> Table {
    let mut table = Table::new(
        "summary",
        "In short",
        "Bytes a triangle that the tree adds to the indexed mesh, what that saves against standard, and how much longer \
         pictures take: mean over the views on the fewest threads measured, negative where faster.",
        &["scene", "triangles", "tree", "B/triangle", "saved, %", "slower, %", "build, × standard"],
    );
    for index in 0..json.list("/scenes").len() {
        let scene = SceneJson { json, index };
        let base = scene.tree(0, "/shape/bytes/tree");
        let last = json.list(&scene.at("/trees/0/builds")).len().saturating_sub(1);
        for (tree, name) in scene.trees().into_iter().enumerate() {
            let bytes = scene.tree(tree, "/shape/bytes/tree");
            let build = |tree: usize| json.median(&scene.at(&format!("/trees/{tree}/builds/{last}/seconds")));
            table.ours(row![
                scene.name(),
                scene.number("/triangles"),
                name,
                (bytes.clone() / scene.number("/triangles"), 2),
                (bytes.saved_of(&base), 1),
                (mean_slower(&scene, tree), 1),
                (build(tree) / build(0), 2),
            ]);
        }
    }
    table
}

/// Builds at several sizes.
pub fn scaling(json: Json<'_>) -> Table {
    let name = json.text("/scaling/0/scene");
    let mut table = Table::new(
        "scaling",
        "Build time against scene size",
        &format!("The built-in scene {name}, medians."),
        &["triangles", "tree", "threads", "seconds", "thousand triangles/s"],
    );
    for (index, point) in json.list("/scaling").iter().enumerate() {
        for build in 0..point["builds"].as_array().map_or(0, Vec::len) {
            let at = |rest: &str| format!("/scaling/{index}/{rest}");
            let seconds = json.median(&at(&format!("builds/{build}/seconds")));
            let triangles = json.number(&at("triangles"));
            table.ours(row![
                triangles.clone(),
                point["tree"].as_str().unwrap_or_default(),
                json.number(&at(&format!("builds/{build}/threads"))),
                (seconds.clone(), 3),
                triangles / (crate::basics::number::Number::from(1000.0) * seconds),
            ]);
        }
    }
    table
}

/// With what it was measured.
pub fn machine(json: Json<'_>) -> Table {
    let mut table = Table::new("machine", "Measured with", "", &["what", "value"]);
    let list = |pointer: &str| {
        let texts =
            json.list(pointer).iter().map(|x| x.as_str().map_or_else(|| x.to_string(), str::to_owned));
        texts.collect::<Vec<_>>().join(", ")
    };
    table.ours(row!["tool", json.text("/tool")]);
    table.ours(row!["date", json.text("/date")]);
    table.ours(row!["processor", json.text("/machine/cpu")]);
    if let Some(gpu) = json.value("/machine/gpu").as_str() {
        table.ours(row!["GPU", gpu]);
    }
    table.ours(row!["system", format!("{}, {}", json.text("/machine/os"), json.text("/machine/arch"))]);
    table.ours(row!["threads at once", json.number("/machine/parallelism")]);
    table.ours(row!["vector extensions", list("/machine/detected")]);
    table.ours(row!["builds and frames on", format!("{} threads", list("/options/threads"))]);
    table.ours(row!["frames, pixels on an edge", json.number("/options/frame_edge")]);
    table.ours(row!["sweep and ablation, pixels on an edge", json.number("/options/sweep_edge")]);
    table.ours(row!["heat maps, pixels on an edge", json.number("/options/heat_edge")]);
    table.ours(row!["rounds", json.number("/options/rounds")]);
    table.ours(row!["builds of each tree", json.number("/options/builds")]);
    table.ours(row!["random rays", json.number("/options/random_rays")]);
    table.ours(row!["seed", json.number("/options/seed")]);
    table
}
