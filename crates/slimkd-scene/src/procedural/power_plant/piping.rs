//! Pipe racks: tiers of pipes on portal frames, flanges, valves, branches to the turbines, cable trays.

use super::{Paints, steelwork};
use crate::procedural::builder::{Builder, Paint};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec3, vec2, vec3};

/// The rack along x: its ends, its middle in z, half its width, the height of its tiers; metres.
const FROM: f32 = -2.0;
const TO: f32 = 46.0;
const MIDDLE: f32 = 13.6;
const HALF: f32 = 2.2;
const TIERS: [f32; 3] = [3.2, 4.6, 6.0];

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    portals(b, p);
    let mut rng = b.rng.fork();
    let lanes = if b.has(0.05) { 9 } else { 3 };
    let (n, bend) = (b.segments(44.0, 4), b.segments(16.0, 1));
    for (tier, y) in TIERS.into_iter().enumerate().take(if b.has(0.04) { 3 } else { 1 }) {
        for lane in 0..lanes {
            let z = MIDDLE - HALF + 0.35 + (2.0 * HALF - 0.7) * lane as f32 / (lanes - 1) as f32;
            let radius = [0.08, 0.16, 0.06, 0.20, 0.10, 0.12, 0.05][(3 * tier + 2 * lane) % 7];
            let paint = paint_of(p, tier * 5 + lane);
            let y = y + radius + 0.1;
            b.paint(paint);
            if tier == 2 && lane % 3 == 1 {
                // A loop that takes up the heat: out of the plane and back.
                let x = 14.0 + 1.1 * lane as f32;
                let path = [
                    vec3(FROM, y, z),
                    vec3(x, y, z),
                    vec3(x, y + 1.9, z),
                    vec3(x + 2.6, y + 1.9, z),
                    vec3(x + 2.6, y, z),
                    vec3(TO, y, z),
                ];
                b.pipe(&path, radius, 3.0 * radius, n, bend);
            } else if (lane + tier) % 2 == 0 {
                let x = 6.0 + 22.0 * rng.unit();
                branch(b, p, vec3(x, y, z), radius, n, bend);
                b.paint(paint).cone(vec3(FROM, y, z), vec3(TO, y, z), radius, radius, n, true);
            } else {
                let down = 38.0 + 6.0 * rng.unit();
                b.pipe(
                    &[vec3(FROM, y, z), vec3(down, y, z), vec3(down, 0.0, z)],
                    radius,
                    3.0 * radius,
                    n,
                    bend,
                );
            }
            for k in 0..7 {
                let x = FROM + 2.0 + 6.0 * k as f32 + 1.5 * rng.unit();
                steelwork::flange(b, p, vec3(x, y, z), Vec3::X, radius);
            }
            if lane % 3 == 0 {
                steelwork::valve(
                    b,
                    p,
                    vec3(9.0 + 8.0 * tier as f32 + 2.0 * rng.unit(), y, z),
                    Vec3::X,
                    radius,
                );
            }
        }
    }
    headers(b, p, n, bend);
    trays(b, p);
    pumps(b, p);
}

fn paint_of(p: &Paints, k: usize) -> Paint {
    [p.lagging, p.red, p.blue, p.lagging, p.green, p.yellow, p.lagging, p.copper][k % 8]
}

/// A pipe that leaves the rack towards the turbine deck: up, across, aslant down.
fn branch(b: &mut Builder, p: &Paints, at: Vec3, radius: f32, n: u32, bend: u32) {
    let up = at.y.max(TIERS[2]) + 1.0;
    let r = 0.8 * radius;
    let path =
        [at, at.with_y(up), vec3(at.x, up, 9.2), vec3(at.x + 1.2, 3.6, 8.4), vec3(at.x + 1.2, 3.2, 2.0)];
    b.pipe(&path, r, 4.0 * radius, n, bend);
    steelwork::flange(b, p, at.with_y(up - 0.5), Vec3::Y, r);
    steelwork::flange(b, p, vec3(at.x, up, 10.6), Vec3::Z, r);
    steelwork::valve(b, p, vec3(at.x, up, 11.4), Vec3::Z, r);
}

/// Portal frames with diagonal bracing under the tiers.
fn portals(b: &mut Builder, p: &Paints) {
    let count = if b.has(0.05) { 9 } else { 4 };
    let fine = b.has(0.07);
    let top = TIERS[2];
    let at = |k: u32| FROM + 1.0 + (TO - FROM - 2.0) * k as f32 / (count - 1) as f32;
    b.paint(p.galvanised);
    for k in 0..count {
        let x = at(k);
        for z in [MIDDLE - HALF, MIDDLE + HALF] {
            let (foot, head) = (vec3(x, 0.0, z), vec3(x, top + 0.4, z));
            if fine { b.girder(foot, head, 0.26) } else { b.beam(foot, head, 0.24, 0.24) }
        }
        for y in TIERS {
            let (a, c) = (vec3(x, y - 0.05, MIDDLE - HALF), vec3(x, y - 0.05, MIDDLE + HALF));
            if fine { b.girder(a, c, 0.22) } else { b.beam(a, c, 0.2, 0.2) }
        }
        if k > 0 && fine {
            for z in [MIDDLE - HALF, MIDDLE + HALF] {
                if k % 2 == 0 {
                    b.beam(vec3(at(k - 1), 0.0, z), vec3(x, top, z), 0.09, 0.09);
                    b.beam(vec3(x, 0.0, z), vec3(at(k - 1), top, z), 0.085, 0.085);
                }
            }
        }
    }
    for z in [MIDDLE - HALF, MIDDLE + HALF] {
        for y in TIERS {
            b.beam(vec3(FROM, y - 0.2, z), vec3(TO, y - 0.2, z), 0.12, 0.16);
        }
    }
}

