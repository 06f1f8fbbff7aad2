//! Models far from 0: the origin that every format gets.

use slimkd::{BuildOptions, KdTree, OpenTree, Preset, RayF64, Tracer, TriangleMesh};
use slimkd_scene::{
    Format, Light, LoadOptions, Origin, Scene, WarningKind, load, load_bytes, load_bytes_with, procedural,
    write_ply,
};
use std::{fs, io::Write};

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

/// A triangle of a city, in tenths of millimetres.
const CITY: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[0.0001,0.0001,0.0001],
    "translate":[528980.0,5183520.0,10.0]},"CityObjects":{"a":{"type":"Building","geometry":[
    {"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}]}},
    "vertices":[[8501,61002,25003],[23004,35505,20000],[10000,6,57000]]}"#;

#[test]
fn city_models_have_origins() {
    let line = CITY.replace('\n', " ");
    for (format, text) in [(Format::CityJson, CITY), (Format::CityJsonSeq, &line)] {
        let scene = load_bytes(format, text.as_bytes()).unwrap();
        assert_eq!(scene.mesh.origin(), [528_984.0, 5_183_520.0, 0.0], "{format}");
        assert!(scene.rounding > 0.0 && scene.rounding < 1e-6 && scene.warnings.is_empty(), "{format}");
        assert_near(&scene, &CORNERS, "city");
    }
}

/// A serialized mesh of doubles.
fn serialized(corners: &[[f64; 3]; 3]) -> Vec<u8> {
    let mut content = [0x2000u32.to_le_bytes().as_slice(), b"a\0"].concat();
    content.extend([3u64, 1].into_iter().flat_map(u64::to_le_bytes));
    content.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    content.extend([0u32, 1, 2].into_iter().flat_map(u32::to_le_bytes));
    let mut out = vec![0x1c, 0x04, 4, 0];
    let mut encoder = flate2::write::ZlibEncoder::new(&mut out, flate2::Compression::default());
    encoder.write_all(&content).unwrap();
    encoder.finish().unwrap();
    out
}

#[test]
fn scenes_of_mitsuba_have_origins_whose_parts_are_far_or_near() {
    let far = serialized(&CORNERS);
    let scene = load_bytes(Format::Serialized, &far).unwrap();
    assert!(scene.rounding < 1e-6 && scene.mesh.origin()[1] != 0.0, "{}", scene.rounding);
    assert_near(&scene, &CORNERS, "serialized");

    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let obj = |[x, y, z]: [f64; 3]| {
        let lines = CORNERS.map(|[a, b, c]| format!("v {:.4} {:.4} {:.4}\n", a - x, b - y, c - z)).concat();
        lines + "f 1 2 3\n"
    };
    fs::write(at("far.serialized"), far).unwrap();
    fs::write(at("far.obj"), obj([0.0; 3])).unwrap();
    fs::write(at("near.obj"), obj([528_980.0, 5_183_520.0, 10.0])).unwrap();
    let moved = r#"<transform name="to_world"><translate x="528980" y="5183520" z="10"/></transform>"#;
    let shape = |plugin: &str, inside: &str| format!(r#"<shape type="{plugin}">{inside}</shape>"#);
    let file = |name: &str| format!(r#"<string name="filename" value="{name}"/>"#);
    let body = [
        shape("serialized", &file("far.serialized")),
        shape("obj", &file("far.obj")),
        shape("obj", &(file("near.obj") + moved)),
        shape("sphere", r#"<point name="center" x="528980.0001" y="5183520.0002" z="10.0003"/>"#),
        r#"<emitter type="point"><point name="position" x="528981.25" y="5183521.5" z="12"/></emitter>"#
            .into(),
        format!(r#"<sensor type="perspective">{moved}</sensor>"#),
    ]
    .concat();
    fs::write(at("scene.xml"), format!(r#"<scene version="3.0.0">{body}</scene>"#)).unwrap();
    let scene = load(at("scene.xml")).unwrap();
    let origin = scene.mesh.origin();
    assert!(origin[0] != 0.0 && origin[1] != 0.0 && scene.rounding < 3e-6, "{origin:?} {}", scene.rounding);
    let found = world(&scene);
    for (k, (found, expected)) in found.iter().zip([CORNERS; 3].as_flattened()).enumerate() {
        let apart = (0..3).map(|k| (found[k] - expected[k]).powi(2)).sum::<f64>().sqrt();
        assert!(apart <= scene.rounding + 1e-9, "{k}: {found:?} is not {expected:?}");
    }
    for found in &found[9..] {
        let centre = [528_980.000_1, 5_183_520.000_2, 10.000_3];
        let radius = (0..3).map(|k| (found[k] - centre[k]).powi(2)).sum::<f64>().sqrt();
        assert!((radius - 1.0).abs() <= scene.rounding + 1e-9, "{found:?}: {radius}");
    }
    let there = |point: [f32; 3]| [0, 1, 2].map(|k| origin[k] + f64::from(point[k]));
    assert_eq!(there(scene.cameras[0].eye.to_array()), [528_980.0, 5_183_520.0, 10.0]);
    let Light::Point { position, .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
    assert_eq!(there(position.to_array()), [528_981.25, 5_183_521.5, 12.0]);
}

#[test]
fn a_mesh_without_vertices_has_no_origin() {
    assert_eq!(TriangleMesh::default().origin(), [0.0; 3]);
}

/// A model near 0 loses its corners beside one that is far away, and that is told; two of one place keep theirs.
#[test]
fn merged_scenes_that_f32_spoils_are_warned_of() {
    let wall = load_bytes(Format::Obj, WALL).unwrap();
    let near = load_bytes(Format::Obj, b"v 0.1 0.2 0.3\nv 1.7 0.2 0.3\nv 0.1 1.9 0.3\nf 1 2 3\n").unwrap();
    let warnings = |scenes: [&Scene; 2]| Scene::merge(scenes.map(Scene::clone).to_vec()).unwrap().warnings;
    let told = warnings([&wall, &near]);
    assert!(told.len() == 1 && told[0].kind == WarningKind::Precision, "{told:?}");
    assert_eq!((warnings([&wall, &wall]), warnings([&near, &near])), (vec![], vec![]));
}
