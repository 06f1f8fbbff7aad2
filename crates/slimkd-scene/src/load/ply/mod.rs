//! PLY: text and binary, any types and order of properties; elements and properties that mean nothing here are skipped.

mod header;
mod roles;
mod uniform;
mod values;

use super::{Format, LoadError, Loading, Place, Progress, polygon::Polygons};
use crate::origin::Frame;
use crate::{Attribute, Scene, Warning, WarningKind};
use header::{Element, Encoding, Header, Number};
use roles::{SLOTS, Slots, VertexColumns, colour_byte, colour_slot, corner_list, corner_uvs};
use slimkd::TriangleMesh;
use std::sync::Arc;
use values::{Binary, Text, Values, cut_off};

/// Entries between two looks at the progress.
const BLOCK: u64 = 1 << 16;
/// A corner without texture coordinates.
const NONE: u32 = u32::MAX;

fn invalid(place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Ply, place, what: what.into(), fix }
}

pub(super) fn parse(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let header = Header::parse(bytes)?;
    match header.encoding {
        Encoding::Text => parse_text(&header, bytes, frame, progress),
        encoding => {
            let mut values = Binary { bytes, at: header.bytes, big: encoding.is_big() };
            let fast =
                |body: &mut Body<'_>, values: &mut Binary<'_>| body.read_uniform(values, encoding, progress);
            Body::new(&header, frame)?.read(&mut values, bytes, progress, fast)
        }
    }
}

/// Text, whose lines may have more numbers than the header says: then they are read line by line.
fn parse_text(header: &Header, bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let read = |by_lines: bool| {
        let mut values = Text::new(bytes, header.bytes, header.lines + 1, by_lines);
        let scene = Body::new(header, frame)?.read(&mut values, bytes, progress, |_, _| Ok(false));
        Ok::<_, LoadError>((scene, values))
    };
    let (scene, values) = read(false)?;
    if matches!(scene, Err(LoadError::Cancelled)) || (scene.is_ok() && !values.has_more()) {
        return scene;
    }
    let (lines, line_values) = read(true)?;
    if let Ok(mut lines) = lines
        && line_values.longer > 0
        && !line_values.has_more()
    {
        let what = "entries have more numbers in their lines than the header says, which were left out";
        let warning = Warning::counted(WarningKind::Invalid, line_values.longer, line_values.entries, what);
        lines.warnings.push(warning);
        return Ok(lines);
    }
    let mut scene = scene?;
    let what = format!("{} bytes behind the last entry were ignored", bytes.len() - values.at);
    scene.warnings.push(Warning::new(WarningKind::Ignored, what));
    Ok(scene)
}

/// The mesh while it is read.
struct Body<'h> {
    elements: &'h [Element],
    frame: &'h Frame,
    encoding: Encoding,
    /// The element that is being read.
    current: usize,
    vertex: usize,
    slots: Slots,
    columns: VertexColumns,
    /// The face element, and its property that lists the corners.
    face: Option<(usize, usize)>,
    /// The faces' property with texture coordinates, and whether they have colours.
    face_uvs: Option<usize>,
    has_face_colours: bool,
    /// The element of triangle strips, and its property that lists the corners.
    strips: Option<(usize, usize)>,
    triangles: Vec<[u32; 3]>,
    polygons: Polygons,
    corner_uvs: Vec<[f32; 2]>,
    /// As long as `triangles` once a face has texture coordinates, empty before.
    uv_indices: Vec<[u32; 3]>,
    face_colours: Vec<[u8; 4]>,
    /// Faces of fewer than three corners.
    slivers: u64,
}

