//! OFF, the Object File Format of Geomview, as text: faces of any number of corners, and colours of vertices and faces.
//!
//! Deviations: the counts may follow the word `OFF` at once (`OFF490 518 0`, as in a well-known data set); a colour that
//! is an index into a table is passed over, since the table is not in the file.

use super::{
    Format, LoadError, Loading, Place, Progress,
    error::quoted,
    polygon::Polygons,
    text::{self, Lines},
};
use crate::origin::Frame;
use crate::{Attribute, Scene, Warning, WarningKind};
use slimkd::TriangleMesh;
use std::sync::Arc;

/// Entries between two looks at the progress.
const BLOCK: u64 = 1 << 14;

fn invalid(line: u64, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Off, place: Place::Line(line), what: what.into(), fix }
}

/// Lines with something in them, without their comments.
struct Content<'a>(Lines<'a>, u64);

impl<'a> Content<'a> {
    fn next(&mut self) -> Result<(u64, &'a [u8]), LoadError> {
        for (number, line) in self.0.by_ref() {
            self.1 = number;
            let end = line.iter().position(|&b| b == b'#').unwrap_or(line.len());
            let line = line[..end].trim_ascii();
            if !line.is_empty() {
                return Ok((number, line));
            }
        }
        let fix = "the counts are wrong or the file was cut off: write or download it again";
        Err(invalid(self.1, "the file ends before all vertices and faces that it announces", fix))
    }
}

