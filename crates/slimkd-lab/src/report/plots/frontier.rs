//! Size against speed as SVG: a panel a scene, bytes on a logarithmic axis, rays a second upwards.
//!
//! Colours are Okabe & Ito's, which colour-blind people tell apart (*Color Universal Design*, 2008); shapes tell the same.

use super::svg::{THEME, escape};
use crate::report::tables::grouped;
use crate::schema::Peers;
use std::collections::BTreeMap;
use std::fmt::Write as _;

const PANEL: (f64, f64) = (460.0, 340.0);
/// Left, top, right, bottom of the axes inside a panel.
const MARGIN: (f64, f64, f64, f64) = (52.0, 34.0, 16.0, 46.0);
const COLUMNS: usize = 2;
/// Width of a character of a label, pixels: what keeps labels apart.
const CHARACTER: f64 = 7.5;
const LABEL_HEIGHT: f64 = 11.0;
/// The first places for a label, directly beside its mark.
const BESIDE: usize = 6;
/// A label farther from its mark than this is tied to it by a line, pixels.
const NEAR: f64 = 9.0;

/// What a mark stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Preset,
    /// A named series of variants: `slimkd-SERIES:POINT`.
    Sweep,
    Peer,
}

/// One contender.
#[derive(Clone, Debug, PartialEq)]
struct Mark {
    name: String,
    family: Family,
    bytes: f64,
    rate: f64,
}

/// One scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    title: String,
    marks: Vec<Mark>,
}

impl Panel {
    /// The points of a report on one thread. `interface` is a name, or `best` for the fastest of each contender.
    /// Contenders whose hits are marked as wrong stay out.
    pub fn new(report: &Peers, workload: &str, interface: &str, resident: bool) -> Self {
        let triangles = report.scene.triangles.max(1) as f64;
        let mut best: BTreeMap<&str, Mark> = BTreeMap::new();
        for point in report.points.iter().filter(|p| p.threads == 1 && !p.marked) {
            let Some(&rate) = point.mrays.get(workload) else { continue };
            // Peers have the interfaces that they have.
            if interface != "best" && point.interface != interface && point.name.starts_with("slimkd") {
                continue;
            }
            let own = point.name.strip_prefix("slimkd-");
            let family = match own {
                Some(name) if name.contains(':') => Family::Sweep,
                Some(_) => Family::Preset,
                None => Family::Peer,
            };
            let bytes = if resident { point.bytes_resident } else { point.bytes_tree };
            let name = own.unwrap_or(&point.name).to_owned();
            let mark = Mark { name, family, bytes: bytes as f64 / triangles, rate };
            let kept = best.entry(&point.name).or_insert_with(|| mark.clone());
            if rate > kept.rate {
                *kept = mark;
            }
        }
        let title = format!("{}, {} triangles", report.scene.name, grouped(report.scene.triangles as f64, 0));
        Self { title, marks: best.into_values().collect() }
    }

    /// The scene and its size.
    pub fn title(&self) -> &str {
        &self.title
    }
}

