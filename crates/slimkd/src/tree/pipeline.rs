//! From a mesh to a tree: sort out, construct, reduce, encode.

use super::{KdTree, walk};
use crate::construct::{self, Builder, Pace};
use crate::geometry::{Aabb, TriangleMesh};
use crate::job::{Job, Progress};
use crate::layout::wide::{LeafCode, Wide};
use crate::layout::{self, Encoded, WideNode};
use crate::options::{BuildError, BuildOptions, Layout};
use crate::plan::{Widened, search_weight, widen};
use crate::reduce::{fit, hoist, prune};
use crate::threads;
use std::sync::Arc;

/// One more thread is used for each so many triangles. Measured on three built-in scenes of 2,500 to 64,000 triangles: two
/// threads are as fast as one up to 4,000 triangles, and 1.4 to 1.7 times as fast from 8,000 on.
const TRIANGLES_A_THREAD: usize = 2048;
/// About how often pruning passes over all nodes of the plan, whether it tries one weight or several. The progress moves by this.
const LOOPS_OF_PRUNING: usize = 8;
/// About how often encoding, and the walk that measures the depth, pass over all nodes of the plan. The progress moves by this.
const LOOPS_OF_ENCODING: usize = 3;

/// Builds a tree on as many threads as its options say.
pub(super) fn build(
    mesh: Arc<TriangleMesh>,
    options: &BuildOptions,
    progress: &Progress,
) -> Result<KdTree, BuildError> {
    options.validate()?;
    let work = || build_here(mesh.clone(), options, progress);
    match options.threads {
        None => work(),
        Some(threads) => {
            let useful = threads.get().min(mesh.len() / TRIANGLES_A_THREAD).max(1);
            threads::with(useful, work).map_err(|refused| BuildError::Threads(refused.why))?
        }
    }
}

/// Builds a tree on the current threads.
fn build_here(
    mesh: Arc<TriangleMesh>,
    options: &BuildOptions,
    progress: &Progress,
) -> Result<KdTree, BuildError> {
    // 1. Collect the triangles that can be hit, and their bounds. Degenerate ones are not given to the builder.
    let job = Job::new(&mesh, options, progress);
    let pace = Pace::of(options, mesh.len(), threads::count());
    progress.begin(pace.scan);
    let valid = mesh.valid_triangles_until(|| progress.is_cancelled());
    job.check()?;
    let (triangles, bounds) = valid.ok_or(BuildError::OutOfMemory { bytes: 4 * mesh.len() as u64 })?;
    let degenerate = (mesh.len() - triangles.len()) as u64;

    if options.layout == Layout::Wide
        && let Some((wide, depth, byte_weight)) = wide_tree(&triangles, &bounds, &job)?
    {
        drop((triangles, job));
        let own_options = BuildOptions {
            threads: None,
            max_tree: None,
            max_build_bytes: None,
            byte_weight,
            ..options.clone()
        };
        progress.finish();
        return Ok(KdTree {
            mesh,
            options: own_options,
            bounds,
            encoded: Encoded::Wide(wide),
            depth,
            degenerate,
        });
    }

    // 2. Construct a plan of the standard tree.
    let budget = options.max_tree.map(|most| most.bytes(mesh.len()));
    let builder = Builder::new(&job, bounds, budget)?;
    let plan = builder.build(&triangles, &pace)?;
    drop(triangles);

    // 3. Reduce the plan: make T-references, then turn subtrees into leaves where that is worth it. With a budget, `fit` also finds
    //    the byte weight at which the tree keeps to it; the tree's own options state that weight.
    progress.begin(pace.hoist);
    let plan = hoist(plan, bounds, &builder, pace.hoist)?;
    drop(builder);
    progress.begin_loops(pace.prune, LOOPS_OF_PRUNING * plan.nodes.len());
    let mut own_options =
        BuildOptions { threads: None, max_tree: None, max_build_bytes: None, ..options.clone() };
    let plan = match budget {
        Some(bytes) => {
            let (plan, byte_weight) = fit(plan, bounds, bytes, &job)?;
            (own_options.collapse, own_options.byte_weight) = (true, byte_weight);
            plan
        }
        None if options.collapse => prune(plan, bounds, options.byte_weight, &job)?,
        None => plan,
    };

    // 4. Encode the plan as bytes, and measure the depth, which sizes the traversal's stack.
    job.memory.take(plan.bytes())?; // no layout takes more
    progress.begin_loops(pace.encode, LOOPS_OF_ENCODING * plan.nodes.len());
    let encoded = layout::encode(&plan, &bounds, &job)?;
    drop((plan, job));
    let mut tree = KdTree { mesh, options: own_options, bounds, encoded, depth: 0, degenerate };
    tree.depth = walk::max_depth(&tree, progress)?;
    progress.finish();
    Ok(tree)
}

/// A wide tree, its depth and the weight of bytes that it has. `None` where a wide tree cannot be: with T-references, without a triangle, in a
/// scene that no grid holds, and where no wide tree is as small as it must be.
fn wide_tree(
    triangles: &[u32],
    bounds: &Aabb,
    job: &Job<'_>,
) -> Result<Option<(Wide, u32, f32)>, BuildError> {
    let options = job.options;
    if options.hoisting.is_some() || triangles.is_empty() || !layout::wide::holds(bounds) {
        return Ok(None);
    }
    let budget = options.max_tree.map(|most| most.bytes(job.mesh.len()));
    if budget.is_some_and(|most| layout::wide::least_size(triangles.len()) > most) {
        return Ok(None);
    }
    job.progress.begin(0.8);
    let forest = construct::boxes::build(triangles, bounds, 0.8, job)?;
    job.progress.begin_loops(0.15, 2 * forest.nodes());
    let code = LeafCode::new(job.mesh.len());
    let leaf_bytes = |ids: &[u32]| code.size(ids);
    let bytes = |tree: &Widened<'_>| layout::wide::size(tree, job.mesh.len());
    // What a byte costs in the tree of the fewest costs for rays: λ = ℓ · cost / bytes, as in other layouts.
    let fastest = widen(&forest, 0.0, size_of::<WideNode>(), &leaf_bytes, job)?;
    let cost_of_a_byte = fastest.cost() / bytes(&fastest) as f64;
    drop(fastest);
    let at_weight = |weight: f32| {
        let lambda = f64::from(weight) * cost_of_a_byte;
        widen(&forest, lambda, size_of::<WideNode>(), &leaf_bytes, job)
    };
    // The search ends with the tree that it finds, or near it: mostly at its first step.
    let mut last = None;
    let weight = match budget {
        None => options.byte_weight,
        Some(most) => {
            let found = search_weight(options.byte_weight, None, most, |weight| {
                drop(last.take());
                let (_, tree) = last.insert((weight, at_weight(weight)?));
                Ok(bytes(tree))
            });
            if let Err(BuildError::TreeTooLarge { .. }) = found {
                drop(last);
                job.memory.give(forest.bytes());
                return Ok(None);
            }
            found?
        }
    };
    let widened = match last.take() {
        Some((found, tree)) if found == weight => tree,
        other => {
            drop(other);
            at_weight(weight)?
        }
    };
    job.progress.begin_loops(0.05, forest.nodes() / 4);
    let (wide, depth) = layout::wide::encode(&widened, bounds, job)?;
    Ok(Some((wide, depth, weight)))
}
