//! The fast path: binary elements whose entries all take the same number of bytes, read in parallel.

use super::{
    header::{Element, Encoding, Number},
    roles::{SLOTS, Slots, VertexColumns, colour_byte},
    values::decode,
};
use crate::load::{LoadError, Loading, Progress};
use crate::origin::Frame;
use rayon::prelude::*;

/// Entries that a thread takes at once: some 200 KB of the usual 13 bytes a face.
const BLOCK: usize = 1 << 14;

/// Reads vertices without lists; `data` holds them all and nothing else.
pub(super) fn vertices(
    data: &[u8],
    element: &Element,
    encoding: Encoding,
    slots: &Slots,
    columns: &mut VertexColumns,
    frame: &Frame,
    progress: &Progress,
) -> Result<(), LoadError> {
    let stride = element.properties.iter().map(|property| property.number.size()).sum::<usize>();
    let mut offset = 0;
    let mut fields: [Option<(usize, Number)>; SLOTS] = [None; SLOTS];
    for (property, slot) in element.properties.iter().zip(&slots.0) {
        if let Some(slot) = *slot {
            fields[slot] = Some((offset, property.number));
        }
        offset += property.number.size();
    }
    fn column<const N: usize>(
        data: &[u8],
        stride: usize,
        fields: [Option<(usize, Number)>; N],
        big: bool,
        frame: Option<&Frame>,
        progress: &Progress,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        let frame = frame.filter(|frame| frame.is_exact());
        let plain = frame.is_none()
            && fields
                .iter()
                .enumerate()
                .all(|(k, field)| !big && *field == fields[0].map(|(first, _)| (first + 4 * k, Number::F32)));
        let mut out = vec![[0.0; N]; data.len() / stride];
        out.par_chunks_mut(BLOCK).zip(data.par_chunks(BLOCK * stride)).try_for_each(|(out, data)| {
            progress.reach(0.0)?;
            for (out, row) in out.iter_mut().zip(data.chunks_exact(stride)) {
                match fields[0] {
                    Some((first, _)) if plain => {
                        for (out, raw) in out.iter_mut().zip(row[first..].as_chunks::<4>().0) {
                            *out = f32::from_le_bytes(*raw);
                        }
                    }
                    _ => {
                        for (k, (out, field)) in out.iter_mut().zip(fields).enumerate() {
                            let value = field.map_or(0.0, |(at, number)| decode(&row[at..], number, big));
                            *out = frame.map_or(value as f32, |frame| frame.axis(k, value));
                        }
                    }
                }
            }
            Ok::<(), LoadError>(())
        })?;
        Ok(out)
    }
    let big = encoding.is_big();
    let [x, y, z, nx, ny, nz, u, v, r, g, b, a] = fields;
    columns.positions = column(data, stride, [x, y, z], big, Some(frame), progress)?;
    if columns.has_normals {
        columns.normals = column(data, stride, [nx, ny, nz], big, None, progress)?;
    }
    if columns.has_uvs {
        columns.uvs = column(data, stride, [u, v], big, None, progress)?;
    }
    if columns.has_colours {
        columns.colours = vec![[255; 4]; data.len() / stride];
        let (rows, colours) = (data.par_chunks(BLOCK * stride), columns.colours.par_chunks_mut(BLOCK));
        colours.zip(rows).try_for_each(|(colours, data)| {
            progress.reach(0.0)?;
            for (colour, row) in colours.iter_mut().zip(data.chunks_exact(stride)) {
                for (byte, field) in colour.iter_mut().zip([r, g, b, a]) {
                    if let Some((at, number)) = field {
                        *byte = colour_byte(decode(&row[at..], number, big), number);
                    }
                }
            }
            Ok::<(), LoadError>(())
        })?;
    }
    Ok(())
}

/// The fans of all faces, and the bytes that they took.
pub(super) struct Faces {
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) bytes: usize,
}

/// Reads faces of equally many corners. `data` is all that is left of the file. `None` when the faces are not all alike or not all valid: then the general path must look.
pub(super) fn faces(
    data: &[u8],
    element: &Element,
    encoding: Encoding,
    list: usize,
    vertex_count: u64,
    progress: &Progress,
) -> Result<Option<Faces>, LoadError> {
    let big = encoding.is_big();
    let lists = element.properties.iter().filter(|property| property.length.is_some()).count();
    let Some(length) = element.properties[list].length.filter(|_| lists == 1) else { return Ok(None) };
    let number = element.properties[list].number;
    let scalars = |properties: &[super::header::Property]| {
        properties.iter().map(|property| property.number.size()).sum::<usize>()
    };
    let before = scalars(&element.properties[..list]);
    let after = scalars(&element.properties[list + 1..]);
    if data.len() < before + length.size() {
        return Ok(None);
    }
    let corners = decode(&data[before..], length, big);
    // Larger polygons are too rare to be worth a path of their own.
    if !(3.0..=64.0).contains(&corners) || corners.fract() != 0.0 {
        return Ok(None);
    }
    let fan = corners as usize - 2;
    let first = before + length.size();
    let stride = first + (fan + 2) * number.size() + after;
    let Some(total) = usize::try_from(element.count).ok().and_then(|count| count.checked_mul(stride)) else {
        return Ok(None);
    };
    let Some(data) = data.get(..total) else { return Ok(None) };
    let plain = fan == 1 && !big && length == Number::U8 && matches!(number, Number::I32 | Number::U32);
    let limit = if number == Number::I32 { vertex_count.min(1 << 31) } else { vertex_count };

    let mut triangles = vec![[0; 3]; total / stride * fan];
    let alike = triangles
        .par_chunks_mut(BLOCK * fan)
        .zip(data.par_chunks(BLOCK * stride))
        .map(|(triangles, data)| {
            progress.reach(0.0)?;
            for (triangles, row) in triangles.chunks_exact_mut(fan).zip(data.chunks_exact(stride)) {
                if plain {
                    if row[before] != 3 {
                        return Ok(false);
                    }
                    let raw = row[first..].as_chunks::<4>().0;
                    let corners = [0, 1, 2].map(|k| u32::from_le_bytes(raw[k]));
                    if corners.iter().any(|&corner| u64::from(corner) >= limit) {
                        return Ok(false);
                    }
                    triangles[0] = corners;
                    continue;
                }
                if decode(&row[before..], length, big) != corners {
                    return Ok(false);
                }
                let index = |k: usize| {
                    let value = decode(&row[first + k * number.size()..], number, big);
                    (value >= 0.0 && value < vertex_count as f64 && value.fract() == 0.0)
                        .then_some(value as u32)
                };
                for (k, triangle) in triangles.iter_mut().enumerate() {
                    let (Some(a), Some(b), Some(c)) = (index(0), index(k + 1), index(k + 2)) else {
                        return Ok(false);
                    };
                    *triangle = [a, b, c];
                }
            }
            Ok(true)
        })
        .try_reduce(|| true, |a, b| Ok::<_, LoadError>(a && b))?;
    Ok(alike.then_some(Faces { triangles, bytes: total }))
}
