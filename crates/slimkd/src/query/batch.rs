//! Questions about many rays or points at once.

use super::inside::{self, RowBuffer};
use super::{Crossings, Grid, Hits, Rays, Segment, Tracer};
use crate::geometry::{ExactRay, Hit, HitF64, Ray, RayF64};
use crate::simd::InstructionSet;
use crate::threads;
use crate::traverse::{Conditions, ExactQuery, NearestPoint, RayConditions};
use std::convert::Infallible;
use std::ops::Range;

/// How many rays are gathered from columns, or hits scattered to them, at a time: 32 KB of rays.
const GATHERED: usize = 1024;
/// The least and the most rays that one thread takes at a time; multiples of the 64 rays that are traced together.
const RAYS_A_PIECE: Range<usize> = 4096..65_536;

/// A question about many rays or points, with options: make it by [`Tracer::batch`], set options, then call a verb.
///
/// Each answer is the one that the ray would get alone, to the last bit. Only the time differs: batches go through the tree by
/// vector instructions, several rays at a time.
///
/// ```
/// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [8.0, 0.0, 0.0], [0.0, 8.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let pixel = |i: usize| [(i % 8) as f32, (i / 8) as f32, -9.0];
/// let rays: Vec<Ray> = (0..64).map(|i| Ray::new([0.0, 0.0, 9.0], pixel(i))).collect();
/// let mut hits = vec![None; rays.len()];
/// tree.batch().coherent().threads(0).closest(&rays, &mut hits);
/// assert!(rays.iter().zip(hits).all(|(ray, hit)| hit == tree.closest(ray)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy)]
#[must_use = "a batch does nothing until a verb such as `closest` is called"]
pub struct Batch<'a> {
    tracer: &'a (dyn Tracer + 'a),
    conditions: RayConditions<'a>,
    coherent: bool,
    /// Segments are closed.
    closed: bool,
    threads: usize,
    instruction_set: InstructionSet,
}

/// Rays for one thread, with all that concerns them.
#[derive(Clone, Copy)]
pub struct BatchJob<'a> {
    pub(crate) rays: &'a [Ray],
    pub(crate) conditions: RayConditions<'a>,
    pub(crate) coherent: bool,
    pub(crate) instruction_set: InstructionSet,
}

