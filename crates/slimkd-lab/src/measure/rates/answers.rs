//! Rates of trees that must agree: every answer is compared before the clock runs, then the trees take turns.

use super::{Kernel, Named, RayTracer};
use crate::basics::{Progress, ReportError};
use crate::workload::{Found, Workload};
use rayon::ThreadPool;
use rayon::prelude::*;
use slimkd::Tracer as _;
use slimkd::{Hit, KdTree, Ray};
use std::time::Instant;

/// Rays that a thread takes at a time.
const CHUNK: usize = 1024;

/// Room for the answers to a workload, so that no run allocates.
#[derive(Default)]
pub(super) struct Answers {
    kernel: Kernel,
    closest: Vec<Option<Hit>>,
    any: Vec<bool>,
}

impl Answers {
    /// To be traced by `kernel`; the default is ray by ray.
    pub(super) fn with(kernel: Kernel) -> Self {
        Self { kernel, ..Self::default() }
    }

    /// Traces `rays`, in the pool's threads; the seconds that it took. Fails when it is cancelled only.
    pub(super) fn trace(
        &mut self,
        progress: &Progress,
        pool: &ThreadPool,
        tree: &KdTree,
        rays: &[Ray],
        any: bool,
    ) -> Result<f64, ReportError> {
        let kernel = self.kernel;
        if any {
            self.any.resize(rays.len(), false);
            time(progress, pool, rays, &mut self.any, |rays, hits| kernel.any(tree, rays, hits))
        } else {
            self.closest.resize(rays.len(), None);
            time(progress, pool, rays, &mut self.closest, |rays, hits| kernel.closest(tree, rays, hits))
        }
    }

    /// The same on a device; the seconds of its kernels.
    pub(super) fn trace_on(
        &mut self,
        progress: &Progress,
        device: &dyn RayTracer,
        rays: &[Ray],
        any: bool,
    ) -> Result<f64, ReportError> {
        progress.check()?;
        if any {
            self.any.resize(rays.len(), false);
            device.any(rays, &mut self.any)
        } else {
            self.closest.resize(rays.len(), None);
            device.closest(rays, &mut self.closest)
        }
        .map_err(ReportError::Device)
    }

    /// The closest hits of the last trace of closest hits, as far as workloads need them.
    pub(super) fn found(&self) -> impl Iterator<Item = Found> {
        let found = |hit: Hit| Found { t: hit.t, triangle: hit.triangle };
        self.closest.iter().map(move |hit| hit.map_or(Found::MISS, found))
    }

    /// How many of a workload's rays hit.
    fn count(&self, any: bool) -> usize {
        if any { self.any.iter().filter(|&&hit| hit).count() } else { self.closest.iter().flatten().count() }
    }

    /// The first ray whose answer differs from `other`'s, by a single bit.
    fn difference(&self, other: &Self, any: bool) -> Option<usize> {
        let bits = |hit: &Option<Hit>| hit.map(|hit| (hit.triangle, [hit.t, hit.u, hit.v].map(f32::to_bits)));
        if any {
            self.any.iter().zip(&other.any).position(|(a, b)| a != b)
        } else {
            self.closest.iter().zip(&other.closest).position(|(a, b)| bits(a) != bits(b))
        }
    }

    fn show(&self, any: bool, index: usize) -> String {
        if any {
            return format!("hit: {}", self.any[index]);
        }
        self.closest[index].map_or("a miss".to_owned(), |hit| {
            format!("triangle {}, t {:?}, u {:?}, v {:?}", hit.triangle, hit.t, hit.u, hit.v)
        })
    }
}

fn time<T: Send>(
    progress: &Progress,
    pool: &ThreadPool,
    rays: &[Ray],
    hits: &mut [T],
    trace: impl Fn(&[Ray], &mut [T]) + Sync,
) -> Result<f64, ReportError> {
    let chunks = rays.par_chunks(CHUNK).zip(hits.par_chunks_mut(CHUNK));
    let started = Instant::now();
    pool.install(|| {
        chunks.for_each(|(rays, hits)| {
            // One relaxed load in a thousand rays costs nothing, and whoever cancels need not wait for the rest.
            if !progress.is_cancelled() {
                trace(rays, hits);
            }
        });
    });
    let seconds = started.elapsed().as_secs_f64();
    progress.check()?;
    Ok(seconds)
}

