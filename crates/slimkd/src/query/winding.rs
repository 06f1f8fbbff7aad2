//! Generalised winding numbers: inside and outside of meshes that have holes, overlap or touch themselves.
//!
//! Sources: Jacobson, Kavan & Sorkine-Hornung, *Robust Inside-Outside Segmentation using Generalized Winding Numbers*, 2013; Barill, Dickson,
//! Schmidt, Levin & Jacobson, *Fast Winding Numbers for Soups and Clouds*, 2018, for far triangles; Van Oosterom & Strackee, *The Solid Angle
//! of a Plane Triangle*, 1983, for near ones.
//!
//! Deviation: a binary tree that halves triangles along the longest axis, instead of an octree.

use crate::geometry::TriangleMesh;
use crate::threads;
use std::convert::Infallible;
use std::f64::consts::PI;

/// The most triangles of a leaf.
const LEAF: usize = 8;
/// Points that one thread takes at a time.
const PIECE: usize = 1024;

type Vector = [f64; 3];

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// What a group of triangles looks like from afar.
#[derive(Clone, Debug)]
struct Node {
    centre: Vector,
    /// No corner is farther from the centre.
    radius: f64,
    /// The sum of the triangles' area vectors.
    area: Vector,
    /// The sum of (a triangle's middle − centre)ᵢ · (its area vector)ⱼ.
    spread: [Vector; 3],
    /// Its triangles.
    triangles: std::ops::Range<u32>,
    /// Where the next node stands that is not below this one.
    next: u32,
}

/// The winding number of a mesh around any point: for an oriented closed mesh the whole number of times that it surrounds the point, 1 inside. Where a
/// mesh has holes, overlaps or touches itself, the number varies smoothly, and a point counts as inside where it is above a half.
///
/// Triangles must agree on their side, normals outwards; they need not fit together. The number is approximate: far groups of
/// triangles count by two terms of a series, so that a point takes a time that grows with the logarithm of the mesh. For closed meshes,
/// [`Tracer::contains`](crate::Tracer::contains) is exact and faster.
///
/// ```
/// use slimkd::{TriangleMesh, WindingNumbers};
/// // A tetrahedron without one of its faces.
/// let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2]])?;
/// let numbers = WindingNumbers::new(mesh);
/// assert!(numbers.contains([0.5, 0.5, 0.5]));
/// assert!(!numbers.contains([3.0, 3.0, 3.0]));
/// assert!(!numbers.contains([-0.1, 1.0, 1.0]));
/// # Ok::<(), slimkd::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct WindingNumbers {
    mesh: TriangleMesh,
    /// In the order of the nodes.
    triangles: Vec<u32>,
    nodes: Vec<Node>,
    accuracy: f64,
}

impl WindingNumbers {
    /// Prepares the numbers of a mesh; takes about 60 bytes a triangle. Triangles that can never be hit do not count.
    pub fn new(mesh: impl Into<TriangleMesh>) -> Self {
        let mesh = mesh.into();
        let (mut triangles, _) = mesh.valid_triangles();
        let mut nodes: Vec<Node> = Vec::new();
        // Groups that are still to become nodes, the next one last; `None` closes the node before.
        let mut pending = if triangles.is_empty() { vec![] } else { vec![Some(0..triangles.len())] };
        let mut open = Vec::new();
        while let Some(group) = pending.pop() {
            let Some(group) = group else {
                let at: usize = open.pop().unwrap_or(0);
                nodes[at].next = nodes.len() as u32;
                continue;
            };
            open.push(nodes.len());
            nodes.push(Node::new(&mesh, &triangles[group.clone()], group.start as u32));
            pending.push(None);
            if group.len() > LEAF {
                let middle = halve(&mesh, &mut triangles[group.clone()]) + group.start;
                pending.extend([Some(middle..group.end), Some(group.start..middle)]);
            }
        }
        Self { mesh, triangles, nodes, accuracy: 2.0 }
    }

    /// Counts groups of triangles by their series only where the point is farther from their centre than `accuracy` times their radius. The default,
    /// 2, errs by some thousandths; infinity sums over all triangles one by one.
    #[must_use]
    pub fn with_accuracy(mut self, accuracy: f64) -> Self {
        self.accuracy = accuracy;
        self
    }

