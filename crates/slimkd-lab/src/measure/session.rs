//! A run: which units there are, which are done, and whether to go on.

use super::frames::{Cpu, Device, DeviceError};
use super::store::Store;
use super::trees::Trees;
use super::{ablation, frames, heat, pictures, scaling, sweep, trees};
use crate::basics::machine::Machine;
use crate::basics::{Progress, ReportError};
use crate::schema::published;
use crate::schema::{Options, Published, Raw, SCHEMA, ScalingPoint, Scene, View};
use bytemuck::cast_slice;
use serde::Serialize;
use serde::de::DeserializeOwned;
use slimkd::Preset;
use slimkd_render::views;
use slimkd_scene::Camera;
use std::cell::Cell;
use std::path::Path;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use xxhash_rust::xxh3::Xxh3;

/// A unit's name, what decides its result, and about how long it takes, in ms for a scene of a million triangles: only
/// the ratios count, for the time left.
pub(super) struct Unit {
    pub(super) name: String,
    pub(super) decides: String,
    pub(super) weight: u64,
}

/// A running report.
pub struct Session<'a> {
    pub(super) store: Store,
    pub(super) options: &'a Options,
    pub(super) progress: &'a Progress,
    pub(super) devices: Vec<Box<dyn Device + 'a>>,
    deadline: Option<Instant>,
    /// Units of this scene that are still to be done.
    left: Cell<usize>,
    /// Something was measured.
    worked: Cell<bool>,
}

impl<'a> Session<'a> {
    /// Goes on in `folder`, or begins there; ends with [`ReportError::TimeUp`] before the first unit that would begin after
    /// `limit`, but never before one was measured: whoever calls again and again comes to an end.
    pub fn new(
        folder: &Path,
        options: &'a Options,
        limit: Option<Duration>,
        progress: &'a Progress,
    ) -> Result<Self, ReportError> {
        let mut devices: Vec<Box<dyn Device + 'a>> = Vec::new();
        for &threads in &options.threads {
            devices.push(Box::new(Cpu::new(threads)?));
        }
        let deadline = limit.map(|limit| Instant::now() + limit);
        Ok(Self {
            store: Store::open(folder)?,
            options,
            progress,
            devices,
            deadline,
            left: Cell::new(0),
            worked: Cell::new(false),
        })
    }

    /// Measures frames on another device too.
    pub fn add_device(&mut self, device: Box<dyn Device + 'a>) {
        self.devices.push(device);
    }

