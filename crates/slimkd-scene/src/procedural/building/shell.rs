//! Slabs, columns, core, facade, and what hangs under the ceilings.

use super::{Paints, SLAB, STOREY, STOREYS, X, Z};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use glam::{Vec3, vec3};

/// The stair well in every slab: x from -WELL.0 to WELL.0, z from -Z to WELL.1; metres.
pub(super) const WELL: (f32, f32) = (1.5, -2.6);

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    for level in 0..=STOREYS {
        let top = STOREY * level as f32;
        let mut slab = |x0: f32, x1: f32, z0: f32, z1: f32| {
            b.paint(p.concrete).cuboid(vec3(x0, top - SLAB, z0), vec3(x1, top - 0.02, z1));
            b.paint(p.floor).quad(vec3(x0, top, z0), Vec3::Z * (z1 - z0), Vec3::X * (x1 - x0));
        };
        if level == 0 || level == STOREYS {
            slab(-X, X, -Z, Z);
        } else {
            slab(-X, -WELL.0, -Z, Z);
            slab(WELL.0, X, -Z, Z);
            slab(-WELL.0, WELL.0, WELL.1, Z);
        }
    }
    let n = b.segments(60.0, 4);
    let height = STOREY * STOREYS as f32;
    b.paint(p.concrete);
    for i in 0..6 {
        for z in [-6.4, 6.4] {
            let x = -15.0 + 6.0 * i as f32;
            b.cone(vec3(x, 0.0, z), vec3(x, height - SLAB, z), 0.24, 0.24, n, false);
        }
    }
    core(b, p);
    facade(b, p);
}

/// Walls beside the stairs and the lift shaft with its doors.
fn core(b: &mut Builder, p: &Paints) {
    let height = STOREY * STOREYS as f32 - SLAB;
    b.paint(p.wall);
    for x in [-WELL.0 - 0.12, WELL.0] {
        b.cuboid(vec3(x, 0.0, -Z), vec3(x + 0.12, height, WELL.1 - 1.4));
    }
    b.cuboid(vec3(-WELL.0, 0.0, -Z - 0.02), vec3(WELL.0, height, -Z + 0.1));
    if !b.has(0.05) {
        return;
    }
    // Guide rails and cables of an open lift beside the stairs: as tall as the house.
    let n = b.segments(10.0, 3);
    b.paint(p.steel);
    for (x, z) in [(2.0, -7.6), (2.0, -5.9), (3.4, -7.6), (3.4, -5.9)] {
        b.cuboid(vec3(x - 0.04, 0.0, z - 0.04), vec3(x + 0.04, height, z + 0.04));
    }
    for k in 0..5 {
        let x = 2.5 + 0.1 * k as f32;
        b.cone(vec3(x, 2.4, -6.8), vec3(x + 0.05, height, -6.75), 0.012, 0.012, n, false);
    }
}

/// Mullions as tall as the house, transoms as long as it, panes of one quad a storey, fins set aslant.
fn facade(b: &mut Builder, p: &Paints) {
    let height = STOREY * STOREYS as f32;
    let out = 0.18;
    let bays = if b.has(0.06) { (24, 11) } else { (8, 4) };
    b.paint(p.dark_steel);
    for k in 0..=bays.0 {
        let x = -X - out + 2.0 * (X + out) * k as f32 / bays.0 as f32;
        for z in [-Z - out, Z + out] {
            b.block(x, -0.02, z, vec3(0.06, height, 0.14));
        }
    }
    for k in 1..bays.1 {
        let z = -Z - out + 2.0 * (Z + out) * k as f32 / bays.1 as f32;
        for x in [-X - out, X + out] {
            b.block(x, -0.02, z, vec3(0.14, height, 0.06));
        }
    }
    let levels = match () {
        () if b.has(0.04) => 2,
        () if b.has(0.03) => 1,
        () => 0,
    };
    for storey in 0..STOREYS {
        let base = STOREY * storey as f32;
        for y in [base - 0.02, base + 0.9].into_iter().take(levels) {
            for z in [-Z - out, Z + out] {
                b.cuboid(vec3(-X - out, y - 0.04, z - 0.05), vec3(X + out, y + 0.04, z + 0.05));
            }
            for x in [-X - out, X + out] {
                b.cuboid(vec3(x - 0.05, y - 0.04, -Z - out), vec3(x + 0.05, y + 0.04, Z + out));
            }
        }
    }
    for storey in 0..STOREYS {
        let (y, tall) = (STOREY * storey as f32, STOREY);
        b.paint(p.pane);
        for (side, x) in [(1.0, X + out), (-1.0, X + out)] {
            let z = Z + out;
            b.quad(vec3(-x * side, y, z * side), Vec3::X * (2.0 * x * side), Vec3::Y * tall);
            b.quad(vec3(x * side, y, z * side), Vec3::Z * (-2.0 * z * side), Vec3::Y * tall);
        }
    }
    // The roof's edge, and stays from it to the ground across the gable: long and aslant.
    b.paint(p.steel);
    for z in [-Z - out, Z + out] {
        b.cuboid(vec3(-X - 0.4, height, z - 0.2), vec3(X + 0.4, height + 0.5, z + 0.2));
    }
    let n = b.segments(14.0, 3);
    for x in [-X - 0.35, X + 0.35] {
        b.cuboid(vec3(x - 0.1, height, -Z), vec3(x + 0.1, height + 0.5, Z));
        for k in 0..3 {
            let z = -Z + 5.3 * k as f32;
            b.cone(vec3(x, 0.0, z), vec3(x, height, z + 5.3), 0.05, 0.05, n, false);
            b.cone(vec3(x, 0.0, z + 5.3), vec3(x, height, z), 0.05, 0.05, n, false);
        }
    }
}

