//! What is wrong with a mesh: edges, doubles, parts, and how fine its coordinates are.

use rayon::prelude::*;
use slimkd::TriangleMesh;

/// Largest number of different positions that edges can be told by.
const MOST_POSITIONS: usize = 1 << 31;
/// Edges of fewer steps of `f32` than this are spoilt by rounding.
const FEWEST_STEPS: f64 = 1024.0;

/// What is wrong with a mesh. Vertices of equal position count as one, and triangles without area have no edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct MeshCheck {
    /// Edges that a single triangle has: the mesh has a border or a hole there.
    pub open_edges: u64,
    /// Edges of three triangles or more.
    pub non_manifold_edges: u64,
    /// Edges whose two triangles turn opposite ways: one of them shows its back.
    pub flipped_edges: u64,
    /// Triangles that have the same three positions as one before them.
    pub duplicate_triangles: u64,
    /// Triangles without area, which are never hit: see [`TriangleMesh::is_degenerate`].
    pub degenerate_triangles: u64,
    /// Groups of triangles that share no position with another group.
    pub parts: u64,
    /// Least x, y, z of any triangle's corner that is finite.
    pub minimum: [f32; 3],
    /// Greatest x, y, z.
    pub maximum: [f32; 3],
    /// The distance between neighbouring numbers of `f32` at the coordinate farthest from 0.
    pub step: f32,
    /// Mean length of the triangles' edges.
    pub mean_edge: f64,
}

impl MeshCheck {
    /// Looks at `mesh`, by all threads; takes about 70 bytes a triangle while it runs.
    pub fn of(mesh: &TriangleMesh) -> Self {
        let mut check = Self::default();
        check.measure(mesh);
        let positions = positions(mesh.vertices());
        let triangles: Vec<[u32; 3]> = mesh
            .triangles()
            .par_iter()
            .map(|corners| corners.map(|corner| positions[corner as usize]))
            .collect();
        drop(positions);
        let has_area: Vec<bool> =
            (0..mesh.len() as u32).into_par_iter().map(|id| !mesh.is_degenerate(id)).collect();
        check.degenerate_triangles = has_area.par_iter().filter(|&&has| !has).count() as u64;
        check.parts = parts(&triangles, &has_area, mesh.vertices().len());
        check.duplicate_triangles = duplicates(&triangles);
        if mesh.vertices().len() < MOST_POSITIONS {
            check.edges(&triangles, &has_area);
        }
        check
    }

    /// True when the coordinates are so far from 0 that `f32` spoils them: georeferenced ones mostly.
    pub fn is_coarse(&self) -> bool {
        self.mean_edge > 0.0 && self.mean_edge < FEWEST_STEPS * f64::from(self.step)
    }

