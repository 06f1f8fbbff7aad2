//! Reads of a dense tree that nobody has proved.

use super::leaf::{Leaf, LeafCode};
use super::{PADDING, word};
use crate::geometry::Aabb;
use crate::layout::Planes;
use crate::layout::checked::{CheckedMesh, Guard, bytes_at};
use crate::layout::nodes::LeafMode;
use crate::layout::nodes::{Address, Ids, Inner, MOST_IDS, Nodes, Step};
use crate::layout::runs::read_code;

/// The section's bytes, and what follows from the mesh.
#[derive(Clone, Copy)]
pub(crate) struct CheckedDense<'a> {
    bytes: &'a [u8],
    code: LeafCode,
    planes: &'a Planes,
    mesh: CheckedMesh<'a>,
    guard: &'a Guard,
}

impl<'a> CheckedDense<'a> {
    /// `planes` are [`CheckedDense::grid`]'s.
    pub(crate) fn new(
        bytes: &'a [u8],
        triangles: usize,
        planes: &'a Planes,
        mesh: CheckedMesh<'a>,
        guard: &'a Guard,
    ) -> Self {
        Self { bytes, code: LeafCode::new(triangles), planes, mesh, guard }
    }

    /// The planes over these bounds; `None` where no such tree has this layout.
    pub(crate) fn grid(bytes: usize, bounds: &Aabb, triangles: usize) -> Option<Planes> {
        super::fits(bytes, triangles).then(|| word::grid(bounds))?
    }

    /// The 8 bytes at a node or a code.
    fn long(self, address: u32) -> Option<u64> {
        bytes_at(self.bytes, address as usize).map(u64::from_le_bytes)
    }

    fn step(self, address: u32) -> Option<Step<Leaf>> {
        self.guard.node()?;
        let word = self.long(address)? as u32;
        let axis = word & word::LEAF;
        if axis == word::LEAF {
            // Where that count would stand outside, it is one that no leaf can have.
            let leaf =
                self.code.leaf(address, word, |at| self.long(at).map_or(u32::MAX, |count| count as u32));
            self.guard.references(leaf.left)?;
            return Some(Step::Leaf(leaf));
        }
        let near = word::distance(word);
        let (left, distance) =
            if near != 0 { (address + 4, near) } else { (address + 8, self.long(address + 4)? as u32) };
        let right = address.checked_add(distance)?;
        if right <= left || right as usize + PADDING > self.bytes.len() {
            return None;
        }
        let split = word::split(word);
        // SAFETY: this view checks every address.
        Some(Step::Inner(unsafe { Inner::new(axis as usize, split, left, right - left, None) }))
    }

    /// Writes a leaf's next run; how many.
    fn run(self, leaf: &mut Leaf, to: &mut [std::mem::MaybeUninit<u32>]) -> Option<usize> {
        let count = leaf.run as usize;
        for (k, id) in to[..count].iter_mut().enumerate() {
            id.write(leaf.next.checked_add(k as u32)?);
        }
        leaf.left = leaf.left.checked_sub(leaf.run)?;
        if leaf.left > 0 {
            let (gap, run, size) = read_code(self.long(leaf.codes)?);
            leaf.next = leaf.next.checked_add(leaf.run)?.checked_add(gap)?;
            (leaf.run, leaf.codes) = (run, leaf.codes.checked_add(size)?);
        }
        Some(count)
    }
}

// SAFETY: every access is checked, whatever the address or the id.
unsafe impl Nodes for CheckedDense<'_> {
    type Leaf = Leaf;

    unsafe fn node(self, address: Address) -> Step<Leaf> {
        let empty = Leaf { codes: 0, left: 0, next: 0, run: 0 };
        self.step(address.get()).or_else(|| self.guard.breaks()).unwrap_or(Step::Leaf(empty))
    }

    unsafe fn take<'b>(self, leaf: &mut Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b,
    {
        let mut filled = 0;
        while leaf.left > 0 && filled < MOST_IDS {
            match self.run(leaf, &mut buffer.0[filled..]).or_else(|| self.guard.breaks()) {
                Some(count) => filled += count,
                None => leaf.left = 0,
            }
        }
        // SAFETY: all before `filled` were written.
        unsafe { buffer.written(filled) }
    }

    fn mode(_: Leaf) -> LeafMode {
        LeafMode::Coded
    }

    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        self.mesh.corners(self.guard, triangle)
    }

    fn planes(self) -> Planes {
        *self.planes
    }

    fn too_deep(self) {
        self.guard.breaks::<()>();
    }
}