pub(super) fn parse(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let mut lines = Content(Lines::new(bytes), 0);
    let (mut number, mut line) = lines.next()?;
    let (mut has_normals, mut has_colours, mut has_uvs) = (false, false, false);
    if let Some(at) = line.windows(3).position(|word| word == b"OFF").filter(|&at| at <= 5) {
        let mut kind = &line[..at];
        if let Some(rest) = kind.strip_prefix(b"ST") {
            (has_uvs, kind) = (true, rest);
        }
        for letter in kind {
            match letter {
                b'C' => has_colours = true,
                b'N' => has_normals = true,
                _ => {
                    return Err(LoadError::Unsupported {
                        format: Format::Off,
                        place: Place::Line(number),
                        what: quoted(line),
                        fix: "write three coordinates a vertex under the word OFF",
                    });
                }
            }
        }
        line = line[at + 3..].trim_ascii();
        if line.eq_ignore_ascii_case(b"BINARY") {
            return Err(LoadError::Unsupported {
                format: Format::Off,
                place: Place::Line(number),
                what: "binary data".to_owned(),
                fix: "write it as text, or as PLY",
            });
        }
        if line.is_empty() {
            (number, line) = lines.next()?;
        }
    }
    let mut counts = text::words(line).map(|word| std::str::from_utf8(word).ok()?.parse::<u64>().ok());
    let (Some(Some(vertices)), Some(Some(faces))) = (counts.next(), counts.next()) else {
        let what = format!("{} is not the numbers of vertices, faces and edges", quoted(line));
        return Err(invalid(number, what, "write \"OFF\" and the three numbers first"));
    };
    // A vertex takes 6 bytes at least, a face 2.
    let left = (bytes.len() - lines.0.at()) as u64 + 1;
    if vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2)) > left.saturating_add(6) {
        let what = format!("{vertices} vertices and {faces} faces do not fit into the rest of the file");
        return Err(invalid(number, what, "the counts are wrong or the file was cut off"));
    }
    let (mut positions, mut normals, mut uvs) = (Vec::new(), Vec::new(), Vec::new());
    let mut colours: Vec<[u8; 4]> = Vec::new();
    for vertex in 0..vertices {
        if vertex.is_multiple_of(BLOCK) {
            progress.parsed(lines.0.at(), bytes.len())?;
        }
        let (number, line) = lines.next()?;
        let mut words = text::words(line);
        let short = || {
            let what = format!("vertex {} has too few numbers", quoted(line));
            invalid(number, what, "write \"x y z\", and what the word before OFF announces")
        };
        positions.push(text::position(words.by_ref(), frame).ok_or_else(short)?);
        if has_normals {
            normals.push(text::numbers::<3>(words.by_ref()).ok_or_else(short)?);
        }
        let rest: Vec<&[u8]> = words.take(6).collect();
        let uv = if has_uvs { rest.len().checked_sub(2).ok_or_else(short)? } else { rest.len() };
        // MeshLab and others write colours under a plain OFF, too.
        if let Some(colour) = colour(&rest[..uv]) {
            colours.resize(positions.len() - 1, [255; 4]);
            colours.push(colour);
        } else if has_colours && uv > 1 {
            return Err(short());
        }
        if has_uvs {
            uvs.push(text::numbers::<2>(rest[uv..].iter().copied()).ok_or_else(short)?);
        }
    }
    if !colours.is_empty() {
        colours.resize(positions.len(), [255; 4]);
    }
    let mut triangles = Vec::new();
    let mut polygons = Polygons::default();
    let mut face_colours: Vec<[u8; 4]> = Vec::new();
    let (mut slivers, mut corners) = (0, Vec::new());
    for face in 0..faces {
        if face.is_multiple_of(BLOCK) {
            progress.parsed(lines.0.at(), bytes.len())?;
        }
        let (number, line) = lines.next()?;
        let mut words = text::words(line).map(|word| (word, std::str::from_utf8(word).ok()));
        let whole =
            |word: Option<(&[u8], Option<&str>)>| word.and_then(|(_, word)| word?.parse::<u64>().ok());
        let count = whole(words.next())
            .ok_or_else(|| invalid(number, format!("{} is no face", quoted(line)), "write \"3 0 1 2\""))?;
        corners.clear();
        for _ in 0..count {
            let index = whole(words.next()).filter(|&index| index < vertices).ok_or_else(|| {
                let what = format!("face {} needs {count} indices below {vertices}", quoted(line));
                invalid(number, what, "fix the index; the first vertex is 0")
            })?;
            corners.push(index as u32);
        }
        slivers += u64::from(count < 3);
        let before = triangles.len();
        polygons.add(before, corners.len(), 1);
        triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
        let rest: Vec<&[u8]> = words.map(|(word, _)| word).take(5).collect();
        if let Some(colour) = colour(&rest) {
            face_colours.resize(before, [255; 4]);
            face_colours.resize(triangles.len(), colour);
        }
    }
    if !face_colours.is_empty() {
        face_colours.resize(triangles.len(), [255; 4]);
    }
    let mut warnings = Vec::new();
    if slivers > 0 {
        let what = "faces have fewer than 3 corners and were left out";
        warnings.push(Warning::counted(WarningKind::Invalid, slivers, faces, what));
    }
    polygons.mend(&positions, &mut triangles, &mut [], &mut warnings, progress)?;
    fn attribute<T>(values: Vec<T>) -> Option<Attribute<T>> {
        (!values.is_empty()).then_some(Attribute { values, indices: None })
    }
    Ok(Scene {
        mesh: Arc::new(TriangleMesh::new(positions, triangles)?),
        normals: attribute(normals),
        uvs: attribute(uvs),
        colours: attribute(colours),
        face_colours,
        warnings,
        ..Default::default()
    })
}

/// Three or four numbers: whole ones from 0 to 255, others from 0 to 1.
fn colour(words: &[&[u8]]) -> Option<[u8; 4]> {
    if !matches!(words.len(), 3 | 4) {
        return None;
    }
    let is_whole = words.iter().all(|word| word.iter().all(u8::is_ascii_digit));
    let mut colour = [255; 4];
    for (byte, word) in colour.iter_mut().zip(words) {
        let value: f32 = text::number(word)?;
        *byte = (if is_whole { value } else { 255.0 * value }).round() as u8;
    }
    Some(colour)
}