    fn measure(&mut self, mesh: &TriangleMesh) {
        let none = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let both = |a: ([f32; 3], [f32; 3]), b: ([f32; 3], [f32; 3])| {
            let each = |k: usize| (a.0[k].min(b.0[k]), a.1[k].max(b.1[k]));
            let [x, y, z] = [each(0), each(1), each(2)];
            ([x.0, y.0, z.0], [x.1, y.1, z.1])
        };
        let of = |corners: &[u32; 3]| {
            let corners = corners.map(|corner| mesh.vertices()[corner as usize]);
            let finite = corners.into_iter().filter(|p| p.iter().all(|x| x.is_finite()));
            finite.fold(none, |bounds, p| both(bounds, (p, p)))
        };
        let (minimum, maximum) = mesh.triangles().par_iter().map(of).reduce(|| none, both);
        if minimum[0] <= maximum[0] {
            (self.minimum, self.maximum) = (minimum, maximum);
        }
        let farthest = self.minimum.iter().chain(&self.maximum).fold(0f32, |far, x| far.max(x.abs()));
        self.step = farthest.next_up() - farthest;
        // Summed in order within blocks of a fixed size, so that the sum is the same at any thread count.
        let sums: Vec<(f64, u64)> = mesh
            .triangles()
            .par_chunks(1 << 14)
            .map(|block| {
                let mut sum = (0.0, 0);
                for corners in block {
                    let p = corners.map(|corner| mesh.vertices()[corner as usize].map(f64::from));
                    for k in 0..3 {
                        let q = p[(k + 1) % 3];
                        let length = (0..3).map(|x| (p[k][x] - q[x]).powi(2)).sum::<f64>().sqrt();
                        if length.is_finite() {
                            sum = (sum.0 + length, sum.1 + 1);
                        }
                    }
                }
                sum
            })
            .collect();
        let (sum, count) = sums.into_iter().fold((0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        self.mean_edge = sum / count.max(1) as f64;
    }

    fn edges(&mut self, triangles: &[[u32; 3]], has_area: &[bool]) {
        // Lower end, higher end, direction: ends are below 2³¹.
        let edge =
            |a: u32, b: u32| (u64::from(a.min(b)) << 33) | (u64::from(a.max(b)) << 1) | u64::from(a > b);
        let mut edges: Vec<u64> = triangles
            .par_iter()
            .zip(has_area)
            .filter(|&(_, &has_area)| has_area)
            .flat_map_iter(|(&[a, b, c], _)| [edge(a, b), edge(b, c), edge(c, a)])
            .collect();
        edges.par_sort_unstable();
        for group in edges.chunk_by(|a, b| a >> 1 == b >> 1) {
            match group {
                [_] => self.open_edges += 1,
                [a, b] => self.flipped_edges += u64::from(a == b),
                _ => self.non_manifold_edges += 1,
            }
        }
    }
}

/// For each vertex the first one at its position.
fn positions(vertices: &[[f32; 3]]) -> Vec<u32> {
    // −0 is 0.
    let bits = |vertex: u32| vertices[vertex as usize].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.par_sort_unstable_by_key(|&vertex| (bits(vertex), vertex));
    let mut first = vec![0; vertices.len()];
    for group in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
        for &vertex in group {
            first[vertex as usize] = group[0];
        }
    }
    first
}

fn duplicates(triangles: &[[u32; 3]]) -> u64 {
    let mut sorted: Vec<[u32; 3]> = triangles
        .par_iter()
        .map(|&(mut corners)| {
            corners.sort_unstable();
            corners
        })
        .collect();
    sorted.par_sort_unstable();
    sorted.par_windows(2).filter(|pair| pair[0] == pair[1]).count() as u64
}

/// Groups of triangles with area that hang together by positions.
fn parts(triangles: &[[u32; 3]], has_area: &[bool], vertices: usize) -> u64 {
    fn root(parents: &mut [u32], mut vertex: u32) -> u32 {
        while parents[vertex as usize] != vertex {
            let above = parents[parents[vertex as usize] as usize];
            parents[vertex as usize] = above;
            vertex = above;
        }
        vertex
    }
    let mut parents: Vec<u32> = (0..vertices as u32).collect();
    let mut is_used = vec![false; vertices];
    for (corners, _) in triangles.iter().zip(has_area).filter(|&(_, &has_area)| has_area) {
        let [a, b, c] = corners.map(|corner| {
            is_used[corner as usize] = true;
            root(&mut parents, corner)
        });
        let least = a.min(b).min(c);
        for corner in [a, b, c] {
            parents[corner as usize] = least;
        }
    }
    (0..vertices).filter(|&vertex| is_used[vertex] && parents[vertex] == vertex as u32).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(vertices: &[[f32; 3]], triangles: &[[u32; 3]]) -> MeshCheck {
        MeshCheck::of(&TriangleMesh::new(vertices.to_vec(), triangles.to_vec()).unwrap())
    }

    const TETRAHEDRON: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn a_closed_mesh_has_nothing_wrong() {
        let found = check(&TETRAHEDRON, &FACES);
        let counts =
            [found.open_edges, found.non_manifold_edges, found.flipped_edges, found.duplicate_triangles];
        assert_eq!((counts, found.degenerate_triangles, found.parts), ([0; 4], 0, 1));
        assert_eq!((found.minimum, found.maximum), ([0.0; 3], [1.0; 3]));
        assert!(!found.is_coarse());
    }

    #[test]
    fn each_fault_is_counted() {
        assert_eq!(check(&TETRAHEDRON, &FACES[..3]).open_edges, 3);
        let mut flipped = FACES;
        flipped[3] = [1, 3, 2];
        assert_eq!(check(&TETRAHEDRON, &flipped).flipped_edges, 3);
        let mut faces = FACES.to_vec();
        faces.extend([[2, 3, 1], [0, 0, 1]]);
        let found = check(&TETRAHEDRON, &faces);
        assert_eq!(
            (found.duplicate_triangles, found.degenerate_triangles, found.non_manifold_edges),
            (1, 1, 3)
        );
        let twice: Vec<_> =
            TETRAHEDRON.iter().chain(&TETRAHEDRON.map(|[x, y, z]| [x + 5.0, y, z])).copied().collect();
        let both: Vec<_> = FACES.iter().copied().chain(FACES.map(|corners| corners.map(|c| c + 4))).collect();
        assert_eq!(check(&twice, &both).parts, 2);
        // Vertices that were split by their normals are one.
        let split: Vec<_> = FACES.iter().flatten().map(|&c| TETRAHEDRON[c as usize]).collect();
        let soup = [[0, 1, 2], [3, 4, 5], [6, 7, 8], [9, 10, 11]];
        let found = check(&split, &soup);
        assert_eq!((found.open_edges, found.parts), (0, 1));
    }

    #[test]
    fn far_coordinates_are_coarse() {
        let far = TETRAHEDRON.map(|[x, y, z]| [x + 5e5, y + 1e5, z]);
        let found = check(&far, &FACES);
        assert!(found.is_coarse() && found.step == 0.03125, "{found:?}");
        assert_eq!(check(&[], &[]).parts, 0);
    }
}
