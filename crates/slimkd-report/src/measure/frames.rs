//! Pictures a second: trees that take turns, after their pictures were compared.

use super::session::Session;
use super::trees::Trees;
use crate::data::{Frames, Timed, View};
use crate::{Progress, ReportError};
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
    /// One picture and the seconds that it took. Pictures of different trees of a scene on one device must be equal.
    fn picture(
        &self,
        scene: &Scene,
        tree: &KdTree,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &Progress,
    ) -> Result<(Film, f64), RenderError>;
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

    fn picture(
        &self,
        scene: &Scene,
        tree: &KdTree,
        camera: &Camera,
        settings: &RenderSettings,
        progress: &Progress,
    ) -> Result<(Film, f64), RenderError> {
        let progress = progress.rendering();
        let started = Instant::now();
        let film = self.0.install(|| render(scene, tree, camera, &scene.lights, settings, &progress))?;
        Ok((film, started.elapsed().as_secs_f64()))
    }
}

/// The paper's picture: Whitted's rays alone, one sample a pixel.
pub fn whitted(width: u32, height: u32) -> RenderSettings {
    let mut settings = RenderSettings::sized(width, height);
    settings.samples = 1;
    settings.occlusion = 0;
    settings
}

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Of what.
    pub scene: &'a Scene,
    /// Number of the view, for messages.
    pub view: usize,
    /// From where.
    pub camera: Camera,
    /// How: see [`whitted`].
    pub settings: &'a RenderSettings,
}

/// Seconds of each tree's picture in each round. All trees render once before, and must show the same. `done` is called
/// after each picture.
pub fn frames(
    device: &dyn Device,
    frame: &Frame<'_>,
    trees: &[(&str, &KdTree)],
    rounds: usize,
    progress: &Progress,
    done: &dyn Fn(),
) -> Result<Vec<Vec<f64>>, ReportError> {
    let Frame { scene, view, camera, settings } = *frame;
    let picture = |tree: &KdTree| {
        let picture = device.picture(scene, tree, &camera, settings, progress);
        done();
        picture.map_err(|error| match error {
            RenderError::Cancelled => ReportError::Cancelled,
            error => ReportError::Render { scene: scene.name.clone(), view, error },
        })
    };
    let mut first: Option<Film> = None;
    for (name, tree) in trees {
        let (film, _) = picture(tree)?;
        let reference = first.get_or_insert_with(|| film.clone());
        if *reference != film {
            return Err(ReportError::Differ((*name).to_owned(), trees[0].0.to_owned(), view));
        }
    }
    let mut seconds = vec![Vec::new(); trees.len()];
    for round in 0..rounds {
        for turn in 0..trees.len() {
            // Another one begins each time, so that none always runs in the wake of the same one.
            let index = (turn + round) % trees.len();
            seconds[index].push(picture(trees[index].1)?.1);
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
    let frame = Frame { scene, view: view.number, camera: view.camera(), settings: &whitted(edge, edge) };
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
