//! What the checked views of both layouts share: reads of bytes that nobody has proved, and the end of every query.
//!
//! A tree reaches each node and each reference once, so a query that meets more than there are goes in a circle. It then
//! sees empty leaves only, and its answer is an error.

use std::cell::Cell;

/// What one query may still read, and whether anything it read cannot be.
#[derive(Debug)]
pub(crate) struct Guard {
    nodes: Cell<u64>,
    references: Cell<u64>,
    broken: Cell<bool>,
}

impl Guard {
    /// For trees of at most that many nodes, and references in leaves.
    pub(crate) fn new(nodes: u64, references: u64) -> Self {
        Self { nodes: Cell::new(nodes), references: Cell::new(references), broken: Cell::new(false) }
    }

    /// Marks this query as having met an invalid tree; it sees only empty leaves from then on.
    pub(crate) fn breaks<T>(&self) -> Option<T> {
        self.broken.set(true);
        None
    }

    pub(crate) fn is_broken(&self) -> bool {
        self.broken.get()
    }

    /// Counts a node; `None` when there are no more.
    pub(crate) fn node(&self) -> Option<()> {
        self.spend(&self.nodes, 1)
    }

    /// Counts references of leaves.
    pub(crate) fn references(&self, count: u32) -> Option<()> {
        self.spend(&self.references, count.into())
    }

    fn spend(&self, of: &Cell<u64>, count: u64) -> Option<()> {
        match of.get().checked_sub(count) {
            Some(left) if !self.is_broken() => {
                of.set(left);
                Some(())
            }
            _ => self.breaks(),
        }
    }
}

/// `N` bytes from `at`, if they are inside.
pub(crate) fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}

/// The mesh as its sections' bytes.
#[derive(Clone, Copy)]
pub(crate) struct CheckedMesh<'a> {
    pub(crate) vertices: &'a [u8],
    pub(crate) triangles: &'a [u8],
}

impl CheckedMesh<'_> {
    /// Where a triangle or a vertex is missing, corners that nothing hits.
    pub(crate) fn corners(self, guard: &Guard, triangle: u32) -> [[f32; 3]; 3] {
        self.find(triangle).or_else(|| guard.breaks()).unwrap_or([[f32::NAN; 3]; 3])
    }

    /// Vertex indices of a triangle.
    pub(crate) fn indices(self, triangle: u32) -> Option<[u32; 3]> {
        let bytes: [u8; 12] = bytes_at(self.triangles, triangle as usize * 12)?;
        Some(std::array::from_fn(|k| u32::from_le_bytes(bytes.as_chunks::<4>().0[k])))
    }

    /// The corners of a triangle, if it and its vertices are there.
    pub(crate) fn find(self, triangle: u32) -> Option<[[f32; 3]; 3]> {
        let mut corners = [[0.0; 3]; 3];
        for (corner, vertex) in corners.iter_mut().zip(self.indices(triangle)?) {
            let place: [u8; 12] = bytes_at(self.vertices, vertex as usize * 12)?;
            *corner = std::array::from_fn(|k| f32::from_le_bytes(place.as_chunks::<4>().0[k]));
        }
        Some(corners)
    }
}
