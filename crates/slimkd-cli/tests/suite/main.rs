//! The command's tests. One program, since each costs a link of everything below it: `cargo test -p slimkd-cli --test suite NAME::`
//! runs the tests of one file.

mod common;
mod devices;
mod disk;
mod failures;
mod hostile;
mod interrupts;
mod render;
mod reports;
mod saved;
mod trace;
mod trace_parity;
mod warnings;
