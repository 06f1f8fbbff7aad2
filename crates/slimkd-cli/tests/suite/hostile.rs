//! Hostile files from a generator, through the tool as a user runs it: an answer or one line and status 1, in bounded time and
//! memory, and never a panic. Limits are the operating system's.
#![cfg(unix)]

#[path = "../../../slimkd/tests/common/skd.rs"]
mod skd;

use crate::common::{Tool, ray_file, square};
use slimkd::{Preset, Ray};
use slimkd_util::Rng;
use std::io::Write;

/// Address space, KiB: threads' stacks and the program itself take part of it.
const MEMORY: u32 = 1_500_000;
/// CPU time of a run, s; all of these files are small.
const SECONDS: u32 = 10;

/// The status of a run within the limits.
fn limited(tool: &Tool, line: &str) -> i32 {
    let inside = format!("ulimit -v {MEMORY} -t {SECONDS}; exec \"$0\" \"$@\"");
    let mut command = std::process::Command::new("bash");
    let slimkd = tool.command(line);
    command.args(["-c", &inside]).arg(slimkd.get_program()).args(slimkd.get_args());
    command.current_dir(slimkd.get_current_dir().unwrap()).stdin(std::process::Stdio::null());
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    let status = output.status.code().unwrap_or(-1);
    assert!(status == 0 || status == 1, "{line}: {:?} {errors}", output.status);
    assert!(!errors.contains("panicked"), "{line}: {errors}");
    if status == 1 {
        assert_eq!(errors.lines().count(), 1, "{line}: {errors}");
        assert!(errors.starts_with("slimkd: error: "), "{line}: {errors}");
    }
    status
}

fn refused(tool: &Tool, line: &str) {
    assert_eq!(limited(tool, line), 1, "{line}");
}

/// A file with some bytes replaced, doubled, cut off or zeroed.
fn bent(rng: &mut Rng, whole: &[u8]) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(bytes.len());
        match rng.below(6) {
            0 => bytes[at] ^= 1 << rng.below(8),
            1 => bytes[at] = [0, 0xff, 0x7f, b'9', b'-', b'\n'][rng.below(6)],
            2 => bytes.truncate(at.max(1)),
            3 => bytes.extend_from_within(at..),
            4 => {
                let end = (at + 8).min(bytes.len());
                bytes[at..end].fill([0, 0xff][rng.below(2)]);
            }
            _ => {
                let digits = b"4294967295";
                let end = (at + digits.len()).min(bytes.len());
                bytes[at..end].copy_from_slice(&digits[..end - at]);
            }
        }
    }
    bytes
}

const TRIANGLE_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A binary STL of one triangle that says it holds `count`.
fn stl(count: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend(count.to_le_bytes());
    for x in [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0; 2]);
    bytes
}

fn gltf(count: u64, length: u64) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{length},"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],"bufferViews":[{{"buffer":0,"byteLength":{length}}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#
    )
}

