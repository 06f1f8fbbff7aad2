//! The measuring itself.

use super::report::{FrameRate, Rate};
use crate::args::Size;
use crate::cameras::View;
use crate::device::{Device, Pictures, Tracer};
use crate::failure::Failure;
use crate::kernel::Kernel;
use crate::measure::{Answers, Named, agree, agree_with_cpu};
use crate::ui::{Ui, Watched, grouped};
use rayon::ThreadPool;
use slimkd::Ray;
use slimkd_lab::basics::median::median;
use slimkd_lab::measure::{self, Cpu, Frame, frames, whitted};
use slimkd_lab::workload::{self, Found, Kind, Order, Recipe, Workload};
use slimkd_lab::{Progress, ReportError};
use slimkd_render::PinholeFrame;
use slimkd_scene::Scene;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Seconds of tracing that a run may take by default, building aside: five presets then stay below a minute.
const TIME: f64 = 40.0;
/// Longest single run, s: more rays would not make a rate more certain.
const LONGEST_RUN: f64 = 1.0;
/// Fewest rays of a workload, unless there are no more: fewer than this is noise.
const LEAST_RAYS: usize = 1 << 14;
/// Most rays of a workload: the pixels of one picture.
pub(super) const MOST_RAYS: usize = 1 << 20;
/// Number of workloads.
const WORKLOADS: usize = Kind::ALL.len();
/// Edge of the pictures that primary rays belong to, pixels.
const PICTURE: usize = 1024;
/// Seed of the bounces and of the random rays.
const SEED: u64 = 1;
/// Where rays are traced.
const CPU: &str = "cpu";
/// The same.
const GPU: &str = "gpu";

/// What is measured, and with what.
pub(super) struct Bench<'a> {
    /// What messages call the scene.
    pub(super) place: &'a str,
    pub(super) scene: &'a Scene,
    pub(super) trees: Vec<Named<'a>>,
    pub(super) views: Vec<View>,
    pub(super) pool: ThreadPool,
    pub(super) kernel: Kernel,
    /// What traces and renders in the CPU's stead.
    pub(super) device: Option<&'a dyn Device>,
    pub(super) rounds: usize,
    pub(super) rays: Option<usize>,
    /// Of the pictures.
    pub(super) size: Size,
}

