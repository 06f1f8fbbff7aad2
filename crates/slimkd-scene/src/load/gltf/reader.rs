//! The file while it is read.

use super::{container::Buffers, json::Root};
use crate::load::{Format, LoadError, Place, source::growth_limit};
use std::cell::{Cell, OnceCell};

/// What helps against most broken files.
pub(super) const DAMAGED: &str = "the file is damaged: export or download it again";

/// The JSON, and the bytes that it speaks of.
pub(super) struct Reader<'a> {
    pub(super) format: Format,
    pub(super) root: &'a Root,
    pub(super) buffers: Buffers<'a>,
    /// Content of each buffer view that is compressed, once it was needed.
    pub(super) decoded_views: Vec<OnceCell<Vec<u8>>>,
    /// Bytes of the file and what it names.
    pub(super) input: u64,
    /// Bytes that decoding may still take.
    left: Cell<u64>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(format: Format, root: &'a Root, buffers: Buffers<'a>, file: usize) -> Self {
        let input = file as u64 + buffers.total();
        let decoded_views = root.buffer_views.iter().map(|_| OnceCell::new()).collect();
        Self { format, root, buffers, decoded_views, input, left: Cell::new(growth_limit(input)) }
    }

    pub(super) fn invalid(&self, place: Place, what: impl Into<String>, fix: &'static str) -> LoadError {
        LoadError::Invalid { format: self.format, place, what: what.into(), fix }
    }

    /// Bytes that decoding may still take.
    pub(super) fn decoding_budget(&self) -> u64 {
        self.left.get()
    }

    /// Takes from that budget what is about to be decoded.
    pub(super) fn spend_decoding(&self, bytes: u64) -> Result<(), LoadError> {
        self.left.set(self.left.get().checked_sub(bytes).ok_or(LoadError::OutOfProportion {
            what: "its compressed parts",
            limit: growth_limit(self.input),
            input: self.input,
            fix: "export it uncompressed",
        })?);
        Ok(())
    }
}
