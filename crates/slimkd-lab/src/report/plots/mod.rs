//! Plots as SVG, drawn from the raw JSON alone. Every mark says where its number came from.

mod bars;
mod chart;
pub mod frontier;
mod scene;
mod svg;

pub use scene::{depths, duplication, frames, peers, scaling, sizes, sizes_of_all, steps, thresholds};
pub use svg::THEME;

/// A plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Its file's name.
    pub id: String,
    /// What it shows, a line.
    pub title: String,
    /// How to read it.
    pub note: String,
    /// The `svg` element. Colours come from [`THEME`], which a page or [`Figure::standalone`] gives.
    pub svg: String,
}

impl Figure {
    /// A file of its own, with its colours.
    pub fn standalone(&self) -> String {
        let end = self.svg.find('>').map_or(0, |at| at + 1);
        let (head, rest) = self.svg.split_at(end);
        format!(
            "{head}\n<style>\n{THEME}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"var(--paper)\"/>{rest}\n"
        )
    }
}