/// The picture. `vertical` and `horizontal` are what the axes count.
pub fn frontier(panels: &[Panel], vertical: &str, horizontal: &str) -> String {
    let columns = COLUMNS.min(panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let (width, height) = (PANEL.0 * columns as f64, PANEL.1 * rows as f64 + 24.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {width} {height}\">\n<style>\n{THEME}</style>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"var(--paper)\"/>\n"
    );
    for (index, panel) in panels.iter().enumerate() {
        let (x, y) = (PANEL.0 * (index % columns) as f64, PANEL.1 * (index / columns) as f64);
        let _ = writeln!(out, "<g transform=\"translate({x} {y})\">");
        draw(&mut out, panel, vertical, horizontal);
        out.push_str("</g>\n");
    }
    key(&mut out, height - 10.0);
    out + "</svg>\n"
}

/// One panel as a figure of a page, which gives the colours; its title stands beside it.
pub(super) fn figure(panel: &Panel, vertical: &str, horizontal: &str) -> String {
    let (width, height) = (PANEL.0, PANEL.1 + 24.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{}\">\n",
        escape(&panel.title)
    );
    draw(&mut out, panel, vertical, horizontal);
    key(&mut out, height - 10.0);
    out + "</svg>"
}

/// What marks stand for, at height `y`.
fn key(out: &mut String, y: f64) {
    let _ = writeln!(
        out,
        "<circle fill=\"var(--c3)\" cx=\"60\" cy=\"{y}\" r=\"5\"/><text x=\"70\" y=\"{t}\">slimkd presets</text>\
         <circle fill=\"var(--c2)\" cx=\"180\" cy=\"{y}\" r=\"3\"/><text x=\"190\" y=\"{t}\">slimkd sweeps</text>\
         <rect fill=\"var(--c5)\" x=\"296\" y=\"{s}\" width=\"8\" height=\"8\"/><text x=\"310\" y=\"{t}\">other \
         libraries</text>",
        t = y + 3.5,
        s = y - 4.0
    );
}

fn draw(out: &mut String, panel: &Panel, vertical: &str, horizontal: &str) {
    let (left, top, right, bottom) = (MARGIN.0, MARGIN.1, PANEL.0 - MARGIN.2, PANEL.1 - MARGIN.3);
    let _ = writeln!(
        out,
        "<text x=\"{left}\" y=\"18\" font-size=\"12\" font-weight=\"bold\">{}</text>",
        escape(&panel.title)
    );
    if panel.marks.is_empty() {
        let _ = writeln!(out, "<text x=\"{left}\" y=\"60\">no measurement of these rays</text>");
        return;
    }
    let bytes = panel.marks.iter().map(|mark| mark.bytes.max(0.1).log10());
    let (low, high) = bytes.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    let (low, high) = (low - 0.1, high + 0.25);
    let most = 1.08 * panel.marks.iter().map(|mark| mark.rate).fold(0.0, f64::max);
    let x = |bytes: f64| left + (bytes.max(0.1).log10() - low) / (high - low) * (right - left);
    let y = |rate: f64| bottom - rate / most * (bottom - top);

    for tick in [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0] {
        if (low..high).contains(&f64::log10(tick)) {
            let at = x(tick);
            let _ = writeln!(
                out,
                "<path class=\"grid\" d=\"M{at:.1} {top}V{bottom}\"/><text x=\"{at:.1}\" y=\"{}\" \
                 text-anchor=\"middle\">{tick}</text>",
                bottom + 14.0
            );
        }
    }
    let step = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0]
        .into_iter()
        .find(|s| most / s <= 7.0)
        .unwrap_or(100.0);
    for index in 0..=(most / step) as u32 {
        let rate = step * f64::from(index);
        let at = y(rate);
        let _ = writeln!(
            out,
            "<path class=\"grid\" d=\"M{left} {at:.1}H{right}\"/><text x=\"{}\" y=\"{:.1}\" \
             text-anchor=\"end\">{}</text>",
            left - 5.0,
            at + 3.5,
            (rate * 10.0).round() / 10.0
        );
    }
    let _ = writeln!(
        out,
        "<path class=\"axis\" d=\"M{left} {top}V{bottom}H{right}\"/>\
         <text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{horizontal}</text>\
         <text transform=\"translate(14 {:.1}) rotate(-90)\" text-anchor=\"middle\">{vertical}</text>",
        (left + right) / 2.0,
        bottom + 30.0,
        (top + bottom) / 2.0
    );

    let mut series: BTreeMap<&str, Vec<&Mark>> = BTreeMap::new();
    for mark in panel.marks.iter().filter(|mark| mark.family == Family::Sweep) {
        series.entry(mark.name.split(':').next().unwrap_or_default()).or_default().push(mark);
    }
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for marks in series.values_mut() {
        marks.sort_by(|a, b| a.bytes.total_cmp(&b.bytes));
        let points: Vec<String> =
            marks.iter().map(|m| format!("{:.1} {:.1}", x(m.bytes), y(m.rate))).collect();
        let _ = writeln!(out, "<path fill=\"none\" stroke=\"var(--c2)\" d=\"M{}\"/>", points.join("L"));
    }
    for mark in &panel.marks {
        let (at_x, at_y) = (x(mark.bytes), y(mark.rate));
        taken.push([at_x - 5.0, at_y - 5.0, at_x + 5.0, at_y + 5.0]);
        let _ = match mark.family {
            Family::Preset => {
                writeln!(out, "<circle fill=\"var(--c3)\" cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"5\"/>")
            }
            Family::Sweep => {
                writeln!(out, "<circle fill=\"var(--c2)\" cx=\"{at_x:.1}\" cy=\"{at_y:.1}\" r=\"3\"/>")
            }
            Family::Peer => writeln!(
                out,
                "<rect fill=\"var(--c5)\" x=\"{:.1}\" y=\"{:.1}\" width=\"8\" height=\"8\"/>",
                at_x - 4.0,
                at_y - 4.0
            ),
        };
    }
    // Presets first: theirs are the labels that must be found.
    let mut labelled: Vec<&Mark> = panel.marks.iter().collect();
    labelled.sort_by_key(|mark| match mark.family {
        Family::Preset => 0,
        Family::Peer => 1,
        Family::Sweep => 2,
    });
    for mark in labelled {
        let text = mark.name.split_once(':').map_or(mark.name.as_str(), |(_, point)| point);
        let (at_x, at_y) = (x(mark.bytes), y(mark.rate));
        let long = CHARACTER * text.chars().count() as f64;
        let box_at = |(dx, dy): (f64, f64)| {
            let (x, y) = (at_x + dx, at_y + dy);
            [x, y - LABEL_HEIGHT + 2.0, x + long, y + 2.0]
        };
        // The curve says what its points are: theirs are left out where there is no room beside them.
        let tried = if mark.family == Family::Sweep { BESIDE } else { usize::MAX };
        let free = places(long).take(tried).map(box_at).find(|own| {
            let inside = own[0] > left && own[2] < right + 10.0 && own[1] > top - 14.0 && own[3] < bottom;
            inside && taken.iter().all(|other| apart(own, other))
        });
        if let Some(own) = free {
            let [x, above, end, below] = own;
            taken.push(own);
            let (to_x, to_y) = (at_x.clamp(x, end), at_y.clamp(above, below));
            if (to_x - at_x).hypot(to_y - at_y) > NEAR {
                let _ =
                    writeln!(out, "<path class=\"axis\" d=\"M{at_x:.1} {at_y:.1}L{to_x:.1} {to_y:.1}\"/>");
            }
            let weight = if mark.family == Family::Preset { " font-weight=\"bold\"" } else { "" };
            let _ =
                writeln!(out, "<text x=\"{x:.1}\" y=\"{:.1}\"{weight}>{}</text>", below - 2.0, escape(text));
        }
    }
}

