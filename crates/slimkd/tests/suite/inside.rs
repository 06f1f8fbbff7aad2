//! Inside and outside: points whose place is known exactly, grids against points, signs of distances, winding numbers of closed and open meshes.

use crate::cells::Cells;
use crate::common::{Rng, soup, sphere, variants};
use crate::exact::lies_on;
use slimkd::{BruteForce, Grid, KdTree, OpenTree, Preset, Surface, Tracer, TriangleMesh, WindingNumbers};
use std::sync::Arc;

/// Points of a cell's inside, its faces, edges and vertices.
fn points_of_cells(cells: &Cells, count: usize) -> Vec<[f32; 3]> {
    let mut rng = Rng::new(9);
    (0..count)
        .map(|_| {
            std::array::from_fn(|_| {
                let cell = rng.below(cells.size + 2) as f32 - 1.0;
                cell + [0.0, 0.5, rng.unit()][rng.below(3)]
            })
        })
        .collect()
}

/// Whether a point is in a full cell, or on the faces between full and empty ones.
fn is_in_cells(cells: &Cells, point: [f32; 3]) -> bool {
    // Those cells whose closed box holds the point: two on each axis where it lies between them.
    let cell = point.map(|x| x.floor() as i64);
    (0..8).any(|i| {
        let other: [i64; 3] = std::array::from_fn(|k| cell[k] - (i >> k & 1));
        let touched = (0..3).all(|k| other[k] == cell[k] || point[k] == point[k].floor());
        touched && cells.is_full(other)
    })
}

#[test]
fn points_in_cells_and_on_their_walls() {
    let cells = Cells::new(5, 3);
    let mesh = Arc::new(cells.mesh(0.0));
    let points = points_of_cells(&cells, 3000);
    let walls =
        points.iter().filter(|p| (0..mesh.len() as u32).any(|id| lies_on(**p, &mesh.corners(id)))).count();
    assert!(walls > 300, "{walls}");
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let mut inside = vec![false; points.len()];
        tree.batch().threads(2).contains(&points, &mut inside);
        for (point, inside) in points.iter().zip(inside) {
            assert_eq!(inside, is_in_cells(&cells, *point), "{variant} {point:?}");
        }
    }
    let (tree, oracle) =
        (KdTree::build(Arc::clone(&mesh), &Preset::Tiny.into()).unwrap(), BruteForce::new(&mesh));
    let mut bytes = Vec::new();
    tree.write(&mut bytes).unwrap();
    let open = OpenTree::open(bytes).unwrap();
    for point in points.iter().step_by(10) {
        assert_eq!(oracle.contains(*point), is_in_cells(&cells, *point), "{point:?}");
        assert_eq!(open.contains(*point), is_in_cells(&cells, *point), "{point:?}");
    }
    for odd in [[f32::NAN, 0.5, 0.5], [f32::INFINITY; 3], [f32::MAX, 0.5, 0.5], [0.5, 0.5, -1e-30]] {
        assert!(!tree.contains(odd) && !oracle.contains(odd), "{odd:?}");
    }
}

#[test]
fn a_grid_says_what_its_points_say() {
    let cells = Cells::new(4, 7);
    let far = TriangleMesh::new(
        sphere(3).vertices().iter().map(|v| [v[0] + 4000.0, v[1] * 3.0, v[2] - 70.0]).collect(),
        sphere(3).triangles().to_vec(),
    );
    for (name, mesh) in [
        ("cells", cells.mesh(0.0)),
        ("moved cells", cells.mesh(0.2)),
        ("sphere", sphere(2)),
        ("far", far.unwrap()),
        ("soup", soup(50, 1.0, 0.0, 1)),
    ] {
        let tree = KdTree::build(mesh, &Preset::Slim.into()).unwrap();
        let bounds = tree.bounds();
        let whole = Grid {
            first: bounds.min.map(|x| f64::from(x) - 0.5),
            step: [0.25, 0.5, 0.125],
            size: [25, 12, 40],
        };
        let flat = Grid { first: [0.5; 3], step: [0.0, 0.25, 0.0], size: [2, 9, 1] };
        for grid in [whole, flat, Grid::over(&bounds, 0.3), Grid { size: [7, 0, 3], ..whole }] {
            let mut inside = vec![true; grid.len()];
            tree.batch().threads(2).occupancy(&grid, &mut inside);
            for (i, inside) in inside.into_iter().enumerate() {
                let point = grid.point(i);
                let rounded = point.map(|x| x as f32);
                if rounded.map(f64::from) == point && name != "soup" {
                    assert_eq!(inside, tree.contains(rounded), "{name} {point:?}");
                }
            }
        }
    }
}

