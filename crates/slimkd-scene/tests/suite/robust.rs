//! Broken files of every format: an error of one line, never a panic, never a hang.

use slimkd_scene::{Compression, FileKind, Format, LoadError, LoadOptions, load, load_bytes, load_with};
use std::{fs, io::Write, path::Path};

const TETRAHEDRON: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn ply(encoding: &str) -> Vec<u8> {
    let mut out = format!(
        "ply\nformat {encoding} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    if encoding == "ascii" {
        TETRAHEDRON.iter().for_each(|[x, y, z]| writeln!(out, "{x} {y} {z}").unwrap());
        FACES.iter().for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}").unwrap());
        return out;
    }
    let big = encoding.contains("big");
    let mut push = |raw: [u8; 4]| out.extend(if big { [raw[3], raw[2], raw[1], raw[0]] } else { raw });
    TETRAHEDRON.iter().flatten().for_each(|x| push(x.to_le_bytes()));
    for face in FACES {
        out.push(3);
        face.iter().for_each(|index| {
            out.extend(if big { index.to_be_bytes() } else { index.to_le_bytes() });
        });
    }
    out
}

fn obj() -> Vec<u8> {
    let mut out = b"mtllib m.mtl\nusemtl m\nvt 0 0\nvn 0 0 1\n".to_vec();
    TETRAHEDRON.iter().for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}").unwrap());
    FACES.iter().for_each(|f| writeln!(out, "f {}/1/1 {}//-1 -1/1/1", f[0] + 1, f[1] + 1).unwrap());
    out
}

fn stl_text() -> Vec<u8> {
    let mut out = b"solid t\n".to_vec();
    for face in FACES {
        out.extend(b"facet normal 0 0 0\nouter loop\n");
        face.map(|k| TETRAHEDRON[k as usize])
            .iter()
            .for_each(|[x, y, z]| writeln!(out, "vertex {x} {y} {z}").unwrap());
        out.extend(b"endloop\nendfacet\n");
    }
    out.extend(b"endsolid t\n");
    out
}

fn stl_binary() -> Vec<u8> {
    let mut out = vec![0; 80];
    out.extend(4u32.to_le_bytes());
    for face in FACES {
        out.extend([0; 12]);
        face.iter().flat_map(|&k| TETRAHEDRON[k as usize]).for_each(|x| out.extend(x.to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

fn glb() -> Vec<u8> {
    let mut json = br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":60}],
        "bufferViews":[{"buffer":0,"byteLength":48,"byteStride":12},{"buffer":0,"byteOffset":48,"byteLength":12}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
        {"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"},{"componentType":5126,"count":4,
        "type":"VEC3","sparse":{"count":2,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":2},"indices":1,"mode":4,"material":0}]}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":0}},"alphaMode":"BLEND"}],
        "textures":[{"source":0}],"images":[{"bufferView":1,"mimeType":"image/png"}],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],
        "nodes":[{"mesh":0,"children":[1],"rotation":[0,0,0,1]},{"mesh":0,"camera":0,"scale":[1,2,3]}],
        "scenes":[{"nodes":[0]}],"scene":0}"#
        .to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend((28 + json.len() as u32 + 60).to_le_bytes());
    out.extend((json.len() as u32).to_le_bytes());
    out.extend(b"JSON");
    out.extend(json);
    out.extend(60u32.to_le_bytes());
    out.extend(b"BIN\0");
    TETRAHEDRON.iter().flatten().for_each(|x| out.extend(x.to_le_bytes()));
    FACES.iter().flatten().for_each(|&index| out.push(index as u8));
    out
}

/// The JSON of the GLB alone.
fn gltf() -> Vec<u8> {
    let glb = glb();
    let data = "data:;base64,".to_owned() + &"AAAA".repeat(20);
    let json = String::from_utf8_lossy(&glb[20..glb.len() - 68]);
    json.replace(r#""buffers":[{"#, &format!(r#""buffers":[{{"uri":"{data}","#))
        .trim_end()
        .as_bytes()
        .to_vec()
}

fn off() -> Vec<u8> {
    let mut out = b"COFF\n4 4 0 # by hand\n".to_vec();
    TETRAHEDRON.iter().for_each(|[x, y, z]| writeln!(out, "{x} {y} {z} 1 0 0.5 1").unwrap());
    FACES.iter().for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c} 9 8 7").unwrap());
    out
}

fn mitsuba() -> Vec<u8> {
    br##"<?xml version="1.0"?><!DOCTYPE scene><scene version="2.1.0"><!-- all of it --><default name="w" value="2"/>
        <bsdf type="twosided" id="m"><bsdf type="roughconductor"><rgb name="specular_reflectance" value="#ff8000"/></bsdf></bsdf>
        <shape type="shapegroup" id="g"><shape type="cube"><ref id="m"/></shape></shape>
        <shape type="instance"><ref id="g"/><transform name="to_world"><scale value="$w"/><rotate y="1" angle="30"/></transform></shape>
        <shape type="disk"/><shape type="cylinder"><point name="p1" x="1" y="2" z="3"/></shape><shape type="sphere"/></scene>"##
        .to_vec()
}

fn serialized() -> Vec<u8> {
    let mut content = 0x1000u32.to_le_bytes().to_vec();
    content.extend(b"name\0");
    content.extend([4u64, 4].map(u64::to_le_bytes).as_flattened());
    TETRAHEDRON.iter().flatten().for_each(|x| content.extend(x.to_le_bytes()));
    FACES.iter().flatten().for_each(|corner| content.extend(corner.to_le_bytes()));
    let mut out = vec![0x1c, 4, 4, 0];
    let mut encoder = flate2::write::ZlibEncoder::new(&mut out, flate2::Compression::best());
    encoder.write_all(&content).unwrap();
    encoder.finish().unwrap();
    let second = out.len() as u64;
    let first = out.clone();
    out.extend(first);
    out.extend([0, second].map(u64::to_le_bytes).as_flattened());
    out.extend(2u32.to_le_bytes());
    out
}

fn city(kind: &str) -> Vec<u8> {
    let faces = FACES.map(|[a, b, c]| format!("[[{a},{b},{c}]]")).join(",");
    let vertices = TETRAHEDRON.map(|[x, y, z]| format!("[{x},{y},{z}]")).join(",");
    format!(
        r#"{{"type":"{kind}","version":"2.0","id":"a","transform":{{"scale":[1,1,1],"translate":[5,5,5]}},"CityObjects":{{"a":{{
        "type":"Building","geometry":[{{"type":"Solid","lod":"2.1","boundaries":[[{faces}]],"semantics":{{"surfaces":[{{
        "type":"RoofSurface"}}],"values":[[0,null,0,null]]}}}}]}}}},"vertices":[{vertices}]}}"#
    )
    .replace('\n', " ")
    .into_bytes()
}

