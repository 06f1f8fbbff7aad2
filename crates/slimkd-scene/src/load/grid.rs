//! Regular grids of heights: ESRI ASCII grids (`.asc`) and arrays of NumPy (`.npy`) of two dimensions.
//!
//! Row 0 is the northernmost. Each height is a vertex, row by row, at the middle of its cell: x goes east by columns, y goes
//! north, z is the height. A square of four heights is two triangles, in the order of the rows; where a height is missing
//! there is none. An array of NumPy has cells of size 1, its south-western vertex at the origin, and misses what is not finite.

use super::{Format, LoadError, Loading, Place, Progress, error::quoted, text};
use crate::origin::Frame;
use crate::{Scene, UpAxis, Warning, WarningKind};
use slimkd::TriangleMesh;
use std::sync::Arc;

/// Numbers between two looks at the progress.
const BLOCK: usize = 1 << 14;

fn invalid(format: Format, place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
    LoadError::Invalid { format, place, what: what.into(), fix }
}

/// Where the vertices lie.
struct Grid {
    rows: usize,
    columns: usize,
    /// The south-western vertex.
    origin: [f64; 2],
    /// From a vertex to its eastern and to its northern neighbour.
    cell: [f64; 2],
}

/// ESRI's text format: a header of names and numbers, then the rows.
pub(super) fn parse_ascii(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let wrong = |line, what: String, fix| invalid(Format::AsciiGrid, Place::Line(line), what, fix);
    let (mut rows, mut columns) = (None, None);
    let (mut corner, mut is_centre, mut cell) = ([0.0f64; 2], [false; 2], [None::<f64>; 2]);
    let mut no_data: Option<f64> = None;
    let mut values = Vec::new();
    let mut missing = Vec::new();
    let mut lines = text::Lines::new(bytes);
    let mut last = 0;
    let mut expected = 0;
    while let Some((number, line)) = lines.next() {
        last = number;
        if number.is_multiple_of(BLOCK as u64) {
            progress.parsed(lines.at(), bytes.len())?;
        }
        let first = line.first().copied().unwrap_or(b' ');
        if values.is_empty() && first.is_ascii_alphabetic() && !line.to_ascii_lowercase().starts_with(b"nan")
        {
            let mut words = text::words(line);
            let name = String::from_utf8_lossy(words.next().unwrap_or_default()).to_ascii_lowercase();
            let word = words.next().unwrap_or_default();
            let value: Option<f64> = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            let value = value.ok_or_else(|| {
                wrong(number, format!("{} has no number", quoted(line)), "write a name and a number")
            })?;
            let whole = || {
                let is_whole = value >= 1.0 && value.fract() == 0.0 && value < f64::from(u32::MAX);
                is_whole.then_some(value as usize).ok_or_else(|| {
                    wrong(number, format!("{} is no count", quoted(line)), "write a whole number, 1 or more")
                })
            };
            match name.as_str() {
                "ncols" => columns = Some(whole()?),
                "nrows" => rows = Some(whole()?),
                "xllcorner" => (corner[0], is_centre[0]) = (value, false),
                "yllcorner" => (corner[1], is_centre[1]) = (value, false),
                "xllcenter" => (corner[0], is_centre[0]) = (value, true),
                "yllcenter" => (corner[1], is_centre[1]) = (value, true),
                "cellsize" => cell = [Some(value); 2],
                "dx" => cell[0] = Some(value),
                "dy" => cell[1] = Some(value),
                "nodata_value" => no_data = Some(value),
                _ => {
                    let fix = "use ncols, nrows, xllcorner, yllcorner, cellsize and NODATA_value";
                    return Err(wrong(number, format!("header line {}", quoted(line)), fix));
                }
            }
            continue;
        }
        let (Some(rows), Some(columns)) = (rows, columns) else {
            let what = "heights before ncols and nrows".to_owned();
            return Err(wrong(number, what, "the file is damaged or no ESRI ASCII grid"));
        };
        if expected == 0 {
            // A height takes two bytes at least.
            expected = (rows as u64).saturating_mul(columns as u64);
            if expected.saturating_mul(2) > bytes.len() as u64 + 1 {
                let what = format!("{rows} rows of {columns} heights do not fit into the file");
                return Err(wrong(number, what, "the header is wrong or the file was cut off"));
            }
        }
        for word in text::words(line) {
            let value: f64 = text::number(word).ok_or_else(|| {
                wrong(number, format!("{} is not a number", quoted(word)), "write a number there")
            })?;
            missing.push(!value.is_finite() || no_data == Some(value));
            values.push(value);
        }
        if values.len() as u64 > expected {
            let what = format!("more than {expected} heights");
            return Err(wrong(number, what, "correct ncols and nrows, or the heights"));
        }
    }
    let (Some(rows), Some(columns)) = (rows, columns) else {
        let what = "there is no ncols or no nrows".to_owned();
        return Err(wrong(last, what, "the file is damaged or no ESRI ASCII grid"));
    };
    if values.len() as u64 != (rows as u64).saturating_mul(columns as u64) {
        let what = format!("{} heights, not {rows} rows of {columns}", values.len());
        return Err(wrong(last, what, "the header is wrong or the file was cut off"));
    }
    let cell = cell.map(|cell| cell.unwrap_or(1.0));
    if cell.iter().any(|&cell| !(cell > 0.0 && cell.is_finite())) {
        return Err(wrong(last, "the size of a cell is not above 0".into(), "correct cellsize"));
    }
    let half = |axis: usize| if is_centre[axis] { 0.0 } else { 0.5 * cell[axis] };
    let origin = [corner[0] + half(0), corner[1] + half(1)];
    scene(&Grid { rows, columns, origin, cell }, &values, &missing, frame, progress)
}

