//! Polygons to triangles: a fan where the polygon is convex, ear clipping (the crate `earcut`) where it is not.
//!
//! A polygon of k corners always gives k − 2 triangles, so that ids can be foretold; with h holes it gives k + 2h − 2.
//! The plane is the one of Newell's normal (Sutherland, Sproull & Schumacker 1974); the coordinate along which that
//! normal is longest is left out, which needs no rounding. `earcut` leaves out corners that lie on a straight line; here
//! they are put back, by splitting the triangle at that edge, so that neighbours meet at common vertices.

use super::{LoadError, Loading, Progress};
use crate::{Warning, WarningKind, warning::warn};
use rayon::prelude::*;

/// Polygons of more corners stay fans, with a warning: ear clipping may take time that grows with their square.
const MOST_CORNERS: usize = 1 << 16;
/// How much larger the triangles' area may be than the polygon's before it counts as self-crossing.
const SURPLUS: f64 = 1e-6;
/// Polygons that a thread looks at between two looks at the progress.
const BLOCK: usize = 1 << 12;

/// The triangles of one polygon.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Triangulation {
    /// Corners of each triangle, counted through all rings.
    pub(super) triangles: Vec<[u32; 3]>,
    /// True when the outline crosses itself (or was too large to tell), so that the triangles are only a guess.
    pub(super) is_doubtful: bool,
}

/// Triangulates a polygon: the outer ring first, then its holes, each without its first corner repeated.
pub(super) fn triangulate(rings: &[Vec<[f64; 3]>]) -> Triangulation {
    let Some((outer, holes)) = rings.split_first() else { return Triangulation::default() };
    if holes.is_empty() {
        return of_ring(outer).unwrap_or_else(|| fan(outer.len()));
    }
    let corners: usize = rings.iter().map(Vec::len).sum();
    let wanted = (corners + 2 * holes.len()).saturating_sub(2);
    let mut found = with_holes(outer, holes)
        .unwrap_or_else(|| Triangulation { is_doubtful: corners > MOST_CORNERS, ..fan(outer.len()) });
    found.is_doubtful |= found.triangles.len() > wanted;
    found.triangles.resize(wanted.max(found.triangles.len()), [0; 3]);
    found
}

/// `None` for what has no area, or is not finite, or too large.
fn with_holes(outer: &[[f64; 3]], holes: &[Vec<[f64; 3]>]) -> Option<Triangulation> {
    let plane = Plane::of(outer)?;
    let rings = || std::iter::once(outer).chain(holes.iter().map(Vec::as_slice));
    let corners: Vec<[f64; 2]> = rings().flatten().map(|&corner| plane.project(corner)).collect();
    if corners.len() > MOST_CORNERS || corners.iter().flatten().any(|x| !x.is_finite()) {
        return None;
    }
    let mut ends = Vec::with_capacity(holes.len() + 1);
    let mut end = 0;
    for ring in rings() {
        end += ring.len() as u32;
        ends.push(end);
    }
    let mut flat = Vec::new();
    earcut::Earcut::new().earcut(corners.iter().copied(), &ends[..holes.len()], &mut flat);
    let mut triangles = flat.as_chunks::<3>().0.to_vec();
    let sum = turn_the_right_way(&corners, &mut triangles);
    let mut area = 0.0;
    for (k, &end) in ends.iter().enumerate() {
        let start = if k == 0 { 0 } else { ends[k - 1] };
        let ring = ring_area(&corners[start as usize..end as usize]).abs();
        area += if k == 0 { ring } else { -ring };
    }
    let is_doubtful = (sum - area).abs() > SURPLUS * sum;
    put_back(&ends, &mut triangles);
    Some(Triangulation { triangles, is_doubtful })
}

fn fan(corners: usize) -> Triangulation {
    let triangles = (2..corners as u32).map(|k| [0, k - 1, k]).collect();
    Triangulation { triangles, is_doubtful: false }
}

/// The plane in which a polygon is triangulated.
#[derive(Clone, Copy)]
struct Plane {
    /// The two coordinates that stay, in the order in which the polygon turns left.
    axes: [usize; 2],
}

