//! PLY: text and binary, any types and order of properties; elements and properties that mean nothing here are skipped.

mod header;
mod roles;
mod uniform;
mod values;

use super::{Format, LoadError, LoadProgress, Place};
use crate::{Attribute, Scene, Warning, WarningKind};
use header::{Element, Encoding, Header, Number};
use roles::{SLOTS, Slots, VertexColumns, corner_list};
use slimkd::TriangleMesh;
use std::sync::Arc;
use values::{Binary, Text, Values, cut_off};

/// Entries between two looks at the progress.
const BLOCK: u64 = 1 << 16;

fn invalid(place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Ply, place, what: what.into(), fix }
}

pub(super) fn parse(bytes: &[u8], progress: &LoadProgress) -> Result<Scene, LoadError> {
    let header = Header::parse(bytes)?;
    let body = Body::new(&header)?;
    match header.encoding {
        Encoding::Text => {
            body.read(Text { bytes, at: header.bytes, line: header.lines + 1 }, bytes, progress, |_, _| {
                Ok(false)
            })
        }
        encoding => {
            let start = Binary { bytes, at: header.bytes, big: encoding.is_big() };
            body.read(start, bytes, progress, |body, values| body.read_uniform(values, encoding, progress))
        }
    }
}

/// The mesh while it is read.
struct Body<'h> {
    elements: &'h [Element],
    encoding: Encoding,
    /// The element that is being read.
    current: usize,
    vertex: usize,
    slots: Slots,
    columns: VertexColumns,
    /// The face element, and its property that lists the corners.
    face: Option<(usize, usize)>,
    triangles: Vec<[u32; 3]>,
    /// Faces of fewer than three corners.
    slivers: u64,
}

impl<'h> Body<'h> {
    fn new(header: &'h Header) -> Result<Self, LoadError> {
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
        let columns =
            VertexColumns { has_normals: slots.has(3..6), has_uvs: slots.has(6..8), ..Default::default() };
        Ok(Self {
            elements: &header.elements,
            encoding: header.encoding,
            current: 0,
            vertex,
            slots,
            columns,
            face,
            triangles: Vec::new(),
            slivers: 0,
        })
    }

    /// Reads all elements; `fast` may take one at once and says whether it did.
    fn read<V: Values>(
        mut self,
        mut values: V,
        bytes: &[u8],
        progress: &LoadProgress,
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
            if least == 0 || fast(&mut self, &mut values)? {
                continue;
            }
            for entry in 0..element.count {
                if entry.is_multiple_of(BLOCK) {
                    progress.parsed(values.at(), bytes.len())?;
                }
                if current == self.vertex {
                    self.read_vertex(&mut values)?;
                } else if let Some((face, list)) = self.face
                    && current == face
                {
                    self.read_face(&mut values, list, entry)?;
                } else {
                    for property in &element.properties {
                        skip(&mut values, property.length, property.number)?;
                    }
                }
            }
        }
        self.finish()
    }

    /// Takes a binary element whose entries are all of one size.
    fn read_uniform(
        &mut self,
        values: &mut Binary<'_>,
        encoding: Encoding,
        progress: &LoadProgress,
    ) -> Result<bool, LoadError> {
        let element = &self.elements[self.current];
        let rest = &values.bytes[values.at..];
        if let Some((face, list)) = self.face
            && self.current == face
        {
            let vertex_count = self.elements[self.vertex].count;
            let taken = uniform::faces(rest, element, encoding, list, vertex_count, progress)?;
            let Some(faces) = taken else { return Ok(false) };
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
            uniform::vertices(data, element, encoding, &self.slots, &mut self.columns, progress)?;
        }
        Ok(true)
    }

    fn read_vertex(&mut self, values: &mut impl Values) -> Result<(), LoadError> {
        let mut row = [0.0; SLOTS];
        for (property, slot) in self.elements[self.vertex].properties.iter().zip(&self.slots.0) {
            match *slot {
                Some(slot) => row[slot] = values.next(property.number)? as f32,
                None => skip(values, property.length, property.number)?,
            }
        }
        let [x, y, z, nx, ny, nz, u, v] = row;
        self.columns.positions.push([x, y, z]);
        if self.columns.has_normals {
            self.columns.normals.push([nx, ny, nz]);
        }
        if self.columns.has_uvs {
            self.columns.uvs.push([u, v]);
        }
        Ok(())
    }

    fn read_face(&mut self, values: &mut impl Values, list: usize, entry: u64) -> Result<(), LoadError> {
        let vertex_count = self.elements[self.vertex].count;
        let properties = &self.elements[self.current].properties;
        for (k, property) in properties.iter().enumerate() {
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
        }
        Ok(())
    }

    fn finish(self) -> Result<Scene, LoadError> {
        let attribute = |values| Attribute { values, indices: None };
        let mut scene = Scene {
            mesh: Arc::new(TriangleMesh::new(self.columns.positions, self.triangles)?),
            normals: self.columns.has_normals.then_some(attribute(self.columns.normals)),
            uvs: self.columns.has_uvs.then_some(Attribute { values: self.columns.uvs, indices: None }),
            ..Default::default()
        };
        if self.slivers > 0 {
            let faces = self.face.map_or(0, |(face, _)| self.elements[face].count);
            let what = "faces have fewer than 3 corners and were left out";
            scene.warnings.push(Warning::counted(WarningKind::Invalid, self.slivers, faces, what));
        }
        if self.elements.iter().any(|element| element.name == "tristrips" && element.count > 0) {
            let what = "triangle strips (element tristrips) were left out; convert them to faces";
            scene.warnings.push(Warning::new(WarningKind::Ignored, what));
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
