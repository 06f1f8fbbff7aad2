//! Writing SVG: text, axes, ticks, marks, legends.

use crate::basics::number::Number;
use std::fmt::Write as _;

/// Colours for both schemes. The series' are Okabe & Ito's (*Color Universal Design*, 2008), lighter on dark paper.
pub const THEME: &str = "\
:root { color-scheme: light dark; --paper: #fdfdfc; --ink: #23262b; --soft: #5d646e; --faint: #dfe2e6; --card: #ffffff;
  --c0: #4a4f57; --c1: #56b4e9; --c2: #0072b2; --c3: #d55e00; --c4: #e69f00; --c5: #009e73; --c6: #cc79a7; }
@media (prefers-color-scheme: dark) { :root { --paper: #15171a; --ink: #e6e8eb; --soft: #a3abb6; --faint: #33383f;
  --card: #1c1f23; --c0: #b9c0c9; --c1: #7cc7f2; --c2: #3d9bdc; --c3: #f07f2e; --c4: #f2bd42; --c5: #33c19a; --c6: #e39ac4; } }
svg.plot { font-family: system-ui, sans-serif; font-size: 12px; }
svg.plot text { fill: var(--ink); } svg.plot .soft { fill: var(--soft); }
svg.plot .axis { stroke: var(--soft); fill: none; } svg.plot .grid { stroke: var(--faint); fill: none; }
svg.plot .hollow { fill: var(--paper); }
";

/// Mean width of a letter at 12 px in a wide font: what keeps texts apart.
pub(super) const LETTER: f64 = 7.0;

/// Width of every plot: on a phone it is shown at about four fifths of that, so texts stay readable.
pub(super) const WIDTH: f64 = 460.0;

/// How a text lies to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing under way.
pub(super) struct Svg {
    out: String,
}

pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

pub(super) fn width_of(text: &str) -> f64 {
    LETTER * text.chars().count() as f64
}

impl Svg {
    pub(super) fn new() -> Self {
        Self { out: String::new() }
    }

    /// The element, `height` high; `label` is for those who cannot see it.
    pub(super) fn finish(self, height: f64, label: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {WIDTH} {height:.0}\" role=\"img\" \
             aria-label=\"{}\">\n{}</svg>",
            escape(label),
            self.out
        )
    }

    pub(super) fn raw(&mut self, text: &str) {
        self.out.push_str(text);
    }

    pub(super) fn text(&mut self, x: f64, y: f64, anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = writeln!(
            self.out,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" class=\"{class}\">{}</text>",
            escape(text)
        );
    }

    pub(super) fn turned(&mut self, x: f64, y: f64, text: &str) {
        let _ = writeln!(
            self.out,
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            escape(text)
        );
    }

    pub(super) fn path(&mut self, class: &str, path: &str) {
        let _ = writeln!(self.out, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    pub(super) fn line(&mut self, colour: usize, dashed: bool, points: &[(f64, f64)]) {
        let points: Vec<_> = points.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
        let dash = if dashed { " stroke-dasharray=\"5 4\"" } else { "" };
        let _ = writeln!(
            self.out,
            "<path d=\"M{}\" fill=\"none\" stroke=\"var(--c{colour})\" stroke-width=\"1.8\"{dash}/>",
            points.join("L")
        );
    }

    /// A mark whose shape tells its series as well as its colour does.
    pub(super) fn mark(&mut self, colour: usize, hollow: bool, (x, y): (f64, f64), about: &About<'_>) {
        let shape = match colour {
            0 => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\""),
            1 => format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"6.6\" height=\"6.6\"", x - 3.3, y - 3.3),
            2 => {
                format!("<path d=\"M{x:.1} {:.1}L{:.1} {:.1}H{:.1}Z\"", y - 4.6, x + 4.4, y + 3.4, x - 4.4)
            }
            3 => {
                format!(
                    "<path d=\"M{x:.1} {:.1}L{:.1} {y:.1}L{x:.1} {:.1}L{:.1} {y:.1}Z\"",
                    y - 5.0,
                    x + 5.0,
                    y + 5.0,
                    x - 5.0
                )
            }
            4 => {
                format!("<path d=\"M{x:.1} {:.1}L{:.1} {:.1}H{:.1}Z\"", y + 4.6, x + 4.4, y - 3.4, x - 4.4)
            }
            _ => format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"5\" height=\"9\"", x - 2.5, y - 4.5),
        };
        let fill = if hollow {
            format!("class=\"hollow\" stroke=\"var(--c{colour})\" stroke-width=\"1.6\"")
        } else {
            format!("fill=\"var(--c{colour})\"")
        };
        let _ = writeln!(self.out, "{shape} {fill}{}>{}</{}>", about.data(), about.title(), tag(&shape));
    }

    pub(super) fn bar(
        &mut self,
        colour: usize,
        [x, y, width, height]: [f64; 4],
        opacity: f64,
        about: &About<'_>,
    ) {
        let _ = writeln!(
            self.out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"var(--c{colour})\" \
             fill-opacity=\"{opacity}\"{}>{}</rect>",
            about.data(),
            about.title()
        );
    }
}