/// NumPy's format, versions 1 to 3 (NumPy Enhancement Proposal 1).
pub(super) fn parse_npy(bytes: &[u8], frame: &Frame, progress: &Progress) -> Result<Scene, LoadError> {
    let wrong = |at: usize, what: &str, fix| invalid(Format::Npy, Place::Byte(at as u64), what, fix);
    let damaged = "the file is damaged or no array of NumPy";
    let (Some(b"\x93NUMPY"), Some(&version)) = (bytes.get(..6), bytes.get(6)) else {
        return Err(wrong(0, "it does not begin as NumPy's arrays do", damaged));
    };
    let (start, length) = match (version, bytes.get(8..12)) {
        (1, Some(raw)) => (10usize, usize::from(u16::from_le_bytes([raw[0], raw[1]]))),
        (2 | 3, Some(raw)) => (12, u32::from_le_bytes([raw[0], raw[1], raw[2], raw[3]]) as usize),
        _ => return Err(wrong(6, "an unknown version", "save it by numpy.save")),
    };
    let end = start.checked_add(length).filter(|&end| end <= bytes.len());
    let end = end.ok_or_else(|| wrong(start, "the header is longer than the file", damaged))?;
    let header = String::from_utf8_lossy(&bytes[start..end]);
    let behind = |key: &str| {
        let at = header.find(&format!("'{key}'"))? + key.len() + 2;
        Some(header[at..].trim_start().strip_prefix(':')?.trim_start())
    };
    let kind = behind("descr").and_then(|rest| rest.strip_prefix('\'')?.split('\'').next());
    let is_fortran = behind("fortran_order").is_some_and(|rest| rest.starts_with("True"));
    let shape = behind("shape").and_then(|rest| rest.strip_prefix('(')?.split(')').next());
    let shape: Option<Vec<usize>> = shape.and_then(|shape| {
        shape.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect()
    });
    let Some(&[rows, columns]) = shape.as_deref() else {
        return Err(wrong(start, "the array has not two dimensions", "save heights by rows and columns"));
    };
    let (Some(kind), true) = (kind, rows > 0 && columns > 0) else {
        return Err(wrong(start, "the array is empty or of no plain type", "save an array of numbers"));
    };
    let (big, code) = (kind.starts_with('>'), kind.trim_start_matches(['<', '>', '|', '=']));
    let size = match code {
        "i1" | "u1" => 1,
        "i2" | "u2" => 2,
        "i4" | "u4" | "f4" => 4,
        "i8" | "u8" | "f8" => 8,
        _ => return Err(wrong(start, "an array of another type", "save it as float32: a.astype('f4')")),
    };
    let data = &bytes[end..];
    let needed = rows.checked_mul(columns).and_then(|count| count.checked_mul(size));
    if needed.is_none_or(|needed| needed > data.len()) {
        return Err(wrong(end, "fewer numbers than the array's shape says", "it was cut off: save it again"));
    }
    let value = |index: usize| {
        let mut raw = [0; 8];
        raw[..size].copy_from_slice(&data[index * size..(index + 1) * size]);
        if big {
            raw[..size].reverse();
        }
        let four = [raw[0], raw[1], raw[2], raw[3]];
        match code {
            "i1" => f64::from(raw[0] as i8),
            "u1" => f64::from(raw[0]),
            "i2" => f64::from(i16::from_le_bytes([raw[0], raw[1]])),
            "u2" => f64::from(u16::from_le_bytes([raw[0], raw[1]])),
            "i4" => f64::from(i32::from_le_bytes(four)),
            "u4" => f64::from(u32::from_le_bytes(four)),
            "f4" => f64::from(f32::from_le_bytes(four)),
            "i8" => i64::from_le_bytes(raw) as f64,
            "u8" => u64::from_le_bytes(raw) as f64,
            _ => f64::from_le_bytes(raw),
        }
    };
    let mut values = Vec::with_capacity(rows * columns);
    for row in 0..rows {
        progress.parsed(end + values.len() * size, bytes.len())?;
        for column in 0..columns {
            values.push(value(if is_fortran { column * rows + row } else { row * columns + column }));
        }
    }
    let missing: Vec<bool> = values.iter().map(|value| !value.is_finite()).collect();
    scene(&Grid { rows, columns, origin: [0.0; 2], cell: [1.0; 2] }, &values, &missing, frame, progress)
}

