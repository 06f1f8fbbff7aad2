//! The experiments of Choi, Chang & Ihm (*Computer Graphics Forum* 32(7), 2013) on any scene, beside our own presets and the
//! published figures.
//!
//! One direction, no way back: [`measure`] fills [`data::Raw`] unit by unit and keeps every unit on disk, so that an
//! interrupted run goes on where it stopped; [`tables`] and [`plots`] read nothing but that JSON; [`page`] lays them out.
//! Every number of a table carries the expression over the JSON that it came from ([`number::Number`]).

pub mod data;
mod error;
pub mod machine;
pub mod measure;
pub mod median;
pub mod number;
pub mod output;
pub mod page;
pub mod plots;
mod progress;
mod published;
pub mod tables;

pub use error::ReportError;
pub use progress::Progress;