/// Big lagged steam lines from the boiler's drum down to the deck.
fn headers(b: &mut Builder, p: &Paints, n: u32, bend: u32) {
    let count = if b.has(0.04) { 4 } else { 1 };
    for k in 0..count {
        let z = -8.6 + 4.4 * k as f32;
        let y = 26.5 - 2.4 * k as f32;
        let x = 0.6 + 0.25 * k as f32;
        let path = [
            vec3(-6.8, y, z),
            vec3(x, y, z),
            vec3(x, 7.4, z - 0.4),
            vec3(5.4, 7.4, z - 0.4),
            vec3(8.4, 7.9, if k < 2 { -5.4 } else { 3.4 }),
        ];
        b.paint(p.lagging).pipe(&path, 0.38, 1.3, 2 * n, 2 * bend);
        for j in 0..5 {
            let t = (j as f32 + 0.5) / 5.0;
            let at = path[1].lerp(path[2], t);
            steelwork::flange(b, p, at, path[2] - path[1], 0.38);
        }
        steelwork::valve(b, p, vec3(3.2, 7.4, z - 0.4), Vec3::X, 0.36);
        // Spring hangers.
        b.paint(p.dark);
        for j in 0..3 {
            let at = path[0].lerp(path[1], (j as f32 + 0.5) / 3.0);
            b.cone(at, at + vec3(0.0, 3.0, 0.4), 0.025, 0.025, n / 6, false);
        }
    }
}

/// Trays above the rack with many cables that change lanes.
fn trays(b: &mut Builder, p: &Paints) {
    if !b.has(0.05) {
        return;
    }
    let (n, y) = (b.segments(7.0, 3), TIERS[2] + 0.9);
    let mut rng = b.rng.fork();
    for z in [MIDDLE - 1.7, MIDDLE + 1.7] {
        b.paint(p.galvanised);
        for side in [-0.3, 0.3] {
            b.cuboid(vec3(FROM, y, z + side - 0.01), vec3(TO, y + 0.1, z + side + 0.01));
        }
        let rungs = if b.has(0.15) { 140 } else { 40 };
        for k in 0..rungs {
            let x = FROM + (TO - FROM) * k as f32 / rungs as f32;
            b.cuboid(vec3(x - 0.015, y + 0.005, z - 0.29), vec3(x + 0.015, y + 0.025, z + 0.29));
        }
        for k in 0..16 {
            let height = y + 0.04 + 0.012 * (k % 5) as f32;
            b.paint(if k % 4 == 0 { p.orange } else { p.cable });
            b.cone(
                vec3(FROM, height, z + 0.25 * rng.signed()),
                vec3(TO, height, z + 0.25 * rng.signed()),
                0.014,
                0.014,
                n,
                false,
            );
        }
    }
}

/// Pumps under the rack: motor, volute, base.
fn pumps(b: &mut Builder, p: &Paints) {
    let count = if b.has(0.05) { 8 } else { 0 };
    let (n, m) = (b.segments(52.0, 4), b.segments(24.0, 2));
    for k in 0..count {
        let at = vec3(3.5 + 4.6 * k as f32, 0.0, MIDDLE + if k % 2 == 0 { -0.9 } else { 0.9 });
        b.paint(p.concrete).block(at.x, 0.0, at.z, vec3(2.4, 0.3, 1.0));
        let axis = at + Vec3::Y * 0.75;
        b.within(Frame::upright(axis - Vec3::X * 1.0, Vec3::X), |b| {
            b.paint(p.blue).lathe(
                &[
                    vec2(0.0, -0.05),
                    vec2(0.26, 0.0),
                    vec2(0.30, 0.1),
                    vec2(0.30, 0.9),
                    vec2(0.24, 1.0),
                    vec2(0.0, 1.02),
                ],
                n,
                m,
            );
            let fins = if b.has(0.2) { 24 } else { 0 };
            for i in 0..fins {
                let out = around(TURN * i as f32 / fins as f32);
                b.beam(out * 0.31 + Vec3::Y * 0.12, out * 0.31 + Vec3::Y * 0.88, 0.012, 0.06);
            }
            b.paint(p.chrome).cone(vec3(0.0, 1.0, 0.0), vec3(0.0, 1.35, 0.0), 0.05, 0.05, n / 2, false);
            b.paint(p.green).lathe(
                &[
                    vec2(0.1, 1.3),
                    vec2(0.42, 1.38),
                    vec2(0.48, 1.5),
                    vec2(0.42, 1.66),
                    vec2(0.15, 1.75),
                    vec2(0.14, 2.0),
                ],
                n,
                m,
            );
        });
        let bend = b.segments(10.0, 1);
        b.paint(p.blue).pipe(
            &[
                axis + vec3(0.5, 0.3, 0.0),
                axis + vec3(0.5, 1.6, 0.0),
                axis + vec3(0.5, 1.6, 0.9),
                axis + vec3(0.5, 2.6, 0.9),
            ],
            0.13,
            0.35,
            n / 2,
            bend,
        );
        steelwork::flange(b, p, axis + vec3(0.5, 0.75, 0.0), Vec3::Y, 0.13);
        steelwork::valve(b, p, axis + vec3(0.5, 1.6, 0.45), Vec3::Z, 0.11);
    }
}
