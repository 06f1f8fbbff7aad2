//! Do two contenders see the same? Hits are compared ray by ray before any rate is reported.
//!
//! A difference is excused where the geometry leaves it open: the ray passes an edge of the triangle in question (or
//! grazes its plane) so closely that single precision decides it by chance, or the hit lies at an end of the ray's range.
//! Anything else is wrong.

use crate::basics::vector::{
    add_scaled, bounds, cross, dot, length, normalized, segment_distance, sub, wide,
};
use crate::bench::built::{Found, Traced};
use serde::{Deserialize, Serialize};
use slimkd::{Ray, TriangleMesh};

/// Relative tolerance of t.
pub const T_RELATIVE: f64 = 1e-4;
/// Absolute tolerance of t and of the distance to an edge, in diagonals of the scene.
pub const DISTANCE: f64 = 1e-5;
/// A ray whose direction makes a smaller cosine with the triangle's normal grazes it.
pub const GRAZING: f64 = 1e-3;
/// Share of wrong rays in any workload above which a contender is marked: its rates stand for other work.
pub const MARKED_SHARE: f64 = 1e-4;

/// Outcome over the rays of one workload.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Agreement {
    /// Rays compared.
    pub rays: u64,
    /// Hits of the contender.
    pub hits: u64,
    /// The same, within tolerance.
    pub same: u64,
    /// Different, and excused.
    pub excused: u64,
    /// Wrong: a hit where the reference misses.
    pub extra: u64,
    /// Wrong: a miss where the reference hits.
    pub missing: u64,
    /// Wrong: both hit, at different distances.
    pub elsewhere: u64,
}

impl Agreement {
    /// All rays that are wrong.
    pub fn wrong(&self) -> u64 {
        self.extra + self.missing + self.elsewhere
    }

    /// Wrong rays of all rays.
    pub fn wrong_share(&self) -> f64 {
        self.wrong() as f64 / self.rays.max(1) as f64
    }

    /// True above [`MARKED_SHARE`].
    pub fn is_marked(&self) -> bool {
        self.wrong_share() > MARKED_SHARE
    }
}

/// Compares over one mesh.
pub struct Judge<'a> {
    mesh: &'a TriangleMesh,
    /// Scene units.
    distance: f64,
}

impl<'a> Judge<'a> {
    /// A judge for hits on `mesh`.
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        let bounds = bounds(mesh);
        let diagonal = length(sub(wide(bounds.max), wide(bounds.min)));
        Self { mesh, distance: DISTANCE * if diagonal.is_finite() { diagonal } else { 1.0 } }
    }

    /// Compares closest hits.
    pub fn closest(&self, rays: &[Ray], reference: &[Found], found: &[Found]) -> Agreement {
        let mut result = Agreement { rays: rays.len() as u64, ..Agreement::default() };
        for ((ray, a), b) in rays.iter().zip(reference).zip(found) {
            result.hits += u64::from(b.is_hit());
            match self.verdict(ray, a, b) {
                Verdict::Same => result.same += 1,
                Verdict::Excused => result.excused += 1,
                Verdict::Wrong => match (a.is_hit(), b.is_hit()) {
                    (false, _) => result.extra += 1,
                    (true, false) => result.missing += 1,
                    (true, true) => result.elsewhere += 1,
                },
            }
        }
        result
    }

    /// Compares any-hit answers. Where they differ, both sides' closest hits tell whether an edge was the reason.
    pub fn any(
        &self,
        rays: &[Ray],
        (reference, blocked): (&dyn Traced, &dyn Traced),
        expected: &[bool],
        given: &[bool],
    ) -> Agreement {
        let mut result = Agreement { rays: rays.len() as u64, ..Agreement::default() };
        for ((ray, &a), &b) in rays.iter().zip(expected).zip(given) {
            result.hits += u64::from(b);
            if a == b {
                result.same += 1;
                continue;
            }
            let (mut first, mut second) = ([Found::MISS], [Found::MISS]);
            reference.closest(&[*ray], &mut first);
            blocked.closest(&[*ray], &mut second);
            match self.verdict(ray, &first[0], &second[0]) {
                Verdict::Excused => result.excused += 1,
                _ if b => result.extra += 1,
                _ => result.missing += 1,
            }
        }
        result
    }

    fn verdict(&self, ray: &Ray, a: &Found, b: &Found) -> Verdict {
        let near = |x: f64, y: f64| (x - y).abs() <= self.t_tolerance(ray, x.abs().min(y.abs()));
        match (a.is_hit(), b.is_hit()) {
            (false, false) => return Verdict::Same,
            (true, true) if near(a.t.into(), b.t.into()) => return Verdict::Same,
            _ => {}
        }
        // Whoever is nearer claims a hit that the other refuses.
        let claimed = if a.t <= b.t { a } else { b };
        if claimed.is_hit() && self.is_open(ray, claimed) { Verdict::Excused } else { Verdict::Wrong }
    }

    fn t_tolerance(&self, ray: &Ray, t: f64) -> f64 {
        T_RELATIVE * t + self.distance / length(wide(ray.direction)).max(f64::MIN_POSITIVE)
    }

    /// Whether single precision may well refuse this hit. A claimed hit that is far off its triangle is not open.
    fn is_open(&self, ray: &Ray, hit: &Found) -> bool {
        if hit.triangle as usize >= self.mesh.len() {
            return false;
        }
        let [a, b, c] = self.mesh.corners(hit.triangle).map(wide);
        let (origin, direction) = (wide(ray.origin), wide(ray.direction));
        let point = add_scaled(origin, hit.t.into(), direction);
        let edge = [(a, b), (b, c), (c, a)]
            .map(|(from, to)| segment_distance(point, from, to))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        if edge <= self.distance {
            return true;
        }
        let Some(normal) = normalized(cross(sub(b, a), sub(c, a))) else { return true };
        let cosine = dot(normal, direction).abs() / length(direction);
        let plane = dot(normal, sub(point, a)).abs();
        if plane > 10.0 * self.distance {
            return false;
        }
        let t = f64::from(hit.t);
        let tolerance = self.t_tolerance(ray, t.abs());
        let at_an_end = [ray.t_min, ray.t_max].into_iter().any(|end| (t - f64::from(end)).abs() <= tolerance);
        cosine < GRAZING || at_an_end
    }
}

