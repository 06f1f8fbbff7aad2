//! One file a command.

pub(crate) mod bench;
pub(crate) mod build;
pub(crate) mod completions;
pub(crate) mod convert;
pub(crate) mod devices;
pub(crate) mod inspect;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod scene;
pub(crate) mod trace;
