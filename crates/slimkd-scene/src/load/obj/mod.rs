//! Wavefront OBJ, polygons only. Corners keep their own indices of normals and texture coordinates: no vertex is split.
//!
//! Materials come through `tobj`. Its geometry reader is not used: it copies vertices that several groups share, and
//! its errors name no line.

mod mtl;

use super::{
    Format, LoadError, Loading, Place, Progress,
    error::quoted,
    polygon::Polygons,
    source::Folder,
    text::{self, Lines},
    textures::Textures,
    warn,
};
use crate::origin::Frame;
use crate::{Attribute, Scene, Warning, WarningKind};
use mtl::Library;
use slimkd::TriangleMesh;
use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

/// Lines between two looks at the progress.
const BLOCK: u64 = 1 << 14;
/// A corner without that attribute.
const NONE: u32 = u32::MAX;

fn invalid(line: u64, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Obj, place: Place::Line(line), what: what.into(), fix }
}

/// What a corner's index points into.
#[derive(Clone, Copy)]
enum Kind {
    Vertex,
    Uv,
    Normal,
}

const KINDS: [(Kind, &str); 3] =
    [(Kind::Vertex, "vertex"), (Kind::Uv, "texture coordinate"), (Kind::Normal, "normal")];

#[derive(Default)]
struct Obj {
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// As long as `triangles` once a face has such an index, empty before.
    uv_indices: Vec<[u32; 3]>,
    normal_indices: Vec<[u32; 3]>,
    /// As long as `triangles` once a second material is used.
    material_ids: Vec<u32>,
    /// Empty before the first vertex that has a colour.
    colours: Vec<[f32; 3]>,
    polygons: Polygons,
    /// Highest index of each kind that a face has used, and where: later lines may still define it.
    highest: [Option<(u32, u64)>; 3],
    libraries: Vec<String>,
    /// Names of the materials that faces use, in order of use; `None` before the first `usemtl`.
    used: Vec<Option<String>>,
    slivers: u64,
    /// Faces with any number of corners.
    faces: u64,
    /// Lines and points, and free-form curves and surfaces: elements that are no faces.
    lines: u64,
    free_form: u64,
    known_lines: u64,
    unknown: Option<(u64, String)>,
}

pub(super) fn parse(
    bytes: &[u8],
    folder: Folder<'_>,
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let mut obj = Obj::default();
    let mut ids: HashMap<Option<String>, u32> = HashMap::new();
    let (mut name, mut id) = (None, None);
    let mut corners = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((number, line)) = lines.next_joined(continues) {
        if number.is_multiple_of(BLOCK) {
            progress.parsed(lines.at(), bytes.len())?;
        }
        let Some(keyword) = text::words(&line).next() else { continue };
        let rest = || line[keyword.len()..].trim_ascii();
        // Numbers end where a comment begins; names may hold a "#".
        let numbers = rest();
        let end = numbers.iter().position(|&b| b == b'#').unwrap_or(numbers.len());
        let mut words = text::words(&numbers[..end]);
        match keyword {
            b"v" => {
                let position = text::position(words.by_ref(), frame);
                obj.positions.push(position.ok_or_else(|| too_few(number, &line))?);
                obj.colour(words);
            }
            b"vn" => obj.normals.push(coordinates(words, number, &line)?),
            b"vt" => {
                // The second coordinate may be left out, for textures of one dimension.
                let [u] = coordinates([words.next()].into_iter().flatten(), number, &line)?;
                let v =
                    words.next().map_or(Ok([0.0]), |word| coordinates([word].into_iter(), number, &line))?;
                obj.uvs.push([u, v[0]]);
            }
            b"f" | b"fo" => {
                corners.clear();
                for word in words {
                    corners.push(obj.corner(word, number)?);
                }
                if id.is_none() {
                    let next = obj.used.len() as u32;
                    id = Some(*ids.entry(name.clone()).or_insert_with(|| {
                        obj.used.push(name.clone());
                        next
                    }));
                }
                obj.face(&corners, id.unwrap_or(0));
            }
            b"usemtl" => (name, id) = (Some(String::from_utf8_lossy(rest()).into_owned()), None),
            b"mtllib" => obj.libraries.push(String::from_utf8_lossy(rest()).into_owned()),
            _ if keyword.starts_with(b"#") => continue,
            b"l" | b"p" => obj.lines += 1,
            b"curv" | b"curv2" | b"surf" => obj.free_form += 1,
            b"o" | b"g" | b"s" | b"mg" | b"vp" | b"usemap" | b"maplib" | b"bevel" | b"c_interp"
            | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj" | b"cstype" | b"deg" | b"bmat"
            | b"step" | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"ctech"
            | b"stech" | b"call" | b"csh" => {}
            _ => {
                if obj.unknown.is_none() {
                    obj.unknown = Some((number, quoted(&line)));
                }
                continue;
            }
        }
        obj.known_lines += 1;
    }
    obj.finish(folder, progress)
}

