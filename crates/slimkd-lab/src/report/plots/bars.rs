//! Lying bars of several parts.

use super::svg::{About, Anchor, Entry, Svg, WIDTH, legend, tick_text, ticks, width_of};
use crate::basics::number::Number;
use crate::report::tables::grouped;

const BAR: f64 = 18.0;
const STEP: f64 = 26.0;

/// A bar.
pub(super) struct Bar {
    pub(super) name: String,
    pub(super) published: bool,
    /// In the order of the parts' names.
    pub(super) parts: Vec<Number>,
    /// Beside its end.
    pub(super) remark: String,
}

/// The `svg` element. `parts`: names and colours.
pub(super) fn bars(label: &str, axis: &str, parts: &[(&str, usize)], bars: &[Bar]) -> String {
    let mut svg = Svg::new();
    // What no bar has needs no entry.
    let any = |part: usize| bars.iter().any(|bar| bar.parts.get(part).is_some_and(|part| part.value > 0.0));
    let used = parts.iter().enumerate().filter(|(part, _)| any(*part)).map(|(_, part)| part);
    let entries: Vec<_> = used
        .map(|(name, colour)| Entry { name: (*name).to_owned(), colour: *colour, hollow: false })
        .collect();
    let top = if parts.len() > 1 { legend(&mut svg, 16.0, 4.0, &entries, true) + 12.0 } else { 8.0 };
    // Long names lie above their bars.
    let longest = bars.iter().map(|bar| width_of(&bar.name)).fold(0.0, f64::max);
    let above = longest > 170.0;
    let step = if above { STEP + 16.0 } else { STEP };
    let bottom = top + step * bars.len() as f64;
    let left = if above { 10.0 } else { longest + 10.0 };
    let remark = bars.iter().map(|bar| width_of(&bar.remark)).fold(0.0, f64::max);
    let right = WIDTH - remark - 12.0;
    let total =
        |bar: &Bar| bar.parts.iter().map(|part| part.value).filter(|part| part.is_finite()).sum::<f64>();
    let high = bars.iter().map(total).fold(0.0, f64::max).max(1e-9);
    let at = |value: f64| left + value / high * (right - left);
    for tick in ticks(0.0, high, 6) {
        svg.path("grid", &format!("M{:.1} {top:.1}V{bottom:.1}", at(tick)));
        svg.text(at(tick), bottom + 16.0, Anchor::Middle, "soft", &tick_text(tick));
    }
    for (index, bar) in bars.iter().enumerate() {
        let mut y = top + step * index as f64 + 4.0;
        if above {
            svg.text(left + 4.0, y + 9.0, Anchor::Start, "", &bar.name);
            y += 14.0;
        } else {
            svg.text(left - 8.0, y + 13.0, Anchor::End, if bar.published { "soft" } else { "" }, &bar.name);
        }
        let mut from = 0.0;
        for (part, (name, colour)) in bar.parts.iter().zip(parts) {
            if !(part.is_known() && part.value > 0.0) {
                continue;
            }
            let words = format!("{}, {name}: {}", bar.name, grouped(part.value, 2));
            let about = About { words, number: Some(part) };
            let opacity = if bar.published { 0.45 } else { 1.0 };
            svg.bar(*colour, [at(from), y, at(from + part.value) - at(from), BAR], opacity, &about);
            from += part.value;
        }
        svg.text(at(from) + 6.0, y + 13.0, Anchor::Start, "", &bar.remark);
    }
    svg.path("axis", &format!("M{left:.1} {top:.1}V{bottom:.1}H{right:.1}"));
    svg.text((left + right) / 2.0, bottom + 36.0, Anchor::Middle, "", axis);
    svg.finish(bottom + 46.0, label)
}
