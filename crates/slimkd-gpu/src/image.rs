//! Tree and mesh as one run of 32-bit words: what is uploaded, and what the twin reads.

use slimkd::{EncodedTree, KdTree, Tracer};

/// What the kernels know beside the words; a uniform buffer. Addresses count words of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
#[allow(missing_docs)] // the names are those of the shaders
pub struct Params {
    pub nodes: u32,
    pub indices_4byte: u32,
    pub indices_2byte: u32,
    pub triangles: u32,
    pub vertices: u32,
    pub triangle_count: u32,
    pub header_bytes: u32,
    pub count_bits: u32,
    pub id_mask: u32,
    pub zero: u32,
    pub spare: [u32; 2],
    pub bounds_min: [f32; 4],
    pub bounds_max: [f32; 4],
    /// Its fourth is the shift.
    pub low: [f32; 4],
    pub scale: [f32; 4],
    pub unscale: [f32; 4],
    pub cell: [f32; 4],
}

/// As `params` in the shaders.
pub(crate) const PARAMS_WGSL: &str = "
struct Params {
    nodes: u32, indices_4byte: u32, indices_2byte: u32, triangles: u32,
    vertices: u32, triangle_count: u32, header_bytes: u32, count_bits: u32,
    id_mask: u32, zero: u32, spare: vec2<u32>,
    bounds_min: vec4<f32>, bounds_max: vec4<f32>,
    low: vec4<f32>, scale: vec4<f32>, unscale: vec4<f32>, cell: vec4<f32>,
}
@group(0) @binding(0) var<uniform> params: Params;
";

/// A tree's bytes and its mesh's, one after the other, each starting at a word.
#[derive(Clone, Debug)]
pub struct Image {
    /// The words, little-endian.
    pub words: Vec<u32>,
    /// Where what stands.
    pub params: Params,
    /// Whether the tree has the dense layout.
    pub dense: bool,
    /// Depth of its deepest leaf.
    pub depth: u32,
}

impl Image {
    /// Copies the bytes of tree and mesh; nothing is changed. `None` beyond 2³² words.
    pub fn new(tree: &KdTree) -> Option<Self> {
        let mesh = tree.mesh();
        let bounds = tree.bounds();
        let hittable = if bounds.is_empty() { 0 } else { mesh.len() as u32 };
        let wide = |v: [f32; 3], w: f32| [v[0], v[1], v[2], w];
        let mut params = Params {
            triangle_count: hittable,
            bounds_min: wide(bounds.min, 0.0),
            bounds_max: wide(bounds.max, 0.0),
            scale: [1.0; 4],
            unscale: [1.0; 4],
            ..Params::default()
        };
        let tree_bytes = tree.memory().resident() as usize;
        let mut words = Vec::with_capacity(tree_bytes / 4 + 16);
        let mut dense = false;
        match tree.encoded() {
            EncodedTree::Plain { nodes, indices_4byte, indices_2byte } => {
                params.nodes = put(&mut words, bytemuck::cast_slice(nodes))?;
                params.indices_4byte = put(&mut words, bytemuck::cast_slice(indices_4byte))?;
                params.indices_2byte = put(&mut words, bytemuck::cast_slice(indices_2byte))?;
            }
            EncodedTree::Dense { bytes, header_bytes, count_bits, id_mask, low, scale, cell } => {
                dense = true;
                params.nodes = put(&mut words, bytes)?;
                params = Params { header_bytes, count_bits, id_mask, ..params };
                params.low = wide(low, 1.0);
                params.scale = wide(scale, 1.0);
                params.unscale = wide(scale.map(f32::recip), 1.0);
                params.cell = wide(cell, 0.0);
            }
            _ => return None,
        }
        params.triangles = put(&mut words, bytemuck::cast_slice(mesh.triangles()))?;
        params.vertices = put(&mut words, bytemuck::cast_slice(mesh.vertices()))?;
        Some(Self { words, params, dense, depth: tree.depth() })
    }

    /// Bytes of the words.
    pub fn bytes(&self) -> u64 {
        4 * self.words.len() as u64
    }
}

/// Appends bytes and returns the word where they start.
pub(crate) fn put(words: &mut Vec<u32>, bytes: &[u8]) -> Option<u32> {
    let start = u32::try_from(words.len()).ok()?;
    let (whole, rest) = bytes.split_at(bytes.len() & !3);
    words.extend(whole.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    if !rest.is_empty() {
        let mut last = [0; 4];
        last[..rest.len()].copy_from_slice(rest);
        words.push(u32::from_le_bytes(last));
    }
    u32::try_from(words.len()).ok().map(|_| start)
}
