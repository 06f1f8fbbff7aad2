//! The GPU's tests. One program, since each costs a link of everything below it: `cargo test -p slimkd-gpu --test suite NAME::`
//! runs the tests of one file.

mod common;
mod frames;
mod gpu;
mod twin;
