//! Mitsuba's `serialized` meshes: several in one file, each compressed by zlib, and a list of their places at the end.
//!
//! As its documentation has it (*Serialized mesh loader*): versions 3 and 4, which differ in the name that 4 has and in the
//! size of the list's entries; coordinates in single or double precision.

use crate::{
    Attribute, Scene,
    load::{Format, LoadError, Loading, Place, Progress, source::growth_limit},
    merge::Gather,
    origin::Frame,
};
use flate2::bufread::ZlibDecoder;
use slimkd::TriangleMesh;
use std::{io::Read, sync::Arc};

const MAGIC: u16 = 0x041C;
const HAS_NORMALS: u32 = 0x0001;
const HAS_UVS: u32 = 0x0002;
const HAS_COLOURS: u32 = 0x0008;
const IS_DOUBLE: u32 = 0x2000;
/// Bytes that are decompressed between two looks at the progress.
const BLOCK: usize = 1 << 20;

fn invalid(at: usize, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format: Format::Serialized, place: Place::Byte(at as u64), what: what.into(), fix }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    bytes.get(at..)?.first_chunk().map(|&raw| u16::from_le_bytes(raw))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..)?.first_chunk().map(|&raw| u32::from_le_bytes(raw))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|&raw| u64::from_le_bytes(raw))
}

/// All meshes of a file as one, in their order.
pub(in crate::load) fn parse(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let list = List::of(bytes)?;
    let mut left = growth_limit(bytes.len() as u64);
    if list.count == 1 {
        return mesh(bytes, 0, &mut left, frame, progress);
    }
    let mut whole = Gather::default();
    for index in 0..list.count {
        whole.append(&mesh(bytes, list.place(bytes, index)?, &mut left, frame, progress)?, None);
    }
    Ok(whole.finish()?)
}

/// One mesh of a file.
pub(super) fn part(
    bytes: &[u8],
    index: usize,
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let list = List::of(bytes)?;
    if index >= list.count {
        let what = format!("there is no mesh {index}: the file has {}", list.count);
        return Err(invalid(bytes.len(), what, "fix shape_index; the first is 0"));
    }
    mesh(bytes, list.place(bytes, index)?, &mut growth_limit(bytes.len() as u64), frame, progress)
}

/// The list of the meshes' places.
struct List {
    start: usize,
    count: usize,
    /// Bytes of an entry.
    size: usize,
}

impl List {
    fn of(bytes: &[u8]) -> Result<Self, LoadError> {
        if u16_at(bytes, 0) != Some(MAGIC) {
            let fix = "it was cut off or is no file of serialized meshes";
            return Err(invalid(0, "it does not begin as Mitsuba's serialized meshes do", fix));
        }
        let size = if u16_at(bytes, 2) == Some(3) { 4 } else { 8 };
        let end = bytes.len().saturating_sub(4);
        let count = u32_at(bytes, end).unwrap_or(0) as usize;
        let start = count.checked_mul(size).and_then(|length| end.checked_sub(length));
        let list = start.map(|start| Self { start, count, size });
        // Without its list, or with one that is damaged, a file has one mesh that can be found.
        let list = list.filter(|list| count > 0 && list.entry(bytes, 0) == Some(0));
        Ok(list.unwrap_or(Self { start: bytes.len(), count: 1, size }))
    }

    fn entry(&self, bytes: &[u8], index: usize) -> Option<u64> {
        let at = self.start + index * self.size;
        if self.size == 4 { u32_at(bytes, at).map(u64::from) } else { u64_at(bytes, at) }
    }

    fn place(&self, bytes: &[u8], index: usize) -> Result<usize, LoadError> {
        if index == 0 {
            return Ok(0);
        }
        let place = self.entry(bytes, index).and_then(|place| usize::try_from(place).ok());
        place.filter(|&place| place < self.start).ok_or_else(|| {
            let what = format!("the list of meshes says that mesh {index} lies outside the file");
            invalid(self.start + index * self.size, what, "write it again")
        })
    }
}

/// The decompressed bytes of a mesh, taken one after another.
struct Content<'a> {
    decoder: ZlibDecoder<&'a [u8]>,
    place: usize,
    left: &'a mut u64,
    input: u64,
    progress: &'a Progress,
}

