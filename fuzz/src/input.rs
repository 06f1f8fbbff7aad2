//! Meshes, rays and options out of arbitrary bytes.

use slimkd::{
    BuildOptions, Clipping, HoistAlgorithm, Hoisting, Layout, Preset, Ray, Splits, TreeBudget, TriangleMesh,
};

/// Bytes to decide by; zeros once they are used up.
pub(crate) struct Input<'a> {
    data: &'a [u8],
}

impl<'a> Input<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self { data }
    }

    fn byte(&mut self) -> u8 {
        let Some((&first, rest)) = self.data.split_first() else { return 0 };
        self.data = rest;
        first
    }

    fn float(&mut self) -> f32 {
        f32::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    /// Mostly on a coarse grid, where planes and corners coincide; sometimes any bits at all.
    fn coordinate(&mut self) -> f32 {
        let kind = self.byte();
        match kind % 8 {
            0..5 => f32::from((kind >> 3) as i8 - 16) * 0.25,
            5 => f32::from(self.byte() as i8) * 1e-6,
            6 => f32::from(self.byte() as i8) * 1e5,
            _ => self.float(),
        }
    }

    fn point(&mut self) -> [f32; 3] {
        std::array::from_fn(|_| self.coordinate())
    }

    /// Up to 255 triangles.
    pub(crate) fn mesh(&mut self) -> TriangleMesh {
        let vertices: Vec<_> = (0..3 + self.byte() % 64).map(|_| self.point()).collect();
        let count = vertices.len() as u32;
        let triangles =
            (0..self.byte()).map(|_| std::array::from_fn(|_| u32::from(self.byte()) % count)).collect();
        TriangleMesh::new(vertices, triangles).expect("every index is in range")
    }

    /// A ray, often from or to a vertex of the mesh, or along an axis.
    pub(crate) fn ray(&mut self, mesh: &TriangleMesh) -> Ray {
        let kind = self.byte();
        let vertices = mesh.vertices();
        let vertex = |byte: u8| match vertices {
            [] => [0.0; 3],
            _ => vertices[usize::from(byte) % vertices.len()],
        };
        let origin = if kind & 1 == 1 { vertex(self.byte()) } else { self.point() };
        let mut direction = match kind >> 1 & 3 {
            0 => self.point(),
            1 => {
                let to = vertex(self.byte());
                std::array::from_fn(|k| to[k] - origin[k])
            }
            2 => {
                let to = [vertex(self.byte()), vertex(self.byte())];
                std::array::from_fn(|k| 0.5 * to[0][k] + 0.5 * to[1][k] - origin[k])
            }
            _ => [0.0; 3],
        };
        if direction == [0.0; 3] {
            direction[usize::from(self.byte()) % 3] = 1.0;
        }
        match kind >> 3 & 7 {
            0 => Ray::new(origin, direction).with_range(self.coordinate(), self.coordinate()),
            1 => Ray::new(origin, direction).with_range(f32::NEG_INFINITY, f32::INFINITY),
            2 => Ray::new(origin, direction).with_range(0.0, 1.0),
            3 => Ray::new(origin, direction.map(|x| x * 1e-20)),
            4 => Ray::new(origin, direction.map(|x| x * 1e20)),
            _ => Ray::new(origin, direction),
        }
    }

    pub(crate) fn options(&mut self) -> BuildOptions {
        let byte = self.byte();
        let mut options = BuildOptions::from(Preset::ALL[usize::from(byte) % Preset::ALL.len()]);
        let more = self.byte();
        if more & 1 == 1 {
            options.collapse = !options.collapse;
        }
        if more & 2 == 2 {
            options.layout =
                [Layout::FourByte, Layout::TwoByte, Layout::Dense, Layout::Wide][usize::from(byte >> 4) % 4];
        }
        if more & 12 == 12 {
            options.splits = Splits::Space;
        }
        match more >> 2 & 3 {
            1 => options.clipping = Clipping::Box,
            2 => options.clipping = Clipping::ExactFrom(16),
            _ => {}
        }
        if more >> 4 & 3 == 3 && options.hoisting.is_some() {
            let mut hoisting = Hoisting::new(0.3, 0.3);
            hoisting.algorithm = [HoistAlgorithm::Strip, HoistAlgorithm::Rebuild][usize::from(more >> 6) % 2];
            options.hoisting = Some(hoisting);
        }
        options.leaf_at_most = u32::from(self.byte() % 6);
        let bytes = self.byte();
        if bytes & 1 == 1 {
            options.byte_weight = f32::from(bytes >> 1) / 32.0;
        }
        options.max_tree = match self.byte() {
            // One leaf of all 255 triangles takes less.
            byte @ 0..64 => Some(TreeBudget::Bytes(4096 + 64 * u64::from(byte))),
            byte @ 64..128 => Some(TreeBudget::BytesPerTriangle(8.0 + f32::from(byte - 64))),
            128..192 => None,
            _ => options.max_tree,
        };
        options
    }
}
