//! A scene's part of the page.

use super::{Group, Scale, Section};
use crate::basics::palette::{DUPLICATION, heat_colour, hex};
use crate::report::plots::{depths, duplication, frames, sizes, steps, thresholds};
use crate::report::tables::{self, SceneJson, grouped};
use maud::{Markup, html};

/// In the order of the talk.
pub(super) fn sections(scene: &SceneJson<'_>) -> Vec<Section> {
    let slug = scene.slug();
    let mut out = Vec::new();
    let mut add = |id: &str, title: &str, text: String, figures, tables, pictures| {
        out.push(Section {
            id: format!("{slug}-{id}"),
            title: title.to_owned(),
            text,
            figures,
            tables,
            pictures,
        });
    };
    let has = |key: &str| !scene.json.list(&scene.at(key)).is_empty();
    let about = format!(
        "{} triangles ({} of them collinear or not finite), {} vertices.",
        grouped(scene.number("/triangles").value, 0),
        grouped(scene.number("/degenerate").value, 0),
        grouped(scene.number("/vertices").value, 0)
    );
    add("views", "The scene", about, vec![], vec![], renders(scene));
    let size_tables = vec![tables::nodes(scene), tables::references(scene), tables::geometry(scene)];
    add("size", "Size", String::new(), vec![sizes(scene)], size_tables, vec![]);
    let shape_tables = vec![tables::duplication(scene), tables::longest_edges(scene), tables::depths(scene)];
    let shape_plots = vec![duplication(scene), depths(scene)];
    add("shape", "Repeated triangles, and depth", String::new(), shape_plots, shape_tables, repeated(scene));
    if has("/frames") {
        let speed_tables = vec![tables::frames(scene), tables::costs(scene), tables::builds(scene)];
        add("speed", "Speed", String::new(), vec![frames(scene)], speed_tables, heat(scene));
    }
    if has("/sweep") {
        add(
            "thresholds",
            "The paper's thresholds",
            String::new(),
            thresholds(scene),
            vec![tables::sweep(scene)],
            vec![],
        );
    }
    if has("/ablation/steps") {
        add(
            "ablation",
            "From standard to tiny",
            String::new(),
            vec![steps(scene)],
            vec![tables::ablation(scene)],
            vec![],
        );
    }
    out
}

fn renders(scene: &SceneJson<'_>) -> Vec<Group> {
    let pictures =
        scene.json.list(&scene.at("/pictures")).iter().filter(|picture| picture["kind"] == "render");
    let pictures = pictures.map(|picture| (format!("view {}", picture["view"]), text(&picture["picture"])));
    vec![Group { title: "Views".to_owned(), scale: Scale::None, pictures: pictures.collect() }]
}

/// The view that shows most of what is repeated in `standard` is as good as any: the first.
fn repeated(scene: &SceneJson<'_>) -> Vec<Group> {
    let all = scene.json.list(&scene.at("/pictures"));
    let pictures = all.iter().filter(|picture| picture["kind"] == "duplication" && picture["view"] == 1);
    let pictures = pictures.map(|picture| (text(&picture["tree"]), text(&picture["picture"])));
    vec![Group {
        title: "Triangles by their number of references, view 1".to_owned(),
        scale: Scale::Duplication,
        pictures: pictures.collect(),
    }]
}

fn heat(scene: &SceneJson<'_>) -> Vec<Group> {
    let units = scene.json.list(&scene.at("/heat")).iter().enumerate();
    let views = units.filter(|(_, unit)| unit["view"] != 0);
    let group = |(index, unit): (usize, &serde_json::Value)| {
        let presets = unit["presets"].as_array().into_iter().flatten();
        Group {
            title: format!(
                "What each pixel of view {} costs: nodes visited and triangles tested",
                unit["view"]
            ),
            scale: Scale::Heat(scene.number(&format!("/heat/{index}/scale_end"))),
            pictures: presets.map(|preset| (text(&preset["name"]), text(&preset["picture"]))).collect(),
        }
    };
    views.map(group).collect()
}

fn text(value: &serde_json::Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

/// The legend of a group's colours.
pub(super) fn scale(scale: &Scale) -> Markup {
    match scale {
        Scale::None => html! {},
        Scale::Duplication => html! {
            ul.key {
                @for (_, name, colour) in DUPLICATION {
                    li { span style={ "background:" (hex(colour)) } {} (name) }
                }
            }
        },
        Scale::Heat(end) => {
            let stops: Vec<_> = (0..=10).map(|k| hex(heat_colour(f64::from(k) / 10.0))).collect();
            html! {
                div.heat {
                    span { "0" }
                    span.ramp style={ "background:linear-gradient(to right," (stops.join(",")) ")" } {}
                    span data-from=(end.from) data-digits="0" title=(end.from) { (grouped(end.value, 0)) }
                    span { "and more, the same scale for all trees" }
                }
            }
        }
    }
}
