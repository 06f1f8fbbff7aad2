//! What is inside the court: paving, beds, hedges, trees, pots, benches, the fountain, strings of lamps.

use super::{BED, COURT, Paints};
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around, noise, sin_cos};
use crate::procedural::shapes::Leaf;
use crate::procedural::tree::{self, Habit};
use glam::{Vec3, vec2, vec3};

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    paving(b, p);
    fountain(b, p);
    for (k, (x, z)) in [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].into_iter().enumerate() {
        bed(b, p, x, z);
        let middle = 0.5 * (BED.0 + BED.1);
        let habit = Habit {
            trunk: [1.45, 1.7, 1.75, 1.5][k],
            girth: [0.15, 0.18, 0.19, 0.16][k],
            leaves: [15_000.0, 20_000.0, 24_000.0, 18_000.0][k],
            leaf: [0.11, 0.12, 0.12, 0.13][k],
        };
        let shift = if k == 0 { 0.9 } else { 0.0 };
        b.within(Frame::at(x * (middle + shift), 0.05, z * (middle - shift)), |b| {
            tree::draw(b, p.bark, [p.leaf, p.leaf_light], habit)
        });
    }
    for side in 0..4 {
        b.within(Frame::IDENTITY.turned(0.25 * TURN * side as f32), |b| {
            if !b.has(0.04) {
                return;
            }
            for k in [-2.5f32, -0.5, 0.5, 2.5] {
                b.within(Frame::at(3.0 * k, 0.0, -COURT + 0.75), |b| pot(b, p));
            }
            b.within(Frame::at(0.0, 0.0, -COURT + 1.9), |b| bench(b, p));
            ivy(b, p);
        });
    }
    lamps(b, p);
}

/// Cobbles in the cross of paths and around the beds; a plain ground lies under them.
fn paving(b: &mut Builder, p: &Paints) {
    let size = 2.0 * COURT - 0.5;
    b.paint(p.stone_dark).quad(vec3(-0.5 * size, 0.0, -0.5 * size), Vec3::Z * size, Vec3::X * size);
    if !b.has(0.15) {
        return;
    }
    let spacing = (0.24 / b.detail.sqrt()).clamp(0.11, 0.5);
    let rows = (size / spacing) as u32;
    let n = b.segments(3.2, 2);
    let mut rng = b.rng.fork();
    for j in 0..rows {
        for i in 0..rows {
            // Broken joints, as masons lay them.
            let shift = if j % 2 == 0 { 0.25 } else { 0.75 };
            let (x, z) = (spacing * (i as f32 + shift) - 0.5 * size, spacing * (j as f32 + 0.5) - 0.5 * size);
            let shade = rng.below(3);
            let (height, angle) = (rng.range(0.012, 0.03), 0.12 * rng.signed());
            let inside = |c: f32| c > BED.0 - 0.12 && c < BED.1 + 0.12;
            if (inside(x.abs()) && inside(z.abs())) || x * x + z * z < 5.0 {
                continue;
            }
            b.paint(match shade {
                0 => p.cobble_light,
                1 => p.cobble,
                _ => p.stone_dark,
            });
            b.within(Frame::at(x, 0.0, z).turned(angle), |b| {
                let half = 0.47 * spacing;
                b.patch(n, n, Closure::OPEN, |u, v| {
                    let (s, t) = (2.0 * u - 1.0, 2.0 * v - 1.0);
                    let (ss, tt) = (s * s, t * t);
                    let dome = (1.0 - ss * ss) * (1.0 - tt * tt);
                    let slope =
                        vec3(4.0 * s * ss * (1.0 - tt * tt), half / height, 4.0 * t * tt * (1.0 - ss * ss));
                    (
                        vec3(half * s * (1.0 - 0.1 * tt), height * dome + 0.002, half * t * (1.0 - 0.1 * ss)),
                        slope,
                    )
                });
            });
        }
    }
}

