//! What is fuzzed. Each target takes any bytes and panics only where the library is wrong: libFuzzer calls them from
//! `src/bin`, and `tests/corpus.rs` replays the corpus and its mutations with plain `cargo test`.

mod input;
mod resign;

use input::Input;
use slimkd::{BruteForce, BuildOptions, KdTree, Progress, Ray, TriangleMesh};
use slimkd_scene::{Compression, FileKind, Format, load_bytes};
use std::sync::{Arc, LazyLock};

/// Formats that [`scene`]'s first byte chooses from.
pub const FORMATS: [Format; 5] = [Format::Ply, Format::Obj, Format::Stl, Format::Gltf, Format::Glb];
/// Compressions that it chooses from, in steps of the formats.
pub const COMPRESSIONS: [Compression; 3] = [Compression::None, Compression::Zstd, Compression::Gzip];

/// Scene files: the first byte names the format, the rest is the file.
pub fn scene(data: &[u8]) {
    let Some((&kind, file)) = data.split_first() else { return };
    let kind = usize::from(kind) % (FORMATS.len() * COMPRESSIONS.len());
    let (format, compression) = (FORMATS[kind % FORMATS.len()], COMPRESSIONS[kind / FORMATS.len()]);
    match load_bytes(FileKind { format, compression }, file) {
        Ok(scene) => {
            assert!(!scene.materials.is_empty());
            (0..scene.mesh.len() as u32).for_each(|id| drop(scene.material(id).clone()));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// `.skd` files. An odd first byte makes the checksums right before the rest is read, so that what lies behind them
/// is reached; whatever is accepted must answer every query and survive another round.
pub fn skd(data: &[u8]) {
    let Some((&signed, file)) = data.split_first() else { return };
    let mut file = file.to_vec();
    if signed & 1 == 1 {
        resign::resign(&mut file);
    }
    let Ok(tree) = KdTree::read(&mut &file[..]) else { return };
    let mut input = Input::new(data);
    for _ in 0..16 {
        let ray = input.ray(tree.mesh());
        let all = tree.all_hits(&ray);
        assert!(all.windows(2).all(|pair| pair[0].t <= pair[1].t));
        tree.closest_hit(&ray);
        tree.any_hit(&ray);
        tree.closest_point(ray.origin, f32::INFINITY);
    }
    if tree.check_complete(&Progress::new()).is_ok() {
        // Then it answers as brute force does, whoever made it.
        let oracle = BruteForce::new(tree.mesh());
        for _ in 0..16 {
            let ray = input.ray(tree.mesh());
            assert_eq!(tree.all_hits(&ray).len(), oracle.all_hits(&ray).len(), "{ray:?}");
            assert_eq!(bits(tree.closest_hit(&ray)), bits(oracle.closest_hit(&ray)), "{ray:?}");
        }
    }
    let statistics = tree.statistics();
    assert!(statistics.references() >= tree.mesh().len() as u64 - statistics.degenerate);
    tree.memory();
    let mut again = Vec::new();
    tree.write(&mut again).unwrap();
    assert!(again == file, "two files for one tree");
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
    for coherent in [false, true] {
        if coherent {
            tree.closest_hits_coherent(rays, &mut hits);
            tree.any_hits_coherent(rays, &mut any);
        } else {
            tree.closest_hits(rays, &mut hits);
            tree.any_hits(rays, &mut any);
        }
        for (at, ray) in rays.iter().enumerate() {
            let expected = tree.closest_hit(ray);
            assert_eq!(bits(hits[at]), bits(expected), "{:?} {coherent} {ray:?}", tree.options().preset);
            assert_eq!(any[at], expected.is_some(), "{:?} {coherent} {ray:?}", tree.options().preset);
        }
    }
}

fn compare(tree: &KdTree, oracle: &BruteForce<'_>, ray: &Ray) {
    let preset = tree.options().preset;
    let expected = oracle.closest_hit(ray);
    assert_eq!(bits(tree.closest_hit(ray)), bits(expected), "{preset:?} {ray:?}");
    assert_eq!(tree.any_hit(ray), expected.is_some(), "{preset:?} {ray:?}");
    let all = oracle.all_hits(ray);
    assert_eq!(tree.all_hits(ray).len(), all.len(), "{preset:?} {ray:?}");
    if let Some(own) = expected.map(|hit| hit.triangle) {
        let rest = oracle.closest_hit_where(ray, |hit| hit.triangle != own);
        assert_eq!(bits(tree.closest_hit_except(ray, own)), bits(rest), "{preset:?} {ray:?}");
    }
    let nearest =
        |point: Option<slimkd::ClosestPoint>| point.map(|point| (point.distance.to_bits(), point.triangle));
    let [here, there] =
        [oracle.closest_point(ray.origin, ray.t_max), tree.closest_point(ray.origin, ray.t_max)];
    assert_eq!(nearest(there), nearest(here), "{preset:?} {ray:?}");
}

/// A mesh for seeds.
pub fn small_mesh(data: &[u8]) -> TriangleMesh {
    Input::new(data).mesh()
}
