//! What tracing does, counted: with the `counters` feature; without it nothing is compiled in.

#[cfg(feature = "counters")]
use std::cell::Cell;

/// What the calling thread's queries did since [`Counters::take`] was last called.
///
/// A single ray counts as a walk of one lane; a packet or a group is one walk of many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Rays that met the scene's bounds.
    pub rays: u64,
    /// Walks through the tree.
    pub walks: u64,
    /// Nodes that walks visited.
    pub nodes: u64,
    /// Those of them where intervals around all rays of a packet said where all go.
    pub whole: u64,
    /// Rays that were active in them, summed: a ray's nodes.
    pub ray_nodes: u64,
    /// Lanes that these nodes were computed for; `ray_nodes / node_lanes` is the occupancy.
    pub node_lanes: u64,
    /// Triangles that walks fetched.
    pub triangles: u64,
    /// Rays that were tested against them, summed: a ray's triangles.
    pub ray_triangles: u64,
    /// Lanes that these tests were computed for.
    pub triangle_lanes: u64,
    /// Rays whose test went on to f64.
    pub decided: u64,
}

#[cfg(feature = "counters")]
thread_local! {
    static COUNTERS: Cell<Counters> = const { Cell::new(Counters {
        rays: 0, walks: 0, nodes: 0, whole: 0, ray_nodes: 0, node_lanes: 0, triangles: 0, ray_triangles: 0, triangle_lanes: 0,
        decided: 0,
    }) };
}

impl Counters {
    /// The calling thread's counters, which begin again at 0. All zero without the `counters` feature.
    pub fn take() -> Self {
        #[cfg(feature = "counters")]
        return COUNTERS.take();
        #[cfg(not(feature = "counters"))]
        Self::default()
    }
}

/// Adds to this thread's counters; with the feature off, `add` is never called and goes away.
#[inline(always)]
pub(crate) fn count(add: impl FnOnce(&mut Counters)) {
    #[cfg(feature = "counters")]
    COUNTERS.with(|cell| {
        let mut counters = cell.get();
        add(&mut counters);
        cell.set(counters);
    });
    #[cfg(not(feature = "counters"))]
    let _ = add;
}
