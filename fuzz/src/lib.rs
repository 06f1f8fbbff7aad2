//! What is fuzzed. Each target takes any bytes and panics only where the library is wrong: libFuzzer calls them from
//! `src/bin`, and `tests/corpus.rs` replays the corpus and its mutations with plain `cargo test`.

mod input;
mod resign;
mod scenes;

use input::Input;
pub use scenes::{
    COMPRESSIONS, FORMATS, cityjson, draco, draco_file, gltf, grids, meshopt, meshopt_file, mitsuba, obj,
    off, ply, scene, stl,
};
use slimkd::{BruteForce, BuildOptions, KdTree, OpenTree, Progress, Ray, Tracer, TriangleMesh};
use std::sync::{Arc, LazyLock};

/// `.skd` files. An odd first byte makes the checksums right before the rest is read, so that what lies behind them
/// is reached; whatever is accepted must answer every query and survive another round.
pub fn skd(data: &[u8]) {
    let Some((&signed, file)) = data.split_first() else { return };
    let mut file = file.to_vec();
    if signed & 1 == 1 {
        resign::resign(&mut file);
    }
    opened(&file, data);
    let Ok(tree) = KdTree::read(&mut &file[..]) else { return };
    let mut input = Input::new(data);
    for _ in 0..16 {
        let ray = input.ray(tree.mesh());
        let all = tree.all(&ray);
        assert!(all.windows(2).all(|pair| pair[0].t <= pair[1].t));
        tree.closest(&ray);
        tree.any(&ray);
        tree.nearest(ray.origin, f32::INFINITY);
    }
    if tree.check_complete(&Progress::new()).is_ok() {
        // Then it answers as brute force does, whoever made it.
        let oracle = BruteForce::new(tree.mesh());
        for _ in 0..16 {
            let ray = input.ray(tree.mesh());
            assert_eq!(tree.all(&ray).len(), oracle.all(&ray).len(), "{ray:?}");
            assert_eq!(bits(tree.closest(&ray)), bits(oracle.closest(&ray)), "{ray:?}");
        }
    }
    let statistics = tree.statistics();
    assert!(statistics.references() >= tree.mesh().len() as u64 - statistics.degenerate);
    tree.memory();
    let mut again = Vec::new();
    tree.write(&mut again).unwrap();
    assert!(again == file, "two files for one tree");
}

/// A tree that nobody proved: every query ends, and where the whole file is a tree, it answers as that.
fn opened(file: &[u8], data: &[u8]) {
    let Ok(open) = OpenTree::open(file) else { return };
    let proved = open.verify().ok();
    let mut input = Input::new(data);
    let rays: Vec<Ray> = (0..16).map(|_| input.ray(&TriangleMesh::default())).collect();
    let mut hits = vec![None; rays.len()];
    open.batch().coherent().closest(&rays, &mut hits);
    for (ray, hit) in rays.iter().zip(&hits) {
        let (all, nearest) = (open.all(ray), open.nearest(ray.origin, f32::INFINITY));
        if let Some(tree) = &proved {
            assert_eq!(bits(*hit), bits(tree.closest(ray)), "{ray:?}");
            assert_eq!((open.any(ray), all), (tree.any(ray), tree.all(ray)), "{ray:?}");
            assert_eq!(nearest, tree.nearest(ray.origin, f32::INFINITY), "{ray:?}");
        }
        let triangle = hit.map_or(7, |hit| hit.triangle);
        assert!(open.triangle(triangle).is_some() || open.corners(triangle).is_none());
    }
    assert!(proved.is_none() || open.check().is_ok(), "what was proved is never broken");
}

/// Any mesh under any options says what brute force says.
pub fn soup(data: &[u8]) {
    let mut input = Input::new(data);
    let options = input.options();
    let mesh = Arc::new(input.mesh());
    let oracle = BruteForce::new(&mesh);
    let tree = KdTree::build(Arc::clone(&mesh), &options).expect("any small mesh builds");
    let rays: Vec<_> = (0..24).map(|_| input.ray(&mesh)).collect();
    rays.iter().for_each(|ray| compare(&tree, &oracle, ray));
    compare_batches(&tree, &rays);
    assert_eq!(tree.check_complete(&Progress::new()), Ok(()));
    let mut file = Vec::new();
    tree.write(&mut file).unwrap();
    assert_eq!(KdTree::read(&mut &file[..]).unwrap().statistics(), tree.statistics());
}

