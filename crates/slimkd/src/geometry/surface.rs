//! Whether a mesh is closed: what inside and outside rest on.

use super::TriangleMesh;

/// Whether a mesh bounds a part of space, as [`TriangleMesh::surface`] tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Surface {
    /// As many triangles run along each edge one way as the other. Inside and outside, and winding numbers, are exact.
    Oriented,
    /// Each edge belongs to an even number of triangles, but they do not agree on their side. Inside and outside are exact.
    Closed,
    /// Some edge belongs to an odd number of triangles: there is a border or a hole. Inside and outside are a matter of degree.
    Open,
}

impl TriangleMesh {
    /// Whether the mesh is closed. Vertices of equal position count as one; it is exact, so a gap of any width is a gap. Triangles with a
    /// corner that is not finite are left out. It takes about 40 bytes a triangle while it runs.
    ///
    /// ```
    /// use slimkd::{Surface, TriangleMesh};
    /// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    /// let mut faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    /// assert_eq!(TriangleMesh::new(corners.clone(), faces.clone())?.surface(), Surface::Oriented);
    /// faces[3].reverse();
    /// assert_eq!(TriangleMesh::new(corners.clone(), faces.clone())?.surface(), Surface::Closed);
    /// faces.pop();
    /// assert_eq!(TriangleMesh::new(corners, faces)?.surface(), Surface::Open);
    /// # Ok::<(), slimkd::MeshError>(())
    /// ```
    pub fn surface(&self) -> Surface {
        let vertices = self.vertices();
        let is_finite = |vertex: u32| vertices[vertex as usize].iter().all(|x| x.is_finite());
        // Of each vertex the first one in this order at its position. −0 is 0.
        let bits = |vertex: u32| vertices[vertex as usize].map(|x| (x + 0.0).to_bits());
        let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
        order.sort_unstable_by_key(|&vertex| bits(vertex));
        let mut position = vec![0; vertices.len()];
        for same in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
            same.iter().for_each(|&vertex| position[vertex as usize] = same[0]);
        }
        drop(order);
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * self.len());
        for corners in self.triangles() {
            if corners.iter().all(|&corner| is_finite(corner)) {
                let [a, b, c] = corners.map(|corner| position[corner as usize]);
                edges.extend([(a, b), (b, c), (c, a)].map(|(p, q)| (p.min(q), p.max(q), p > q)));
            }
        }
        // An edge between equal positions has no length and bounds nothing.
        edges.retain(|&(p, q, _)| p != q);
        edges.sort_unstable();
        let mut surface = Surface::Oriented;
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let back = edge.iter().filter(|&&(_, _, back)| back).count();
            match edge.len() {
                odd if odd % 2 == 1 => return Surface::Open,
                even if back * 2 != even => surface = Surface::Closed,
                _ => {}
            }
        }
        surface
    }
}