fn tag(shape: &str) -> &str {
    shape[1..].split(' ').next().unwrap_or("path")
}

/// What a mark is, in words, and its number.
pub(super) struct About<'a> {
    pub(super) words: String,
    pub(super) number: Option<&'a Number>,
}

impl About<'_> {
    pub(super) fn nothing() -> Self {
        Self { words: String::new(), number: None }
    }

    fn data(&self) -> String {
        self.number.map_or_else(String::new, |number| {
            format!(" data-value=\"{}\" data-from=\"{}\"", number.value, escape(&number.from))
        })
    }

    fn title(&self) -> String {
        if self.words.is_empty() { String::new() } else { format!("<title>{}</title>", escape(&self.words)) }
    }
}

/// A legend's entry.
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) colour: usize,
    pub(super) hollow: bool,
}

/// Draws a legend from `top` on, in as many lines as it needs; where it ends.
pub(super) fn legend(svg: &mut Svg, top: f64, left: f64, entries: &[Entry], bars: bool) -> f64 {
    let (mut x, mut y) = (left, top);
    for entry in entries {
        let width = 18.0 + width_of(&entry.name) + 12.0;
        if x + width > WIDTH && x > left {
            (x, y) = (left, y + 17.0);
        }
        if bars {
            svg.bar(entry.colour, [x, y - 9.0, 11.0, 11.0], 1.0, &About::nothing());
        } else {
            svg.mark(entry.colour, entry.hollow, (x + 6.0, y - 4.0), &About::nothing());
        }
        svg.text(x + 16.0, y, Anchor::Start, "", &entry.name);
        x += width;
    }
    y
}

/// Round steps that cut `low..high` into at most `most` parts.
pub(super) fn ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    let rough = (high - low) / most as f64;
    if !(rough.is_finite() && rough > 0.0) {
        return vec![low];
    }
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|step| step * power).find(|&step| step >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let first = (low / step - 1e-9).ceil() as i64;
    (first..).map(|index| index as f64 * step).take_while(|&tick| tick <= high + 1e-9 * step).collect()
}

/// Powers of ten between, and their 2 and 5 where few.
pub(super) fn log_ticks(low: f64, high: f64) -> Vec<f64> {
    let steps: &[f64] = if (high / low).log10() < 2.2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let powers = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
    let all = powers.flat_map(|power| steps.iter().map(move |step| step * 10f64.powi(power)));
    all.filter(|tick| (low * 0.999..=high * 1.001).contains(tick)).collect()
}

/// A tick's words: 1,000,000 is 1 M.
pub(super) fn tick_text(value: f64) -> String {
    let text = |value: f64| {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').replace('-', "−")
    };
    match value.abs() {
        0.0..1e4 => text(value),
        1e4..1e6 => format!("{} k", text(value / 1e3)),
        _ => format!("{} M", text(value / 1e6)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(ticks(0.0, 10.0, 5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(ticks(-3.0, 12.0, 4), [0.0, 5.0, 10.0]);
        assert_eq!(log_ticks(1.0, 1e5).len(), 6);
        assert_eq!(log_ticks(3.0, 30.0), [5.0, 10.0, 20.0]);
        assert_eq!([0.25, -5.0, 20_000.0, 1.5e6].map(tick_text), ["0.25", "−5", "20 k", "1.5 M"]);
    }
}