impl<'a> Batch<'a> {
    pub(super) fn new(tracer: &'a (dyn Tracer + 'a)) -> Self {
        let instruction_set = InstructionSet::best();
        let conditions = RayConditions::default();
        Self { tracer, conditions, coherent: false, closed: false, threads: 1, instruction_set }
    }

    /// Says that neighbours in the batch go much the same way, as a camera's rays do, or rays from neighbouring points to one light.
    /// They are then traced 64 at a time, which is faster. Order the batch so that neighbours are neighbours: one tile of
    /// 8 × 8 pixels after the other, not rows of the picture. Rays that go different ways after all cost time, never a hit.
    pub fn coherent(mut self) -> Self {
        self.coherent = true;
        self
    }

    /// Leaves out one triangle for each ray: the one that the ray starts on. `triangles` has one id for each ray of the batch, in the
    /// batch's order; `u32::MAX` leaves out none. The kernels themselves leave it out: no ray is
    /// traced again.
    ///
    /// ```
    /// use slimkd::{BuildOptions, KdTree, Ray, Tracer, TriangleMesh};
    /// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let tree = KdTree::build(mesh, &BuildOptions::default())?;
    /// let rays = [Ray::new([0.2, 0.2, 0.0], [0.0, 0.0, 1.0]); 2];
    /// let mut occluded = [false; 2];
    /// tree.batch().except(&[0, u32::MAX]).any(&rays, &mut occluded);
    /// assert_eq!(occluded, [false, true]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn except(mut self, triangles: &'a [u32]) -> Self {
        self.conditions.except = Some(triangles);
        self
    }

    /// Counts only hits for which `accept` returns `true`. Its first argument is the ray's position in the batch. Several threads may
    /// call it at once; for the order and the number of its calls, see [`Query::filter`](crate::Query::filter).
    ///
    /// Where each ray must leave out more than one triangle, this replaces [`Batch::except`]: coherent batches are slower with it, as
    /// they are traced like others then.
    pub fn filter(mut self, accept: &'a (dyn Fn(usize, &Hit) -> bool + Sync)) -> Self {
        self.conditions.filter = Some(accept);
        self
    }

    /// Makes the segments of [`Batch::visible`] closed: triangles on which their ends lie hide the ends as well.
    pub fn closed(mut self) -> Self {
        self.closed = true;
        self
    }

    /// Traces on `count` threads: 1 (the default) is the calling thread alone, 0 is all threads of the current rayon pool. With any
    /// other number, each call of a verb starts a pool of its own, so 0 suits many small batches better. A batch of at most 4096
    /// rays is never divided. Without the feature `rayon`, and where no threads can be started, the calling thread does all the
    /// work.
    pub fn threads(mut self, count: usize) -> Self {
        self.threads = count;
        self
    }

    /// Traces by this instruction set instead of [`InstructionSet::best`]. Where the processor lacks it, the next lower one that the
    /// processor has is taken.
    pub fn instruction_set(mut self, set: InstructionSet) -> Self {
        self.instruction_set = set.or_below();
        self
    }

    /// [`Tracer::closest`] of each ray: writes the hit of ray `i` to place `i` of `hits`.
    ///
    /// # Panics
    /// When `hits`, or the slice given to [`Batch::except`], is not as long as `rays`.
    pub fn closest<'r, 'h>(&self, rays: impl Into<Rays<'r>>, hits: impl Into<Hits<'h>>) {
        let (rays, mut rest) = (rays.into(), hits.into());
        self.check(rays.len(), rest.len());
        let mut pieces = Vec::new();
        for range in self.pieces(rays.len()) {
            let (piece, behind) = rest.split_at(range.len());
            pieces.push((range, piece));
            rest = behind;
        }
        self.spread(pieces, |(range, hits)| self.closest_piece(rays, range, hits));
    }

    /// [`Tracer::any`] of each ray: `hits[i]` becomes `true` where ray `i` hits anything.
    ///
    /// # Panics
    /// When `hits`, or the slice given to [`Batch::except`], is not as long as `rays`.
    pub fn any<'r>(&self, rays: impl Into<Rays<'r>>, hits: &mut [bool]) {
        let rays = rays.into();
        self.check(rays.len(), hits.len());
        self.spread(self.with_pieces(hits), |(range, hits)| {
            self.for_slices(rays, range, |job, at| self.tracer.any_batch(job, &mut hits[at]));
        });
    }

    /// [`Tracer::count`] of each ray: `counts[i]` becomes the number of triangles that ray `i` hits. Each ray is traced alone.
    ///
    /// # Panics
    /// When `counts`, or the slice given to [`Batch::except`], is not as long as `rays`.
    pub fn count<'r>(&self, rays: impl Into<Rays<'r>>, counts: &mut [u32]) {
        let rays = rays.into();
        self.check(rays.len(), counts.len());
        self.spread(self.with_pieces(counts), |(range, counts)| {
            let mut hits = Vec::new();
            for (at, count) in range.zip(counts) {
                self.first_of(rays, at, usize::MAX, &mut hits);
                *count = hits.len() as u32;
            }
        });
    }

    /// [`Tracer::crossings`] of each ray: `crossings[i]` becomes the answer for ray `i`. Each ray is traced alone. Excluded triangles and
    /// filters do not apply.
    ///
    /// # Panics
    /// When `crossings` is not as long as `rays`.
    pub fn crossings<'r>(&self, rays: impl Into<Rays<'r>>, crossings: &mut [Crossings]) {
        let rays = rays.into();
        self.check(rays.len(), crossings.len());
        self.spread(self.with_pieces(crossings), |(range, crossings)| {
            let mut found = Vec::new();
            for (at, crossings) in range.zip(crossings) {
                *crossings = Crossings::of(self.tracer, &rays.get(at), &mut found);
            }
        });
    }

    /// [`Tracer::contains`] of each point: `inside[i]` becomes the answer for `points[i]`. For the points of a grid, [`Batch::occupancy`]
    /// is faster. Excluded triangles and filters do not apply.
    ///
    /// # Panics
    /// When `inside` is not as long as `points`.
    pub fn contains(&self, points: &[[f32; 3]], inside: &mut [bool]) {
        self.check(points.len(), inside.len());
        self.spread(self.with_pieces(inside), |(range, inside)| {
            let mut found = Vec::new();
            for (point, inside) in points[range].iter().zip(inside) {
                *inside = inside::contains(self.tracer, point.map(f64::from), &mut found);
            }
        });
    }

    /// [`Tracer::signed_distance`] of each point: `distances[i]` becomes the answer for `points[i]`, NaN where there is none. Excluded
    /// triangles and filters do not apply.
    ///
    /// # Panics
    /// When `distances` is not as long as `points`.
    pub fn signed_distance(&self, points: &[[f32; 3]], distances: &mut [f32]) {
        self.check(points.len(), distances.len());
        self.spread(self.with_pieces(distances), |(range, distances)| {
            let mut found = Vec::new();
            for (point, distance) in points[range].iter().zip(distances) {
                *distance = inside::signed_distance(self.tracer, *point, &mut found);
            }
        });
    }

    /// Which points of a grid are inside the surface or on it, as [`Tracer::contains`] says: `inside[i]` becomes the answer for `grid.point(i)`. One
    /// ray answers a whole row of the grid along x. Excluded triangles and filters do not apply.
    ///
    /// ```
    /// use slimkd::{BuildOptions, Grid, KdTree, Tracer, TriangleMesh};
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    /// let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// let tree = KdTree::build(TriangleMesh::new(corners, faces)?, &BuildOptions::default())?;
    /// let grid = Grid::over(&tree.bounds(), 1.0);
    /// let mut inside = vec![false; grid.len()];
    /// tree.batch().threads(0).occupancy(&grid, &mut inside);
    /// assert_eq!(inside.iter().filter(|&&inside| inside).count(), 10);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Panics
    /// When `inside` is not as long as the grid.
    pub fn occupancy(&self, grid: &Grid, inside: &mut [bool]) {
        self.check(grid.len(), inside.len());
        if grid.is_empty() {
            return;
        }
        let rows = grid.size[1] * grid.size[2];
        // About eight pieces a thread, as for rays, but a row is much work.
        let piece = rows.div_ceil(8 * self.thread_count()).max(1);
        let pieces = inside.chunks_mut(piece * grid.size[0]).enumerate().collect();
        self.spread(pieces, |(at, inside): (usize, &mut [bool])| {
            let mut buffer = RowBuffer::default();
            for (row, inside) in (at * piece..).zip(inside.chunks_mut(grid.size[0])) {
                buffer.fill(self.tracer, grid, row, inside);
            }
        });
    }

    /// Whether nothing lies between the ends of each segment: `visible[i]` becomes the answer for `segments[i]`.
    ///
    /// Segments are open at both ends: a triangle on which an end lies hides nothing. As ends are rounded, such a triangle is one that is no
    /// farther from an end than 2⁻²² of the segment's largest coordinate: 0.24 µm in a room of 1 m, 0.24 mm at 1 km. Give ends as exactly as f32 allows,
    /// by [`Hit::point`]. [`Batch::closed`] makes segments closed. Otherwise, the segment hides what its ray from `from` in the
    /// direction `to − from` hits over [0, 1]. A segment whose ends are equal or not finite meets nothing.
    ///
    /// # Panics
    /// When `visible`, or the slice given to [`Batch::except`], is not as long as `segments`.
    pub fn visible(&self, segments: &[Segment], visible: &mut [bool]) {
        self.check(segments.len(), visible.len());
        self.spread(self.with_pieces(visible), |(range, visible)| {
            let mut rays = Vec::with_capacity(GATHERED.min(range.len()));
            for first in range.clone().step_by(GATHERED) {
                let part = first..range.end.min(first + GATHERED);
                let hidden = &mut visible[part.start - range.start..part.end - range.start];
                rays.clear();
                rays.extend(segments[part.clone()].iter().map(Segment::ray));
                let between = |at: usize, hit: &Hit| {
                    let on_end = self
                        .tracer
                        .corners(hit.triangle)
                        .is_some_and(|corners| segments[at].ends_on(&corners));
                    !on_end && self.conditions.filter.is_none_or(|accept| accept(at, hit))
                };
                let mut job = self.job(&rays, part);
                if !self.closed {
                    job.conditions.filter = Some(&between);
                }
                self.tracer.any_batch(job, hidden);
                hidden.iter_mut().for_each(|hidden| *hidden = !*hidden);
            }
        });
    }

    /// [`Query::first`](crate::Query::first) of each ray, ray after ray: at most `most` hits a ray. Each ray is traced alone.
    ///
    /// # Panics
    /// When the slice given to [`Batch::except`] is not as long as `rays`.
    pub fn first<'r>(&self, rays: impl Into<Rays<'r>>, most: usize) -> BatchHits {
        self.collect(rays.into(), most)
    }

    /// [`Tracer::all`] of each ray, ray after ray. Each ray is traced alone.
    ///
    /// # Panics
    /// When the slice given to [`Batch::except`] is not as long as `rays`.
    pub fn all<'r>(&self, rays: impl Into<Rays<'r>>) -> BatchHits {
        self.collect(rays.into(), usize::MAX)
    }

    fn collect(&self, rays: Rays<'_>, most: usize) -> BatchHits {
        self.check(rays.len(), rays.len());
        let mut parts: Vec<BatchHits> = Vec::new();
        let ranges: Vec<_> = self.pieces(rays.len()).collect();
        parts.resize_with(ranges.len(), BatchHits::default);
        self.spread(ranges.into_iter().zip(&mut parts).collect(), |(range, part)| {
            let mut hits = Vec::new();
            for at in range {
                self.first_of(rays, at, most, &mut hits);
                part.hits.extend_from_slice(&hits);
                part.splits.push(part.hits.len());
            }
        });
        let mut whole = BatchHits { splits: vec![0], hits: Vec::new() };
        for part in parts {
            let before = whole.hits.len();
            whole.splits.extend(part.splits.into_iter().map(|split| before + split));
            whole.hits.extend(part.hits);
        }
        whole
    }

    /// [`Tracer::nearest`] of each point: `found[i]` becomes the answer for `points[i]`. Each point is searched for alone.
    ///
    /// # Panics
    /// When `found`, or the slice given to [`Batch::except`], is not as long as `points`.
    pub fn nearest(&self, points: &[[f32; 3]], max_distance: f32, found: &mut [Option<NearestPoint>]) {
        self.check(points.len(), found.len());
        self.spread(self.with_pieces(found), |(range, found)| {
            for (at, found) in range.zip(found) {
                let ask = |conditions: Conditions<'_>| {
                    self.tracer.nearest_with(points[at], max_distance, conditions)
                };
                *found = self.conditions.alone(at, ask);
            }
        });
    }

    /// [`Tracer::closest_f64`] of each ray: `hits[i]` becomes the hit of ray `i`. Each ray is traced alone. A filter gets hits rounded to f32.
    ///
    /// # Panics
    /// When `hits`, or the slice given to [`Batch::except`], is not as long as `rays`.
    pub fn closest_f64(&self, rays: &[RayF64], hits: &mut [Option<HitF64>]) {
        self.check(rays.len(), hits.len());
        self.spread(self.with_pieces(hits), |(range, hits)| {
            for (at, hit) in range.zip(hits) {
                *hit = self.exact_hit(at, &rays[at], false);
            }
        });
    }

    /// [`Tracer::any_f64`] of each ray: `hits[i]` becomes `true` where ray `i` hits anything. Each ray is traced alone. A filter gets hits
    /// rounded to f32.
    ///
    /// # Panics
    /// When `hits`, or the slice given to [`Batch::except`], is not as long as `rays`.
    pub fn any_f64(&self, rays: &[RayF64], hits: &mut [bool]) {
        self.check(rays.len(), hits.len());
        self.spread(self.with_pieces(hits), |(range, hits)| {
            for (at, hit) in range.zip(hits) {
                *hit = self.exact_hit(at, &rays[at], true).is_some();
            }
        });
    }

    /// The nearest hit, or any, of the ray at position `at` of the batch.
    fn exact_hit(&self, at: usize, ray: &RayF64, any: bool) -> Option<HitF64> {
        let ray = ExactRay::in_world(ray, self.tracer.origin())?;
        self.conditions.alone(at, |conditions| {
            let ask = if any { ExactQuery::any } else { ExactQuery::closest };
            let mut query = ask(ray, conditions);
            self.tracer.exact_with(&mut query);
            query.into_hit()
        })
    }

    fn check(&self, rays: usize, answers: usize) {
        assert_eq!(rays, answers, "one place for an answer for each ray");
        assert!(
            self.conditions.except.is_none_or(|except| except.len() == rays),
            "one exception for each ray"
        );
    }

    /// Writes the first hits of the ray at position `at` of the batch over what `hits` held.
    fn first_of(&self, rays: Rays<'_>, at: usize, most: usize, hits: &mut Vec<Hit>) {
        let ray = rays.get(at);
        hits.clear();
        self.conditions.alone(at, |conditions| self.tracer.first_with(&ray, most, conditions, hits));
    }

    fn closest_piece(&self, rays: Rays<'_>, range: Range<usize>, hits: Hits<'_>) {
        match hits {
            Hits::Slice(hits) => {
                self.for_slices(rays, range, |job, at| self.tracer.closest_batch(job, &mut hits[at]));
            }
            Hits::Columns(mut columns) => {
                let mut buffer = [None; GATHERED];
                for first in range.clone().step_by(GATHERED) {
                    let part = first..range.end.min(first + GATHERED);
                    let hits = &mut buffer[..part.len()];
                    self.for_slices(rays, part, |job, at| self.tracer.closest_batch(job, &mut hits[at]));
                    let at = first - range.start;
                    hits.iter().enumerate().for_each(|(k, hit)| columns.put(at + k, *hit));
                }
            }
        }
    }

    /// Calls `trace` with the rays of a range as slices, and with their places in that range.
    fn for_slices(
        &self,
        rays: Rays<'_>,
        range: Range<usize>,
        mut trace: impl FnMut(BatchJob<'_>, Range<usize>),
    ) {
        match rays {
            Rays::Slice(rays) => {
                let length = range.len();
                trace(self.job(&rays[range.clone()], range), 0..length);
            }
            Rays::Columns(columns) => {
                let mut buffer = Vec::with_capacity(GATHERED);
                for first in range.clone().step_by(GATHERED) {
                    let part = first..range.end.min(first + GATHERED);
                    buffer.clear();
                    buffer.extend(part.clone().map(|at| columns.ray(at)));
                    let places = part.start - range.start..part.end - range.start;
                    trace(self.job(&buffer, part), places);
                }
            }
        }
    }

    fn job<'r>(&'r self, rays: &'r [Ray], range: Range<usize>) -> BatchJob<'r> {
        let conditions = self.conditions.of(range);
        BatchJob { rays, conditions, coherent: self.coherent, instruction_set: self.instruction_set }
    }

    fn thread_count(&self) -> usize {
        if self.threads == 0 { threads::count() } else { self.threads }
    }

    /// Cuts a batch into the ranges of rays that threads take one after the other: about eight for each thread, so that none waits
    /// long for the last one.
    fn pieces(&self, rays: usize) -> impl Iterator<Item = Range<usize>> + use<> {
        let threads = self.thread_count();
        let piece = match threads {
            1 => rays.max(1),
            _ => (rays / (8 * threads)).clamp(RAYS_A_PIECE.start, RAYS_A_PIECE.end).next_multiple_of(64),
        };
        (0..rays).step_by(piece).map(move |first| first..rays.min(first + piece))
    }

    /// The ranges of [`Batch::pieces`], each with its part of the answers.
    fn with_pieces<'h, A>(&self, mut answers: &'h mut [A]) -> Vec<(Range<usize>, &'h mut [A])> {
        let mut pieces = Vec::new();
        for range in self.pieces(answers.len()) {
            let (piece, behind) = answers.split_at_mut(range.len());
            pieces.push((range, piece));
            answers = behind;
        }
        pieces
    }

    /// Does the work of all pieces, on the threads that were asked for.
    fn spread<P: Send>(&self, pieces: Vec<P>, work: impl Fn(P) + Sync + Send) {
        if self.threads == 1 || pieces.len() <= 1 {
            return pieces.into_iter().for_each(work);
        }
        let all = || {
            let done: Result<Vec<()>, Infallible> = threads::map(pieces, |piece| {
                work(piece);
                Ok(())
            });
            done.map_or_else(|never| match never {}, drop);
        };
        match self.threads {
            0 => all(),
            count => threads::with(count, all).unwrap_or_else(|refused| (refused.work)()),
        }
    }
}

impl std::fmt::Debug for Batch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Batch")
            .field("coherent", &self.coherent)
            .field("threads", &self.threads)
            .field("instruction_set", &self.instruction_set)
            .finish_non_exhaustive()
    }
}

/// All hits of a batch's rays, ray after ray.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BatchHits {
    /// Where each ray's hits begin in `hits`, and at the end the number of all hits: one more than there are rays.
    pub splits: Vec<usize>,
    /// The hits of all rays, each ray's sorted by `t` and then by triangle id.
    pub hits: Vec<Hit>,
}

impl BatchHits {
    /// The hits of one ray.
    ///
    /// # Panics
    /// When the batch had no ray at this position.
    pub fn of(&self, ray: usize) -> &[Hit] {
        &self.hits[self.splits[ray]..self.splits[ray + 1]]
    }
}
