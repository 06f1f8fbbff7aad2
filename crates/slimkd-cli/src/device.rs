//! Where rays are traced.

use crate::failure::Failure;
use crate::kernel::Kernel;
use crate::ui::Ui;
use clap::ValueEnum;
use slimkd::KdTree;

/// A device, as the command line names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Choice {
    /// The CPU, with the kernel that --kernel names
    #[default]
    Cpu,
    /// The first adapter that `slimkd devices` lists, software ones too
    Gpu,
    /// A GPU if there is one in hardware that takes the tree, else the CPU
    Auto,
}

#[cfg(feature = "gpu")]
mod adapter {
    use super::{Choice, Failure, KdTree, Ui};
    pub(crate) use slimkd_gpu::GpuTree;
    use slimkd_gpu::{Device, GpuError, UploadOptions};

    /// The device that was asked for; `None` is the CPU.
    pub(crate) fn open(choice: Choice, ui: Ui) -> Result<Option<Device>, Failure> {
        if choice == Choice::Cpu {
            return Ok(None);
        }
        match Device::open(None) {
            Ok(device) if choice == Choice::Auto && device.adapter().kind == "software" => Ok(None),
            Ok(device) => {
                ui.note(format_args!("on {} ({})", device.adapter().name, device.adapter().backend));
                Ok(Some(device))
            }
            Err(_) if choice == Choice::Auto => Ok(None),
            Err(error) => Err(Failure::work(error)),
        }
    }

    /// The tree on the device; `None` is the CPU.
    pub(crate) fn upload<'d>(
        device: Option<&'d Device>,
        choice: Choice,
        tree: &KdTree,
        ui: Ui,
    ) -> Result<Option<GpuTree<'d>>, Failure> {
        let Some(device) = device else { return Ok(None) };
        match GpuTree::upload(device, tree, &UploadOptions::default()) {
            Ok(tree) => Ok(Some(tree)),
            Err(error) => on_the_cpu(choice, error, ui).map(|()| None),
        }
    }

    /// Says that the CPU takes over, where it may.
    fn on_the_cpu(choice: Choice, error: GpuError, ui: Ui) -> Result<(), Failure> {
        if choice == Choice::Gpu {
            return Err(Failure::work(error));
        }
        ui.note(format_args!("on the CPU: {error}"));
        Ok(())
    }
}

#[cfg(not(feature = "gpu"))]
mod adapter {
    use super::{Choice, Failure, KdTree, Ui};
    use slimkd::{Hit, Ray};

    /// There is none in this build.
    pub(crate) enum Device {}
    /// There is none in this build.
    pub(crate) struct GpuTree<'d>(&'d Device);

    impl GpuTree<'_> {
        pub(crate) fn closest_hits(&self, _: &[Ray], _: &mut [Option<Hit>]) -> Result<(), String> {
            match *self.0 {}
        }

        pub(crate) fn any_hits(&self, _: &[Ray], _: &mut [bool]) -> Result<(), String> {
            match *self.0 {}
        }
    }

    pub(crate) fn open(choice: Choice, _: Ui) -> Result<Option<Device>, Failure> {
        match choice {
            Choice::Gpu => {
                Err(Failure::work("this slimkd was built without its feature gpu; build it with that"))
            }
            _ => Ok(None),
        }
    }

    pub(crate) fn upload<'d>(
        _: Option<&'d Device>,
        _: Choice,
        _: &KdTree,
        _: Ui,
    ) -> Result<Option<GpuTree<'d>>, Failure> {
        Ok(None)
    }
}

pub(crate) use adapter::{GpuTree, open, upload};

impl Choice {
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
