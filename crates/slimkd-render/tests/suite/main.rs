//! The renderer's tests. One program, since each costs a link of everything below it: `cargo test -p slimkd-render --test suite NAME::`
//! runs the tests of one file.

mod analytic;
mod common;
mod files;
mod golden;
mod refused;
mod threads;
mod views;