    /// The number around a point, in scene units. On the surface itself it lies between those of both sides.
    pub fn at(&self, point: [f32; 3]) -> f64 {
        let point = point.map(f64::from);
        let (mut solid_angle, mut at) = (0.0, 0);
        while let Some(node) = self.nodes.get(at) {
            let to = sub(node.centre, point);
            let square = dot(to, to);
            let far = self.accuracy * node.radius;
            if square > far * far {
                solid_angle += node.seen_from_afar(to, square);
                at = node.next as usize;
            } else if node.triangles.len() <= LEAF {
                let ids = &self.triangles[node.triangles.start as usize..node.triangles.end as usize];
                solid_angle += ids.iter().map(|&id| self.solid_angle(point, id)).sum::<f64>();
                at += 1;
            } else {
                at += 1;
            }
        }
        solid_angle / (4.0 * PI)
    }

    /// Whether the number around a point is above a half.
    pub fn contains(&self, point: [f32; 3]) -> bool {
        self.at(point) > 0.5
    }

    /// [`WindingNumbers::at`] of each point, on all threads of the current rayon pool.
    ///
    /// # Panics
    /// When `numbers` is not as long as `points`.
    pub fn batch(&self, points: &[[f32; 3]], numbers: &mut [f64]) {
        assert_eq!(points.len(), numbers.len(), "one place for an answer for each point");
        let pieces = points.chunks(PIECE).zip(numbers.chunks_mut(PIECE)).collect::<Vec<_>>();
        let done: Result<Vec<()>, Infallible> = threads::map(pieces, |(points, numbers)| {
            points.iter().zip(numbers).for_each(|(point, number)| *number = self.at(*point));
            Ok(())
        });
        done.map_or_else(|never| match never {}, drop);
    }

    /// The signed solid angle of a triangle: positive where the point sees its back.
    fn solid_angle(&self, point: Vector, id: u32) -> f64 {
        let [a, b, c] = self.mesh.corners(id).map(|corner| sub(corner.map(f64::from), point));
        let [p, q, r] = [a, b, c].map(|x| dot(x, x).sqrt());
        let below = p * q * r + dot(a, b) * r + dot(b, c) * p + dot(c, a) * q;
        2.0 * dot(a, cross(b, c)).atan2(below)
    }
}

impl Node {
    fn new(mesh: &TriangleMesh, ids: &[u32], first: u32) -> Self {
        let parts = || {
            ids.iter().map(|&id| {
                let corners = mesh.corners(id).map(|corner| corner.map(f64::from));
                let [a, b, c] = corners;
                let area = cross(sub(b, a), sub(c, a)).map(|x| 0.5 * x);
                let middle: Vector = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
                (corners, area, middle)
            })
        };
        let (mut centre, mut weight, mut area) = ([0.0; 3], 0.0, [0.0; 3]);
        for (_, part, middle) in parts() {
            let size = dot(part, part).sqrt();
            weight += size;
            for k in 0..3 {
                centre[k] += size * middle[k];
                area[k] += part[k];
            }
        }
        // Areas below what f64 can hold weigh nothing; any centre will do.
        let some = parts().next().map_or([0.0; 3], |(_, _, middle)| middle);
        centre = if weight > 0.0 { centre.map(|x| x / weight) } else { some };
        let (mut spread, mut square) = ([[0.0; 3]; 3], 0.0f64);
        for (corners, part, middle) in parts() {
            let off = sub(middle, centre);
            for i in 0..3 {
                for j in 0..3 {
                    spread[i][j] += off[i] * part[j];
                }
                let corner = sub(corners[i], centre);
                square = square.max(dot(corner, corner));
            }
        }
        let triangles = first..first + ids.len() as u32;
        Self { centre, radius: square.sqrt(), area, spread, triangles, next: 0 }
    }

    /// The solid angle of the whole group as seen from a far point; `to` leads from there to the centre.
    fn seen_from_afar(&self, to: Vector, square: f64) -> f64 {
        let cube = square * square.sqrt();
        let trace = self.spread[0][0] + self.spread[1][1] + self.spread[2][2];
        let along = dot(to, self.spread.map(|row| dot(row, to)));
        (dot(self.area, to) + trace) / cube - 3.0 * along / (cube * square)
    }
}

/// Puts the half of the triangles first whose boxes lie lower on the axis along which their middles spread most; returns its length.
fn halve(mesh: &TriangleMesh, ids: &mut [u32]) -> usize {
    let middle = |id: u32| {
        let corners = mesh.corners(id);
        [0, 1, 2].map(|k| corners.iter().map(|corner| f64::from(corner[k])).sum::<f64>())
    };
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for &id in ids.iter() {
        let at = middle(id);
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(at[k]), high[k].max(at[k]));
        }
    }
    let extent = sub(high, low);
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let half = ids.len() / 2;
    ids.select_nth_unstable_by(half, |&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b)));
    half
}
