//! What the library promises, one file a promise. One program: linking is most of what a test costs to build.

mod cells;
#[path = "../common/mod.rs"]
mod common;
mod exact;
#[path = "../common/skd.rs"]
mod skd;

mod api;
mod budget;
mod coherent;
mod complete;
mod crossings;
mod file;
mod inline_chain;
mod inside;
mod interop;
mod invariants;
mod layers;
mod open;
mod oracle;
mod parity;
mod queries;
mod scales;
mod segments;
mod soups;
mod streams;
mod watertight;
mod world;
