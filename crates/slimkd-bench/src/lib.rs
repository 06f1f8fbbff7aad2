//! Measures slimkd beside other ray tracing libraries: the same rays in the same process, hits compared before any rate
//! is reported, variants alternated in rounds. How to run it and how to read it: `docs/benchmarking.md`.

pub mod agree;
pub mod alloc;
pub mod args;
pub mod built;
pub mod measure;
pub mod peers;
pub mod report;
pub mod rng;
pub mod run;
pub mod scene;
pub mod soup;
pub mod truth;
pub mod variant;
pub mod vector;
pub mod view;
pub mod workload;

pub use slimkd_report::{machine, median};
