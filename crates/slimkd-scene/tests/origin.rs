//! Models far from 0: the origin that every format gets, and walls in world coordinates against exact arithmetic.
//!
//! The walls of one test run are few; `scripts/walls` takes as many as one likes (`SLIMKD_WALLS`).

use slimkd::{BuildOptions, KdTree, OpenTree, Preset, RayF64, Tracer, TriangleMesh};
use slimkd_scene::{Format, LoadOptions, Origin, Scene, load_bytes, load_bytes_with, procedural, write_ply};

const WALL: &[u8] =
    b"v 528980.85 183526.1 0\nv 528980.85 183526.1 3\nv 528982.3 183523.55 0\nv 528982.3 183523.55 3\n\
    f 2 1 3\nf 2 3 4\n";

/// The same in coordinates of the world.
fn world(scene: &Scene) -> Vec<[f64; 3]> {
    let origin = scene.mesh.origin();
    scene.mesh.vertices().iter().map(|vertex| [0, 1, 2].map(|k| origin[k] + f64::from(vertex[k]))).collect()
}

fn assert_near(scene: &Scene, expected: &[[f64; 3]], name: &str) {
    let found = world(scene);
    assert_eq!(found.len(), expected.len(), "{name}");
    for (found, expected) in found.iter().zip(expected) {
        let apart = (0..3).map(|k| (found[k] - expected[k]).powi(2)).sum::<f64>().sqrt();
        assert!(apart <= scene.rounding + 1e-10, "{name}: {found:?} is not {expected:?}, {apart}");
    }
}

#[test]
fn a_ray_beside_a_wall_in_utm_coordinates_misses_it() {
    let scene = load_bytes(Format::Obj, WALL).unwrap();
    assert_eq!(scene.mesh.origin(), [528_980.0, 183_524.0, 0.0]);
    assert!(scene.rounding > 0.0 && scene.rounding < 3e-7, "{}", scene.rounding);
    let away = RayF64::new(
        [528_981.583_692_901_2, 183_524.829_943_022_25, 1.0],
        [0.869_290_118_919_176_4, 0.494_302_224_503_879_8, 0.0],
    );
    let back = RayF64 { direction: away.direction.map(|x| -x), ..away };
    for preset in Preset::ALL {
        let tree = KdTree::build(scene.mesh.clone(), &BuildOptions::from(*preset)).unwrap();
        assert_eq!(tree.closest_f64(&away), None, "{preset}");
        let hit = tree.closest_f64(&back).unwrap();
        assert!((hit.t - 0.01).abs() < 2.0 * scene.rounding, "{preset}: {hit:?}");
        let mut bytes = Vec::new();
        tree.write(&mut bytes).unwrap();
        let open = OpenTree::open(bytes).unwrap();
        assert_eq!((open.closest_f64(&away), open.closest_f64(&back)), (None, Some(hit)), "{preset}");
    }
}

#[test]
fn models_near_0_have_no_origin() {
    for scene in procedural::list() {
        let scene = procedural::generate(scene.name, 4000).unwrap();
        let mut ply = Vec::new();
        write_ply(&scene.mesh, &mut ply).unwrap();
        let read = load_bytes(Format::Ply, &ply).unwrap();
        assert_eq!((read.mesh.origin(), read.rounding), ([0.0; 3], 0.0));
        assert_eq!(read.mesh, scene.mesh);
    }
    // Eight times the extent away is not far, and a single point has no extent.
    for (x, far) in [(7.0, false), (7.5, true), (-7.0, false), (-9.0, true)] {
        let obj = format!("v {x} 0 0\nv {} 0 0\nv {x} 1 0\nf 1 2 3\n", x + 1.0);
        let scene = load_bytes(Format::Obj, obj.as_bytes()).unwrap();
        assert_eq!(scene.mesh.origin() != [0.0; 3], far, "{x}: {:?}", scene.mesh.origin());
    }
    let point = load_bytes(Format::Obj, b"v 1e6 1e6 0\nf 1 1 1\n").unwrap();
    assert_eq!(point.mesh.origin(), [0.0; 3]);
}

