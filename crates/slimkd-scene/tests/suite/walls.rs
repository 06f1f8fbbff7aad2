//! Walls far from 0, in world coordinates, against exact arithmetic.
//!
//! The walls of one test run are few; `scripts/walls` takes as many as one likes (`SLIMKD_WALLS`).

use slimkd::{KdTree, Preset, RayF64, Tracer};
use slimkd_scene::{Format, load_bytes};
use slimkd_util::Rng;

fn unit(rng: &mut Rng) -> f64 {
    (rng.bits() >> 11) as f64 / (1u64 << 53) as f64
}

/// From −most to most.
fn within(rng: &mut Rng, most: f64) -> i128 {
    ((2.0 * unit(rng) - 1.0) * most).round() as i128
}

type Point = [i128; 3];

fn sub(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn length(a: Point) -> f64 {
    a.iter().map(|&x| (x as f64).powi(2)).sum::<f64>().sqrt()
}

/// Micrometres as metres, in decimals.
fn decimal(x: i128) -> String {
    let sign = if x < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", x.abs() / 1_000_000, x.abs() % 1_000_000)
}

/// A wall, and a ray near it. In micrometres, so that whole numbers decide what is hit.
struct Case {
    corner: Point,
    edges: [Point; 2],
    start: Point,
    direction: Point,
}

impl Case {
    /// From 10⁵ to 10⁷ m away, of 1 mm to 1 km.
    fn new(rng: &mut Rng) -> Self {
        let away = 1e6 * 10f64.powf(5.0 + 2.0 * unit(rng));
        let size = 1e6 * 10f64.powf(-3.0 + 6.0 * unit(rng));
        let corner = std::array::from_fn(|k| if k == 2 { within(rng, 1e9) } else { within(rng, away) });
        let mut edge = || -> Point {
            loop {
                let edge = [(); 3].map(|()| within(rng, size));
                if length(edge) > 0.3 * size {
                    break edge;
                }
            }
        };
        let edges = loop {
            let edges = [edge(), edge()];
            if length(cross(edges[0], edges[1])) > 0.05 * length(edges[0]) * length(edges[1]) {
                break edges;
            }
        };
        let (s, t) = (0.1 + 0.8 * unit(rng), 0.1 + 0.8 * unit(rng));
        let on: Point = std::array::from_fn(|k| {
            corner[k] + (s * edges[0][k] as f64 + t * edges[1][k] as f64).round() as i128
        });
        let normal = cross(edges[0], edges[1]);
        let scale = length(normal).max(1.0);
        // How far the ray starts from the wall: from a millionth of its size to its size.
        let far = size * 10f64.powf(-6.0 * unit(rng)) * if rng.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let start = std::array::from_fn(|k| on[k] + (far * normal[k] as f64 / scale).round() as i128);
        let direction = match rng.bits() % 4 {
            0 => normal.map(|x| (1e6 * x as f64 / scale).round() as i128),
            1 => normal.map(|x| (-1e6 * x as f64 / scale).round() as i128),
            2 => sub(on, start),
            _ => [(); 3].map(|()| within(rng, 1e6)),
        };
        Self { corner, edges, start, direction }
    }

    fn obj(&self) -> String {
        let [e, f] = self.edges;
        let corner = |s: i128, t: i128| -> String {
            let p: Point = std::array::from_fn(|k| self.corner[k] + s * e[k] + t * f[k]);
            format!("v {} {} {}\n", decimal(p[0]), decimal(p[1]), decimal(p[2]))
        };
        [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1), "f 1 2 3 4\n".into()].concat()
    }

    /// Where the ray meets the wall, in units of its direction; the outer `None` where less than `near` micrometres decide that.
    fn truth(&self, near: f64) -> Option<Option<f64>> {
        let [e, f] = self.edges;
        let normal = cross(e, f);
        let to = sub(self.corner, self.start);
        if self.direction == [0; 3] {
            return None;
        }
        let (above, below) = (dot(to, normal), dot(self.direction, normal));
        // Both are below 2¹²⁷: 2³¹ for what is relative to the wall, cubed, times 6.
        if (above as f64).abs() < near * length(normal)
            || (below as f64).abs() < 1e-2 * length(normal) * length(self.direction)
        {
            return None;
        }
        if (above < 0) != (below < 0) {
            return Some(None);
        }
        // Weights of the edges at the crossing, as parts of below · normal².
        let t = above as f64 / below as f64;
        let seen = [0, 1, 2].map(|k| t * self.direction[k] as f64 - to[k] as f64);
        let square = length(normal).powi(2);
        let part = |a: [f64; 3], b: Point| {
            let b = b.map(|x| x as f64);
            let cross: [f64; 3] =
                std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
            (0..3).map(|k| cross[k] * normal[k] as f64).sum::<f64>() / square
        };
        let weights = [part(seen, f), -part(seen, e)];
        let margin = weights.iter().map(|w| w.min(1.0 - w)).fold(f64::INFINITY, f64::min);
        // A part of an edge is decided by the rounding of corners, which is far below a hundredth of it.
        if margin.abs() < 1e-2 { None } else { Some((margin > 0.0).then_some(t)) }
    }
}

#[test]
fn met_from_the_right_side() {
    let cases: u64 =
        std::env::var("SLIMKD_WALLS").map_or(3000, |n| n.parse().expect("SLIMKD_WALLS is a number"));
    let mut rng = Rng::new(5);
    let (mut decided, mut hits) = (0u64, 0u64);
    for case in 0..cases {
        let wall = Case::new(&mut rng);
        let scene = load_bytes(Format::Obj, wall.obj().as_bytes()).unwrap();
        let preset = Preset::ALL[case as usize % Preset::ALL.len()];
        let tree = KdTree::build(scene.mesh.clone(), &preset.into()).unwrap();
        // The ray's decimals are rounded to f64 as well: below 2⁻²⁹ m.
        let largest = scene.mesh.vertices().as_flattened().iter().fold(0f32, |most, x| most.max(x.abs()));
        // Near 0 it is not measured.
        let moved = if scene.mesh.origin() == [0.0; 3] {
            f64::from(largest) * 2f64.powi(-23)
        } else {
            scene.rounding
        };
        let rounding = 1e6 * moved + 0.01;
        let metres = |p: Point| p.map(|x| decimal(x).parse::<f64>().unwrap());
        let ray = RayF64::new(metres(wall.start), wall.direction.map(|x| x as f64 * 1e-6));
        let Some(truth) = wall.truth(2.0 * rounding) else { continue };
        decided += 1;
        hits += u64::from(truth.is_some());
        let hit = tree.closest_f64(&ray);
        assert_eq!(hit.is_some(), truth.is_some(), "case {case}: {ray:?} at\n{}", wall.obj());
        assert_eq!(tree.any_f64(&ray), truth.is_some(), "case {case}");
        if let (Some(hit), Some(truth)) = (hit, truth) {
            // A hundredth of a radian at least between ray and wall, and corners that moved by the rounding.
            let apart = (hit.t - truth).abs() * length(wall.direction);
            assert!(
                apart <= 2000.0 * rounding,
                "case {case}: {hit:?} is not {truth}, {rounding}, {ray:?} at\n{}",
                wall.obj()
            );
        }
    }
    println!("{decided} of {cases} walls decided, {hits} hit: none wrong");
    assert!(decided * 10 > cases * 6 && hits * 4 > decided && hits * 4 < decided * 3, "{decided} {hits}");
}
