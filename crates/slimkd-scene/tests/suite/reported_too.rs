//! More inputs after public reports about other programs, described anew with other numbers; each test names the reports.

use base64::{Engine, engine::general_purpose::STANDARD};
use slimkd_scene::{Format, LoadError, Scene, WarningKind, load_bytes};

fn load(format: Format, bytes: impl AsRef<[u8]>) -> Scene {
    load_bytes(format, bytes.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

fn ply(header: &str, body: &str) -> String {
    format!("ply\nformat ascii 1.0\n{header}end_header\n{body}")
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

/// assimp#4866 and spark#338: a comment, or `obj_info`, between an element and its properties.
#[test]
fn ply_comments_anywhere_in_the_header() {
    let header = "comment first\nelement vertex 3\ncomment Points\nproperty float x\nobj_info by hand\nproperty float y\n\
        property float z\nelement face 1\ncomment\ncomment element face 99\nproperty list uchar int vertex_indices\n";
    let scene = load(Format::Ply, ply(header, "0 0 0\n2 0 0\n0 2 0\n3 2 0 1\n"));
    assert_eq!(scene.mesh.triangles(), [[2, 0, 1]]);
}

/// trimesh#138 and LAStools#173: types under their sized names.
#[test]
fn ply_sized_types() {
    let header = "element vertex 3\nproperty float32 x\nproperty float64 y\nproperty int16 z\nproperty uint8 red\n\
        property uint8 green\nproperty uint8 blue\nproperty int8 label\nelement face 1\nproperty list uint8 int32 vertex_index\n";
    let scene = load(Format::Ply, ply(header, "0 0 7 1 2 3 -4\n2 0 7 1 2 3 -4\n0 2 7 1 2 3 -4\n3 0 1 2\n"));
    assert_eq!((scene.mesh.len(), scene.mesh.vertices()[0]), (1, [0.0, 0.0, 7.0]));
    assert_eq!(scene.colours.unwrap().values[0], [1, 2, 3, 255]);
}

/// meshlab#290 and happly#4: lengths of lists as `ushort` or `uint`, here in binary data of both byte orders.
#[test]
fn ply_lengths_of_any_type() {
    for (name, size) in [("char", 1), ("ushort", 2), ("short", 2), ("uint", 4), ("int", 4)] {
        for big in [false, true] {
            let encoding = if big { "big" } else { "little" };
            let mut bytes = format!(
                "ply\nformat binary_{encoding}_endian 1.0\nelement vertex 4\n{XYZ}element face 2\n\
                 property list {name} uint vertex_indices\nproperty list uchar float texcoord\nend_header\n"
            )
            .into_bytes();
            let mut put = |bits: u32, size: usize| match big {
                true => bytes.extend(&bits.to_be_bytes()[4 - size..]),
                false => bytes.extend(&bits.to_le_bytes()[..size]),
            };
            for corner in [[0.0f32, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0], [0.0, 3.0, 0.0]] {
                corner.iter().for_each(|x| put(x.to_bits(), 4));
            }
            for face in [&[0u32, 1, 2][..], &[0, 1, 2, 3]] {
                put(face.len() as u32, size);
                face.iter().for_each(|&corner| put(corner, 4));
                put(2 * face.len() as u32, 1);
                (0..2 * face.len()).for_each(|k| put((k as f32).to_bits(), 4));
            }
            let scene = load(Format::Ply, &bytes);
            assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 1, 2], [0, 2, 3]], "{name} {big}");
            let uvs = scene.uvs.as_ref().unwrap();
            assert_eq!(uvs.corners(2, [0, 2, 3]), Some([[0.0, 1.0], [4.0, 5.0], [6.0, 7.0]]));
        }
    }
}

/// Open3D#2120: a cube of six squares is twelve triangles.
#[test]
fn ply_cube_of_squares() {
    let corners: String = (0..8).map(|k| format!("{} {} {}\n", k & 1, k >> 1 & 1, k >> 2)).collect();
    let faces = "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
    let header = format!("element vertex 8\n{XYZ}element face 6\nproperty list uchar int vertex_index\n");
    let scene = load(Format::Ply, ply(&header, &(corners + faces)));
    assert_eq!(scene.mesh.len(), 12);
    assert_eq!(scene.mesh.triangles()[10..], [[1, 3, 7], [1, 7, 5]]);
}

