//! What a tree costs in memory, exact to the byte.

/// Bytes of a tree by part. Everything but `mesh` is what the acceleration structure adds to the bare indexed mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MemoryReport {
    /// Inner and leaf nodes, without T-reference slots.
    pub nodes: u64,
    /// T-reference slots.
    pub t_references: u64,
    /// Triangle indices of the leaves.
    pub indices: u64,
    /// The way back from internal to public triangle ids.
    pub id_map: u64,
    /// Copies of triangle data inside the tree.
    pub triangle_copies: u64,
    /// Anything else.
    pub other: u64,
    /// The indexed mesh: 12 B a vertex, 12 B a triangle.
    pub mesh: u64,
}

impl MemoryReport {
    /// Everything that the structure adds to the mesh.
    pub fn tree(&self) -> u64 {
        self.nodes + self.t_references + self.indices + self.id_map + self.triangle_copies + self.other
    }

    /// All that must stay in memory to trace and to report public ids.
    pub fn resident(&self) -> u64 {
        self.tree() + self.mesh
    }
}
