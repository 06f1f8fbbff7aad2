//! The report's tests. One program, since each costs a link of everything below it: `cargo test -p slimkd-lab --test suite NAME::`
//! runs the tests of one file.

mod browser;
mod common;
mod layers;
mod traceable;
