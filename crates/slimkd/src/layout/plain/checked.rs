//! Reads of a plain tree that nobody has proved.

use super::layout::Node;
use super::{Packed, view::Leaf};
use crate::layout::Planes;
use crate::layout::checked::{CheckedMesh, Guard, bytes_at};
use crate::layout::nodes::LeafMode;
use crate::layout::nodes::{Address, Ids, Inner, Nodes, PIECE, Step};

/// The sections' bytes.
#[derive(Clone, Copy)]
pub(crate) struct CheckedPlain<'a> {
    pub(crate) nodes: &'a [u8],
    pub(crate) indices_4byte: &'a [u8],
    pub(crate) indices_2byte: &'a [u8],
    pub(crate) mesh: CheckedMesh<'a>,
    pub(crate) guard: &'a Guard,
}

impl CheckedPlain<'_> {
    fn packed(self, index: u32) -> Option<Packed> {
        bytes_at(self.nodes, index as usize * 8).map(|bytes| Packed(u64::from_le_bytes(bytes)))
    }

    fn step(self, address: u32) -> Option<Step<Leaf>> {
        self.guard.node()?;
        let node = self.packed(address)?;
        match node.decode().ok()? {
            // Children stand behind their parent; so no walk comes back.
            Node::Inner { axis, split, children, t_reference } if children > address => {
                let t_reference = match t_reference {
                    true => Some(self.packed(children + 2)?.triangle()),
                    false => None,
                };
                // SAFETY: this view checks every address.
                Some(Step::Inner(unsafe { Inner::new(axis, split, children, 1, t_reference) }))
            }
            Node::Inner { .. } => None,
            Node::Leaf4 { count, .. } | Node::Leaf2 { count, .. } => {
                self.guard.references(count)?;
                Some(Step::Leaf(Leaf::new(node)))
            }
        }
    }

    fn id(self, leaf: &Leaf, at: usize) -> Option<u32> {
        if leaf.mode == LeafMode::FourByte {
            return bytes_at(self.indices_4byte, 4 * at).map(u32::from_le_bytes);
        }
        bytes_at(self.indices_2byte, 2 * at).map(|id| leaf.upper | u32::from(u16::from_le_bytes(id)))
    }
}

// SAFETY: every access is checked, whatever the address or the id.
unsafe impl Nodes for CheckedPlain<'_> {
    type Leaf = Leaf;

    unsafe fn node(self, address: Address) -> Step<Leaf> {
        self.step(address.get()).or_else(|| self.guard.breaks()).unwrap_or(Step::Leaf(Leaf::EMPTY))
    }

    unsafe fn take<'b>(self, leaf: &mut Leaf, buffer: &'b mut Ids) -> &'b [u32]
    where
        Self: 'b,
    {
        let count = PIECE.min(leaf.left as usize);
        for k in 0..count {
            let Some(id) = self.id(leaf, leaf.first as usize + k).or_else(|| self.guard.breaks()) else {
                *leaf = Leaf::EMPTY;
                return &[];
            };
            buffer.0[k].write(id);
        }
        leaf.first += count as u32;
        leaf.left -= count as u32;
        // SAFETY: `count` of them were written above.
        unsafe { buffer.written(count) }
    }

    fn mode(leaf: Leaf) -> LeafMode {
        leaf.mode
    }

    unsafe fn corners(self, triangle: u32) -> [[f32; 3]; 3] {
        self.mesh.corners(self.guard, triangle)
    }

    fn planes(self) -> Planes {
        Planes::WORLD
    }

    fn too_deep(self) {
        self.guard.breaks::<()>();
    }
}
