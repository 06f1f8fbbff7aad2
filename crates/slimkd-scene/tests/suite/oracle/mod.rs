//! Whole scenes against brute force: hard rays, every query, compared to the last bit.
//!
//! One pass of the oracle answers a ray for all trees: the closest hit and "any" follow from the list of all hits. To
//! afford that on large meshes, `sieve.rs` finds the list. Both shortcuts are checked on some of the rays.
#![allow(dead_code, unreachable_pub)] // each test file uses its own part

#[path = "../../../../slimkd/tests/common/mod.rs"]
pub mod common;
mod sieve;

pub use common::check_invariants;

use rayon::prelude::*;
use sieve::Sieve;
use slimkd::{BruteForce, Hit, KdTree, Ray, Tracer, TriangleMesh};

/// Rays a scene unless `SLIMKD_PARITY_RAYS` says otherwise.
const RAYS: usize = 10_000;
/// Rays of one seed; further ones continue with the next seed.
const BATCH: usize = 10_000;
/// Rays that pass through the sieve together.
const GROUP: usize = 100;
/// One ray of so many asks `BruteForce` itself as well. Coprime to the ten kinds of hard rays, so each has its turn.
const CROSS_CHECK: usize = 49;
/// Disagreements of a scene that are spelt out.
const SPELT_OUT: usize = 8;

/// A number from the environment.
pub fn setting(name: &str, default: usize) -> usize {
    match std::env::var(name) {
        Ok(text) => text.parse().unwrap_or_else(|_| panic!("{name}={text:?} is not a number")),
        Err(_) => default,
    }
}

/// What a comparison saw.
#[derive(Default)]
pub struct Outcome {
    pub rays: usize,
    /// Rays that hit.
    pub hits: usize,
    /// Rays whose nearest hit several triangles share.
    pub ties: usize,
    /// Hits of all kinds along all rays.
    pub all_hits: usize,
    pub disagreements: Vec<String>,
}

impl Outcome {
    fn and(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.hits += other.hits;
        self.ties += other.ties;
        self.all_hits += other.all_hits;
        self.disagreements.extend(other.disagreements);
        self
    }

    /// Prints the counts; fails where a tree disagreed, or where the rays prove nothing.
    pub fn verdict(self, scene: &str) {
        println!(
            "{scene}: {} rays, {} hit, {} with a tie, {} hits in all",
            self.rays, self.hits, self.ties, self.all_hits
        );
        let count = self.disagreements.len();
        assert_eq!(count, 0, "{scene}:\n{}", self.disagreements[..count.min(SPELT_OUT)].join("\n"));
        assert!(self.hits * 10 > self.rays, "{scene}: too few rays hit to prove anything");
        assert!(self.ties > 0, "{scene}: no ray met an edge or a vertex exactly");
    }
}

/// Every query of every tree on `SLIMKD_PARITY_RAYS` hard rays.
pub fn compare(mesh: &TriangleMesh, trees: &[(String, KdTree)]) -> Outcome {
    let (oracle, sieve) = (BruteForce::new(mesh), Sieve::new(mesh));
    let mut left = setting("SLIMKD_PARITY_RAYS", RAYS);
    let mut outcome = Outcome::default();
    for seed in 0.. {
        if left == 0 {
            break;
        }
        let rays = common::hard_rays(mesh, left.min(BATCH), seed);
        left -= rays.len();
        let groups = rays.par_chunks(GROUP).enumerate().map(|(group, rays)| {
            let answers = sieve.all_hits(rays).into_iter().zip(rays).enumerate().map(|(i, (all, ray))| {
                let whole = (group * GROUP + i).is_multiple_of(CROSS_CHECK);
                one(whole.then_some(&oracle), &all, trees, ray)
            });
            answers.fold(Outcome::default(), Outcome::and)
        });
        outcome = outcome.and(groups.reduce(Outcome::default, Outcome::and));
    }
    outcome
}

fn one(oracle: Option<&BruteForce<'_>>, all: &[Hit], trees: &[(String, KdTree)], ray: &Ray) -> Outcome {
    let closest = nearest(all);
    let hit = closest.is_some();
    let mut wrong = Vec::new();
    if let Some(oracle) = oracle {
        expect(&mut wrong, "oracle", "closest hit", bits(oracle.closest(ray)), bits(closest), ray);
        expect(&mut wrong, "oracle", "any hit", oracle.any(ray), hit, ray);
        expect(&mut wrong, "oracle", "all hits", list(&oracle.all(ray)), list(all), ray);
    }
    for (name, tree) in trees {
        expect(&mut wrong, name, "closest hit", bits(tree.closest(ray)), bits(closest), ray);
        expect(&mut wrong, name, "any hit", tree.any(ray), hit, ray);
        expect(&mut wrong, name, "all hits", list(&tree.all(ray)), list(all), ray);
    }
    let ties = closest.map_or(0, |best| all.iter().filter(|other| other.t == best.t).count());
    Outcome {
        rays: 1,
        hits: usize::from(hit),
        ties: usize::from(ties > 1),
        all_hits: all.len(),
        disagreements: wrong,
    }
}

fn expect<T: PartialEq + std::fmt::Debug>(
    wrong: &mut Vec<String>,
    tree: &str,
    query: &str,
    got: T,
    expected: T,
    ray: &Ray,
) {
    if got != expected {
        wrong.push(format!("{tree}: {query} of {ray:?}: {got:08x?}, not {expected:08x?}"));
    }
}

/// Smallest t, then the lowest id. Not simply the first: the list puts −0 before 0, for a closest hit they tie.
pub fn nearest(all: &[Hit]) -> Option<Hit> {
    let order = |a: &&Hit, b: &&Hit| a.t.partial_cmp(&b.t).unwrap().then(a.triangle.cmp(&b.triangle));
    all.iter().min_by(order).copied()
}

/// t, triangle, u, v bit by bit, in a hit file's order; a miss as there.
pub fn bits(hit: Option<Hit>) -> [u32; 4] {
    match hit {
        Some(hit) => [hit.t.to_bits(), hit.triangle, hit.u.to_bits(), hit.v.to_bits()],
        None => [f32::INFINITY.to_bits(), u32::MAX, 0, 0],
    }
}

fn list(hits: &[Hit]) -> Vec<[u32; 4]> {
    hits.iter().map(|&hit| bits(Some(hit))).collect()
}
