//! The corpus and mutations of it through every target: seconds, no libFuzzer, the same on every machine.
//!
//! `SLIMKD_FUZZ_SEEDS=1` writes the seeds anew.

use slimkd::{BuildOptions, KdTree, Preset};
use slimkd_util::Rng;
use std::fs;
use std::path::PathBuf;

type Target = (&'static str, fn(&[u8]), usize);
/// With mutations of each corpus entry.
const TARGETS: [Target; 4] = [
    ("scene", slimkd_fuzz::scene, 60),
    ("skd", slimkd_fuzz::skd, 60),
    ("soup", slimkd_fuzz::soup, 6),
    ("rays", slimkd_fuzz::rays, 4),
];

fn folder(target: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

fn mutate(data: &mut Vec<u8>, rng: &mut Rng) {
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(data.len());
        match rng.below(6) {
            0 if at < data.len() => data[at] ^= 1 << rng.below(8),
            1 if at < data.len() => data[at] = rng.bits() as u8,
            2 if at < data.len() => data[at] = [0, 1, 0x7f, 0x80, 0xff][rng.below(5)],
            3 => data.truncate(at),
            4 => data.insert(at, rng.bits() as u8),
            _ => {
                let piece: Vec<u8> = data[at..].iter().take(1 + rng.below(16)).copied().collect();
                let to = rng.below(data.len() + 1);
                data.splice(to..to, piece);
            }
        }
    }
}

#[test]
fn nothing_breaks_a_target() {
    if std::env::var_os("SLIMKD_FUZZ_SEEDS").is_some() {
        seeds();
    }
    for (name, target, mutations) in TARGETS {
        let mut files: Vec<_> =
            fs::read_dir(folder(name)).unwrap().map(|file| file.unwrap().path()).collect();
        files.sort();
        assert!(!files.is_empty(), "{name}");
        let mut rng = Rng::new(7);
        for file in files {
            let seed = fs::read(&file).unwrap();
            target(&seed);
            for _ in 0..mutations {
                let mut data = seed.clone();
                mutate(&mut data, &mut rng);
                target(&data);
            }
        }
    }
}

fn seeds() {
    let put = |target: &str, name: &str, data: &[u8]| fs::write(folder(target).join(name), data).unwrap();
    let mut rng = Rng::new(1);
    let mut noise = |length: usize| (0..length).map(|_| rng.bits() as u8).collect::<Vec<_>>();
    for k in 0..6 {
        put("soup", &format!("seed-{k}"), &noise(100 << k));
        put("rays", &format!("seed-{k}"), &noise(32 * (k + 1)));
    }
    let floats =
        |rays: &[[f32; 8]]| rays.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<_>>();
    put(
        "rays",
        "seed-plain",
        &floats(&[
            [0.1, 0.2, 9.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY],
            [-9.0, 0.1, 0.1, 0.0, 1.0, 0.0, 0.0, 99.0],
        ]),
    );
    for (k, &preset) in Preset::ALL.iter().enumerate() {
        let mesh = slimkd_fuzz::small_mesh(&noise(300 + 100 * k));
        let tree = KdTree::build(mesh, &BuildOptions::from(preset)).unwrap();
        for signed in [0, 1] {
            let mut file = vec![signed];
            tree.write(&mut file).unwrap();
            put("skd", &format!("seed-{k}-{signed}"), &file);
        }
    }
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n";
    let mut binary = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n".to_vec();
    for x in 0..3u8 {
        binary.extend([0, 0, 128, 63, 0, 0, 0, 64, x, 0, 0, 65, x]);
    }
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    let obj = "mtllib a.mtl\no box\nv 0 0 0\nv 1 0 0\nv 1 1 0 1\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a\nusemtl m\ns 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1//1 -2//1 -3//1\nf 1 2 3\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
    let mut stl_binary = vec![0; 84 + 50];
    stl_binary[80] = 1;
    stl_binary[84 + 24..84 + 28].copy_from_slice(&1f32.to_le_bytes());
    stl_binary[84 + 40..84 + 44].copy_from_slice(&1f32.to_le_bytes());
    let json = |buffer: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0,"scale":[2,2,2],"children":[1]}},{{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],"materials":[{{"pbrMetallicRoughness":{{"baseColorFactor":[1,0,0,1]}}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},{{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],"buffers":[{{"byteLength":44{buffer}}}]}}"#
        )
    };
    let gltf = json(
        r#","uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=""#,
    );
    let mut text = json("").into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut buffer = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect::<Vec<_>>();
    buffer.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    let mut glb = b"glTF".to_vec();
    for number in [2, (12 + 8 + text.len() + 8 + buffer.len()) as u32, text.len() as u32] {
        glb.extend(number.to_le_bytes());
    }
    glb.extend(b"JSON");
    glb.extend(&text);
    glb.extend((buffer.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(&buffer);
    let off = "COFF\n4 1 0\n0 0 0 1 0 0\n4 0 0 0 1 0\n1 1 0 0 0 1\n0 4 0 255 255 255\n4 0 1 2 3 9 9 9\n";
    let grid = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9\n1 2\n3 4\n";
    let npy = b"\x93NUMPY\x01\x00\x3c\x00{'descr': '|u1', 'fortran_order': False, 'shape': (2, 2), }\n\x01\x02\x03\x04";
    let files: [(u8, &[u8]); 10] = [
        (0, ply.as_bytes()),
        (0, &binary),
        (1, obj.as_bytes()),
        (2, stl.as_bytes()),
        (2, &stl_binary),
        (3, gltf.as_bytes()),
        (4, &glb),
        (5, off.as_bytes()),
        (6, grid.as_bytes()),
        (7, npy),
    ];
    for (k, (format, file)) in files.into_iter().enumerate() {
        slimkd_scene::load_bytes(slimkd_fuzz::FORMATS[usize::from(format)], file)
            .unwrap_or_else(|error| panic!("seed {k}: {error}"));
        put("scene", &format!("seed-{k}"), &[&[format], file].concat());
    }
    put("scene", "seed-zst", &[&[8], &zstd::encode_all(ply.as_bytes(), 3).unwrap()[..]].concat());
    let mut gzip = flate2::write::GzEncoder::new(vec![16], flate2::Compression::best());
    std::io::Write::write_all(&mut gzip, ply.as_bytes()).unwrap();
    put("scene", "seed-gz", &gzip.finish().unwrap());
}
