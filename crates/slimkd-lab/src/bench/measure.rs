//! Timed passes over the rays, alternating the contenders in rounds.

use crate::bench::built::{Found, Interface, Traced};
use crate::workload::Workload;
use rayon::prelude::*;
use slimkd::Ray;
use std::time::{Duration, Instant};

/// Rays a task takes when several threads share a batch. Multiples of a tile stay whole.
const CHUNK: usize = 4096;

/// Output buffers as long as the longest batch, shared by all passes.
#[derive(Clone, Debug, Default)]
pub struct Buffers {
    found: Vec<Found>,
    blocked: Vec<bool>,
}

impl Buffers {
    /// Buffers for batches of at most `rays`.
    pub fn new(rays: usize) -> Self {
        Self { found: vec![Found::MISS; rays], blocked: vec![false; rays] }
    }

    /// Traces all rays once; returns the closest hits, or for an any-hit workload nothing.
    pub fn closest(&mut self, traced: &dyn Traced, interface: Interface, rays: &[Ray]) -> &[Found] {
        let found = &mut self.found[..rays.len()];
        found.fill(Found::MISS);
        traced.closest_through(interface, rays, found);
        found
    }

    /// Traces all rays once; returns whether each is blocked.
    pub fn any(&mut self, traced: &dyn Traced, interface: Interface, rays: &[Ray]) -> &[bool] {
        let blocked = &mut self.blocked[..rays.len()];
        blocked.fill(false);
        traced.any_through(interface, rays, blocked);
        blocked
    }

    /// Seconds for all rays of a workload; on the calling thread alone without a pool.
    fn time(
        &mut self,
        traced: &dyn Traced,
        interface: Interface,
        workload: &Workload,
        pool: Option<&rayon::ThreadPool>,
    ) -> f64 {
        let rays = &workload.rays[..];
        let found = &mut self.found[..rays.len()];
        let blocked = &mut self.blocked[..rays.len()];
        let start = Instant::now();
        // What is not counted is spread over all threads.
        let uncounted: Duration = match (pool, workload.kind.is_any()) {
            (None, false) => traced.closest_through(interface, rays, found),
            (None, true) => traced.any_through(interface, rays, blocked),
            (Some(pool), false) => pool.install(|| {
                let batches = rays.par_chunks(CHUNK).zip(found.par_chunks_mut(CHUNK));
                batches.map(|(rays, found)| traced.closest_through(interface, rays, found)).sum()
            }),
            (Some(pool), true) => pool.install(|| {
                let batches = rays.par_chunks(CHUNK).zip(blocked.par_chunks_mut(CHUNK));
                batches.map(|(rays, blocked)| traced.any_through(interface, rays, blocked)).sum()
            }),
        };
        let elapsed = start.elapsed().as_secs_f64();
        std::hint::black_box((&self.found, &self.blocked));
        let threads = pool.map_or(1, rayon::ThreadPool::current_num_threads);
        elapsed - uncounted.as_secs_f64() / threads as f64
    }
}

/// One contender at one workload with one number of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Position among the contenders.
    pub contender: usize,
    /// How rays are handed over.
    pub interface: Interface,
    /// Position among the workloads.
    pub workload: usize,
    /// Threads that traced.
    pub threads: usize,
    /// Wall-clock seconds of each round.
    pub seconds: Vec<f64>,
}

/// Who goes at which place of a round: another one first each round, so that nobody always follows the same neighbour.
fn order(contenders: usize, round: usize) -> impl Iterator<Item = usize> {
    (0..contenders).map(move |place| (place + round) % contenders)
}

