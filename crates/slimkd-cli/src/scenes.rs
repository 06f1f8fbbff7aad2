//! Scenes by file or by built-in name.

use crate::args::SceneDetails;
use crate::failure::Failure;
use crate::interrupt;
use crate::saved::{self, is_saved};
use crate::trees::Origin;
use crate::ui::{Ui, grouped};
use rayon::prelude::*;
use slimkd::{KdTree, Progress};
use slimkd_scene::procedural::{self, BuiltIn};
use slimkd_scene::{FileKind, LoadError, LoadOptions, Scene, Warning, WarningKind};
use std::fmt::Write;
use std::fs::File;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often Ctrl-C is looked at while a scene is generated.
const TICK: Duration = Duration::from_millis(50);

/// A scene and how long it took to get it.
pub(crate) struct Loaded {
    /// The scene.
    pub(crate) scene: Scene,
    /// Its path as it was given, or the built-in scene's name: what messages call it.
    pub(crate) place: String,
    /// Wall time, s.
    pub(crate) seconds: f64,
    /// Its tree, where that was saved.
    pub(crate) tree: Option<KdTree>,
}

impl Loaded {
    /// What its trees say of it.
    pub(crate) fn origin(&self) -> Origin {
        Origin { name: self.scene.name.clone(), place: self.place.clone(), load_seconds: self.seconds }
    }
}

/// Loads a file, or generates the built-in scene of that name. `./kitchen` is always a file.
pub(crate) fn load(path: &Path, details: &SceneDetails, ui: Ui) -> Result<Loaded, Failure> {
    if details.files.scene_index.is_some() && (is_saved(path) || find(path).is_some()) {
        let what = "only scene files have a choice of --scene-index; leave it out";
        return Err(Failure::Usage(format!("{}: {what}", path.display())));
    }
    if details.files.origin.is_some() && (find(path).is_some() || (is_saved(path) && details.mesh.is_none()))
    {
        let what = "only scene files have a choice of --origin; leave it out";
        return Err(Failure::Usage(format!("{}: {what}", path.display())));
    }
    if is_saved(path) {
        return saved::load(path, details, ui);
    }
    if details.mesh.is_some() {
        let what = "only a saved tree takes a --mesh; leave it out";
        return Err(Failure::Usage(format!("{}: {what}", path.display())));
    }
    if let Some(found) = find(path) {
        return generate(found, details.triangles, ui);
    }
    if details.triangles.is_some() {
        return Err(fixed_size(path));
    }
    if !path.exists() {
        return Err(unknown(path));
    }
    let (progress, started) = (Progress::new(), Instant::now());
    let mut options = LoadOptions::new();
    options.scene_index = details.files.scene_index;
    options.allow_outside = details.files.allow_outside;
    options.origin = details.files.origin.unwrap_or_default();
    let scene = ui.watch("load", &progress, || slimkd_scene::load_with(path, &options, &progress)).map_err(
        |error| match error {
            LoadError::Cancelled => Failure::Interrupted,
            // These name the file themselves.
            LoadError::Read { .. } | LoadError::NotAFile { .. } | LoadError::UnknownFormat { .. } => {
                Failure::work(error)
            }
            other => Failure::at(path, other),
        },
    )?;
    let place = path.display().to_string();
    ui.warn_of(&place, &scene.warnings)?;
    if let [x, y, z] = scene.mesh.origin()
        && [x, y, z] != [0.0; 3]
    {
        let rounding = scene.rounding;
        ui.note(format_args!(
            "{place}: origin {x},{y},{z}; rounding moves no vertex farther than {rounding:.1e}"
        ));
    }
    Ok(Loaded { scene, place, seconds: started.elapsed().as_secs_f64(), tree: None })
}

/// Loads a scene, and what `more` names, into one.
pub(crate) fn load_all(
    path: &Path,
    more: &[PathBuf],
    details: &SceneDetails,
    ui: Ui,
) -> Result<Loaded, Failure> {
    if let Some(tree) = std::iter::once(path).chain(more.iter().map(PathBuf::as_path)).find(|p| is_saved(p))
        && !more.is_empty()
    {
        let what = "a saved tree is a scene alone; build one from all the scene files";
        return Err(Failure::Usage(format!("{}: {what}", tree.display())));
    }
    if more.is_empty() {
        return load(path, details, ui);
    }
    more.iter().try_for_each(|path| check(path))?;
    let paths = || std::iter::once(path).chain(more.iter().map(PathBuf::as_path));
    if details.triangles.is_some() && paths().all(|path| find(path).is_none()) {
        return Err(fixed_size(path));
    }
    let (mut scenes, mut seconds) = (Vec::new(), 0.0);
    for path in paths() {
        // Each of the built-in ones gets so many.
        let triangles = details.triangles.filter(|_| find(path).is_some());
        let mut next = load(path, &SceneDetails { triangles, ..details.clone() }, ui)?;
        let warnings = std::mem::take(&mut next.scene.warnings);
        next.scene.warnings = warnings.into_iter().map(|warning| warning.within(&next.place)).collect();
        seconds += next.seconds;
        scenes.push(next.scene);
    }
    let told = scenes.iter().map(|scene| scene.warnings.len()).sum();
    let scene = Scene::merge(scenes).map_err(|error| Failure::at(path, error))?;
    let place = format!("{} and {} more", path.display(), more.len());
    ui.warn_of(&place, scene.warnings.get(told..).unwrap_or_default())?;
    Ok(Loaded { scene, place, seconds, tree: None })
}

