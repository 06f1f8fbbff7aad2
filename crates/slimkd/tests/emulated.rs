//! The same bits on lower processors than this one: this program runs itself under qemu-user, as a processor with SSE2 alone and as
//! one with AVX2, and compares what they build and hit. Skipped with a word where qemu-x86_64 is missing (Debian: qemu-user).
#![cfg(all(target_arch = "x86_64", target_os = "linux"))]

mod common;

use common::{hard_rays, soup, variants};
use slimkd::{Hit, InstructionSet, KdTree, Tracer};
use std::process::Command;
use std::sync::Arc;

/// By the names of `qemu-x86_64 -cpu help`, with what each must find.
const PROCESSORS: [(&str, InstructionSet); 2] =
    [("Nehalem", InstructionSet::Sse2), ("Haswell", InstructionSet::Avx2)];
/// Set for the emulated run, which prints its digest and compares nothing.
const INSIDE: &str = "SLIMKD_EMULATED";
const DIGEST: &str = "digest of trees and hits:";

/// FNV-1a over words.
struct Digest(u64);

impl Digest {
    fn add(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn add_hit(&mut self, hit: Option<Hit>) {
        match hit {
            Some(hit) => {
                [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.triangle]
                    .iter()
                    .for_each(|&word| self.add(word));
            }
            None => self.add(u32::MAX),
        }
    }
}

/// Of every variant's bytes and of what each kind of query hits, with the best instruction set that is here.
fn digest() -> u64 {
    let mut digest = Digest(0xcbf2_9ce4_8422_2325);
    let mesh = Arc::new(soup(300, 1.0, 0.0, 5));
    let rays = hard_rays(&mesh, 400, 6);
    for (_, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let memory = tree.memory();
        [memory.nodes, memory.indices, memory.other].iter().for_each(|&bytes| digest.add(bytes as u32));
        let mut hits = vec![None; rays.len()];
        let mut any = vec![false; rays.len()];
        rays.iter().for_each(|ray| digest.add_hit(tree.closest(ray)));
        tree.batch().closest(&rays, &mut hits);
        hits.iter().for_each(|&hit| digest.add_hit(hit));
        tree.batch().coherent().closest(&rays, &mut hits);
        hits.iter().for_each(|&hit| digest.add_hit(hit));
        tree.batch().any(&rays, &mut any);
        any.iter().for_each(|&hit| digest.add(u32::from(hit)));
        tree.batch().coherent().any(&rays, &mut any);
        any.iter().for_each(|&hit| digest.add(u32::from(hit)));
    }
    digest.0
}

#[test]
fn lower_processors_build_and_hit_the_same() {
    if std::env::var_os(INSIDE).is_some() {
        println!("{DIGEST} {:016x} by {}", digest(), InstructionSet::best().name());
        return;
    }
    if Command::new("qemu-x86_64").arg("--version").output().is_err() {
        return slimkd_util::missing("qemu", "Debian: apt-get install qemu-user");
    }
    let expected = digest();
    for (processor, set) in PROCESSORS {
        let output = Command::new("qemu-x86_64")
            .args(["-cpu", processor])
            .arg(std::env::current_exe().unwrap())
            .args(["lower_processors_build_and_hit_the_same", "--exact", "--nocapture"])
            .env(INSIDE, "1")
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        let wanted = format!("{DIGEST} {expected:016x} by {}", set.name());
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(&wanted), "{processor}: wanted '{wanted}', got:\n{said}{errors}");
    }
}
