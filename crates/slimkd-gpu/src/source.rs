//! The kernels' text: fixed parts, and what depends on the tree and on how many bindings it takes.

use crate::image::PARAMS_WGSL;
use std::fmt::Write;

const EXACT: &str = include_str!("shaders/exact.wgsl");
const PLAIN: &str = include_str!("shaders/plain.wgsl");
const DENSE: &str = include_str!("shaders/dense.wgsl");
const WALK: &str = include_str!("shaders/walk.wgsl");
pub(crate) const TRACE: &str = include_str!("shaders/trace.wgsl");
/// The picture's kernel, after its constants.
#[cfg(feature = "render")]
pub(crate) const FRAME: [&str; 3] = [
    include_str!("shaders/surface.wgsl"),
    include_str!("shaders/shade.wgsl"),
    include_str!("shaders/frame.wgsl"),
];

/// What the text depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) dense: bool,
    pub(crate) shards: u32,
    /// Words of each shard but the last, a power of two.
    pub(crate) shard_words: u32,
    /// Entries of the short stack.
    pub(crate) ring: u32,
    /// Depth of the tree: a bit of the trail a level.
    pub(crate) depth: u32,
}

/// The whole module; `main` has the entry points.
pub(crate) fn module(shape: Shape, main: &[&str]) -> String {
    let nodes = if shape.dense { DENSE } else { PLAIN };
    let mut text = format!("{PARAMS_WGSL}{}", memory(shape.shards, shape.shard_words));
    let _ = writeln!(text, "const RING = {}u;\nconst TRAIL = {}u;", shape.ring, shape.depth / 32 + 1);
    for part in [EXACT, nodes, WALK].iter().chain(main) {
        text.push_str(part);
    }
    text
}

/// `word`, which reads the image wherever its shard is bound.
fn memory(shards: u32, shard_words: u32) -> String {
    debug_assert!(shard_words.is_power_of_two());
    let mut text = String::new();
    for k in 0..shards {
        let _ = writeln!(text, "@group(0) @binding({}) var<storage, read> shard{k}: array<u32>;", k + 1);
    }
    if shards == 1 {
        text.push_str("fn word(at: u32) -> u32 { return shard0[at]; }\n");
        return text;
    }
    let (shift, mask) = (shard_words.trailing_zeros(), shard_words - 1);
    let _ =
        writeln!(text, "fn word(at: u32) -> u32 {{\n    let i = at & {mask}u;\n    switch at >> {shift}u {{");
    for k in 1..shards {
        let _ = writeln!(text, "        case {k}u: {{ return shard{k}[i]; }}");
    }
    text.push_str("        default: { return shard0[i]; }\n    }\n}\n");
    text
}
