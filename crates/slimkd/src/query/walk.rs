//! What a tree must be able to do so that every query of a [`Tracer`](super::Tracer) works on it.

use super::batch::BatchJob;
use crate::geometry::{Aabb, Hit, Ray};
use crate::traverse::{Any, Closest, Conditions, ExactQuery, Filtered, First, NearestPoint, Search, Sink};

/// A tree, or what answers like one.
pub(crate) trait Walk: Send + Sync {
    /// [`Tracer::bounds`](super::Tracer::bounds).
    fn extent(&self) -> Aabb;

    /// [`Tracer::origin`](super::Tracer::origin).
    fn place(&self) -> [f64; 3];

    /// [`Tracer::corners`](super::Tracer::corners).
    fn triangle(&self, id: u32) -> Option<[[f32; 3]; 3]>;

    /// Offers every triangle that the ray may hit to `sink`, nearer ones mostly first. An invalid ray offers nothing.
    fn walk(&self, ray: &Ray, sink: &mut impl Sink);

    /// Lets `query` decide about every triangle that its ray may hit.
    fn walk_exact(&self, query: &mut ExactQuery<'_>);

    /// Offers every triangle that may be nearest to the point of `search`.
    fn search(&self, search: &mut Search<'_>);

    fn ask_closest(&self, ray: &Ray, conditions: Conditions<'_>) -> Option<Hit> {
        let mut sink = Closest::new(ray.t_max, conditions.except);
        match conditions.filter {
            None => self.walk(ray, &mut sink),
            Some(accept) => self.walk(ray, &mut Filtered { sink: &mut sink, accept }),
        }
        sink.into_hit()
    }

    fn ask_any(&self, ray: &Ray, conditions: Conditions<'_>) -> bool {
        let mut sink = Any::new(ray.t_max, conditions.except);
        match conditions.filter {
            None => self.walk(ray, &mut sink),
            Some(accept) => self.walk(ray, &mut Filtered { sink: &mut sink, accept }),
        }
        sink.found
    }

    fn ask_first(&self, ray: &Ray, most: usize, conditions: Conditions<'_>, hits: &mut Vec<Hit>) {
        let mut sink = First::new(hits, most, ray.t_max, conditions.except);
        match conditions.filter {
            None => self.walk(ray, &mut sink),
            Some(accept) => self.walk(ray, &mut Filtered { sink: &mut sink, accept }),
        }
        sink.finish();
    }

    fn ask_nearest(
        &self,
        point: [f32; 3],
        max_distance: f32,
        conditions: Conditions<'_>,
    ) -> Option<NearestPoint> {
        let mut search = Search::new(point, max_distance, &self.extent(), conditions)?;
        self.search(&mut search);
        search.into_nearest()
    }

    fn ask_several(
        &self,
        point: [f32; 3],
        max_distance: f32,
        most: usize,
        conditions: Conditions<'_>,
        found: &mut Vec<NearestPoint>,
    ) {
        let search = Search::new(point, max_distance, &self.extent(), conditions);
        if let Some(search) = search.filter(|_| most > 0) {
            let mut search = search.several(most);
            self.search(&mut search);
            search.add_to(found);
        }
    }

    /// Closest hits of a batch; ray by ray where there is nothing faster.
    fn closest_hits(&self, job: BatchJob<'_>, hits: &mut [Option<Hit>]) {
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| self.ask_closest(ray, conditions));
        }
    }

    /// Any-hit answers of a batch; ray by ray where there is nothing faster.
    fn any_hits(&self, job: BatchJob<'_>, hits: &mut [bool]) {
        for (at, (ray, hit)) in job.rays.iter().zip(hits).enumerate() {
            *hit = job.conditions.alone(at, |conditions| self.ask_any(ray, conditions));
        }
    }
}

/// Makes a [`Walk`] a [`Tracer`](super::Tracer). This is a macro and not a blanket implementation, so that each tree's walks are
/// compiled once, in this crate, and not again in every crate that calls them. For the same reason a generic type has a tracer that is not
/// generic do its work: `tracer!([B: …] OpenTree<B>: |tree| tree.opened())`.
macro_rules! tracer {
    ([$($generics:tt)*] $type:ty: |$tree:ident| $tracer:expr) => {
        $crate::query::tracer! {
            [$($generics)*] $type: |$tree| $tracer;
            bounds origin corners closest_with any_with first_with exact_with nearest_with several_with closest_batch any_batch
        }
    };
    // What answers, and its names of the trait's methods.
    ([$($generics:tt)*] $type:ty: |$tree:ident| $tracer:expr;
        $bounds:ident $origin:ident $corners:ident $closest:ident $any:ident $first:ident $exact:ident $nearest:ident $several:ident
        $closest_batch:ident $any_batch:ident) => {
        impl<$($generics)*> $crate::query::Tracer for $type {
            fn as_dyn(&self) -> &(dyn $crate::query::Tracer + '_) {
                self
            }

            fn bounds(&self) -> $crate::geometry::Aabb {
                let $tree = self;
                $tracer.$bounds()
            }

            fn origin(&self) -> [f64; 3] {
                let $tree = self;
                $tracer.$origin()
            }

            fn corners(&self, triangle: u32) -> Option<[[f32; 3]; 3]> {
                let $tree = self;
                $tracer.$corners(triangle)
            }

            fn closest_with(
                &self,
                ray: &$crate::geometry::Ray,
                conditions: $crate::traverse::Conditions<'_>,
            ) -> Option<$crate::geometry::Hit> {
                let $tree = self;
                $tracer.$closest(ray, conditions)
            }

            fn any_with(&self, ray: &$crate::geometry::Ray, conditions: $crate::traverse::Conditions<'_>) -> bool {
                let $tree = self;
                $tracer.$any(ray, conditions)
            }

            fn first_with(
                &self,
                ray: &$crate::geometry::Ray,
                most: usize,
                conditions: $crate::traverse::Conditions<'_>,
                hits: &mut Vec<$crate::geometry::Hit>,
            ) {
                let $tree = self;
                $tracer.$first(ray, most, conditions, hits);
            }

            fn exact_with(&self, query: &mut $crate::traverse::ExactQuery<'_>) {
                let $tree = self;
                $tracer.$exact(query);
            }

            fn nearest_with(
                &self,
                point: [f32; 3],
                max_distance: f32,
                conditions: $crate::traverse::Conditions<'_>,
            ) -> Option<$crate::traverse::NearestPoint> {
                let $tree = self;
                $tracer.$nearest(point, max_distance, conditions)
            }

            fn several_with(
                &self,
                point: [f32; 3],
                max_distance: f32,
                most: usize,
                conditions: $crate::traverse::Conditions<'_>,
                found: &mut Vec<$crate::traverse::NearestPoint>,
            ) {
                let $tree = self;
                $tracer.$several(point, max_distance, most, conditions, found);
            }

            fn closest_batch(&self, job: $crate::query::BatchJob<'_>, hits: &mut [Option<$crate::geometry::Hit>]) {
                let $tree = self;
                $tracer.$closest_batch(job, hits);
            }

            fn any_batch(&self, job: $crate::query::BatchJob<'_>, hits: &mut [bool]) {
                let $tree = self;
                $tracer.$any_batch(job, hits);
            }
        }
    };
    ($type:ty) => {
        $crate::query::tracer! {
            [] $type: |tree| tree;
            extent place triangle ask_closest ask_any ask_first walk_exact ask_nearest ask_several closest_hits any_hits
        }
    };
}
pub(crate) use tracer;
