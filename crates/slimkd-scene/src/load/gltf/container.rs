//! Where glTF's bytes are: GLB chunks, `data:` URIs, files beside the scene.

use super::Reader;
use crate::load::{Format, LoadError, Place, error::quoted, source::Folder};
use base64::{Engine, alphabet, engine::DecodePaddingMode, engine::general_purpose};
use gltf::json::Root;
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
            _ => Ok((bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None)),
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
    if length as usize > bytes.len() {
        let what = format!("{length} bytes are announced, but there are {}", bytes.len());
        return Err(invalid(8, what, CUT_OFF));
    }
    let chunk = |at: usize, kind: u32| -> Result<Option<&[u8]>, LoadError> {
        let (Some(size), Some(found)) = (word(at), word(at + 4)) else { return Ok(None) };
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..size as usize)).ok_or_else(|| {
            invalid(at, format!("a chunk of {size} bytes is longer than the rest of the file"), CUT_OFF)
        })?;
        Ok((found == kind).then_some(data))
    };
    let fix = "the file is damaged: write or download it again";
    let json = chunk(12, JSON)?.ok_or_else(|| invalid(12, "the first chunk is no JSON".into(), fix))?;
    // Chunks start at multiples of four bytes.
    let bin = chunk(20 + json.len().next_multiple_of(4), BIN)?;
    Ok((json, bin))
}

/// The content of all buffers.
pub(super) struct Buffers<'a> {
    /// Each source once, however many buffers name it.
    sources: Vec<Cow<'a, [u8]>>,
    /// Source and length of each buffer.
    buffers: Vec<(usize, usize)>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(
        format: Format,
        root: &'a Root,
        bin: Option<&'a [u8]>,
        folder: Folder<'_>,
    ) -> Result<Self, LoadError> {
        let mut known: HashMap<Option<&str>, usize> = HashMap::new();
        let mut this = Self { sources: Vec::new(), buffers: Vec::new() };
        for (k, buffer) in root.buffers.iter().enumerate() {
            let invalid = |what: String, fix| LoadError::Invalid {
                format,
                place: Place::Entry("buffers", k),
                what,
                fix,
            };
            let uri = buffer.uri.as_deref();
            let source = match known.get(&uri) {
                Some(&source) => source,
                None => {
                    let data = match uri {
                        None => Cow::Borrowed(bin.ok_or_else(|| {
                            invalid("it has no uri, and there is no binary chunk".into(), "export it again")
                        })?),
                        Some(uri) => Cow::Owned(resource(uri, folder).map_err(|why| {
                            let what = format!("{} cannot be read: {why}", quoted(uri.as_bytes()));
                            invalid(what, "put it beside the scene file")
                        })?),
                    };
                    this.sources.push(data);
                    known.insert(uri, this.sources.len() - 1);
                    this.sources.len() - 1
                }
            };
            let (length, there) = (buffer.byte_length.0, this.sources[source].len());
            if length > there as u64 {
                let what = format!("{length} bytes are announced, but there are {there}");
                return Err(invalid(what, "the buffer was cut off: export or download it again"));
            }
            this.buffers.push((source, length as usize));
        }
        Ok(this)
    }

    /// Bytes of all sources.
    pub(super) fn total(&self) -> u64 {
        self.sources.iter().map(|source| source.len() as u64).sum()
    }

    fn get(&self, buffer: usize) -> Option<&[u8]> {
        let &(source, length) = self.buffers.get(buffer)?;
        self.sources[source].get(..length)
    }
}

impl Reader<'_> {
    /// The bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<usize>), LoadError> {
        let place = Place::Entry("bufferViews", index);
        let fix = "the file is damaged: export or download it again";
        let view =
            self.root.buffer_views.get(index).ok_or_else(|| self.invalid(place, "there is none", fix))?;
        let start = view.byte_offset.unwrap_or_default().0;
        let range = || {
            let end = usize::try_from(start.checked_add(view.byte_length.0)?).ok()?;
            self.buffers.get(view.buffer.value())?.get(start as usize..end)
        };
        let bytes = range().ok_or_else(|| {
            let what = format!(
                "{} bytes from {start} on are not in buffer {}",
                view.byte_length.0,
                view.buffer.value()
            );
            self.invalid(place, what, fix)
        })?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// The bytes that a URI stands for.
pub(super) fn resource(uri: &str, folder: Folder<'_>) -> Result<Vec<u8>, String> {
    let Some(data) = uri.strip_prefix("data:") else {
        if uri.contains("://") {
            return Err("only files and data: URIs are read".into());
        }
        return folder.read(&percent_decoded(uri));
    };
    let (_, payload) =
        data.split_once(";base64,").ok_or_else(|| "a data: URI that is not base64".to_owned())?;
    let config = general_purpose::GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true);
    general_purpose::GeneralPurpose::new(&alphabet::STANDARD, config)
        .decode(payload.trim())
        .map_err(|error| error.to_string())
}

/// Undoes `%20` and the like; what is no such code stays.
fn percent_decoded(uri: &str) -> String {
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
    String::from_utf8(out).unwrap_or_else(|_| uri.to_owned())
}
