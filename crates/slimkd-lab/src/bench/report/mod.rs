//! The outcome of a run: as data with every raw figure, and as a table to read.

mod data;
mod table;

pub use data::{
    Build, ByteReport, ContenderReport, Measurement, Report, SCHEMA, SceneReport, Settings, Skipped,
    WorkloadAgreement, WorkloadReport, points,
};
pub use table::table;
