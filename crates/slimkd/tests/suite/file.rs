//! `.skd` files: round trips, and damage that must be an error.

use crate::common::{Rng, hard_rays, soup, variants};
use slimkd::{BuildOptions, FileError, KdTree, Preset, Tracer, TriangleMesh};
use std::sync::Arc;

fn written(tree: &KdTree) -> Vec<u8> {
    let mut bytes = Vec::new();
    tree.write(&mut bytes).unwrap();
    bytes
}

#[test]
fn what_was_written_is_read() {
    let mesh = Arc::new(soup(2000, 1.0, 0.0, 3));
    let rays = hard_rays(&mesh, 500, 1);
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let bytes = written(&tree);
        let mut alone = Vec::new();
        tree.write_without_mesh(&mut alone).unwrap();
        for read in [
            KdTree::read(&mut &bytes[..]).unwrap(),
            KdTree::read_with_mesh(&mut &bytes[..], Arc::clone(&mesh)).unwrap(),
            KdTree::read_with_mesh(&mut &alone[..], Arc::clone(&mesh)).unwrap(),
        ] {
            assert_eq!(read.options(), tree.options(), "{variant}");
            assert_eq!(read.statistics(), tree.statistics(), "{variant}");
            for ray in &rays {
                assert_eq!(read.closest(ray), tree.closest(ray), "{variant} {ray:?}");
            }
            assert!(written(&read) == bytes, "{variant}");
        }
    }
}

#[test]
fn an_empty_mesh_is_a_mesh() {
    let tree = KdTree::build(TriangleMesh::default(), &BuildOptions::default()).unwrap();
    assert_eq!(KdTree::read(&mut &written(&tree)[..]).unwrap().statistics(), tree.statistics());
}

#[test]
fn the_bytes_say_nothing_of_threads() {
    let mesh = Arc::new(soup(5000, 1.0, 0.0, 9));
    let files: Vec<_> = [1, 2, 3]
        .map(|threads| {
            let mut options = BuildOptions::from(Preset::PaperSmall);
            options.threads = std::num::NonZeroUsize::new(threads);
            written(&KdTree::build(Arc::clone(&mesh), &options).unwrap())
        })
        .into();
    assert!(files[0] == files[1] && files[1] == files[2]);
}

#[test]
fn sections_are_aligned_and_in_order() {
    for (preset, expected) in
        [(Preset::Standard, [1, 2, 3, 4, 16, 17]), (Preset::PaperSmall, [1, 2, 3, 4, 16, 18])]
    {
        let bytes = written(&KdTree::build(soup(300, 1.0, 0.0, 3), &preset.into()).unwrap());
        let sections = crate::skd::sections(&bytes);
        let kinds: Vec<_> = sections.iter().map(|section| section.kind).collect();
        assert_eq!(kinds, expected);
        assert!(sections.iter().all(|section| section.range.start % 64 == 0));
        assert_eq!(sections.last().unwrap().range.end, bytes.len());
    }
}

#[test]
fn a_mesh_that_is_missing_or_another_is_named() {
    let mesh = soup(50, 1.0, 0.0, 3);
    let tree = KdTree::build(mesh.clone(), &BuildOptions::default()).unwrap();
    let mut alone = Vec::new();
    tree.write_without_mesh(&mut alone).unwrap();
    let missing = KdTree::read(&mut &alone[..]);
    assert!(matches!(missing, Err(FileError::MeshMissing { vertices: 150, triangles: 50 })));
    let mut vertices = mesh.vertices().to_vec();
    vertices[7][1] = f32::from_bits(vertices[7][1].to_bits() ^ 1);
    let other = TriangleMesh::new(vertices, mesh.triangles().to_vec()).unwrap();
    for file in [&alone, &written(&tree)] {
        let read = KdTree::read_with_mesh(&mut &file[..], other.clone());
        assert!(matches!(read, Err(FileError::MeshMismatch { triangles: 50, .. })));
    }
}

#[test]
fn every_damaged_byte_and_every_cut_is_found() {
    let mesh = soup(60, 1.0, 0.0, 4);
    for (_, options) in variants() {
        let bytes = written(&KdTree::build(mesh.clone(), &options).unwrap());
        for length in 0..bytes.len() {
            assert!(KdTree::read(&mut &bytes[..length]).is_err(), "cut to {length} of {}", bytes.len());
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(KdTree::read(&mut &longer[..]).is_err());
        for at in 0..bytes.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                assert!(KdTree::read(&mut &damaged[..]).is_err(), "byte {at} ^ {flip:x}");
            }
        }
    }
}

