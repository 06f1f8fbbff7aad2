//! From a plan to 8-byte nodes.

use super::Plain;
use super::layout::{COUNT_LIMIT_2BYTE, COUNT_LIMIT_4BYTE, Node, POINTER_LIMIT, Packed};
use crate::job::Job;
use crate::job::memory::with_room;
use crate::options::{BuildError, Countable};
use crate::plan::{Plan, PlanNode};

/// Whether a leaf of these ids can use the 2-byte mode: they share their upper 16 bits and H can count them.
fn shared_upper(ids: &[u32]) -> Option<u32> {
    let upper = ids.first()? & 0xffff_0000;
    (ids.len() <= COUNT_LIMIT_2BYTE && ids.iter().all(|id| id & 0xffff_0000 == upper)).then_some(upper)
}

/// Bytes of what [`encode`] writes.
pub(crate) fn size(plan: &Plan, two_byte: bool, job: &Job<'_>) -> Result<u64, BuildError> {
    let Entries { nodes, wide, narrow } = Entries::of(plan, two_byte, job)?;
    Ok(8 * nodes + 4 * wide + 2 * narrow)
}

/// Entries of each array.
struct Entries {
    /// Nodes and T-references.
    nodes: u64,
    /// 4-byte ids.
    wide: u64,
    /// 2-byte ids.
    narrow: u64,
}

impl Entries {
    fn of(plan: &Plan, two_byte: bool, job: &Job<'_>) -> Result<Self, BuildError> {
        let nodes = (plan.nodes.len() + plan.hoisted.len()) as u64;
        check(Countable::Nodes, nodes, POINTER_LIMIT)?;
        let (mut wide, mut narrow) = (0u64, 0u64);
        for (at, node) in plan.nodes.iter().enumerate() {
            job.check_at(at)?;
            if let &PlanNode::Leaf { first, count } = node {
                let mode = shared_upper(leaf_ids(plan, first, count)).filter(|_| two_byte);
                *if mode.is_some() { &mut narrow } else { &mut wide } += u64::from(count);
                check(Countable::TrianglesOfALeaf, count.into(), COUNT_LIMIT_4BYTE)?;
            }
        }
        check(Countable::FourByteReferences, wide, POINTER_LIMIT)?;
        check(Countable::TwoByteReferences, narrow, POINTER_LIMIT)?;
        Ok(Self { nodes, wide, narrow })
    }
}

fn leaf_ids(plan: &Plan, first: u32, count: u32) -> &[u32] {
    &plan.references[first as usize..(first + count) as usize]
}

/// Encodes a plan; `two_byte` allows the 2-byte leaf mode.
pub(crate) fn encode(plan: &Plan, two_byte: bool, job: &Job<'_>) -> Result<Plain, BuildError> {
    let Entries { nodes, wide, narrow } = Entries::of(plan, two_byte, job)?;
    let mut out = Plain {
        nodes: with_room(nodes as usize)?,
        indices_4byte: with_room(wide as usize)?,
        indices_2byte: with_room(narrow as usize)?,
    };
    out.nodes.push(Packed(0));
    let mut hoisted = plan.hoisted.iter().peekable();
    // The plan is in preorder: the next node always belongs into the slot on top.
    let mut slots = vec![0usize];
    for (at, node) in plan.nodes.iter().enumerate() {
        job.check_at(at)?;
        let slot = slots.pop().expect("a plan has one root");
        let node = match *node {
            PlanNode::Inner { axis, split, .. } => {
                let children = out.nodes.len() as u32;
                out.nodes.extend([Packed(0), Packed(0)]);
                let t_reference = hoisted.next_if(|&&(node, _)| node as usize == at);
                out.nodes.extend(t_reference.map(|&(_, triangle)| Packed::t_reference(triangle)));
                slots.extend([children as usize + 1, children as usize]);
                Node::Inner { axis: axis.into(), split, children, t_reference: t_reference.is_some() }
            }
            PlanNode::Leaf { first, count } => {
                let ids = leaf_ids(plan, first, count);
                match shared_upper(ids).filter(|_| two_byte) {
                    Some(upper) => {
                        let first = out.indices_2byte.len() as u32;
                        out.indices_2byte.extend(ids.iter().map(|&id| id as u16));
                        Node::Leaf2 { first, count, upper }
                    }
                    None => {
                        // An empty leaf may stand behind the last index, where no pointer reaches.
                        let first = if count == 0 { 0 } else { out.indices_4byte.len() as u32 };
                        out.indices_4byte.extend_from_slice(ids);
                        Node::Leaf4 { first, count }
                    }
                }
            }
        };
        out.nodes[slot] = Packed::encode(node);
    }
    Ok(out)
}

fn check(what: Countable, needed: u64, limit: u64) -> Result<(), BuildError> {
    if needed <= limit { Ok(()) } else { Err(BuildError::TooLarge { what, needed, limit }) }
}