enum Verdict {
    Same,
    Excused,
    Wrong,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit square in two triangles.
    fn square() -> TriangleMesh {
        let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
    }

    fn down(x: f32, y: f32) -> Ray {
        Ray::new([x, y, 1.0], [0.0, 0.0, -1.0])
    }

    fn judge_one(ray: Ray, a: Found, b: Found) -> Agreement {
        Judge::new(&square()).closest(&[ray], &[a], &[b])
    }

    const HIT: Found = Found { t: 1.0, triangle: 0 };

    #[test]
    fn same_within_tolerance() {
        let nearly = Found { t: 1.000_05, triangle: 1 };
        assert_eq!(judge_one(down(0.5, 0.2), HIT, nearly).same, 1);
        assert_eq!(judge_one(down(5.0, 5.0), Found::MISS, Found::MISS).same, 1);
    }

    #[test]
    fn each_kind_of_wrong() {
        assert_eq!(judge_one(down(0.5, 0.2), HIT, Found::MISS).missing, 1);
        assert_eq!(judge_one(down(0.5, 0.2), Found::MISS, HIT).extra, 1);
        assert_eq!(judge_one(down(0.5, 0.2), HIT, Found { t: 1.1, triangle: 0 }).elsewhere, 1);
        // A claim that is nowhere near its triangle, or names none, has no excuse.
        assert_eq!(judge_one(down(0.5, 0.2), HIT, Found { t: 0.5, triangle: 1 }).elsewhere, 1);
        assert_eq!(judge_one(down(0.5, 0.2), Found::MISS, Found { t: 1.0, triangle: 9 }).extra, 1);
        let wrong = judge_one(down(0.5, 0.2), HIT, Found { t: f32::NAN, triangle: 0 });
        assert_eq!(wrong.wrong(), 1);
    }

    #[test]
    fn edges_grazing_and_ends_are_excused() {
        assert_eq!(judge_one(down(0.5, 1e-6), HIT, Found::MISS).excused, 1);
        assert_eq!(judge_one(down(0.5, -1e-6), Found::MISS, HIT).excused, 1);
        let grazing = Ray::new([0.2, 0.1, 1e-5], [1.0, 0.0, -1e-4]);
        assert_eq!(judge_one(grazing, Found { t: 0.1, triangle: 0 }, Found::MISS).excused, 1);
        let short = down(0.5, 0.2).with_range(0.0, 1.0);
        assert_eq!(judge_one(short, HIT, Found::MISS).excused, 1);
    }

    #[test]
    fn marks_above_the_stated_share() {
        let few = Agreement { rays: 100_000, missing: 10, ..Agreement::default() };
        assert!(!few.is_marked());
        assert!(Agreement { missing: 11, ..few }.is_marked());
        assert!(!Agreement::default().is_marked());
    }

    /// Says what it is told.
    struct Fixed(Found);

    impl Traced for Fixed {
        fn closest(&self, _rays: &[Ray], found: &mut [Found]) {
            found.fill(self.0);
        }
        fn any(&self, _rays: &[Ray], blocked: &mut [bool]) {
            blocked.fill(self.0.is_hit());
        }
        fn bytes(&self, _counted: u64) -> crate::bench::built::Bytes {
            unreachable!("not asked")
        }
    }

    #[test]
    fn any_hit_answers_are_judged_by_closest_hits() {
        let mesh = square();
        let judge = Judge::new(&mesh);
        let (hit, miss) = (Fixed(HIT), Fixed(Found::MISS));
        let rays = [down(0.5, 0.2), down(0.5, 1e-6)];
        let result = judge.any(&rays, (&hit, &miss), &[true, true], &[false, false]);
        assert_eq!((result.missing, result.excused, result.hits), (1, 1, 0));
        // Any-hit contradicts its own closest hit: wrong.
        let result = judge.any(&rays, (&hit, &hit), &[true, true], &[false, true]);
        assert_eq!((result.missing, result.same), (1, 1));
    }
}
