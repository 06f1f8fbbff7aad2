//! STL, text and binary. It has no indices: equal positions are welded. The facets' normals say nothing that the
//! corners do not, and are ignored.

use super::{
    Format, LoadError, Loading, Place, Progress, error::quoted, polygon::Polygons, text, weld::Weld,
};
use crate::origin::Frame;
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

pub(super) fn parse(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let mut announced =
        bytes.get(80..HEAD).map(|raw| u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]) as usize);
    let mut warnings = Vec::new();
    // Programs that did not know the count when they began to write left 0 or −1.
    let behind = bytes.len().saturating_sub(HEAD) / TRIANGLE;
    if let Some(wrong) = announced
        && (wrong == 0 || wrong == u32::MAX as usize)
        && behind > 0
        && (bytes.len() - HEAD).is_multiple_of(TRIANGLE)
        && !is_text(bytes)
    {
        let what = format!("the count of triangles is {wrong}, but {behind} follow, which were read");
        warnings.push(Warning::new(WarningKind::Invalid, what));
        announced = Some(behind);
    }
    let size = announced.map(|count| HEAD as u64 + TRIANGLE as u64 * count as u64);
    // Binary files may start with "solid" too: the size tells first.
    if size != Some(bytes.len() as u64) && is_text(bytes) {
        return parse_text(bytes, frame, progress);
    }
    let (Some(announced), Some(size)) = (announced, size) else {
        let what = format!("{} bytes are too few for a binary STL, and it is no text", bytes.len());
        return Err(invalid(Place::Byte(0), what, "the file was cut off or is no STL"));
    };
    if size > bytes.len() as u64 {
        let what = format!("{announced} triangles need {size} bytes, but there are {}", bytes.len());
        return Err(invalid(Place::Byte(80), what, "the file was cut off or is no STL"));
    }
    // Closed meshes have half as many vertices as triangles.
    let mut weld = Weld::with_capacity(announced / 2);
    let mut triangles = Vec::with_capacity(announced);
    for (k, triangle) in bytes[HEAD..size as usize].as_chunks::<TRIANGLE>().0.iter().enumerate() {
        if k.is_multiple_of(BLOCK) {
            progress.parsed(k, announced)?;
        }
        let raw = triangle[12..48].as_chunks::<4>().0;
        let value = |k: usize| f32::from_le_bytes(raw[k]);
        triangles.push([0, 3, 6].map(|k| weld.index(frame.put_f32([value(k), value(k + 1), value(k + 2)]))));
    }
    if size < bytes.len() as u64 {
        let what = format!("{} bytes behind the last triangle were ignored", bytes.len() as u64 - size);
        warnings.push(Warning::new(WarningKind::Ignored, what));
    }
    let mesh = Arc::new(TriangleMesh::new(weld.vertices, triangles)?);
    Ok(Scene { mesh, warnings, ..Default::default() })
}

/// True for what starts like a text STL: "solid", and no control characters soon after.
fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let start = &start[..start.len().min(512)];
    start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !start.contains(&0)
}

/// The words of a text and their lines. All white space is alike, but for the end of a solid's name.
struct Words<'a> {
    rest: &'a [u8],
    total: usize,
    line: u64,
}

impl<'a> Words<'a> {
    fn new(text: &'a [u8]) -> Self {
        let rest = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
        Self { rest, total: text.len(), line: 1 }
    }

    fn at(&self) -> usize {
        self.total - self.rest.len()
    }

