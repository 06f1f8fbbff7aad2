//! Floor, walls, ceiling, windows with blinds, and the slatted wall.

use super::{D, H, Paints, W};
use crate::procedural::builder::{Builder, Closure};
use crate::procedural::frame::Frame;
use crate::procedural::math::{TURN, sin_cos};
use glam::{Vec3, vec3};

/// The strip of windows in the wall at z = -D: x0, y0, x1, y1.
const WINDOW: [f32; 4] = [-4.6, 0.85, 4.6, 2.55];

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    b.paint(p.carpet).quad(vec3(-W, 0.0, -D), Vec3::Z * (2.0 * D), Vec3::X * (2.0 * W));
    b.paint(p.wall);
    let [x0, y0, x1, y1] = WINDOW;
    b.within(Frame::at(-W, 0.0, -D), |b| b.wall(2.0 * W, H, Some([x0 + W, y0, x1 + W, y1])));
    b.within(Frame::at(W, 0.0, D).turned(0.5 * TURN), |b| b.wall(2.0 * W, H, None));
    b.within(Frame::at(-W, 0.0, D).turned(0.25 * TURN), |b| b.wall(2.0 * D, H, None));
    b.within(Frame::at(W, 0.0, -D).turned(-0.25 * TURN), |b| b.wall(2.0 * D, H, None));
    pile(b, p);
    ceiling(b, p);
    windows(b, p);
    slats(b, p);
}

/// The carpet's pile, in stripes.
fn pile(b: &mut Builder, p: &Paints) {
    let count = b.count(50_000.0, 0, 6_000_000) as usize;
    for (paint, odd) in [(p.carpet, 0.0), (p.carpet_dark, 1.0)] {
        b.paint(paint).blades(count / 2, 0.006, |rng| {
            let stripe = 2.0 * rng.below(10) as f32 + odd;
            let x = -W + (stripe + rng.unit()) * 0.1 * W;
            let way = vec3(0.006 * rng.signed(), rng.range(0.006, 0.012), 0.006 * rng.signed());
            (vec3(x, 0.0, D * rng.signed()), way)
        });
    }
}

/// A grid of tiles on long bars, lamps in some of the cells.
fn ceiling(b: &mut Builder, p: &Paints) {
    const CELL: f32 = 0.625;
    let (columns, rows) = (16, 11);
    let (left, near) = (-0.5 * CELL * columns as f32, -0.5 * CELL * rows as f32);
    b.paint(p.wall).quad(vec3(-W, H, -D), Vec3::X * (2.0 * W), Vec3::Z * (2.0 * D));
    b.paint(p.steel);
    for i in 0..=columns {
        let x = left + CELL * i as f32;
        b.cuboid(vec3(x - 0.012, H - 0.05, -D), vec3(x + 0.012, H - 0.03, D));
    }
    for j in 0..=rows {
        let z = near + CELL * j as f32;
        b.cuboid(vec3(-W, H - 0.049, z - 0.012), vec3(W, H - 0.029, z + 0.012));
    }
    let n = b.segments(3.0, 0);
    for i in 0..columns {
        for j in 0..rows {
            let (x, z) = (left + CELL * (i as f32 + 0.5), near + CELL * (j as f32 + 0.5));
            let lit = i % 4 == 1 && (j == 2 || j == 5 || j == 8);
            if lit {
                b.paint(p.lamp).quad(vec3(x - 0.29, H - 0.035, z - 0.29), Vec3::X * 0.58, Vec3::Z * 0.58);
                lamp_grid(b, p, x, z);
            } else if b.has(0.08) {
                b.paint(p.ceiling).pillow(vec3(x, H - 0.03, z), vec3(0.298, 0.012, 0.298), 0.006, n);
            }
        }
    }
    if !b.has(0.08) {
        b.paint(p.ceiling).quad(vec3(-W, H - 0.035, -D), Vec3::X * (2.0 * W), Vec3::Z * (2.0 * D));
    }
}

/// Bright louvres below a lamp.
fn lamp_grid(b: &mut Builder, p: &Paints, x: f32, z: f32) {
    if !b.has(0.2) {
        return;
    }
    b.paint(p.chrome);
    for k in -3..=3 {
        let off = 0.09 * k as f32;
        b.cuboid(vec3(x + off - 0.002, H - 0.065, z - 0.29), vec3(x + off + 0.002, H - 0.036, z + 0.29));
        b.cuboid(vec3(x - 0.29, H - 0.064, z + off - 0.002), vec3(x + 0.29, H - 0.037, z + off + 0.002));
    }
}