#[test]
fn an_origin_can_be_chosen() {
    let load = |origin| load_bytes_with(Format::Obj, WALL, &LoadOptions::new().origin(origin)).unwrap();
    let none = load(Origin::None);
    assert_eq!((none.mesh.origin(), none.rounding), ([0.0; 3], 0.0));
    assert_eq!(none.mesh.vertices()[0], [528_980.85, 183_526.1, 0.0].map(|x: f64| x as f32));
    let at = load(Origin::At([528_000.0, 183_000.0, -1.0]));
    assert_eq!(at.mesh.origin(), [528_000.0, 183_000.0, -1.0]);
    assert_eq!(at.mesh.vertices()[0][2], 1.0);
    assert!(at.rounding > load(Origin::Auto).rounding);
    for wrong in ["", "here", "1,2", "1,2,3,4", "nan,0,0", "1e39,0,0"] {
        assert!(wrong.parse::<Origin>().is_err(), "{wrong}");
    }
    for right in ["auto", "none", "-1.5,2,3e5"] {
        assert_eq!(right.parse::<Origin>().unwrap().to_string().parse(), right.parse::<Origin>(), "{right}");
    }
}

/// A triangle with a tenth of a millimetre in each coordinate.
const CORNERS: [[f64; 3]; 3] = [
    [528_980.850_1, 5_183_526.100_2, 12.5003],
    [528_982.300_4, 5_183_523.550_5, 12.0],
    [528_981.0, 5_183_520.000_6, 15.7],
];

#[test]
fn every_format_is_read_as_exactly_as_it_is_written() {
    let lines = |before: &str| CORNERS.map(|[x, y, z]| format!("{before}{x} {y} {z}\n")).concat();
    let head = |encoding: &str, real: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty {real} x\nproperty {real} y\nproperty {real} z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    let face: Vec<u8> = [3].into_iter().chain([0i32, 1, 2].into_iter().flat_map(i32::to_le_bytes)).collect();
    let doubles: Vec<u8> = CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut files: Vec<(&str, Format, Vec<u8>)> = vec![
        ("obj", Format::Obj, (lines("v ") + "f 1 2 3\n").into()),
        ("off", Format::Off, format!("OFF\n3 1 0\n{}3 0 1 2\n", lines("")).into()),
        (
            "stl",
            Format::Stl,
            format!("solid\nfacet\nouter loop\n{}endloop\nendfacet\nendsolid\n", lines("vertex ")).into(),
        ),
        ("text ply, double", Format::Ply, (head("ascii", "double") + &lines("") + "3 0 1 2\n").into()),
        ("text ply, float", Format::Ply, (head("ascii", "float") + &lines("") + "3 0 1 2\n").into()),
        (
            "binary ply",
            Format::Ply,
            [head("binary_little_endian", "double").into_bytes(), doubles.clone(), face.clone()].concat(),
        ),
    ];
    // A list beside the coordinates keeps a binary file from the fast path.
    let odd = head("binary_little_endian", "double")
        .replace("element face", "property list uchar uchar extra\nelement face");
    let rows = doubles.chunks(24).flat_map(|row| row.iter().copied().chain([1, 7]));
    files.push(("binary ply with lists", Format::Ply, [odd.into_bytes(), rows.collect(), face].concat()));
    for (name, format, bytes) in files {
        let scene = load_bytes(format, &bytes).unwrap();
        assert_eq!(
            scene.mesh.origin(),
            [528_984.0, 5_183_520.0, 12.0].map(|x: f64| if x < 100.0 { 0.0 } else { x }),
            "{name}"
        );
        assert!(scene.rounding < 1e-6, "{name}: {}", scene.rounding);
        assert_near(&scene, &CORNERS, name);
    }
}

#[test]
fn coordinates_of_f32_stay_what_they_are() {
    let corners = CORNERS.map(|corner| corner.map(|x| x as f32));
    let mut stl = vec![0; 84];
    stl[80] = 1;
    stl.extend([0; 12]);
    stl.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    stl.extend([0; 2]);
    let scene = load_bytes(Format::Stl, &stl).unwrap();
    assert_ne!(scene.mesh.origin(), [0.0; 3]);
    assert_eq!(scene.rounding, 0.0);
    let expected = corners.map(|corner| corner.map(f64::from));
    assert_eq!(world(&scene), expected);
    // Written and read again.
    let mut ply = Vec::new();
    write_ply(&scene.mesh, &mut ply).unwrap();
    let again = load_bytes(Format::Ply, &ply).unwrap();
    assert_eq!(again.mesh, scene.mesh);
    // Two scenes of one region become one with one origin.
    let both = Scene::merge(vec![scene, load_bytes(Format::Obj, WALL).unwrap()]).unwrap();
    assert_eq!(world(&both)[..3], expected);
    assert!((world(&both)[3][0] - 528_980.85).abs() < 1.0 && both.rounding > 0.0);
}