    /// Measures one scene, whose up is settled; of a very large one less.
    pub fn scene(&self, scene: &slimkd_scene::Scene, very_large: bool) -> Result<Scene, ReportError> {
        let hash = hash(scene);
        let options = self.options;
        let mut trees = Trees::new(self, scene);
        let views = self.views(&mut trees, &hash)?;
        let decides = |what: &dyn std::fmt::Debug| format!("{hash} {what:?} {views:?}");
        let unit = |name: String, what: &dyn std::fmt::Debug, weight: u64| Unit {
            name: format!("{}-{name}", scene.name),
            decides: decides(what),
            weight,
        };
        let presets: Vec<_> = trees::presets(very_large);
        // A build of the very large scene takes a minute or some: one tells enough.
        let builds = if very_large { 1 } else { options.builds };
        let tree_units: Vec<_> = presets
            .iter()
            .map(|preset| {
                let what = (slimkd::BuildOptions::from(*preset), &options.threads, builds);
                unit(format!("tree-{}", preset.name()), &what, 2000 * builds as u64)
            })
            .collect();
        let edge = options.frame_edge;
        let frame_units: Vec<_> = views
            .iter()
            .flat_map(|view| (0..self.devices.len()).map(move |device| (view, device)))
            // As in the paper, whose very large scene has no rows of a GPU: most could not hold it.
            .filter(|&(_, device)| !very_large || self.devices[device].name() == "cpu")
            .map(|(view, device)| {
                let on = &self.devices[device];
                let name = format!("frames-{}-{}-{}", view.number, on.name(), on.threads());
                let weight = u64::from(edge) * u64::from(edge) * (1 + options.rounds as u64) / 200;
                let what = (edge, options.rounds, presets.len());
                match on.description() {
                    // The CPU is not named: a report goes on on another machine.
                    None => (view, device, unit(name, &what, weight)),
                    Some(gpu) => (view, device, unit(name, &(what, gpu), weight)),
                }
            })
            .collect();
        let fine = if very_large { 0 } else { views.len() };
        let sweep_units: Vec<_> = options
            .occupancies
            .iter()
            .filter(|_| fine > 0)
            .map(|&occupancy| {
                let what = (&options.frequencies, options.sweep_edge, options.rounds);
                (occupancy, unit(format!("sweep-{occupancy}"), &what, 9000))
            })
            .collect();
        let ablation_unit =
            (fine > 0).then(|| unit("ablation".into(), &(options.sweep_edge, options.rounds), 9000));
        let heat_units: Vec<_> = (0..=fine.max(1))
            .map(|view| {
                let what = (options.heat_edge, options.seed, options.random_rays, presets.len());
                unit(format!("heat-{view}"), &what, 2500)
            })
            .collect();
        let picture_units: Vec<_> = views
            .iter()
            .map(|view| unit(format!("pictures-{}", view.number), &options.picture_edge, 3000))
            .collect();

        let mut all: Vec<&Unit> = tree_units.iter().chain(&heat_units).chain(&picture_units).collect();
        all.extend(frame_units.iter().map(|(.., unit)| unit));
        all.extend(sweep_units.iter().map(|(_, unit)| unit));
        all.extend(&ablation_unit);
        // What is there already tells nothing about the time left.
        all.retain(|unit| !self.store.has(&unit.name, &unit.decides));
        self.progress.expect(all.iter().map(|unit| unit.weight).sum());
        self.left.set(all.len());

        let mut out = Scene {
            name: scene.name.clone(),
            hash: hash.clone(),
            triangles: scene.mesh.len() as u64,
            vertices: scene.mesh.vertices().len() as u64,
            degenerate: 0,
            mesh_bytes: scene.mesh.memory_bytes(),
            very_large,
            published: self.published(scene, very_large),
            views: views.clone(),
            trees: Vec::new(),
            frames: Vec::new(),
            sweep: Vec::new(),
            ablation: None,
            heat: Vec::new(),
            pictures: Vec::new(),
        };
        for (preset, unit) in presets.iter().zip(&tree_units) {
            let (degenerate, tree) = self.unit(unit, || trees::measure(self, &mut trees, *preset, builds))?;
            out.degenerate = degenerate;
            out.trees.push(tree);
        }
        for (index, unit) in picture_units.iter().enumerate() {
            let view = &views[index];
            out.pictures.extend(self.unit(unit, || pictures::measure(self, &mut trees, view))?);
        }
        for (index, unit) in heat_units.iter().enumerate() {
            let view = index.checked_sub(1).map(|index| &views[index]);
            out.heat.push(self.unit(unit, || heat::measure(self, &mut trees, &presets, view))?);
        }
        for (view, device, unit) in &frame_units {
            let device = &*self.devices[*device];
            match self.unit(unit, || frames::measure(self, &mut trees, &presets, view, device)) {
                Err(ReportError::Render { error: DeviceError::Failed(_), .. }) if device.is_optional() => {
                    self.progress.done(unit.weight);
                    self.left.set(self.left.get().saturating_sub(1));
                }
                frames => out.frames.push(frames?),
            }
        }
        for (occupancy, unit) in &sweep_units {
            out.sweep.push(self.unit(unit, || sweep::measure(self, &mut trees, &views[0], *occupancy))?);
        }
        if let Some(unit) = &ablation_unit {
            out.ablation = Some(self.unit(unit, || ablation::measure(self, &mut trees, &views[0]))?);
        }
        Ok(out)
    }

    /// Builds one procedural scene at several sizes.
    pub fn scaling(&self) -> Result<Vec<ScalingPoint>, ReportError> {
        let options = self.options;
        let units = options.scaling.iter().map(|&triangles| Unit {
            name: format!("scaling-{triangles}"),
            decides: format!("{} {:?} {}", scaling::SCENE, options.threads, options.builds),
            weight: u64::from(triangles) * options.builds as u64 / 40,
        });
        let units: Vec<_> = units.collect();
        let missing = units.iter().filter(|unit| !self.store.has(&unit.name, &unit.decides));
        let missing: Vec<_> = missing.map(|unit| unit.weight).collect();
        self.progress.expect(missing.iter().sum());
        self.left.set(missing.len());
        let mut points = Vec::new();
        for (unit, &triangles) in units.iter().zip(&options.scaling) {
            points.extend(self.unit(unit, || scaling::measure(self, triangles))?);
        }
        Ok(points)
    }

