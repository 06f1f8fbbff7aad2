//! Vectors, bytes and memory of others.

use crate::common::{hard_rays, soup};
use slimkd::{BuildOptions, Hit, KdTree, Ray, Tracer, TriangleMesh};
use std::sync::Arc;

#[test]
fn points_of_other_crates_go_in_and_come_out() {
    let corners = [glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y];
    let mesh = TriangleMesh::collect(corners, [[0u32, 1, 2]]).unwrap();
    let tree = KdTree::build(mesh, &BuildOptions::default()).unwrap();
    let ray = Ray::new(glam::vec3(0.25, 0.25, 1.0), -glam::Vec3::Z);
    let hit = tree.closest(&ray).unwrap();
    let refined = tree.refine(&ray, hit.triangle).unwrap();
    assert_eq!(glam::DVec3::from(refined.point), glam::dvec3(0.25, 0.25, 0.0));
    let same = Ray::new(mint::Point3 { x: 0.25, y: 0.25, z: 1.0 }, mint::Vector3 { x: 0.0, y: 0.0, z: -1.0 });
    assert_eq!(tree.closest(&same), Some(hit));
    let nearest = tree.nearest(glam::vec3(0.25, 0.25, 1.0).into(), 2.0).unwrap();
    assert_eq!(mint::Point3::from(nearest.point), mint::Point3 { x: 0.25, y: 0.25, z: 0.0 });
}

/// The bytes of a slice of rays are those of a file of rays: ox oy oz t_min dx dy dz t_max.
#[test]
fn rays_and_hits_are_plain_data() {
    let ray = Ray::new([1.0, 2.0, 3.0], [5.0, 6.0, 7.0]).with_range(4.0, 8.0);
    assert_eq!(bytemuck::cast_slice::<Ray, f32>(&[ray]), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    let numbers = [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
    assert_eq!(bytemuck::cast_slice::<f32, Ray>(&numbers), [ray]);
    let hit = Hit { t: 1.0, u: 0.25, v: 0.5, triangle: 7 };
    assert_eq!(bytemuck::bytes_of(&hit).len(), 16);
}

/// Memory that somebody else owns is traced where it lies, for as long as anything needs it.
#[test]
fn shared_memory_is_not_copied() {
    let mesh = soup(300, 1.0, 0.0, 5);
    let (vertices, triangles) = (Arc::new(mesh.vertices().to_vec()), Arc::new(mesh.triangles().to_vec()));
    let address = vertices.as_ptr();
    let shared = TriangleMesh::from_shared(vertices.clone(), triangles).unwrap();
    assert_eq!(shared, mesh);
    assert_eq!((shared.vertices().as_ptr(), shared.clone().vertices().as_ptr()), (address, address));
    let tree = KdTree::build(shared, &BuildOptions::default()).unwrap();
    assert_eq!(tree.mesh().vertices().as_ptr(), address);
    let owners = Arc::strong_count(&vertices);
    assert!(owners > 1);
    let own = KdTree::build(mesh.clone(), &BuildOptions::default()).unwrap();
    assert!(hard_rays(&mesh, 300, 1).iter().all(|ray| tree.closest(ray) == own.closest(ray)));
    drop(tree);
    assert_eq!(Arc::strong_count(&vertices), 1);
    let wrong: Arc<Vec<[u32; 3]>> = Arc::new(vec![[0, 1, 900_000]]);
    assert!(TriangleMesh::from_shared(vertices, wrong).is_err());
}

#[test]
fn debug_is_short() {
    let tree = KdTree::build(soup(1000, 1.0, 0.0, 1), &BuildOptions::default()).unwrap();
    assert!(format!("{tree:?}").len() < 300, "{tree:?}");
}

#[cfg(feature = "serde")]
#[test]
fn options_and_figures_survive_serde() {
    let tree = KdTree::build(soup(100, 1.0, 0.0, 1), &BuildOptions::default()).unwrap();
    let options: BuildOptions =
        serde_json::from_str(&serde_json::to_string(tree.options()).unwrap()).unwrap();
    assert_eq!(&options, tree.options());
    let memory: slimkd::MemoryReport =
        serde_json::from_str(&serde_json::to_string(&tree.memory()).unwrap()).unwrap();
    assert_eq!(memory, tree.memory());
    let statistics: slimkd::TreeStatistics =
        serde_json::from_str(&serde_json::to_string(&tree.statistics()).unwrap()).unwrap();
    assert_eq!(statistics, tree.statistics());
}