/// PyMesh#13: vertices and faces have colours of the same names.
#[test]
fn ply_colours_of_both_elements() {
    let colour = "property uint8 red\nproperty uint8 green\nproperty uint8 blue\nproperty uint8 alpha\n";
    let header = format!(
        "element vertex 3\n{XYZ}{colour}element face 1\nproperty list uint8 int32 vertex_indices\n{colour}"
    );
    let scene =
        load(Format::Ply, ply(&header, "0 0 0 1 2 3 4\n1 0 0 5 6 7 8\n0 1 0 9 9 9 9\n3 0 1 2 10 20 30 40\n"));
    assert_eq!(scene.colours.unwrap().values[1], [5, 6, 7, 8]);
    assert_eq!(scene.face_colours, [[10, 20, 30, 40]]);
}

/// meshlab#437: one face fewer than the header says is an error, since nobody can say what is missing.
#[test]
fn ply_with_a_face_too_few() {
    let header = format!("element vertex 3\n{XYZ}element face 3\nproperty list uchar int vertex_indices\n");
    let error = load_bytes(Format::Ply, ply(&header, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n").as_bytes())
        .unwrap_err();
    assert!(error.to_string().contains("line 15") && error.to_string().contains("ends before"), "{error}");
}

/// tinyply#19: lines with more numbers than the header has properties shift nothing.
#[test]
fn ply_lines_longer_than_the_header_says() {
    let header = format!("element vertex 4\n{XYZ}element face 2\nproperty list uchar int vertex_indices\n");
    let body = "0 0 0 255 0 9\n4 0 0 255 0 9\n4 4 0 255 0 9\n0 4 0 255 0 9\n3 0 1 2\n3 0 2 3\n";
    let scene = load(Format::Ply, ply(&header, body));
    assert_eq!(scene.mesh.vertices()[3], [0.0, 4.0, 0.0]);
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((scene.warnings.len(), scene.warnings[0].count()), (1, Some((4, 6))));
    // Entries that share lines, or take several, are numbers as before.
    let scene = load(Format::Ply, ply(&header, "0 0 0 4 0 0\n4\n4 0\n0 4 0 3 0 1 2 3\n0 2 3\n\n"));
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (2, 0));
    let scene = load(Format::Ply, ply(&header, "0 0 0\n4 0 0\n4 4 0\n0 4 0\n3 0 1 2\n3 0 2 3\n# by hand\n"));
    assert_eq!((scene.mesh.len(), scene.warnings[0].kind), (2, WarningKind::Ignored));
}

/// tinyobjloader#44, #138, #235 and #104: `usemtl` right before a group, before an object, and at the end of the file.
#[test]
fn obj_materials_before_groups() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
    let text = format!(
        "{vertices}usemtl red\ng one\nf 1 2 3\nusemtl green\ng two\nf 2 4 3\nusemtl blue\no three\nf 1 4 2\nusemtl red\n"
    );
    let scene = load(Format::Obj, text);
    assert_eq!(scene.mesh.len(), 3);
    let names: Vec<_> = (0..3).map(|id| scene.material(id).name.as_str()).collect();
    assert_eq!(names, ["red", "green", "blue"]);
}

/// opensn#953 and assimp#300: corners in every notation, also with a slash that nothing follows.
#[test]
fn obj_corners_in_every_notation() {
    let values = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\n";
    let text = format!(
        "{values}f 1 2 3\nf 1/1 2/2 3/3\nf 1//1 2//1 3//1\nf 1/1/1 2/2/1 3/3/1\nf 1/1/ 2/2/ 3/3/\nf 1// 2// 3//\n"
    );
    let scene = load(Format::Obj, text);
    assert_eq!(scene.mesh.triangles(), [[0, 1, 2]; 6]);
    let (uvs, normals) = (scene.uvs.as_ref().unwrap(), scene.normals.as_ref().unwrap());
    let has = |id: u32| (uvs.corners(id, [0, 1, 2]).is_some(), normals.corners(id, [0, 1, 2]).is_some());
    let expected =
        [(false, false), (true, false), (false, true), (true, true), (true, false), (false, false)];
    assert_eq!((0..6).map(has).collect::<Vec<_>>(), expected);
}

/// Open3D#2614, #5582, #3799 and trimesh#2078: vertices and faces keep their order, number and repetitions.
#[test]
fn obj_order_and_number() {
    let text = "v 5 5 5\nv 0 0 0\nv 1 0 0\nv 0 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 5/2 3/1 4/1\nf 2/2 3/2 5/1\n";
    let scene = load(Format::Obj, text);
    assert_eq!(scene.mesh.vertices().len(), 5);
    assert_eq!(scene.mesh.triangles(), [[4, 2, 3], [1, 2, 4]]);
    assert_eq!(scene.mesh.vertices()[0], [5.0; 3]);
}

/// assimp#1453: a file of vertices alone has no triangles, and is no error.
#[test]
fn obj_of_vertices_alone() {
    let scene = load(Format::Obj, "v  0.0  0.0  1.0\nv 1 0 1\n");
    assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (0, 2));
}

