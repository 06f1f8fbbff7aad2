//! Where glTF's bytes are: GLB chunks, `data:` URIs, files beside the scene, views that are compressed.

use super::{
    json::{BufferView, Root},
    meshopt,
    reader::{DAMAGED, Reader},
};
use crate::load::{Format, LoadError, Place, error::quoted, source::Folder};
use base64::{Engine, alphabet, engine::DecodePaddingMode, engine::general_purpose};
use std::{borrow::Cow, collections::HashMap};

/// The chunk types "JSON" and "BIN\0".
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The JSON text of a file, and its binary chunk if it is a GLB with one (glTF 2.0, section 4).
pub(super) fn split(format: Format, bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
    let invalid = |at: usize, what: String, fix| LoadError::Invalid {
        format,
        place: Place::Byte(at as u64),
        what,
        fix,
    };
    const CUT_OFF: &str = "the file was cut off: write or download it again";
    if !bytes.starts_with(b"glTF") {
        return match format {
            Format::Glb => {
                let what = format!("it starts with {}, not \"glTF\"", quoted(&bytes[..bytes.len().min(8)]));
                Err(invalid(0, what, "give the file the extension of what it is"))
            }
            _ => Ok((text(bytes), None)),
        };
    }
    let word = |at: usize| {
        let raw = bytes.get(at..)?.first_chunk()?;
        Some(u32::from_le_bytes(*raw))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(invalid(4, "the header is incomplete".into(), CUT_OFF));
    };
    if version != 2 {
        let what = format!("GLB version {version}");
        let fix = "convert it to version 2";
        return Err(LoadError::Unsupported { format, place: Place::Byte(4), what, fix });
    }
    // Some writers forget the padding, or count it where it is not: the chunks' own lengths decide.
    if length as usize > bytes.len() + 3 {
        let what = format!("{length} bytes are announced, but there are {}", bytes.len());
        return Err(invalid(8, what, CUT_OFF));
    }
    // The chunk's type and where its content ends, when it begins at `at`.
    let chunk = |at: usize| Some((word(at + 4)?, at.checked_add(8)?.checked_add(word(at)? as usize)?));
    let content = |at: usize, end: usize| {
        bytes.get(at + 8..end).ok_or_else(|| {
            let size = end - at - 8;
            invalid(at, format!("a chunk of {size} bytes is longer than the rest of the file"), CUT_OFF)
        })
    };
    let fix = "the file is damaged: write or download it again";
    let Some((JSON, end)) = chunk(12) else {
        return Err(invalid(12, "the first chunk is no JSON".into(), fix));
    };
    let json = text(content(12, end)?);
    // Chunks start at multiples of four bytes and have such lengths. Writers that do not pad leave out the one, or both.
    let mut end = end;
    loop {
        let starts = [end, end.next_multiple_of(4)];
        let bin = starts.into_iter().find_map(|at| Some((at, chunk(at).filter(|next| next.0 == BIN)?.1)));
        if let Some((at, end)) = bin {
            return Ok((json, Some(content(at, end)?)));
        }
        // Chunks of other types are to be passed over.
        match chunk(end.next_multiple_of(4)) {
            Some((_, next)) => end = next,
            None => return Ok((json, None)),
        }
    }
}

/// The text without what is no JSON: a byte-order mark, and zeros as padding.
fn text(json: &[u8]) -> &[u8] {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &json[..end]
}

/// The content of all buffers.
pub(super) struct Buffers<'a> {
    /// Each source once, however many buffers name it; or why it is not there.
    sources: Vec<Result<Cow<'a, [u8]>, String>>,
    /// The source of each buffer.
    buffers: Vec<usize>,
}

impl<'a> Buffers<'a> {
    /// Reads them all, but for those that only readers without meshopt need. A missing one matters once it is used.
    pub(super) fn load(root: &'a Root, bin: Option<&'a [u8]>, folder: Folder<'_>) -> Self {
        let mut known: HashMap<&str, usize> = HashMap::new();
        let mut this = Self { sources: Vec::new(), buffers: Vec::new() };
        for (k, buffer) in root.buffers.iter().enumerate() {
            let uri = buffer.uri.as_deref().filter(|_| !buffer.extensions.is_fallback());
            if let Some(&source) = uri.and_then(|uri| known.get(uri)) {
                this.buffers.push(source);
                continue;
            }
            let source = match uri {
                Some(uri) => resource(uri, folder)
                    .map(Cow::Owned)
                    .map_err(|why| format!("{} cannot be read: {why}", quoted(uri.as_bytes()))),
                // Only the first buffer can be the binary chunk.
                None if k > 0 => Err("it has no uri".to_owned()),
                None => {
                    bin.map(Cow::Borrowed).ok_or_else(|| "it has no uri, and there is no binary chunk".into())
                }
            };
            this.buffers.push(this.sources.len());
            if let Some(uri) = uri {
                known.insert(uri, this.sources.len());
            }
            this.sources.push(source);
        }
        this
    }

