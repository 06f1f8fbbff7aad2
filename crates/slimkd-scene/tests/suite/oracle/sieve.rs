//! Brute force for large meshes: many triangles at a time tell which ones a ray may hit, `BruteForce` tests those.
//!
//! The sieve has no tree, no bounds and no order: each ray meets each triangle. It drops a triangle when the f32 edge
//! functions of Woop, Benthin & Wald 2013 have strictly opposite signs, by the same operations as the library's own
//! first test, so nothing is lost that `BruteForce` would find; `oracle::compare` checks that on some of the rays.
//! Triangles lie lane by lane for the compiler to vectorise, and a chunk of them stays in the cache for a group of
//! rays: 2.5 ns a ray and triangle, `BruteForce` takes 11 in the cache and 20 beyond it (dev profile, SSE2).

use slimkd::{BruteForce, Hit, Ray, Tracer, TriangleMesh};

/// Triangles that are tested together.
const LANES: usize = 16;
/// Blocks that stay in the cache for a group of rays: 128 × 16 × 36 B = 72 KiB.
const CHUNK: usize = 128;

/// Corners of some triangles: axis, corner, lane.
type Block = [[[f32; LANES]; 3]; 3];

pub struct Sieve<'a> {
    mesh: &'a TriangleMesh,
    blocks: Vec<Block>,
    /// Bounds of all finite corners.
    low: [f32; 3],
    high: [f32; 3],
}

impl<'a> Sieve<'a> {
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        let mut blocks = vec![[[[0.0; LANES]; 3]; 3]; mesh.len().div_ceil(LANES)];
        let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
        for id in 0..mesh.len() {
            for (corner, position) in mesh.corners(id as u32).iter().enumerate() {
                for axis in 0..3 {
                    blocks[id / LANES][axis][corner][id % LANES] = position[axis];
                    if position[axis].is_finite() {
                        low[axis] = low[axis].min(position[axis]);
                        high[axis] = high[axis].max(position[axis]);
                    }
                }
            }
        }
        Self { mesh, blocks, low, high }
    }

    /// What `BruteForce::all_hits` answers, ray by ray.
    pub fn all_hits(&self, rays: &[Ray]) -> Vec<Vec<Hit>> {
        let frames: Vec<_> = rays.iter().map(Frame::new).collect();
        let mut candidates = vec![Vec::new(); rays.len()];
        for (chunk, blocks) in self.blocks.chunks(CHUNK).enumerate() {
            for (frame, ids) in frames.iter().zip(&mut candidates) {
                for (block, corners) in blocks.iter().enumerate() {
                    let keep = frame.may_hit(corners);
                    if keep.iter().fold(0, |any, lane| any | lane) != 0 {
                        let first = (chunk * CHUNK + block) * LANES;
                        ids.extend((0..LANES).filter(|&lane| keep[lane] != 0).map(|l| (first + l) as u32));
                    }
                }
            }
        }
        rays.iter().zip(candidates).map(|(ray, ids)| self.test(ray, ids)).collect()
    }

    /// Brute force over the candidates alone, and over one triangle more that spans the scene: `BruteForce` looks at
    /// the bounds first, and those of a few candidates would be too tight.
    fn test(&self, ray: &Ray, mut ids: Vec<u32>) -> Vec<Hit> {
        ids.retain(|&id| (id as usize) < self.mesh.len());
        let mut vertices: Vec<_> = ids.iter().flat_map(|&id| self.mesh.corners(id)).collect();
        vertices.extend([self.low, self.high, [self.high[0], self.low[1], self.low[2]]]);
        let triangles = (0..=ids.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let few = TriangleMesh::new(vertices, triangles).unwrap();
        let mut hits = BruteForce::new(&few).all(ray);
        hits.retain(|hit| (hit.triangle as usize) < ids.len());
        hits.iter_mut().for_each(|hit| hit.triangle = ids[hit.triangle as usize]);
        hits
    }
}

/// The frame in which a ray runs along z.
struct Frame {
    origin: [f32; 3],
    axes: [usize; 3],
    slope: [f32; 2],
}

impl Frame {
    fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let [dx, dy, dz] = d.map(f32::abs);
        let z = if dx > dy && dx > dz {
            0
        } else if dx <= dy && dy > dz {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Self { origin: ray.origin, axes: [x, y, z], slope: [d[x] / d[z], d[y] / d[z]] }
    }

    /// Not 0 for each triangle that the ray does not certainly pass by.
    #[inline(always)]
    fn may_hit(&self, block: &Block) -> [u32; LANES] {
        let [bx, by, bz] = self.axes.map(|axis| &block[axis]);
        let [ox, oy, oz] = self.axes.map(|axis| self.origin[axis]);
        let [sx, sy] = self.slope;
        let (mut x, mut y) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for corner in 0..3 {
            for lane in 0..LANES {
                let z = bz[corner][lane] - oz;
                x[corner][lane] = (bx[corner][lane] - ox) - sx * z;
                y[corner][lane] = (by[corner][lane] - oy) - sy * z;
            }
        }
        let mut keep = [0; LANES];
        for lane in 0..LANES {
            let u = x[2][lane] * y[1][lane] - y[2][lane] * x[1][lane];
            let v = x[0][lane] * y[2][lane] - y[0][lane] * x[2][lane];
            let w = x[1][lane] * y[0][lane] - y[1][lane] * x[0][lane];
            let negative = (u < 0.0) | (v < 0.0) | (w < 0.0);
            let positive = (u > 0.0) | (v > 0.0) | (w > 0.0);
            keep[lane] = u32::from(!(negative & positive));
        }
        keep
    }
}