/// Checksums find accidents; against intent there is the proof of everything that they cover.
#[test]
fn damage_with_the_right_checksums_is_an_error_or_harmless_but_never_a_panic() {
    let mesh = soup(60, 1.0, 0.0, 4);
    let rays = hard_rays(&mesh, 40, 2);
    let mut rng = Rng::new(5);
    let (mut refused, mut read) = (0, 0);
    for (_, options) in variants() {
        let bytes = written(&KdTree::build(mesh.clone(), &options).unwrap());
        for section in crate::skd::sections(&bytes) {
            for round in 0..400 {
                let mut damaged = bytes.clone();
                for _ in 0..1 + round % 3 {
                    let at = section.range.start + rng.below(section.range.len());
                    damaged[at] =
                        [damaged[at] ^ (1 << rng.below(8)), 0, 0xff, rng.bits() as u8][rng.below(4)];
                }
                crate::skd::sign(&mut damaged);
                match KdTree::read(&mut &damaged[..]) {
                    Err(_) => refused += 1,
                    Ok(tree) => {
                        read += 1;
                        rays.iter().for_each(|ray| drop(tree.all(ray)));
                        tree.statistics();
                    }
                }
            }
        }
    }
    assert!(refused > 10_000 && read > 1000, "{refused} refused, {read} read");
}

#[test]
fn lengths_that_lie_take_no_memory() {
    let bytes = written(&KdTree::build(soup(10, 1.0, 0.0, 4), &BuildOptions::default()).unwrap());
    let sections = crate::skd::sections(&bytes).len();
    for section in 0..sections {
        for lie in [u64::MAX, 1 << 60, 1 << 40, 3 << 30] {
            let mut damaged = bytes.clone();
            damaged[64 + 32 * section + 16..][..8].copy_from_slice(&lie.to_le_bytes());
            crate::skd::place(&mut damaged);
            assert!(
                matches!(KdTree::read(&mut &damaged[..]), Err(FileError::Damaged(_))),
                "{section} {lie:x}"
            );
        }
    }
}

#[test]
fn what_is_no_tree_or_a_later_one_is_told_apart() {
    assert!(matches!(KdTree::read(&mut &b"PK\x03\x04 something else"[..]), Err(FileError::NotATree)));
    let bytes = written(&KdTree::build(soup(10, 1.0, 0.0, 4), &BuildOptions::default()).unwrap());
    let mut later = bytes.clone();
    later[8] = 99;
    assert!(matches!(KdTree::read(&mut &later[..]), Err(FileError::Version { found: 99, .. })));
    let mut unknown = bytes;
    let last = 64 + 32 * (crate::skd::sections(&unknown).len() - 1);
    unknown[last] = 200;
    crate::skd::place(&mut unknown);
    assert!(matches!(KdTree::read(&mut &unknown[..]), Err(FileError::UnknownSection(200))));
}

#[test]
fn a_tree_that_leaves_a_triangle_out_or_names_a_degenerate_one_is_found() {
    let mesh = soup(60, 1.0, 0.0, 4);
    let whole = written(&KdTree::build(mesh.clone(), &Preset::Standard.into()).unwrap());
    let mut fewer = crate::skd::parts(&whole);
    let indices = fewer.iter_mut().find(|part| part.0 == 17).unwrap();
    for id in indices.1.chunks_exact_mut(4).filter(|id| **id == [8, 0, 0, 0]) {
        id[0] = 7;
    }
    let read = KdTree::read(&mut &crate::skd::join(&fewer)[..]);
    assert!(matches!(&read, Err(FileError::Damaged(what)) if what.contains("in no leaf")), "{read:?}");

    let mut triangles = mesh.triangles().to_vec();
    triangles.push([0, 1, 1]);
    let mesh = TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap();
    let mut more = crate::skd::parts(&written(&KdTree::build(mesh, &Preset::Standard.into()).unwrap()));
    let indices = more.iter_mut().find(|part| part.0 == 17).unwrap();
    indices.1[0] = 60;
    let read = KdTree::read(&mut &crate::skd::join(&more)[..]);
    assert!(matches!(&read, Err(FileError::Damaged(what)) if what.contains("never be hit")), "{read:?}");
}

#[test]
fn saving_replaces_and_leaves_nothing_beside() {
    let folder = std::env::temp_dir().join(format!("slimkd-save-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("tree.skd");
    let mesh = Arc::new(soup(50, 1.0, 0.0, 3));
    let tree = KdTree::build(Arc::clone(&mesh), &BuildOptions::default()).unwrap();
    std::fs::write(&path, b"old").unwrap();
    tree.save(&path).unwrap();
    assert_eq!(KdTree::load(&path).unwrap().statistics(), tree.statistics());
    tree.save_without_mesh(&path).unwrap();
    assert!(KdTree::load(&path).is_err());
    assert!(KdTree::load_with_mesh(&path, mesh).is_ok());
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    assert!(
        matches!(tree.save(folder.join("no/such/tree.skd")), Err(FileError::At { path, .. }) if path.ends_with("tree.skd"))
    );
    assert!(matches!(tree.save(&folder), Err(FileError::At { .. })));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    std::fs::remove_dir_all(&folder).unwrap();
}
