//! Measures slimkd beside other ray tracing libraries: the same rays in the same process, hits compared before any rate
//! is reported, variants alternated in rounds. How to run it and how to read it: `docs/benchmarking.md`.

pub mod agree;
pub mod args;
pub mod built;
pub mod measure;
pub mod peers;
pub mod report;
pub mod run;
pub mod scene;
pub mod truth;
pub mod variant;