/// A bed in one quarter: a stone curb, soil, grass, a hedge around it, flowers.
fn bed(b: &mut Builder, p: &Paints, x: f32, z: f32) {
    let (near, far) = BED;
    let span = |a: f32, c: f32, e: f32, f: f32, y0: f32, y1: f32| {
        let (u, v) = (vec3(x * a, y0, z * e), vec3(x * c, y1, z * f));
        (u.min(v), u.max(v))
    };
    let curb = 0.14;
    let curbs = if b.has(0.03) { 4 } else { 0 };
    b.paint(p.stone);
    for (a, c, e, f) in [
        (near, far, near, near + curb),
        (near, far, far - curb, far),
        (near, near + curb, near + curb, far - curb),
        (far - curb, far, near + curb, far - curb),
    ]
    .into_iter()
    .take(curbs)
    {
        let (min, max) = span(a, c, e, f, 0.0, 0.13);
        b.cuboid(min, max);
    }
    let (min, max) = span(near + curb, far - curb, near + curb, far - curb, 0.0, 0.06);
    b.paint(p.soil).quad(vec3(min.x, max.y, min.z), Vec3::Z * (max.z - min.z), Vec3::X * (max.x - min.x));
    let blades = b.count(16_000.0, 0, 1_500_000) as usize;
    b.paint(p.grass).blades(blades, 0.009, |rng| {
        let root = rng.point(min, max).with_y(max.y);
        let lean = rng.direction() * 0.05;
        (root, vec3(lean.x, rng.range(0.06, 0.15), lean.z))
    });
    let (a, c) = (near + 0.25, far - 0.25);
    for (a, c, e, f) in [(a, c, a, a + 0.32), (a, c, c - 0.32, c), (a, a + 0.32, a, c), (c - 0.32, c, a, c)] {
        let (min, max) = span(a, c, e, f, 0.06, 0.50);
        hedge(b, p, min, max);
    }
    let flowers = b.count(700.0, 0, 60_000) as usize;
    for (paint, colour) in [(p.flower, 0.0), (p.flower_white, 0.5)] {
        b.paint(paint).leaves(flowers, |rng| {
            let angle = TURN * (rng.unit() * 0.5 + colour) * 1.0;
            let root = vec3(0.5 * x * (near + far), 0.0, 0.5 * z * (near + far))
                + around(angle) * rng.range(0.55, 1.25);
            let base = root + Vec3::Y * rng.range(0.12, 0.28);
            Leaf::scattered(rng, base, 0.06, 0.3)
        });
    }
}

/// A clipped hedge: a dark core and leaves on its skin.
fn hedge(b: &mut Builder, p: &Paints, min: Vec3, max: Vec3) {
    let core = Vec3::splat(0.03);
    b.paint(p.hedge).cuboid(min + core.with_y(0.0), max - core);
    let count = b.count(2_400.0, 0, 220_000);
    let size = 0.05 * (2_400.0 / count.max(1) as f32).sqrt().sqrt().clamp(0.6, 2.4);
    for paint in [p.leaf, p.leaf_light] {
        b.paint(paint).leaves(count as usize / 2, |rng| {
            let mut at = rng.point(min, max);
            match rng.below(5) {
                0 => at.x = min.x,
                1 => at.x = max.x,
                2 => at.z = min.z,
                3 => at.z = max.z,
                _ => at.y = max.y,
            }
            let base = at + rng.direction() * 0.015;
            Leaf::scattered(rng, base, size, 0.3)
        });
    }
}

/// A terracotta pot with a round shrub.
fn pot(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(44.0, 4), b.segments(28.0, 1));
    let profile = [
        vec2(0.15, 0.0),
        vec2(0.18, 0.06),
        vec2(0.25, 0.36),
        vec2(0.28, 0.38),
        vec2(0.28, 0.45),
        vec2(0.23, 0.44),
        vec2(0.22, 0.38),
        vec2(0.0, 0.38),
    ];
    b.paint(p.clay).lathe(&profile, n, m);
    let count = b.count(1_100.0, 10, 100_000);
    let size = 0.10 * (1_100.0 / count as f32).sqrt().sqrt().clamp(0.6, 2.4);
    b.paint(p.leaf).leaves(count as usize, |rng| {
        let out = rng.direction();
        let base = vec3(0.0, 0.72, 0.0) + out * (0.36 * (0.5 + 0.5 * rng.unit().sqrt()));
        Leaf::scattered(rng, base, size, 0.4)
    });
}

/// A bench of long slats on iron feet.
fn bench(b: &mut Builder, p: &Paints) {
    b.paint(p.wood);
    for k in 0..5 {
        let z = -0.2 + 0.1 * k as f32;
        b.cuboid(vec3(-0.85, 0.43, z - 0.04), vec3(0.85, 0.455, z + 0.04));
    }
    for k in 0..3 {
        let y = 0.58 + 0.13 * k as f32;
        b.beam(vec3(-0.85, y, -0.27 - 0.03 * k as f32), vec3(0.85, y, -0.27 - 0.03 * k as f32), 0.025, 0.09);
    }
    let (n, m) = (b.segments(12.0, 3), b.segments(8.0, 1));
    b.paint(p.iron);
    for x in [-0.7, 0.7] {
        b.pipe(
            &[vec3(x, 0.0, 0.22), vec3(x, 0.43, 0.20), vec3(x, 0.43, -0.22), vec3(x, 0.92, -0.36)],
            0.02,
            0.08,
            n,
            m,
        );
        b.cone(vec3(x, 0.0, -0.25), vec3(x, 0.43, -0.20), 0.02, 0.02, n, false);
    }
}

/// Ivy that climbs from the ground past the string course.
fn ivy(b: &mut Builder, p: &Paints) {
    let count = b.count(3_000.0, 0, 250_000);
    let size = 0.10 * (3_000.0 / count.max(1) as f32).sqrt().sqrt().clamp(0.6, 2.0);
    b.paint(p.leaf).leaves(count as usize, |rng| {
        // Dense where it is old, in fingers where it is young.
        let t = rng.unit();
        let y = 0.4 + 6.6 * t * (1.2 - 0.4 * t);
        let finger = noise(vec3(0.9 * y, 3.0, 0.0)) * 0.9 + noise(vec3(2.7 * y, 9.0, 4.0)) * 0.4;
        let spread = 0.25 + 1.1 * (1.0 - t) * t + 0.35 * noise(vec3(0.0, 1.7 * y, 0.0));
        let x = 3.0 + finger * t + rng.signed() * spread.max(0.12);
        let z = -COURT + 0.34 + 0.08 * rng.unit();
        Leaf::scattered(rng, vec3(x, y, z), size, 0.9)
    });
}

