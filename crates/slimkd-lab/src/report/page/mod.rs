//! The page: one HTML file with everything inside, a function of the raw JSON and the pictures.

mod scene;

use crate::basics::number::Json;
use crate::report::plots::{Figure, THEME, peers, scaling, sizes_of_all};
use crate::report::tables::{self, Cell, SceneJson, Table};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Everything else about how it looks.
const STYLE: &str = include_str!("style.css");

/// Letters of a line's head that are kept on one line.
const SHORT: usize = 40;

/// A picture's bytes by its name below the report's folder.
pub type Pictures<'a> = dyn Fn(&str) -> Option<Vec<u8>> + 'a;

/// A part of the page.
pub struct Section {
    /// Its anchor.
    pub id: String,
    /// Its head.
    pub title: String,
    /// What to know before.
    pub text: String,
    /// Plots.
    pub figures: Vec<Figure>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Pictures in groups.
    pub pictures: Vec<Group>,
}

/// Pictures that belong beside each other, with a scale.
pub struct Group {
    /// What they show.
    pub title: String,
    /// What the colours mean.
    pub scale: Scale,
    /// Words below and the file's name.
    pub pictures: Vec<(String, String)>,
}

/// What a group's colours mean.
pub enum Scale {
    /// They are pictures.
    None,
    /// Nodes and tests a pixel, up to the end of the scale.
    Heat(crate::basics::number::Number),
    /// References by class.
    Duplication,
}

/// All of a report, in order.
pub struct Content {
    /// Over all scenes.
    pub overview: Section,
    /// A scene each.
    pub scenes: Vec<(String, Vec<Section>)>,
    /// Builds and peers.
    pub beyond: Vec<Section>,
    /// With what.
    pub machine: Table,
}

impl Content {
    /// From the raw JSON.
    pub fn new(json: Json<'_>) -> Self {
        let all = (0..json.list("/scenes").len()).map(|index| SceneJson { json, index });
        let scenes: Vec<_> = all.map(|scene| (scene.name().to_owned(), scene::sections(&scene))).collect();
        let section = |id: &str, title: &str, figures, tables| Section {
            id: id.to_owned(),
            title: title.to_owned(),
            text: String::new(),
            figures,
            tables,
            pictures: Vec::new(),
        };
        // One scene's sizes have a better plot of their own.
        let all = if scenes.len() > 1 { vec![sizes_of_all(json)] } else { Vec::new() };
        let overview = section("overview", "In short", all, vec![tables::summary(json)]);
        let mut beyond = Vec::new();
        let very_large = tables::very_large(json);
        if !very_large.rows.is_empty() {
            beyond.push(section("very-large", "The very large scene", Vec::new(), vec![very_large]));
        }
        if !json.list("/scaling").is_empty() {
            beyond.push(section("scaling", "Building", vec![scaling(json)], vec![tables::scaling(json)]));
        }
        let peers = peers(json);
        if !peers.is_empty() {
            beyond.push(section("peers", "Beside other libraries", peers, Vec::new()));
        }
        Self { overview, scenes, beyond, machine: tables::machine(json) }
    }

    fn sections(&self) -> impl Iterator<Item = &Section> {
        let scenes = self.scenes.iter().flat_map(|(_, sections)| sections);
        std::iter::once(&self.overview).chain(scenes).chain(&self.beyond)
    }

    /// Every table.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.sections().flat_map(|section| &section.tables).chain([&self.machine])
    }

    /// Every plot.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.sections().flat_map(|section| &section.figures)
    }
}