#[test]
fn a_distance_has_the_sign_of_its_side() {
    let mesh = sphere(4);
    assert_eq!(mesh.surface(), Surface::Oriented);
    let numbers = WindingNumbers::new(mesh.clone()).with_accuracy(f64::INFINITY);
    let tree = KdTree::build(mesh, &Preset::Slim.into()).unwrap();
    let grid = Grid { first: [-1.2; 3], step: [2.4 / 63.0; 3], size: [64; 3] };
    let points: Vec<[f32; 3]> = (0..grid.len()).map(|i| grid.point(i).map(|x| x as f32)).collect();
    let mut distances = vec![0.0; points.len()];
    tree.batch().threads(2).signed_distance(&points, &mut distances);
    let mut near = 0;
    for (point, distance) in points.iter().zip(distances) {
        let size = point.iter().map(|&x| f64::from(x).powi(2)).sum::<f64>().sqrt();
        // The flat faces are at least 0.995 from the centre; between the spheres the winding number says which side it is.
        let inside = match size {
            inside if inside < 0.995 => true,
            outside if outside > 1.000001 => false,
            _ => {
                near += 1;
                numbers.contains(*point)
            }
        };
        assert_eq!(distance < 0.0, inside, "{point:?} {distance}");
        assert!((f64::from(distance) - (size - 1.0)).abs() < 0.005, "{point:?} {distance}");
    }
    assert!(near > 500, "{near}");
    assert_eq!(tree.signed_distance([0.0, 0.0, 1.0]), Some(0.0));
    assert_eq!(tree.signed_distance([f32::NAN; 3]), None);
    let empty = KdTree::build(TriangleMesh::default(), &Preset::Slim.into()).unwrap();
    assert_eq!((empty.signed_distance([0.0; 3]), empty.contains([0.0; 3])), (None, false));
}

#[test]
fn winding_numbers_are_whole_in_closed_meshes_and_reasonable_in_open_ones() {
    let cells = Cells::new(5, 4);
    let mesh = cells.mesh(0.0);
    let (fast, slow) =
        (WindingNumbers::new(mesh.clone()), WindingNumbers::new(mesh).with_accuracy(f64::INFINITY));
    let mut rng = Rng::new(2);
    let points: Vec<[f32; 3]> =
        (0..2000).map(|_| std::array::from_fn(|_| rng.below(7) as f32 - 0.9 + 0.8 * rng.unit())).collect();
    let mut numbers = vec![0.0; points.len()];
    fast.batch(&points, &mut numbers);
    for (point, number) in points.iter().zip(numbers) {
        let expected = f64::from(u8::from(is_in_cells(&cells, *point)));
        assert!((slow.at(*point) - expected).abs() < 1e-12, "{point:?} {}", slow.at(*point));
        assert!((number - expected).abs() < 0.02, "{point:?} {number}");
    }
    // A sphere without a cap.
    let whole = sphere(4);
    let kept = whole.triangles().iter().filter(|t| t.iter().all(|&v| whole.vertices()[v as usize][2] < 0.7));
    let open = TriangleMesh::new(whole.vertices().to_vec(), kept.copied().collect()).unwrap();
    assert_eq!(open.surface(), Surface::Open);
    let numbers = WindingNumbers::new(open);
    for _ in 0..2000 {
        let point = rng.point().map(|x| 3.0 * x - 1.5);
        let size = point.iter().map(|x| x * x).sum::<f32>().sqrt();
        if point[2] < 0.4 && (size - 1.0).abs() > 0.02 {
            assert_eq!(numbers.contains(point), size < 1.0, "{point:?} {}", numbers.at(point));
        }
    }
    assert_eq!(WindingNumbers::new(TriangleMesh::default()).at([0.0; 3]), 0.0);
}

