//! glTF files as exporters write them, most after public reports; numbers are our own.

use base64::{Engine, engine::general_purpose::STANDARD};
use slimkd_scene::{Format, LoadError, LoadOptions, Scene, load, load_bytes, load_bytes_with};
use std::fs;

const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// A file with one buffer; `rest` goes behind it.
fn text(buffer: &[u8], rest: &str) -> String {
    let data = STANDARD.encode(buffer);
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "data:;base64,{data}", "byteLength": {}}}], {rest}}}"#,
        buffer.len()
    )
}

fn parse(buffer: &[u8], rest: &str) -> Scene {
    load_bytes(Format::Gltf, text(buffer, rest).as_bytes()).unwrap_or_else(|error| panic!("{rest}: {error}"))
}

/// One triangle as accessor 0, of view 0, whose positions are the first 36 bytes.
fn one(more_views: &str, more_accessors: &str) -> String {
    format!(
        r#""bufferViews": [{{"buffer": 0, "byteLength": 36}}{more_views}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}{more_accessors}]"#
    )
}

const MESH: &str = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}]"#;

fn glb(json: &[u8], pad: bool, bin: &[u8]) -> Vec<u8> {
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, data) in [(b"JSON", json), (b"BIN\0", bin)] {
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(data);
        if pad {
            out.resize(out.len().next_multiple_of(4), 0);
        }
    }
    let length = out.len() as u32;
    out[8..12].copy_from_slice(&length.to_le_bytes());
    out
}

#[test]
fn required_extensions_that_move_nothing() {
    for name in [
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "MSFT_texture_dds",
        "KHR_materials_unlit",
        "KHR_materials_variants",
        "KHR_xmp_json_ld",
        "EXT_structural_metadata",
        "VRMC_vrm",
    ] {
        let rest = format!(r#"{}, {MESH}, "extensionsRequired": ["{name}"]"#, one("", ""));
        assert_eq!(parse(&floats(&TRIANGLE), &rest).mesh.len(), 1, "{name}");
    }
    let rest = format!(r#"{}, {MESH}, "extensionsRequired": ["EXT_implicit_geometry"]"#, one("", ""));
    let error = load_bytes(Format::Gltf, text(&floats(&TRIANGLE), &rest).as_bytes()).unwrap_err();
    assert!(matches!(error, LoadError::Unsupported { .. }), "{error}");
}

#[test]
fn accessors_without_a_view_are_zeros() {
    let mesh = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}}]}], "nodes": [{"mesh": 0}]"#;
    let accessor = r#", {"componentType": 5126, "count": 3, "type": "VEC3"}"#;
    let scene = parse(&floats(&TRIANGLE), &format!("{}, {mesh}", one("", accessor)));
    assert_eq!(scene.mesh.vertices()[1], [1.0, 0.0, 0.0]);
    assert_eq!(scene.normals.unwrap().values, [[0.0; 3]; 3]);
    // As indices: three times vertex 0.
    let mesh = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "nodes": [{"mesh": 0}]"#;
    let accessor = r#", {"componentType": 5121, "count": 3, "type": "SCALAR"}"#;
    assert_eq!(
        parse(&floats(&TRIANGLE), &format!("{}, {mesh}", one("", accessor))).mesh.triangles(),
        [[0; 3]]
    );
}