impl Plane {
    /// `None` for what has no area or is not finite.
    fn of(ring: &[[f64; 3]]) -> Option<Self> {
        let origin = *ring.first()?;
        let mut normal = [0.0; 3];
        for (k, &a) in ring.iter().enumerate() {
            let b = ring[(k + 1) % ring.len()];
            for (axis, sum) in normal.iter_mut().enumerate() {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                *sum += (a[i] - origin[i]) * (b[j] - origin[j]) - (a[j] - origin[j]) * (b[i] - origin[i]);
            }
        }
        if normal.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let longest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs()))?;
        let (i, j) = ((longest + 1) % 3, (longest + 2) % 3);
        Some(Self { axes: if normal[longest] < 0.0 { [j, i] } else { [i, j] } })
    }

    fn project(self, corner: [f64; 3]) -> [f64; 2] {
        self.axes.map(|axis| corner[axis])
    }
}

/// Twice the signed area of a triangle.
fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Twice the signed area of a ring.
fn ring_area(ring: &[[f64; 2]]) -> f64 {
    ring.windows(2).skip(1).map(|pair| cross(ring[0], pair[0], pair[1])).sum()
}

/// Makes all triangles turn left; twice the sum of their areas.
fn turn_the_right_way(corners: &[[f64; 2]], triangles: &mut [[u32; 3]]) -> f64 {
    let mut sum = 0.0;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|k| corners[k as usize]);
        let area = cross(a, b, c);
        if area < 0.0 {
            triangle.swap(1, 2);
        }
        sum += area.abs();
    }
    sum
}

/// The triangles of a ring; `None`: its fan from the first corner is right.
fn of_ring(ring: &[[f64; 3]]) -> Option<Triangulation> {
    let k = ring.len();
    if k < 4 {
        return None;
    }
    let plane = Plane::of(ring)?;
    let corners: Vec<[f64; 2]> = ring.iter().map(|&corner| plane.project(corner)).collect();
    match shape(&corners) {
        Shape::Convex => None,
        Shape::Straight => best_fan(&corners),
        Shape::Other if k > MOST_CORNERS => Some(Triangulation { is_doubtful: true, ..fan(k) }),
        Shape::Other => Some(clip(&corners)),
    }
}

enum Shape {
    /// Convex, and each corner turns.
    Convex,
    /// Convex, with corners on straight lines or repeated ones.
    Straight,
    Other,
}

fn shape(corners: &[[f64; 2]]) -> Shape {
    let k = corners.len();
    let mut is_straight = false;
    // A convex outline changes its direction along an axis twice; a star changes it more often.
    let (mut signs, mut firsts, mut changes) = ([0.0; 2], [0.0; 2], [0; 2]);
    for i in 0..k {
        let (a, b, c) = (corners[i], corners[(i + 1) % k], corners[(i + 2) % k]);
        let turn = cross(a, b, c);
        if turn < 0.0 || turn.is_nan() {
            return Shape::Other;
        }
        is_straight |= turn == 0.0;
        for axis in 0..2 {
            let sign = (b[axis] - a[axis]).partial_cmp(&0.0).map_or(0.0, |order| f64::from(order as i8));
            if sign != 0.0 {
                changes[axis] += u32::from(signs[axis] != 0.0 && signs[axis] != sign);
                signs[axis] = sign;
                if firsts[axis] == 0.0 {
                    firsts[axis] = sign;
                }
            }
        }
    }
    for axis in 0..2 {
        changes[axis] += u32::from(signs[axis] != firsts[axis]);
    }
    match (changes.iter().any(|&count| count > 2), is_straight) {
        (true, _) => Shape::Other,
        (false, true) => Shape::Straight,
        (false, false) => Shape::Convex,
    }
}

/// The fan with the fewest triangles without area; corners on straight lines then belong to triangles with area.
fn best_fan(corners: &[[f64; 2]]) -> Option<Triangulation> {
    const MOST_TRIED: usize = 64;
    let k = corners.len();
    let flat = |apex: usize| {
        let at = |i: usize| corners[(apex + i) % k];
        (2..k).filter(|&i| cross(at(0), at(i - 1), at(i)) == 0.0).count()
    };
    let best = (0..k.min(MOST_TRIED)).min_by_key(|&apex| flat(apex)).filter(|&apex| apex > 0)? as u32;
    let k = k as u32;
    let triangles = (2..k).map(|i| [best, (best + i - 1) % k, (best + i) % k]).collect();
    Some(Triangulation { triangles, is_doubtful: false })
}

