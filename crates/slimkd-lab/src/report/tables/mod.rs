//! Tables, computed from the raw JSON alone: for the page, as CSV and as Markdown.

mod all_scenes;
mod scene;
mod shape;
mod size;
mod speed;
mod sweep;

pub use all_scenes::{machine, scaling, summary};
pub use scene::SceneJson;
pub(crate) use scene::{METHODS, MIB};
pub(crate) use shape::interval;
pub use shape::{depths, duplication, longest_edges};
pub use size::{geometry, nodes, references, very_large};
pub use speed::{ablation, builds, costs, frames};
pub(crate) use sweep::effects;
pub use sweep::sweep;

use crate::basics::number::Number;
use std::fmt::Write;

/// What stands in a table's field.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number and its decimals.
    Number(Number, usize),
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Number> for Cell {
    /// A whole number.
    fn from(number: Number) -> Self {
        Self::Number(number, 0)
    }
}

impl From<(Number, usize)> for Cell {
    fn from((number, digits): (Number, usize)) -> Self {
        Self::Number(number, digits)
    }
}

impl Cell {
    /// As people read it: thousands grouped, a dash for what is not known.
    pub fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number, _) if !number.is_known() => "–".to_owned(),
            Self::Number(number, digits) => grouped(number.value, *digits),
        }
    }

    fn csv(&self) -> String {
        match self {
            Self::Text(text) if text.contains([',', '"', '\n']) => {
                format!("\"{}\"", text.replace('"', "\"\""))
            }
            Self::Text(text) => text.clone(),
            Self::Number(number, _) if !number.is_known() => String::new(),
            Self::Number(number, digits) => format!("{:.digits$}", zero(number.value, *digits)),
        }
    }
}

/// Without a sign on what rounds to zero.
fn zero(value: f64, digits: usize) -> f64 {
    if value.abs() < 0.5 * 10f64.powi(-(digits as i32)) { 0.0 } else { value }
}

/// `1234567.8` as `1,234,567.8`, with a real minus sign.
pub(crate) fn grouped(value: f64, digits: usize) -> String {
    let text = format!("{:.digits$}", zero(value, digits).abs());
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let mut out = String::new();
    if zero(value, digits) < 0.0 {
        out.push('−');
    }
    for (index, digit) in whole.chars().enumerate() {
        if index > 0 && (whole.len() - index).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out + rest
}

/// A line of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// As many as there are columns.
    pub cells: Vec<Cell>,
    /// A published figure, not ours.
    pub published: bool,
}

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Its CSV's name.
    pub id: String,
    /// What it shows.
    pub title: String,
    /// How to read it.
    pub note: String,
    /// Heads with their units.
    pub columns: Vec<String>,
    /// Lines.
    pub rows: Vec<Row>,
}

impl Table {
    fn new(id: impl Into<String>, title: &str, note: &str, columns: &[&str]) -> Self {
        Self {
            id: id.into(),
            title: title.to_owned(),
            note: note.to_owned(),
            columns: columns.iter().map(|&name| name.to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    fn ours(&mut self, cells: Vec<Cell>) {
        self.rows.push(Row { cells, published: false });
    }

    fn published(&mut self, cells: Vec<Cell>) {
        self.rows.push(Row { cells, published: true });
    }

    /// Comma-separated, RFC 4180; numbers plain, nothing where nothing is known.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let heads = self.columns.iter().map(|head| Cell::Text(head.clone()).csv()).collect();
        let rows = self.rows.iter().map(|row| line(row.cells.iter().map(Cell::csv).collect()));
        line(heads) + &rows.collect::<String>()
    }

    /// For documents.
    pub fn markdown(&self) -> String {
        let mut out = format!("| {} |\n|{}\n", self.columns.join(" | "), "---|".repeat(self.columns.len()));
        for row in &self.rows {
            let cells: Vec<_> = row.cells.iter().map(Cell::text).collect();
            let _ = writeln!(out, "| {} |", cells.join(" | "));
        }
        out
    }
}

/// Fields of any kind.
macro_rules! row {
    ($($cell:expr),* $(,)?) => { vec![$($crate::report::tables::Cell::from($cell)),*] };
}
use row;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped() {
        for (value, digits, text) in [
            (1_234_567.0, 0, "1,234,567"),
            (-1234.56, 1, "−1,234.6"),
            (-0.04, 1, "0.0"),
            (999.0, 2, "999.00"),
        ] {
            assert_eq!(grouped(value, digits), text);
        }
    }

    #[test]
    fn csv_and_markdown() {
        let mut table = Table::new("t", "T", "", &["a, b", "c"]);
        table.ours(row!["x\"y", (Number::from(1234.5), 1)]);
        table.ours(row!["z", Number::from(f64::NAN)]);
        assert_eq!(table.csv(), "\"a, b\",c\n\"x\"\"y\",1234.5\nz,\n");
        assert!(table.markdown().ends_with("| x\"y | 1,234.5 |\n| z | – |\n"));
    }
}
