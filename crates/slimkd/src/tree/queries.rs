//! How a tree answers: which kernel takes which question.

use super::KdTree;
use crate::geometry::{Aabb, Hit, Ray};
use crate::layout::{LaneNodes, Nodes as _, WideView, with_nodes};
use crate::query::{BatchJob, Walk, tracer};
use crate::traverse::{
    AnyHits, ClosestHits, ExactQuery, Grouped, LEAST_STREAM, PreparedRay, RayConditions, Search, Sink,
    Stream, Traced, WideBatch, WideWalk, finish_strays, search_tree, search_wide, traverse, traverse_exactly,
    traverse_wide_exactly,
};

tracer!(KdTree);

impl Walk for KdTree {
    fn extent(&self) -> Aabb {
        self.bounds
    }

    fn place(&self) -> [f64; 3] {
        self.mesh.origin()
    }

    fn triangle(&self, id: u32) -> Option<[[f32; 3]; 3]> {
        ((id as usize) < self.mesh.len()).then(|| self.mesh.corners(id))
    }

    fn walk(&self, ray: &Ray, sink: &mut impl Sink) {
        with_nodes!(self, nodes => {
            if let Some(prepared) = PreparedRay::new(ray, &self.bounds, &nodes.planes()) {
                traverse(nodes, self.depth, &prepared, sink);
            }
        }, wide => WideWalk { tree: self.traced(wide), ray, sink }.run_best());
    }

    fn walk_exact(&self, query: &mut ExactQuery<'_>) {
        with_nodes!(self, nodes => traverse_exactly(self.traced(nodes), query), wide => {
            traverse_wide_exactly(wide, &self.bounds, query)
        });
    }

    fn search(&self, search: &mut Search<'_>) {
        with_nodes!(self, nodes => search_tree(self.traced(nodes), search), wide => search_wide(wide, search));
    }

    fn closest_hits(&self, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        with_nodes!(self, nodes => self.traced(nodes).closest_hits(self, job, hits), wide => {
            self.traced(wide).closest_hits(self, job, hits)
        });
    }

    fn any_hits(&self, job: BatchJob<'_>, hits: &mut [bool]) {
        with_nodes!(self, nodes => self.traced(nodes).any_hits(self, job, hits), wide => {
            self.traced(wide).any_hits(self, job, hits)
        });
    }
}

impl KdTree {
    fn traced<N>(&self, nodes: N) -> Traced<'_, N> {
        Traced { nodes, depth: self.depth, bounds: &self.bounds }
    }
}

/// A tree that batches go through in any order.
pub(crate) trait Batched: Grouped {
    fn closest(traced: Traced<'_, Self>, tree: &KdTree, job: BatchJob<'_>, hits: &mut [Option<Hit>]);
    fn any(traced: Traced<'_, Self>, tree: &KdTree, job: BatchJob<'_>, hits: &mut [bool]);
}

impl<N: Batched> Traced<'_, N> {
    fn closest_hits(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        // A filter is asked hit by hit, which streams do anyway.
        if !job.coherent || conditions.filter.is_some() {
            return N::closest(self, tree, job, hits);
        }
        let except = conditions.except;
        let strays = instruction_set.run(ClosestHits { tree: self, rays, except, hits: &mut *hits });
        let Some(strays) = strays else { return N::closest(self, tree, job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            N::closest(self, tree, BatchJob { rays, conditions, ..job }, hits);
        });
    }

    fn any_hits(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [bool]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        if !job.coherent || conditions.filter.is_some() {
            return N::any(self, tree, job, hits);
        }
        let except = conditions.except;
        let strays = instruction_set.run(AnyHits { tree: self, rays, except, hits: &mut *hits });
        let Some(strays) = strays else { return N::any(self, tree, job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            N::any(self, tree, BatchJob { rays, conditions, ..job }, hits);
        });
    }
}

impl<N: LaneNodes> Batched for N {
    fn closest(traced: Traced<'_, Self>, tree: &KdTree, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        if job.rays.len() >= LEAST_STREAM
            && let Some(stream) = Stream::new(traced, job.rays, job.conditions, &mut *hits)
            && job.instruction_set.run(stream).is_some()
        {
            return;
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| tree.ask_closest(ray, conditions));
        }
    }

    fn any(traced: Traced<'_, Self>, tree: &KdTree, job: BatchJob<'_>, hits: &mut [bool]) {
        if job.rays.len() >= LEAST_STREAM
            && let Some(stream) = Stream::new(traced, job.rays, job.conditions, &mut *hits)
            && job.instruction_set.run(stream).is_some()
        {
            return;
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| tree.ask_any(ray, conditions));
        }
    }
}

impl Batched for WideView<'_> {
    fn closest(tree: Traced<'_, Self>, _: &KdTree, job: BatchJob<'_>, answers: &mut [Option<Hit>]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        WideBatch { tree, rays, conditions, answers }.run_with(instruction_set);
    }

    fn any(tree: Traced<'_, Self>, _: &KdTree, job: BatchJob<'_>, answers: &mut [bool]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        WideBatch { tree, rays, conditions, answers }.run_with(instruction_set);
    }
}