/// Compares a device's answers to a workload with those of the CPU: the same but for what the device may err by. How many of its
/// rays hit.
pub(super) fn agree_with_cpu(
    progress: &Progress,
    pool: &ThreadPool,
    tree: &KdTree,
    devices: &[Box<dyn RayTracer + '_>],
    workload: &Workload,
) -> Result<usize, ReportError> {
    let (mut cpu, mut other) = (Answers::default(), Answers::default());
    let (name, any, rays) = (workload.kind.name(), workload.kind.is_any(), &workload.rays);
    cpu.trace(progress, pool, tree, rays, false)?;
    let bounds = tree.bounds();
    for device in devices {
        other.trace_on(progress, device.as_ref(), rays, any)?;
        let wrong = (0..rays.len()).find(|&index| {
            let (ray, wanted) = (&rays[index], cpu.closest[index]);
            let bound = |t: f32| device.t_bound(ray, &bounds, t);
            let near = |a: f32, b: f32| (a - b).abs() <= bound(a);
            if any {
                // The same but where a hit lies at an end of the range.
                let moved = |t: f32, by: f32| if t.is_finite() { t + by * bound(t) } else { t };
                let ends = |by: f32| ray.with_range(moved(ray.t_min, -by), moved(ray.t_max, by));
                return other.any[index] != wanted.is_some() && tree.any(&ends(1.0)) == tree.any(&ends(-1.0));
            }
            let found = other.closest[index];
            let same = match (wanted, found) {
                (Some(wanted), Some(found)) => near(wanted.t, found.t),
                (wanted, found) => wanted.is_some() == found.is_some(),
            };
            let at_an_end = |hit: Hit| near(hit.t, ray.t_min) || near(hit.t, ray.t_max);
            !same && !wanted.is_some_and(at_an_end) && !found.is_some_and(at_an_end)
        });
        if let Some(ray) = wrong {
            return Err(ReportError::Answers(format!(
                "the GPU answers {name} ray {ray} unlike the CPU ({} and {}), so no rate is reported; \
                 this is a bug in slimkd or in the GPU's driver, please report it with {:?}",
                other.show(any, ray),
                cpu.show(false, ray),
                rays[ray]
            )));
        }
    }
    Ok(other.count(any))
}

/// Compares the answers of all trees, traced by `kernel`, to a workload with those of the first one ray by ray; how many
/// rays hit.
pub(super) fn agree(
    progress: &Progress,
    pool: &ThreadPool,
    trees: &[Named<'_>],
    kernel: Kernel,
    workload: &Workload,
) -> Result<usize, ReportError> {
    let (mut first, mut other) = (Answers::default(), Answers::with(kernel));
    let (name, any, rays) = (workload.kind.name(), workload.kind.is_any(), &workload.rays);
    first.trace(progress, pool, trees[0].1, rays, any)?;
    for (index, (preset, tree)) in trees.iter().enumerate() {
        if index == 0 && kernel == Kernel::Single {
            continue;
        }
        other.trace(progress, pool, tree, rays, any)?;
        if let Some(ray) = first.difference(&other, any) {
            return Err(ReportError::Answers(format!(
                "{preset} and {} answer {name} ray {ray} differently ({} and {}), so no rate is reported; \
                 this is a bug in slimkd, please report it with {:?}",
                trees[0].0,
                other.show(any, ray),
                first.show(any, ray),
                rays[ray]
            )));
        }
    }
    Ok(first.count(any))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workload::Kind;
    use slimkd::{BuildOptions, TriangleMesh};

    fn tree(height: f32) -> KdTree {
        let vertices = vec![[0.0, 0.0, height], [1.0, 0.0, height], [0.0, 1.0, height]];
        KdTree::build(TriangleMesh::new(vertices, vec![[0, 1, 2]]).unwrap(), &BuildOptions::default())
            .unwrap()
    }

    fn workload(any: bool) -> Workload {
        let rays = (0..100).map(|k| Ray::new([k as f32 * 0.01, 0.2, 5.0], [0.0, 0.0, -1.0])).collect();
        Workload { kind: if any { Kind::Shadow } else { Kind::Primary }, rays }
    }

    #[test]
    fn trees_that_differ_are_found_out() {
        let (a, b, c) = (tree(0.0), tree(0.0), tree(1.0));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        for (any, kernel) in [(false, Kernel::Single), (true, Kernel::Packet), (false, Kernel::Packet)] {
            let hits =
                agree(&Progress::new(), &pool, &[("a", &a), ("b", &b)], kernel, &workload(any)).unwrap();
            assert!((79..=82).contains(&hits), "{hits}");
        }
        let failure = agree(
            &Progress::new(),
            &pool,
            &[("a", &a), ("b", &b), ("c", &c)],
            Kernel::Single,
            &workload(false),
        )
        .unwrap_err();
        assert!(failure.to_string().starts_with("c and a answer primary ray 0 differently"), "{failure}");
        // Whether there is a hit is the same in both.
        assert!(
            agree(&Progress::new(), &pool, &[("a", &a), ("c", &c)], Kernel::Packet, &workload(true)).is_ok()
        );
    }
}
