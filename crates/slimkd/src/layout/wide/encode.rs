//! From a widened tree to wide nodes.

use super::leaf::{LeafCode, TRIANGLE_LIMIT};
use super::node::WideNode;
use super::{LANES, PADDING, Wide};
use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::{push, room, with_room};
use crate::layout::runs::LONGEST_RUN;
use crate::layout::{Planes, dense};
use crate::options::{BuildError, Countable};
use crate::plan::{Child, MOST, Widened};
use crate::threads;
use std::convert::Infallible;

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

/// Encodes a tree in bounds that the grid [`holds`]: nodes of its top by this thread, then what is below by all.
pub(crate) fn encode(tree: &Widened<'_>, bounds: &Aabb, job: &Job<'_>) -> Result<(Wide, u32), BuildError> {
    let triangles = job.mesh.len();
    check(Countable::Triangles, triangles as u64, TRIANGLE_LIMIT)?;
    let grid = grid(bounds).expect("bounds that the grid holds");
    let code = LeafCode::new(triangles);
    let encoder = Encoder { tree, grid: &grid, code, job };
    let Some(root) = tree.root() else {
        let nodes = vec![WideNode::new(&[], 0, &grid)];
        return Ok((Wide { nodes, leaves: vec![0; PADDING], grid, code }, 0));
    };
    // 1. Each subtree that is a part's gets a section of its own.
    let mut roots = Vec::new();
    let top = encoder.section(root, 0, |at, child, depth| {
        let is_apart = child.is_in_part() && !child.is_leaf;
        if is_apart {
            roots.push((at, child, depth));
        }
        is_apart
    })?;
    let sections = threads::map(&roots, |&(_, child, depth)| encoder.section(child, depth, |_, _, _| false))?;
    // 2. All of them together, each behind the one before. The first node of a section has its place already.
    let total = |of: fn(&Section) -> usize| sections.iter().chain([&top]).map(of).sum::<usize>();
    let (nodes, leaves) = (total(|s| s.nodes.len()) - sections.len(), total(|s| s.leaves.len()) + PADDING);
    check(Countable::Nodes, nodes as u64, u32::MAX.into())?;
    check(Countable::Bytes, leaves as u64, BYTE_LIMIT)?;
    job.memory.take(nodes * size_of::<WideNode>() + leaves)?;
    let mut wide = Wide { nodes: with_room(nodes)?, leaves: with_room(leaves)?, grid, code };
    let mut deepest = top.deepest;
    wide.nodes.extend_from_slice(&top.nodes);
    wide.leaves.extend_from_slice(&top.leaves);
    for (&(at, ..), section) in roots.iter().zip(&sections) {
        let (nodes, leaves) = (wide.nodes.len() as u32 - 1, wide.leaves.len() as u32);
        let moved = section.nodes.iter().map(|node| WideNode {
            nodes: node.nodes + nodes,
            leaves: node.leaves + leaves,
            ..*node
        });
        for (number, node) in moved.enumerate() {
            if number == 0 { wide.nodes[at] = node } else { wide.nodes.push(node) }
        }
        wide.leaves.extend_from_slice(&section.leaves);
        deepest = deepest.max(section.deepest);
    }
    wide.leaves.extend_from_slice(&[0; PADDING]);
    Ok((wide, deepest))
}

/// A subtree's bytes, whose places count from its own start. Its root is node 0.
struct Section {
    nodes: Vec<WideNode>,
    leaves: Vec<u8>,
    /// Depth of its deepest leaf in the whole tree.
    deepest: u32,
}

/// What all sections share.
#[derive(Clone, Copy)]
struct Encoder<'a> {
    tree: &'a Widened<'a>,
    grid: &'a Planes,
    code: LeafCode,
    job: &'a Job<'a>,
}