/// Measures all contenders on all workloads that have rays. Whoever stands beside each other in time stands beside each
/// other in the figures: within a round, a workload is traced by all contenders before the next one is. Of their
/// interfaces, those take part that are made for a workload and `wanted`.
/// `progress` hears the number of each round before it begins.
pub fn measure(
    contenders: &[&dyn Traced],
    workloads: &[Workload],
    threads: &[usize],
    rounds: usize,
    wanted: impl Fn(Interface) -> bool,
    mut progress: impl FnMut(usize),
) -> Result<Vec<Series>, rayon::ThreadPoolBuildError> {
    let pools: Vec<Option<rayon::ThreadPool>> = threads
        .iter()
        .map(|&n| (n > 1).then(|| rayon::ThreadPoolBuilder::new().num_threads(n).build()).transpose())
        .collect::<Result<_, _>>()?;
    let mut buffers = Buffers::new(workloads.iter().map(|w| w.rays.len()).max().unwrap_or(0));
    let mut series = Vec::new();
    for (workload, asked) in workloads.iter().enumerate().filter(|(_, w)| !w.rays.is_empty()) {
        for &threads in threads {
            for (contender, traced) in contenders.iter().enumerate() {
                for &interface in traced.interfaces().iter().filter(|i| i.takes(asked.kind) && wanted(**i)) {
                    series.push(Series { contender, interface, workload, threads, seconds: Vec::new() });
                }
            }
        }
    }
    for round in 0..rounds {
        progress(round);
        let beside = |a: &Series, b: &Series| (a.workload, a.threads) == (b.workload, b.threads);
        for block in series.chunk_by_mut(beside) {
            for place in order(block.len(), round) {
                let entry = &mut block[place];
                let pool = threads.iter().position(|&n| n == entry.threads).and_then(|k| pools[k].as_ref());
                let traced = contenders[entry.contender];
                entry.seconds.push(buffers.time(traced, entry.interface, &workloads[entry.workload], pool));
            }
        }
    }
    Ok(series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::built::Bytes;
    use crate::workload::Kind;
    use std::sync::Mutex;

    struct Logged<'a>(char, &'a Mutex<String>);

    impl Traced for Logged<'_> {
        fn closest(&self, _rays: &[Ray], _found: &mut [Found]) {
            self.1.lock().unwrap().push(self.0);
        }
        fn any(&self, _rays: &[Ray], _blocked: &mut [bool]) {
            self.1.lock().unwrap().push(self.0.to_ascii_uppercase());
        }
        fn bytes(&self, _counted: u64) -> Bytes {
            unreachable!("not asked")
        }
    }

    #[test]
    fn contenders_alternate_and_rotate() {
        let log = Mutex::new(String::new());
        let (a, b, c) = (Logged('a', &log), Logged('b', &log), Logged('c', &log));
        let rays = vec![Ray::new([0.0; 3], [1.0, 0.0, 0.0]); 3];
        let workloads = [
            Workload { kind: Kind::Primary, rays: rays.clone() },
            Workload { kind: Kind::Random, rays: Vec::new() },
            Workload { kind: Kind::Shadow, rays },
        ];
        let series = measure(&[&a, &b, &c], &workloads, &[1], 2, |_| true, |_| {}).unwrap();
        assert_eq!(*log.lock().unwrap(), "abcABCbcaBCA");
        assert_eq!(series.len(), 6);
        assert!(series.iter().all(|s| s.seconds.len() == 2 && s.workload != 1));
        let kept: Vec<usize> = series.iter().map(|s| s.contender).collect();
        assert_eq!(kept, [0, 1, 2, 0, 1, 2]);
    }

    #[test]
    fn several_threads_trace_every_ray() {
        struct Ones;
        impl Traced for Ones {
            fn closest(&self, rays: &[Ray], found: &mut [Found]) {
                assert_eq!(rays.len(), found.len());
                found.fill(Found { t: 1.0, triangle: 0 });
            }
            fn any(&self, _rays: &[Ray], blocked: &mut [bool]) {
                blocked.fill(true);
            }
            fn bytes(&self, _counted: u64) -> Bytes {
                unreachable!("not asked")
            }
        }
        let rays = vec![Ray::new([0.0; 3], [1.0, 0.0, 0.0]); 2 * CHUNK + 5];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let mut buffers = Buffers::new(rays.len());
        buffers.time(
            &Ones,
            Interface::Single,
            &Workload { kind: Kind::Random, rays: rays.clone() },
            Some(&pool),
        );
        buffers.time(&Ones, Interface::Single, &Workload { kind: Kind::Shadow, rays }, Some(&pool));
        assert!(buffers.found.iter().all(Found::is_hit));
        assert!(buffers.blocked.iter().all(|&b| b));
    }
}