/// Ear clipping of a ring that turns left.
fn clip(corners: &[[f64; 2]]) -> Triangulation {
    let k = corners.len();
    if corners.iter().flatten().any(|x| !x.is_finite()) {
        return fan(k);
    }
    let mut flat: Vec<u32> = Vec::new();
    earcut::Earcut::new().earcut(corners.iter().copied(), &[], &mut flat);
    let mut triangles = flat.as_chunks::<3>().0.to_vec();
    let sum = turn_the_right_way(corners, &mut triangles);
    let is_doubtful = (sum - ring_area(corners).abs()).abs() > SURPLUS * sum;
    put_back(&[k as u32], &mut triangles);
    triangles.resize(triangles.len().max(k - 2), [0; 3]);
    if triangles.len() != k - 2 {
        return Triangulation { is_doubtful: true, ..fan(k) };
    }
    Triangulation { triangles, is_doubtful }
}

/// Puts the corners back that no triangle uses: each splits the triangle at the edge on which it lies. What finds no
/// such edge becomes a triangle without area. `ends` are those of the rings, the outer one first.
fn put_back(ends: &[u32], triangles: &mut Vec<[u32; 3]>) {
    let count = ends.last().copied().unwrap_or(0) as usize;
    let mut is_used = vec![false; count];
    for &corner in triangles.iter().flatten() {
        is_used[corner as usize] = true;
    }
    let missing = is_used.iter().filter(|&&used| !used).count();
    if missing == 0 {
        return;
    }
    // The triangle that has each directed edge, by its first corner and its second one.
    let mut edges = std::collections::HashMap::with_capacity(3 * triangles.len() + 2 * missing);
    for (id, triangle) in triangles.iter().enumerate() {
        for e in 0..3 {
            edges.insert((triangle[e], triangle[(e + 1) % 3]), id);
        }
    }
    let mut start = 0;
    for (ring, &end) in ends.iter().enumerate() {
        let k = end - start;
        match (start..end).find(|&corner| is_used[corner as usize]) {
            Some(first) => put_back_in(start, k, first, &mut is_used, &mut edges, triangles),
            None if ring == 0 => triangles.extend((2..k).map(|i| [0, i - 1, i])),
            // A hole that nothing is cut out for.
            None => {}
        }
        start = end;
    }
}

/// The same for the ring of `k` corners from `start` on, whose corner `first` is in use.
fn put_back_in(
    start: u32,
    k: u32,
    first: u32,
    is_used: &mut [bool],
    edges: &mut std::collections::HashMap<(u32, u32), usize>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let at = |i: u32| start + (first - start + i) % k;
    let mut before = first;
    // The next corner in use, found once for a whole row of missing ones.
    let mut next = None;
    for step in 1..k {
        let corner = at(step);
        if is_used[corner as usize] {
            (before, next) = (corner, None);
            continue;
        }
        let behind = || (1..=k).map(|i| at(step + i)).find(|&c| is_used[c as usize]).unwrap_or(first);
        let after = *next.get_or_insert_with(behind);
        let new = triangles.len();
        // A hole may turn either way.
        let forward = edges.remove(&(before, after));
        match forward.or_else(|| edges.remove(&(after, before))) {
            Some(id) => {
                let third = triangles[id].into_iter().find(|&c| c != before && c != after).unwrap_or(before);
                let (a, b) = if forward.is_some() { (before, after) } else { (after, before) };
                triangles[id] = [a, corner, third];
                triangles.push([corner, b, third]);
                for (id, triangle) in [(id, [a, corner, third]), (new, [corner, b, third])] {
                    for e in 0..3 {
                        edges.insert((triangle[e], triangle[(e + 1) % 3]), id);
                    }
                }
            }
            None => triangles.push([before, corner, after]),
        }
        is_used[corner as usize] = true;
        before = corner;
    }
}

/// Polygons that follow one another as fans in a list of triangles, and have equally many corners.
#[derive(Clone, Copy, Debug)]
struct Run {
    /// The first fan's first triangle.
    first: usize,
    corners: usize,
    count: usize,
}

/// The polygons of more than three corners while a file is read; they are fans until [`Polygons::mend`].
#[derive(Clone, Debug, Default)]
pub(super) struct Polygons {
    runs: Vec<Run>,
}

