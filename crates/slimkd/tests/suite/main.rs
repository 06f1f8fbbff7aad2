//! What the library promises, one file a promise. One program: linking is most of what a test costs to build.

#[path = "../common/mod.rs"]
mod common;
mod exact;
#[path = "../common/skd.rs"]
mod skd;

mod budget;
mod coherent;
mod complete;
mod file;
mod inline_chain;
mod interop;
mod invariants;
mod layers;
mod open;
mod oracle;
mod parity;
mod queries;
mod scales;
mod soups;
mod streams;
mod watertight;
