//! `.skd` files: round trips, and damage that must be an error.

mod common;

use common::{hard_rays, soup, variants};
use slimkd::{FileError, KdTree};

#[test]
fn what_was_written_is_read() {
    let mesh = soup(2000, 1.0, 0.0, 3);
    let rays = hard_rays(&mesh, 500, 1);
    for (variant, options) in variants() {
        let tree = KdTree::build(mesh.clone(), &options).unwrap();
        let mut bytes = Vec::new();
        tree.write(&mut bytes).unwrap();
        let read = KdTree::read(&mut &bytes[..]).unwrap();
        assert_eq!(read.options(), tree.options(), "{variant}");
        assert_eq!(read.statistics(), tree.statistics(), "{variant}");
        for ray in &rays {
            assert_eq!(read.closest_hit(ray), tree.closest_hit(ray), "{variant} {ray:?}");
        }
        let mut again = Vec::new();
        read.write(&mut again).unwrap();
        assert!(again == bytes, "{variant}");
    }
}

#[test]
fn damage_is_an_error_or_harmless_but_never_a_panic() {
    let mesh = soup(60, 1.0, 0.0, 4);
    let rays = hard_rays(&mesh, 40, 2);
    for (_, options) in variants() {
        let mut bytes = Vec::new();
        KdTree::build(mesh.clone(), &options).unwrap().write(&mut bytes).unwrap();
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
                if let Ok(tree) = KdTree::read(&mut &damaged[..]) {
                    for ray in &rays {
                        tree.closest_hit(ray);
                    }
                    tree.statistics();
                }
            }
        }
    }
}

#[test]
fn counts_that_lie_take_no_memory() {
    let mut bytes = Vec::new();
    KdTree::build(soup(10, 1.0, 0.0, 4), &Default::default()).unwrap().write(&mut bytes).unwrap();
    let options = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    for count in 0..6 {
        for lie in [u64::MAX, 1 << 60, 1 << 33, 1 << 32] {
            let mut damaged = bytes.clone();
            damaged[16 + options + 8 * count..][..8].copy_from_slice(&lie.to_le_bytes());
            assert!(matches!(KdTree::read(&mut &damaged[..]), Err(FileError::Damaged(_))));
        }
    }
    assert!(matches!(KdTree::read(&mut &b"PK\x03\x04 something else"[..]), Err(FileError::NotATree)));
    bytes[8] = 99;
    assert!(matches!(KdTree::read(&mut &bytes[..]), Err(FileError::Version { found: 99, .. })));
}
