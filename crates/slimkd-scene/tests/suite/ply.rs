//! PLY files in all their variants.

use slimkd_scene::{Format, LoadError, Place, Scene, load_bytes};

fn load(bytes: &[u8]) -> Scene {
    load_bytes(Format::Ply, bytes).unwrap()
}

fn error(bytes: impl AsRef<[u8]>) -> LoadError {
    let error = load_bytes(Format::Ply, bytes.as_ref()).unwrap_err();
    assert!(!error.to_string().contains('\n'), "{error}");
    error
}

fn text(elements: &str, body: &str) -> String {
    format!("ply\nformat ascii 1.0\n{elements}end_header\n{body}")
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
const FACES: &str = "property list uchar int vertex_indices\n";

/// A pentagon, a triangle and a quad over 5 vertices, in any binary layout.
fn polygons(big: bool, index_type: &str, length_type: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut out = format!(
        "ply\nformat binary_{order}_endian 1.0\ncomment any\nelement vertex 5\n{XYZ}element face 3\n\
         property list {length_type} {index_type} vertex_index\nend_header\n"
    )
    .into_bytes();
    let number = |out: &mut Vec<u8>, kind: &str, value: f64| {
        let mut raw = match kind {
            "uchar" | "uint8" => vec![value as u8],
            "char" | "int8" => (value as i8).to_le_bytes().to_vec(),
            "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
            "short" | "int16" => (value as i16).to_le_bytes().to_vec(),
            "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
            "int" | "int32" => (value as i32).to_le_bytes().to_vec(),
            "float" | "float32" => (value as f32).to_le_bytes().to_vec(),
            _ => value.to_le_bytes().to_vec(),
        };
        if big {
            raw.reverse();
        }
        out.extend(raw);
    };
    for k in 0..5 {
        for axis in 0..3 {
            number(&mut out, "float", f64::from(10 * k + axis));
        }
    }
    for face in [&[0, 1, 2, 3, 4][..], &[4, 3, 2], &[1, 2, 3, 4]] {
        number(&mut out, length_type, face.len() as f64);
        face.iter().for_each(|&index| number(&mut out, index_type, f64::from(index)));
    }
    out
}

const FANS: [[u32; 3]; 6] = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 3, 2], [1, 2, 3], [1, 3, 4]];

#[test]
fn polygons_are_fans_in_every_layout() {
    for big in [false, true] {
        for index in ["uchar", "int8", "short", "ushort", "int", "uint32", "double"] {
            for length in ["uchar", "int8", "ushort", "int", "uint32"] {
                let scene = load(&polygons(big, index, length));
                assert_eq!(scene.mesh.triangles(), FANS, "{big} {index} {length}");
                assert_eq!(scene.mesh.vertices()[4], [40.0, 41.0, 42.0]);
                assert_eq!(scene.materials.len(), 1);
            }
        }
    }
}

#[test]
fn faces_of_equally_many_corners_take_the_fast_path_to_the_same_result() {
    for corners in 3..9u32 {
        for big in [false, true] {
            for (before, after) in [("", ""), ("property uchar red\n", "property double q\n")] {
                let order = if big { "big" } else { "little" };
                let mut bytes = format!(
                    "ply\nformat binary_{order}_endian 1.0\nelement vertex 20\nproperty double y\nproperty float z\n\
                     property short x\nproperty uchar red\nelement face 40\n{before}{FACES}{after}end_header\n"
                )
                .into_bytes();
                let mut push = |raw: &[u8]| {
                    if big {
                        bytes.extend(raw.iter().rev());
                    } else {
                        bytes.extend(raw);
                    }
                };
                for k in 0..20i16 {
                    push(&(f64::from(k) + 0.5).to_le_bytes());
                    push(&(f32::from(k) - 0.25).to_le_bytes());
                    push(&(-k).to_le_bytes());
                    push(&[9]);
                }
                let mut expected = Vec::new();
                for face in 0..40u32 {
                    let index = |k: u32| (face * 3 + k * 7) % 20;
                    if !before.is_empty() {
                        push(&[1]);
                    }
                    push(&[corners as u8]);
                    (0..corners).for_each(|k| push(&(index(k) as i32).to_le_bytes()));
                    if !after.is_empty() {
                        push(&1.0f64.to_le_bytes());
                    }
                    expected.extend((1..corners - 1).map(|k| [index(0), index(k), index(k + 1)]));
                }
                let scene = load(&bytes);
                assert_eq!(scene.mesh.triangles(), expected);
                assert_eq!(scene.mesh.vertices()[3], [-3.0, 3.5, 2.75]);
            }
        }
    }
}

