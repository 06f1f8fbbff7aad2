//! Kernels on whatever GPU there is, Mesa's software one at least: against the twin to the bit, against the CPU within the bound.

mod common;

use common::{build, complaint, device, rays, scene};
use slimkd::{KdTree, Preset, Ray, Tracer};
use slimkd_gpu::twin::Twin;
use slimkd_gpu::{Device, GpuError, GpuTree, Image, UploadOptions};

fn options(binding_limit: Option<u64>, stack: u32) -> UploadOptions {
    let mut options = UploadOptions::default();
    (options.binding_limit, options.stack) = (binding_limit, stack);
    options
}

/// Traces on the GPU, the twin and the CPU and compares all three.
fn compare(device: &Device, tree: &KdTree, rays: &[Ray], options: &UploadOptions) -> u32 {
    let gpu = GpuTree::upload(device, tree, options).unwrap();
    let mut closest = vec![None; rays.len()];
    let mut any = vec![false; rays.len()];
    gpu.closest(rays, &mut closest).unwrap();
    gpu.any(rays, &mut any).unwrap();
    let image = Image::new(tree).unwrap();
    let twin = Twin::new(&image, options.stack);
    let mut unlike_twin = 0;
    for ((ray, found), any) in rays.iter().zip(closest).zip(any) {
        let wanted = tree.closest(ray);
        if let Some(complaint) = complaint(tree, ray, wanted, found) {
            panic!("{ray:?}: {complaint}; the twin says {:?}", twin.closest(ray));
        }
        let any = if any { found.or(wanted) } else { None };
        assert_eq!(complaint(tree, ray, wanted, any), None, "any hit of {ray:?}");
        unlike_twin += usize::from(found != twin.closest(ray));
    }
    // A GPU may divide inexactly in the last step of t, u and v.
    assert!(unlike_twin * 1000 <= rays.len(), "{unlike_twin} of {} unlike the twin", rays.len());
    gpu.shards()
}

#[test]
fn every_preset() {
    let Some(device) = device() else { return };
    let mesh = scene("kitchen", 4_000);
    for &preset in Preset::ALL {
        let tree = build(&mesh, preset);
        assert_eq!(compare(&device, &tree, &rays(&mesh, &tree, 3_000), &options(None, 12)), 1);
    }
}

#[test]
fn a_stack_of_one_and_many_shards() {
    let Some(device) = device() else { return };
    let mesh = scene("conference", 4_000);
    for preset in [Preset::PaperSmall, Preset::Slim] {
        let tree = build(&mesh, preset);
        let limit = Image::new(&tree).unwrap().bytes() / 3;
        let shards = compare(&device, &tree, &rays(&mesh, &tree, 2_000), &options(Some(limit), 1));
        assert!(shards > 3, "{shards} shards");
    }
}

#[test]
fn an_empty_mesh_misses() {
    let Some(device) = device() else { return };
    let tree = KdTree::build(slimkd::TriangleMesh::default(), &Preset::Slim.into()).unwrap();
    compare(&device, &tree, &[Ray::new([0.0; 3], [1.0, 0.0, 0.0])], &options(None, 4));
}

#[test]
fn too_large_and_lost_are_errors() {
    let Some(device) = device() else { return };
    let mesh = scene("kitchen", 20_000);
    let tree = build(&mesh, Preset::Standard);
    let small = GpuTree::upload(&device, &tree, &options(Some(1024), 4)).unwrap_err();
    assert!(matches!(small, GpuError::TooLarge { .. }), "{small}");
    let gpu = GpuTree::upload(&device, &tree, &UploadOptions::default()).unwrap();
    device.destroy();
    let mut hits = [None];
    let error = gpu.closest(&[Ray::new([0.0; 3], [1.0, 0.0, 0.0])], &mut hits).unwrap_err();
    assert!(matches!(error, GpuError::Lost(_)), "{error}");
    let again = GpuTree::upload(&device, &tree, &UploadOptions::default()).unwrap_err();
    assert!(matches!(again, GpuError::Lost(_)), "{again}");
    let named = Device::open(Some("no such adapter")).unwrap_err();
    assert!(matches!(named, GpuError::NoSuchAdapter { .. }), "{named}");
}