impl Content<'_> {
    fn cut_off(&self, why: &dyn std::fmt::Display) -> LoadError {
        invalid(self.place, format!("the mesh that begins here is damaged: {why}"), "write it again")
    }

    /// Reads `count` values of `size` bytes each.
    fn take(&mut self, count: u64, size: u64) -> Result<Vec<u8>, LoadError> {
        let length = count.saturating_mul(size);
        *self.left = self.left.checked_sub(length).ok_or(LoadError::OutOfProportion {
            what: "the serialized meshes",
            limit: growth_limit(self.input),
            input: self.input,
            fix: "write them as PLY",
        })?;
        let mut out = Vec::new();
        while (out.len() as u64) < length {
            self.progress.reach(0.0)?;
            let before = out.len();
            let block = (length - before as u64).min(BLOCK as u64);
            if let Err(why) = (&mut self.decoder).take(block).read_to_end(&mut out) {
                return Err(self.cut_off(&why));
            }
            if out.len() == before {
                return Err(self.cut_off(&"it ends too early"));
            }
        }
        Ok(out)
    }

    fn number(&mut self) -> Result<u64, LoadError> {
        Ok(self.take(1, 8)?.first_chunk().map_or(0, |&raw| u64::from_le_bytes(raw)))
    }

    /// Reads positions.
    fn positions(&mut self, rows: u64, is_double: bool, frame: &Frame) -> Result<Vec<[f32; 3]>, LoadError> {
        if is_double {
            let bytes = self.take(rows, 24)?;
            let position = |raw: &[u8; 24]| [0, 1, 2].map(|k| f64::from_le_bytes(raw.as_chunks::<8>().0[k]));
            return Ok(bytes.as_chunks::<24>().0.iter().map(|raw| frame.put(position(raw))).collect());
        }
        let mut positions = self.rows::<3>(rows, false)?;
        if frame.is_exact() {
            positions.iter_mut().for_each(|position| *position = frame.put_f32(*position));
        }
        Ok(positions)
    }

    /// Reads rows of `N` coordinates.
    fn rows<const N: usize>(&mut self, rows: u64, is_double: bool) -> Result<Vec<[f32; N]>, LoadError> {
        let size = if is_double { 8 } else { 4 };
        let bytes = self.take(rows, N as u64 * size)?;
        let values: Vec<f32> = if is_double {
            bytes.as_chunks::<8>().0.iter().map(|&raw| f64::from_le_bytes(raw) as f32).collect()
        } else {
            bytes.as_chunks::<4>().0.iter().map(|&raw| f32::from_le_bytes(raw)).collect()
        };
        drop(bytes);
        Ok(values.as_chunks::<N>().0.to_vec())
    }
}

fn mesh(
    bytes: &[u8],
    place: usize,
    left: &mut u64,
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let (magic, version) = (u16_at(bytes, place), u16_at(bytes, place.saturating_add(2)));
    let (Some(MAGIC), Some(version @ (3 | 4))) = (magic, version) else {
        return Err(invalid(
            place,
            "a mesh does not begin here, or is of another version than 3 and 4",
            "write it again",
        ));
    };
    let decoder = ZlibDecoder::new(&bytes[place + 4..]);
    let mut content = Content { decoder, place, left, input: bytes.len() as u64, progress };
    let flags = content.take(1, 4)?.first_chunk().map_or(0, |&raw| u32::from_le_bytes(raw));
    let mut name = Vec::new();
    if version == 4 {
        loop {
            match content.take(1, 1)?[0] {
                0 => break,
                byte if name.len() < 1 << 16 => name.push(byte),
                _ => return Err(content.cut_off(&"its name does not end")),
            }
        }
    }
    let (vertices, triangles) = (content.number()?, content.number()?);
    if vertices > u64::from(u32::MAX) || triangles > u64::from(u32::MAX) {
        return Err(content.cut_off(&format!("{vertices} vertices and {triangles} triangles are too many")));
    }
    let is_double = flags & IS_DOUBLE != 0;
    let positions = content.positions(vertices, is_double, frame)?;
    let normals = if flags & HAS_NORMALS != 0 { Some(content.rows(vertices, is_double)?) } else { None };
    let uvs = if flags & HAS_UVS != 0 { Some(content.rows(vertices, is_double)?) } else { None };
    let colours = if flags & HAS_COLOURS != 0 { Some(content.rows::<3>(vertices, is_double)?) } else { None };
    let corners = content.take(triangles, 12)?;
    let corners: Vec<u32> = corners.as_chunks::<4>().0.iter().map(|&raw| u32::from_le_bytes(raw)).collect();
    if let Some(bad) = corners.iter().find(|&&corner| u64::from(corner) >= vertices) {
        return Err(content.cut_off(&format!("a triangle uses vertex {bad}, but there are {vertices}")));
    }
    let byte = |share: f32| (share.clamp(0.0, 1.0) * 255.0).round() as u8;
    let colour = |[r, g, b]: [f32; 3]| [byte(r), byte(g), byte(b), 255];
    Ok(Scene {
        name: String::from_utf8_lossy(&name).into_owned(),
        mesh: Arc::new(TriangleMesh::new(positions, corners.as_chunks::<3>().0.to_vec())?),
        normals: normals.map(|values| Attribute { values, indices: None }),
        uvs: uvs.map(|values| Attribute { values, indices: None }),
        colours: colours
            .map(|values| Attribute { values: values.into_iter().map(colour).collect(), indices: None }),
        ..Default::default()
    })
}