impl Bench<'_> {
    /// The rates of all presets on all workloads.
    pub(super) fn rates(&self, steps: &Steps, ui: Ui) -> Result<Vec<Rate>, Failure> {
        let uploaded = self.uploaded()?;
        let workloads = self.workloads(&uploaded)?;
        steps.expect(workloads.len() * (1 + self.rounds) * self.trees.len());
        let mut hits = Vec::new();
        for workload in &workloads {
            let (count, alike) = if uploaded.is_empty() {
                (agree(&self.pool, &self.trees, self.kernel, workload)?, "the same with all presets")
            } else {
                let count = agree_with_cpu(&self.pool, self.trees[0].1, &uploaded, workload)?;
                (count, "the CPU's with all presets")
            };
            steps.done(self.trees.len());
            let share = 100.0 * count as f64 / workload.rays.len().max(1) as f64;
            let rays = grouped(workload.rays.len() as u64);
            ui.note(format_args!("{}: {rays} rays, {share:.1} % hit, {alike}", workload.kind.name()));
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
                    steps.done(1);
                }
            }
        }
        let mut results = Vec::new();
        for ((workload, hits), mut rates) in workloads.iter().zip(hits).zip(rates) {
            for ((preset, _), rates) in self.trees.iter().zip(&mut rates) {
                results.push(Rate {
                    preset,
                    kernel: self.kernel.name(),
                    device: self.device_name(),
                    threads: self.threads(),
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
    fn uploaded(&self) -> Result<Vec<Box<dyn Tracer + '_>>, Failure> {
        let Some(device) = self.device else { return Ok(Vec::new()) };
        self.trees.iter().map(|(_, tree)| device.tree(tree).map_err(Failure::work)).collect()
    }

    /// Traces with tree number `index`, wherever that is done; the seconds that it took.
    fn trace(
        &self,
        answers: &mut Answers,
        uploaded: &[Box<dyn Tracer + '_>],
        index: usize,
        rays: &[Ray],
        any: bool,
    ) -> Result<f64, Failure> {
        match uploaded.get(index) {
            Some(tree) => answers.trace_on(tree.as_ref(), rays, any),
            None => answers.trace(&self.pool, self.trees[index].1, rays, any),
        }
    }

    fn device_name(&self) -> &'static str {
        if self.device.is_some() { GPU } else { CPU }
    }

    /// Threads of the CPU that do the work; one waits for a GPU.
    fn threads(&self) -> usize {
        if self.device.is_some() { 1 } else { self.pool.current_num_threads() }
    }

    /// The rays, as many as the time allows.
    fn workloads(&self, uploaded: &[Box<dyn Tracer + '_>]) -> Result<Vec<Workload>, Failure> {
        let tree = self.trees[0].1;
        let most = self.rays.unwrap_or(MOST_RAYS);
        let views = self.views.iter().map(|view| view.camera.into()).collect();
        for view in &self.views {
            PinholeFrame::new(&view.camera, 1.0)
                .map_err(|error| Failure::work(format_args!("{}: {error} (--camera, --up)", self.place)))?;
        }
        let order = Order::Scattered;
        let mut recipe = Recipe { views, size: PICTURE, order, random_rays: 0, seed: SEED };
        let mut primary = workload::primary(&recipe);
        primary.truncate(most);
        let count = self.affordable(uploaded, &primary, false)?;
        primary.truncate(count);
        recipe.random_rays = primary.len();
        let closest = |rays: &[Ray], found: &mut [Found]| {
            // Ctrl-C leaves misses; the next trace ends the measurement.
            let mut answers = Answers::with(self.kernel);
            if answers.trace(&self.pool, tree, rays, false).is_ok() {
                found.iter_mut().zip(answers.found()).for_each(|(found, hit)| *found = hit);
            }
        };
        let rays = workload::generate_from(&self.scene.mesh, &closest, &recipe, primary, Kind::ALL);
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
        uploaded: &[Box<dyn Tracer + '_>],
        rays: &[Ray],
        any: bool,
    ) -> Result<usize, Failure> {
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

    /// Pictures a second of all presets and views.
    pub(super) fn frames(&self, steps: &Steps) -> Result<Vec<FrameRate>, Failure> {
        steps.expect(self.views.len() * (1 + self.rounds) * self.trees.len());
        let failed = |error| match error {
            ReportError::Cancelled => Failure::Interrupted,
            error => Failure::work(error),
        };
        let device: Box<dyn measure::Device + '_> = match self.device {
            Some(device) => Box::new(Pictures { device, optional: false }),
            None => Box::new(Cpu::new(self.threads()).map_err(failed)?),
        };
        let settings = whitted(self.size.width, self.size.height);
        let mut results = Vec::new();
        for view in &self.views {
            let frame =
                Frame { scene: self.scene, view: view.number, camera: view.camera, settings: &settings };
            let progress = Progress::new();
            // Passes Ctrl-C on; the bar is that of all pictures together.
            let seconds = Ui::new(true)
                .watch("", &progress, || {
                    frames(device.as_ref(), &frame, &self.trees, self.rounds, &progress, &|| steps.done(1))
                })
                .map_err(failed)?;
            for ((preset, _), seconds) in self.trees.iter().zip(&seconds) {
                results.push(FrameRate {
                    preset,
                    device: self.device_name(),
                    threads: self.threads(),
                    view: view.number,
                    frames_per_s: median(seconds).map_or(f64::NAN, |seconds| 1.0 / seconds.max(1e-9)),
                });
            }
        }
        Ok(results)
    }
}

/// How many runs are done, of how many. Runs look at Ctrl-C themselves, so there is nothing to cancel.
#[derive(Default)]
pub(super) struct Steps {
    total: AtomicUsize,
    done: AtomicUsize,
}

impl Steps {
    fn expect(&self, total: usize) {
        self.total.store(total, Relaxed);
    }

    fn done(&self, steps: usize) {
        self.done.fetch_add(steps, Relaxed);
    }
}

impl Watched for Steps {
    fn fraction(&self) -> f64 {
        self.done.load(Relaxed) as f64 / self.total.load(Relaxed).max(1) as f64
    }

    fn cancel(&self) {}
}
