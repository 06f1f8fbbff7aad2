//! Rates of trees over the workloads: every answer is compared before the clock runs, then the trees take turns.

mod answers;
mod kernel;

use crate::ReportError;
use crate::basics::median::median;
use crate::workload::{Found, Kind, Order, Recipe, Workload, generate_from, primary as primary_rays};
use answers::{Answers, agree, agree_with_cpu};
pub use kernel::Kernel;
use rayon::ThreadPool;
use slimkd::{Aabb, Hit, KdTree, Ray, TriangleMesh};
use slimkd_render::PinholeFrame;
use slimkd_scene::Camera;

/// Seconds of tracing that a run may take by default, building aside: five presets then stay below a minute.
const TIME: f64 = 40.0;
/// Longest single run, s: more rays would not make a rate more certain.
const LONGEST_RUN: f64 = 1.0;
/// Fewest rays of a workload, unless there are no more: fewer than this is noise.
const LEAST_RAYS: usize = 1 << 14;
/// Most rays of a workload: the pixels of one picture.
pub const MOST_RAYS: usize = PICTURE * PICTURE;
/// Number of workloads.
const WORKLOADS: usize = Kind::ALL.len();
/// Edge of the pictures that primary rays belong to, pixels.
const PICTURE: usize = 1024;
/// Seed of the bounces and of the random rays.
const SEED: u64 = 1;

/// A tree under its preset's name.
pub type Named<'a> = (&'a str, &'a KdTree);

/// What traces rays in the CPU's stead. Its errors are sentences.
pub trait RayDevice {
    /// The tree on it.
    fn tree<'d>(&'d self, tree: &KdTree) -> Result<Box<dyn RayTracer + 'd>, String>;
}

/// A tree on a device. All seconds are those of the kernels.
pub trait RayTracer {
    /// The closest hits.
    fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<f64, String>;
    /// How far its t may lie from the CPU's.
    fn t_bound(&self, ray: &Ray, bounds: &Aabb, t: f32) -> f32;
    /// Whether there are hits.
    fn any(&self, rays: &[Ray], hits: &mut [bool]) -> Result<f64, String>;
}

/// Hears how far a measurement has come, and can end it.
pub trait Watch: Sync {
    /// Whether to end with [`ReportError::Cancelled`] soon.
    fn is_cancelled(&self) -> bool {
        false
    }
    /// There will be this many more steps.
    fn expect(&self, _steps: usize) {}
    /// This many steps more are done.
    fn done(&self, _steps: usize) {}
    /// The answers to a workload were compared: its name, its rays, how many per cent of them hit, and what they are.
    fn compared(&self, _workload: &str, _rays: usize, _per_cent: f64, _alike: &str) {}
}

/// A rate.
#[derive(Clone, Copy, Debug)]
pub struct Rate<'a> {
    /// The tree's name.
    pub tree: &'a str,
    /// The workload's name.
    pub workload: &'static str,
    /// Its rays.
    pub rays: usize,
    /// How many of them hit.
    pub hits: usize,
    /// Million rays a second, the median of all rounds.
    pub mrays_per_s: f64,
}

/// What is measured, and with what.
pub struct Rates<'a> {
    /// The triangles.
    pub mesh: &'a TriangleMesh,
    /// The trees to compare; the first one decides where rays end and how many there are.
    pub trees: &'a [Named<'a>],
    /// From where the scene is seen.
    pub cameras: &'a [Camera],
    /// Traces on the CPU.
    pub pool: &'a ThreadPool,
    /// How it does that.
    pub kernel: Kernel,
    /// What traces in the CPU's stead.
    pub device: Option<&'a dyn RayDevice>,
    /// Rounds that the median is taken of.
    pub rounds: usize,
    /// Rays of a workload at most; as many as the time allows unless given.
    pub rays: Option<usize>,
    /// Who hears of it.
    pub watch: &'a dyn Watch,
}