impl Encoder<'_> {
    /// The subtree below `root`, which stands at `depth`. Nodes for which `apart` says so get a place, and nothing below them.
    fn section(
        &self,
        root: Child,
        depth: u32,
        mut apart: impl FnMut(usize, Child, u32) -> bool,
    ) -> Result<Section, BuildError> {
        let Self { tree, grid, code, job } = *self;
        let empty = WideNode::new(&[], 0, grid);
        let mut own = Section { nodes: vec![empty], leaves: Vec::new(), deepest: 0 };
        let mut ids = [0; MOST];
        // Nodes whose place is known, with their depth. Taken from the back, so a subtree stands together.
        let mut pending: Vec<(usize, Child, u32)> = vec![(0, root, depth)];
        let mut children = Vec::with_capacity(LANES);
        let mut boxes = Vec::with_capacity(LANES);
        let mut written = 0;
        while let Some((at, node, depth)) = pending.pop() {
            job.check_at(written)?;
            written += 1;
            if apart(at, node, depth) {
                continue;
            }
            // The root is a node even where a leaf would do.
            if node.is_leaf {
                children.clear();
                children.push(node);
            } else {
                tree.children(node, &mut children);
            }
            // Larger boxes first among nodes and among leaves: rays that end at any hit take them in this order.
            let area = |child: &Child| tree.bounds(*child).surface_area();
            children.sort_by(|a, b| a.is_leaf.cmp(&b.is_leaf).then(area(b).total_cmp(&area(a))));
            boxes.clear();
            boxes.extend(children.iter().map(|&child| *tree.bounds(child)));
            let inner = children.iter().filter(|child| !child.is_leaf).count();
            let mut node = WideNode::new(&boxes, inner, grid);
            let first = own.nodes.len();
            (node.nodes, node.leaves) = (first as u32, own.leaves.len() as u32);
            for (lane, &child) in children.iter().enumerate() {
                if child.is_leaf {
                    node.offsets[lane] = (own.leaves.len() - node.leaves as usize) as u16;
                    room(&mut own.leaves, 8 * MOST)?;
                    code.write(&mut own.leaves, tree.ids(child, &mut ids));
                } else {
                    push(&mut own.nodes, empty)?;
                }
            }
            for lane in (0..inner).rev() {
                push(&mut pending, (first + lane, children[lane], depth + 1))?;
            }
            if inner < children.len() {
                own.deepest = own.deepest.max(depth + 1);
            }
            own.nodes[at] = node;
        }
        own.nodes.shrink_to_fit();
        own.leaves.shrink_to_fit();
        job.memory.take(own.nodes.len() * size_of::<WideNode>() + own.leaves.len())?;
        Ok(own)
    }
}

fn check(what: Countable, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}

/// The fewest bytes that so many triangles can take: full leaves of runs, full nodes.
pub(crate) fn least_size(triangles: usize) -> u64 {
    let leaves = triangles.div_ceil(MOST);
    let codes = (MOST - 1).div_ceil(LONGEST_RUN);
    let each = LeafCode::new(triangles).header_bytes() as usize + codes;
    let nodes = leaves.saturating_sub(1).div_ceil(LANES - 1).max(1);
    // The last leaf may be small.
    (nodes * size_of::<WideNode>() + leaves.saturating_sub(1) * each + PADDING) as u64
}

/// Bytes of what [`encode`] writes.
pub(crate) fn size(tree: &Widened<'_>, triangles: usize) -> u64 {
    let code = LeafCode::new(triangles);
    // The root is a node whatever it holds.
    let is_leaf = tree.root().is_none_or(|root| root.is_leaf);
    let root = if is_leaf { size_of::<WideNode>() as u64 } else { 0 };
    // Nodes of the top by this thread, what is below them by all.
    let mut parts = Vec::new();
    let top = size_below(tree, code, tree.root(), |child| {
        let is_apart = child.is_in_part();
        if is_apart {
            parts.push(child);
        }
        is_apart
    });
    let Ok(parts) =
        threads::map(parts, |part| Ok::<_, Infallible>(size_below(tree, code, Some(part), |_| false)));
    PADDING as u64 + root + top + parts.iter().sum::<u64>()
}

/// A subtree's bytes, without what is `apart` below.
fn size_below(
    tree: &Widened<'_>,
    code: LeafCode,
    root: Option<Child>,
    mut apart: impl FnMut(Child) -> bool,
) -> u64 {
    let (mut bytes, mut ids) = (0, [0; MOST]);
    let mut pending: Vec<Child> = root.into_iter().collect();
    let mut children = Vec::with_capacity(LANES);
    while let Some(child) = pending.pop() {
        if apart(child) {
            continue;
        }
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