    fn peek(&self) -> &'a [u8] {
        let rest = self.rest.trim_ascii_start();
        &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())]
    }

    /// Passes over the rest of the line, or what is before `facet` in it: a solid's name.
    fn skip_name(&mut self) {
        loop {
            let blanks = self.rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            if self.rest[..blanks].iter().any(|&b| b == b'\n' || b == b'\r') {
                return;
            }
            let word = self.peek();
            let behind = self.rest[blanks + word.len()..].trim_ascii_start();
            let is_next =
                |name: &[u8]| behind.get(..name.len()).is_some_and(|w| w.eq_ignore_ascii_case(name));
            if word.is_empty()
                || (word.eq_ignore_ascii_case(b"facet") && is_next(b"normal"))
                || word.eq_ignore_ascii_case(b"endsolid")
                || word.eq_ignore_ascii_case(b"solid")
            {
                return;
            }
            self.rest = &self.rest[blanks + word.len()..];
        }
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest.trim_ascii_start();
        let blanks = &self.rest[..self.rest.len() - rest.len()];
        let ends = |k: usize| blanks[k] == b'\n' || (blanks[k] == b'\r' && blanks.get(k + 1) != Some(&b'\n'));
        self.line += (0..blanks.len()).filter(|&k| ends(k)).count() as u64;
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

fn parse_text(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let mut weld = Weld::with_capacity(0);
    let mut triangles = Vec::new();
    let mut polygons = Polygons::default();
    let mut corners = Vec::new();
    let (mut in_solid, mut in_facet) = (false, false);
    let (mut slivers, mut facets, mut count) = (0u64, 0u64, 0u64);
    let mut words = Words::new(bytes);
    while let Some(word) = words.next() {
        count += 1;
        if count.is_multiple_of(BLOCK as u64) {
            progress.parsed(words.at(), bytes.len())?;
        }
        // In any case, without allocating: keywords have 8 letters at most, the ninth tells longer words apart.
        let mut lower = [0; 9];
        let length = word.len().min(lower.len());
        lower[..length].copy_from_slice(&word[..length]);
        lower.make_ascii_lowercase();
        let mut keyword = &lower[..length];
        if keyword == b"end" {
            // In two words, as some programs write it.
            keyword = match words.next() {
                Some(word) if word.eq_ignore_ascii_case(b"solid") => b"endsolid",
                Some(word) if word.eq_ignore_ascii_case(b"facet") => b"endfacet",
                Some(word) if word.eq_ignore_ascii_case(b"loop") => b"endloop",
                _ => keyword,
            };
        }
        match keyword {
            b"solid" => {
                in_solid = true;
                words.skip_name();
            }
            b"endsolid" => {
                in_solid = false;
                words.skip_name();
            }
            b"facet" => {
                in_facet = true;
                // The normal's numbers may be anything: they are not read.
                if words.peek().eq_ignore_ascii_case(b"normal") {
                    words.next();
                    for _ in 0..3 {
                        if !words.peek().eq_ignore_ascii_case(b"outer") {
                            words.next();
                        }
                    }
                }
            }
            b"endfacet" => in_facet = false,
            b"outer" => {
                corners.clear();
                if words.peek().eq_ignore_ascii_case(b"loop") {
                    words.next();
                }
            }
            b"vertex" => {
                let position = text::position(words.by_ref(), frame).ok_or_else(|| {
                    let fix = "write \"vertex x y z\"; the file may be cut off";
                    invalid(Place::Line(words.line), "a vertex has no three numbers", fix)
                })?;
                corners.push(weld.index(position));
            }
            b"endloop" => {
                facets += 1;
                slivers += u64::from(corners.len() < 3);
                polygons.add(triangles.len(), corners.len(), 1);
                triangles.extend(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]));
                corners.clear();
            }
            _ => {
                let what = format!("unknown word {}", quoted(word));
                return Err(invalid(Place::Line(words.line), what, "the file is damaged or no STL"));
            }
        }
    }
    if in_facet {
        let fix = "the file was cut off: write or download it again";
        return Err(invalid(Place::Line(words.line), "the file ends within a facet", fix));
    }
    let mut warnings = Vec::new();
    if in_solid {
        let what = "the file ends without endsolid: it may have been cut off";
        warnings.push(Warning::new(WarningKind::Invalid, what));
    }
    if slivers > 0 {
        let what = "facets have fewer than 3 corners and were left out";
        warnings.push(Warning::counted(WarningKind::Invalid, slivers, facets, what));
    }
    polygons.mend(&weld.vertices, &mut triangles, &mut [], &mut warnings, progress)?;
    let mesh = Arc::new(TriangleMesh::new(weld.vertices, triangles)?);
    Ok(Scene { mesh, warnings, ..Default::default() })
}
