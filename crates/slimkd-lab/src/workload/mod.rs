//! The rays that rates are measured with: one definition, for `slimkd bench` and for `slimkd-bench`.
//!
//! All have t_min = 0 and a direction of unit length, because two peers know nothing else; origins on surfaces are lifted off
//! instead.

mod order;
pub mod view;

use crate::basics::vector::{Vec64, add_scaled, bounds, cross, dot, length, narrow, normalized, sub, wide};
pub use order::{BLOCK, BLOCK_PIXELS, Order, TILE};
use slimkd::{Aabb, Ray, TriangleMesh};
use slimkd_util::Rng;
use view::View;

/// How far origins are lifted off their surface, in diagonals of the scene.
pub const LIFT: f64 = 1e-5;
/// The light hangs at this share of the way from the eye up to the first surface.
pub const LIGHT_HEIGHT: f64 = 0.8;
/// Or, under open sky, this many diagonals of the scene above the eye.
pub const LIGHT_SKY: f64 = 0.5;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Kind {
    /// Closest hits through the pixels of a picture.
    Primary,
    /// Any hit between the primary hits and a light.
    Shadow,
    /// Closest hits of cosine-distributed reflections at the primary hits.
    Bounce,
    /// Closest hits from random points of the scene's box in random directions.
    Random,
}

impl Kind {
    /// All of them, in table order.
    pub const ALL: &[Self] = &[Self::Primary, Self::Shadow, Self::Bounce, Self::Random];

    /// The name in tables and JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce",
            Self::Random => "random",
        }
    }

    /// True where any hit is asked for instead of the closest.
    pub const fn is_any(self) -> bool {
        matches!(self, Self::Shadow)
    }
}

/// Rays of one kind.
#[derive(Clone, Debug)]
pub struct Workload {
    /// What is asked of them.
    pub kind: Kind,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// A closest hit as every library can report it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Distance in units of the direction; `+inf` on a miss.
    pub t: f32,
    /// Public triangle id; `u32::MAX` on a miss.
    pub triangle: u32,
}

impl Found {
    /// Nothing.
    pub const MISS: Self = Self { t: f32::INFINITY, triangle: u32::MAX };

    /// False on a miss.
    pub fn is_hit(&self) -> bool {
        self.triangle != u32::MAX
    }
}

/// Finds the closest hits of rays.
pub type Closest<'a> = dyn Fn(&[Ray], &mut [Found]) + 'a;

/// What the rays depend on besides the scene.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// Where the cameras stand.
    pub views: Vec<View>,
    /// Width and height of each view's picture, pixels.
    pub size: usize,
    /// In which order the pixels are visited.
    pub order: Order,
    /// Number of random rays.
    pub random_rays: usize,
    /// Seed of bounce and random rays.
    pub seed: u64,
}

impl Recipe {
    /// One view's picture, row of tiles by row of tiles.
    pub fn picture(view: View, size: usize, random_rays: usize, seed: u64) -> Self {
        Self { views: vec![view], size, order: Order::Rows, random_rays, seed }
    }

    /// The view that the primary ray number `index` belongs to.
    fn view_of(&self, index: usize) -> usize {
        self.order.view_of(index, self.size, self.views.len())
    }
}

/// All rays and the lights that the shadow rays go to.
#[derive(Clone, Debug)]
pub struct Rays {
    /// One a kind asked for, in the order asked.
    pub workloads: Vec<Workload>,
    /// Where each view's light hangs.
    pub lights: Vec<[f32; 3]>,
}

/// Makes the rays of `kinds`; `closest` finds the primary hits that shadow and bounce rays start from.
pub fn generate(mesh: &TriangleMesh, closest: &Closest<'_>, recipe: &Recipe, kinds: &[Kind]) -> Rays {
    generate_from(mesh, closest, recipe, primary(recipe), kinds)
}

/// Like [`generate`], but from a beginning of the [`primary`] rays.
pub fn generate_from(
    mesh: &TriangleMesh,
    closest: &Closest<'_>,
    recipe: &Recipe,
    primary: Vec<Ray>,
    kinds: &[Kind],
) -> Rays {
    let bounds = bounds(mesh);
    let diagonal = diagonal(&bounds);
    let mut found = vec![Found::MISS; primary.len()];
    if kinds.iter().any(|kind| matches!(kind, Kind::Shadow | Kind::Bounce)) {
        closest(&primary, &mut found);
    }
    let starts: Vec<Start> = primary
        .iter()
        .zip(&found)
        .enumerate()
        .filter(|(_, (_, hit))| hit.is_hit())
        .filter_map(|(index, (ray, hit))| start(mesh, ray, hit, LIFT * diagonal, recipe.view_of(index)))
        .collect();
    let lights: Vec<Vec64> = recipe.views.iter().map(|view| light(closest, view, diagonal)).collect();
    let rays = |kind| match kind {
        Kind::Primary => primary.clone(),
        Kind::Shadow => starts.iter().filter_map(|start| shadow(start, lights[start.view])).collect(),
        Kind::Bounce => bounce(&starts, recipe.seed),
        Kind::Random => random(&bounds, recipe),
    };
    Rays {
        workloads: kinds.iter().map(|&kind| Workload { kind, rays: rays(kind) }).collect(),
        lights: lights.into_iter().map(narrow).collect(),
    }
}

fn diagonal(bounds: &Aabb) -> f64 {
    let diagonal = length(sub(wide(bounds.max), wide(bounds.min)));
    if diagonal.is_finite() { diagonal } else { 0.0 }
}

