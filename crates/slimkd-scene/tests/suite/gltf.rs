//! glTF and GLB files.

use base64::{Engine, engine::general_purpose::STANDARD};
use glam::Vec3;
use slimkd_scene::{Format, Light, LoadError, Scene, UpAxis, load, load_bytes};
use std::fs;

/// Five positions, normals and texture coordinates, then indices of bytes, shorts and ints.
fn buffer() -> Vec<u8> {
    let positions: [[f32; 3]; 5] =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]];
    let uvs: [[f32; 2]; 5] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.25]];
    let mut out = Vec::new();
    positions.iter().flatten().for_each(|x| out.extend(x.to_le_bytes())); // 0..60
    (0..5).for_each(|_| [0.0f32, 0.0, 1.0].iter().for_each(|x| out.extend(x.to_le_bytes()))); // 60..120
    uvs.iter().flatten().for_each(|x| out.extend(x.to_le_bytes())); // 120..160
    out.extend([0u8, 1, 2, 0, 2, 3, 0, 0]); // 160..168
    [0u16, 1, 3, 2, 4, 0].iter().for_each(|x| out.extend(x.to_le_bytes())); // 168..180
    [4u32, 3, 2].iter().for_each(|x| out.extend(x.to_le_bytes())); // 180..192
    out
}

const ACCESSORS: &str = r#"
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
    {"bufferView": 1, "componentType": 5126, "count": 5, "type": "VEC3"},
    {"bufferView": 2, "componentType": 5126, "count": 5, "type": "VEC2"},
    {"bufferView": 3, "componentType": 5121, "count": 6, "type": "SCALAR"},
    {"bufferView": 3, "byteOffset": 8, "componentType": 5123, "count": 5, "type": "SCALAR"},
    {"bufferView": 3, "byteOffset": 20, "componentType": 5125, "count": 3, "type": "SCALAR"}
  ],
  "bufferViews": [
    {"buffer": 0, "byteLength": 60},
    {"buffer": 0, "byteOffset": 60, "byteLength": 60},
    {"buffer": 0, "byteOffset": 120, "byteLength": 40, "byteStride": 8},
    {"buffer": 0, "byteOffset": 160, "byteLength": 32}
  ]"#;

fn json(uri: Option<&str>, rest: &str) -> String {
    let uri = uri.map_or(String::new(), |uri| format!(r#""uri": "{uri}", "#));
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{{uri}"byteLength": 192}}], {ACCESSORS}, {rest}}}"#
    )
}

fn embedded(rest: &str) -> String {
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(buffer()));
    json(Some(&uri), rest)
}

fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((28 + json.len() + bin.len()) as u32).to_le_bytes());
    for (kind, data) in [(b"JSON", &json[..]), (b"BIN\0", bin)] {
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(data);
    }
    out
}

fn parse(rest: &str) -> Scene {
    load_bytes(Format::Gltf, embedded(rest).as_bytes()).unwrap()
}

const QUAD: &str = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 3}]}]"#;