/// Ray files: 32 bytes a ray, any bits, over a mesh with shared planes, slivers and degenerate triangles.
pub fn rays(data: &[u8]) {
    static TREES: LazyLock<Vec<KdTree>> = LazyLock::new(|| {
        let mut seed = [0u8; 1200];
        let mut state = 1u32;
        seed.iter_mut().for_each(|byte| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *byte = (state >> 24) as u8;
        });
        let mesh = Arc::new(Input::new(&seed).mesh());
        let build = |&preset| KdTree::build(Arc::clone(&mesh), &BuildOptions::from(preset)).unwrap();
        slimkd::Preset::ALL.iter().map(build).collect()
    });
    let oracle = BruteForce::new(TREES[0].mesh());
    let ray = |bytes: &[u8]| {
        let [ox, oy, oz, t_min, dx, dy, dz, t_max] =
            std::array::from_fn(|k| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte])));
        Ray { origin: [ox, oy, oz], direction: [dx, dy, dz], t_min, t_max }
    };
    let rays: Vec<_> = data.chunks_exact(32).take(64).map(ray).collect();
    for tree in &*TREES {
        rays.iter().for_each(|ray| compare(tree, &oracle, ray));
        compare_batches(tree, &rays);
    }
}

fn bits(hit: Option<slimkd::Hit>) -> Option<(u32, u32, u32, u32)> {
    hit.map(|hit| (hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle))
}

/// Streams and packets say what single rays say.
fn compare_batches(tree: &KdTree, rays: &[Ray]) {
    let (mut hits, mut any) = (vec![None; rays.len()], vec![false; rays.len()]);
    for (coherent, batch) in [(false, tree.batch()), (true, tree.batch().coherent())] {
        batch.closest(rays, &mut hits);
        batch.any(rays, &mut any);
        for (at, ray) in rays.iter().enumerate() {
            let expected = tree.closest(ray);
            assert_eq!(bits(hits[at]), bits(expected), "{:?} {coherent} {ray:?}", tree.options().preset);
            assert_eq!(any[at], expected.is_some(), "{:?} {coherent} {ray:?}", tree.options().preset);
        }
        // Every other ray leaves out what it hits, and a filter refuses every third triangle.
        let own = |ray: &Ray| tree.closest(ray).map_or(u32::MAX, |hit| hit.triangle);
        let except: Vec<u32> =
            rays.iter().enumerate().map(|(at, ray)| if at % 2 == 0 { own(ray) } else { u32::MAX }).collect();
        let accept = |at: usize, hit: &slimkd::Hit| hit.triangle as usize % 3 != at % 3;
        batch.except(&except).closest(rays, &mut hits);
        batch.except(&except).filter(&accept).any(rays, &mut any);
        for (at, ray) in rays.iter().enumerate() {
            let expected = tree.query().except(except[at]).closest(ray);
            assert_eq!(bits(hits[at]), bits(expected), "{:?} {coherent} {ray:?}", tree.options().preset);
            let expected = tree.query().except(except[at]).filter(&mut |hit| accept(at, hit)).any(ray);
            assert_eq!(any[at], expected, "{:?} {coherent} {ray:?}", tree.options().preset);
        }
    }
}

fn compare(tree: &KdTree, oracle: &BruteForce<'_>, ray: &Ray) {
    let preset = tree.options().preset;
    let expected = oracle.closest(ray);
    assert_eq!(bits(tree.closest(ray)), bits(expected), "{preset:?} {ray:?}");
    assert_eq!(tree.any(ray), expected.is_some(), "{preset:?} {ray:?}");
    let all = oracle.all(ray);
    assert_eq!(tree.all(ray).len(), all.len(), "{preset:?} {ray:?}");
    if let Some(own) = expected.map(|hit| hit.triangle) {
        let rest = oracle.query().filter(&mut |hit| hit.triangle != own).closest(ray);
        assert_eq!(bits(tree.query().except(own).closest(ray)), bits(rest), "{preset:?} {ray:?}");
    }
    let nearest =
        |point: Option<slimkd::NearestPoint>| point.map(|point| (point.distance.to_bits(), point.triangle));
    let [here, there] = [oracle.nearest(ray.origin, ray.t_max), tree.nearest(ray.origin, ray.t_max)];
    assert_eq!(nearest(there), nearest(here), "{preset:?} {ray:?}");
}

/// A mesh for seeds.
pub fn small_mesh(data: &[u8]) -> TriangleMesh {
    Input::new(data).mesh()
}
