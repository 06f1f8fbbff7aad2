//! The turbine deck: two sets of turbine and generator on a concrete floor.

use super::{Paints, steelwork};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec2, Vec3, vec2, vec3};

/// The deck's corners and height, metres.
const MIN: (f32, f32) = (3.0, -10.0);
const MAX: (f32, f32) = (31.0, 8.0);
const DECK: f32 = 4.5;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    b.paint(p.concrete);
    b.cuboid(vec3(MIN.0, DECK - 0.6, MIN.1), vec3(MAX.0, DECK, MAX.1));
    let columns = if b.has(0.04) { 5 } else { 2 };
    for k in 0..columns {
        let x = MIN.0 + 1.0 + (MAX.0 - MIN.0 - 2.0) * k as f32 / (columns - 1) as f32;
        for z in [MIN.1 + 1.0, -1.0, MAX.1 - 1.0] {
            b.block(x, 0.0, z, vec3(0.9, DECK - 0.6, 0.9));
        }
    }
    let sets = if b.has(0.03) { 2 } else { 1 };
    for z in [3.4, -5.4].into_iter().take(sets) {
        b.within(Frame::at(7.0, DECK, z), |b| set(b, p));
    }
    let corner = |x: f32, z: f32| vec3(x, DECK, z);
    steelwork::railing(
        b,
        p,
        &[
            corner(MIN.0, MIN.1),
            corner(MAX.0, MIN.1),
            corner(MAX.0, MAX.1),
            corner(MIN.0, MAX.1),
            corner(MIN.0, MIN.1),
        ],
    );
    steelwork::stairs(b, p, vec3(MAX.0 - 6.4, 0.0, MAX.1 + 0.7), vec3(MAX.0 - 0.6, DECK, MAX.1 + 0.7), 1.0);
    crane(b, p);
}

/// Two casings and a generator on one shaft along x.
fn set(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(120.0, 5), b.segments(70.0, 2));
    b.paint(p.concrete).cuboid(vec3(-1.8, 0.0, -1.5), vec3(21.0, 0.45, 1.5));
    b.paint(p.chrome).cone(vec3(-1.4, 1.7, 0.0), vec3(20.0, 1.7, 0.0), 0.22, 0.22, n / 2, true);
    let casing = |b: &mut Builder, x: f32, profile: &[Vec2]| {
        b.within(Frame::upright(vec3(x, 1.7, 0.0), Vec3::X), |b| b.lathe(profile, n, m));
    };
    b.paint(p.lagging);
    casing(
        b,
        0.0,
        &[vec2(0.3, 0.0), vec2(0.85, 0.1), vec2(0.95, 0.8), vec2(1.15, 2.4), vec2(1.2, 3.0), vec2(0.35, 3.3)],
    );
    b.paint(p.green);
    casing(
        b,
        4.2,
        &[
            vec2(0.35, 0.0),
            vec2(1.3, 0.25),
            vec2(1.7, 1.2),
            vec2(1.75, 2.6),
            vec2(1.7, 4.0),
            vec2(1.3, 4.9),
            vec2(0.35, 5.2),
        ],
    );
    b.paint(p.orange);
    casing(
        b,
        11.0,
        &[
            vec2(0.4, 0.0),
            vec2(1.25, 0.05),
            vec2(1.4, 0.3),
            vec2(1.4, 3.0),
            vec2(1.4, 6.0),
            vec2(1.25, 6.3),
            vec2(0.4, 6.4),
        ],
    );
    if !b.has(0.05) {
        return;
    }
    // Joint flanges with bolts, cooling fins, pedestals.
    let nut = b.segments(12.0, 3);
    for (x, radius) in [(3.2, 1.3), (4.7, 1.6), (9.0, 1.6)] {
        b.within(Frame::upright(vec3(x, 1.7, 0.0), Vec3::X), |b| {
            b.paint(p.galvanised).torus(0.0, radius, 0.07, n, nut);
            let bolts = if b.has(0.2) { 36 } else { 12 };
            b.paint(p.dark);
            for k in 0..bolts {
                let out = around(TURN * k as f32 / bolts as f32) * radius;
                b.rod(out - Vec3::Y * 0.11, out + Vec3::Y * 0.11, 0.035, nut);
            }
        });
    }
    let fins = if b.has(0.15) { 22 } else { 6 };
    b.paint(p.orange);
    for k in 0..fins {
        let x = 11.5 + 5.4 * k as f32 / fins as f32;
        b.within(Frame::upright(vec3(x, 1.7, 0.0), Vec3::X), |b| b.torus(0.0, 1.42, 0.05, n, nut));
    }
    let edge = b.segments(5.0, 0);
    b.paint(p.steel);
    for x in [-0.9, 3.7, 10.2, 18.2] {
        b.pillow(vec3(x, 1.1, 0.0), vec3(0.32, 0.75, 0.8), 0.1, edge);
        b.within(Frame::upright(vec3(x - 0.35, 1.7, 0.0), Vec3::X), |b| {
            b.lathe(
                &[vec2(0.24, 0.0), vec2(0.6, 0.05), vec2(0.62, 0.35), vec2(0.6, 0.65), vec2(0.24, 0.7)],
                n / 2,
                m / 4,
            )
        });
    }
    // Inlets and drains.
    let bend = b.segments(12.0, 1);
    for side in [-1.0, 1.0] {
        b.paint(p.lagging);
        b.pipe(
            &[
                vec3(1.4, 1.9, 0.8 * side),
                vec3(1.4, 3.4, 1.9 * side),
                vec3(1.4, 3.4, 2.6 * side),
                vec3(1.4, -1.0, 2.6 * side),
            ],
            0.24,
            0.6,
            n / 3,
            bend,
        );
        steelwork::flange(b, p, vec3(1.4, 1.8, 2.6 * side), Vec3::Y, 0.24);
        steelwork::valve(b, p, vec3(1.4, 0.8, 2.6 * side), Vec3::Y, 0.24);
        b.paint(p.blue).pipe(
            &[vec3(14.0, 0.9, 1.2 * side), vec3(14.0, 0.9, 2.1 * side), vec3(19.5, 0.25, 2.1 * side)],
            0.12,
            0.3,
            n / 4,
            bend,
        );
    }
    b.paint(p.lagging).pipe(
        &[vec3(3.0, 2.6, 0.0), vec3(3.0, 4.3, 0.0), vec3(6.8, 4.3, 0.0), vec3(6.8, 3.2, 0.0)],
        0.42,
        1.0,
        n / 2,
        2 * bend,
    );
}

