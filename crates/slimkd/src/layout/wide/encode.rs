//! From a widened tree to wide nodes.

use super::leaf::{LeafCode, TRIANGLE_LIMIT};
use super::node::WideNode;
use super::{LANES, PADDING, Wide};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{push, with_room};
use crate::layout::runs::LONGEST_RUN;
use crate::layout::{Planes, dense};
use crate::options::{BuildError, Countable};
use crate::plan::{Child, MOST, Widened};
use crate::threads;
use std::convert::Infallible;
use std::ops::Add;

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
    // All of it is reserved at once, so nothing is copied as it grows.
    let size = size(tree, triangles);
    check(Countable::Nodes, size.nodes as u64, u32::MAX.into())?;
    check(Countable::Bytes, size.leaves as u64, BYTE_LIMIT)?;
    job.memory.take(size.bytes() as usize)?;
    let mut wide = Wide { nodes: with_room(size.nodes)?, leaves: with_room(size.leaves)?, grid, code };
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
        let area = |child: &Child| tree.bounds(*child).surface_area();
        children.sort_by(|a, b| a.is_leaf.cmp(&b.is_leaf).then(area(b).total_cmp(&area(a))));
        boxes.clear();
        boxes.extend(children.iter().map(|&child| *tree.bounds(child)));
        let inner = children.iter().filter(|child| !child.is_leaf).count();
        let mut node = WideNode::new(&boxes, inner, &wide.grid);
        let first = wide.nodes.len();
        (node.nodes, node.leaves) = (first as u32, wide.leaves.len() as u32);
        for (lane, &child) in children.iter().enumerate() {
            if child.is_leaf {
                node.offsets[lane] = (wide.leaves.len() - node.leaves as usize) as u16;
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
        wide.nodes[at] = node;
    }
    wide.leaves.extend_from_slice(&[0; PADDING]);
    debug_assert!(wide.bytes() == size.bytes());
    Ok((wide, deepest))
}

fn check(what: Countable, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}

/// How large a tree is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Size {
    nodes: usize,
    /// Bytes of leaves.
    leaves: usize,
}

impl Size {
    pub(crate) fn bytes(self) -> u64 {
        (self.nodes * size_of::<WideNode>() + self.leaves) as u64
    }

    /// The least that so many triangles can take: full leaves of runs, full nodes.
    pub(crate) fn least(triangles: usize) -> Self {
        let leaves = triangles.div_ceil(MOST);
        let codes = (MOST - 1).div_ceil(LONGEST_RUN);
        let each = LeafCode::new(triangles).header_bytes() as usize + codes;
        let nodes = leaves.saturating_sub(1).div_ceil(LANES - 1).max(1);
        Self { nodes, leaves: leaves.saturating_sub(1) * each + PADDING }
    }
}

impl Add for Size {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { nodes: self.nodes + other.nodes, leaves: self.leaves + other.leaves }
    }
}

/// How large what [`encode`] writes is.
pub(crate) fn size(tree: &Widened<'_>, triangles: usize) -> Size {
    let code = LeafCode::new(triangles);
    // The root is a node whatever it holds.
    let is_leaf = tree.root().is_none_or(|root| root.is_leaf);
    let root = Size { nodes: usize::from(is_leaf), leaves: PADDING };
    // Nodes of the top by this thread, what is below them by all.
    let mut parts = Vec::new();
    let top = size_below(tree, code, tree.root(), |child| {
        let is_in_part = child.is_in_part();
        if is_in_part {
            parts.push(child);
        }
        is_in_part
    });
    let Ok(parts) =
        threads::map(parts, |part| Ok::<_, Infallible>(size_below(tree, code, Some(part), |_| false)));
    parts.into_iter().fold(root + top, Add::add)
}

/// A subtree's size, without those below that are `left_out`.
fn size_below(
    tree: &Widened<'_>,
    code: LeafCode,
    root: Option<Child>,
    mut left_out: impl FnMut(Child) -> bool,
) -> Size {
    let (mut size, mut ids) = (Size::default(), [0; MOST]);
    let mut pending: Vec<Child> = root.into_iter().collect();
    let mut children = Vec::with_capacity(LANES);
    while let Some(child) = pending.pop() {
        if left_out(child) {
            continue;
        }
        if child.is_leaf {
            size.leaves += code.size(tree.ids(child, &mut ids)) as usize;
        } else {
            size.nodes += 1;
            tree.children(child, &mut children);
            pending.extend_from_slice(&children);
        }
    }
    size
}