/// The HTML. Pictures that are not there are left out.
pub fn page(content: &Content, pictures: &Pictures<'_>) -> String {
    let names: Vec<_> = content.scenes.iter().map(|(name, _)| name.as_str()).collect();
    let title = format!("slimkd report: {}", names.join(", "));
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(THEME)) (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { "Small kd-trees for ray tracing" }
                    p {
                        "The experiments of Choi, Chang & Ihm, "
                        em { "Improving Memory Space Efficiency of Kd-tree for Real-time Ray Tracing" }
                        " (Computer Graphics Forum 32(7), 2013), run again on these scenes, beside slimkd's own trees. "
                        "Published figures stand in shaded rows. Hover over a number to see which raw measurements it was computed \
                         from; compare times within one run only."
                    }
                    nav {
                        a href="#overview" { "In short" }
                        @for (index, name) in names.iter().enumerate() { a href={ "#scene-" (index) } { (name) } }
                        @for section in &content.beyond { a href={ "#" (section.id) } { (section.title) } }
                        a href="#machine" { "Machine" }
                    }
                }
                main {
                    (self::section(&content.overview, pictures, 2))
                    @for (index, (name, sections)) in content.scenes.iter().enumerate() {
                        h2.scene id={ "scene-" (index) } { (name) }
                        @for part in sections { (self::section(part, pictures, 3)) }
                    }
                    @for part in &content.beyond { (self::section(part, pictures, 2)) }
                    section id="machine" { h2 { "Measured with" } (table(&content.machine)) }
                }
                footer { "Written by slimkd report from raw.json; every table is a CSV in tables/, every plot an SVG in plots/." }
            }
        }
    };
    markup.into_string()
}

fn section(section: &Section, pictures: &Pictures<'_>, level: u8) -> Markup {
    html! {
        section id=(section.id) {
            @if level == 2 { h2 { (section.title) } } @else { h3 { (section.title) } }
            @if !section.text.is_empty() { p { (section.text) } }
            @for group in &section.pictures { (self::group(group, pictures)) }
            @if !section.figures.is_empty() {
                div.figures {
                    @for figure in &section.figures {
                        figure {
                            h4 { (figure.title) }
                            (PreEscaped(&figure.svg))
                            figcaption { (figure.note) }
                        }
                    }
                }
            }
            @for part in &section.tables { (table(part)) }
        }
    }
}

fn group(group: &Group, pictures: &Pictures<'_>) -> Markup {
    let found = group.pictures.iter().filter_map(|(words, name)| {
        let kind = if name.ends_with(".png") { "png" } else { "jpeg" };
        Some((words, format!("data:image/{kind};base64,{}", STANDARD.encode(pictures(name)?))))
    });
    let found: Vec<_> = found.collect();
    html! {
        @if !found.is_empty() {
            div.group {
                h4 { (group.title) }
                div.pictures {
                    @for (words, source) in &found {
                        figure { img src=(source) alt=(format!("{}: {words}", group.title)); figcaption { (words) } }
                    }
                }
                (scene::scale(&group.scale))
            }
        }
    }
}

fn table(table: &Table) -> Markup {
    html! {
        div.table {
            @if table.title != "Measured with" { h4 { (table.title) } }
            @if !table.note.is_empty() { p.note { (table.note) } }
            div.scroll tabindex="0" {
                table {
                    thead { tr { @for (column, head) in table.columns.iter().enumerate() { th.number[is_number(table, column)] { (head) } } } }
                    tbody {
                        @for row in &table.rows {
                            tr.published[row.published] {
                                @for (index, cell) in row.cells.iter().enumerate() { (self::cell(cell, index == 0)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// True for a column of numbers.
fn is_number(table: &Table, column: usize) -> bool {
    table.rows.iter().any(|row| matches!(row.cells.get(column), Some(Cell::Number(..))))
}

fn cell(cell: &Cell, first: bool) -> Markup {
    let text = cell.text();
    match cell {
        Cell::Text(_) if first => html! { th.short[text.chars().count() <= SHORT] { (text) } },
        Cell::Text(_) => html! { td { (text) } },
        Cell::Number(number, digits) => html! {
            td.number data-from=(number.from) data-digits=(digits) title=(number.from) { (text) }
        },
    }
}