#[test]
fn every_container_holds_the_same_scene() {
    let rest = format!(r#"{QUAD}, "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}], "scene": 0"#);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a buffer.bin"), buffer()).unwrap();
    let path = folder.path().join("external.GLTF");
    fs::write(&path, json(Some("a%20buffer.bin"), &rest)).unwrap();
    let external = load(&path).unwrap();
    assert_eq!(external.name, "external");
    assert_eq!(external.up, Some(UpAxis::Y));
    assert_eq!(external.mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(external.mesh.vertices()[2], [1.0, 1.0, 0.0]);
    assert!(external.warnings.is_empty());
    assert_eq!(parse(&rest).mesh, external.mesh);
    let glb = glb(&json(None, &rest), &buffer());
    assert_eq!(load_bytes(Format::Glb, &glb).unwrap().mesh, external.mesh);
    assert_eq!(load_bytes(Format::Gltf, &glb).unwrap().mesh, external.mesh);
    // From memory there is nothing beside.
    assert!(load_bytes(Format::Gltf, json(Some("a%20buffer.bin"), &rest).as_bytes()).is_err());
}

#[test]
fn nodes_are_flattened_in_scene_order() {
    let scene = parse(&format!(
        r#"{QUAD}, "nodes": [
            {{"translation": [10, 0, 0], "children": [2, 1], "mesh": 0}},
            {{"scale": [2, 3, 4], "mesh": 0}},
            {{"rotation": [0, 0, 0.70710678, 0.70710678], "mesh": 0}},
            {{"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,7,1], "mesh": 0}},
            {{"mesh": 0}}],
            "scenes": [{{"nodes": [4]}}, {{"nodes": [3, 0]}}], "scene": 1"#
    ));
    assert_eq!(scene.mesh.len(), 8);
    let corner = |id: u32| Vec3::from(scene.mesh.corners(id)[2]);
    let expected = [
        Vec3::new(1.0, 1.0, 7.0),
        Vec3::new(11.0, 1.0, 0.0),
        Vec3::new(9.0, 1.0, 0.0),
        Vec3::new(12.0, 3.0, 0.0),
    ];
    for (instance, expected) in expected.into_iter().enumerate() {
        assert!(
            corner(2 * instance as u32).abs_diff_eq(expected, 1e-6),
            "{instance}: {}",
            corner(2 * instance as u32)
        );
    }
    // Without scenes: all nodes that have no parent.
    let library = parse(&format!(r#"{QUAD}, "nodes": [{{"mesh": 0}}, {{"children": [0]}}, {{"mesh": 0}}]"#));
    assert_eq!(library.mesh.len(), 4);
}

#[test]
fn modes_and_attributes() {
    let scene = parse(
        r#""meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 4, "mode": 5},
            {"attributes": {"POSITION": 0}, "mode": 6, "material": 0},
            {"attributes": {"POSITION": 0}, "mode": 1},
            {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 5}]}],
            "materials": [{"name": "m"}],
            "nodes": [{"mesh": 0, "scale": [1, 1, 0.5], "rotation": [1, 0, 0, 0]}]"#,
    );
    assert_eq!(
        scene.mesh.triangles(),
        [[0, 1, 3], [1, 2, 3], [3, 2, 4], [5, 6, 7], [5, 7, 8], [5, 8, 9], [14, 13, 12]]
    );
    assert_eq!(scene.material_ids, [1, 1, 1, 0, 0, 0, 1]);
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.warnings.len(), 1);
    assert_eq!(scene.warnings[0].text(), "1 of 4 primitives are points or lines and were left out");
    let normals = scene.normals.unwrap();
    let normal = normals.corners(0, scene.mesh.triangles()[0]).unwrap()[0];
    assert!(Vec3::from(normal).abs_diff_eq(Vec3::NEG_Z, 1e-6), "{normal:?}");
    assert_eq!(normals.corners(3, scene.mesh.triangles()[3]), None);
    assert!(normals.corners(6, scene.mesh.triangles()[6]).is_some());
    let uvs = scene.uvs.unwrap();
    assert_eq!(uvs.corners(0, scene.mesh.triangles()[0]).unwrap(), [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
    assert_eq!(uvs.corners(6, scene.mesh.triangles()[6]), None);
}

#[test]
fn materials_textures_cameras_and_lights() {
    let mut png = Vec::new();
    slimkd_util::png::write(&mut png, [3, 2], [[255, 0, 0]; 6].as_flattened()).unwrap();
    let png = STANDARD.encode(png);
    let scene = parse(&format!(
        r#""meshes": [{{"primitives": [
              {{"attributes": {{"POSITION": 0, "TEXCOORD_0": 2}}, "indices": 3, "material": 0}},
              {{"attributes": {{"POSITION": 0}}, "indices": 3, "material": 1}},
              {{"attributes": {{"POSITION": 0}}, "indices": 3, "material": 2}}]}}],
            "materials": [
              {{"name": "map", "pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}, "metallicFactor": 0,
                "roughnessFactor": 1}}, "emissiveFactor": [0, 0, 1]}},
              {{"name": "mirror", "pbrMetallicRoughness": {{"baseColorFactor": [1, 0.5, 0, 1], "roughnessFactor": 0,
                "baseColorTexture": {{"index": 1}}}}}},
              {{"name": "glass", "pbrMetallicRoughness": {{"metallicFactor": 0}}, "extensions": {{
                "KHR_materials_transmission": {{"transmissionFactor": 0.75}}, "KHR_materials_ior": {{"ior": 1.25}}}}}},
              {{"name": "film", "alphaMode": "BLEND", "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, 0.25]}}}}],
            "textures": [{{"source": 0}}, {{"source": 1}}],
            "images": [{{"uri": "data:image/png;base64,{png}"}}, {{"uri": "missing.jpg"}}],
            "cameras": [{{"type": "perspective", "perspective": {{"yfov": 1.5707963, "znear": 0.1}}}},
              {{"type": "orthographic", "orthographic": {{"xmag": 1, "ymag": 1, "zfar": 9, "znear": 1}}}}],
            "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_ior", "KHR_materials_transmission", "ACME_fur"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [
              {{"type": "point", "color": [1, 0.5, 0], "intensity": 10}},
              {{"type": "directional"}},
              {{"type": "spot", "spot": {{}}, "intensity": 2}}]}}}},
            "nodes": [{{"mesh": 0}},
              {{"camera": 0, "translation": [1, 2, 3], "rotation": [0, 1, 0, 0]}}, {{"camera": 1}},
              {{"translation": [4, 5, 6], "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
              {{"extensions": {{"KHR_lights_punctual": {{"light": 1}}}}}},
              {{"extensions": {{"KHR_lights_punctual": {{"light": 2}}}}}}]"#
    ));
    assert_eq!(scene.material_ids, [0, 0, 1, 1, 2, 2]);
    let [map, mirror, glass, film] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert_eq!((map.texture, map.reflection, map.emission), (Some(0), 0.0, Vec3::Z));
    assert_eq!((mirror.texture, mirror.reflection, mirror.shininess), (None, 1.0, 1e4));
    assert_eq!((mirror.diffuse, mirror.specular), (Vec3::new(1.0, 0.5, 0.0), Vec3::new(1.0, 0.5, 0.0)));
    assert_eq!((glass.transmission, glass.ior), (0.75, 1.25));
    assert_eq!((film.transmission, film.ior), (0.75, 1.0));
    assert_eq!((scene.textures.len(), scene.textures[0].texels[0]), (1, [1.0, 0.0, 0.0]));
    assert_eq!(scene.cameras.len(), 1);
    let camera = scene.cameras[0];
    assert_eq!((camera.eye, camera.up), (Vec3::new(1.0, 2.0, 3.0), Vec3::Y));
    assert!((camera.target - camera.eye).abs_diff_eq(Vec3::Z, 1e-6) && (camera.fov - 90.0).abs() < 1e-3);
    assert_eq!(
        scene.lights[..2],
        [
            Light::Point { position: Vec3::new(4.0, 5.0, 6.0), intensity: Vec3::new(10.0, 5.0, 0.0) },
            Light::Directional { direction: Vec3::NEG_Z, irradiance: Vec3::ONE },
        ]
    );
    assert!(matches!(scene.lights[2], Light::Point { .. }));
    // fur, the missing texture, the orthographic camera, the spot light
    assert_eq!(scene.warnings.len(), 4, "{:?}", scene.warnings);
}

