//! The real scenes' triangle counts, where they are at hand.

use slimkd_scene::load;
use std::path::Path;

#[test]
fn real_scenes_have_their_triangles() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes"));
    if !folder.is_dir() {
        println!("skipped: no scenes folder");
        return;
    }
    for (name, triangles) in [
        ("bart_kitchen_101015", 101_015),
        ("sponza_dabrovic", 56_100),
        ("clinic_architectural", 169_602),
        ("hospital_structure", 444_854),
        ("bodo_mep", 670_488),
        ("clinic", 1_354_234),
        ("west_riverside_hospital", 7_380_395),
        ("sionna_san_francisco", 268_041),
        ("stk_candela_city", 445_022),
        ("scan_stanford_bunny", 69_451),
    ] {
        let scene = load(folder.join(name).with_extension("ply.zst")).unwrap();
        assert_eq!((scene.name.as_str(), scene.mesh.len()), (name, triangles));
    }
}
