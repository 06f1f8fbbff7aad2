//! Meshes and rays that several tests use.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part

pub mod layers;

use slimkd::{
    BuildOptions, Clipping, EncodedTree, HoistAlgorithm, KdTree, Layout, Preset, Ray, Splits, TriangleMesh,
};
pub use slimkd_util::Rng;

/// How many, from the environment or else `few`: what makes a campaign of a test.
pub fn how_many(variable: &str, few: u64) -> u64 {
    std::env::var(variable)
        .map_or(few, |n| n.parse().unwrap_or_else(|_| panic!("{variable}={n} is no number")))
}

/// Threads that a campaign takes, `SLIMKD_WORKERS`.
pub fn workers() -> u64 {
    how_many("SLIMKD_WORKERS", 2).max(1)
}

/// What `work` gives for each worker, on a thread each.
pub fn on_workers<T: Send>(work: impl Fn(u64) -> T + Sync) -> Vec<T> {
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = (0..workers()).map(|worker| scope.spawn(move || work(worker))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// Every preset, and each option that changes what a tree looks like, with each that it may meet.
pub fn variants() -> Vec<(String, BuildOptions)> {
    let mut out: Vec<(String, BuildOptions)> =
        Preset::ALL.iter().map(|&preset| (preset.to_string(), preset.into())).collect();
    // Layouts, clipping and collapse, on the constants of `standard`.
    for layout in [Layout::FourByte, Layout::TwoByte, Layout::Dense] {
        for clipping in [Clipping::Exact, Clipping::ExactFrom(40), Clipping::Box] {
            for byte_weight in [None, Some(0.0), Some(0.2)] {
                let mut options = BuildOptions::from(Preset::Standard);
                (options.layout, options.clipping) = (layout, clipping);
                (options.collapse, options.byte_weight) = (byte_weight.is_some(), byte_weight.unwrap_or(0.0));
                let collapse =
                    byte_weight.map_or_else(String::new, |weight| format!(", collapse at {weight}"));
                out.push((format!("{layout}, clipping {clipping}{collapse}"), options));
            }
        }
    }
    for preset in [Preset::PaperFast, Preset::PaperSmall] {
        for algorithm in [HoistAlgorithm::Strip, HoistAlgorithm::Rebuild] {
            for byte_weight in [None, Some(0.2)] {
                let mut options = BuildOptions::from(preset);
                options.hoisting.as_mut().unwrap().algorithm = algorithm;
                (options.collapse, options.byte_weight) = (byte_weight.is_some(), byte_weight.unwrap_or(0.0));
                let collapse =
                    byte_weight.map_or_else(String::new, |weight| format!(", collapse at {weight}"));
                out.push((format!("{preset}, {algorithm}{collapse}"), options));
            }
        }
    }
    for byte_weight in [0.0, 0.2] {
        let options =
            BuildOptions::from(Preset::Slim).with_layout(Layout::Wide).with_byte_weight(byte_weight);
        for splits in [Splits::Both, Splits::Space] {
            let options = options.clone().with_splits(splits).with_max_tree(None);
            out.push((format!("wide at {byte_weight}, splits {splits}"), options));
        }
    }
    for layout in [Layout::FourByte, Layout::TwoByte, Layout::Wide] {
        let mut options = BuildOptions::from(Preset::Slim);
        options.layout = layout;
        out.push((format!("slim, {layout}"), options));
    }
    out
}

/// Random triangles of mixed sizes in a cube of edge `scale` at `offset`.
pub fn soup(count: usize, scale: f32, offset: f32, seed: u64) -> TriangleMesh {
    let mut rng = Rng::new(seed);
    let mut vertices = Vec::new();
    for i in 0..count {
        let size = [0.02, 0.1, 0.5, 1.5][i % 4];
        let center = rng.point();
        for _ in 0..3 {
            let corner = rng.point();
            vertices.push(std::array::from_fn(|k| offset + scale * (center[k] + size * (corner[k] - 0.5))));
        }
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Twelve triangles of a box.
pub fn push_box(vertices: &mut Vec<[f32; 3]>, triangles: &mut Vec<[u32; 3]>, low: [f32; 3], size: [f32; 3]) {
    let first = vertices.len() as u32;
    for i in 0..8 {
        vertices.push(std::array::from_fn(|k| low[k] + if i >> k & 1 == 1 { size[k] } else { 0.0 }));
    }
    for [a, b, c, d] in [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]] {
        triangles.push([first + a, first + b, first + c]);
        triangles.push([first + a, first + c, first + d]);
    }
}

/// A closed sphere: an octahedron subdivided `levels` times.
pub fn sphere(levels: u32) -> TriangleMesh {
    use std::collections::HashMap;
    let mut vertices: Vec<[f32; 3]> = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut next = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let (p, q) = (vertices[i as usize], vertices[j as usize]);
                    let sum: [f32; 3] = std::array::from_fn(|k| p[k] + q[k]);
                    let length = sum.iter().map(|x| x * x).sum::<f32>().sqrt();
                    vertices.push(sum.map(|x| x / length));
                    vertices.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = next;
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Rays that break sloppy code, in equal parts: random, axis-parallel, through edges, through vertices, in a triangle's
/// plane, grazing, starting on a surface, along coordinates of vertices (likely split planes), with odd ranges.
pub fn hard_rays(mesh: &TriangleMesh, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
    for vertex in mesh.vertices().iter().filter(|v| v.iter().all(|x| x.is_finite())) {
        for k in 0..3 {
            low[k] = low[k].min(vertex[k]);
            high[k] = high[k].max(vertex[k]);
        }
    }
    let inside = |rng: &mut Rng, grow: f32| -> [f32; 3] {
        std::array::from_fn(|k| {
            let (middle, half) = (0.5 * low[k] + 0.5 * high[k], 0.5 * high[k] - 0.5 * low[k]);
            middle + grow * half * (2.0 * rng.unit() - 1.0)
        })
    };
    let sub = |a: [f32; 3], b: [f32; 3]| -> [f32; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let corners = mesh.corners(rng.below(mesh.len()) as u32);
        let [a, b, c] = corners;
        let s = rng.unit();
        let on_edge: [f32; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]));
        let r = rng.unit() * (1.0 - s);
        let on_face: [f32; 3] = std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + r * (c[k] - a[k]));
        let origin = inside(&mut rng, 1.2);
        let axis = rng.below(3);
        let sign = if rng.below(2) == 0 { 1.0 } else { -1.0 };
        let along: [f32; 3] = std::array::from_fn(|k| if k == axis { sign } else { 0.0 });
        let ray = match rays.len() % 10 {
            0 => Ray::new(origin, sub(inside(&mut rng, 1.0), origin)),
            1 => {
                let mut start = on_face;
                start[axis] =
                    if sign > 0.0 { low[axis] } else { high[axis] } - sign * (high[axis] - low[axis]);
                Ray::new(start, along)
            }
            2 => Ray::new(origin, sub(on_edge, origin)),
            3 => Ray::new(origin, sub(a, origin)),
            4 => {
                let start: [f32; 3] = std::array::from_fn(|k| on_edge[k] - 2.0 * (c[k] - on_edge[k]));
                Ray::new(start, sub(c, start))
            }
            5 => {
                let mut start = origin;
                start[axis] = on_face[axis] + 1e-6 * (high[axis] - low[axis]) * sign;
                Ray::new(start, sub(on_face, start))
            }
            6 => Ray::new(on_face, sub(inside(&mut rng, 1.0), on_face)),
            7 => {
                // Inside a likely split plane, axis-parallel or not.
                let mut start = origin;
                start[axis] = a[axis];
                let mut direction = sub(inside(&mut rng, 1.0), start);
                direction[axis] = 0.0;
                if rng.below(2) == 0 {
                    direction[(axis + 1) % 3] = 0.0;
                }
                Ray::new(start, direction)
            }
            8 => {
                // Towards a point of a face, over a range that begins or ends exactly there.
                let ray = Ray::new(origin, sub(on_face, origin));
                if rng.below(2) == 0 { ray.with_range(0.5, 1.0) } else { ray.with_range(1.0, 2.0) }
            }
            _ => {
                let scale = [1e-12, 1e12, 1e-3, 3.0][rng.below(4)];
                let direction = sub(on_face, origin).map(|x| x * scale);
                Ray::new(origin, direction).with_range(f32::NEG_INFINITY, f32::INFINITY)
            }
        };
        rays.push(ray);
    }
    rays
}

/// What holds for every tree: counts, sizes and histograms agree with each other and with the mesh.
pub fn check_invariants(scene: &str, variant: &str, tree: &KdTree) {
    let (s, m, mesh) = (tree.statistics(), tree.memory(), tree.mesh());
    let context = format!("{scene}, {variant}");
    let r = &s.leaf_references;
    // The slides' size formula.
    let plain = 8 * (s.nodes.inner + s.nodes.t_inner + s.nodes.leaf)
        + 8 * s.nodes.t_inner
        + 4 * r.four_byte
        + 2 * r.two_byte;
    let is_wide = matches!(tree.encoded(), EncodedTree::Wide { .. });
    if is_wide {
        // 256 bytes a node, 3 or 4 a leaf's header, at most 5 a further reference, 8 behind the end.
        let most = m.nodes + 4 * s.nodes.leaf + 5 * r.other + 8;
        assert_eq!(m.nodes, 256 * s.nodes.inner, "{context}");
        assert!((m.nodes + 3 * s.nodes.leaf + 8..=most).contains(&m.tree()), "{context}");
    } else if r.other == 0 {
        assert_eq!(m.tree(), plain, "{context}");
    } else {
        // 4 bytes an inner node, at most 8 a leaf's header, at most 5 a further reference, 8 behind the end.
        let least = 4 * s.nodes.inner + s.nodes.leaf + 8;
        assert!(
            (least..=least + 4 * s.nodes.inner + 7 * s.nodes.leaf + 5 * r.other).contains(&m.tree()),
            "{context}"
        );
    }
    assert_eq!(m.resident(), m.tree() + mesh.memory_bytes(), "{context}");
    if is_wide {
        // Each node after the root takes one of its parent's 16 children.
        assert!(s.nodes.leaf <= 15 * s.nodes.inner + 1, "{context}");
    } else {
        assert_eq!(s.nodes.leaf, s.nodes.inner + s.nodes.t_inner + 1, "{context}");
    }
    assert_eq!(s.t_references, s.nodes.t_inner, "{context}");
    assert_eq!(s.triangles, mesh.len() as u64, "{context}");
    assert_eq!(s.duplication[0], 0, "{context}: a triangle is lost");
    assert_eq!(s.duplication.iter().sum::<u64>(), s.triangles - s.degenerate, "{context}");
    assert_eq!(s.leaf_depths.iter().sum::<u64>(), s.nodes.leaf, "{context}");
    assert_eq!(s.leaf_depths.len(), s.max_depth as usize + 1, "{context}");
    assert!(s.leaf_depths[s.max_depth as usize] > 0, "{context}");
    assert!(s.nodes.empty_leaf < s.nodes.leaf, "{context}");
    assert!(s.references() >= s.triangles - s.degenerate, "{context}");
    assert!(s.sah_cost.is_finite() && s.sah_cost > 0.0, "{context}");
}
