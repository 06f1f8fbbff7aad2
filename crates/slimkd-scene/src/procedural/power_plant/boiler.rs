//! The boiler house: an open steel frame with braces, platforms and stairs around a boiler with tube walls and a drum.

use super::{Paints, steelwork};
use crate::procedural::builder::Builder;
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, around};
use glam::{Vec3, vec2, vec3};

/// Corners of the frame in x and z, and its floors; metres.
const X: [f32; 4] = [-22.0, -15.5, -9.0, -2.5];
const Z: [f32; 4] = [-12.0, -4.0, 4.0, 12.0];
const FLOOR: f32 = 6.0;
const FLOORS: u32 = 5;

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    frame(b, p);
    boiler(b, p);
    for floor in (1..=FLOORS).step_by(if b.has(0.03) { 1 } else { 2 }) {
        platforms(b, p, FLOOR * floor as f32);
    }
    for floor in 0..FLOORS {
        let (y, forth) = (FLOOR * floor as f32, floor % 2 == 0);
        let (z0, z1) = if forth { (-1.5, 10.2) } else { (10.2, -1.5) };
        steelwork::stairs(b, p, vec3(X[3] + 0.8, y, z0), vec3(X[3] + 0.8, y + FLOOR, z1), 0.9);
        if !b.has(0.03) {
            continue;
        }
        // The landing between two flights.
        let z = z1 + if forth { 0.7 } else { -0.7 };
        let min = vec3(X[3], y + FLOOR, z - 0.8);
        steelwork::grating(b, p, min, min + vec3(1.4, 0.0, 1.6));
    }
    steelwork::ladder(b, p, vec3(X[0] - 0.3, 0.0, 6.0), FLOOR * FLOORS as f32, Vec3::Z);
    lamps(b, p);
}

fn frame(b: &mut Builder, p: &Paints) {
    let top = FLOOR * FLOORS as f32 + 3.0;
    let fine = b.has(0.05);
    let bar = |b: &mut Builder, from: Vec3, to: Vec3, size: f32| {
        if fine { b.girder(from, to, size) } else { b.beam(from, to, size, size) }
    };
    b.paint(p.steel);
    for x in X {
        for z in Z {
            let inside = x != X[0] && x != X[3] && z != Z[0] && z != Z[3];
            if !inside {
                bar(b, vec3(x, 0.0, z), vec3(x, top, z), 0.4);
            }
        }
    }
    for floor in 1..=FLOORS {
        let y = FLOOR * floor as f32 - 0.35;
        for z in [Z[0], Z[3]] {
            bar(b, vec3(X[0], y, z), vec3(X[3], y, z), 0.36);
        }
        for x in [X[0], X[3]] {
            bar(b, vec3(x, y, Z[0]), vec3(x, y, Z[3]), 0.36);
        }
        if fine {
            for x in &X[1..3] {
                bar(b, vec3(*x, y, Z[0]), vec3(*x, y, Z[1] - 0.6), 0.3);
                bar(b, vec3(*x, y, Z[2] + 0.6), vec3(*x, y, Z[3]), 0.3);
            }
        }
    }
    // Diagonal braces in alternating bays: long, thin, and parallel to no axis.
    b.paint(p.red);
    let floors = if fine { FLOORS } else { 1 };
    for floor in 0..floors {
        let (y0, y1) = (FLOOR * floor as f32, FLOOR * (floor + 1) as f32 - 0.35);
        for k in 0..3 {
            if (k + floor) % 2 == 1 && fine {
                continue;
            }
            let k = k as usize;
            for z in [Z[0], Z[3]] {
                b.beam(vec3(X[k], y0, z), vec3(X[k + 1], y1, z), 0.16, 0.16);
                b.beam(vec3(X[k + 1], y0, z), vec3(X[k], y1, z), 0.15, 0.15);
            }
            b.beam(vec3(X[0], y0, Z[k]), vec3(X[0], y1, Z[k + 1]), 0.16, 0.16);
            b.beam(vec3(X[0], y0, Z[k + 1]), vec3(X[0], y1, Z[k]), 0.15, 0.15);
        }
    }
    // A sheet roof on purlins.
    b.paint(p.galvanised).cuboid(vec3(X[0] - 0.6, top, Z[0] - 0.6), vec3(X[3] + 0.6, top + 0.12, Z[3] + 0.6));
    let purlins = if fine { 9 } else { 2 };
    b.paint(p.steel);
    for k in 0..purlins {
        let z = Z[0] + (Z[3] - Z[0]) * k as f32 / (purlins - 1) as f32;
        bar(b, vec3(X[0], top - 0.2, z), vec3(X[3], top - 0.2, z), 0.3);
    }
}

