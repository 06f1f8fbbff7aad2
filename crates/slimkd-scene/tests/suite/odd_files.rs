//! Files that are odd but valid, or broken in a way that other programs' users met: each stands for its kind.

use serde_json::Value;
use slimkd::{BuildOptions, KdTree, Ray, RayF64, Tracer};
use slimkd_scene::{Format, Scene, WarningKind, load_bytes};
use std::collections::BTreeMap;
use std::sync::Arc;

fn load(format: Format, bytes: impl AsRef<[u8]>) -> Scene {
    load_bytes(format, bytes.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn area(scene: &Scene) -> f64 {
    let corners = |id| scene.mesh.corners(id).map(|p| p.map(f64::from));
    let triangle = |id| {
        let [a, b, c] = corners(id);
        let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        0.5 * n.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    (0..scene.mesh.len() as u32).map(triangle).sum()
}

#[test]
fn obj_concave_polygons_have_their_area() {
    // A plus sign of five unit squares, and an L whose first corner comes again at its end.
    let plus = "v 1 0 0\nv 2 0 0\nv 2 1 0\nv 3 1 0\nv 3 2 0\nv 2 2 0\nv 2 3 0\nv 1 3 0\nv 1 2 0\nv 0 2 0\nv 0 1 0\nv 1 1 0\n\
        f 1 2 3 4 5 6 7 8 9 10 11 12\n";
    let scene = load(Format::Obj, plus);
    assert_eq!(scene.mesh.len(), 10);
    assert!((area(&scene) - 5.0).abs() < 1e-6 && scene.warnings.is_empty());
    let l = "v 0 0 0\nv 0 0 2\nv 0 1 2\nv 0 1 1\nv 0 2 1\nv 0 2 0\nf -6 -5 -4 -3 -2 -1 -6\n";
    let scene = load(Format::Obj, l);
    assert_eq!(scene.mesh.len(), 5);
    assert!((area(&scene) - 3.0).abs() < 1e-6 && scene.warnings.is_empty());
}

#[test]
fn obj_attributes_go_with_the_corners_of_a_clipped_polygon() {
    let arrow = "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 0 0\nvt 4 0\nvt 1 1\nvt 0 4\nvn 0 0 1\n\
        f 1/4//1\n";
    assert!(load_bytes(Format::Obj, arrow.as_bytes()).is_err());
    let arrow =
        "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nvt 9 9\nvt 0 0\nvt 4 0\nvt 1 1\nvt 0 4\nf 1/2 2/3 3/4 4/5\n";
    let scene = load(Format::Obj, arrow);
    let uvs = scene.uvs.as_ref().unwrap();
    for id in 0..2 {
        let corners = scene.mesh.corners(id);
        let uv = uvs.corners(id, scene.mesh.triangles()[id as usize]).unwrap();
        for (corner, uv) in corners.iter().zip(uv) {
            assert_eq!(corner[..2], uv);
        }
    }
    assert!((area(&scene) - 4.0).abs() < 1e-6);
}

#[test]
fn obj_polygons_that_cross_themselves_are_counted() {
    let bow = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nv 0 0 1\nf 1 2 3 4\nf 1 2 5\n";
    let scene = load(Format::Obj, bow);
    assert_eq!((scene.warnings.len(), scene.warnings[0].kind), (1, WarningKind::Polygon));
}

#[test]
fn obj_backslashes_join_numbers_and_nothing_else() {
    let head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for before in ["# C:\\models\\", "o path\\", "g a\\", "usemtl a\\", "#\\"] {
        let scene = load(Format::Obj, format!("{head}{before}\nf 1 2 3\n"));
        assert_eq!(scene.mesh.len(), 1, "{before}");
    }
    assert_eq!(load(Format::Obj, format!("{head}f 1 \\\n2 \\\n3\n")).mesh.len(), 1);
    assert_eq!(load(Format::Obj, format!("{head}f 1 2 3 # see D:\\\nf 3 2 1\n")).mesh.len(), 2);
}

#[test]
fn obj_line_ends_comments_and_names() {
    for end in ["\n", "\r\n", "\r"] {
        let text =
            "v 0 0 0#a\nv 1 0 0 #b\nv 0 1 0\nusemtl a b#c\nf 1 2 3#d\nf 1// 2// 3//\n".replace('\n', end);
        let scene = load(Format::Obj, text);
        assert_eq!((scene.mesh.len(), scene.materials[0].name.as_str()), (2, "a b#c"));
    }
}

#[test]
fn obj_vertex_colours() {
    let colours = |text: &str| load(Format::Obj, text).colours.map(|colours| colours.values);
    assert_eq!(colours("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), None);
    let shares = "v 0 0 0 1 0 0.5\nv 1 0 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
    assert_eq!(colours(shares).unwrap(), [[255, 0, 128, 255], [255; 4], [0, 0, 255, 255]]);
    let bytes = "v 0 0 0 255 0 128\nv 1 0 0 1 2 3\nv 0 1 0 0 0 255 255\nf 1 2 3\n";
    assert_eq!(colours(bytes).unwrap(), [[255, 0, 128, 255], [1, 2, 3, 255], [0, 0, 255, 255]]);
    // A fourth number alone is a weight.
    assert_eq!(colours("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n"), None);
}

const HEADER: &str =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty float y\nproperty int z\n";
const POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n";

#[test]
fn ply_line_ends_marks_and_blank_lines() {
    let body = format!(
        "{HEADER}element face 1\nproperty list float double vertex_index\nend_header\n{POINTS}3 0 1 2\n"
    );
    for end in ["\n", "\r\n", "\r"] {
        let text = body.replace('\n', end);
        assert_eq!(load(Format::Ply, &text).mesh.triangles(), [[0, 1, 2]]);
        assert_eq!(load(Format::Ply, format!("\u{feff}{text}")).mesh.len(), 1);
        let mark = text.replacen(&format!("end_header{end}"), &format!("end_header{end}\u{feff}"), 1);
        assert_eq!(load(Format::Ply, mark).mesh.len(), 1);
        let blank = text.replacen(&format!("end_header{end}"), &format!("end_header{end}{end}{end}"), 1);
        assert_eq!(load(Format::Ply, blank).mesh.len(), 1);
    }
}

#[test]
fn ply_strips_turn_and_begin_anew() {
    let strips = |lists: &str, count: usize| {
        let header =
            format!("{HEADER}element tristrips {count}\nproperty list int int vertex_indices\nend_header\n");
        load(Format::Ply, format!("{header}{POINTS}{lists}")).mesh.triangles().to_vec()
    };
    assert_eq!(strips("8 0 1 2 3 -1 3 1 0\n", 1), [[0, 1, 2], [1, 3, 2], [3, 1, 0]]);
    assert_eq!(strips("4 -1 0 1 2\n4 1 2 3 -1\n", 2), [[0, 1, 2], [1, 2, 3]]);
    assert!(strips("3 0 1 -1\n", 1).is_empty());
    // Strips that are joined by triangles without area keep those triangles' ids.
    assert_eq!(strips("5 0 1 1 2 3\n", 1), [[0, 1, 1], [1, 2, 1], [1, 2, 3]]);
}

#[test]
fn ply_faces_before_vertices() {
    let text = format!(
        "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n\
         property float x\nproperty float y\nproperty float z\nend_header\n4 0 1 3 2\n{POINTS}"
    );
    assert_eq!(load(Format::Ply, text).mesh.triangles(), [[0, 1, 3], [0, 3, 2]]);
}

#[test]
fn ply_colours_and_corner_texture_coordinates() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 2\n\
        property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty float red\n\
        property float green\nproperty float blue\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n\
        3 0 1 2 6 0 0 1 0 0 1 1 0.5 0\n3 2 1 0 0 0 0 1\n";
    let scene = load(Format::Ply, text);
    assert_eq!(scene.colours.unwrap().values, [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]]);
    assert_eq!(scene.face_colours, [[255, 128, 0, 255], [0, 0, 255, 255]]);
    let uvs = scene.uvs.unwrap();
    assert_eq!(uvs.corners(0, [0, 1, 2]), Some([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]));
    assert_eq!(uvs.corners(1, [2, 1, 0]), None);
}

#[test]
fn ply_binary_polygons_and_colours() {
    let mut bytes = b"ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
        property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        .to_vec();
    for (x, y) in [(0f32, 0f32), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)] {
        for value in [x, y, 0.0] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([1, 2, 3, 4]);
    }
    bytes.push(4);
    for index in 0..4i32 {
        bytes.extend(index.to_le_bytes());
    }
    let scene = load(Format::Ply, &bytes);
    assert!((area(&scene) - 4.0).abs() < 1e-6 && scene.mesh.len() == 2);
    assert_eq!(scene.colours.unwrap().values, [[1, 2, 3, 4]; 4]);
}

const FACET: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

#[test]
fn stl_text_is_words() {
    let text = format!("solid a b\n{FACET}{FACET}endsolid a b\n");
    let two = format!("solid a facet 1\n{FACET}endsolid a\nsolid b\n{FACET}endsolid b\n");
    for text in [
        text.clone(),
        text.replace('\n', " "),
        text.replace('\n', "\r"),
        text.replace('\n', "\r\n\r\n\t"),
        text.replace("endloop", "end loop").replace("endfacet", "end facet").replace("endsolid", "end solid"),
        text.replace("0 0 1\n", "nan nan nan\n"),
        format!("\u{feff}{text}"),
        two,
    ] {
        let scene = load(Format::Stl, &text);
        assert_eq!(scene.mesh.len(), 2, "{text}");
        assert!(scene.warnings.is_empty(), "{text}");
    }
    let open = load(Format::Stl, format!("solid a\n{FACET}"));
    assert_eq!((open.mesh.len(), open.warnings.len()), (1, 1));
}

#[test]
fn stl_counts_that_nobody_filled_in() {
    for (count, start) in [(0u32, &b"made"[..]), (u32::MAX, b"made"), (0, b"solid "), (u32::MAX, b"solid ")] {
        let mut bytes = start.to_vec();
        bytes.resize(80, 0);
        bytes.extend(count.to_le_bytes());
        for _ in 0..2 {
            for value in [0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.extend([0; 2]);
        }
        let scene = load(Format::Stl, &bytes);
        assert_eq!((scene.mesh.len(), scene.warnings.len()), (2, 1), "{count}");
    }
}

#[test]
fn other_files_are_read_from_the_folder_and_below_alone() {
    use slimkd_scene::{LoadOptions, load, load_with};
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("model");
    std::fs::create_dir_all(folder.join("below")).unwrap();
    let mtl = "newmtl a\nKd 1 0 0\n";
    for place in [outer.path().join("out.mtl"), folder.join("below/in.mtl")] {
        std::fs::write(place, mtl).unwrap();
    }
    let progress = slimkd::Progress::new();
    let loaded = |library: &str, allow_outside: bool| {
        let path = folder.join("a.obj");
        std::fs::write(&path, format!("mtllib {library}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"))
            .unwrap();
        let mut options = LoadOptions::default();
        options.allow_outside = allow_outside;
        let scene = load_with(&path, &options, &progress).unwrap();
        assert!(allow_outside || load(&path).unwrap().warnings == scene.warnings);
        scene.warnings.is_empty()
    };
    let absolute = outer.path().join("out.mtl");
    assert!(loaded("below/in.mtl", false) && loaded("below/../below\\in.mtl", false));
    for outside in ["../out.mtl", "below/../../out.mtl", "..\\out.mtl", absolute.to_str().unwrap()] {
        assert!(!loaded(outside, false), "{outside}");
        assert!(loaded(outside, true), "{outside}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&absolute, folder.join("link.mtl")).unwrap();
        assert!(!loaded("link.mtl", false) && loaded("link.mtl", true));
    }
}

/// The cases that other programs answered wrongly, where they are at hand, with everything that is expected of them.
#[test]
fn the_shared_cases_come_out_right() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases");
    if !folder.is_dir() {
        eprintln!("skipped: {folder:?} is not there");
        return;
    }
    let expected = std::fs::read(folder.join("expected.json")).unwrap();
    let expected: BTreeMap<String, Value> = serde_json::from_slice(&expected).unwrap();
    for (name, expected) in &expected {
        let scene = slimkd_scene::load(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let tree = KdTree::build(Arc::clone(&scene.mesh), &BuildOptions::default()).unwrap();
        for (key, expected) in expected.as_object().unwrap() {
            match key.as_str() {
                "triangles" => assert_eq!(Some(scene.mesh.len() as u64), expected.as_u64(), "{name}"),
                "area" => assert!((area(&scene) - expected.as_f64().unwrap()).abs() < 1e-4, "{name}"),
                "corners" => assert_eq!(&serde_json::json!(scene.mesh.triangles()), expected, "{name}"),
                "vertex_colours" => {
                    let colours = scene.colours.as_ref().unwrap().values.iter();
                    let opaque: Vec<_> = colours.map(|[r, g, b, a]| ([r, g, b], *a == 255)).collect();
                    assert!(opaque.iter().all(|colour| colour.1), "{name}");
                    let colours: Vec<_> = opaque.iter().map(|colour| colour.0).collect();
                    assert_eq!(&serde_json::json!(colours), expected, "{name}");
                }
                // An origin, a direction, and t or null.
                "rays" | "rays_f64" => {
                    for ray in expected.as_array().unwrap() {
                        let vector = |at: usize| [0, 1, 2].map(|k| ray[at][k].as_f64().unwrap());
                        let (start, direction) = (vector(0), vector(1));
                        let t = if key == "rays" {
                            let (start, direction) = (start.map(|x| x as f32), direction.map(|x| x as f32));
                            tree.closest(&Ray::new(start, direction)).map(|hit| f64::from(hit.t))
                        } else {
                            tree.closest_f64(&RayF64::new(start, direction)).map(|hit| hit.t)
                        };
                        assert_eq!(t, ray[2].as_f64(), "{name}: {ray}");
                    }
                }
                other => panic!("{name}: {other} is not checked"),
            }
        }
    }
}

#[test]
fn an_l_shaped_building_has_its_roof() {
    // Walls of quads, and a roof and a floor with a corner that turns inwards.
    let plan = [(0, 0), (9, 0), (9, 4), (4, 4), (4, 9), (0, 9)];
    let mut text = String::new();
    for z in [0, 5] {
        for (x, y) in plan {
            text += &format!("v {x} {y} {z}\n");
        }
    }
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    for k in 0..6 {
        let next = (k + 1) % 6;
        text += &format!("f {} {} {} {}\n", k + 1, next + 1, next + 7, k + 7);
    }
    let scene = load(Format::Obj, text);
    assert_eq!(scene.mesh.len(), 20);
    assert!((area(&scene) - (2.0 * 56.0 + 36.0 * 5.0)).abs() < 1e-3);
    let check = slimkd_scene::MeshCheck::of(&scene.mesh);
    assert_eq!((check.open_edges, check.non_manifold_edges, check.flipped_edges, check.parts), (0, 0, 0, 1));
}