#[test]
fn grids_and_gltf_have_origins_too() {
    let grid = "ncols 3\nnrows 2\nxllcenter 528980.25\nyllcenter 5183520.75\ncellsize 0.1\n1 2 3\n4 5 6\n";
    let scene = load_bytes(Format::AsciiGrid, grid.as_bytes()).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let x = |column: f64| 528_980.25 + 0.1 * column;
    let at = |column, row: f64, z| [x(column), 5_183_520.75 + 0.1 * row, z];
    let expected = [
        at(0.0, 1.0, 1.0),
        at(1.0, 1.0, 2.0),
        at(2.0, 1.0, 3.0),
        at(0.0, 0.0, 4.0),
        at(1.0, 0.0, 5.0),
        at(2.0, 0.0, 6.0),
    ];
    assert_near(&scene, &expected, "grid");

    // Positions near 0, and a node that puts them into the world; its camera goes along.
    let corners: Vec<u8> =
        [0.1f32, 0.2, 0.3, 1.4, 0.5, 0.6, 0.7, 1.8, 0.9].iter().flat_map(|x| x.to_le_bytes()).collect();
    let json = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"scene":0,
        "nodes":[{"mesh":0,"translation":[528980.125,60.0,-5183520.5],"children":[1]},{"camera":0,"translation":[0.0,0.25,5.0]}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.1}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |x: usize| (x as u32).to_le_bytes();
    let mut glb =
        [*b"glTF", word(2), word(12 + 8 + json.len() + 8 + 36), word(json.len()), *b"JSON"].concat();
    glb.extend(json);
    glb.extend([word(36), *b"BIN\0"].concat());
    glb.extend(corners);
    let scene = load_bytes(Format::Glb, &glb).unwrap();
    let origin = scene.mesh.origin();
    assert!(origin[0] != 0.0 && origin[2] != 0.0, "{origin:?}");
    let moved =
        |[x, y, z]: [f32; 3]| [f64::from(x) + 528_980.125, f64::from(y) + 60.0, f64::from(z) - 5_183_520.5];
    assert_near(&scene, &[[0.1, 0.2, 0.3], [1.4, 0.5, 0.6], [0.7, 1.8, 0.9]].map(moved), "glb");
    let eye = scene.cameras[0].eye;
    assert_eq!(f64::from(eye.x) + origin[0], 528_980.125);
    assert_eq!(f64::from(eye.z) + origin[2], -5_183_515.5);
}

/// Numbers by SplitMix64.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// From −most to most.
    fn within(&mut self, most: f64) -> i128 {
        ((2.0 * self.unit() - 1.0) * most).round() as i128
    }
}

type Point = [i128; 3];

fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn length(a: Point) -> f64 {
    a.iter().map(|&x| (x as f64).powi(2)).sum::<f64>().sqrt()
}

/// Micrometres as metres, in decimals.
fn decimal(x: i128) -> String {
    let sign = if x < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", x.abs() / 1_000_000, x.abs() % 1_000_000)
}

/// A wall, and a ray near it. In micrometres, so that whole numbers decide what is hit.
struct Case {
    corner: Point,
    edges: [Point; 2],
    start: Point,
    direction: Point,
}

impl Case {
    /// From 10⁵ to 10⁷ m away, of 1 mm to 1 km.
    fn new(rng: &mut Rng) -> Self {
        let away = 1e6 * 10f64.powf(5.0 + 2.0 * rng.unit());
        let size = 1e6 * 10f64.powf(-3.0 + 6.0 * rng.unit());
        let corner = std::array::from_fn(|k| if k == 2 { rng.within(1e9) } else { rng.within(away) });
        let mut edge = || -> Point {
            loop {
                let edge = [(); 3].map(|()| rng.within(size));
                if length(edge) > 0.3 * size {
                    break edge;
                }
            }
        };
        let edges = loop {
            let edges = [edge(), edge()];
            if length(cross(edges[0], edges[1])) > 0.05 * length(edges[0]) * length(edges[1]) {
                break edges;
            }
        };
        let (s, t) = (0.1 + 0.8 * rng.unit(), 0.1 + 0.8 * rng.unit());
        let on: Point = std::array::from_fn(|k| {
            corner[k] + (s * edges[0][k] as f64 + t * edges[1][k] as f64).round() as i128
        });
        let normal = cross(edges[0], edges[1]);
        let scale = length(normal).max(1.0);
        // How far the ray starts from the wall: from a millionth of its size to its size.
        let far =
            size * 10f64.powf(-6.0 * rng.unit()) * if rng.next().is_multiple_of(2) { 1.0 } else { -1.0 };
        let start = std::array::from_fn(|k| on[k] + (far * normal[k] as f64 / scale).round() as i128);
        let direction = match rng.next() % 4 {
            0 => normal.map(|x| (1e6 * x as f64 / scale).round() as i128),
            1 => normal.map(|x| (-1e6 * x as f64 / scale).round() as i128),
            2 => sub(on, start),
            _ => [(); 3].map(|()| rng.within(1e6)),
        };
        Self { corner, edges, start, direction }
    }