impl<'h> Body<'h> {
    fn new(header: &'h Header, frame: &'h Frame) -> Result<Self, LoadError> {
        let named = |name: &str| header.elements.iter().position(|element| element.name == name);
        let vertex = named("vertex").ok_or_else(|| {
            invalid(Place::Line(header.lines), "the header has no vertex element", "add the vertices")
        })?;
        let slots = Slots::of(&header.elements[vertex]);
        if !slots.has(0..3) {
            let place = Place::Line(header.elements[vertex].line);
            return Err(invalid(place, "the vertices lack x, y or z", "give them all three"));
        }
        let face = match named("face") {
            None => None,
            Some(face) => Some((
                face,
                corner_list(&header.elements[face]).ok_or_else(|| {
                    let place = Place::Line(header.elements[face].line);
                    invalid(place, "the faces have no vertex_indices", "add the list or remove the element")
                })?,
            )),
        };
        let strips =
            named("tristrips").and_then(|strips| Some((strips, corner_list(&header.elements[strips])?)));
        let face_element = face.map(|(face, _)| &header.elements[face]);
        let face_uvs = face_element.and_then(corner_uvs);
        let has_face_colours = face_element.is_some_and(|element| {
            let named = |slot| {
                element.properties.iter().any(|p| p.length.is_none() && colour_slot(&p.name) == Some(slot))
            };
            named(0) && named(1) && named(2)
        });
        let columns = VertexColumns {
            has_colours: slots.has(8..11),
            has_normals: slots.has(3..6),
            has_uvs: slots.has(6..8),
            ..Default::default()
        };
        Ok(Self {
            elements: &header.elements,
            frame,
            encoding: header.encoding,
            current: 0,
            vertex,
            slots,
            columns,
            face,
            face_uvs,
            has_face_colours,
            strips,
            triangles: Vec::new(),
            polygons: Polygons::default(),
            corner_uvs: Vec::new(),
            uv_indices: Vec::new(),
            face_colours: Vec::new(),
            slivers: 0,
        })
    }

    /// Reads all elements; `fast` may take one at once and says whether it did.
    fn read<V: Values>(
        mut self,
        values: &mut V,
        bytes: &[u8],
        progress: &Progress,
        fast: impl Fn(&mut Self, &mut V) -> Result<bool, LoadError>,
    ) -> Result<Scene, LoadError> {
        for (current, element) in self.elements.iter().enumerate() {
            self.current = current;
            progress.parsed(values.at(), bytes.len())?;
            // Checked before any count is trusted with memory or time. Text may end without a line end.
            let least = element.least_bytes(self.encoding);
            let left = (bytes.len() - values.at() + 1) as u64;
            if element.count.checked_mul(least).is_none_or(|needed| needed > left) {
                let what = format!(
                    "{} {} entries need at least {least} bytes each, but {} bytes are left",
                    element.count,
                    super::error::quoted(element.name.as_bytes()),
                    left - 1
                );
                let fix = "the count is wrong or the file was cut off: write or download it again";
                return Err(invalid(Place::Line(element.line), what, fix));
            }
            if least == 0 || fast(&mut self, values)? {
                continue;
            }
            for entry in 0..element.count {
                if entry.is_multiple_of(BLOCK) {
                    progress.parsed(values.at(), bytes.len())?;
                }
                if current == self.vertex {
                    self.read_vertex(values)?;
                } else if let Some((face, list)) = self.face
                    && current == face
                {
                    self.read_face(values, list, entry)?;
                } else if let Some((strips, list)) = self.strips
                    && current == strips
                {
                    self.read_strip(values, list, entry)?;
                } else {
                    for property in &element.properties {
                        skip(values, property.length, property.number)?;
                    }
                }
                values.end_entry();
            }
        }
        self.finish(progress)
    }

    /// Takes a binary element whose entries are all of one size.
    fn read_uniform(
        &mut self,
        values: &mut Binary<'_>,
        encoding: Encoding,
        progress: &Progress,
    ) -> Result<bool, LoadError> {
        let element = &self.elements[self.current];
        let rest = &values.bytes[values.at..];
        if let Some((face, list)) = self.face
            && self.current == face
        {
            if self.has_face_colours || self.face_uvs.is_some() || !self.triangles.is_empty() {
                return Ok(false);
            }
            let vertex_count = self.elements[self.vertex].count;
            let taken = uniform::faces(rest, element, encoding, list, vertex_count, progress)?;
            let Some(faces) = taken else { return Ok(false) };
            if element.count > 0 {
                let corners = faces.triangles.len() / element.count as usize + 2;
                self.polygons.add(0, corners, element.count as usize);
            }
            self.triangles = faces.triangles;
            values.at += faces.bytes;
            return Ok(true);
        }
        if !element.is_fixed() {
            return Ok(false);
        }
        let length = (element.count * element.least_bytes(encoding)) as usize;
        let data = rest.get(..length).ok_or_else(|| cut_off(Place::Byte(values.bytes.len() as u64)))?;
        values.at += length;
        if self.current == self.vertex {
            uniform::vertices(data, element, encoding, &self.slots, &mut self.columns, self.frame, progress)?;
        }
        Ok(true)
    }

