//! Points and lines over two axes.

use super::svg::{About, Anchor, Entry, Svg, WIDTH, legend, log_ticks, tick_text, ticks};
use crate::basics::number::Number;

const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
/// Height of the axes.
const HEIGHT: f64 = 230.0;

/// An axis.
pub(super) struct Axis {
    /// What it counts, with the unit.
    pub(super) label: String,
    pub(super) log: bool,
    /// Names of the places 0, 1, …, where they are no numbers.
    pub(super) names: Vec<String>,
    /// A value that must be on it.
    pub(super) include: Option<f64>,
}

impl Axis {
    pub(super) fn linear(label: &str, include: Option<f64>) -> Self {
        Self { label: label.to_owned(), log: false, names: Vec::new(), include }
    }

    pub(super) fn log(label: &str) -> Self {
        Self { log: true, ..Self::linear(label, None) }
    }

    pub(super) fn named(label: &str, names: Vec<String>) -> Self {
        Self { names, ..Self::linear(label, None) }
    }
}

/// Points that belong together.
pub(super) struct Series {
    pub(super) name: String,
    pub(super) colour: usize,
    /// A published one: hollow and dashed.
    pub(super) published: bool,
    pub(super) connected: bool,
    pub(super) marked: bool,
    pub(super) points: Vec<(f64, Number)>,
}

impl Series {
    /// Marks on a line, measured here.
    pub(super) fn line(name: impl Into<String>, colour: usize, points: Vec<(f64, Number)>) -> Self {
        Self { name: name.into(), colour, published: false, connected: true, marked: true, points }
    }
}

/// The `svg` element; `unit` follows a point's value in its words.
pub(super) fn chart(label: &str, x: &Axis, y: &Axis, series: &[Series], unit: &str) -> String {
    let mut svg = Svg::new();
    let shown = |series: &Series| -> Vec<(f64, Number)> {
        let known = series.points.iter().filter(|(_, number)| number.is_known());
        known.filter(|(_, number)| !y.log || number.value > 0.0).cloned().collect()
    };
    let entries: Vec<_> = series
        .iter()
        .map(|series| Entry { name: series.name.clone(), colour: series.colour, hollow: series.published })
        .collect();
    let top = legend(&mut svg, 16.0, 4.0, &entries, false) + 16.0;
    let bottom = top + HEIGHT;
    let (right, slanted) = (WIDTH - RIGHT, x.names.iter().any(|name| name.len() > 7));
    let all: Vec<_> = series.iter().flat_map(shown).collect();
    if all.is_empty() {
        svg.text(LEFT, top + 40.0, Anchor::Start, "soft", "nothing measured");
        return svg.finish(bottom, label);
    }
    let bounds = |values: Vec<f64>, axis: &Axis| {
        let values = || values.iter().copied().chain(axis.include);
        let (low, high) = (values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max));
        if !axis.names.is_empty() {
            (-0.5, axis.names.len() as f64 - 0.5)
        } else if axis.log {
            (low / 1.25, high * 1.25)
        } else {
            let room = 0.06 * (high - low).max(1e-9 + 1e-3 * high.abs());
            // What begins or ends at the value that must be there needs no room beyond.
            (if axis.include == Some(low) { low } else { low - room }, high + room)
        }
    };
    let (x_low, x_high) = bounds(all.iter().map(|(x, _)| *x).collect(), x);
    let (y_low, y_high) = bounds(all.iter().map(|(_, y)| y.value).collect(), y);
    let share = |value: f64, low: f64, high: f64, log: bool| {
        if log { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) }
    };
    let at_x = |value: f64| LEFT + share(value, x_low, x_high, x.log) * (right - LEFT);
    let at_y = |value: f64| bottom - share(value, y_low, y_high, y.log) * HEIGHT;

    let y_ticks = if y.log { log_ticks(y_low, y_high) } else { ticks(y_low, y_high, 6) };
    for tick in y_ticks {
        let at = at_y(tick);
        svg.path("grid", &format!("M{LEFT} {at:.1}H{right}"));
        svg.text(LEFT - 6.0, at + 4.0, Anchor::End, "soft", &tick_text(tick));
    }
    let mut below = bottom + 18.0;
    if x.names.is_empty() {
        let x_ticks = if x.log { log_ticks(x_low, x_high) } else { ticks(x_low, x_high, 8) };
        for tick in x_ticks {
            svg.path("grid", &format!("M{:.1} {top:.1}V{bottom:.1}", at_x(tick)));
            svg.text(at_x(tick), below, Anchor::Middle, "soft", &tick_text(tick));
        }
    } else {
        for (index, name) in x.names.iter().enumerate() {
            let at = at_x(index as f64);
            if slanted {
                svg.raw(&format!(
                    "<g transform=\"translate({:.1} {:.1}) rotate(-38)\">",
                    at + 4.0,
                    bottom + 14.0
                ));
                svg.text(0.0, 0.0, Anchor::End, "soft", name);
                svg.raw("</g>\n");
            } else {
                svg.text(at, below, Anchor::Middle, "soft", name);
            }
        }
        if slanted {
            let longest = x.names.iter().map(|name| super::svg::width_of(name)).fold(0.0, f64::max);
            below += 0.62 * longest;
        }
    }
    svg.path("axis", &format!("M{LEFT} {top:.1}V{bottom:.1}H{right}"));
    if y.include == Some(0.0) && y_low < 0.0 {
        svg.path("axis", &format!("M{LEFT} {:.1}H{right}", at_y(0.0)));
    }
    svg.text((LEFT + right) / 2.0, below + 20.0, Anchor::Middle, "", &x.label);
    svg.turned(13.0, (top + bottom) / 2.0, &y.label);

    for series in series {
        let points = shown(series);
        if series.connected && points.len() > 1 {
            let line: Vec<_> = points.iter().map(|(x, y)| (at_x(*x), at_y(y.value))).collect();
            svg.line(series.colour, series.published, &line);
        }
        if !series.marked && points.len() > 1 {
            continue;
        }
        for (value, number) in &points {
            let place = match x.names.get(*value as usize) {
                Some(name) => name.clone(),
                None => format!("{} at {}", x.label, tick_text(*value)),
            };
            let value_text = crate::report::tables::grouped(number.value, 2);
            let value_text = value_text.trim_end_matches('0').trim_end_matches('.').to_owned();
            let words = format!("{}, {place}: {value_text} {unit}", series.name);
            let about = About { words, number: Some(number) };
            svg.mark(series.colour, series.published, (at_x(*value), at_y(number.value)), &about);
        }
    }
    svg.finish(below + 28.0, label)
}
