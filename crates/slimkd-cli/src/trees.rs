//! From a scene to a tree, or a tree from its file, with everything that reports say about it.

use crate::args::{TreeArgs, listed};
use crate::failure::Failure;
use crate::interrupt;
use crate::scenes::{self, Loaded};
use crate::ui::Ui;
use slimkd::{
    BuildError, BuildOptions, CompletenessError, KdTree, Layout, Preset, Progress, TreeStatistics,
    TriangleMesh,
};
use slimkd_scene::Warning;
use slimkd_util::alloc;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::Instant;

/// What a build took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cost {
    /// Wall time of the build with reduction and encoding, s.
    pub(crate) seconds: f64,
    /// The most bytes live at a time, above what was live before: the mesh.
    pub(crate) peak: u64,
}

/// What a tree is of.
#[derive(Clone, Debug)]
pub(crate) struct Origin {
    /// The scene's name, for tables.
    pub(crate) name: String,
    /// Its path as it was given, or the built-in scene's name: what messages call it.
    pub(crate) place: String,
    /// Wall time of reading the scene or the tree, s.
    pub(crate) load_seconds: f64,
}

/// A tree that something can be hit in.
#[derive(Debug)]
pub(crate) struct Tree {
    /// What it is of.
    pub(crate) origin: Origin,
    /// The tree itself.
    pub(crate) tree: KdTree,
    /// Its shape.
    pub(crate) statistics: TreeStatistics,
    /// What the build took; `None` for a tree that was read.
    pub(crate) cost: Option<Cost>,
}

/// The number of threads that "all cores" means.
pub(crate) fn thread_count(threads: Option<NonZeroUsize>) -> usize {
    threads.map_or_else(rayon::current_num_threads, NonZeroUsize::get)
}

/// A pool of that many threads.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::work(format_args!("{threads} threads: {error}; give fewer with --threads")))
}

/// Builds the tree of a mesh.
pub(crate) fn build(
    origin: &Origin,
    mesh: &Arc<TriangleMesh>,
    options: &BuildOptions,
    ui: Ui,
) -> Result<Tree, Failure> {
    interrupt::check()?;
    let progress = Progress::new();
    let started = Instant::now();
    let label = options.preset.name();
    let work = || KdTree::build_with_progress(Arc::clone(mesh), options, &progress);
    let (tree, allocated) = alloc::count(|| ui.watch(label, &progress, work));
    let cost = Cost { seconds: started.elapsed().as_secs_f64(), peak: allocated.peak };
    let tree = tree.map_err(|error| match error {
        BuildError::Cancelled => Failure::Interrupted,
        other => Failure::work(format_args!("{}: {other}{}", origin.place, advice(&other, options))),
    })?;
    usable(Tree { origin: origin.clone(), statistics: tree.statistics(), tree, cost: Some(cost) })
}

/// What else the command line could say; only what it does not say yet.
fn advice(error: &BuildError, options: &BuildOptions) -> String {
    let is_small = matches!(options.preset, Preset::Slim | Preset::Tiny);
    let smaller = if is_small { "" } else { ", or use the preset slim or tiny" };
    match error {
        BuildError::TreeTooLarge { .. } => {
            let dense = match (options.layout, &options.hoisting) {
                // A wide tree that does not fit was tried as a dense one already.
                (Layout::Dense | Layout::Wide, _) => "",
                (_, None) => ", or take --layout dense",
                (_, Some(_)) => ", or take --layout dense and a preset without hoisting",
            };
            format!(" with --max-tree-bytes{dense}")
        }
        BuildError::BuildTooLarge { .. } => format!(" with --max-build-bytes{smaller}"),
        BuildError::OutOfMemory { .. } => smaller.to_owned(),
        _ => String::new(),
    }
}

/// The scene's saved tree, or else the one that is built for it.
pub(crate) fn take_or_build(loaded: &mut Loaded, args: &TreeArgs, ui: Ui) -> Result<Tree, Failure> {
    let Some(tree) = loaded.tree.take() else {
        return build(&loaded.origin(), &loaded.scene.mesh, &args.options(), ui);
    };
    warn_of_ignored(&loaded.place, &args.given(), ui);
    saved(loaded.origin(), tree)
}

/// Says which of the options that were given have no effect on a saved tree.
pub(crate) fn warn_of_ignored(place: &str, given: &[&str], ui: Ui) {
    let is = match given {
        [] => return,
        [_] => "is",
        _ => "are",
    };
    let what = "a saved tree keeps the options that it was built with";
    ui.warn(format_args!("{place}: {} {is} ignored: {what}", listed(given)));
}

/// Proves that the tree answers rays as brute force does, whoever made its file.
pub(crate) fn prove_complete(tree: &Tree, pool: &rayon::ThreadPool, ui: Ui) -> Result<(), Failure> {
    let progress = Progress::new();
    let proved = ui.watch("prove", &progress, || pool.install(|| tree.tree.check_complete(&progress)));
    proved.map_err(|error| match error {
        CompletenessError::Cancelled => Failure::Interrupted,
        other => Failure::work(format_args!("{}: {other}", tree.origin.place)),
    })?;
    ui.note(format_args!("{}: complete, no triangle is missing from any leaf", tree.origin.place));
    Ok(())
}

/// A tree that was read.
pub(crate) fn saved(origin: Origin, tree: KdTree) -> Result<Tree, Failure> {
    usable(Tree { origin, statistics: tree.statistics(), tree, cost: None })
}

/// Refuses a tree in which nothing can ever be hit.
fn usable(tree: Tree) -> Result<Tree, Failure> {
    let TreeStatistics { triangles, degenerate, .. } = tree.statistics;
    scenes::usable(&tree.origin.place, degenerate, triangles)?;
    Ok(tree)
}

/// Says how many triangles can never be hit; with `--strict` that is an error.
pub(crate) fn warn_of_degenerate(tree: &Tree, ui: Ui) -> Result<Option<Warning>, Failure> {
    let TreeStatistics { triangles, degenerate, .. } = tree.statistics;
    let warning = scenes::degenerate(degenerate, triangles);
    ui.warn_of(&tree.origin.place, warning.as_slice())?;
    Ok(warning)
}
