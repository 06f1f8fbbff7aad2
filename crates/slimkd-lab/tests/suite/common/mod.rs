//! A report of a tiny scene, in a moment.
#![allow(dead_code, unreachable_pub)] // each test file uses its share

use slimkd::KdTree;
use slimkd_lab::measure::{Cpu, Device, DeviceError, Ready, Session};
use slimkd_lab::schema::{Options, Raw};
use slimkd_lab::{Progress, ReportError, report::output};
use slimkd_scene::Scene;
use std::path::Path;
use std::time::Duration;

pub fn options() -> Options {
    Options {
        frame_edge: 24,
        occupancies: vec![0.5, 0.9],
        frequencies: vec![0.4, 0.7],
        sweep_edge: 16,
        heat_edge: 48,
        picture_edge: 64,
        scaling: vec![1000, 2000],
        random_rays: 500,
        ..Options::quick(vec![1, 2])
    }
}

/// The processor under a GPU's name.
struct Pretended(Cpu);

impl Device for Pretended {
    fn name(&self) -> &str {
        "gpu"
    }

    fn threads(&self) -> usize {
        1
    }

    fn description(&self) -> Option<String> {
        Some("no GPU at all".to_owned())
    }

    fn unlike(&self) -> f64 {
        1e-3
    }

    fn ready<'a>(&'a self, scene: &'a Scene, tree: &'a KdTree) -> Result<Box<dyn Ready + 'a>, DeviceError> {
        self.0.ready(scene, tree)
    }
}

/// A GPU that has no room.
struct Full;

impl Device for Full {
    fn name(&self) -> &str {
        "gpu"
    }

    fn threads(&self) -> usize {
        2
    }

    fn is_optional(&self) -> bool {
        true
    }

    fn ready<'a>(&'a self, _: &'a Scene, _: &'a KdTree) -> Result<Box<dyn Ready + 'a>, DeviceError> {
        Err(DeviceError::Failed("no room".to_owned()))
    }
}

/// Measures and writes.
pub fn report(folder: &Path, limit: Option<Duration>) -> Result<Raw, ReportError> {
    let (options, progress) = (options(), Progress::new());
    let mut session = Session::new(folder, &options, limit, &progress)?;
    session.add_device(Box::new(Pretended(Cpu::new(1)?)));
    session.add_device(Box::new(Full));
    let mut kitchen = slimkd_scene::procedural::generate("kitchen", 3000).unwrap();
    // As its name says, so that published figures stand beside ours.
    kitchen.name = "bart_kitchen_101015".to_owned();
    let plant = slimkd_scene::procedural::generate("power-plant", 3000).unwrap();
    let scenes = vec![session.scene(&kitchen, false)?, session.scene(&plant, true)?];
    let mut raw = session.raw(scenes, session.scaling()?);
    let peers = r#"{"scene": {"name": "kitchen <&>", "triangles": 3000}, "points": [
        {"name": "slimkd-slim", "interface": "single", "threads": 1, "bytes_tree": 15000, "bytes_resident": 90000,
         "mrays": {"bounce": 2.0}, "marked": false},
        {"name": "other", "interface": "single", "threads": 1, "bytes_tree": 60000, "bytes_resident": 190000,
         "mrays": {"bounce": 3.0}, "marked": false}]}"#;
    raw.peers = vec![serde_json::from_str(peers).unwrap()];
    output::write_all(folder, &raw)?;
    assert!(progress.fraction() > 0.999);
    Ok(raw)
}
