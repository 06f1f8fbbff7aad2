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
#[cfg(test)]
mod tests;

use crate::geometry::Aabb;
use crate::job::Job;
use crate::job::memory::with_room;
use crate::options::{BuildError, Splits};
use crate::plan::BoxForest;
use grow::Shared;
use reference::Reference;

/// Parts beyond the first for each triangle, over the whole tree; and where planes alone divide it.
const SPARE: f64 = 0.75;
const SPARE_OF_CELLS: f64 = 3.0;

/// Builds the tree over triangles that can be hit. Moves the progress by `share`.
pub(crate) fn build(
    triangles: &[u32],
    bounds: &Aabb,
    share: f64,
    job: &Job<'_>,
) -> Result<BoxForest, BuildError> {
    let mut forest = BoxForest::default();
    if triangles.is_empty() {
        return Ok(forest);
    }
    job.memory.take(triangles.len() * size_of::<Reference>())?;
    let mut references = with_room(triangles.len())?;
    for &id in triangles {
        let mut bounds = Aabb::EMPTY;
        job.mesh.corners(id).into_iter().for_each(|corner| bounds.include(corner));
        references.push(Reference::new(&bounds, id));
    }
    let splits = job.options.splits;
    let spare = if splits == Splits::Space { SPARE_OF_CELLS } else { SPARE };
    let spare = (spare * triangles.len() as f64) as usize;
    let shared =
        Shared { job, root_area: bounds.surface_area() / 2.0, splits, share: share / triangles.len() as f64 };
    shared.grow(references, spare, 0)?.append_to(&mut forest)?;
    Ok(forest)
}