#[test]
fn any_extras_and_numbers_with_a_point() {
    for extras in [r#""x""#, "7", "null", "[1, [2]]", r#"{"a": {"b": []}}"#, "true"] {
        let rest = format!(
            r#"{}, "meshes": [{{"extras": {extras}, "primitives": [{{"attributes": {{"POSITION": 0, "_ID": 9}},
            "extras": {extras}}}]}}], "nodes": [{{"mesh": 0, "extras": {extras}}}], "extras": {extras}"#,
            one("", "")
        );
        assert_eq!(parse(&floats(&TRIANGLE), &rest).mesh.len(), 1, "{extras}");
    }
    let rest = format!("{}, {}", one("", ""), MESH.replace(r#""POSITION": 0"#, r#""POSITION": 0.0"#));
    let rest = rest.replace(r#""count": 3"#, r#""count": 3.0"#).replace("5126", "5.126e3");
    assert_eq!(parse(&floats(&TRIANGLE), &rest).mesh.len(), 1);
    for bad in ["3.5", "-3", "\"3\"", "1e300"] {
        let rest = format!("{}, {MESH}", one("", "")).replace(r#""count": 3"#, &format!(r#""count": {bad}"#));
        assert!(load_bytes(Format::Gltf, text(&floats(&TRIANGLE), &rest).as_bytes()).is_err(), "{bad}");
    }
}

#[test]
fn morph_targets_by_their_default_weights() {
    let mut buffer = floats(&TRIANGLE);
    buffer.extend(floats(&[0.0, 0.0, 4.0, 0.0, 0.0, 4.0, 0.0, 0.0, 4.0]));
    buffer.extend([2, 0, 0, 0]);
    buffer.extend(floats(&[0.0, 2.0, 0.0]));
    let views = r#", {"buffer": 0, "byteOffset": 36, "byteLength": 36}, {"buffer": 0, "byteOffset": 72, "byteLength": 1},
        {"buffer": 0, "byteOffset": 76, "byteLength": 12}"#;
    let accessors = r#", {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
        {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1,
        "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}}}"#;
    let scene = |mesh: &str, node: &str| {
        let rest = format!(
            r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "targets": [{{"POSITION": 1}},
            {{"POSITION": 2}}]}}]{mesh}}}], "nodes": [{{"mesh": 0{node}}}]"#,
            one(views, accessors)
        );
        parse(&buffer, &rest).mesh.vertices().to_vec()
    };
    assert_eq!(scene("", "")[2], [0.0, 1.0, 0.0]);
    assert_eq!(scene(r#", "weights": [0.5, 0]"#, "")[2], [0.0, 1.0, 2.0]);
    assert_eq!(scene(r#", "weights": [0.5, 0]"#, r#", "weights": [0, 1]"#)[2], [0.0, 3.0, 0.0]);
    assert_eq!(scene("", r#", "weights": [1, 0.5]"#), [[0.0, 0.0, 4.0], [1.0, 0.0, 4.0], [0.0, 2.0, 4.0]]);
}

#[test]
fn instances_on_the_gpu() {
    let mut buffer = floats(&TRIANGLE);
    buffer.extend(floats(&[0.0, 0.0, 0.0, 10.0, 0.0, 0.0]));
    buffer.extend([0i16, 0, 0, 32_767, 0, 0, 32_767, 0].iter().flat_map(|x| x.to_le_bytes()));
    let views = r#", {"buffer": 0, "byteOffset": 36, "byteLength": 24}, {"buffer": 0, "byteOffset": 60, "byteLength": 16}"#;
    let accessors = r#", {"bufferView": 1, "componentType": 5126, "count": 2, "type": "VEC3"},
        {"bufferView": 2, "componentType": 5122, "normalized": true, "count": 2, "type": "VEC4"}"#;
    let with = |attributes: &str| {
        format!(
            r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "nodes": [{{"mesh": 0, "scale": [2, 2, 2],
            "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {attributes}}}}}}}],
            "extensionsRequired": ["EXT_mesh_gpu_instancing"]"#,
            one(views, accessors)
        )
    };
    let scene = parse(&buffer, &with(r#"{"TRANSLATION": 1, "ROTATION": 2}"#));
    // The second one is turned by half a turn about z, moved by 10, and all of it is twice as large.
    let corners = scene.mesh.corners(1);
    assert_eq!(scene.mesh.len(), 2);
    assert_eq!((scene.mesh.corners(0)[1], corners[0]), ([2.0, 0.0, 0.0], [20.0, 0.0, 0.0]));
    assert!((corners[1][0] - 18.0).abs() < 1e-5 && corners[2][1] < -1.99, "{corners:?}");
    assert_eq!(parse(&buffer, &with(r#"{"_ID": 1}"#)).mesh.len(), 1);
    let bad = text(&buffer, &with(r#"{"TRANSLATION": 1, "SCALE": 0}"#));
    assert!(load_bytes(Format::Gltf, bad.as_bytes()).unwrap_err().to_string().contains("instances"));
    // Many of nothing.
    let huge = with(r#"{"TRANSLATION": 1}"#)
        .replace(r#""bufferView": 1, "#, "")
        .replace(r#""count": 2"#, r#""count": 900000000000"#);
    let error = load_bytes(Format::Gltf, text(&buffer, &huge).as_bytes()).unwrap_err();
    assert!(matches!(error, LoadError::OutOfProportion { .. }), "{error}");
}

#[test]
fn mirrored_nodes_keep_their_faces_outside() {
    let rest =
        format!("{}, {}", one("", ""), MESH.replace(r#""mesh": 0}"#, r#""mesh": 0, "scale": [-1, 1, 1]}"#));
    let scene = parse(&floats(&TRIANGLE), &rest);
    assert_eq!((scene.mesh.triangles(), scene.mesh.vertices()[1]), (&[[0, 2, 1]][..], [-1.0, 0.0, 0.0]));
}

#[test]
fn texture_coordinates_are_transformed() {
    let mut buffer = floats(&TRIANGLE);
    buffer.extend(floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]));
    let views = r#", {"buffer": 0, "byteOffset": 36, "byteLength": 24}"#;
    let accessors = r#", {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}"#;
    let rest = format!(
        r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_3": 1}}, "material": 0}}]}}],
        "nodes": [{{"mesh": 0}}], "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0, "extensions":
        {{"KHR_texture_transform": {{"offset": [0, 1], "rotation": 1.5707963267948966, "scale": [0.5, 0.5], "texCoord": 3}}}}}}}}}}]"#,
        one(views, accessors)
    );
    let uvs = parse(&buffer, &rest).uvs.unwrap().values;
    // The lower left quadrant; our v goes up.
    for (uv, expected) in uvs.iter().zip([[0.0, 0.0], [0.0, 0.5], [0.5, 0.0]]) {
        assert!((uv[0] - expected[0]).abs() + (uv[1] - expected[1]).abs() < 1e-6, "{uvs:?}");
    }
}

#[test]
fn colours_of_vertices_are_srgb() {
    let mut buffer = floats(&TRIANGLE);
    buffer.extend([255, 0, 0, 0, 0, 0, 0, 255, 255, 255, 0, 128u8]);
    buffer.extend(floats(&[1.0, 0.214_041_14, 0.0, 0.0, 0.0, 0.0, 2.0, -1.0, 0.5]));
    let views = r#", {"buffer": 0, "byteOffset": 36, "byteLength": 12}, {"buffer": 0, "byteOffset": 48, "byteLength": 36}"#;
    let accessors = r#", {"bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
        {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3"}"#;
    let colours = |accessor: u32| {
        let mesh = MESH.replace(r#""POSITION": 0"#, &format!(r#""POSITION": 0, "COLOR_0": {accessor}"#));
        parse(&buffer, &format!("{}, {mesh}", one(views, accessors))).colours.unwrap().values
    };
    assert_eq!(colours(1), [[255, 0, 0, 0], [0, 0, 0, 255], [255, 255, 0, 128]]);
    assert_eq!(colours(2), [[255, 128, 0, 255], [0, 0, 0, 255], [255, 0, 188, 255]]);
}

#[test]
fn padding_of_glb_chunks() {
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 36}}], {}, {MESH}}}"#,
        one("", "")
    );
    for blanks in 0..4 {
        let json = json.clone() + &" ".repeat(blanks);
        for pad in [true, false] {
            let file = glb(json.as_bytes(), pad, &floats(&TRIANGLE));
            assert_eq!(load_bytes(Format::Glb, &file).unwrap().mesh.len(), 1, "{blanks} {pad}");
        }
        let zeros = json.trim_end().to_owned() + &"\0".repeat(4 + blanks);
        assert_eq!(
            load_bytes(Format::Glb, &glb(zeros.as_bytes(), true, &floats(&TRIANGLE))).unwrap().mesh.len(),
            1
        );
    }
}

#[test]
fn buffers_under_many_names() {
    let folder = tempfile::tempdir().unwrap();
    let names = [
        ("buffer one.bin", "buffer%20one.bin"),
        ("50% of it.bin", "50% of it.bin"),
        ("a%20b.bin", "a%20b.bin"),
        ("gr\u{fc}n.bin", "gr%C3%BCn.bin"),
        ("c.bin", "./c.bin"),
    ];
    for (file, uri) in names {
        fs::write(folder.path().join(file), floats(&TRIANGLE)).unwrap();
        let json = text(&[], &format!("{}, {MESH}", one("", "")))
            .replace("data:;base64,", uri)
            .replace(r#""byteLength": 0"#, r#""byteLength": 36"#);
        fs::write(folder.path().join("m.gltf"), json).unwrap();
        let scene = load(folder.path().join("m.gltf"));
        assert_eq!(scene.unwrap_or_else(|error| panic!("{uri}: {error}")).mesh.len(), 1);
    }
    let data = STANDARD.encode(floats(&TRIANGLE));
    let percent: String = floats(&TRIANGLE).iter().map(|byte| format!("%{byte:02x}")).collect();
    for uri in [
        format!("data:application/gltf-buffer;base64,{data}"),
        format!("data:application/octet-stream;charset=utf-8;base64,{data}"),
        format!("DATA:;BASE64,{data}"),
        format!("data:;base64,{}\\n{}", &data[..8], &data[8..]),
        format!("data:application/octet-stream,{percent}"),
    ] {
        let json = text(&[], &format!("{}, {MESH}", one("", "")))
            .replace("data:;base64,", &uri)
            .replace(r#""byteLength": 0"#, r#""byteLength": 36"#);
        assert_eq!(
            load_bytes(Format::Gltf, json.as_bytes()).unwrap_or_else(|e| panic!("{uri}: {e}")).mesh.len(),
            1
        );
    }
}

#[test]
fn scenes_by_their_index() {
    let rest = format!(
        r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "scene": 1,
        "nodes": [{{"mesh": 0}}, {{"mesh": 0}}, {{"mesh": 0}}], "scenes": [{{"nodes": [0]}}, {{"nodes": [1, 2]}}]"#,
        one("", "")
    );
    let file = text(&floats(&TRIANGLE), &rest);
    let chosen =
        |index| load_bytes_with(Format::Gltf, file.as_bytes(), &LoadOptions::new().scene_index(index));
    let default = load_bytes(Format::Gltf, file.as_bytes()).unwrap();
    assert_eq!((default.mesh.len(), default.warnings.len()), (2, 1));
    assert!(default.warnings[0].text().contains("1 of 2 scenes"), "{:?}", default.warnings);
    assert_eq!((chosen(0).unwrap().mesh.len(), chosen(1).unwrap().mesh.len()), (1, 2));
    assert!(chosen(2).unwrap_err().to_string().contains("scenes[2]"));
    assert!(load_bytes_with(Format::Obj, b"v 0 0 0\n", &LoadOptions::new().scene_index(1)).is_err());
}

#[test]
fn strips_and_fans_with_restarts() {
    let mut buffer = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 2.0, 1.0, 0.0]);
    buffer.extend([0, 1, 2, 3, 255, 2, 3, 4u8]);
    let rest = |mode: u32| {
        format!(
            r#""bufferViews": [{{"buffer": 0, "byteLength": 60}}, {{"buffer": 0, "byteOffset": 60, "byteLength": 8}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5121, "count": 8, "type": "SCALAR"}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "mode": {mode}}}]}}], "nodes": [{{"mesh": 0}}]"#
        )
    };
    assert_eq!(parse(&buffer, &rest(5)).mesh.triangles(), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    assert_eq!(parse(&buffer, &rest(6)).mesh.triangles(), [[0, 1, 2], [0, 2, 3], [2, 3, 4]]);
    assert!(load_bytes(Format::Gltf, text(&buffer, &rest(4)).as_bytes()).is_err());
}

#[test]
fn quantised_positions_of_every_type() {
    for (component, normalized, bytes, expected) in [
        (5120, true, [0u8, 127, 0x81, 0].to_vec(), [0.0, 1.0, -1.0]),
        (5120, false, [0, 100, 0x9c, 0].to_vec(), [0.0, 100.0, -100.0]),
        (5121, true, [0, 255, 51, 0].to_vec(), [0.0, 1.0, 0.2]),
        (5121, false, [1, 2, 255, 0].to_vec(), [1.0, 2.0, 255.0]),
        (5122, true, [0, 0, 0xff, 0x7f, 1, 0x80, 0, 0].to_vec(), [0.0, 1.0, -1.0]),
        (5122, false, [0, 0, 0xff, 0x7f, 0, 0x80, 0, 0].to_vec(), [0.0, 32_767.0, -32_768.0]),
        (5123, true, [0, 0, 0xff, 0xff, 0x33, 0x33, 0, 0].to_vec(), [0.0, 1.0, 0.2]),
        (5123, false, [0, 0, 0xff, 0xff, 1, 0, 0, 0].to_vec(), [0.0, 65_535.0, 1.0]),
    ] {
        let stride = bytes.len();
        let rest = format!(
            r#""bufferViews": [{{"buffer": 0, "byteLength": {0}, "byteStride": {stride}}}], {MESH},
            "accessors": [{{"bufferView": 0, "componentType": {component}, "normalized": {normalized}, "count": 3, "type": "VEC3"}}],
            "extensionsRequired": ["KHR_mesh_quantization"]"#,
            3 * stride
        );
        assert_eq!(parse(&bytes.repeat(3), &rest).mesh.vertices()[0], expected, "{component} {normalized}");
    }
}

#[test]
fn skins_stand_as_their_joints_do() {
    let mut buffer = floats(&TRIANGLE);
    buffer.extend([0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0u8]);
    buffer.extend([255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0u8]);
    let views = r#", {"buffer": 0, "byteOffset": 36, "byteLength": 12}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}"#;
    let accessors = r#", {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
        {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"}"#;
    let rest = format!(
        r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}}}}]}}],
        "skins": [{{"joints": [1, 2]}}], "nodes": [{{"mesh": 0, "skin": 0, "translation": [99, 0, 0]}},
        {{"translation": [0, 0, 1], "children": [2]}}, {{"translation": [0, 0, 2]}}]"#,
        one(views, accessors)
    );
    let scene = parse(&buffer, &rest);
    // A skinned mesh does not follow its own node.
    assert_eq!(scene.mesh.vertices(), [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 3.0]]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn draco_of_every_method() {
    // Two triangles of a unit square by Google's encoder, at its speeds 1, 7 and 10.
    for stream in [
        "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgABAQADAwEgASADACCEmJAAAAAAAP8/AAAAAAAAAAAAAAAAAAAAAIA/Dg==",
        "RFJBQ08CAgEBAAAABAIAAgAAAR//AREB/wAAAQAJAwAAAgEBAQADAwEwARADACiCmAAAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O",
        "RFJBQ08CAgEAAAACBAEAAQIAAgMBAQAJAwAAAgABAQADAwEwARADADSCiAQAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O",
    ] {
        let stream = STANDARD.decode(stream).unwrap();
        let rest = |length: usize| {
            format!(
                r#""bufferViews": [{{"buffer": 0, "byteLength": {length}}}], "nodes": [{{"mesh": 0}}, {{"mesh": 0, "scale": [1, 1, -1]}}],
                "accessors": [{{"componentType": 5126, "count": 4, "type": "VEC3"}}, {{"componentType": 5121, "count": 6, "type": "SCALAR"}}],
                "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "extensions": {{
                "KHR_draco_mesh_compression": {{"bufferView": 0, "attributes": {{"POSITION": 0}}}}}}}}]}}],
                "extensionsRequired": ["KHR_draco_mesh_compression"]"#
            )
        };
        let scene = parse(&stream, &rest(stream.len()));
        assert_eq!((scene.mesh.len(), scene.mesh.vertices().len()), (4, 8));
        let area: f32 = (0..2)
            .map(|id| {
                let [a, b, c] = scene.mesh.corners(id);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
            })
            .sum();
        assert!((area - 1.0).abs() < 1e-5, "{area}");
        for length in 0..stream.len() {
            let cut = text(&stream, &rest(length));
            let error = load_bytes(Format::Gltf, cut.as_bytes()).unwrap_err().to_string();
            assert!(
                error.contains("without Draco") || error.contains("DRACO") || error.contains("damaged"),
                "{error}"
            );
        }
    }
}

#[test]
fn what_is_left_out_is_counted() {
    let rest = format!(
        r#"{}, "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}, {{"attributes": {{"POSITION": 0}}, "mode": 0}},
        {{"attributes": {{"POSITION": 0}}, "mode": 3}}, {{"attributes": {{}}}}]}}], "animations": [{{}}, {{}}],
        "nodes": [{{"mesh": 0, "children": [1]}}, {{"mesh": 0, "extensions": {{"KHR_node_visibility": {{"visible": false}}}}}}]"#,
        one("", "")
    );
    let scene = parse(&floats(&TRIANGLE), &rest);
    let texts: Vec<_> = scene.warnings.iter().map(|warning| warning.text()).collect();
    assert_eq!(scene.mesh.len(), 1);
    assert_eq!(
        texts,
        [
            "2 animations were left out; the model stands as its nodes say",
            "1 of 2 nodes are hidden by KHR_node_visibility and were left out",
            "2 of 4 primitives are points or lines and were left out",
            "1 of 4 primitives have no POSITION and were left out",
        ]
    );
}