    /// All that was measured, to be written.
    pub fn raw(&self, scenes: Vec<Scene>, scaling: Vec<ScalingPoint>) -> Raw {
        self.progress.finish();
        Raw {
            schema: SCHEMA,
            tool: format!("slimkd report {}", env!("CARGO_PKG_VERSION")),
            date: day(SystemTime::now()),
            machine: Machine { gpu: self.devices.iter().find_map(|on| on.description()), ..Machine::here() },
            options: self.options.clone(),
            scenes,
            scaling,
            peers: Vec::new(),
            published: published::tables(),
        }
    }

    pub(super) fn check(&self) -> Result<(), ReportError> {
        self.progress.check()
    }

    fn published(&self, scene: &slimkd_scene::Scene, very_large: bool) -> Option<Published> {
        published::of_scene(&scene.name).filter(|_| !very_large)
    }

    /// A unit's result, from the disk or new.
    fn unit<T: Serialize + DeserializeOwned>(
        &self,
        unit: &Unit,
        work: impl FnOnce() -> Result<T, ReportError>,
    ) -> Result<T, ReportError> {
        self.check()?;
        if let Some(result) = self.store.get(&unit.name, &unit.decides) {
            return Ok(result);
        }
        if self.worked.get() && self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            return Err(ReportError::TimeUp { left: self.left.get().max(1) });
        }
        let result = work()?;
        self.check()?;
        self.store.put(&unit.name, &unit.decides, &result)?;
        self.progress.done(unit.weight);
        self.left.set(self.left.get().saturating_sub(1));
        self.worked.set(true);
        Ok(result)
    }

    /// The file's cameras, then views found by looking around.
    fn views(&self, trees: &mut Trees<'_>, hash: &str) -> Result<Vec<View>, ReportError> {
        let unit = Unit { name: format!("{}-views", trees.scene.name), decides: hash.to_owned(), weight: 0 };
        let views: Vec<View> = self.unit(&unit, || {
            trees.ensure(Preset::Standard)?;
            let (scene, tree) = (trees.scene, trees.get(Preset::Standard));
            let cameras = views::of_scene(scene, tree, views::VIEWS);
            Ok(cameras.iter().enumerate().map(|(index, camera)| View::new(index + 1, camera)).collect())
        })?;
        if views.is_empty() { Err(ReportError::NoView(trees.scene.name.clone())) } else { Ok(views) }
    }
}

impl View {
    fn new(number: usize, camera: &Camera) -> Self {
        Self {
            number,
            eye: camera.eye.to_array(),
            target: camera.target.to_array(),
            up: camera.up.to_array(),
            fov: camera.fov,
        }
    }

    pub(super) fn camera(&self) -> Camera {
        Camera { eye: self.eye.into(), target: self.target.into(), up: self.up.into(), fov: self.fov }
    }
}

/// Of the mesh and all that a picture depends on, textures' texels aside.
fn hash(scene: &slimkd_scene::Scene) -> String {
    let mut hasher = Xxh3::new();
    hasher.update(cast_slice(scene.mesh.vertices()));
    hasher.update(cast_slice(scene.mesh.triangles()));
    hasher.update(cast_slice(&scene.material_ids));
    let rest = (&scene.name, &scene.materials, &scene.cameras, &scene.lights, &scene.up);
    hasher.update(format!("{rest:?}").as_bytes());
    format!("{:016x}", hasher.digest())
}

/// The day in UTC, as 2013-10-07.
pub fn day(time: SystemTime) -> String {
    let days = time.duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs() / 86_400) as i64;
    // Hinnant's civil_from_days, for days after 1970.
    let shifted = days + 719_468;
    let (era, day) = (shifted / 146_097, shifted % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let of_year = day - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let date = of_year - (153 * month + 2) / 5 + 1;
    let (year, month) =
        if month < 10 { (year + 400 * era, month + 3) } else { (year + 400 * era + 1, month - 9) };
    format!("{year:04}-{month:02}-{date:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days() {
        let at = |seconds| day(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(at(0), "1970-01-01");
        assert_eq!(at(951_782_400), "2000-02-29");
        assert_eq!(at(1_381_104_000), "2013-10-07");
        assert_eq!(at(4_102_444_799), "2099-12-31");
    }
}
