//! Rays and hits of a batch: slices of structures, or a column for each field.

use crate::geometry::{Hit, Ray};

/// The rays of a batch: `&[Ray]`, an array, a `Vec`, or [`RayColumns`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Rays<'a> {
    /// A slice of rays. This is the fastest form: kernels read it in place.
    Slice(&'a [Ray]),
    /// A slice for each field.
    Columns(RayColumns<'a>),
}

impl Rays<'_> {
    /// The number of rays.
    pub fn len(&self) -> usize {
        match self {
            Self::Slice(rays) => rays.len(),
            Self::Columns(columns) => columns.origin[0].len(),
        }
    }

    /// True when there is no ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn get(&self, at: usize) -> Ray {
        match self {
            Self::Slice(rays) => rays[at],
            Self::Columns(columns) => columns.ray(at),
        }
    }
}

impl<'a> From<&'a [Ray]> for Rays<'a> {
    fn from(rays: &'a [Ray]) -> Self {
        Self::Slice(rays)
    }
}

impl<'a> From<&'a Vec<Ray>> for Rays<'a> {
    fn from(rays: &'a Vec<Ray>) -> Self {
        Self::Slice(rays)
    }
}

impl<'a, const N: usize> From<&'a [Ray; N]> for Rays<'a> {
    fn from(rays: &'a [Ray; N]) -> Self {
        Self::Slice(rays)
    }
}

impl<'a> From<RayColumns<'a>> for Rays<'a> {
    fn from(columns: RayColumns<'a>) -> Self {
        Self::Columns(columns)
    }
}

/// Rays as columns: a slice of f32 for each coordinate, all of the same length.
///
/// ```
/// use slimkd::{BuildOptions, HitColumns, KdTree, RayColumns, Tracer, TriangleMesh};
/// let mesh = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let tree = KdTree::build(mesh, &BuildOptions::default())?;
/// let (x, y, z) = ([0.2, 0.9], [0.2, 0.9], [5.0; 2]);
/// let rays = RayColumns::new([&x, &y, &z], [&[0.0; 2], &[0.0; 2], &[-1.0; 2]]);
/// let (mut t, mut triangle) = ([0.0; 2], [0; 2]);
/// tree.batch().closest(rays, HitColumns::new(&mut t, &mut triangle));
/// assert_eq!((t, triangle), ([5.0, f32::INFINITY], [0, u32::MAX]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct RayColumns<'a> {
    origin: [&'a [f32]; 3],
    direction: [&'a [f32]; 3],
    t_min: Option<&'a [f32]>,
    t_max: Option<&'a [f32]>,
}

impl<'a> RayColumns<'a> {
    /// Rays over `[0, ∞]`: x, y and z of the origins, then of the directions.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn new(origin: [&'a [f32]; 3], direction: [&'a [f32]; 3]) -> Self {
        let same = |column: &&[f32]| column.len() == origin[0].len();
        assert!(origin.iter().chain(&direction).all(same), "columns of one length");
        Self { origin, direction, t_min: None, t_max: None }
    }

    /// Gives each ray its own `[t_min, t_max]`.
    ///
    /// # Panics
    /// When the slices are not as long as the other columns.
    #[must_use]
    pub fn with_range(mut self, t_min: &'a [f32], t_max: &'a [f32]) -> Self {
        let length = self.origin[0].len();
        assert!(t_min.len() == length && t_max.len() == length, "columns of one length");
        (self.t_min, self.t_max) = (Some(t_min), Some(t_max));
        self
    }

    pub(super) fn ray(&self, at: usize) -> Ray {
        let range = |column: Option<&[f32]>, none: f32| column.map_or(none, |column| column[at]);
        Ray::new(self.origin.map(|column| column[at]), self.direction.map(|column| column[at]))
            .with_range(range(self.t_min, 0.0), range(self.t_max, f32::INFINITY))
    }
}

/// Where the closest hits of a batch go: `&mut [Option<Hit>]`, an array, a `Vec`, or [`HitColumns`].
#[derive(Debug)]
#[non_exhaustive]
pub enum Hits<'a> {
    /// A slice of hits. This is the fastest form.
    Slice(&'a mut [Option<Hit>]),
    /// A slice for each field.
    Columns(HitColumns<'a>),
}

impl Hits<'_> {
    /// The number of hits that there is room for.
    pub fn len(&self) -> usize {
        match self {
            Self::Slice(hits) => hits.len(),
            Self::Columns(columns) => columns.t.len(),
        }
    }

    /// True when there is no room.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The first `at` places, and the places behind them.
    pub(super) fn split_at(self, at: usize) -> (Self, Self) {
        match self {
            Self::Slice(hits) => {
                let (left, right) = hits.split_at_mut(at);
                (Self::Slice(left), Self::Slice(right))
            }
            Self::Columns(HitColumns { t, triangle, u, v }) => {
                let (t, t_right) = t.split_at_mut(at);
                let (triangle, triangle_right) = triangle.split_at_mut(at);
                let (u, u_right) = u.map(|u| u.split_at_mut(at)).unzip();
                let (v, v_right) = v.map(|v| v.split_at_mut(at)).unzip();
                let right = HitColumns { t: t_right, triangle: triangle_right, u: u_right, v: v_right };
                (Self::Columns(HitColumns { t, triangle, u, v }), Self::Columns(right))
            }
        }
    }
}

impl<'a> From<&'a mut [Option<Hit>]> for Hits<'a> {
    fn from(hits: &'a mut [Option<Hit>]) -> Self {
        Self::Slice(hits)
    }
}

impl<'a> From<&'a mut Vec<Option<Hit>>> for Hits<'a> {
    fn from(hits: &'a mut Vec<Option<Hit>>) -> Self {
        Self::Slice(hits)
    }
}

impl<'a, const N: usize> From<&'a mut [Option<Hit>; N]> for Hits<'a> {
    fn from(hits: &'a mut [Option<Hit>; N]) -> Self {
        Self::Slice(hits)
    }
}

impl<'a> From<HitColumns<'a>> for Hits<'a> {
    fn from(columns: HitColumns<'a>) -> Self {
        Self::Columns(columns)
    }
}

/// Hits as columns, all of the same length. A ray that misses gets `t = +∞`, `triangle = u32::MAX` and `u = v = 0`.
#[derive(Debug)]
pub struct HitColumns<'a> {
    t: &'a mut [f32],
    triangle: &'a mut [u32],
    u: Option<&'a mut [f32]>,
    v: Option<&'a mut [f32]>,
}

impl<'a> HitColumns<'a> {
    /// `t` and the triangle of each ray's hit.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn new(t: &'a mut [f32], triangle: &'a mut [u32]) -> Self {
        assert_eq!(t.len(), triangle.len(), "columns of one length");
        Self { t, triangle, u: None, v: None }
    }

    /// The barycentric weights of the vertices 1 and 2 as well.
    ///
    /// # Panics
    /// When the slices are not as long as the other columns.
    #[must_use]
    pub fn with_barycentrics(mut self, u: &'a mut [f32], v: &'a mut [f32]) -> Self {
        assert!(u.len() == self.t.len() && v.len() == self.t.len(), "columns of one length");
        (self.u, self.v) = (Some(u), Some(v));
        self
    }

    pub(super) fn put(&mut self, at: usize, hit: Option<Hit>) {
        let hit = hit.unwrap_or(Hit { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: u32::MAX });
        (self.t[at], self.triangle[at]) = (hit.t, hit.triangle);
        if let (Some(u), Some(v)) = (&mut self.u, &mut self.v) {
            (u[at], v[at]) = (hit.u, hit.v);
        }
    }
}