#[test]
fn attributes_and_unknown_things_are_told_apart() {
    let elements = "obj_info made by hand\nelement camera 1\nproperty float view_px\nproperty list int float k\n\
        element vertex 3\nproperty uchar red\nproperty float nz\nproperty float nx\nproperty float ny\n\
        property list uchar int bones\nproperty double z\nproperty float x\nproperty float y\nproperty float s\n\
        property float t\nelement edge 2\nproperty int a\nproperty int b\nelement face 2\n\
        property list uchar float texcoord\nproperty list uchar int vertex_indices\nproperty uchar flags\n\
        element material 0\nproperty int z\n";
    let body = "7 2 1 1\n255 3 1 2 1 8 0.25 1 2 .5 .75\n255 6 4 5 0 30 10 20 0.0 1\n\
        255 9 7 8 2 1 2 300 100 200 0 1\n0 1 1 2\n0 3 2 1 0 1\n2 .1 .2 3 0 1 2 0\n";
    let scene = load(text(elements, body).as_bytes());
    assert_eq!(scene.mesh.vertices(), [[1.0, 2.0, 0.25], [10.0, 20.0, 30.0], [100.0, 200.0, 300.0]]);
    assert_eq!(scene.mesh.triangles(), [[2, 1, 0], [0, 1, 2]]);
    let normals = scene.normals.unwrap();
    assert_eq!(normals.values, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]);
    assert_eq!(normals.indices, None);
    assert_eq!(scene.uvs.unwrap().values, [[0.5, 0.75], [0.0, 1.0], [0.0, 1.0]]);
}

#[test]
fn faces_may_come_before_vertices_and_lines_may_end_as_on_windows() {
    let file =
        text(&format!("element face 1\n{FACES}element vertex 3\n{XYZ}"), "3 2 1 0\n0 0 0\n1 0 0\n0 1 0");
    let windows = file.replace('\n', "\r\n");
    assert_eq!(load(file.as_bytes()).mesh.triangles(), [[2, 1, 0]]);
    assert_eq!(load(windows.as_bytes()).mesh.triangles(), [[2, 1, 0]]);
}

#[test]
fn what_is_not_finite_and_degenerate_triangles_load() {
    let body = "nan 0 0\n-inf 1 1e39\n-nan(ind) 1.#INF 0\n3 0 1 2\n3 0 0 0\n";
    let scene = load(text(&format!("element vertex 3\n{XYZ}element face 2\n{FACES}"), body).as_bytes());
    let vertices = scene.mesh.vertices();
    assert!(vertices[0][0].is_nan() && vertices[2][0].is_nan());
    assert_eq!(vertices[1], [f32::NEG_INFINITY, 1.0, f32::INFINITY]);
    assert_eq!(vertices[2][1], f32::INFINITY);
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 0, 0]]);
}

#[test]
fn files_without_triangles_are_empty_meshes() {
    let points = load(text(&format!("element vertex 1\n{XYZ}"), "1 2 3\n").as_bytes());
    assert_eq!((points.mesh.len(), points.mesh.vertices().len()), (0, 1));
    let nothing = load(text(&format!("element vertex 0\n{XYZ}element face 0\n{FACES}"), "").as_bytes());
    assert!(nothing.mesh.is_empty());
    let lines = text(&format!("element vertex 2\n{XYZ}element face 2\n{FACES}"), "0 0 0\n1 1 1\n2 0 1\n0\n");
    let lines = load(lines.as_bytes());
    assert!(lines.mesh.is_empty());
    assert_eq!(lines.warnings.len(), 1);
}

#[test]
fn errors_say_where() {
    let faces = format!("element vertex 3\n{XYZ}element face 2\n{FACES}");
    for (body, line) in [
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 3\n", 14), // out of range
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 -1\n", 14), // negative
        ("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 .5\n", 14), // not whole
        ("0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", 11), // no number
        ("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n3 0 1 2\n", 13), // negative length
        ("0 0 0\n1 0 0\n0 1 0\n99999999 0 1\n3 0 1 2", 13), // absurd length
    ] {
        match error(text(&faces, body)) {
            LoadError::Invalid { place, .. } => assert_eq!(place, Place::Line(line), "{body}"),
            other => panic!("{other}"),
        }
    }
    let mut binary = polygons(false, "int", "uchar");
    let last = binary.len() - 4;
    binary[last] = 5;
    match error(&binary) {
        LoadError::Invalid { place, .. } => assert_eq!(place, Place::Byte(last as u64)),
        other => panic!("{other}"),
    }
}

#[test]
fn headers_that_lie_are_refused_before_memory_is_taken() {
    for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for (vertices, faces) in [
            ("1152921504606846976", "0"),
            ("18446744073709551615", "1"),
            ("0", "1152921504606846976"),
            ("3", "4294967295"),
            ("-1", "0"),
            ("1e3", "0"),
            ("99999999999999999999999", "0"),
        ] {
            error(format!(
                "ply\nformat {encoding} 1.0\nelement vertex {vertices}\n{XYZ}element face {faces}\n{FACES}end_header\n\
                 0 0 0 1 1 1 2 2 2 3 0 1 2 and then some"
            ));
        }
        // Entries without properties take no bytes, and no time.
        let file = format!(
            "ply\nformat {encoding} 1.0\nelement nothing 1152921504606846976\nelement vertex 0\n{XYZ}end_header\n"
        );
        assert!(load(file.as_bytes()).mesh.is_empty());
    }
    for header in [
        "",
        "plx\n",
        "ply",
        "ply\nend_header\n",
        "ply\nformat ascii 1.0\nend_header\n",
        "ply\nformat morse 1.0\nelement vertex 0\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nend_header\n",
        "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty quaternion x\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty list float x\nend_header\n",
        "ply\nformat ascii 1.0\nwhat is this\nend_header\n",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n\
         element face 0\nproperty int vertex_indices\nend_header\n",
    ] {
        error(header);
    }
}
