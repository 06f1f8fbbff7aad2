//! The twin against the CPU's tree: the arithmetic of the GPU's kernels, without a GPU.

mod common;

use common::{build, complaint, rays, scene};
use slimkd::{KdTree, Preset, Tracer};
use slimkd_gpu::Image;
use slimkd_gpu::twin::Twin;

#[test]
fn the_twin_agrees_with_the_cpu_for_every_preset_and_stack() {
    let mesh = scene("kitchen", 4_000);
    for &preset in Preset::ALL {
        let tree = build(&mesh, preset);
        let image = Image::new(&tree).unwrap();
        let rays = rays(&mesh, &tree, 4_000);
        for stack in [1, 2, 12] {
            let twin = Twin::new(&image, stack);
            let mut other_bits = 0;
            for ray in &rays {
                let (wanted, found) = (tree.closest(ray), twin.closest(ray));
                if let Some(complaint) = complaint(&tree, ray, wanted, found) {
                    panic!("{}, stack of {stack}, {ray:?}: {complaint}", preset.name());
                }
                let any = if twin.any(ray) { found.or(wanted) } else { None };
                assert_eq!(complaint(&tree, ray, wanted, any), None, "any hit of {ray:?}");
                other_bits += usize::from(wanted != found);
            }
            assert!(other_bits * 100 < rays.len(), "{other_bits} hits differ in a bit");
        }
    }
}

#[test]
fn an_empty_mesh_misses() {
    let tree = KdTree::build(slimkd::TriangleMesh::default(), &Preset::Slim.into()).unwrap();
    let image = Image::new(&tree).unwrap();
    assert_eq!(Twin::new(&image, 4).closest(&slimkd::Ray::new([0.0; 3], [1.0, 0.0, 0.0])), None);
}