/// tinyobjloader#130: the last line counts, also without its end.
#[test]
fn obj_without_a_last_line_end() {
    for text in ["v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\t \t"] {
        assert_eq!(load(Format::Obj, text).mesh.triangles(), [[0, 1, 2]]);
    }
}

/// FreeCAD-old#47: polygons out of their plane keep their number of triangles.
#[test]
fn obj_polygons_out_of_their_plane() {
    let text = "v 0 0 0\nv 2 0 0.5\nv 3 2 0\nv 1 3 0.5\nv -1 2 0\nf 1//1 2//1 3//1 4//1 5//1\nvn 0 0 1\n";
    let scene = load(Format::Obj, text);
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (3, 0));
}

const FACET: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3 0 0\nvertex 0 3 0\nendloop\nendfacet\n";

/// numpy-stl#156 and assimp#106: white space before `solid`.
#[test]
fn stl_with_blanks_before_it() {
    for before in [" ", "\t", "\r\n\n", "\u{feff}", "\u{feff} "] {
        let scene = load(Format::Stl, format!("{before}solid cube\n{FACET}endsolid cube\n"));
        assert_eq!((scene.mesh.len(), scene.warnings.len()), (1, 0), "{before:?}");
    }
}

/// Slic3r#2971, numpy-stl#154 and #155, three-stl-loader#7: capitals in all words, in some, and in the last.
#[test]
fn stl_in_capitals() {
    let text = format!("solid a\n{FACET}endsolid a\n");
    let mixed = text.replace("endsolid", "ENDSOLID").replace("solid a\nf", "Solid Unity Mesh\nf");
    for text in [text.to_uppercase(), mixed, text.replace("0 3 0", "0.0E+00 3.00000000E+00 -0.0E-00")] {
        let scene = load(Format::Stl, text);
        assert_eq!(scene.mesh.vertices(), [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
    }
}

/// stl_io#1: a name with blanks behind both `solid` and `endsolid`.
#[test]
fn stl_names_with_blanks() {
    let text = format!(
        "solid foo bar facet\n{FACET}endsolid foo bar facet\nsolid the end\n{FACET}endsolid the end\n"
    );
    let scene = load(Format::Stl, text);
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (2, 0));
}

/// libigl#26, stl_reader#3, manyfold#2340: binary data behind a head that says `solid`, also one with more words.
#[test]
fn stl_binary_that_says_solid() {
    for name in
        ["solid", "solid base facet normal", "SOLID by hand\nfacet normal 0 0 0\nouter loop\nvertex 1 2 3\n"]
    {
        let mut bytes = name.as_bytes().to_vec();
        bytes.resize(80, b' ');
        bytes.extend(2u32.to_le_bytes());
        for z in [0.0f32, 1.0] {
            let numbers = [0.0, 0.0, 1.0, 0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z];
            bytes.extend(numbers.iter().flat_map(|x: &f32| x.to_le_bytes()));
            bytes.extend([0, 0]);
        }
        assert_eq!(load(Format::Stl, &bytes).mesh.len(), 2, "{name}");
        bytes[80] = 3;
        let error = load_bytes(Format::Stl, &bytes).unwrap_err();
        assert!(matches!(error, LoadError::Invalid { .. }), "{name}: {error}");
    }
}

/// numpy-stl#37: a facet with a corner too many is a polygon, one with too few is left out, and both are told.
#[test]
fn stl_facets_of_other_numbers_of_corners() {
    let four = FACET.replace("endloop", "vertex 1 1 0\nendloop");
    let two = FACET.replace("vertex 0 3 0\n", "");
    let scene = load(Format::Stl, format!("solid\n{four}{two}{FACET}endsolid\n"));
    assert_eq!((scene.mesh.len(), scene.warnings.len()), (3, 1));
    assert_eq!(scene.warnings[0].count(), Some((1, 3)));
}

/// stl_reader#16 and #21: facets whose `facet` or `endfacet` is missing.
#[test]
fn stl_without_some_words() {
    let without = FACET.replace("facet normal 0 0 1\n", "").replace("endfacet\n", "");
    assert_eq!(load(Format::Stl, format!("solid\n{without}{FACET}{without}endsolid\n")).mesh.len(), 3);
}

/// A glTF of one buffer, a mesh of the accessors 0 and, where `indexed`, 1, and a node.
fn gltf(buffer: &[u8], views: &str, accessors: &str, attributes: &str, node: &str) -> Vec<u8> {
    let data = STANDARD.encode(buffer);
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "data:;base64,{data}", "byteLength": {}}}],
        "bufferViews": [{views}], "accessors": [{accessors}], "nodes": [{{"mesh": 0{node}}}],
        "meshes": [{{"primitives": [{{{attributes}}}]}}]}}"#,
        buffer.len()
    )
    .into_bytes()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 5.0, 0.0];