/// A round basin, a bowl on a stem, falling water.
fn fountain(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(150.0, 8), b.segments(40.0, 1));
    b.paint(p.stone);
    let basin = [
        vec2(2.0, 0.0),
        vec2(2.02, 0.10),
        vec2(1.86, 0.22),
        vec2(1.88, 0.46),
        vec2(1.98, 0.50),
        vec2(1.96, 0.56),
        vec2(1.66, 0.56),
        vec2(1.64, 0.48),
        vec2(1.60, 0.12),
        vec2(0.0, 0.10),
    ];
    b.lathe(&basin, n, m);
    let stem = [
        vec2(0.34, 0.1),
        vec2(0.30, 0.3),
        vec2(0.14, 0.55),
        vec2(0.18, 0.9),
        vec2(0.12, 1.15),
        vec2(0.2, 1.3),
    ];
    b.lathe(&stem, n / 2, m);
    let bowl = [
        vec2(0.16, 1.26),
        vec2(0.5, 1.36),
        vec2(0.82, 1.55),
        vec2(0.84, 1.6),
        vec2(0.78, 1.6),
        vec2(0.45, 1.46),
        vec2(0.0, 1.42),
    ];
    b.lathe(&bowl, n * 2 / 3, m);
    b.lathe(&[vec2(0.12, 1.42), vec2(0.06, 1.7), vec2(0.09, 1.9), vec2(0.0, 2.02)], n / 3, m);
    // Rippled water: the basin's, with depth, and the bowl's.
    let rings = b.segments(70.0, 1);
    let fan = Closure { ring: true, first_pole: true, last_pole: false };
    b.paint(p.water);
    for (y, radius, height) in [(0.46f32, 1.66f32, 0.010f32), (1.57, 0.80, 0.004)] {
        b.patch(n, rings, fan, |u, v| {
            let (s, c) = sin_cos(TURN * 7.0 * v);
            let fade = v * (1.0 - v) * 4.0;
            let slope = -height * fade * c * TURN * 7.0 / radius;
            (
                around(TURN * u) * (radius * v) + Vec3::Y * (y + height * fade * s),
                Vec3::Y + around(TURN * u) * slope,
            )
        });
    }
    // Jets: thin parabolas, from the top into the bowl and from the bowl into the basin.
    let jets = if b.has(0.1) {
        16
    } else if b.has(0.035) {
        6
    } else {
        0
    };
    let (sides, steps) = (b.segments(8.0, 3), b.segments(18.0, 3));
    b.paint(p.spray);
    for k in 0..2 * jets {
        let high = k < jets;
        let out = around(TURN * (k as f32 + 0.5) / jets as f32);
        let (r0, r1, y0, y1, rise) =
            if high { (0.02, 0.55, 2.0, 1.56, 0.35) } else { (0.80, 1.25, 1.59, 0.46, 0.02) };
        let path: Vec<Vec3> = (0..=steps)
            .map(|i| {
                let t = i as f32 / steps as f32;
                out * (r0 + (r1 - r0) * t) + Vec3::Y * (y0 + (y1 - y0) * t * t + 4.0 * rise * t * (1.0 - t))
            })
            .collect();
        b.tube_by(&path, sides, |i| 0.011 - 0.006 * i as f32 / steps as f32);
    }
}

/// Strings of lamps from gallery to gallery, crossing the court aslant.
fn lamps(b: &mut Builder, p: &Paints) {
    if !b.has(0.03) {
        return;
    }
    let (n, m) = (b.segments(6.0, 3), b.segments(30.0, 4));
    let (y, e) = (LEVEL, COURT - 0.3);
    let bulbs = if b.has(0.15) { 14 } else { 0 };
    let segments = b.segments(18.0, 4);
    for (a, c) in [
        (vec3(-e, y, -6.0), vec3(6.0, y, e)),
        (vec3(-e, y, 2.0), vec3(2.0, y, -e)),
        (vec3(-3.0, y, e), vec3(e, y, -3.0)),
        (vec3(-e, y, 6.0), vec3(e, y, -6.0)),
    ] {
        b.paint(p.iron).cable(a, c, 0.9, 0.008, n, m);
        b.paint(p.bulb);
        for k in 1..=bulbs {
            let t = k as f32 / (bulbs + 1) as f32;
            let at = a.lerp(c, t) - Vec3::Y * (3.6 * t * (1.0 - t) + 0.07);
            b.ball(at, vec3(0.04, 0.055, 0.04), segments);
        }
    }
}

/// Height at which the strings are tied, metres.
const LEVEL: f32 = 5.3;
