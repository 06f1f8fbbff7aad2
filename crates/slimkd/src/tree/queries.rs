//! How a tree answers: which kernel takes which question.

use super::KdTree;
use crate::geometry::{Aabb, Hit, Ray};
use crate::layout::{LaneNodes, Nodes as _, with_nodes};
use crate::query::{BatchJob, Walk, tracer};
use crate::traverse::{
    AnyHits, ClosestHits, ExactQuery, PreparedRay, RayConditions, Search, Sink, Stream, Traced, WideAnyHits,
    WideClosestHits, WideWalk, finish_strays, search_tree, search_wide, traverse, traverse_exactly,
    traverse_wide_exactly,
};

/// Batches below this go ray by ray: a stream is not worth setting up.
const LEAST_STREAM: usize = 16;

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
            let (tree, BatchJob { rays, conditions, coherent, instruction_set }) = (self.traced(wide), job);
            WideClosestHits { tree, rays, conditions, coherent, hits }.run_with(instruction_set);
        });
    }

    fn any_hits(&self, job: BatchJob<'_>, hits: &mut [bool]) {
        with_nodes!(self, nodes => self.traced(nodes).any_hits(self, job, hits), wide => {
            let (tree, BatchJob { rays, conditions, coherent, instruction_set }) = (self.traced(wide), job);
            WideAnyHits { tree, rays, conditions, coherent, hits }.run_with(instruction_set);
        });
    }
}

impl KdTree {
    fn traced<N>(&self, nodes: N) -> Traced<'_, N> {
        Traced { nodes, depth: self.depth, bounds: &self.bounds }
    }
}

impl<N: LaneNodes> Traced<'_, N> {
    fn closest_hits(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        // A filter is asked hit by hit, which streams do anyway.
        if !job.coherent || conditions.filter.is_some() {
            return self.closest_stream(tree, job, hits);
        }
        let except = conditions.except;
        let strays = instruction_set.run(ClosestHits { tree: self, rays, except, hits: &mut *hits });
        let Some(strays) = strays else { return self.closest_stream(tree, job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            self.closest_stream(tree, BatchJob { rays, conditions, ..job }, hits);
        });
    }

    fn any_hits(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [bool]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        if !job.coherent || conditions.filter.is_some() {
            return self.any_stream(tree, job, hits);
        }
        let except = conditions.except;
        let strays = instruction_set.run(AnyHits { tree: self, rays, except, hits: &mut *hits });
        let Some(strays) = strays else { return self.any_stream(tree, job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            self.any_stream(tree, BatchJob { rays, conditions, ..job }, hits);
        });
    }

    fn closest_stream(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        if job.rays.len() >= LEAST_STREAM
            && let Some(stream) = Stream::new(self, job.rays, job.conditions, &mut *hits)
            && job.instruction_set.run(stream).is_some()
        {
            return;
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| tree.ask_closest(ray, conditions));
        }
    }

    fn any_stream(self, tree: &KdTree, job: BatchJob<'_>, hits: &mut [bool]) {
        if job.rays.len() >= LEAST_STREAM
            && let Some(stream) = Stream::new(self, job.rays, job.conditions, &mut *hits)
            && job.instruction_set.run(stream).is_some()
        {
            return;
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| tree.ask_any(ray, conditions));
        }
    }
}