    fn read_vertex(&mut self, values: &mut impl Values) -> Result<(), LoadError> {
        let mut row = [0.0; SLOTS];
        row[11] = 255.0;
        for (property, slot) in self.elements[self.vertex].properties.iter().zip(&self.slots.0) {
            match *slot {
                Some(slot @ 8..) => {
                    row[slot] = f32::from(colour_byte(values.next(property.number)?, property.number));
                }
                Some(axis @ 0..3) if self.frame.is_exact() => {
                    row[axis] = self.frame.axis(axis, values.next(values.exact(property.number))?);
                }
                Some(slot) => row[slot] = values.next(property.number)? as f32,
                None => skip(values, property.length, property.number)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v, r, g, b, a] = row;
        self.columns.positions.push([x, y, z]);
        if self.columns.has_normals {
            self.columns.normals.push([nx, ny, nz]);
        }
        if self.columns.has_uvs {
            self.columns.uvs.push([u, v]);
        }
        if self.columns.has_colours {
            self.columns.colours.push([r, g, b, a].map(|x| x as u8));
        }
        Ok(())
    }

    fn read_face(&mut self, values: &mut impl Values, list: usize, entry: u64) -> Result<(), LoadError> {
        let vertex_count = self.elements[self.vertex].count;
        let properties = &self.elements[self.current].properties;
        let before = self.triangles.len();
        let (mut total, mut first_uv, mut colour) = (0, None, [0, 0, 0, 255]);
        for (k, property) in properties.iter().enumerate() {
            if let Some(length) = property.length.filter(|_| Some(k) == self.face_uvs) {
                let count = list_length(values, length, property.number)?;
                first_uv = Some((self.corner_uvs.len(), count));
                let mut u = 0.0;
                for number in 0..count {
                    let value = values.next(property.number)? as f32;
                    if number % 2 == 0 {
                        u = value;
                    } else {
                        self.corner_uvs.push([u, value]);
                    }
                }
                continue;
            }
            if self.has_face_colours
                && property.length.is_none()
                && let Some(slot) = colour_slot(&property.name)
            {
                colour[slot] = colour_byte(values.next(property.number)?, property.number);
                continue;
            }
            let Some(length) = property.length.filter(|_| k == list) else {
                skip(values, property.length, property.number)?;
                continue;
            };
            let corners = list_length(values, length, property.number)?;
            let mut fan = [0; 2];
            for corner in 0..corners {
                let place = values.place();
                let index = values.next(property.number)?;
                if !(index >= 0.0 && index < vertex_count as f64 && index.fract() == 0.0) {
                    let what =
                        format!("face {entry} uses vertex {index}, but there are {vertex_count} vertices");
                    return Err(invalid(place, what, "fix the index; the first vertex is 0"));
                }
                let index = index as u32;
                match corner {
                    0 | 1 => fan[corner as usize] = index,
                    _ => {
                        self.triangles.push([fan[0], fan[1], index]);
                        fan[1] = index;
                    }
                }
            }
            self.slivers += u64::from(corners < 3);
            total = corners;
            self.polygons.add(before, corners as usize, 1);
        }
        if self.has_face_colours {
            self.face_colours.resize(before, [255; 4]);
            self.face_colours.resize(self.triangles.len(), colour);
        }
        if let Some((first, count)) = first_uv {
            // A face without texture coordinates has an empty list, or one of another length.
            if count == 2 * total && total > 0 && self.corner_uvs.len() < NONE as usize {
                let first = first as u32;
                self.uv_indices.resize(before, [NONE; 3]);
                self.uv_indices.extend((2..total as u32).map(|k| [first, first + k - 1, first + k]));
            } else {
                self.corner_uvs.truncate(first);
            }
        }
        Ok(())
    }

    /// Reads a list of triangle strips: −1 ends one, and each begins with a triangle that turns as it is listed.
    fn read_strip(&mut self, values: &mut impl Values, list: usize, entry: u64) -> Result<(), LoadError> {
        let vertex_count = self.elements[self.vertex].count;
        let properties = &self.elements[self.current].properties;
        for (k, property) in properties.iter().enumerate() {
            let Some(length) = property.length.filter(|_| k == list) else {
                skip(values, property.length, property.number)?;
                continue;
            };
            let (mut last, mut turned) = ((None, None), false);
            for _ in 0..list_length(values, length, property.number)? {
                let place = values.place();
                let index = values.next(property.number)?;
                if index == -1.0 {
                    (last, turned) = ((None, None), false);
                    continue;
                }
                if !(index >= 0.0 && index < vertex_count as f64 && index.fract() == 0.0) {
                    let what =
                        format!("strip {entry} uses vertex {index}, but there are {vertex_count} vertices");
                    return Err(invalid(place, what, "fix the index; the first vertex is 0"));
                }
                let c = index as u32;
                if let (Some(a), Some(b)) = last {
                    self.triangles.push(if turned { [a, c, b] } else { [a, b, c] });
                    turned = !turned;
                }
                last = (last.1, Some(c));
            }
        }
        Ok(())
    }

    fn finish(mut self, progress: &Progress) -> Result<Scene, LoadError> {
        let attribute = |values| Attribute { values, indices: None };
        let mut warnings = Vec::new();
        if !self.uv_indices.is_empty() {
            self.uv_indices.resize(self.triangles.len(), [NONE; 3]);
        }
        if !self.face_colours.is_empty() {
            self.face_colours.resize(self.triangles.len(), [255; 4]);
        }
        let positions = &self.columns.positions;
        let mut others = [&mut self.uv_indices[..]];
        self.polygons.mend(positions, &mut self.triangles, &mut others, &mut warnings, progress)?;
        let uvs = match (self.uv_indices.is_empty(), self.columns.has_uvs) {
            (false, _) => Some(Attribute { values: self.corner_uvs, indices: Some(self.uv_indices) }),
            (true, true) => Some(Attribute { values: self.columns.uvs, indices: None }),
            (true, false) => None,
        };
        let mut scene = Scene {
            mesh: Arc::new(TriangleMesh::new(self.columns.positions, self.triangles)?),
            normals: self.columns.has_normals.then_some(attribute(self.columns.normals)),
            uvs,
            colours: self
                .columns
                .has_colours
                .then_some(Attribute { values: self.columns.colours, indices: None }),
            face_colours: self.face_colours,
            warnings,
            ..Default::default()
        };
        if self.slivers > 0 {
            let faces = self.face.map_or(0, |(face, _)| self.elements[face].count);
            let what = "faces have fewer than 3 corners and were left out";
            scene.warnings.push(Warning::counted(WarningKind::Invalid, self.slivers, faces, what));
        }
        let unread = |name: &str| self.elements.iter().find(|element| element.name == name);
        for (name, what) in [("edge", "edges"), ("polyline", "lines")] {
            if let Some(count) = unread(name).map(|element| element.count).filter(|&count| count > 0) {
                let what = format!("{count} {what} were left out: only faces and strips are read");
                scene.warnings.push(Warning::new(WarningKind::Ignored, what));
            }
        }
        Ok(scene)
    }
}

/// The length of a list that comes next.
fn list_length(values: &mut impl Values, length: Number, item: Number) -> Result<u64, LoadError> {
    let place = values.place();
    let count = values.next(length)?;
    if !(count >= 0.0 && count.fract() == 0.0) {
        return Err(invalid(place, format!("a list of {count} entries"), "write a whole number, 0 or more"));
    }
    if count > values.most(item) as f64 {
        let what = format!("a list of {count} entries is longer than the rest of the file");
        return Err(invalid(place, what, "the length is wrong or the file was cut off"));
    }
    Ok(count as u64)
}

fn skip(values: &mut impl Values, length: Option<Number>, number: Number) -> Result<(), LoadError> {
    let count = length.map_or(Ok(1), |length| list_length(values, length, number))?;
    for _ in 0..count {
        values.next(number)?;
    }
    Ok(())
}