/// The warning of triangles that can never be hit, where there are any.
pub(crate) fn degenerate(count: u64, total: u64) -> Option<Warning> {
    let what = "triangles are collinear or not finite and can never be hit";
    (count > 0).then(|| Warning::counted(WarningKind::Degenerate, count, total, what))
}

/// Refuses a scene in which nothing can ever be hit, and says how many triangles cannot be; for scenes of which no tree tells that.
pub(crate) fn check_triangles(loaded: &Loaded, ui: Ui) -> Result<(), Failure> {
    let mesh = &loaded.scene.mesh;
    let count = (0..mesh.len() as u32).into_par_iter().filter(|&id| mesh.is_degenerate(id)).count();
    let (count, total) = (count as u64, mesh.len() as u64);
    usable(&loaded.place, count, total)?;
    ui.warn_of(&loaded.place, degenerate(count, total).as_slice())
}

/// Refuses a scene in which nothing can ever be hit.
pub(crate) fn usable(place: &str, degenerate: u64, triangles: u64) -> Result<(), Failure> {
    if triangles > degenerate {
        return Ok(());
    }
    let what = match triangles {
        0 => "there is no triangle in it".to_owned(),
        n => format!("all {} triangles are collinear or not finite", grouped(n)),
    };
    Err(Failure::work(format_args!("{place}: {what}; export the scene's surfaces as triangles")))
}

/// Refuses what [`load`] would refuse unread.
pub(crate) fn check(path: &Path) -> Result<(), Failure> {
    if find(path).is_some() {
        return Ok(());
    }
    let unreadable = |source| Failure::work(LoadError::Read { path: path.to_owned(), source });
    if !path.exists() {
        return Err(unknown(path));
    }
    if !path.is_dir() && FileKind::of(path).is_none() {
        return Err(Failure::work(LoadError::UnknownFormat { path: path.to_owned() }));
    }
    // Not opened before: a pipe could block for ever.
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err(Failure::work(LoadError::NotAFile { path: path.to_owned() }));
    }
    File::open(path).map(drop).map_err(unreadable)
}

/// The files among what is read, which no output may be.
pub(crate) fn files<'a>(scene: &'a Path, details: &'a SceneDetails) -> impl Iterator<Item = &'a Path> {
    [Some(scene), details.mesh.as_deref()].into_iter().flatten().filter(|path| find(path).is_none())
}

/// The built-in scene of that name.
pub(crate) fn find(path: &Path) -> Option<&'static BuiltIn> {
    path.to_str().and_then(procedural::find)
}

/// Generates the built-in scene `name`.
pub(crate) fn built_in(name: &str, triangles: Option<NonZeroU32>, ui: Ui) -> Result<Loaded, Failure> {
    generate(procedural::find(name).ok_or_else(|| unknown(Path::new(name)))?, triangles, ui)
}

/// The built-in scenes as a table.
pub(crate) fn list() -> String {
    let mut out = String::new();
    let width = procedural::list().iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    for BuiltIn { name, description, triangles, .. } in procedural::list() {
        let triangles = grouped(*triangles as u64);
        let _ = writeln!(out, "{name:width$}  {triangles:>10} triangles  {description}");
    }
    out
}

/// The error for `--triangles` with a file.
pub(crate) fn fixed_size(path: &Path) -> Failure {
    Failure::Usage(format!(
        "{}: only built-in scenes have a choice of --triangles; leave it out",
        path.display()
    ))
}

fn unknown(path: &Path) -> Failure {
    let names: Vec<_> = procedural::list().iter().map(|scene| scene.name).collect();
    let what = format_args!(
        "neither a file nor a built-in scene; check the path, or take one of {}",
        names.join(", ")
    );
    Failure::at(path, what)
}

/// Generation cannot be cancelled: on Ctrl-C its thread is left behind, and ends with the process.
fn generate(found: &'static BuiltIn, asked: Option<NonZeroU32>, ui: Ui) -> Result<Loaded, Failure> {
    let triangles = asked.map_or(found.triangles, |count| count.get() as usize);
    let started = Instant::now();
    let (done, scenes) = channel();
    std::thread::spawn(move || {
        // After Ctrl-C nobody listens any more.
        let _ = done.send(procedural::generate(found.name, triangles));
    });
    let scene = loop {
        match scenes.recv_timeout(TICK) {
            Ok(scene) => break scene,
            Err(RecvTimeoutError::Timeout) => interrupt::check()?,
            Err(RecvTimeoutError::Disconnected) => break None,
        }
    };
    let scene = scene.ok_or_else(|| {
        Failure::work(format_args!("{}: no such scene of {triangles} triangles; ask for fewer", found.name))
    })?;
    if scene.mesh.len() > triangles {
        let (fewest, asked) = (grouped(scene.mesh.len() as u64), grouped(triangles as u64));
        ui.note(format_args!("{}: {fewest} triangles, the fewest that it can have, not {asked}", found.name));
    }
    let place = found.name.to_owned();
    Ok(Loaded { scene, place, seconds: started.elapsed().as_secs_f64(), tree: None })
}