#[test]
fn sparse_and_quantised_accessors() {
    let data: Vec<u8> = [1u8, 2, 0, 0]
        .into_iter()
        .chain([1.0f32, 0.0, 0.0, 0.0, 1.0, 0.0].into_iter().flat_map(f32::to_le_bytes))
        .chain([0u8, 0, 0, 0, 127, 0, 0, 0, 0, 0x81, 0, 0])
        .collect();
    let uri = STANDARD.encode(&data);
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "extensionsRequired": ["KHR_mesh_quantization"],
        "buffers": [{{"uri": "data:;base64,{uri}", "byteLength": 40}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 4}}, {{"buffer": 0, "byteOffset": 4, "byteLength": 24}},
          {{"buffer": 0, "byteOffset": 28, "byteLength": 12, "byteStride": 4}}],
        "accessors": [
          {{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{"count": 2,
            "indices": {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 1}}}}}},
          {{"bufferView": 2, "componentType": 5120, "normalized": true, "count": 3, "type": "VEC3"}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}, {{"attributes": {{"POSITION": 1}}}}]}}],
        "nodes": [{{"mesh": 0}}]}}"#
    );
    let mesh = load_bytes(Format::Gltf, json.as_bytes()).unwrap().mesh;
    assert_eq!(
        mesh.vertices(),
        [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
    );
    assert_eq!(mesh.triangles(), [[0, 1, 2], [3, 4, 5]]);
}