/// The walks around the boiler on one floor.
fn platforms(b: &mut Builder, p: &Paints, y: f32) {
    let (x0, x1, z0, z1) = (X[0], X[3], Z[0], Z[3]);
    let (i0, i1, j0, j1) = (-18.6, -5.9, -8.0, 8.0);
    for (a, c, e, f) in [(x0, x1, z0, j0), (x0, x1, j1, z1), (x0, i0, j0, j1), (i1, x1, j0, j1)] {
        steelwork::grating(b, p, vec3(a, y, e), vec3(c, y, f));
    }
    let corner = |x: f32, z: f32| vec3(x, y, z);
    steelwork::railing(
        b,
        p,
        &[corner(i0, j0), corner(i1, j0), corner(i1, j1), corner(i0, j1), corner(i0, j0)],
    );
    steelwork::railing(
        b,
        p,
        &[corner(x1, -2.6), corner(x1, z0), corner(x0, z0), corner(x0, z1), corner(x1, z1)],
    );
}

fn boiler(b: &mut Builder, p: &Paints) {
    let (x0, x1, z0, z1, y0, y1) = (-17.6, -6.9, -7.0, 7.0, 5.0, 29.0);
    b.paint(p.boiler).cuboid(vec3(x0, y0, z0), vec3(x1, y1, z1));
    // Hopper below: four slanting sheets.
    let low = [vec3(-13.0, 1.2, -1.0), vec3(-11.5, 1.2, -1.0), vec3(-11.5, 1.2, 1.0), vec3(-13.0, 1.2, 1.0)];
    let high = [vec3(x0, y0, z0), vec3(x1, y0, z0), vec3(x1, y0, z1), vec3(x0, y0, z1)];
    for k in 0..4 {
        let (a, c, d, e) = (low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]);
        let normal = (e - a).cross(c - a).normalize();
        b.patch(1, 1, crate::procedural::builder::Closure::OPEN, |u, v| {
            (a.lerp(c, u).lerp(e.lerp(d, u), v), normal)
        });
    }
    tube_walls(b, p, [x0, x1, y0, y1, z0, z1]);
    // Buckstays: girders around the boiler.
    b.paint(p.steel);
    let stays = if b.has(0.05) { 9 } else { 0 };
    for k in 0..stays {
        let y = y0 + 1.2 + 2.6 * k as f32;
        for z in [z0 - 0.28, z1 + 0.28] {
            b.beam(vec3(x0 - 0.3, y, z), vec3(x1 + 0.3, y, z), 0.3, 0.25);
        }
        for x in [x0 - 0.28, x1 + 0.28] {
            b.beam(vec3(x, y, z0 - 0.3), vec3(x, y, z1 + 0.3), 0.3, 0.25);
        }
    }
    drum(b, p, y1 + 1.5, z0, z1);
    burners(b, p, x1);
}

/// Rows of tubes as high as the boiler on its outside.
fn tube_walls(b: &mut Builder, p: &Paints, [x0, x1, y0, y1, z0, z1]: [f32; 6]) {
    if !b.has(0.05) {
        return;
    }
    let n = b.segments(14.0, 3);
    let pitch = if b.has(0.25) { 0.22 } else { 0.7 };
    b.paint(p.copper);
    let (along_x, along_z) = (((x1 - x0) / pitch) as u32, ((z1 - z0) / pitch) as u32);
    for k in 0..=along_z {
        let z = z0 + (z1 - z0) * k as f32 / along_z as f32;
        b.cone(vec3(x1 + 0.05, y0, z), vec3(x1 + 0.05, y1, z), 0.3 * pitch, 0.3 * pitch, n, false);
    }
    b.paint(p.lagging);
    for k in 0..=along_x {
        let x = x0 + (x1 - x0) * k as f32 / along_x as f32;
        for z in [z0 - 0.05, z1 + 0.05] {
            b.cone(vec3(x, y0, z), vec3(x, y1, z), 0.3 * pitch, 0.3 * pitch, n, false);
        }
    }
}

