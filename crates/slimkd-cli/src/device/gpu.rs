//! The GPU as a device.

use super::{Device, Tracer};
use slimkd::{Aabb, Hit, KdTree, Progress, Ray};
use slimkd_gpu::frame::{FrameError, GpuScene};
use slimkd_gpu::{GpuTree, UploadOptions};
use slimkd_lab::measure::{DeviceError, Ready};
use slimkd_render::{Film, RenderSettings, Setup};
use slimkd_scene::{Camera, Scene};

/// Mesa's device selection complains on stderr where there is no XDG_RUNTIME_DIR, as on servers, and then is of no use. It is
/// switched off by a variable of the environment, which only a new process gets safely: this one becomes it.
pub(crate) fn quieten() {
    #[cfg(unix)]
    {
        use std::env::{args_os, current_exe, var_os};
        use std::ffi::OsString;
        use std::os::unix::process::CommandExt;
        const SWITCH: &str = "NODEVICE_SELECT";
        let named = |argument: OsString| {
            let argument = argument.to_string_lossy();
            argument == "devices" || argument == "report" || argument.starts_with("--device")
        };
        let wanted = args_os().skip(1).any(named);
        if !wanted || var_os("XDG_RUNTIME_DIR").is_some() || var_os(SWITCH).is_some() {
            return;
        }
        let mut arguments = args_os();
        if let (Ok(program), Some(name)) = (current_exe(), arguments.next()) {
            // It returns only where it failed, and then there is one line more.
            let _ = std::process::Command::new(program).arg0(name).args(arguments).env(SWITCH, "1").exec();
        }
    }
}

/// The adapter that is listed first.
pub(super) fn adapter() -> Result<Box<dyn Device>, String> {
    match slimkd_gpu::Device::open(None) {
        Ok(device) => Ok(Box::new(device)),
        Err(error) => Err(error.to_string()),
    }
}

impl Device for slimkd_gpu::Device {
    fn name(&self) -> String {
        format!("{} ({})", self.adapter().name, self.adapter().backend)
    }

    fn is_software(&self) -> bool {
        self.adapter().kind == "software"
    }

    fn tree<'d>(&'d self, tree: &KdTree) -> Result<Box<dyn Tracer + 'd>, String> {
        match GpuTree::upload(self, tree, &UploadOptions::default()) {
            Ok(tree) => Ok(Box::new(OnGpu(tree))),
            Err(error) => Err(error.to_string()),
        }
    }

    fn scene<'d>(&'d self, scene: &'d Scene, tree: &'d KdTree) -> Result<Box<dyn Ready + 'd>, DeviceError> {
        let gpu = GpuScene::upload(self, scene, tree, &UploadOptions::default()).map_err(failed)?;
        Ok(Box::new(SceneOnGpu { gpu, scene, tree }))
    }
}

fn failed(error: impl std::fmt::Display) -> DeviceError {
    DeviceError::Failed(error.to_string())
}

/// A tree on a GPU, as what measures rates sees it.
struct OnGpu<'a>(GpuTree<'a>);

impl Tracer for OnGpu<'_> {
    fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> Result<f64, String> {
        self.0.closest(rays, hits).map(|time| time.kernels.as_secs_f64()).map_err(|error| error.to_string())
    }

    fn t_bound(&self, ray: &Ray, bounds: &Aabb, t: f32) -> f32 {
        slimkd_gpu::t_bound(ray, bounds, t)
    }

    fn any(&self, rays: &[Ray], hits: &mut [bool]) -> Result<f64, String> {
        self.0.any(rays, hits).map(|time| time.kernels.as_secs_f64()).map_err(|error| error.to_string())
    }
}

/// A scene on a GPU, as what measures frames sees it.
struct SceneOnGpu<'a> {
    gpu: GpuScene<'a>,
    scene: &'a Scene,
    tree: &'a KdTree,
}

impl Ready for SceneOnGpu<'_> {
    fn picture(
        &self,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &Progress,
    ) -> Result<(Film, f64), DeviceError> {
        let setup = Setup::new(self.scene, self.tree, camera, &self.scene.lights, settings)?;
        match self.gpu.render(&setup, settings, progress) {
            Ok((film, time)) => Ok((film, time.kernels.as_secs_f64())),
            Err(FrameError::Render(error)) => Err(error.into()),
            Err(error) => Err(failed(error)),
        }
    }
}
