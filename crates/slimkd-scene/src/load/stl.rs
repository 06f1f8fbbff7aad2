//! STL, text and binary. It has no indices: equal positions are welded. The facets' normals say nothing that the
//! corners do not, and are ignored.

use super::{Format, LoadError, LoadProgress, Place, error::quoted, text, weld::Weld};
use crate::{Scene, Warning, WarningKind};
use slimkd::TriangleMesh;
use std::sync::Arc;

/// Bytes of a binary file before the triangles: 80 of anything, and the count.
const HEAD: usize = 84;
/// Bytes of a triangle: normal, three corners, two bytes of attributes.
const TRIANGLE: usize = 50;
/// Triangles or lines between two looks at the progress.
const BLOCK: usize = 1 << 14;

fn invalid(place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Stl, place, what: what.into(), fix }
}

pub(super) fn parse(bytes: &[u8], progress: &LoadProgress) -> Result<Scene, LoadError> {
    let announced =
        bytes.get(80..HEAD).map(|raw| u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]) as usize);
    let size = announced.map(|count| HEAD as u64 + TRIANGLE as u64 * count as u64);
    // Binary files may start with "solid" too: the size tells first.
    if size != Some(bytes.len() as u64) && is_text(bytes) {
        return parse_text(bytes, progress);
    }
    let (Some(announced), Some(size)) = (announced, size) else {
        let what = format!("{} bytes are too few for a binary STL, and it is no text", bytes.len());
        return Err(invalid(Place::Byte(0), what, "the file was cut off or is no STL"));
    };
    if size > bytes.len() as u64 {
        let what = format!("{announced} triangles need {size} bytes, but there are {}", bytes.len());
        return Err(invalid(Place::Byte(80), what, "the file was cut off or is no STL"));
    }
    let mut weld = Weld::new();
    let mut triangles = Vec::with_capacity(announced);
    for (k, triangle) in bytes[HEAD..size as usize].as_chunks::<TRIANGLE>().0.iter().enumerate() {
        if k.is_multiple_of(BLOCK) {
            progress.parsed(k, announced)?;
        }
        let raw = triangle[12..48].as_chunks::<4>().0;
        let value = |k: usize| f32::from_le_bytes(raw[k]);
        triangles.push([0, 3, 6].map(|k| weld.index([value(k), value(k + 1), value(k + 2)])));
    }
    let mut warnings = Vec::new();
    if size < bytes.len() as u64 {
        let what = format!("{} bytes behind the last triangle were ignored", bytes.len() as u64 - size);
        warnings.push(Warning::new(WarningKind::Ignored, what));
    }
    let mesh = Arc::new(TriangleMesh::new(weld.vertices, triangles)?);
    Ok(Scene { mesh, warnings, ..Default::default() })
}

/// True for what starts like a text STL: "solid", and no control characters soon after.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let start = &start[..start.len().min(512)];
    start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !start.contains(&0)
}

fn parse_text(bytes: &[u8], progress: &LoadProgress) -> Result<Scene, LoadError> {
    let mut weld = Weld::new();
    let mut triangles = Vec::new();
    let mut corners = Vec::new();
    let mut inside = false;
    let (mut slivers, mut facets) = (0u64, 0u64);
    let mut last = 0;
    let mut lines = text::Lines::new(bytes);
    while let Some((number, line)) = lines.next() {
        if number.is_multiple_of(BLOCK as u64) {
            progress.parsed(lines.at(), bytes.len())?;
        }
        last = number;
        let mut words = text::words(line);
        let Some(word) = words.next() else { continue };
        // In any case, without allocating: keywords have 8 letters at most, the ninth tells longer words apart.
        let mut lower = [0; 9];
        let length = word.len().min(lower.len());
        lower[..length].copy_from_slice(&word[..length]);
        lower.make_ascii_lowercase();
        match &lower[..length] {
            b"solid" => inside = true,
            b"endsolid" => inside = false,
            b"facet" | b"endfacet" => {}
            b"outer" => corners.clear(),
            b"vertex" => {
                let position = text::numbers(words).ok_or_else(|| {
                    let what = format!("{} has no three numbers", quoted(line));
                    invalid(Place::Line(number), what, "write \"vertex x y z\"; the file may be cut off")
                })?;
                corners.push(weld.index(position));
            }
            b"endloop" => {
                facets += 1;
                slivers += u64::from(corners.len() < 3);
                triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
            }
            _ => {
                let what = format!("unknown line {}", quoted(line));
                return Err(invalid(Place::Line(number), what, "the file is damaged or no STL"));
            }
        }
    }
    if inside {
        let fix = "the file was cut off: write or download it again";
        return Err(invalid(Place::Line(last), "the file ends without endsolid", fix));
    }
    let mut warnings = Vec::new();
    if slivers > 0 {
        let what = "facets have fewer than 3 corners and were left out";
        warnings.push(Warning::counted(WarningKind::Invalid, slivers, facets, what));
    }
    let mesh = Arc::new(TriangleMesh::new(weld.vertices, triangles)?);
    Ok(Scene { mesh, warnings, ..Default::default() })
}