/// A travelling crane over the deck: rails on columns and a lattice bridge.
fn crane(b: &mut Builder, p: &Paints) {
    let top = 13.0;
    let columns = if b.has(0.045) { 5 } else { 2 };
    b.paint(p.steel);
    for z in [MIN.1 - 0.6, MAX.1 + 2.2] {
        for k in 0..columns {
            let x = MIN.0 + (MAX.0 - MIN.0) * k as f32 / (columns - 1) as f32;
            b.beam(vec3(x, 0.0, z), vec3(x, top, z), 0.35, 0.35);
            if k > 0 && b.has(0.04) && k % 2 == 1 {
                let before = x - (MAX.0 - MIN.0) / (columns - 1) as f32;
                b.beam(vec3(before, 0.0, z), vec3(x, top, z), 0.12, 0.12);
                b.beam(vec3(x, 0.0, z), vec3(before, top, z), 0.11, 0.11);
            }
        }
        b.beam(vec3(MIN.0 - 0.5, top, z), vec3(MAX.0 + 0.5, top, z), 0.3, 0.5);
    }
    let (z0, z1) = (MIN.1 - 0.6, MAX.1 + 2.2);
    let fields = if b.has(0.05) { 14 } else { 2 };
    b.paint(p.yellow);
    for x in [21.0, 22.6] {
        b.beam(vec3(x, top + 0.4, z0), vec3(x, top + 0.4, z1), 0.2, 0.2);
        b.beam(vec3(x, top + 1.8, z0), vec3(x, top + 1.8, z1), 0.2, 0.2);
        for k in 0..fields {
            let at = |k: u32| z0 + (z1 - z0) * k as f32 / fields as f32;
            let (low, high) = (vec3(x, top + 0.4, at(k)), vec3(x, top + 1.8, at(k + 1)));
            if k % 2 == 0 {
                b.beam(low, high, 0.1, 0.1);
            } else {
                b.beam(low.with_y(high.y), high.with_y(low.y), 0.1, 0.1);
            }
        }
    }
    b.paint(p.dark).block(21.8, top - 0.2, 0.0, vec3(2.2, 0.6, 1.6));
    let n = b.segments(10.0, 3);
    for (x, z) in [(21.5, -0.2), (22.1, -0.2), (21.5, 0.2), (22.1, 0.2)] {
        b.cone(vec3(x, top - 0.2, z), vec3(0.5 * (x + 21.8), 9.2, 0.5 * z), 0.015, 0.015, n, false);
    }
    b.block(21.8, 8.8, 0.0, vec3(0.5, 0.5, 0.3));
}