#[test]
fn a_surface_is_closed_by_its_positions() {
    // Every triangle with vertices of its own, as STL files have them.
    let mesh = sphere(2);
    let vertices = mesh.triangles().iter().flatten().map(|&v| mesh.vertices()[v as usize]).collect();
    let apart = |count: u32| (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>();
    let soup_of = TriangleMesh::new(vertices, apart(mesh.len() as u32)).unwrap();
    assert_eq!(soup_of.surface(), Surface::Oriented);
    assert_eq!(Cells::new(5, 4).mesh(0.0).surface(), Surface::Oriented);
    assert_eq!(soup(5, 1.0, 0.0, 1).surface(), Surface::Open);
    // A flat triangle closes the gap at a T-junction; a triangle that is nowhere bounds nothing.
    let mut vertices =
        vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0], [2.0, 0.0, 0.0], [f32::NAN; 3]];
    let mut triangles =
        vec![[0, 2, 4], [4, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 4, 1], [0, 1, 5], [1, 1, 2]];
    let closed = |vertices: &[[f32; 3]], triangles: &[[u32; 3]]| {
        TriangleMesh::new(vertices.to_vec(), triangles.to_vec()).unwrap().surface()
    };
    assert_eq!(closed(&vertices, &triangles), Surface::Oriented);
    vertices[0] = [-0.0; 3];
    triangles[5] = [0, 1, 4];
    assert_eq!(closed(&vertices, &triangles), Surface::Closed);
    triangles.remove(5);
    assert_eq!(closed(&vertices, &triangles), Surface::Open);
}

#[test]
fn several_nearest_triangles_are_those_of_a_sorted_list() {
    let mesh = Arc::new(soup(150, 1.0, 3.0, 5));
    // Each triangle's own nearest point, by a tree of that triangle alone.
    let alone: Vec<TriangleMesh> = (0..mesh.len() as u32)
        .map(|id| TriangleMesh::new(mesh.corners(id).to_vec(), vec![[0, 1, 2]]).unwrap())
        .collect();
    let mut rng = Rng::new(6);
    let points: Vec<[f32; 3]> = (0..60).map(|_| rng.point().map(|x| 2.5 + 2.0 * x)).collect();
    let sorted: Vec<Vec<(f32, u32)>> = points
        .iter()
        .map(|point| {
            let mut list: Vec<(f32, u32)> = (0..mesh.len() as u32)
                .map(|id| {
                    let own = BruteForce::new(&alone[id as usize]).nearest(*point, f32::INFINITY).unwrap();
                    (own.distance, id)
                })
                .collect();
            list.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            list
        })
        .collect();
    for (variant, options) in variants() {
        let tree = KdTree::build(Arc::clone(&mesh), &options).unwrap();
        let mut found = Vec::new();
        for (i, (point, sorted)) in points.iter().zip(&sorted).enumerate() {
            let most = [0, 1, 2, 7, 1000, usize::MAX][i % 6];
            let radius = [f32::INFINITY, 0.5 * (sorted[9].0 + sorted[10].0), 0.0][i / 6 % 3];
            let except = sorted[3].1;
            tree.query().except(except).nearest_several(*point, radius, most, &mut found);
            let expected =
                sorted.iter().filter(|(distance, id)| *distance <= radius && *id != except).take(most);
            // Distances that f32 cannot tell apart may be in another order, as f64 decides.
            let expected: Vec<f32> = expected.map(|(distance, _)| *distance).collect();
            let distances: Vec<f32> = found.iter().map(|found| found.distance).collect();
            assert_eq!(distances, expected, "{variant} {point:?} {most} {radius}");
            let own = |triangle: u32| sorted.iter().find(|(_, id)| *id == triangle).unwrap().0;
            assert!(found.iter().all(|found| own(found.triangle) == found.distance), "{variant} {point:?}");
            let nearest = tree.query().except(except).nearest(*point, radius);
            if most > 0 {
                assert_eq!(found.first().copied(), nearest, "{variant} {point:?}");
            }
        }
    }
}