/// True for a line that a `\` at its end joins to the next: one of numbers, without a comment.
fn continues(line: &[u8]) -> bool {
    let keyword = text::words(line).next().unwrap_or_default();
    let is_name = matches!(keyword, b"o" | b"g" | b"usemtl" | b"mtllib" | b"usemap" | b"maplib");
    !is_name && !line.contains(&b'#')
}

fn coordinates<'a, const N: usize>(
    words: impl Iterator<Item = &'a [u8]>,
    number: u64,
    line: &[u8],
) -> Result<[f32; N], LoadError> {
    text::numbers(words).ok_or_else(|| too_few(number, line))
}

fn too_few(number: u64, line: &[u8]) -> LoadError {
    let what = format!("{} has too few numbers, or something else among them", quoted(line));
    invalid(number, what, "write \"v x y z\", \"vn x y z\" or \"vt u v\"; the file may be cut off")
}

impl Obj {
    /// Reads `v`, `v/t`, `v//n` or `v/t/n`; indices count from 1, negative ones from the latest.
    fn corner(&mut self, word: &[u8], line: u64) -> Result<[u32; 3], LoadError> {
        let mut corner = [NONE; 3];
        let mut parts = word.split(|&b| b == b'/');
        for (k, (kind, what)) in KINDS.into_iter().enumerate() {
            let Some(part) = parts.next() else { break };
            if part.is_empty() && k > 0 {
                continue;
            }
            let count = match kind {
                Kind::Vertex => self.positions.len(),
                Kind::Uv => self.uvs.len(),
                Kind::Normal => self.normals.len(),
            };
            let index = std::str::from_utf8(part).ok().and_then(|part| part.parse::<i64>().ok());
            let Some(index) = index else {
                let what = format!("{} is no corner of a face", quoted(word));
                return Err(invalid(line, what, "write v, v/vt, v//vn or v/vt/vn"));
            };
            let zero_based = if index < 0 { index.saturating_add(count as i64) } else { index - 1 };
            corner[k] = u32::try_from(zero_based).ok().filter(|&index| index != NONE).ok_or_else(|| {
                invalid(line, out_of_range(what, index, count), "the first one is 1, the latest −1")
            })?;
            if self.highest[k].is_none_or(|(highest, _)| corner[k] > highest) {
                self.highest[k] = Some((corner[k], line));
            }
        }
        if parts.next().is_some() {
            let what = format!("{} is no corner of a face", quoted(word));
            return Err(invalid(line, what, "write v, v/vt, v//vn or v/vt/vn"));
        }
        Ok(corner)
    }

    /// Adds the fan of a face.
    fn face(&mut self, corners: &[[u32; 3]], material: u32) {
        self.faces += 1;
        if corners.len() < 3 {
            self.slivers += 1;
            return;
        }
        let before = self.triangles.len();
        let fan = |k: usize| {
            let first = corners[0][k];
            corners.windows(2).skip(1).map(move |pair| [first, pair[0][k], pair[1][k]])
        };
        self.triangles.extend(fan(0));
        self.polygons.add(before, corners.len(), 1);
        for (k, indices) in [(1, &mut self.uv_indices), (2, &mut self.normal_indices)] {
            // A face has the attribute when all its corners do.
            let has = corners.iter().all(|corner| corner[k] != NONE);
            if has {
                indices.resize(before, [NONE; 3]);
                indices.extend(fan(k));
            } else if !indices.is_empty() {
                indices.resize(self.triangles.len(), [NONE; 3]);
            }
        }
        if material > 0 {
            self.material_ids.resize(before, 0);
        }
        if material > 0 || !self.material_ids.is_empty() {
            self.material_ids.resize(self.triangles.len(), material);
        }
    }

