//! Buffer views that meshoptimizer compressed: `EXT_meshopt_compression` and its successor `KHR_meshopt_compression`.
//!
//! Written from the extensions' README files (KhronosGroup/glTF, `extensions/2.0`), appendix A for the streams and appendix
//! B for the filters. Deviations: 1. both extensions read both versions of the attributes' stream, as the reference does;
//! 2. vectors that a filter leaves unspecified become some value instead of an error;
//! 3. the rotation of channel mode 2 is the one of the writer, so that the reader turns back, as the reference does.

mod attributes;
mod filters;
mod indices;
#[cfg(test)]
mod tests;

use filters::Filter;

/// How a view is compressed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mode {
    Attributes(Filter),
    Triangles,
    Indices,
}

impl Mode {
    /// The mode of these names.
    pub(super) fn of(mode: &str, filter: Option<&str>) -> Result<Self, String> {
        let filter = match filter.unwrap_or("NONE") {
            "NONE" => Filter::None,
            "OCTAHEDRAL" => Filter::Octahedral,
            "QUATERNION" => Filter::Quaternion,
            "EXPONENTIAL" => Filter::Exponential,
            "COLOR" => Filter::Colour,
            other => return Err(format!("filter {} is not known", quoted(other))),
        };
        match mode {
            "ATTRIBUTES" => Ok(Self::Attributes(filter)),
            "TRIANGLES" => Ok(Self::Triangles),
            "INDICES" => Ok(Self::Indices),
            other => Err(format!("mode {} is not known", quoted(other))),
        }
    }

    /// `count` elements of `stride` bytes out of `data`. The caller knows that there is room for them.
    pub(super) fn decode(self, data: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
        let fits = match self {
            Self::Attributes(filter) => {
                stride.is_multiple_of(4) && (4..=256).contains(&stride) && filter.fits(stride)
            }
            Self::Triangles => (stride == 2 || stride == 4) && count.is_multiple_of(3),
            Self::Indices => stride == 2 || stride == 4,
        };
        if !fits {
            return Err(format!("{count} elements of {stride} bytes do not go with its mode"));
        }
        let length = count.checked_mul(stride).ok_or("too many elements")?;
        let mut out = Vec::new();
        out.try_reserve_exact(length).map_err(|error| error.to_string())?;
        match self {
            Self::Attributes(filter) => {
                out.resize(length, 0);
                attributes::decode(data, &mut out, stride)?;
                filter.apply(&mut out, stride);
            }
            Self::Triangles => indices::triangles(data, count, indices::Sink { out: &mut out, stride })?,
            Self::Indices => indices::sequence(data, count, indices::Sink { out: &mut out, stride })?,
        }
        Ok(out)
    }
}

const CUT_OFF: &str = "the stream ends too early";
const TOO_LONG: &str = "there are bytes behind the stream's end";

fn quoted(name: &str) -> String {
    crate::load::error::quoted(name.as_bytes())
}

/// Takes `length` bytes from the front of `data`.
fn take<'a>(data: &mut &'a [u8], length: usize) -> Result<&'a [u8], String> {
    let (taken, rest) = data.split_at_checked(length).ok_or(CUT_OFF)?;
    *data = rest;
    Ok(taken)
}
