//! The report: tables and plots of the measurements' JSON, laid out on a page.
//!
//! Every number of a table carries the expression over the JSON that it came from ([`crate::basics::number::Number`]).

pub mod output;
pub mod page;
pub mod plots;
pub mod tables;