/// Where a label of that length may begin, from its mark: beside it, else farther away in eight directions.
fn places(long: f64) -> impl Iterator<Item = (f64, f64)> {
    let near =
        [(8.0, 4.0), (-8.0 - long, 4.0), (-long / 2.0, -8.0), (-long / 2.0, 16.0), (8.0, -8.0), (8.0, 14.0)];
    let far = [22.0, 36.0, 52.0, 70.0].into_iter().flat_map(move |r: f64| {
        let (right, left, middle) = (0.7 * r, -0.7 * r - long, -long / 2.0);
        let (up, down) = (-0.7 * r, 0.7 * r + 8.0);
        [
            (r, 4.0),
            (right, up),
            (right, down),
            (middle, -r),
            (middle, r + 8.0),
            (left, up),
            (left, down),
            (-r - long, 4.0),
        ]
    });
    near.into_iter().chain(far)
}

fn apart(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mark_is_inside_its_panel() {
        let mark = |name: &str, family, bytes, rate| Mark { name: name.into(), family, bytes, rate };
        let panel = Panel {
            title: "a scene".into(),
            marks: vec![
                mark("slim", Family::Preset, 5.0, 1.0),
                mark("l:0.1", Family::Sweep, 3.0, 0.9),
                mark("l:0.2", Family::Sweep, 2.0, 0.8),
                mark("peer", Family::Peer, 800.0, 2.0),
            ],
        };
        let svg = frontier(&[panel.clone(), panel], "rays", "bytes");
        for part in svg.split("cx=\"").skip(1) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((0.0..=PANEL.0).contains(&x), "{x}");
        }
        assert_eq!(svg.matches("stroke=\"var(--c2)\"").count(), 2);
        assert!(svg.contains(">slim</text>") && svg.contains(">0.1</text>"));
        assert!(frontier(&[], "rays", "bytes").ends_with("</svg>\n"));
    }
}
