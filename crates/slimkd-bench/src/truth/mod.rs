//! An independent judge of closest and any hits: its own hierarchy, its own triangle test in f64, and error bounds.
//!
//! Each triangle is seen in the frame in which the ray runs along z (Woop, Benthin & Wald 2013), computed in f64 from the
//! f32 input. There the ray is the origin of a plane. `slimkd` shears in f32, which moves a corner by at most
//! [`CORNER`] · M, M being the largest distance per axis from the ray's origin to the scene's bounds
//! (`slimkd/src/traverse/prepared.rs`). So a triangle is hit *for certain* where the origin lies inside of the projected
//! triangle by more than that, and *possibly* where it lies outside by no more. Every candidate has an interval of t.
//!
//! A closest hit is wrong when its triangle is not possible at that t (invented), or when a triangle that is hit for
//! certain lies before it (missing). It is borderline where its triangle is only possible, or where nothing is hit and
//! something was possible. An answer of an any-hit query is wrong when it is yes and nothing is possible, or no and
//! something is certain.

mod bvh;
mod triangle;

use crate::vector::bounds;
use bvh::Bvh;
use slimkd::{Hit, Ray, TriangleMesh};
use std::ops::AddAssign;
use triangle::{Frame, Possible};

/// How far `slimkd` may move a corner, in M: 5 · 2⁻²⁴ by its own proof, and 3 · 2⁻²⁴ for the slope's rounding.
pub const CORNER: f64 = 8.0 / (1u64 << 24) as f64;

/// Counts of verdicts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Verdicts {
    /// Rays judged.
    pub rays: u64,
    /// Rays that hit something, by the answers.
    pub hits: u64,
    /// Decided by less than the error bound.
    pub borderline: u64,
    /// Wrong: no such hit exists.
    pub invented: u64,
    /// Wrong: something nearer is hit for certain.
    pub missing: u64,
}

impl Verdicts {
    /// All that are wrong.
    pub fn wrong(&self) -> u64 {
        self.invented + self.missing
    }
}

impl AddAssign for Verdicts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.borderline += other.borderline;
        self.invented += other.invented;
        self.missing += other.missing;
    }
}

/// Judges hits on one mesh.
pub struct Truth<'a> {
    mesh: &'a TriangleMesh,
    bounds: slimkd::Aabb,
    bvh: Bvh,
}

impl<'a> Truth<'a> {
    /// Builds the judge's hierarchy.
    pub fn new(mesh: &'a TriangleMesh) -> Self {
        Self { mesh, bounds: bounds(mesh), bvh: Bvh::new(mesh) }
    }

    /// Judges a closest hit.
    pub fn closest(&self, ray: &Ray, hit: Option<Hit>) -> Verdicts {
        let mut verdict = Verdicts { rays: 1, hits: u64::from(hit.is_some()), ..Verdicts::default() };
        let frame = Frame::new(ray, &self.bounds);
        let claimed = hit.map(|hit| frame.candidate(&self.mesh.corners(hit.triangle)));
        if let (Some(hit), Some(claimed)) = (hit, claimed) {
            let t = f64::from(hit.t);
            match claimed {
                Some(found) if found.first <= t && t <= found.last => {
                    verdict.borderline += u64::from(!found.certain);
                }
                _ => {
                    verdict.invented = 1;
                    return verdict;
                }
            }
        }
        let nearest = hit.map_or(f64::INFINITY, |hit| hit.t.into());
        let (certain, possible) = self.search(&frame, nearest);
        if certain {
            verdict.missing = 1;
        } else if hit.is_none() && possible {
            verdict.borderline = 1;
        }
        verdict
    }

    /// Judges whether anything is hit.
    pub fn any(&self, ray: &Ray, blocked: bool) -> Verdicts {
        let mut verdict = Verdicts { rays: 1, hits: u64::from(blocked), ..Verdicts::default() };
        let (certain, possible) = self.search(&Frame::new(ray, &self.bounds), f64::INFINITY);
        match (blocked, certain, possible) {
            (true, _, false) => verdict.invented = 1,
            (false, true, _) => verdict.missing = 1,
            (_, certain, possible) => verdict.borderline = u64::from(possible && !certain),
        }
        verdict
    }

    /// Whether something is hit before `limit` for certain, and whether something possibly is. A certain one ends the
    /// search.
    fn search(&self, frame: &Frame, limit: f64) -> (bool, bool) {
        let mut any = false;
        let certain = self.bvh.visit(frame, limit, |id| {
            let Some(Possible { certain, first, last }) = frame.candidate(&self.mesh.corners(id)) else {
                return false;
            };
            any |= first < limit && first <= frame.t_max && last >= frame.t_min;
            certain && last < limit && frame.t_min <= first && last <= frame.t_max
        });
        (certain, any || certain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;
    use crate::soup::soup;
    use slimkd::{BuildOptions, KdTree, Tracer};

    #[test]
    fn true_hits_are_right_and_planted_errors_are_found() {
        let mesh = soup(300, 5);
        let tree = KdTree::build(mesh.clone(), &BuildOptions::default()).unwrap();
        let truth = Truth::new(&mesh);
        let mut rng = Rng::new(3);
        let (mut right, mut hidden, mut moved, mut shadows) =
            (Verdicts::default(), Verdicts::default(), Verdicts::default(), Verdicts::default());
        for _ in 0..20_000 {
            let origin = std::array::from_fn(|_| rng.between(-0.5, 1.5));
            let ray = Ray::new(origin, rng.direction());
            let hit = tree.closest(&ray);
            right += truth.closest(&ray, hit);
            right += truth.any(&ray, hit.is_some());
            if let Some(hit) = hit {
                hidden += truth.closest(&ray, None);
                moved += truth.closest(&ray, Some(Hit { t: hit.t * 0.9, ..hit }));
            }
            shadows += truth.any(&ray, hit.is_none());
        }
        assert!(right.wrong() == 0 && right.hits > 500, "{right:?}");
        assert!(right.borderline < 10, "{right:?}");
        assert!(hidden.missing + hidden.borderline == hidden.rays, "{hidden:?}");
        assert!(moved.invented == moved.rays, "{moved:?}");
        assert!(shadows.wrong() + shadows.borderline == shadows.rays, "{shadows:?}");
    }
}
