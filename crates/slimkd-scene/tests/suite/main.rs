//! The loaders' and the built-in scenes' tests. One program, since each costs a link of everything below it:
//! `cargo test -p slimkd-scene --test suite NAME::` runs the tests of one file.

mod cityjson;
mod gltf;
mod gltf_as_found;
mod mitsuba;
mod obj;
mod odd_files;
mod off_and_grids;
mod oracle;
mod origin;
mod parity_builtin;
mod parity_real;
mod ply;
mod real_scenes;
mod reported;
mod reported_too;
mod robust;
mod stl;
mod walls;