/// The steam drum on top with its risers.
fn drum(b: &mut Builder, p: &Paints, y: f32, z0: f32, z1: f32) {
    let (n, m) = (b.segments(90.0, 5), b.segments(30.0, 3));
    let x = -8.4;
    b.within(Frame::upright(vec3(x, y, z0), Vec3::Z), |b| {
        let (length, r) = (z1 - z0, 0.9);
        let shell = [
            vec2(0.0, -0.5),
            vec2(0.6 * r, -0.35),
            vec2(r, 0.0),
            vec2(r, 0.2 * length),
            vec2(r, 0.8 * length),
            vec2(r, length),
            vec2(0.6 * r, length + 0.35),
            vec2(0.0, length + 0.5),
        ];
        b.paint(p.lagging).lathe(&shell, n, m);
        for k in 0..if b.has(0.03) { 5 } else { 0 } {
            b.within(Frame::at(0.0, length * (k as f32 + 0.5) / 5.0, 0.0), |b| {
                b.torus(0.0, r, 0.03, n, m / 3)
            });
        }
    });
    if !b.has(0.03) {
        return;
    }
    let (sides, bend) = (b.segments(20.0, 3), b.segments(10.0, 1));
    let risers = if b.has(0.06) { 22 } else { 5 };
    for k in 0..risers {
        let z = z0 + 0.4 + (z1 - z0 - 0.8) * k as f32 / (risers - 1) as f32;
        let path = [vec3(-6.6, y - 4.0, z), vec3(-6.6, y + 0.2, z), vec3(x + 0.7, y + 0.2, z)];
        b.paint(p.copper).pipe(&path, 0.11, 0.7, sides, bend);
        if k % 3 == 0 {
            steelwork::flange(b, p, vec3(-6.6, y - 2.2, z), Vec3::Y, 0.11);
        }
    }
}

/// Burners in the front wall with their ducts.
fn burners(b: &mut Builder, p: &Paints, x: f32) {
    let (n, m) = (b.segments(60.0, 4), b.segments(20.0, 2));
    let rows = match () {
        () if b.has(0.05) => 3,
        () if b.has(0.03) => 1,
        () => 0,
    };
    for row in 0..rows {
        for k in 0..4 {
            let at = vec3(x, 8.6 + 6.0 * row as f32, -5.0 + 3.4 * k as f32);
            b.within(Frame::upright(at, Vec3::X), |b| {
                let body =
                    [vec2(0.75, 0.0), vec2(0.70, 0.2), vec2(0.5, 0.4), vec2(0.42, 0.75), vec2(0.0, 0.8)];
                b.paint(p.orange).lathe(&body, n, m);
                if b.has(0.2) {
                    b.paint(p.dark);
                    for i in 0..10 {
                        let out = around(TURN * i as f32 / 10.0) * 0.72;
                        b.rod(out, out + Vec3::Y * 0.12, 0.03, n / 8);
                    }
                }
            });
            let elbow = [at + vec3(0.6, 0.0, 0.0), at + vec3(0.95, 0.0, 0.0), at + vec3(0.95, -1.9, 0.0)];
            b.paint(p.yellow).pipe(&elbow, 0.09, 0.2, n / 3, m / 2);
            steelwork::valve(b, p, at + vec3(0.95, -1.2, 0.0), Vec3::Y, 0.09);
        }
        let y = 6.7 + 6.0 * row as f32;
        b.paint(p.yellow).rod(vec3(x + 0.95, y, -6.5), vec3(x + 0.95, y, 6.5), 0.14, n / 2);
    }
}

fn lamps(b: &mut Builder, p: &Paints) {
    if !b.has(0.1) {
        return;
    }
    let n = b.segments(24.0, 4);
    for floor in 1..=FLOORS {
        for z in [-10.0, -3.0, 3.0, 10.0] {
            let at = vec3(-4.2, FLOOR * floor as f32 - 0.7, z);
            b.paint(p.dark).cone(at, at + Vec3::Y * 0.6, 0.02, 0.02, n / 4, false);
            b.cone(at, at + Vec3::Y * 0.12, 0.16, 0.05, n, true);
            b.paint(p.lamp).ball(at - Vec3::Y * 0.02, vec3(0.09, 0.07, 0.09), n);
        }
    }
}
