//! CityJSON 1.0 to 2.0, and CityJSONSeq: city models of surfaces with holes.
//!
//! Followed is the specification, <https://www.cityjson.org/specs/2.0.1/>. Of each city object, the geometries of its highest
//! level of detail are read. Triangles are named by the kind of their surface (`RoofSurface`), or of their object, as
//! materials. Coordinates are f64 until the mesh is made.

mod city;
mod json;
mod surfaces;

use super::{
    Format, LoadError, Loading, Place, Progress,
    error::short,
    source::{FREE_BYTES, MAX_GROWTH},
    text::Lines,
};
use crate::{Scene, origin::Frame};
use city::City;
use json::{Root, Transform};

/// Memory that a JSON object may become, bytes.
const OBJECT: u64 = 320;

fn invalid(format: Format, line: u64, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format, place: Place::Line(line), what: what.into(), fix }
}

/// One JSON text, which begins at that line.
fn read(format: Format, text: &[u8], line: u64) -> Result<Root<'_>, LoadError> {
    let objects = text.iter().filter(|&&byte| byte == b'{').count() as u64;
    let (input, limit) = (text.len() as u64, FREE_BYTES * 4 + MAX_GROWTH / 4 * text.len() as u64);
    if objects * OBJECT > limit {
        let (what, fix) = ("the list of objects", "leave out what has no geometry");
        return Err(LoadError::OutOfProportion { what, limit, input, fix });
    }
    serde_json::from_slice(text).map_err(|error| {
        let line = line + (error.line() as u64).saturating_sub(1);
        invalid(format, line, short(&error), "the file was cut off or is no CityJSON")
    })
}

/// A whole model in one text.
pub(super) fn parse(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let format = Format::CityJson;
    let root = read(format, bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), 1)?;
    if root.kind != "CityJSON" {
        let what =
            format!("its type is {:?}, not \"CityJSON\"", root.kind.chars().take(40).collect::<String>());
        let fix = "give the file the extension of what it is: features one a line are .jsonl";
        return Err(invalid(format, 1, what, fix));
    }
    let mut city = City::new(format, bytes.len(), progress);
    city.add(&root, &root, 1)?;
    city.finish(frame)
}

/// A sequence: a first object with what all share, then a feature a line.
pub(super) fn parse_sequence(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let format = Format::CityJsonSeq;
    let mut city = City::new(format, bytes.len(), progress);
    let mut shared: Option<Root<'_>> = None;
    let mut lines = Lines::new(bytes);
    while let Some((number, line)) = lines.next() {
        progress.parsed(lines.at(), bytes.len())?;
        if line.is_empty() {
            continue;
        }
        let root = read(format, line, number)?;
        match (&*root.kind, &shared) {
            ("CityJSON", _) => {
                city.add(&root, &root, number)?;
                shared = Some(root);
            }
            ("CityJSONFeature", Some(shared)) => city.add(&root, shared, number)?,
            ("CityJSONFeature", None) => {
                let fix = "write the line of type \"CityJSON\" first: it has the transform";
                return Err(invalid(format, number, "a feature comes before the model it belongs to", fix));
            }
            (kind, _) => {
                let kind: String = kind.chars().take(40).collect();
                let what = format!("a line is of type {kind:?}, not \"CityJSONFeature\"");
                return Err(invalid(format, number, what, "the file is damaged or no CityJSONSeq"));
            }
        }
    }
    if shared.is_none() {
        return Err(invalid(format, 1, "there is no line of type \"CityJSON\"", "write it first"));
    }
    city.finish(frame)
}

impl Transform {
    /// A vertex in the model's coordinates.
    fn apply(self, vertex: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| vertex[axis] * self.scale[axis] + self.translate[axis])
    }
}