fn npy() -> Vec<u8> {
    let mut out =
        b"\x93NUMPY\x01\x00\x3c\x00{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }\n".to_vec();
    out.extend([1, 2, 3, 4, 5, 6]);
    out
}

/// A valid file of every format, and whether a cut always shows.
fn samples() -> Vec<(FileKind, Vec<u8>, bool)> {
    let mut samples = vec![
        (Format::Ply.into(), ply("binary_little_endian"), true),
        (Format::Ply.into(), ply("binary_big_endian"), true),
        (Format::Ply.into(), ply("ascii"), false),
        (Format::Obj.into(), obj(), false),
        (Format::Stl.into(), stl_text(), false),
        (Format::Stl.into(), stl_binary(), true),
        (Format::Gltf.into(), gltf(), true),
        (Format::Glb.into(), glb(), true),
        (Format::Off.into(), off(), false),
        (Format::Mitsuba.into(), mitsuba(), true),
        (Format::Serialized.into(), serialized(), false),
        (Format::CityJson.into(), city("CityJSON"), true),
        (Format::CityJsonSeq.into(), [city("CityJSON"), city("CityJSONFeature")].join(&b'\n'), false),
        (
            Format::AsciiGrid.into(),
            b"ncols 3\nnrows 2\nxllcorner 1\nyllcenter 2\ncellsize 0.5\n1 2 3\n4 5 6".to_vec(),
            false,
        ),
        (Format::Npy.into(), npy(), true),
    ];
    for compression in [Compression::Zstd, Compression::Gzip] {
        for k in [0, 3] {
            let (kind, bytes, _): &(FileKind, _, _) = &samples[k];
            samples.push((FileKind { compression, ..*kind }, compress(compression, bytes), true));
        }
    }
    samples
}

fn compress(compression: Compression, bytes: &[u8]) -> Vec<u8> {
    match compression {
        Compression::Zstd => zstd::encode_all(bytes, 3).unwrap(),
        Compression::Gzip => {
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        }
        Compression::None => bytes.to_vec(),
    }
}

fn check(error: &LoadError) {
    let message = error.to_string();
    assert!(!message.contains(['\n', '\r']) && message.len() < 400, "{message}");
}

#[test]
fn the_samples_are_valid() {
    for (kind, bytes, _) in samples() {
        let scene = load_bytes(kind, &bytes).unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        assert_eq!(scene.mesh.len() % 4, 0);
        assert!(!scene.mesh.is_empty() && !scene.materials.is_empty());
    }
}