impl Polygons {
    /// Notes `count` polygons of `corners` corners whose fans begin at the triangle `first`.
    pub(super) fn add(&mut self, first: usize, corners: usize, count: usize) {
        if corners < 4 || count == 0 {
            return;
        }
        match self.runs.last_mut() {
            Some(run) if run.corners == corners && run.first + run.count * (corners - 2) == first => {
                run.count += count;
            }
            _ => self.runs.push(Run { first, corners, count }),
        }
    }

    /// Gives the polygons that are not convex their right triangles. `others` hold the corners' attributes, fan by fan as
    /// `triangles` does; one that is shorter than `triangles` lacks its last polygons.
    pub(super) fn mend(
        &self,
        positions: &[[f32; 3]],
        triangles: &mut [[u32; 3]],
        others: &mut [&mut [[u32; 3]]],
        warnings: &mut Vec<Warning>,
        progress: &Progress,
    ) -> Result<(), LoadError> {
        let fans: &[[u32; 3]] = triangles;
        let look = |run: &Run, polygon: usize| {
            let first = run.first + polygon * (run.corners - 2);
            let fan = &fans[first..first + run.corners - 2];
            let ring = ring(fan).map(|index| positions.get(index as usize).copied());
            let ring: Option<Vec<[f64; 3]>> = ring.map(|p| p.map(|p| p.map(f64::from))).collect();
            ring.and_then(|ring| of_ring(&ring)).map(|found| (first, found))
        };
        let (mut total, mut doubtful) = (0, 0);
        let mut found = Vec::new();
        for run in &self.runs {
            total += run.count as u64;
            if run.count < BLOCK {
                progress.reach(0.0)?;
                found.extend((0..run.count).filter_map(|polygon| look(run, polygon)));
                continue;
            }
            let blocks: Vec<usize> = (0..run.count).step_by(BLOCK).collect();
            let parts: Vec<Vec<_>> = blocks
                .into_par_iter()
                .map(|start| {
                    progress.reach(0.0)?;
                    let polygons = start..(start + BLOCK).min(run.count);
                    Ok(polygons.filter_map(|polygon| look(run, polygon)).collect())
                })
                .collect::<Result<_, LoadError>>()?;
            found.extend(parts.into_iter().flatten());
        }
        for (first, Triangulation { triangles: corners, is_doubtful }) in found {
            doubtful += u64::from(is_doubtful);
            let range = first..first + corners.len();
            let all = std::iter::once(&mut *triangles).chain(others.iter_mut().map(|other| &mut **other));
            for list in all {
                let Some(fan) = list.get_mut(range.clone()) else { continue };
                let ring: Vec<u32> = ring(fan).collect();
                for (triangle, corners) in fan.iter_mut().zip(&corners) {
                    *triangle = corners.map(|corner| ring[corner as usize]);
                }
            }
        }
        if doubtful > 0 {
            let what = "polygons cross themselves, and their triangles are a guess";
            warn(warnings, Warning::counted(WarningKind::Polygon, doubtful, total, what));
        }
        Ok(())
    }
}