/// Lamps, ducts, trays and cables under the ceiling of one storey.
pub(super) fn services(b: &mut Builder, p: &Paints) {
    let top = STOREY - SLAB;
    let n = b.segments(36.0, 4);
    let rows = if b.has(0.04) { 4 } else { 1 };
    for k in 0..rows {
        let z = -5.0 + 3.3 * k as f32;
        for (x0, x1) in [(-17.0, -3.5), (3.5, 17.0)] {
            b.paint(p.white).cuboid(vec3(x0, top - 0.42, z - 0.07), vec3(x1, top - 0.36, z + 0.07));
            b.paint(p.lamp).quad(vec3(x0, top - 0.422, z - 0.05), Vec3::X * (x1 - x0), Vec3::Z * 0.10);
            if b.has(0.08) {
                b.paint(p.steel);
                for i in 0..6 {
                    let x = x0 + (x1 - x0) * (i as f32 + 0.5) / 6.0;
                    b.cone(vec3(x, top - 0.36, z), vec3(x + 0.05, top, z), 0.004, 0.004, n / 8, false);
                }
            }
        }
    }
    b.paint(p.steel);
    b.cone(vec3(-17.4, top - 0.30, -3.4), vec3(17.4, top - 0.30, -3.4), 0.2, 0.2, n, true);
    if !b.has(0.06) {
        return;
    }
    let m = b.segments(8.0, 2);
    for k in 0..10 {
        let x = -16.2 + 3.6 * k as f32;
        b.within(Frame::upright(vec3(x, top - 0.30, -3.4), Vec3::X), |b| b.torus(0.0, 0.205, 0.012, n, m));
        b.pipe(
            &[
                vec3(x + 1.0, top - 0.30, -3.3),
                vec3(x + 1.0, top - 0.30, -1.6),
                vec3(x + 1.0, top - 0.55, -1.6),
            ],
            0.07,
            0.15,
            n / 2,
            m,
        );
    }
    trays(b, p, top);
    sprinklers(b, p, top);
}

/// A ladder tray along the storey with a bundle of cables, and drops from it to the desks.
fn trays(b: &mut Builder, p: &Paints, top: f32) {
    let (y, z, n) = (top - 0.5, 0.35, b.segments(8.0, 3));
    b.paint(p.steel);
    for side in [-0.2, 0.2] {
        b.cuboid(vec3(-17.4, y, z + side - 0.01), vec3(17.4, y + 0.06, z + side + 0.01));
    }
    let rungs = if b.has(0.15) { 100 } else { 30 };
    for k in 0..rungs {
        let x = -17.3 + 34.6 * k as f32 / rungs as f32;
        b.cuboid(vec3(x - 0.012, y + 0.005, z - 0.19), vec3(x + 0.012, y + 0.02, z + 0.19));
    }
    let mut rng = b.rng.fork();
    for k in 0..14 {
        b.paint(p.cable[k % 3]);
        // Nearly parallel, but each crosses over to another lane.
        let (from, to) = (z + 0.16 * rng.signed(), z + 0.16 * rng.signed());
        let height = y + 0.03 + 0.01 * (k % 4) as f32;
        b.cone(vec3(-17.4, height, from), vec3(17.4, height + 0.01, to), 0.009, 0.009, n, false);
    }
    let m = b.segments(16.0, 3);
    for k in 0..16 {
        let x = -16.5 + 33.0 * (k as f32 + 0.5) / 16.0;
        if x.abs() < 4.0 {
            continue;
        }
        b.paint(p.cable[k % 3]);
        let way = vec3(0.4 * rng.signed(), 0.0, 2.2 * rng.signed());
        b.cable(vec3(x, y + 0.04, z), vec3(x, 1.1, z) + way, -0.12, 0.007, n, m);
    }
}

fn sprinklers(b: &mut Builder, p: &Paints, top: f32) {
    let n = b.segments(16.0, 3);
    b.paint(p.fabric[1]);
    for z in [-5.8, 4.4] {
        b.cone(vec3(-17.4, top - 0.14, z), vec3(17.4, top - 0.14, z), 0.022, 0.022, n, false);
    }
    b.paint(p.chrome);
    for k in 0..12 {
        for z in [-5.8, 4.4] {
            let x = -16.5 + 3.0 * k as f32;
            b.cone(vec3(x, top - 0.16, z), vec3(x, top - 0.26, z), 0.012, 0.008, n, true);
            b.ball(vec3(x, top - 0.27, z), vec3(0.03, 0.006, 0.03), n);
        }
    }
}
