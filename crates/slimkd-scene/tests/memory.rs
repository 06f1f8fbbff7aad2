//! Loading takes at most 4 times the decoded bytes and 256 MiB, whatever the file is; measured by the allocator. Decoded is
//! what comes out of the compression, or the mesh where that is larger.

use cap::Cap;
use slimkd_scene::{Compression, FileKind, Format, LoadError, Scene, load_bytes};
use std::alloc::System;
use std::io::Write;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

const FACTOR: f64 = 4.0;
/// What is free.
const FREE: usize = 256 << 20;
/// What sound files may take beyond the factor: buffers that do not grow with the file.
const BUFFERS: usize = 9 << 20;

/// A terrain of 2 · `edge`² triangles.
struct Terrain {
    edge: u32,
}

impl Terrain {
    fn vertices(&self) -> impl Iterator<Item = [f32; 3]> {
        let row = self.edge + 1;
        (0..row * row).map(move |i| {
            let (x, y) = ((i % row) as f32, (i / row) as f32);
            [x * 0.37, y * 0.41, (x * 0.7).sin() * (y * 0.3).cos()]
        })
    }

    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let (edge, row) = (self.edge, self.edge + 1);
        (0..2 * edge * edge).map(move |i| {
            let a = i / 2 % edge + i / 2 / edge * row;
            if i % 2 == 0 { [a, a + 1, a + row] } else { [a + 1, a + row + 1, a + row] }
        })
    }

    fn corners(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        let vertices: Vec<_> = self.vertices().collect();
        self.triangles().map(move |corners| corners.map(|v| vertices[v as usize]))
    }

    fn ply(&self, text: bool) -> Vec<u8> {
        let encoding = if text { "ascii" } else { "binary_little_endian" };
        let mut out = ply_header(encoding, self.vertices().count(), "int", self.triangles().count());
        for vertex in self.vertices() {
            if text {
                writeln!(out, "{} {} {}", vertex[0], vertex[1], vertex[2]).unwrap();
            } else {
                vertex.iter().for_each(|x| out.extend(x.to_le_bytes()));
            }
        }
        for triangle in self.triangles() {
            if text {
                writeln!(out, "3 {} {} {}", triangle[0], triangle[1], triangle[2]).unwrap();
            } else {
                out.push(3);
                triangle.iter().for_each(|x| out.extend(x.to_le_bytes()));
            }
        }
        out
    }

    fn obj(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.vertices().for_each(|[x, y, z]| writeln!(out, "v {x} {y} {z}").unwrap());
        self.triangles().for_each(|t| writeln!(out, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1).unwrap());
        out
    }

    fn stl(&self, text: bool) -> Vec<u8> {
        let mut out = if text { b"solid t\n".to_vec() } else { vec![0; 80] };
        if !text {
            out.extend((2 * self.edge * self.edge).to_le_bytes());
        }
        for corners in self.corners() {
            if text {
                out.extend(b"facet normal 0 0 0\nouter loop\n");
                corners.iter().for_each(|[x, y, z]| writeln!(out, "vertex {x} {y} {z}").unwrap());
                out.extend(b"endloop\nendfacet\n");
            } else {
                out.extend([0; 12]);
                corners.as_flattened().iter().for_each(|x| out.extend(x.to_le_bytes()));
                out.extend([0; 2]);
            }
        }
        if text {
            out.extend(b"endsolid t\n");
        }
        out
    }

    /// Places and indices as glTF has them.
    fn buffer(&self) -> Vec<u8> {
        let mut out: Vec<u8> = self.vertices().flatten().flat_map(f32::to_le_bytes).collect();
        out.extend(self.triangles().flatten().flat_map(u32::to_le_bytes));
        out
    }

    fn json(&self, uri: &str, nodes: usize) -> String {
        let (vertices, indices) = (self.vertices().count(), 3 * self.triangles().count());
        let all = vec![r#"{"mesh":0}"#; nodes].join(",");
        let named: Vec<_> = (0..nodes).map(|node| node.to_string()).collect();
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{{uri}"byteLength":{}}}],
            "bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3"}},
            {{"bufferView":1,"componentType":5125,"count":{indices},"type":"SCALAR"}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "nodes":[{all}],"scenes":[{{"nodes":[{}]}}],"scene":0}}"#,
            12 * vertices + 4 * indices,
            12 * vertices,
            12 * vertices,
            4 * indices,
            named.join(",")
        )
    }

    fn gltf(&self) -> Vec<u8> {
        use base64::Engine;
        let data = base64::engine::general_purpose::STANDARD.encode(self.buffer());
        self.json(&format!(r#""uri":"data:application/octet-stream;base64,{data}","#), 1).into_bytes()
    }

    /// Stored, so that its bytes are what is decoded.
    fn serialized(&self) -> Vec<u8> {
        let mut out = vec![0x1c, 4, 3, 0];
        let mut encoder = flate2::write::ZlibEncoder::new(&mut out, flate2::Compression::none());
        encoder.write_all(&0x1000u32.to_le_bytes()).unwrap();
        let counts = [self.vertices().count() as u64, self.triangles().count() as u64];
        encoder.write_all(counts.map(u64::to_le_bytes).as_flattened()).unwrap();
        encoder.write_all(&self.buffer()).unwrap();
        encoder.finish().unwrap();
        out
    }

    /// One model, or a sequence of features with so many triangles each.
    fn city(&self, each: usize) -> Vec<u8> {
        let (vertices, triangles): (Vec<_>, Vec<_>) = (self.vertices().collect(), self.triangles().collect());
        let head = r#""version":"2.0","transform":{"scale":[0.01,0.01,0.01],"translate":[0,0,0]}"#;
        let mut out = Vec::new();
        let is_whole = each >= triangles.len();
        if !is_whole {
            writeln!(out, r#"{{"type":"CityJSON",{head},"CityObjects":{{}},"vertices":[]}}"#).unwrap();
        }
        for part in triangles.chunks(each) {
            let kind = if is_whole { "CityJSON" } else { "CityJSONFeature" };
            write!(out, r#"{{"type":"{kind}",{head},"CityObjects":{{"a":{{"type":"TINRelief","geometry":["#)
                .unwrap();
            write!(out, r#"{{"type":"CompositeSurface","lod":"2","boundaries":["#).unwrap();
            let at = |corner: usize, k: u32| if is_whole { k as usize } else { corner };
            for (k, corners) in part.iter().enumerate() {
                let [a, b, c] = std::array::from_fn(|corner| at(3 * k + corner, corners[corner]));
                write!(out, "{}[[{a},{b},{c}]]", if k > 0 { "," } else { "" }).unwrap();
            }
            write!(out, r#"]}}]}}}},"vertices":["#).unwrap();
            let own: Vec<u32> =
                if is_whole { (0..vertices.len() as u32).collect() } else { part.as_flattened().to_vec() };
            for (k, vertex) in own.iter().enumerate() {
                let [x, y, z] = vertices[*vertex as usize].map(|x| (100.0 * x).round() as i32);
                write!(out, "{}[{x},{y},{z}]", if k > 0 { "," } else { "" }).unwrap();
            }
            writeln!(out, "]}}").unwrap();
        }
        out
    }

    fn glb(&self, nodes: usize) -> Vec<u8> {
        let (mut json, buffer) = (self.json("", nodes).into_bytes(), self.buffer());
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((28 + json.len() as u32 + buffer.len() as u32).to_le_bytes());
        for (name, content) in [(b"JSON", &json), (b"BIN\0", &buffer)] {
            out.extend((content.len() as u32).to_le_bytes());
            out.extend(name);
            out.extend(content);
        }
        out
    }
}

fn ply_header(encoding: &str, vertices: usize, index: &str, faces: usize) -> Vec<u8> {
    format!(
        "ply\nformat {encoding} 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar {index} vertex_indices\nend_header\n"
    )
    .into_bytes()
}

fn compress(compression: Compression, bytes: &[u8]) -> Vec<u8> {
    match compression {
        Compression::None => bytes.to_vec(),
        Compression::Zstd => zstd::encode_all(bytes, 1).unwrap(),
        Compression::Gzip => {
            let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        }
    }
}

/// The answer, and the most bytes that were live above what was live before.
fn measured(kind: FileKind, bytes: &[u8]) -> (Result<Scene, LoadError>, usize) {
    // There is no way to begin a new maximum, so a block as large as all before is taken first.
    let before = ALLOCATOR.allocated();
    let high = ALLOCATOR.max_allocated();
    let room: Vec<u8> = Vec::with_capacity(high - before + (64 << 10));
    let before = ALLOCATOR.allocated();
    let loaded = load_bytes(kind, bytes);
    let peak = ALLOCATOR.max_allocated() - before;
    drop(room);
    (loaded, peak)
}

/// One test: live bytes are counted over the whole process.
#[test]
fn loading_takes_memory_in_proportion() {
    let terrain = Terrain { edge: 300 };
    let samples: [(&str, Format, Vec<u8>); 10] = [
        ("binary PLY", Format::Ply, terrain.ply(false)),
        ("text PLY", Format::Ply, terrain.ply(true)),
        ("OBJ", Format::Obj, terrain.obj()),
        ("binary STL", Format::Stl, terrain.stl(false)),
        ("text STL", Format::Stl, terrain.stl(true)),
        ("glTF", Format::Gltf, terrain.gltf()),
        ("GLB", Format::Glb, terrain.glb(1)),
        ("serialized", Format::Serialized, terrain.serialized()),
        ("CityJSON", Format::CityJson, terrain.city(180_000)),
        ("CityJSONSeq", Format::CityJsonSeq, terrain.city(60)),
    ];
    for (name, format, bytes) in &samples {
        for compression in [Compression::None, Compression::Zstd, Compression::Gzip] {
            let file = compress(compression, bytes);
            let (scene, peak) = measured(FileKind { format: *format, compression }, &file);
            assert_eq!(scene.unwrap().mesh.len(), 180_000, "{name}");
            let part = peak as f64 / bytes.len() as f64;
            println!(
                "{name}, {compression:?}: {:.1} MiB, {part:.2} times its decoded bytes",
                peak as f64 / 1048576.0
            );
            assert!(
                peak as f64 <= FACTOR * bytes.len() as f64 + BUFFERS as f64,
                "{name}, {compression:?}: {part}"
            );
        }
    }
    dense_files();
    bombs_and_lies(&terrain);
}

/// Files that say much in few bytes: their mesh is larger than they are.
fn dense_files() {
    let mut fans = ply_header("binary_little_endian", 255, "uchar", 20_000);
    fans.extend([0u8; 255 * 12]);
    let face: Vec<u8> = std::iter::once(255).chain(0..255).collect();
    (0..20_000).for_each(|_| fans.extend(&face));
    let mut polygon = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_vec();
    (0..20).for_each(|_| {
        polygon.extend(b"f");
        (0..100_000).for_each(|_| polygon.extend(b" 1"));
        polygon.push(b'\n');
    });
    let instances = Terrain { edge: 64 }.glb(150);
    for (name, format, bytes) in [
        ("fans", Format::Ply, fans),
        ("polygons", Format::Obj, polygon),
        ("instances", Format::Glb, instances),
    ] {
        let (scene, peak) = measured(format.into(), &bytes);
        let decoded = scene.as_ref().map_or(0, |scene| scene.mesh.memory_bytes() as usize).max(bytes.len());
        let part = peak as f64 / decoded as f64;
        println!("{name}: {} of {} bytes, {part:.2} times", peak, decoded);
        assert!(scene.is_ok(), "{name}: {}", scene.unwrap_err());
        assert!(peak as f64 <= FACTOR * decoded as f64 + BUFFERS as f64, "{name}: {part}");
    }
}

fn bombs_and_lies(terrain: &Terrain) {
    let zeros = |compression| compress(compression, &vec![0u8; 300 << 20]);
    let mut many = ply_header("binary_little_endian", 4_000_000_000, "int", 4_000_000_000);
    many.extend([0; 1000]);
    let lies = [
        (
            "zeros as zstd",
            FileKind { format: Format::Ply, compression: Compression::Zstd },
            zeros(Compression::Zstd),
        ),
        (
            "zeros as gzip",
            FileKind { format: Format::Stl, compression: Compression::Gzip },
            zeros(Compression::Gzip),
        ),
        ("a count that lies", Format::Ply.into(), many),
        ("20,000 instances", Format::Glb.into(), terrain.glb(20_000)),
    ];
    for (name, kind, bytes) in lies {
        let (scene, peak) = measured(kind, &bytes);
        println!("{name}: {:.1} MiB over {:.1}", peak as f64 / 1048576.0, bytes.len() as f64 / 1048576.0);
        assert!(scene.is_err(), "{name}");
        assert!(peak as f64 <= FACTOR * bytes.len() as f64 + FREE as f64, "{name}: {peak}");
    }
}
