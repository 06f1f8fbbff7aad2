//! A closed mesh whose inside is known: the surface of some cells of a grid.
#![allow(unreachable_pub)]

use crate::common::Rng;
use slimkd::TriangleMesh;

/// Cells of a grid, and which of them are full.
pub struct Cells {
    pub size: usize,
    full: Vec<bool>,
}

impl Cells {
    /// Random ones: edges of two and of four faces, cells that meet in an edge or a vertex only, cavities.
    pub fn new(size: usize, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        Self { size, full: (0..size.pow(3)).map(|_| rng.below(2) == 0).collect() }
    }

    pub fn is_full(&self, cell: [i64; 3]) -> bool {
        let inside = cell.iter().all(|&x| (0..self.size as i64).contains(&x));
        inside && self.full[cell.iter().fold(0, |at, &x| at * self.size + x as usize)]
    }

    /// The faces between full and empty cells, normals outwards. Vertices are moved off the grid by `wobble` at most.
    pub fn mesh(&self, wobble: f32) -> TriangleMesh {
        let mut rng = Rng::new(5);
        let (line, side) = (self.size + 1, self.size as i64);
        let vertices = (0..line.pow(3)).map(|i| {
            let cell = [i / (line * line), i / line % line, i % line];
            cell.map(|x| x as f32 + wobble * (2.0 * rng.unit() - 1.0))
        });
        let vertices: Vec<[f32; 3]> = vertices.collect();
        let at = |p: [i64; 3]| p.iter().fold(0, |at, &x| at * line as u32 + x as u32);
        let mut triangles = Vec::new();
        for i in 0..side.pow(3) {
            let cell = [i / (side * side), i / side % side, i % side];
            for (axis, up) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
                let mut next = cell;
                next[axis] += 2 * up - 1;
                if !self.is_full(cell) || self.is_full(next) {
                    continue;
                }
                let corner = |x: i64, y: i64| {
                    let mut corner = cell;
                    corner[axis] += up;
                    corner[(axis + 1) % 3] += x;
                    corner[(axis + 2) % 3] += y;
                    at(corner)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let (b, d) = if up == 1 { (b, d) } else { (d, b) };
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        TriangleMesh::new(vertices, triangles).unwrap()
    }
}