fn scene(
    grid: &Grid,
    values: &[f64],
    missing: &[bool],
    frame: &Frame,
    progress: &Progress,
) -> Result<Scene, LoadError> {
    let &Grid { rows, columns, origin, cell } = grid;
    if values.len() as u64 > u64::from(u32::MAX) {
        // Refused before triangles are made of them.
        return Err(
            slimkd::TriangleMesh::new(Vec::new(), vec![[0; 3]]).map_or_else(Into::into, |_| LoadError::Empty)
        );
    }
    let mut vertices = Vec::with_capacity(values.len());
    for row in 0..rows {
        let y = frame.axis(1, origin[1] + (rows - 1 - row) as f64 * cell[1]);
        for column in 0..columns {
            let at = row * columns + column;
            let z = if missing[at] { 0.0 } else { frame.axis(2, values[at]) };
            vertices.push([frame.axis(0, origin[0] + column as f64 * cell[0]), y, z]);
        }
    }
    let mut triangles = Vec::new();
    for row in 0..rows - 1 {
        progress.reach(0.0)?;
        for column in 0..columns - 1 {
            let north = row * columns + column;
            let square = [north, north + 1, north + columns, north + columns + 1];
            if square.iter().all(|&at| !missing[at]) {
                let [nw, ne, sw, se] = square.map(|at| at as u32);
                triangles.extend([[nw, sw, se], [nw, se, ne]]);
            }
        }
    }
    let mut warnings = Vec::new();
    let far = (0..2).map(|axis| {
        let count = if axis == 0 { columns } else { rows };
        let end = origin[axis] + count as f64 * cell[axis];
        let [first, last] = [origin[axis], end].map(|x| frame.near(axis, x).abs());
        (first.max(last) as f32, cell[axis])
    });
    for (far, cell) in far {
        let step = f64::from(far.next_up() - far);
        if step > cell / 1024.0 && warnings.is_empty() {
            let what = format!(
                "coordinates of {far} have steps of {step} in f32, beside cells of {cell}: give it an origin"
            );
            warnings.push(Warning::new(WarningKind::Precision, what));
        }
    }
    let mesh = Arc::new(TriangleMesh::new(vertices, triangles)?);
    Ok(Scene { mesh, up: Some(UpAxis::Z), warnings, ..Default::default() })
}