    fn obj(&self) -> String {
        let [e, f] = self.edges;
        let corner = |s: i128, t: i128| -> String {
            let p: Point = std::array::from_fn(|k| self.corner[k] + s * e[k] + t * f[k]);
            format!("v {} {} {}\n", decimal(p[0]), decimal(p[1]), decimal(p[2]))
        };
        [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), "f 1 2 3 4\n".into()].concat()
    }

    /// Where the ray meets the wall, in units of its direction; the outer `None` where less than `near` micrometres decide that.
    fn truth(&self, near: f64) -> Option<Option<f64>> {
        let [e, f] = self.edges;
        let normal = cross(e, f);
        let to = sub(self.corner, self.start);
        if self.direction == [0; 3] {
            return None;
        }
        let (above, below) = (dot(to, normal), dot(self.direction, normal));
        // Both are below 2¹²⁷: 2³¹ for what is relative to the wall, cubed, times 6.
        if (above as f64).abs() < near * length(normal)
            || (below as f64).abs() < 1e-2 * length(normal) * length(self.direction)
        {
            return None;
        }
        if (above < 0) != (below < 0) {
            return Some(None);
        }
        // Weights of the edges at the crossing, as parts of below · normal².
        let t = above as f64 / below as f64;
        let seen = [0, 1, 2].map(|k| t * self.direction[k] as f64 - to[k] as f64);
        let square = length(normal).powi(2);
        let part = |a: [f64; 3], b: Point| {
            let b = b.map(|x| x as f64);
            let cross: [f64; 3] =
                std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
            (0..3).map(|k| cross[k] * normal[k] as f64).sum::<f64>() / square
        };
        let weights = [part(seen, f), -part(seen, e)];
        let margin = weights.iter().map(|w| w.min(1.0 - w)).fold(f64::INFINITY, f64::min);
        // A part of an edge is decided by the rounding of corners, which is far below a hundredth of it.
        if margin.abs() < 1e-2 { None } else { Some((margin > 0.0).then_some(t)) }
    }
}

#[test]
fn walls_far_away_are_met_from_the_right_side() {
    let cases: u64 =
        std::env::var("SLIMKD_WALLS").map_or(3000, |n| n.parse().expect("SLIMKD_WALLS is a number"));
    let mut rng = Rng(5);
    let (mut decided, mut hits) = (0u64, 0u64);
    for case in 0..cases {
        let wall = Case::new(&mut rng);
        let scene = load_bytes(Format::Obj, wall.obj().as_bytes()).unwrap();
        let preset = Preset::ALL[case as usize % Preset::ALL.len()];
        let tree = KdTree::build(scene.mesh.clone(), &preset.into()).unwrap();
        // The ray's decimals are rounded to f64 as well: below 2⁻²⁹ m.
        let largest = scene.mesh.vertices().as_flattened().iter().fold(0f32, |most, x| most.max(x.abs()));
        // Near 0 it is not measured.
        let moved = if scene.mesh.origin() == [0.0; 3] {
            f64::from(largest) * 2f64.powi(-23)
        } else {
            scene.rounding
        };
        let rounding = 1e6 * moved + 0.01;
        let metres = |p: Point| p.map(|x| decimal(x).parse::<f64>().unwrap());
        let ray = RayF64::new(metres(wall.start), wall.direction.map(|x| x as f64 * 1e-6));
        let Some(truth) = wall.truth(2.0 * rounding) else { continue };
        decided += 1;
        hits += u64::from(truth.is_some());
        let hit = tree.closest_f64(&ray);
        assert_eq!(hit.is_some(), truth.is_some(), "case {case}: {ray:?} at\n{}", wall.obj());
        assert_eq!(tree.any_f64(&ray), truth.is_some(), "case {case}");
        if let (Some(hit), Some(truth)) = (hit, truth) {
            // A hundredth of a radian at least between ray and wall, and corners that moved by the rounding.
            let apart = (hit.t - truth).abs() * length(wall.direction);
            assert!(
                apart <= 2000.0 * rounding,
                "case {case}: {hit:?} is not {truth}, {rounding}, {ray:?} at\n{}",
                wall.obj()
            );
        }
    }
    println!("{decided} of {cases} walls decided, {hits} hit: none wrong");
    assert!(decided * 10 > cases * 6 && hits * 4 > decided && hits * 4 < decided * 3, "{decided} {hits}");
}

#[test]
fn a_mesh_without_vertices_has_no_origin() {
    assert_eq!(TriangleMesh::default().origin(), [0.0; 3]);
}
