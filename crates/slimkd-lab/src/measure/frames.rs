//! Pictures a second: trees that take turns, after their pictures were compared.

use super::session::Session;
use super::trees::Trees;
pub use crate::basics::DeviceError;
use crate::basics::{Progress, ReportError};
use crate::schema::{Frames, Timed, View};
use rayon::{ThreadPool, ThreadPoolBuilder};
use slimkd::{KdTree, Preset};
use slimkd_render::{Film, RenderError, RenderSettings, render};
use slimkd_scene::{Camera, Scene};
use std::time::Instant;

/// Where pictures are rendered.
pub trait Device {
    /// As in JSON: `cpu` or `gpu`.
    fn name(&self) -> &str;
    /// Threads of the CPU that it uses.
    fn threads(&self) -> usize;
    /// What it is, where `name` does not say.
    fn description(&self) -> Option<String> {
        None
    }
    /// Share of a picture's pixels that may differ from the CPU's by more than 1/255.
    fn unlike(&self) -> f64 {
        0.0
    }
    /// Whether a scene that it has no room for is left out, instead of ending the report.
    fn is_optional(&self) -> bool {
        false
    }
    /// A scene and one of its trees, brought to where they are rendered.
    fn ready<'a>(&'a self, scene: &'a Scene, tree: &'a KdTree) -> Result<Box<dyn Ready + 'a>, DeviceError>;
}

/// A scene where it is rendered.
pub trait Ready {
    /// One picture and the seconds that it took: on a GPU, those of its kernels.
    fn picture(
        &self,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &slimkd::Progress,
    ) -> Result<(Film, f64), DeviceError>;
}

/// The processor.
pub struct Cpu(ThreadPool);

impl Cpu {
    /// With that many threads.
    pub fn new(threads: usize) -> Result<Self, ReportError> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        pool.map(Self).map_err(|_| ReportError::Threads(threads))
    }
}

impl Device for Cpu {
    fn name(&self) -> &str {
        "cpu"
    }

    fn threads(&self) -> usize {
        self.0.current_num_threads()
    }

    fn ready<'a>(&'a self, scene: &'a Scene, tree: &'a KdTree) -> Result<Box<dyn Ready + 'a>, DeviceError> {
        Ok(Box::new(OnCpu { pool: &self.0, scene, tree }))
    }
}

struct OnCpu<'a> {
    pool: &'a ThreadPool,
    scene: &'a Scene,
    tree: &'a KdTree,
}

impl Ready for OnCpu<'_> {
    fn picture(
        &self,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &slimkd::Progress,
    ) -> Result<(Film, f64), DeviceError> {
        let started = Instant::now();
        let Self { pool, scene, tree } = self;
        let film = pool.install(|| render(scene, tree, camera, &scene.lights, settings, progress))?;
        Ok((film, started.elapsed().as_secs_f64()))
    }
}

/// The paper's picture: Whitted's rays alone, one sample a pixel.
fn whitted(width: u32, height: u32) -> RenderSettings {
    let mut settings = RenderSettings::sized(width, height);
    settings.samples = 1;
    settings.occlusion = 0;
    settings
}

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<'a> {
    /// Of what.
    pub(super) scene: &'a Scene,
    /// Number of the view, for messages.
    pub(super) view: usize,
    /// From where.
    pub(super) camera: Camera,
    /// Width and height, pixels.
    pub(super) size: [u32; 2],
}

/// Seconds of each tree's picture in each round. All trees render once before, and must show the same: on a device that only
/// comes near to the CPU, what that shows. `done` is called after each picture.
pub(super) fn frames(
    device: &dyn Device,
    frame: &Frame<'_>,
    trees: &[(&str, &KdTree)],
    rounds: usize,
    progress: &Progress,
    done: &dyn Fn(),
) -> Result<Vec<Vec<f64>>, ReportError> {
    let Frame { scene, view, camera, size: [width, height] } = *frame;
    let settings = &whitted(width, height);
    let failed = |error| match error {
        DeviceError::Render(RenderError::Cancelled) => ReportError::Cancelled,
        error => ReportError::Render { scene: scene.name.clone(), view, error },
    };
    let ready = trees.iter().map(|(_, tree)| device.ready(scene, tree));
    let ready = ready.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    let picture = |index: usize| {
        let picture = ready[index].picture(&camera, settings, &progress.piece());
        done();
        picture.map_err(failed)
    };
    let reference = if device.unlike() > 0.0 {
        let film = render(scene, trees[0].1, &camera, &scene.lights, settings, &progress.piece());
        film.map_err(|error| failed(error.into()))?
    } else {
        picture(0)?.0
    };
    for (index, (name, _)) in trees.iter().enumerate() {
        let same = if device.unlike() > 0.0 {
            let film = picture(index)?.0;
            reference.share_apart(&film) <= device.unlike()
        } else {
            index == 0 || picture(index)?.0 == reference
        };
        if !same {
            return Err(ReportError::Differ((*name).to_owned(), trees[0].0.to_owned(), view));
        }
    }
    let mut seconds = vec![Vec::new(); trees.len()];
    for round in 0..rounds {
        for turn in 0..trees.len() {
            // Another one begins each time, so that none always runs in the wake of the same one.
            let index = (turn + round) % trees.len();
            seconds[index].push(picture(index)?.1);
        }
    }
    Ok(seconds)
}

/// [`frames`] of a square picture of a view, as the session's options say.
pub(super) fn on_view(
    session: &Session<'_>,
    scene: &Scene,
    trees: &[(&str, &KdTree)],
    view: &View,
    edge: u32,
    device: &dyn Device,
) -> Result<Vec<Vec<f64>>, ReportError> {
    let frame = Frame { scene, view: view.number, camera: view.camera(), size: [edge, edge] };
    frames(device, &frame, trees, session.options.rounds, session.progress, &|| ())
}

pub(super) fn measure(
    session: &Session<'_>,
    trees: &mut Trees<'_>,
    presets: &[Preset],
    view: &View,
    device: &dyn Device,
) -> Result<Frames, ReportError> {
    trees.ensure_all(presets)?;
    let named: Vec<_> = presets.iter().map(|&preset| (preset.name(), trees.get(preset))).collect();
    let edge = session.options.frame_edge;
    let seconds = on_view(session, trees.scene, &named, view, edge, device)?;
    let presets = named.iter().zip(seconds);
    Ok(Frames {
        view: view.number,
        device: device.name().to_owned(),
        threads: device.threads(),
        presets: presets.map(|((name, _), seconds)| Timed { name: (*name).to_owned(), seconds }).collect(),
    })
}