/// The rays through the pixels of all views; none where a camera looks nowhere.
pub fn primary(recipe: &Recipe) -> Vec<Ray> {
    let frames: Option<Vec<_>> = recipe.views.iter().map(View::frame).collect();
    let Some(frames) = frames else { return Vec::new() };
    let size = recipe.size;
    let place = |pixel: usize| (2.0 * (pixel as f64 + 0.5)) / size as f64 - 1.0;
    let mut rays = Vec::with_capacity(size * size * frames.len());
    recipe.order.visit(size, frames.len(), |view, x, y| {
        rays.push(Ray::new(recipe.views[view].eye, frames[view].direction(place(x), -place(y))));
    });
    rays
}

/// A point just above a surface, and the side that it is on.
struct Start {
    point: Vec64,
    normal: Vec64,
    view: usize,
}

fn start(mesh: &TriangleMesh, ray: &Ray, hit: &Found, lift: f64, view: usize) -> Option<Start> {
    let [a, b, c] = mesh.corners(hit.triangle).map(wide);
    let normal = normalized(cross(sub(b, a), sub(c, a)))?;
    let direction = wide(ray.direction);
    let normal = if dot(normal, direction) > 0.0 { normal.map(|x| -x) } else { normal };
    let point = add_scaled(wide(ray.origin), hit.t.into(), direction);
    Some(Start { point: add_scaled(point, lift, normal), normal, view })
}

fn light(closest: &Closest<'_>, view: &View, diagonal: f64) -> Vec64 {
    let up = normalized(wide(view.up)).unwrap_or([0.0, 1.0, 0.0]);
    let mut ceiling = [Found::MISS];
    closest(&[Ray::new(view.eye, narrow(up))], &mut ceiling);
    let height =
        if ceiling[0].is_hit() { LIGHT_HEIGHT * f64::from(ceiling[0].t) } else { LIGHT_SKY * diagonal };
    add_scaled(wide(view.eye), height, up)
}

fn shadow(start: &Start, light: Vec64) -> Option<Ray> {
    let way = sub(light, start.point);
    let direction = normalized(way)?;
    Some(Ray::new(narrow(start.point), narrow(direction)).with_range(0.0, length(way) as f32))
}

/// Cosine-distributed: the normal plus a point of the unit sphere.
fn bounce(starts: &[Start], seed: u64) -> Vec<Ray> {
    let mut rng = Rng::new(seed);
    let ray = |start: &Start| {
        let direction = add_scaled(start.normal, 0.999, wide(rng.direction()));
        normalized(direction).map(|direction| Ray::new(narrow(start.point), narrow(direction)))
    };
    starts.iter().filter_map(ray).collect()
}

fn random(bounds: &Aabb, recipe: &Recipe) -> Vec<Ray> {
    if bounds.is_empty() {
        return Vec::new();
    }
    // Another stream than that of the bounces.
    let mut rng = Rng::new(!recipe.seed);
    let mut point = || std::array::from_fn::<f32, 3, _>(|k| rng.between(bounds.min[k], bounds.max[k]));
    let origins: Vec<[f32; 3]> = (0..recipe.random_rays).map(|_| point()).collect();
    let unit = |d: [f32; 3]| narrow(normalized(wide(d)).unwrap_or([1.0, 0.0, 0.0]));
    origins.into_iter().map(|origin| Ray::new(origin, unit(rng.direction()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basics::soup::soup;
    use slimkd::{BuildOptions, KdTree, Tracer};
    use slimkd_scene::UpAxis;

    fn all(seed: u64) -> Rays {
        let mesh = soup(200, 3);
        let tree = KdTree::build(mesh.clone(), &BuildOptions::default()).unwrap();
        let closest = |rays: &[Ray], found: &mut [Found]| {
            for (ray, found) in rays.iter().zip(found) {
                *found =
                    tree.closest(ray).map_or(Found::MISS, |hit| Found { t: hit.t, triangle: hit.triangle });
            }
        };
        let view = View::parse("0.5,0.5,3,0.5,0.5,0.5,30", UpAxis::Y).unwrap();
        generate(&mesh, &closest, &Recipe::picture(view, 21, 100, seed), Kind::ALL)
    }

    #[test]
    fn rays_are_what_all_peers_understand() {
        let rays = all(1);
        assert_eq!(rays.workloads[0].rays.len(), 21 * 21);
        assert_eq!(rays.workloads[3].rays.len(), 100);
        assert!(!rays.workloads[1].rays.is_empty());
        assert_eq!(rays.workloads[1].rays.len(), rays.workloads[2].rays.len());
        for ray in rays.workloads.iter().flat_map(|w| &w.rays) {
            assert_eq!(ray.t_min, 0.0);
            assert!(ray.t_max > 0.0);
            assert!((length(wide(ray.direction)) - 1.0).abs() < 1e-5);
        }
        // Shadow rays end at the light, and only they end.
        for ray in &rays.workloads[1].rays {
            assert!(length(sub(wide(ray.at(ray.t_max)), wide(rays.lights[0]))) < 1e-4);
        }
        assert!(rays.workloads[2].rays.iter().all(|ray| ray.t_max == f32::INFINITY));
    }

    #[test]
    fn tiles_cover_every_pixel_once() {
        let mut seen: Vec<[u32; 3]> =
            all(1).workloads[0].rays.iter().map(|ray| ray.direction.map(f32::to_bits)).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 21 * 21);
    }

    #[test]
    fn the_seed_decides() {
        let (a, b, c) = (all(1), all(1), all(2));
        assert_eq!(a.workloads[2].rays, b.workloads[2].rays);
        assert_ne!(a.workloads[2].rays, c.workloads[2].rays);
        assert_ne!(a.workloads[3].rays, c.workloads[3].rays);
        assert_eq!(a.workloads[0].rays, c.workloads[0].rays);
    }
}