/// The corners that a fan was made of.
fn ring(fan: &[[u32; 3]]) -> impl Iterator<Item = u32> + '_ {
    let start = fan.first().map(|first| [first[0], first[1]]).into_iter().flatten();
    start.chain(fan.iter().map(|triangle| triangle[2]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[[f64; 2]]) -> Vec<[f64; 3]> {
        corners.iter().map(|&[x, y]| [x, y, 0.5 * x]).collect()
    }

    fn area(corners: &[[f64; 2]], found: &Triangulation) -> f64 {
        let at = |k: u32| corners[k as usize];
        found.triangles.iter().map(|&[a, b, c]| 0.5 * cross(at(a), at(b), at(c)).abs()).sum()
    }

    #[test]
    fn convex_ones_stay_fans() {
        let square = ring(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(triangulate(&[square]).triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_ones_have_their_area_and_every_corner() {
        // An arrow, an L with corners on its edges, and one whose first corner comes again at the end.
        let cases: [(&[[f64; 2]], f64); 3] = [
            (&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]], 1.0),
            (
                &[
                    [0.0, 0.0],
                    [1.0, 0.0],
                    [2.0, 0.0],
                    [2.0, 1.0],
                    [1.0, 1.0],
                    [1.0, 2.0],
                    [0.0, 2.0],
                    [0.0, 1.0],
                ],
                3.0,
            ),
            (&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0], [0.0, 0.0]], 1.0),
        ];
        for (corners, right) in cases {
            for turned in [false, true] {
                let mut corners = corners.to_vec();
                if turned {
                    corners.reverse();
                }
                let found = triangulate(&[ring(&corners)]);
                assert_eq!(found.triangles.len(), corners.len() - 2);
                assert!(!found.is_doubtful);
                assert!((area(&corners, &found) - right).abs() < 1e-12, "{found:?}");
                for corner in 0..corners.len() as u32 {
                    assert!(found.triangles.iter().flatten().any(|&c| c == corner), "{corner}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn straight_corners_apart_from_each_other_are_put_back_in_their_own_places() {
        // A comb with a corner in the middle of every edge.
        let comb = [
            [0.0, 0.0],
            [12.0, 0.0],
            [12.0, 8.0],
            [8.0, 8.0],
            [8.0, 4.0],
            [4.0, 4.0],
            [4.0, 8.0],
            [0.0, 8.0],
        ];
        for start in 0..8 {
            for turned in [false, true] {
                let at = |k: usize| comb[(start + k) % 8];
                let mut corners: Vec<[f64; 2]> = (0..8)
                    .flat_map(|k| {
                        let (a, b) = (at(k), at(k + 1));
                        [a, [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]]
                    })
                    .collect();
                if turned {
                    corners.reverse();
                }
                let found = triangulate(&[ring(&corners)]);
                assert_eq!((found.triangles.len(), area(&corners, &found)), (14, 80.0), "{found:?}");
                let at = |k: u32| corners[k as usize];
                let flat = |&&[a, b, c]: &&[u32; 3]| cross(at(a), at(b), at(c)) == 0.0;
                assert_eq!(found.triangles.iter().filter(flat).count(), 0, "{found:?}");
            }
        }
    }

    #[test]
    fn a_corner_on_an_edge_belongs_to_a_triangle_with_area() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let found = triangulate(&[ring(&corners)]);
        let at = |k: u32| corners[k as usize];
        assert!(found.triangles.iter().all(|&[a, b, c]| cross(at(a), at(b), at(c)) > 0.0), "{found:?}");
        assert_eq!(area(&corners, &found), 4.0);
    }

    #[test]
    fn what_crosses_itself_is_doubtful() {
        let bow = ring(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]]);
        let found = triangulate(&[bow]);
        assert!(found.is_doubtful && found.triangles.len() == 2);
        let star = ring(&[[0.0, 3.0], [2.0, -3.0], [-3.0, 1.0], [3.0, 1.0], [-2.0, -3.0]]);
        let found = triangulate(&[star]);
        assert!(found.is_doubtful && found.triangles.len() == 3);
    }

    #[test]
    fn holes_are_left_out() {
        let square = |a: f64, b: f64| ring(&[[a, a], [b, a], [b, b], [a, b]]);
        let found = triangulate(&[square(0.0, 4.0), square(1.0, 2.0)]);
        let corners =
            [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]];
        assert_eq!((found.triangles.len(), area(&corners, &found)), (8, 15.0));
        assert!(!found.is_doubtful);
    }

    #[test]
    fn corners_on_the_edges_of_holes_are_kept() {
        let outer = [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let hole = [[1.0, 1.0], [1.0, 1.5], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]];
        for turned in [false, true] {
            let mut hole = hole;
            if turned {
                hole.reverse();
            }
            let found = triangulate(&[ring(&outer), ring(&hole)]);
            let corners = [outer, hole].concat();
            assert_eq!((found.triangles.len(), area(&corners, &found)), (10, 15.0));
            for corner in 0..10 {
                let has = |t: &&[u32; 3]| {
                    t.contains(&corner)
                        && cross(corners[t[0] as usize], corners[t[1] as usize], corners[t[2] as usize]) > 0.0
                };
                assert!(found.triangles.iter().any(|t| has(&t)), "{corner}: {found:?}");
            }
        }
    }

    #[test]
    fn odd_numbers_stay_fans() {
        for odd in [f64::NAN, f64::INFINITY] {
            assert_eq!(triangulate(&[vec![[odd; 3]; 5]]).triangles.len(), 3);
        }
        assert_eq!(triangulate(&[vec![[1.0; 3]; 6]]).triangles.len(), 4);
        assert!(triangulate(&[]).triangles.is_empty());
    }
}