impl<'a> Rates<'a> {
    /// The rates of all presets on all workloads.
    pub fn measure(&self) -> Result<Vec<Rate<'a>>, ReportError> {
        let uploaded = self.uploaded()?;
        let workloads = self.workloads(&uploaded)?;
        self.watch.expect(workloads.len() * (1 + self.rounds) * self.trees.len());
        let mut hits = Vec::new();
        for workload in &workloads {
            let (count, alike) = if uploaded.is_empty() {
                (
                    agree(self.watch, self.pool, self.trees, self.kernel, workload)?,
                    "the same with all presets",
                )
            } else {
                let count = agree_with_cpu(self.watch, self.pool, self.trees[0].1, &uploaded, workload)?;
                (count, "the CPU's with all presets")
            };
            self.watch.done(self.trees.len());
            let share = 100.0 * count as f64 / workload.rays.len().max(1) as f64;
            let (name, rays) = (workload.kind.name(), workload.rays.len());
            self.watch.compared(name, rays, share, alike);
            hits.push(count);
        }
        let mut answers = Answers::with(self.kernel);
        let mut rates = vec![vec![Vec::new(); self.trees.len()]; workloads.len()];
        for round in 0..self.rounds {
            for (workload, rates) in workloads.iter().zip(&mut rates) {
                for turn in 0..self.trees.len() {
                    // Another preset begins each time, so that none always runs in the wake of the same one.
                    let index = (turn + round) % self.trees.len();
                    let seconds =
                        self.trace(&mut answers, &uploaded, index, &workload.rays, workload.kind.is_any())?;
                    rates[index].push(workload.rays.len() as f64 / seconds.max(1e-9) / 1e6);
                    self.watch.done(1);
                }
            }
        }
        let mut results = Vec::new();
        for ((workload, hits), mut rates) in workloads.iter().zip(hits).zip(rates) {
            for ((preset, _), rates) in self.trees.iter().zip(&mut rates) {
                results.push(Rate {
                    tree: preset,
                    workload: workload.kind.name(),
                    rays: workload.rays.len(),
                    hits,
                    mrays_per_s: median(rates).unwrap_or(f64::NAN),
                });
            }
        }
        Ok(results)
    }

    /// All trees on the device; none for the CPU.
    fn uploaded(&self) -> Result<Vec<Box<dyn RayTracer + '_>>, ReportError> {
        let Some(device) = self.device else { return Ok(Vec::new()) };
        self.trees.iter().map(|(_, tree)| device.tree(tree).map_err(ReportError::Device)).collect()
    }

    /// Traces with tree number `index`, wherever that is done; the seconds that it took.
    fn trace(
        &self,
        answers: &mut Answers,
        uploaded: &[Box<dyn RayTracer + '_>],
        index: usize,
        rays: &[Ray],
        any: bool,
    ) -> Result<f64, ReportError> {
        match uploaded.get(index) {
            Some(tree) => answers.trace_on(self.watch, tree.as_ref(), rays, any),
            None => answers.trace(self.watch, self.pool, self.trees[index].1, rays, any),
        }
    }

    /// The rays, as many as the time allows.
    fn workloads(&self, uploaded: &[Box<dyn RayTracer + '_>]) -> Result<Vec<Workload>, ReportError> {
        let tree = self.trees[0].1;
        let most = self.rays.unwrap_or(MOST_RAYS);
        let views = self.cameras.iter().map(|&camera| camera.into()).collect();
        for camera in self.cameras {
            PinholeFrame::new(camera, 1.0).map_err(ReportError::Camera)?;
        }
        let order = Order::Scattered;
        let mut recipe = Recipe { views, size: PICTURE, order, random_rays: 0, seed: SEED };
        let mut primary = primary_rays(&recipe);
        primary.truncate(most);
        let count = self.affordable(uploaded, &primary, false)?;
        primary.truncate(count);
        recipe.random_rays = primary.len();
        let closest = |rays: &[Ray], found: &mut [Found]| {
            // Cancelling leaves misses; the next trace ends the measurement.
            let mut answers = Answers::with(self.kernel);
            if answers.trace(self.watch, self.pool, tree, rays, false).is_ok() {
                found.iter_mut().zip(answers.found()).for_each(|(found, hit)| *found = hit);
            }
        };
        let rays = generate_from(self.mesh, &closest, &recipe, primary, Kind::ALL);
        let mut workloads = rays.workloads;
        for workload in &mut workloads {
            let count = self.affordable(uploaded, &workload.rays, workload.kind.is_any())?;
            workload.rays.truncate(count);
        }
        // A workload without a ray has no rate: the camera sees nothing, or no light.
        workloads.retain(|workload| !workload.rays.is_empty());
        Ok(workloads)
    }

    /// How many of these rays one run should trace, from the rate of the first preset on the first of them.
    fn affordable(
        &self,
        uploaded: &[Box<dyn RayTracer + '_>],
        rays: &[Ray],
        any: bool,
    ) -> Result<usize, ReportError> {
        if self.rays.is_some() {
            return Ok(rays.len());
        }
        let runs = self.trees.len() * (self.rounds + 1) * WORKLOADS;
        let seconds = (TIME / runs as f64).min(LONGEST_RUN);
        let sample = &rays[..rays.len().min(LEAST_RAYS)];
        let mut answers = Answers::with(self.kernel);
        // The first run warms the caches.
        self.trace(&mut answers, uploaded, 0, &sample[..sample.len() / 2], any)?;
        let took = self.trace(&mut answers, uploaded, 0, sample, any)?;
        let count = (sample.len() as f64 / took.max(1e-9) * seconds) as usize;
        Ok(count.clamp(LEAST_RAYS, MOST_RAYS).min(rays.len()))
    }
}
