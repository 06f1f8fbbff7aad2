//! What the two thresholds do.

use super::speed::slower;
use super::{SceneJson, Table, row};
use crate::basics::number::Number;

/// Size and rate of the tree at a row and point of the sweep, against standard: saved and slower, per cent.
pub(crate) fn effects(scene: &SceneJson<'_>, row: usize, point: usize) -> (Number, Number) {
    let at = |rest: &str| format!("/sweep/{row}/{rest}");
    let bytes = scene.number(&at(&format!("points/{point}/shape/bytes/tree")));
    let own = scene.json.median(&scene.at(&at(&format!("points/{point}/seconds"))));
    let base = scene.json.median(&scene.at(&at("standard_seconds")));
    let saved = bytes.saved_of(&scene.number(&at("standard_bytes")));
    (saved, slower(&own, &base))
}

/// All points.
pub fn sweep(scene: &SceneJson<'_>) -> Table {
    let edge = scene.json.number("/options/sweep_edge").value as u32;
    let mut table = Table::new(
        format!("{}-thresholds", scene.slug()),
        "Effect of the thresholds",
        &format!(
            "The paper's tree at other thresholds. Slower: against standard; view 1, {edge} × {edge} pixels, one thread, \
             medians of alternating rounds."
        ),
        &["occupancy", "frequency", "T-inner nodes", "nodes", "tree, B/triangle", "saved, %", "slower, %"],
    );
    for (line, value) in scene.json.list(&scene.at("/sweep")).iter().enumerate() {
        for point in 0..value["points"].as_array().map_or(0, Vec::len) {
            let number = |key: &str| scene.number(&format!("/sweep/{line}/points/{point}/{key}"));
            let node = |kind: &str| number(&format!("shape/nodes/{kind}"));
            let (saved, loss) = effects(scene, line, point);
            table.ours(row![
                (scene.number(&format!("/sweep/{line}/occupancy")), 1),
                (number("frequency"), 1),
                node("t_inner"),
                node("inner") + node("t_inner") + node("leaf"),
                (number("shape/bytes/tree") / scene.number("/triangles"), 2),
                (saved, 1),
                (loss, 1),
            ]);
        }
    }
    table
}