#[test]
fn cut_off_at_every_length() {
    for (kind, bytes, shows) in samples() {
        for length in 0..bytes.len() {
            match load_bytes(kind, &bytes[..length]) {
                Err(error) => check(&error),
                Ok(_) => assert!(!shows && length > 0, "{kind:?} cut at {length} of {}", bytes.len()),
            }
        }
    }
}

#[test]
fn every_byte_changed() {
    for (kind, bytes, _) in samples() {
        for at in 0..bytes.len() {
            let mut bytes = bytes.clone();
            for value in [0, 0xff, b'0', b'9', b'-', b' ', b'\n', bytes[at] ^ 1, bytes[at] ^ 0x80] {
                bytes[at] = value;
                if let Err(error) = load_bytes(kind, &bytes) {
                    check(&error);
                }
            }
        }
    }
}

#[test]
fn any_bytes_as_any_format() {
    let all = samples();
    for (_, bytes, _) in &all {
        for (kind, _, _) in &all {
            if let Err(error) = load_bytes(*kind, bytes) {
                check(&error);
            }
        }
    }
    // Noise behind each format's first bytes, from a linear congruential generator.
    let mut state = 1u64;
    for (kind, start) in all
        .iter()
        .flat_map(|(kind, bytes, _)| [4, 20, 100].map(|n| (*kind, bytes[..n.min(bytes.len())].to_vec())))
    {
        for _ in 0..20 {
            let mut bytes = start.clone();
            for _ in 0..300 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                bytes.push((state >> 56) as u8);
            }
            if let Err(error) = load_bytes(kind, &bytes) {
                check(&error);
            }
        }
    }
}

#[test]
fn paths_that_are_no_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let error = |path: &Path| {
        let error = load(path).unwrap_err();
        check(&error);
        error
    };
    assert!(matches!(error(&at("missing.ply")), LoadError::Read { .. }));
    assert!(matches!(error(folder.path()), LoadError::NotAFile { .. }));
    fs::create_dir(at("folder.ply")).unwrap();
    assert!(matches!(error(&at("folder.ply")), LoadError::NotAFile { .. }));
    for name in ["scene", "scene.txt", "scene.zst", ".ply", "scene.txt.gz", "scene.ply.xz"] {
        fs::write(at(name), "x").unwrap();
        assert!(matches!(error(&at(name)), LoadError::UnknownFormat { .. }), "{name}");
    }
    for name in ["a.ply", "a.obj", "a.stl", "a.gltf", "a.glb", "a.ply.zst", "a.obj.gz"] {
        fs::write(at(name), "").unwrap();
        assert!(matches!(error(&at(name)), LoadError::Empty), "{name}");
        fs::write(at(name), [0x80; 100]).unwrap();
        error(&at(name));
    }
}

#[test]
fn compressed_files_by_their_names() {
    let folder = tempfile::tempdir().unwrap();
    for (name, compression) in [
        ("a.b.PLY", Compression::None),
        ("a.b.ply.zst", Compression::Zstd),
        ("a.b.Ply.GZ", Compression::Gzip),
    ] {
        let path = folder.path().join(name);
        // Two frames behind each other are one file.
        let bytes = ply("ascii");
        let (first, second) = bytes.split_at(100);
        fs::write(&path, [compress(compression, first), compress(compression, second)].concat()).unwrap();
        let progress = slimkd::Progress::new();
        let scene = load_with(&path, &LoadOptions::new(), &progress).unwrap();
        assert_eq!((scene.name.as_str(), scene.mesh.triangles()), ("a.b", &FACES[..]));
        assert_eq!(progress.fraction(), 1.0);
    }
}

#[test]
fn bombs_are_refused() {
    let mut content = ply("binary_little_endian");
    content.extend(vec![0; 160 << 20]);
    for compression in [Compression::Zstd, Compression::Gzip] {
        let bomb = compress(compression, &content);
        assert!(bomb.len() < 1 << 20);
        let error = load_bytes(FileKind { format: Format::Ply, compression }, &bomb).unwrap_err();
        assert!(matches!(error, LoadError::OutOfProportion { .. }), "{error}");
    }
    // Zeros that are still in proportion are what they are: bytes behind the last face.
    let small = compress(Compression::Zstd, &content[..32 << 20]);
    assert_eq!(
        load_bytes(FileKind { format: Format::Ply, compression: Compression::Zstd }, &small)
            .unwrap()
            .mesh
            .len(),
        4
    );
}

#[test]
fn a_cancelled_load_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    fs::write(&path, ply("ascii")).unwrap();
    let progress = slimkd::Progress::new();
    progress.cancel();
    assert!(matches!(load_with(&path, &LoadOptions::new(), &progress), Err(LoadError::Cancelled)));
}
