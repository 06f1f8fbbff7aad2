//! The measuring itself.

use super::report::{FrameRate, Rate};
use crate::args::Size;
use crate::cameras::View;
use crate::device::{Device, Pictures, Traces};
use crate::failure::Failure;
use crate::interrupt;
use crate::ui::{Ui, Watched, grouped};
use rayon::ThreadPool;
use slimkd_lab::basics::median::median;
use slimkd_lab::measure::rates::{self, Kernel, Named, Rates, RayDevice, Watch};
use slimkd_lab::measure::{self, Cpu, Frame, frames, whitted};
use slimkd_lab::{Progress, ReportError};
use slimkd_scene::Scene;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

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
        let cameras: Vec<_> = self.views.iter().map(|view| view.camera).collect();
        let device = self.device.map(Traces);
        let rates = Rates {
            mesh: &self.scene.mesh,
            trees: &self.trees,
            cameras: &cameras,
            pool: &self.pool,
            kernel: self.kernel,
            device: device.as_ref().map(|device| device as &dyn RayDevice),
            rounds: self.rounds,
            rays: self.rays,
            watch: &Watching { steps, ui },
        };
        let rates = rates.measure().map_err(|error| match error {
            ReportError::Camera(error) => {
                Failure::work(format_args!("{}: {error} (--camera, --up)", self.place))
            }
            error => self.failed(error),
        })?;
        let rate = |rate: rates::Rate<'_>| Rate {
            preset: rate.tree.to_owned(),
            kernel: self.kernel.name(),
            device: self.device_name(),
            threads: self.threads(),
            workload: rate.workload,
            rays: rate.rays,
            hits: rate.hits,
            mrays_per_s: rate.mrays_per_s,
        };
        Ok(rates.into_iter().map(rate).collect())
    }

    fn failed(&self, error: ReportError) -> Failure {
        match error {
            ReportError::Cancelled => Failure::Interrupted,
            error => Failure::work(error),
        }
    }

    fn device_name(&self) -> &'static str {
        if self.device.is_some() { GPU } else { CPU }
    }

    /// Threads of the CPU that do the work; one waits for a GPU.
    fn threads(&self) -> usize {
        if self.device.is_some() { 1 } else { self.pool.current_num_threads() }
    }

    /// Pictures a second of all presets and views.
    pub(super) fn frames(&self, steps: &Steps) -> Result<Vec<FrameRate>, Failure> {
        steps.expect(self.views.len() * (1 + self.rounds) * self.trees.len());
        let failed = |error| self.failed(error);
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
                    preset: (*preset).to_owned(),
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

/// Rates, as the bar and the notes show them.
struct Watching<'a> {
    steps: &'a Steps,
    ui: Ui,
}

impl Watch for Watching<'_> {
    fn is_cancelled(&self) -> bool {
        interrupt::pending()
    }

    fn expect(&self, steps: usize) {
        self.steps.expect(steps);
    }

    fn done(&self, steps: usize) {
        self.steps.done(steps);
    }

    fn compared(&self, workload: &str, rays: usize, per_cent: f64, alike: &str) {
        let rays = grouped(rays as u64);
        self.ui.note(format_args!("{workload}: {rays} rays, {per_cent:.1} % hit, {alike}"));
    }
}

impl Watched for Steps {
    fn fraction(&self) -> f64 {
        self.done.load(Relaxed) as f64 / self.total.load(Relaxed).max(1) as f64
    }

    fn cancel(&self) {}
}
