//! Rates of trees over the workloads: every answer is compared before the clock runs, then the trees take turns.

mod answers;
mod kernel;

use super::frames::{Device, Frame, frames};
use crate::basics::median::median;
use crate::basics::{Progress, ReportError};
use crate::schema::{FrameRate, Rate};
use crate::workload::{
    BLOCK_PIXELS, Found, Kind, Order, Recipe, Workload, generate_from, primary as primary_rays,
};
use answers::{Answers, agree, agree_with_cpu};
pub use kernel::Kernel;
use rayon::ThreadPool;
use slimkd::{Aabb, Hit, KdTree, Ray};
use slimkd_render::PinholeFrame;
use slimkd_scene::{Camera, Scene};

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

/// Hears that the answers to a workload were compared: its name, its rays, how many per cent of them hit, and what they are.
pub type Compared<'a> = dyn Fn(&str, usize, f64, &str) + 'a;

/// What is measured, and with what.
pub struct Rates<'a> {
    /// What is looked at.
    pub scene: &'a Scene,
    /// The trees to compare; the first one decides where rays end and how many there are.
    pub trees: &'a [Named<'a>],
    /// From where: views' numbers and cameras.
    pub views: &'a [(usize, Camera)],
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
}

impl Rates<'_> {
    /// The rates of all trees on all workloads.
    pub fn measure(&self, progress: &Progress, compared: &Compared<'_>) -> Result<Vec<Rate>, ReportError> {
        let run = Run { rates: self, uploaded: self.uploaded()?, progress };
        let workloads = run.workloads()?;
        progress.expect((workloads.len() * (1 + self.rounds) * self.trees.len()) as u64);
        let mut hits = Vec::new();
        for workload in &workloads {
            let (count, alike) = if run.uploaded.is_empty() {
                let count = agree(progress, self.pool, self.trees, self.kernel, workload)?;
                (count, "the same with all presets")
            } else {
                let count = agree_with_cpu(progress, self.pool, self.trees[0].1, &run.uploaded, workload)?;
                (count, "the CPU's with all presets")
            };
            progress.done(self.trees.len() as u64);
            let share = 100.0 * count as f64 / workload.rays.len().max(1) as f64;
            compared(workload.kind.name(), workload.rays.len(), share, alike);
            hits.push(count);
        }
        let mut answers = Answers::with(self.kernel);
        let mut rates = vec![vec![Vec::new(); self.trees.len()]; workloads.len()];
        for round in 0..self.rounds {
            for (workload, rates) in workloads.iter().zip(&mut rates) {
                for turn in 0..self.trees.len() {
                    // Another preset begins each time, so that none always runs in the wake of the same one.
                    let index = (turn + round) % self.trees.len();
                    let seconds = run.trace(&mut answers, index, &workload.rays, workload.kind.is_any())?;
                    rates[index].push(workload.rays.len() as f64 / seconds.max(1e-9) / 1e6);
                    progress.done(1);
                }
            }
        }
        let mut results = Vec::new();
        for ((workload, hits), rates) in workloads.iter().zip(hits).zip(rates) {
            for ((preset, _), rates) in self.trees.iter().zip(rates) {
                results.push(Rate {
                    preset: (*preset).to_owned(),
                    kernel: self.kernel.name(),
                    device: if self.device.is_some() { "gpu" } else { "cpu" },
                    // One waits for a GPU.
                    threads: if self.device.is_some() { 1 } else { self.pool.current_num_threads() },
                    workload: workload.kind.name(),
                    rays: workload.rays.len(),
                    hits,
                    mrays_per_s: median(&rates).unwrap_or(f64::NAN),
                });
            }
        }
        Ok(results)
    }

    /// Whitted's pictures a second of all trees, of each view; `size` is their width and height in pixels.
    pub fn frames(
        &self,
        device: &dyn Device,
        size: [u32; 2],
        progress: &Progress,
    ) -> Result<Vec<FrameRate>, ReportError> {
        progress.expect((self.views.len() * (1 + self.rounds) * self.trees.len()) as u64);
        let mut results = Vec::new();
        for &(view, camera) in self.views {
            let frame = Frame { scene: self.scene, view, camera, size };
            let done = || progress.done(1);
            let seconds = frames(device, &frame, self.trees, self.rounds, progress, &done)?;
            for ((preset, _), seconds) in self.trees.iter().zip(&seconds) {
                results.push(FrameRate {
                    preset: (*preset).to_owned(),
                    device: device.name().to_owned(),
                    threads: device.threads(),
                    view,
                    frames_per_s: median(seconds).map_or(f64::NAN, |seconds| 1.0 / seconds.max(1e-9)),
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
}

/// A measurement of rates under way.
struct Run<'a> {
    rates: &'a Rates<'a>,
    uploaded: Vec<Box<dyn RayTracer + 'a>>,
    progress: &'a Progress,
}

impl Run<'_> {
    /// Traces with tree number `index`, wherever that is done; the seconds that it took.
    fn trace(
        &self,
        answers: &mut Answers,
        index: usize,
        rays: &[Ray],
        any: bool,
    ) -> Result<f64, ReportError> {
        match self.uploaded.get(index) {
            Some(tree) => answers.trace_on(self.progress, tree.as_ref(), rays, any),
            None => answers.trace(self.progress, self.rates.pool, self.rates.trees[index].1, rays, any),
        }
    }

    /// The rays, as many as the time allows.
    fn workloads(&self) -> Result<Vec<Workload>, ReportError> {
        let Rates { scene, trees, views, pool, kernel, rays, .. } = *self.rates;
        for (_, camera) in views {
            PinholeFrame::new(camera, 1.0).map_err(ReportError::Camera)?;
        }
        let order = Order::Scattered { run: run_of(rays) };
        let views = views.iter().map(|&(_, camera)| camera.into()).collect();
        let mut recipe = Recipe { views, size: PICTURE, order, random_rays: 0, seed: SEED };
        let mut primary = primary_rays(&recipe);
        primary.truncate(rays.unwrap_or(MOST_RAYS));
        let count = self.affordable(&primary, false)?;
        primary.truncate(count);
        recipe.random_rays = primary.len();
        let closest = |rays: &[Ray], found: &mut [Found]| {
            // Cancelling leaves misses; the next trace ends the measurement.
            let mut answers = Answers::with(kernel);
            if answers.trace(self.progress, pool, trees[0].1, rays, false).is_ok() {
                found.iter_mut().zip(answers.found()).for_each(|(found, hit)| *found = hit);
            }
        };
        let rays = generate_from(&scene.mesh, &closest, &recipe, primary, Kind::ALL);
        let mut workloads = rays.workloads;
        for workload in &mut workloads {
            let count = self.affordable(&workload.rays, workload.kind.is_any())?;
            workload.rays.truncate(count);
        }
        // A workload without a ray has no rate: the camera sees nothing, or no light.
        workloads.retain(|workload| !workload.rays.is_empty());
        Ok(workloads)
    }

    /// How many of these rays one run should trace, from the rate of the first preset on the first of them.
    fn affordable(&self, rays: &[Ray], any: bool) -> Result<usize, ReportError> {
        if self.rates.rays.is_some() {
            return Ok(rays.len());
        }
        let runs = self.rates.trees.len() * (self.rates.rounds + 1) * WORKLOADS;
        let seconds = (TIME / runs as f64).min(LONGEST_RUN);
        let sample = &rays[..rays.len().min(LEAST_RAYS)];
        let mut answers = Answers::with(self.rates.kernel);
        // The first run warms the caches.
        self.trace(&mut answers, 0, &sample[..sample.len() / 2], any)?;
        let took = self.trace(&mut answers, 0, sample, any)?;
        let count = (sample.len() as f64 / took.max(1e-9) * seconds) as usize;
        Ok(count.clamp(LEAST_RAYS, MOST_RAYS).min(rays.len()))
    }
}

/// How many neighbouring pixels are visited at a time, so that few rays are spread over the whole picture too.
fn run_of(rays: Option<usize>) -> usize {
    /// Places that the rays are spread over at least, while there are as many rays.
    const PLACES: usize = 64;
    let most = rays.map_or(BLOCK_PIXELS, |rays| (rays / PLACES).clamp(1, BLOCK_PIXELS));
    1 << most.ilog2()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rays_are_spread_and_many_go_block_by_block() {
        assert_eq!([1, 100, 500, 2000, 65_535].map(|rays| run_of(Some(rays))), [1, 1, 4, 16, 512]);
        assert_eq!([None, Some(65_536), Some(MOST_RAYS)].map(run_of), [BLOCK_PIXELS; 3]);
    }
}