const POSITION: &str = r#""attributes": {"POSITION": 0}"#;

/// gltf-rs#205, Online3DViewer#59 and cesium-native#751: a stride of 0 means that entries follow one another.
#[test]
fn gltf_strides_of_zero() {
    let mut buffer = floats(&CORNERS);
    buffer.extend([2, 0, 0, 0, 1, 0]);
    let views = r#"{"buffer": 0, "byteLength": 36, "byteStride": 0}, {"buffer": 0, "byteOffset": 36, "byteLength": 6, "byteStride": 0}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}"#;
    let scene =
        load(Format::Gltf, gltf(&buffer, views, accessors, &format!(r#"{POSITION}, "indices": 1"#), ""));
    assert_eq!(scene.mesh.triangles(), [[2, 0, 1]]);
    assert_eq!(scene.mesh.vertices()[1], [5.0, 0.0, 0.0]);
}

/// Babylon.js#2374, glTFForUE4#38, three.js#13043, SwiftGLTF#2: attributes that take turns, the first without an offset.
#[test]
fn gltf_attributes_that_take_turns() {
    let mut rows = Vec::new();
    for corner in CORNERS.chunks(3) {
        rows.extend(floats(corner));
        rows.extend(floats(&[0.0, 0.0, 1.0, 0.25, 0.75]));
    }
    let views = r#"{"buffer": 0, "byteLength": 96, "byteStride": 32}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": 3, "type": "VEC2"}"#;
    let attributes = r#""attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}"#;
    let scene = load(Format::Gltf, gltf(&rows, views, accessors, attributes, ""));
    assert_eq!(scene.mesh.vertices(), [[0.0; 3], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0]]);
    assert_eq!(scene.normals.unwrap().values, [[0.0, 0.0, 1.0]; 3]);
    assert_eq!(scene.uvs.unwrap().values, [[0.25, 0.25]; 3]);
}

/// three.js#16802 and #16989: accessors of different counts share a view whose stride is larger than their entries.
#[test]
fn gltf_accessors_that_share_a_view() {
    let mut rows = Vec::new();
    for k in 0..7 {
        rows.extend(floats(&[k as f32, (k * k) as f32, 0.0]));
        rows.extend([0; 4]);
    }
    let views = r#"{"buffer": 0, "byteLength": 112, "byteStride": 16}"#;
    let accessors = r#"{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"}"#;
    let attributes = format!(r#"{POSITION}}}, {{"attributes": {{"POSITION": 1}}, "mode": 5"#);
    let scene = load(Format::Gltf, gltf(&rows, views, accessors, &attributes, ""));
    assert_eq!((scene.mesh.vertices().len(), scene.mesh.len()), (7, 3));
    assert_eq!(scene.mesh.vertices()[6], [6.0, 36.0, 0.0]);
}

/// glTFast#116 and model-viewer#4888: matrices that are nearly singular, or mirror, are followed as they are.
#[test]
fn gltf_matrices_that_are_nearly_singular() {
    let view = r#"{"buffer": 0, "byteLength": 36}"#;
    let accessor = r#"{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}"#;
    for (matrix, corner, mirrored) in [
        ("1e-12, 0, 0, 0, 0, 1e-12, 0, 0, 0, 0, 1e-12, 0, 1, 2, 3, 1", [1.0, 2.0, 3.0], false),
        ("0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 7, 0, 0, 1", [7.0, 0.0, -10.0], false),
        ("-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1", [0.0, 5.0, 0.0], true),
    ] {
        let node = format!(r#", "matrix": [{matrix}]"#);
        let scene = load(Format::Gltf, gltf(&floats(&CORNERS), view, accessor, POSITION, &node));
        assert_eq!(scene.mesh.triangles()[0], if mirrored { [0, 2, 1] } else { [0, 1, 2] });
        assert_eq!(scene.mesh.corners(0)[1], corner);
    }
}

/// glTF-Sample-Models#84: a GLB whose head says a byte too few or too many.
#[test]
fn glb_of_another_length_than_it_says() {
    let view = r#"{"buffer": 0, "byteLength": 36}"#;
    let accessor = r#"{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}"#;
    let mut json = gltf(&floats(&CORNERS), view, accessor, POSITION, "");
    json.resize(json.len().next_multiple_of(4), b' ');
    for off in [-1i32, 0, 1] {
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        glb.extend((20 + json.len() as i32 + off).to_le_bytes());
        glb.extend((json.len() as u32).to_le_bytes());
        glb.extend(b"JSON");
        glb.extend(&json);
        assert_eq!(load(Format::Glb, &glb).mesh.len(), 1, "{off}");
    }
}
