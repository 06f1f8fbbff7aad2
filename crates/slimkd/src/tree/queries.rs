//! How a tree answers: which kernel takes which question.

use super::KdTree;
use crate::geometry::{Aabb, Hit, Ray};
use crate::layout::{Nodes, with_nodes};
use crate::query::{BatchJob, Walk, tracer};
use crate::traverse::{
    AnyHits, ClosestHits, Conditions, ExactQuery, NearestPoint, PreparedRay, RayConditions, Search, Sink,
    Stream, Traced, finish_strays, search_tree, traverse, traverse_exactly,
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
        });
    }

    fn walk_exact(&self, query: &mut ExactQuery<'_>) {
        with_nodes!(self, nodes => traverse_exactly(self.traced(nodes), query));
    }

    fn search(&self, search: &mut Search<'_>) {
        with_nodes!(self, nodes => search_tree(self.traced(nodes), search));
    }

    fn closest_hits(&self, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        // A filter is asked hit by hit, which streams do anyway.
        if !job.coherent || conditions.filter.is_some() {
            return self.closest_stream(job, hits);
        }
        let except = conditions.except;
        let strays = with_nodes!(self, nodes => {
            let hits = &mut *hits;
            instruction_set.run(ClosestHits { tree: self.traced(nodes), rays, except, hits })
        });
        let Some(strays) = strays else { return self.closest_stream(job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            self.closest_stream(BatchJob { rays, conditions, ..job }, hits);
        });
    }

    fn any_hits(&self, job: BatchJob<'_>, hits: &mut [bool]) {
        let BatchJob { rays, conditions, instruction_set, .. } = job;
        if !job.coherent || conditions.filter.is_some() {
            return self.any_stream(job, hits);
        }
        let except = conditions.except;
        let strays = with_nodes!(self, nodes => {
            let hits = &mut *hits;
            instruction_set.run(AnyHits { tree: self.traced(nodes), rays, except, hits })
        });
        let Some(strays) = strays else { return self.any_stream(job, hits) };
        finish_strays(rays, hits, except, &strays, |rays, except, hits| {
            let conditions = RayConditions { except, ..conditions };
            self.any_stream(BatchJob { rays, conditions, ..job }, hits);
        });
    }
}

impl KdTree {
    fn traced<N: Nodes>(&self, nodes: N) -> Traced<'_, N> {
        Traced { nodes, depth: self.depth, bounds: &self.bounds }
    }

    fn closest_stream(&self, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        if job.rays.len() >= LEAST_STREAM {
            with_nodes!(self, nodes => {
                if let Some(stream) = Stream::new(self.traced(nodes), job.rays, job.conditions, &mut *hits)
                    && job.instruction_set.run(stream).is_some()
                {
                    return;
                }
            });
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| self.ask_closest(ray, conditions));
        }
    }

    fn any_stream(&self, job: BatchJob<'_>, hits: &mut [bool]) {
        if job.rays.len() >= LEAST_STREAM {
            with_nodes!(self, nodes => {
                if let Some(stream) = Stream::new(self.traced(nodes), job.rays, job.conditions, &mut *hits)
                    && job.instruction_set.run(stream).is_some()
                {
                    return;
                }
            });
        }
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| self.ask_any(ray, conditions));
        }
    }
}
