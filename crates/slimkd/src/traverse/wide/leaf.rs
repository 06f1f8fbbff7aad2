//! The triangles of a leaf in a stream: four at a time, and f64 at once for those that may be hit.
//!
//! One ray alone waits for f64, so `walk.rs` puts it off. Here other rays compute meanwhile, and what f32 would have to say instead takes more
//! instructions than f64 with the three corners side by side.

use crate::layout::{Ids, WideNode, WideView};
use crate::simd::Simd;
use crate::traverse::counters::count;
use crate::traverse::prepared::PreparedRay;
use crate::traverse::sink::Sink;

/// Tests the triangles of a leaf; `true` ends the walk.
///
/// # Safety
/// The node must come from this tree, and the lane must be that of a leaf.
#[inline(always)]
pub(super) unsafe fn leaf<V: Simd, S: Sink>(
    s: V,
    nodes: WideView<'_>,
    ray: &PreparedRay,
    node: &WideNode,
    lane: usize,
    sink: &mut S,
) -> bool {
    let mut buffer = Ids::new();
    // SAFETY: the caller's promise.
    let fours = unsafe { nodes.fours(node, lane, &mut buffer) };
    for ids in fours {
        let mut four = [[std::ptr::null(); 3]; 4];
        for (four, &id) in four.iter_mut().zip(ids) {
            // SAFETY: a leaf of this tree names triangles of the mesh.
            *four = unsafe { nodes.mesh.corner_pointers(id) };
        }
        // SAFETY: these are corners.
        let mut may_hit = unsafe { s.may_hit(&ray.shear, &four) };
        count(|c| {
            let different = 1 + ids.windows(2).filter(|two| two[0] != two[1]).count() as u64;
            (c.triangles, c.ray_triangles, c.triangle_lanes) =
                (c.triangles + 1, c.ray_triangles + different, c.triangle_lanes + 4);
        });
        while may_hit != 0 {
            let id = ids[(may_hit.trailing_zeros() & 3) as usize];
            may_hit &= may_hit - 1;
            if sink.knows(id) {
                continue;
            }
            count(|c| c.decided += 1);
            // SAFETY: a leaf of this tree names the triangle; these are its corners.
            let found = unsafe { s.decide(&ray.shear, nodes.mesh.corner_pointers(id)) };
            if ray.hand_over(found, id, sink) {
                return true;
            }
        }
    }
    false
}