/// Frames, panes and Venetian blinds: slats as long as a window bay and a few millimetres thick, tilted.
fn windows(b: &mut Builder, p: &Paints) {
    let [x0, y0, x1, y1] = WINDOW;
    let bays = 4;
    let width = (x1 - x0) / bays as f32;
    b.paint(p.black);
    for k in 0..=bays {
        let x = x0 + width * k as f32;
        b.cuboid(vec3(x - 0.03, y0, -D - 0.08), vec3(x + 0.03, y1, -D + 0.01));
    }
    for y in [y0, y1] {
        b.cuboid(vec3(x0, y - 0.03, -D - 0.081), vec3(x1, y + 0.03, -D + 0.011));
    }
    b.paint(p.maple).cuboid(vec3(x0 - 0.1, y0 - 0.07, -D), vec3(x1 + 0.1, y0 - 0.03, -D + 0.26));
    b.paint(p.pane).quad(vec3(x0, y0, -D - 0.05), Vec3::X * (x1 - x0), Vec3::Y * (y1 - y0));
    let slats = if b.has(0.25) {
        44
    } else if b.has(0.1) {
        24
    } else {
        10
    };
    let across = b.segments(5.0, 1);
    for bay in 0..bays {
        let (left, right) = (x0 + width * bay as f32 + 0.05, x0 + width * (bay + 1) as f32 - 0.05);
        // One blind is half drawn up, the others hang down fully; each is tilted its own way.
        let lowest = [0.0, 0.0, 0.45, 0.12][bay] * (y1 - y0);
        let tilt = [0.45, 0.62, 0.25, 0.5][bay];
        let (s, c) = sin_cos(tilt);
        let z = -D + 0.09;
        b.paint(p.blind);
        for k in 0..slats {
            let y = y0 + lowest + (y1 - y0 - lowest - 0.04) * (k as f32 + 0.5) / slats as f32;
            let skew = if (k * 7 + bay * 3) % 9 == 0 { 0.012 } else { 0.003 };
            b.patch(1, across, Closure::OPEN, |u, v| {
                let t = v - 0.5;
                let (reach, arch) = (0.045 * t, 0.006 * (0.25 - t * t));
                let at = vec3(
                    left + (right - left) * u,
                    y + reach * s + arch * c + skew * (u - 0.5),
                    z - reach * c + arch * s,
                );
                let bend = -0.27 * t;
                (at, vec3(0.0, c - bend * s, s + bend * c))
            });
        }
        let n = b.segments(6.0, 3);
        b.paint(p.paper);
        for t in [0.12, 0.5, 0.88] {
            let x = left + (right - left) * t;
            b.cone(vec3(x, y0 + lowest, z + 0.025), vec3(x, y1, z + 0.025), 0.0018, 0.0018, n, false);
        }
        b.paint(p.steel).cuboid(vec3(left, y1 - 0.05, z - 0.03), vec3(right, y1, z + 0.03));
        b.cuboid(vec3(left, y0 + lowest - 0.012, z - 0.02), vec3(right, y0 + lowest, z + 0.02));
        b.cable(
            vec3(right - 0.06, y1 - 0.04, z + 0.04),
            vec3(right - 0.10, y0 - 0.02, z + 0.05),
            0.01,
            0.003,
            n,
            3,
        );
    }
}

/// Upright wooden slats over the wall behind the screen: floor to ceiling, a hand wide.
fn slats(b: &mut Builder, p: &Paints) {
    let count = if b.has(0.1) { 85 } else { 24 };
    b.paint(p.black).quad(vec3(-W + 0.005, 0.0, D), Vec3::Z * (-2.0 * D), Vec3::Y * H);
    b.paint(p.maple);
    for k in 0..count {
        let z = -D + 2.0 * D * (k as f32 + 0.5) / count as f32;
        let half = 0.3 * 2.0 * D / count as f32;
        b.cuboid(vec3(-W + 0.006, 0.0, z - half), vec3(-W + 0.045, H - 0.03, z + half));
    }
    // Panels and a skirting board on the long wall, a door with a handle in the far corner.
    b.paint(p.maple);
    b.cuboid(vec3(-W, 0.0, D - 0.02), vec3(W, 0.12, D));
    b.cuboid(vec3(W - 0.03, 0.0, -2.6), vec3(W, 2.15, -1.6));
    b.paint(p.walnut);
    let n = b.segments(5.0, 0);
    b.pillow(vec3(W - 0.035, 1.06, -2.1), vec3(0.012, 1.03, 0.45), 0.006, n);
    let (n, m) = (b.segments(16.0, 3), b.segments(8.0, 1));
    b.paint(p.chrome);
    b.pipe(
        &[vec3(W - 0.03, 1.05, -1.75), vec3(W - 0.10, 1.05, -1.75), vec3(W - 0.10, 1.05, -1.90)],
        0.010,
        0.02,
        n,
        m,
    );
}