    /// Reads the colour behind a vertex' position: "v x y z r g b", or with a weight before it or an opacity behind it.
    fn colour<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) {
        let rest: Vec<f32> = words.take(4).map_while(text::number).collect();
        if let [r, g, b] | [r, g, b, _] = rest[..] {
            self.colours.resize(self.positions.len() - 1, [1.0; 3]);
            self.colours.push([r, g, b]);
        }
    }

    fn finish(mut self, folder: Folder<'_>, progress: &Progress) -> Result<Scene, LoadError> {
        if self.known_lines == 0
            && let Some((line, text)) = self.unknown
        {
            let what = format!("no line is one of an OBJ, the first is {text}");
            return Err(invalid(line, what, "give the file the extension of what it is"));
        }
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        for ((highest, count), (_, what)) in self.highest.into_iter().zip(counts).zip(KINDS) {
            if let Some((index, line)) = highest
                && index as usize >= count
            {
                let what = out_of_range(what, i64::from(index) + 1, count);
                return Err(invalid(line, what, "fix the index, or the file was cut off"));
            }
        }
        let mut warnings = Vec::new();
        if let Some((line, text)) = self.unknown {
            let what = format!("unknown lines were ignored, the first is line {line}: {text}");
            warn(&mut warnings, Warning::new(WarningKind::Ignored, what));
        }
        let elements = self.faces + self.lines + self.free_form;
        for (count, what) in [
            (self.lines, "elements are lines or points and were left out"),
            (
                self.free_form,
                "elements are free-form curves or surfaces and were left out; export them as polygons",
            ),
        ] {
            if count > 0 {
                warn(&mut warnings, Warning::counted(WarningKind::Ignored, count, elements, what));
            }
        }
        if self.slivers > 0 {
            let what = "faces have fewer than 3 corners and were left out";
            warn(&mut warnings, Warning::counted(WarningKind::Invalid, self.slivers, self.faces, what));
        }
        let mut others = [&mut self.uv_indices[..], &mut self.normal_indices[..]];
        self.polygons.mend(&self.positions, &mut self.triangles, &mut others, &mut warnings, progress)?;
        let colours = colours(self.colours, self.positions.len());
        let library = load_libraries(&self.libraries, folder, &mut warnings);
        let mut textures = Textures::new(folder);
        let materials = self.used.iter().map(|name| match name {
            Some(name) => library.material(name, &mut textures, &mut warnings),
            None => Default::default(),
        });
        let materials = materials.collect();
        let normals = attribute(self.normals, self.normal_indices, &self.triangles, counts[0]);
        let uvs = attribute(self.uvs, self.uv_indices, &self.triangles, counts[0]);
        let mesh = Arc::new(TriangleMesh::new(self.positions, self.triangles)?);
        let material_ids = self.material_ids;
        let textures = textures.list;
        Ok(Scene {
            mesh,
            materials,
            material_ids,
            normals,
            uvs,
            colours,
            textures,
            warnings,
            ..Default::default()
        })
    }
}

/// Vertex colours in bytes. They are meant from 0 to 1; where one is above, all are taken for bytes.
fn colours(mut colours: Vec<[f32; 3]>, vertices: usize) -> Option<Attribute<[u8; 4]>> {
    if colours.is_empty() {
        return None;
    }
    let scale = if colours.iter().flatten().any(|&x| x > 1.0) { 1.0 } else { 255.0 };
    colours.resize(vertices, [255.0 / scale; 3]);
    let byte = |x: f32| (x * scale).round() as u8;
    let values = colours.into_iter().map(|[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
    Some(Attribute { values, indices: None })
}

fn out_of_range(what: &str, index: i64, count: usize) -> String {
    format!("a face uses {what} {index}, but there are {count}")
}

fn attribute<T>(
    values: Vec<T>,
    mut indices: Vec<[u32; 3]>,
    triangles: &[[u32; 3]],
    vertices: usize,
) -> Option<Attribute<T>> {
    if indices.is_empty() {
        return None;
    }
    indices.resize(triangles.len(), [NONE; 3]);
    // The usual "f 1/1/1 2/2/2 3/3/3" needs no indices of its own.
    let same = values.len() >= vertices && indices == triangles;
    Some(Attribute { values, indices: (!same).then_some(indices) })
}

fn load_libraries(names: &[String], folder: Folder<'_>, warnings: &mut Vec<Warning>) -> Library {
    let mut library = Library::default();
    let mut seen = HashSet::new();
    for line in names {
        // A statement may name several files, or one whose name has blanks.
        let files: Vec<&str> =
            if folder.has(line) { vec![line.as_str()] } else { line.split_whitespace().collect() };
        for file in files {
            if !seen.insert(file) {
                continue;
            }
            match folder.read(file) {
                Ok(bytes) => library.add(file, &bytes, warnings),
                Err(why) => {
                    let file = quoted(file.as_bytes());
                    let what = format!("material file {file} was left out: {why}");
                    warn(warnings, Warning::new(WarningKind::Missing, what));
                }
            }
        }
    }
    library
}
