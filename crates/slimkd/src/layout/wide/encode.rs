//! From a widened tree to wide nodes.

use super::leaf::{LeafCode, TRIANGLE_LIMIT};
use super::node::WideNode;
use super::{LANES, PADDING, Wide};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{push, room};
use crate::layout::{Planes, dense};
use crate::options::{BuildError, Countable};
use crate::plan::{Child, MOST, Widened};

/// Bytes of leaves that addresses reach.
const BYTE_LIMIT: u64 = (1 << 32) - 1;

/// The grid over a scene's bounds; `None` where f32 cannot hold its scales.
pub(super) fn grid(bounds: &Aabb) -> Option<Planes> {
    dense::grid(bounds).map(|planes| Planes { shift: 0.0, cell: 0.0, ..planes })
}

/// Whether a scene of these bounds has a grid.
pub(crate) fn holds(bounds: &Aabb) -> bool {
    grid(bounds).is_some()
}

/// Whether headers reach all triangles, and addresses all bytes.
pub(super) fn fits(leaf_bytes: usize, triangles: usize) -> bool {
    triangles as u64 <= TRIANGLE_LIMIT && leaf_bytes as u64 <= BYTE_LIMIT
}

impl Wide {
    /// From the sections of a file, to be proved. `None` where no tree over these bounds has this layout.
    pub(crate) fn from_parts(
        nodes: Vec<WideNode>,
        leaves: Vec<u8>,
        bounds: &Aabb,
        triangles: usize,
    ) -> Option<Self> {
        let grid = grid(bounds)?;
        fits(leaves.len(), triangles).then(|| Self { nodes, leaves, grid, code: LeafCode::new(triangles) })
    }
}

/// Encodes a tree in bounds that the grid [`holds`].
pub(crate) fn encode(tree: &Widened<'_>, bounds: &Aabb, job: &Job<'_>) -> Result<(Wide, u32), BuildError> {
    let triangles = job.mesh.len();
    check(Countable::Triangles, triangles as u64, TRIANGLE_LIMIT)?;
    let grid = grid(bounds).expect("bounds that the grid holds");
    let code = LeafCode::new(triangles);
    let mut wide = Wide { nodes: Vec::new(), leaves: Vec::new(), grid, code };
    let (mut deepest, mut ids) = (0, [0; MOST]);
    // Nodes whose place is known, with their depth. Taken from the back, so a subtree stands together.
    let mut pending: Vec<(usize, Child, u32)> = Vec::new();
    push(&mut wide.nodes, WideNode::new(&[], 0, &wide.grid))?;
    let mut children = Vec::with_capacity(LANES);
    let mut boxes = Vec::with_capacity(LANES);
    if let Some(root) = tree.root() {
        pending.push((0, root, 0));
    }
    let mut written = 0;
    while let Some((at, own, depth)) = pending.pop() {
        job.check_at(written)?;
        written += 1;
        // The root is a node even where a leaf would do.
        if own.is_leaf {
            children.clear();
            children.push(own);
        } else {
            tree.children(own, &mut children);
        }
        // Larger boxes first among nodes and among leaves: rays that end at any hit take them in this order.
        let area = |child: &Child| tree.plan().nodes[child.at].bounds.surface_area();
        children.sort_by(|a, b| a.is_leaf.cmp(&b.is_leaf).then(area(b).total_cmp(&area(a))));
        boxes.clear();
        boxes.extend(children.iter().map(|child| tree.plan().nodes[child.at].bounds));
        let inner = children.iter().filter(|child| !child.is_leaf).count();
        let mut node = WideNode::new(&boxes, inner, &wide.grid);
        let first = wide.nodes.len();
        check(Countable::Nodes, (first + inner) as u64, u32::MAX.into())?;
        (node.nodes, node.leaves) = (first as u32, wide.leaves.len() as u32);
        for (lane, &child) in children.iter().enumerate() {
            if child.is_leaf {
                node.offsets[lane] = (wide.leaves.len() - node.leaves as usize) as u16;
                room(&mut wide.leaves, 8 * MOST)?;
                code.write(&mut wide.leaves, tree.ids(child, &mut ids));
            } else {
                push(&mut wide.nodes, WideNode::new(&[], 0, &wide.grid))?;
            }
        }
        for lane in (0..inner).rev() {
            push(&mut pending, (first + lane, children[lane], depth + 1))?;
        }
        if inner < children.len() {
            deepest = deepest.max(depth + 1);
        }
        check(Countable::Bytes, (wide.leaves.len() + PADDING) as u64, BYTE_LIMIT)?;
        wide.nodes[at] = node;
    }
    room(&mut wide.leaves, PADDING)?;
    wide.leaves.extend_from_slice(&[0; PADDING]);
    wide.leaves.shrink_to_fit();
    wide.nodes.shrink_to_fit();
    Ok((wide, deepest))
}

fn check(what: Countable, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}

/// Bytes of what [`encode`] writes.
pub(crate) fn size(tree: &Widened<'_>, triangles: usize) -> u64 {
    let code = LeafCode::new(triangles);
    let (mut bytes, mut ids) = (PADDING as u64, [0; MOST]);
    let mut pending: Vec<Child> = tree.root().into_iter().collect();
    let mut children = Vec::with_capacity(LANES);
    // The root is a node whatever it holds.
    let is_leaf = tree.root().is_none_or(|root| root.is_leaf);
    bytes += if is_leaf { size_of::<WideNode>() as u64 } else { 0 };
    while let Some(child) = pending.pop() {
        if child.is_leaf {
            bytes += code.size(tree.ids(child, &mut ids));
        } else {
            bytes += size_of::<WideNode>() as u64;
            tree.children(child, &mut children);
            pending.extend_from_slice(&children);
        }
    }
    bytes
}