/// The same in one binary file.
fn glb() -> Vec<u8> {
    let mut json = gltf(3, 36).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((20 + json.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes
}

#[test]
fn scene_files_of_every_format() {
    let tool = Tool::new();
    tool.ok("scene kitchen --triangles 1000 -o kitchen.ply");
    let kitchen = std::fs::read(tool.path("kitchen.ply")).unwrap();
    let seeds: [(&str, Vec<u8>); 6] = [
        ("ply", square().into_bytes()),
        ("ply", kitchen),
        ("obj", TRIANGLE_OBJ.into()),
        ("stl", stl(1)),
        ("gltf", gltf(3, 36).into()),
        ("glb", glb()),
    ];
    let mut rng = Rng::new(1);
    let (mut answered, mut refused) = (0, 0);
    for (extension, whole) in &seeds {
        let name = format!("whole.{extension}");
        tool.file(&name, whole);
        assert_eq!(limited(&tool, &format!("build {name} --quiet")), 0, "{name}");
        for _ in 0..12 {
            let name = format!("bent.{extension}");
            tool.file(&name, bent(&mut rng, whole));
            let status = limited(&tool, &format!("build {name} --quiet"));
            *if status == 0 { &mut answered } else { &mut refused } += 1;
        }
    }
    assert!(answered > 0 && refused > 20, "{answered} {refused}");
}

#[test]
fn counts_and_sizes_that_lie() {
    let tool = Tool::new();
    let many = "3 0 1 2\n".repeat(3);
    let lies = [
        ("a.ply", square().replace("vertex 4", "vertex 4294967294")),
        ("b.ply", square().replace("face 2", "face 99999999999999999999")),
        ("c.ply", square().replace("uchar int", "uint int").replace("3 0 1 2", "4000000000 0 1 2")),
        ("d.ply", square().replace("ascii", "binary_little_endian")),
        ("e.obj", TRIANGLE_OBJ.replace("f 1 2 3", "f 1 2 9223372036854775807")),
        ("f.obj", TRIANGLE_OBJ.replace("f 1 2 3", "f -1 -2 -9223372036854775808")),
        ("g.gltf", gltf(3_000_000_000, 36)),
        ("h.gltf", gltf(1 << 60, 1 << 62)),
        (
            "i.gltf",
            gltf(3, 36).replace("\"nodes\":[{\"mesh\":0}]", "\"nodes\":[{\"mesh\":0,\"children\":[0]}]"),
        ),
        ("j.gltf", format!("{}{}", "[".repeat(200_000), many)),
    ];
    for (name, text) in lies {
        tool.file(name, text);
        refused(&tool, &format!("build {name} --quiet"));
    }
    // −1 is what programs write that did not know the count: only that lie, and 0, are seen through.
    tool.file("k.stl", stl(u32::MAX - 1));
    refused(&tool, "build k.stl --quiet");
}

/// 16 GiB of spaces in a header line, as run-length blocks of zstd: half a megabyte on the disk.
#[test]
fn compressed_bombs() {
    let tool = Tool::new();
    let mut zstd = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x58];
    let block = |last: u32, kind: u32, size: u32| (size << 3 | kind << 1 | last).to_le_bytes();
    zstd.extend_from_slice(&block(0, 0, 4)[..3]);
    zstd.extend_from_slice(b"ply\n");
    for _ in 0..1 << 17 {
        zstd.extend_from_slice(&block(0, 1, 128 << 10)[..3]);
        zstd.push(b' ');
    }
    tool.file("bomb.ply.zst", zstd);
    refused(&tool, "build bomb.ply.zst --quiet");
}

#[test]
fn saved_trees() {
    let tool = Tool::new();
    ray_file(&tool.path("rays.f32"), &[Ray::new([0.0, 1.0, 0.0], [0.3, -0.2, 0.5]); 64]);
    let mut rng = Rng::new(2);
    let (mut answered, mut wrong) = (0, 0);
    for preset in [Preset::Slim, Preset::Standard, Preset::PaperSmall] {
        tool.ok(&format!("build kitchen --triangles 1000 --preset {} -o tree.skd", preset.name()));
        let whole = std::fs::read(tool.path("tree.skd")).unwrap();
        for round in 0..24 {
            let mut bytes = bent(&mut rng, &whole);
            if round % 2 == 0 {
                // Within one section, with the right checksums.
                bytes.clone_from(&whole);
                let sections = skd::sections(&whole);
                let range = sections[rng.below(sections.len())].range.clone();
                for _ in 0..8 {
                    bytes[range.start + rng.below(range.len())] = [0, 0xff, 0x80, 3][rng.below(4)];
                }
                skd::sign(&mut bytes);
            }
            tool.file("bent.skd", bytes);
            let command =
                ["inspect bent.skd --quiet", "trace bent.skd --rays rays.f32 --out h.bin --no-verify"];
            for line in command {
                *if limited(&tool, line) == 0 { &mut answered } else { &mut wrong } += 1;
            }
        }
        // Lengths that lie.
        for section in 0..skd::sections(&whole).len() {
            let mut bytes = whole.clone();
            bytes[64 + 32 * section + 16..][..8]
                .copy_from_slice(&(1u64 << [31, 40, 62][section % 3]).to_le_bytes());
            skd::place(&mut bytes);
            tool.file("bent.skd", bytes);
            refused(&tool, "inspect bent.skd --quiet");
            refused(&tool, "trace bent.skd --rays rays.f32 --out h.bin --no-verify");
        }
    }
    assert!(answered > 10 && wrong > 30, "{answered} {wrong}");
}

/// With right checksums, and every triangle somewhere.
#[test]
fn forged_trees_that_lack_triangles() {
    let tool = Tool::new();
    tool.ok("build kitchen --triangles 1000 --preset standard -o tree.skd");
    let whole = skd::parts(&std::fs::read(tool.path("tree.skd")).unwrap());
    let mut forged = whole.clone();
    let ids = &mut forged.iter_mut().find(|part| part.0 == 17).unwrap().1;
    // Each triangle stays where it is named first; elsewhere another is named.
    let mut seen = std::collections::HashSet::new();
    for id in ids.chunks_exact_mut(4) {
        if !seen.insert(id.to_vec()) {
            id.copy_from_slice(&whole.iter().find(|part| part.0 == 17).unwrap().1[..4]);
        }
    }
    tool.file("forged.skd", skd::join(&forged));
    assert_eq!(limited(&tool, "inspect forged.skd --quiet"), 0);
    refused(&tool, "inspect forged.skd --complete --quiet");
    assert_eq!(limited(&tool, "inspect tree.skd --complete --quiet"), 0);
}

#[test]
fn ray_files() {
    let tool = Tool::new();
    tool.ok("build kitchen --triangles 1000 -o tree.skd");
    let mut rng = Rng::new(3);
    for round in 0..8 {
        let bytes: Vec<u8> = (0..32 * 500).map(|_| rng.below(256) as u8).collect();
        let cut = if round % 4 == 3 { 17 } else { 0 };
        tool.file("rays.f32", &bytes[cut..]);
        for kernel in ["single", "packet", "stream"] {
            let status =
                limited(&tool, &format!("trace tree.skd --rays rays.f32 --out h.bin --kernel {kernel}"));
            assert_eq!(status, i32::from(cut != 0));
        }
    }
    // A hole in the file: 8 GiB that take no room on the disk, and one ray too few.
    let sparse = std::fs::File::create(tool.path("sparse.f32")).unwrap();
    sparse.set_len((8 << 30) + 1).unwrap();
    refused(&tool, "trace tree.skd --rays sparse.f32 --out h.bin");
    let mut pipe = std::fs::File::create(tool.path("nan.f32")).unwrap();
    pipe.write_all(&[0xff; 32 * 100]).unwrap();
    assert_eq!(limited(&tool, "trace tree.skd --rays nan.f32 --out h.bin"), 0);
}
