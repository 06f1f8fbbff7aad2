//! Measuring: the rays that rates are measured with, the experiments of Choi, Chang & Ihm (*Computer Graphics Forum* 32(7),
//! 2013) on any scene, and slimkd beside other ray tracing libraries.
//!
//! Each room knows those above it alone:
//!
//! - [`basics`]: medians, numbers that remember where they come from, the machine, progress, vectors;
//! - [`schema`]: the JSON of a report, and the published figures;
//! - [`workload`]: the rays, defined once for `slimkd bench` and `slimkd-bench`;
//! - [`measure`]: fills [`schema::Raw`] unit by unit and keeps every unit on disk, so that an interrupted run goes on where it
//!   stopped;
//! - [`report`] (feature `page`, a default): tables, plots and a page, which read nothing but that JSON;
//! - `bench` (feature `peers`): other libraries beside slimkd, and an independent judge of hits.

pub mod basics;
#[cfg(feature = "peers")]
pub mod bench;
pub mod measure;
#[cfg(feature = "page")]
pub mod report;
pub mod schema;
pub mod workload;

pub use basics::{Progress, ReportError};
