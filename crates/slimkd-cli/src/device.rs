//! Where rays are traced and pictures are rendered.

#[cfg(feature = "gpu")]
mod gpu;

use crate::failure::Failure;
use crate::ui::Ui;
use clap::ValueEnum;
use slimkd::KdTree;
pub(crate) use slimkd_lab::measure::rates::RayTracer as Tracer;
use slimkd_lab::measure::rates::{Kernel, RayDevice};
use slimkd_lab::measure::{self, DeviceError, Ready};
use slimkd_scene::Scene;

/// A device, as the command line names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The CPU
    #[default]
    Cpu,
    /// The first adapter that `slimkd devices` lists, software ones too
    Gpu,
    /// A GPU if there is one in hardware that does the work, else the CPU
    Auto,
}

/// What works in the CPU's stead. Its errors are sentences.
pub(crate) trait Device {
    /// As in messages.
    fn name(&self) -> String;
    /// Whether the CPU does its work.
    fn is_software(&self) -> bool;
    /// The tree on it.
    fn tree<'d>(&'d self, tree: &KdTree) -> Result<Box<dyn Tracer + 'd>, String>;
    /// The scene and its tree on it.
    fn scene<'d>(&'d self, scene: &'d Scene, tree: &'d KdTree) -> Result<Box<dyn Ready + 'd>, DeviceError>;
}

#[cfg(feature = "gpu")]
use gpu::adapter;
#[cfg(feature = "gpu")]
pub(crate) use gpu::quieten;

#[cfg(not(feature = "gpu"))]
pub(crate) fn quieten() {}

#[cfg(not(feature = "gpu"))]
fn adapter() -> Result<Box<dyn Device>, String> {
    Err("this slimkd was built without its feature gpu; build it with that".to_owned())
}

/// A device, as what measures rates sees it.
pub(crate) struct Traces<'d>(pub(crate) &'d dyn Device);

impl RayDevice for Traces<'_> {
    fn tree<'d>(&'d self, tree: &KdTree) -> Result<Box<dyn Tracer + 'd>, String> {
        self.0.tree(tree)
    }
}

/// A device, as what measures frames sees it.
pub(crate) struct Pictures<'d> {
    pub(crate) device: &'d dyn Device,
    /// Whether it was not asked for by name.
    pub(crate) optional: bool,
}

/// Share of a picture's pixels that may differ from the CPU's.
const UNLIKE: f64 = 1e-3;

impl measure::Device for Pictures<'_> {
    fn name(&self) -> &str {
        "gpu"
    }

    fn threads(&self) -> usize {
        1
    }

    fn description(&self) -> Option<String> {
        Some(self.device.name())
    }

    fn unlike(&self) -> f64 {
        UNLIKE
    }

    fn is_optional(&self) -> bool {
        self.optional
    }

    fn ready<'a>(&'a self, scene: &'a Scene, tree: &'a KdTree) -> Result<Box<dyn Ready + 'a>, DeviceError> {
        self.device.scene(scene, tree)
    }
}

/// The device that was asked for; `None` is the CPU.
pub(crate) fn open(choice: Choice, ui: Ui) -> Result<Option<Box<dyn Device>>, Failure> {
    if choice == Choice::Cpu {
        return Ok(None);
    }
    match adapter() {
        Ok(device) if choice == Choice::Auto && device.is_software() => Ok(None),
        Ok(device) => {
            ui.note(format_args!("on {}", device.name()));
            Ok(Some(device))
        }
        Err(_) if choice == Choice::Auto => Ok(None),
        Err(error) => Err(Failure::work(error)),
    }
}

impl Choice {
    /// What a device answered; `None` where the CPU takes over, which then is said.
    pub(crate) fn or_cpu<T>(self, answer: Result<T, String>, ui: Ui) -> Result<Option<T>, Failure> {
        match answer {
            Ok(answer) => Ok(Some(answer)),
            Err(error) if self == Self::Auto => {
                ui.note(format_args!("on the CPU: {error}"));
                Ok(None)
            }
            Err(error) => Err(Failure::work(error)),
        }
    }

    /// Refuses a kernel that the device does not have.
    pub(crate) fn check(self, kernel: Kernel) -> Result<(), Failure> {
        if self == Self::Gpu && kernel != Kernel::default() {
            return Err(Failure::Usage(
                "--kernel names kernels of the CPU; leave it out with --device gpu".to_owned(),
            ));
        }
        Ok(())
    }
}
