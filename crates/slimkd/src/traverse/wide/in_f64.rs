//! The walk with plain numbers. Read it first: the one with vectors does the same, faster.

use crate::layout::{Address, Ids, LANES, STEP_BITS, WideNodes};
use crate::traverse::prepared::PreparedRay;
use crate::traverse::sink::Sink;

/// The walk in f64: for rays that the other one does not take, since no value overflows; for trees that are not proved; and where there
/// are no vectors.
#[inline(never)]
pub(crate) fn walk_in_f64(nodes: impl WideNodes, ray: &PreparedRay, sink: &mut impl Sink) {
    let mut pending = vec![(Address::ROOT, f64::NEG_INFINITY)];
    // Lanes that the ray meets, and where it enters them.
    let mut met: Vec<(usize, f64)> = Vec::with_capacity(LANES);
    while let Some((at, enter)) = pending.pop() {
        let limit = f64::from(sink.limit()) * f64::from(ray.scale);
        if enter > limit {
            continue;
        }
        sink.visit();
        // SAFETY: pending addresses are the root and inner children of nodes of this tree.
        let node = unsafe { nodes.read(at) };
        met.clear();
        for lane in 0..node.children() {
            let (mut near, mut far) = (f64::from(ray.enter), f64::from(ray.exit).min(limit));
            for k in 0..3 {
                let step = f64::from(f32::from_bits(node.steps[k] & STEP_BITS));
                let along = |plane: usize| {
                    let place = f64::from(node.low[k]) + f64::from(node.planes[2 * k + plane][lane]) * step;
                    (place - f64::from(ray.plane_origin[k])) * f64::from(ray.inverse[k])
                };
                let (a, b) = (along(0), along(1));
                let (first, last) = if ray.descends[k] == 0 { (a, b) } else { (b, a) };
                // A width that is infinite, or a distance that is none, bounds nothing.
                let width = f64::from(ray.slack[k]);
                (near, far) = (near.max(first - width), far.min(last + width));
            }
            if near <= far {
                met.push((lane, near));
            }
        }
        met.sort_by(|a, b| a.1.total_cmp(&b.1));
        // Leaves first, the nearest of them first: they shorten the walk. Then the nearest inner child, which is pushed last.
        for &(lane, _) in met.iter().filter(|&&(lane, _)| lane >= node.inner()) {
            let mut buffer = Ids::new();
            // SAFETY: the lane is that of a leaf.
            for &id in unsafe { nodes.ids(&node, lane, &mut buffer) } {
                if sink.knows(id) {
                    continue;
                }
                sink.test();
                // SAFETY: a leaf of this tree names the triangle.
                let corners = unsafe { nodes.corners(id) };
                if let Some(done) = sink.decide(&corners, id) {
                    if done {
                        return;
                    }
                    continue;
                }
                if ray.hand_over(ray.shear.decide(&corners), id, sink) {
                    return;
                }
            }
        }
        for &(lane, near) in met.iter().rev().filter(|&&(lane, _)| lane < node.inner()) {
            // SAFETY: the lane is that of an inner child.
            pending.push((unsafe { nodes.child(&node, lane) }, near));
        }
    }
}
