//! A binary tree of tight boxes, by splits of objects and of space.
//!
//! Source: Stich, Friedrich & Dietrich 2009, *Spatial Splits in Bounding Volume Hierarchies*.
//!
//! Deviations
//! 1. Nodes are split down to pairs whatever the heuristic says: collapsing into wide nodes (`plan/widen.rs`) decides what becomes a
//!    leaf, with the price of bytes in mind.
//! 2. The number of parts is bounded: a node may cut as many triangles as its share of [`SPARE`] allows, so memory is bounded too.

mod grow;
mod object;
mod reference;
mod spatial;

use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::with_room;
use crate::options::BuildError;
use crate::plan::BoxPlan;
use grow::Shared;
use reference::Reference;

/// Parts beyond the first for each triangle, over the whole tree.
const SPARE: f64 = 0.75;

/// Builds the tree over triangles that can be hit.
pub(crate) fn build(
    triangles: &[u32],
    bounds: &Aabb,
    cuts: bool,
    job: &Job<'_>,
) -> Result<BoxPlan, BuildError> {
    if triangles.is_empty() {
        return Ok(BoxPlan::default());
    }
    job.memory.take(triangles.len() * size_of::<Reference>())?;
    let mut references = with_room(triangles.len())?;
    for &id in triangles {
        let mut bounds = Aabb::EMPTY;
        job.mesh.corners(id).into_iter().for_each(|corner| bounds.include(corner));
        references.push(Reference::new(&bounds, id));
    }
    let spare = (SPARE * triangles.len() as f64) as usize;
    let shared = Shared { job, root_area: bounds.surface_area() / 2.0, cuts };
    shared.grow(references, spare, 0)?.joined(job)
}