#[test]
fn broken_files_are_errors() {
    let node = r#""nodes": [{"mesh": 0}]"#;
    let mesh = |primitive: &str| format!(r#"{node}, "meshes": [{{"primitives": [{primitive}]}}]"#);
    for rest in [
        mesh(r#"{"attributes": {"POSITION": 99}}"#),
        mesh(r#"{"attributes": {"POSITION": 2}}"#), // two components
        mesh(r#"{"attributes": {"POSITION": 0}, "indices": 99}"#),
        mesh(r#"{"attributes": {"POSITION": 0}, "material": 7}"#),
        mesh(r#"{"attributes": {"POSITION": 0}, "mode": 99}"#),
        mesh(r#"{"attributes": {"POSITION": 0, "NORMAL": 5}}"#),
        r#""nodes": [{"mesh": 3}]"#.to_owned(),
        format!(
            r#"{QUAD}, "nodes": [{{"children": [1]}}, {{"children": [0]}}], "scenes": [{{"nodes": [0]}}]"#
        ),
        format!(r#"{QUAD}, "nodes": [{{"children": [0]}}], "scenes": [{{"nodes": [0]}}]"#),
        format!(r#"{QUAD}, "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0, 0]}}]"#),
        format!(r#"{QUAD}, "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [5]}}]"#),
        format!(r#"{QUAD}, {node}, "scene": 4"#),
        format!(r#"{QUAD}, {node}, "extensionsRequired": ["ACME_bent_triangles"]"#),
        r#""nodes": {"#.to_owned(),
    ] {
        let error = load_bytes(Format::Gltf, embedded(&rest).as_bytes()).expect_err(&rest);
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    let bent = embedded(&format!(r#"{QUAD}, "extensionsRequired": ["ACME_bent_triangles"]"#));
    let error = load_bytes(Format::Gltf, bent.as_bytes()).unwrap_err();
    assert!(matches!(error, LoadError::Unsupported { .. }) && error.to_string().contains("bent"), "{error}");
    for bytes in [
        &b"glTF"[..],
        b"glTF\x02\0\0\0",
        b"glTF\x01\0\0\0\x10\0\0\0",
        b"glTF\x02\0\0\0\xff\xff\xff\xff",
        b"{}",
        b"[",
        b"PK",
    ] {
        assert!(load_bytes(Format::Glb, bytes).is_err());
        assert!(load_bytes(Format::Gltf, bytes).is_err());
    }
    let old = embedded(node).replace(r#""version": "2.0""#, r#""version": "1.0""#);
    assert!(matches!(load_bytes(Format::Gltf, old.as_bytes()), Err(LoadError::Unsupported { .. })));
}

#[test]
fn counts_that_lie_are_refused_before_memory_is_taken() {
    let huge = 1u64 << 60;
    for (from, to) in [
        (r#""count": 5, "type": "VEC3""#, format!(r#""count": {huge}, "type": "VEC3""#)),
        (r#""count": 6"#, format!(r#""count": {huge}"#)),
        (r#""byteLength": 192"#, format!(r#""byteLength": {huge}"#)),
        (r#""byteLength": 60"#, format!(r#""byteLength": {huge}"#)),
        (r#""byteLength": 32"#, r#""byteLength": 32, "byteStride": 18446744073709551615"#.to_owned()),
        (r#""byteOffset": 160"#, format!(r#""byteOffset": {}"#, u64::MAX)),
        (
            r#""bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3""#,
            format!(
                r#""componentType": 5126, "count": {huge}, "type": "VEC3", "sparse": {{"count": 1, "indices":
                {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 1}}}}"#
            ),
        ),
    ] {
        let file = embedded(&format!(r#"{QUAD}, "nodes": [{{"mesh": 0}}]"#));
        assert!(file.contains(from));
        let error = load_bytes(Format::Gltf, file.replace(from, &to).as_bytes()).expect_err(&to);
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    // Instances of one large mesh: a few hundred bytes each, a million triangles each.
    let count = 3_000_000;
    let nodes = vec![r#"{"mesh": 0}"#; 400].join(",");
    let file = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": 64}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 64}}],
        "accessors": [{{"componentType": 5126, "count": {count}, "type": "VEC3", "sparse": {{"count": 1, "indices":
          {{"bufferView": 0, "componentType": 5121}}, "values": {{"bufferView": 0, "byteOffset": 4}}}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "nodes": [{nodes}]}}"#
    );
    let error = load_bytes(Format::Glb, &glb(&file, &[0; 64])).unwrap_err();
    assert!(matches!(error, LoadError::OutOfProportion { .. }), "{error}");
    let objects = format!(r#"{{"asset": {{"version": "2.0"}}, "nodes": [{}{{}}]}}"#, "{},".repeat(1 << 20));
    let error = load_bytes(Format::Gltf, objects.as_bytes()).unwrap_err();
    assert!(matches!(error, LoadError::OutOfProportion { .. }), "{error}");
}

#[test]
fn textures_out_of_proportion_are_left_out() {
    let mut png = Vec::new();
    slimkd_util::png::write(&mut png, [1, 1], &[0; 3]).unwrap();
    // The header chunk: length, "IHDR", width, height, 5 bytes, checksum of all but the length.
    png[16..20].copy_from_slice(&60_000u32.to_be_bytes());
    png[20..24].copy_from_slice(&60_000u32.to_be_bytes());
    let mut checksum = flate2::Crc::new();
    checksum.update(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.sum().to_be_bytes());
    let scene = parse(&format!(
        r#""materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
        "textures": [{{"source": 0}}], "images": [{{"uri": "data:image/png;base64,{}"}}]"#,
        STANDARD.encode(png)
    ));
    assert!(scene.textures.is_empty() && scene.materials[0].texture.is_none());
    assert!(scene.warnings[0].text().contains("out of proportion"), "{:?}", scene.warnings);
}