    /// Bytes of all sources.
    pub(super) fn total(&self) -> u64 {
        self.sources.iter().flatten().map(|source| source.len() as u64).sum()
    }
}

impl Reader<'_> {
    /// A buffer's bytes from `start` on, `length` of them.
    fn bytes(&self, place: Place, buffer: usize, start: usize, length: usize) -> Result<&[u8], LoadError> {
        let at = Place::Entry("buffers", buffer);
        let (Some(announced), Some(&source)) =
            (self.root.buffers.get(buffer), self.buffers.buffers.get(buffer))
        else {
            return Err(self.invalid(at, "there is none", DAMAGED));
        };
        let content = self.buffers.sources[source].as_ref().map_err(|why| {
            self.invalid(at, why.clone(), "put the file beside the scene file, or export the scene again")
        })?;
        let (announced, there) = (announced.byte_length.0, content.len());
        if announced > there {
            let what = format!("{announced} bytes are announced, but there are {there}");
            return Err(self.invalid(at, what, "the buffer was cut off: export or download it again"));
        }
        let range =
            start.checked_add(length).filter(|&end| end <= announced).and_then(|end| content.get(start..end));
        range.ok_or_else(|| {
            self.invalid(place, format!("{length} bytes from {start} on are not in buffer {buffer}"), DAMAGED)
        })
    }

    /// The bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), LoadError> {
        let place = Place::Entry("bufferViews", index);
        let (Some(view), Some(decoded)) = (self.root.buffer_views.get(index), self.decoded_views.get(index))
        else {
            return Err(self.invalid(place, "there is none", DAMAGED));
        };
        let stride = view.byte_stride.map(|stride| stride.0);
        if view.extensions.meshopt().is_none() {
            let bytes = self.bytes(place, view.buffer.0, view.byte_offset.0, view.byte_length.0)?;
            return Ok((bytes, stride));
        }
        if let Some(bytes) = decoded.get() {
            return Ok((bytes, stride));
        }
        let bytes = self.decode(place, view)?;
        Ok((decoded.get_or_init(|| bytes), stride))
    }

    /// The content of a view that meshopt compressed.
    fn decode(&self, place: Place, view: &BufferView) -> Result<Vec<u8>, LoadError> {
        let Some(packed) = view.extensions.meshopt() else { return Ok(Vec::new()) };
        let (count, stride) = (packed.count.0, packed.byte_stride.0);
        let bytes = self.bytes(place, packed.buffer.0, packed.byte_offset.0, packed.byte_length.0)?;
        self.spend_decoding((count as u64).saturating_mul(stride as u64))?;
        let mode = meshopt::Mode::of(&packed.mode, packed.filter.as_deref());
        mode.and_then(|mode| mode.decode(bytes, count, stride)).map_err(|what| {
            let fix = "the file is damaged, or made by a later meshopt: export it again, uncompressed";
            self.invalid(place, format!("meshopt: {what}"), fix)
        })
    }
}

/// The bytes that a URI stands for.
pub(super) fn resource(uri: &str, folder: Folder<'_>) -> Result<Vec<u8>, String> {
    let scheme = uri.get(..5).filter(|scheme| scheme.eq_ignore_ascii_case("data:"));
    let Some(scheme) = scheme else {
        if uri.contains("://") {
            return Err("only files and data: URIs are read".into());
        }
        // Names that were not encoded as the format asks may have a `%` of their own.
        let decoded = percent_decoded(uri);
        let decoded = std::str::from_utf8(&decoded).ok().filter(|name| folder.has(name) || !folder.has(uri));
        return folder.read(decoded.unwrap_or(uri));
    };
    let (kind, payload) = uri[scheme.len()..].split_once(',').ok_or("a data: URI without a comma")?;
    let payload = percent_decoded(payload);
    if !kind.to_ascii_lowercase().ends_with(";base64") {
        return Ok(payload.into_owned());
    }
    let payload = match payload.iter().any(u8::is_ascii_whitespace) {
        true => payload.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect(),
        false => payload,
    };
    let config = general_purpose::GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    let decoder = general_purpose::GeneralPurpose::new(&alphabet::STANDARD, config);
    decoder.decode(payload).map_err(|error| error.to_string())
}

/// Undoes `%20` and the like; what is no such code stays.
fn percent_decoded(uri: &str) -> Cow<'_, [u8]> {
    if !uri.contains('%') {
        return Cow::Borrowed(uri.as_bytes());
    }
    let digit = |byte: Option<&u8>| byte.and_then(|&byte| char::from(byte).to_digit(16));
    let mut rest = uri.as_bytes();
    let mut out = Vec::with_capacity(rest.len());
    while let [first, tail @ ..] = rest {
        match (first, digit(tail.first()), digit(tail.get(1))) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                rest = &tail[2..];
            }
            _ => {
                out.push(*first);
                rest = tail;
            }
        }
    }
    Cow::Owned(out)
}
