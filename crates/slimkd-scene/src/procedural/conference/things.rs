//! The table and what lies on it, the screen, the projector, plants, the sideboard.

use super::{D, H, Paints, TABLE, W};
use crate::procedural::builder::{Builder, Closure, Paint};
use crate::procedural::frame::Frame;
use crate::procedural::math::{Rng, TURN, around, sin_cos};
use crate::procedural::shapes::Leaf;
use glam::{Vec3, vec2, vec3};

/// A boat-shaped top: one fan of skinny triangles as long as the table, and a thin rim.
pub(super) fn table(b: &mut Builder, p: &Paints) {
    let (length, width, height) = TABLE;
    let outline = |u: f32| {
        let (s, c) = sin_cos(TURN * u);
        // A superellipse of exponent 4, by its square root of a square root.
        let r = (s * s * s * s + c * c * c * c).sqrt().sqrt();
        vec3(length * c / r, 0.0, width * (s / r) * (1.0 - 0.12 * (c / r) * (c / r)))
    };
    let n = b.segments(240.0, 16);
    let fan = Closure { ring: true, first_pole: true, last_pole: false };
    b.paint(p.walnut);
    b.patch(n, 1, fan, |u, v| (outline(u) * v + Vec3::Y * height, Vec3::Y));
    b.patch(n, 1, fan, |u, v| (outline(u) * v + Vec3::Y * (height - 0.04), Vec3::NEG_Y));
    let m = b.segments(4.0, 1);
    b.paint(p.black).patch(n, m, Closure::RING, |u, v| {
        let at = outline(u);
        let out = at.normalize_or(Vec3::X);
        let (s, c) = sin_cos(0.5 * TURN * (v - 0.5));
        (at + out * (0.012 * c) + Vec3::Y * (height - 0.02 + 0.02 * s), out * c + Vec3::Y * s)
    });
    for x in [-0.55 * length, 0.0, 0.55 * length] {
        b.paint(p.steel).cone(vec3(x, 0.02, 0.0), vec3(x, height - 0.04, 0.0), 0.09, 0.06, n / 6, false);
        b.within(Frame::at(x, 0.0, 0.0).scaled(0.9, 1.0, 1.3), |b| {
            let foot = [vec2(0.36, 0.0), vec2(0.35, 0.015), vec2(0.12, 0.035), vec2(0.0, 0.036)];
            let k = b.segments(6.0, 1);
            b.lathe(&foot, n / 5, k);
        });
    }
    b.within(Frame::at(0.0, height, 0.0), |b| on_the_table(b, p));
}

fn on_the_table(b: &mut Builder, p: &Paints) {
    if !b.has(0.05) {
        return;
    }
    let (length, width, _) = TABLE;
    let mut rng = b.rng.fork();
    for k in 0..7 {
        let x = length * (-0.80 + 0.27 * k as f32);
        for side in [-1.0, 1.0] {
            let turn = if side > 0.0 { 0.0 } else { 0.5 * TURN };
            let frame = Frame::at(x, 0.0, side * (width - 0.30)).turned(turn + 0.15 * rng.signed());
            let laptop = rng.below(3) == 0;
            b.within(frame, |b| {
                if laptop {
                    self::laptop(b, p);
                } else {
                    papers(b, p);
                }
                b.within(Frame::at(0.24, 0.0, -0.10), |b| tumbler(b, p));
            });
        }
    }
    for x in [-1.5, 0.0, 1.5] {
        b.within(Frame::at(x, 0.0, 0.03), |b| {
            let (n, m) = (b.segments(56.0, 5), b.segments(30.0, 4));
            let bottle = [
                vec2(0.0, 0.0),
                vec2(0.042, 0.0),
                vec2(0.044, 0.03),
                vec2(0.044, 0.17),
                vec2(0.016, 0.24),
                vec2(0.015, 0.28),
            ];
            b.paint(p.glass).lathe(&bottle, n, m);
            b.paint(p.blue).rod(vec3(0.0, 0.28, 0.0), vec3(0.0, 0.30, 0.0), 0.017, n / 2);
        });
    }
    microphone(b, p, -0.75);
    microphone(b, p, 0.75);
    // Power cords from the middle to the nearest laptops: thin and slanted.
    let (n, m) = (b.segments(8.0, 3), b.segments(20.0, 3));
    b.paint(p.black);
    for k in 0..8 {
        let (a, c) = (
            vec3(-2.2 + 0.6 * k as f32, 0.006, 0.0),
            vec3(-2.4 + 0.62 * k as f32, 0.006, if k % 2 == 0 { 0.5 } else { -0.5 }),
        );
        b.cable(a, c, 0.0, 0.004, n, m);
    }
}

fn laptop(b: &mut Builder, p: &Paints) {
    let n = b.segments(6.0, 0);
    b.paint(p.steel).pillow(vec3(0.0, 0.010, 0.0), vec3(0.165, 0.009, 0.115), 0.006, n);
    b.within(Frame::at(0.0, 0.018, -0.112).tilted(-0.30), |b| {
        b.paint(p.steel).pillow(vec3(0.0, 0.11, 0.0), vec3(0.165, 0.108, 0.004), 0.004, n);
        b.paint(p.screen).quad(vec3(-0.155, 0.012, 0.0045), Vec3::X * 0.31, Vec3::Y * 0.195);
    });
    if b.has(0.3) {
        b.paint(p.black);
        let key = b.segments(1.5, 0);
        for row in 0..5 {
            for column in 0..14 {
                let at = vec3(-0.143 + 0.022 * column as f32, 0.0195, -0.075 + 0.021 * row as f32);
                b.pillow(at, vec3(0.0092, 0.002, 0.0088), 0.0015, key);
            }
        }
    }
}

fn papers(b: &mut Builder, p: &Paints) {
    let n = b.segments(10.0, 1);
    b.paint(p.paper);
    for k in 0..3 {
        b.within(Frame::at(0.02 * k as f32, 0.002 + 0.002 * k as f32, 0.0).turned(0.12 * k as f32), |b| {
            // The sheets curl a little.
            b.patch(n, n, Closure::OPEN, |u, v| {
                let lift = 0.012 * u * u * v;
                let normal = vec3(-0.024 * u * v / 0.21, 1.0, 0.012 * u * u / 0.297);
                (vec3(0.21 * (u - 0.5), lift, 0.297 * (0.5 - v)), normal)
            });
        });
    }
    let n = b.segments(16.0, 3);
    b.paint(p.blue).cone(vec3(0.06, 0.012, 0.05), vec3(-0.04, 0.018, -0.06), 0.004, 0.004, n, true);
}

fn tumbler(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(48.0, 5), b.segments(18.0, 5));
    let profile = [
        vec2(0.0, 0.001),
        vec2(0.029, 0.001),
        vec2(0.034, 0.10),
        vec2(0.032, 0.10),
        vec2(0.0275, 0.012),
        vec2(0.0, 0.012),
    ];
    b.paint(p.glass).lathe(&profile, n, m);
}

fn microphone(b: &mut Builder, p: &Paints, x: f32) {
    let (n, m) = (b.segments(32.0, 4), b.segments(16.0, 2));
    b.within(Frame::at(x, 0.0, 0.0), |b| {
        b.paint(p.black).lathe(&[vec2(0.06, 0.0), vec2(0.055, 0.02), vec2(0.0, 0.03)], n, m);
        let neck = [vec3(0.0, 0.02, 0.0), vec3(0.0, 0.20, 0.0), vec3(0.05, 0.32, 0.08)];
        b.pipe(&neck, 0.005, 0.2, n / 3, m);
        b.ball(vec3(0.052, 0.325, 0.083), Vec3::splat(0.018), n);
    });
}

pub(super) fn draw(b: &mut Builder, p: &Paints) {
    screen(b, p);
    projector(b, p);
    sideboard(b, p);
    for (x, z, size) in [(-4.45, 2.85, 1.0), (4.5, 2.95, 0.85), (-4.5, -2.75, 0.9)] {
        b.within(Frame::at(x, 0.0, z).scaled(size, size, size), |b| plant(b, p));
    }
    pictures(b, p);
}

/// The projected slide: a chart of a few bars.
fn screen(b: &mut Builder, p: &Paints) {
    let x = -W + 0.06;
    b.paint(p.black).cuboid(vec3(x - 0.01, 0.93, -1.45), vec3(x, 2.50, 1.45));
    let slide = |b: &mut Builder, paint: Paint, z: f32, y: f32, width: f32, height: f32, off: f32| {
        b.paint(paint).quad(vec3(x + off, y, z + width), Vec3::Z * -width, Vec3::Y * height);
    };
    slide(b, p.screen, -1.40, 0.98, 2.80, 1.47, 0.002);
    slide(b, p.paper, -1.40, 2.25, 2.80, 0.20, 0.004);
    slide(b, p.screen_dark, -0.9, 2.31, 1.8, 0.07, 0.006);
    for k in 0..7 {
        let height = [0.25, 0.42, 0.38, 0.60, 0.78, 0.70, 0.95][k];
        slide(
            b,
            if k == 6 { p.gold } else { p.screen_dark },
            1.0 - 0.32 * k as f32,
            1.12,
            0.2,
            height,
            0.006,
        );
    }
    b.paint(p.steel);
    let n = b.segments(24.0, 3);
    b.rod(vec3(x, 2.56, -1.5), vec3(x, 2.56, 1.5), 0.045, n);
}

fn projector(b: &mut Builder, p: &Paints) {
    let n = b.segments(14.0, 0);
    let m = b.segments(40.0, 4);
    b.within(Frame::at(-0.6, 2.28, 0.0), |b| {
        b.paint(p.paper).pillow(Vec3::ZERO, vec3(0.16, 0.055, 0.20), 0.03, n);
        b.paint(p.black).cone(vec3(-0.15, 0.0, 0.07), vec3(-0.20, 0.0, 0.07), 0.045, 0.05, m, false);
        b.paint(p.glass).ball(vec3(-0.165, 0.0, 0.07), vec3(0.02, 0.04, 0.04), m);
        b.paint(p.steel).rod(vec3(0.0, 0.05, 0.0), vec3(0.0, H - 2.28, 0.0), 0.022, m / 2);
        for (x, z) in [(0.1, 0.12), (-0.1, 0.12), (0.1, -0.12), (-0.1, -0.12)] {
            b.beam(vec3(x, 0.05, z), vec3(0.0, 0.16, 0.0), 0.012, 0.012);
        }
    });
}

/// A low cupboard below the pictures, with a coffee set on it.
fn sideboard(b: &mut Builder, p: &Paints) {
    b.within(Frame::at(1.2, 0.0, D - 0.24).turned(0.5 * TURN), |b| {
        let n = b.segments(5.0, 0);
        b.paint(p.walnut).pillow(vec3(0.0, 0.78, 0.0), vec3(1.25, 0.018, 0.24), 0.01, n);
        for k in 0..4 {
            let x = -0.93 + 0.62 * k as f32;
            b.paint(p.maple).pillow(vec3(x, 0.42, 0.0), vec3(0.305, 0.335, 0.22), 0.008, n);
            b.paint(p.chrome).beam(vec3(x - 0.1, 0.66, 0.24), vec3(x + 0.1, 0.66, 0.24), 0.012, 0.012);
        }
        if !b.has(0.06) {
            return;
        }
        let (m, k) = (b.segments(64.0, 5), b.segments(36.0, 4));
        b.within(Frame::at(-0.7, 0.80, 0.0), |b| {
            let urn = [
                vec2(0.0, 0.0),
                vec2(0.085, 0.0),
                vec2(0.09, 0.04),
                vec2(0.09, 0.26),
                vec2(0.05, 0.32),
                vec2(0.0, 0.34),
            ];
            b.paint(p.chrome).lathe(&urn, m, k);
            b.paint(p.black).pipe(
                &[vec3(0.06, 0.28, 0.0), vec3(0.16, 0.27, 0.0), vec3(0.16, 0.10, 0.0), vec3(0.08, 0.09, 0.0)],
                0.012,
                0.04,
                m / 4,
                k / 4,
            );
        });
        for cup in 0..8 {
            b.within(
                Frame::at(-0.35 + 0.12 * (cup % 4) as f32, 0.80, -0.08 + 0.14 * (cup / 4) as f32),
                |b| {
                    let profile = [
                        vec2(0.025, 0.0),
                        vec2(0.036, 0.02),
                        vec2(0.038, 0.07),
                        vec2(0.035, 0.07),
                        vec2(0.032, 0.02),
                        vec2(0.0, 0.008),
                    ];
                    b.paint(if cup % 3 == 0 { p.red } else { p.paper }).lathe(&profile, m / 2, k / 2);
                    let ear: Vec<Vec3> = (0..=k / 4)
                        .map(|i| {
                            let (s, c) = sin_cos(0.5 * TURN * i as f32 / (k / 4) as f32);
                            vec3(0.034 + 0.022 * s, 0.038 + 0.02 * c, 0.0)
                        })
                        .collect();
                    b.tube(&ear, 0.004, m / 8);
                },
            );
        }
    });
}

/// A tall pot with arching leaves.
fn plant(b: &mut Builder, p: &Paints) {
    let (n, m) = (b.segments(64.0, 5), b.segments(24.0, 2));
    let profile = [
        vec2(0.14, 0.0),
        vec2(0.17, 0.10),
        vec2(0.22, 0.42),
        vec2(0.20, 0.43),
        vec2(0.19, 0.38),
        vec2(0.0, 0.38),
    ];
    b.paint(p.pot).lathe(&profile, n, m);
    let mut rng = b.rng.fork();
    let stems = if b.has(0.08) { 34 } else { 9 };
    let (nu, nv) = (b.segments(5.0, 1), b.segments(26.0, 3));
    b.paint(p.leaf);
    for _ in 0..stems {
        blade(b, &mut rng, nu, nv);
    }
    let count = b.count(1500.0, 0, 60_000) as usize;
    b.leaves(count, |rng| {
        let way = (rng.direction() + Vec3::Y * 0.8).normalize_or(Vec3::Y);
        let base = Vec3::Y * 0.40 + way * vec3(0.5, 0.75, 0.5) * rng.unit().sqrt();
        Leaf { base, way: (way + rng.direction() * 0.5) * rng.range(0.05, 0.10), width: 0.035, droop: 0.4 }
    });
}

/// One arching strap leaf as a curved sheet.
fn blade(b: &mut Builder, rng: &mut Rng, nu: u32, nv: u32) {
    let out = around(rng.range(0.0, TURN));
    let (reach, rise, width) = (rng.range(0.25, 0.6), rng.range(0.5, 1.15), rng.range(0.02, 0.035));
    let across = out.cross(Vec3::Y);
    let at = |t: f32| {
        Vec3::Y * (0.40 + rise * (1.5 * t - 0.75 * t * t * (0.6 + reach))) + out * (0.03 + reach * t * t)
    };
    b.patch(nu, nv, Closure::OPEN, |u, v| {
        let way = (at(v + 0.01) - at(v)).normalize_or(Vec3::Y);
        let half = width * (4.0 * v * (1.0 - v) * 0.8 + 0.2 * (1.0 - v) + 0.02);
        let t = 2.0 * u - 1.0;
        let normal = across.cross(way);
        (at(v) + across * (half * t) + normal * (0.25 * half * t * t), normal - across * (0.5 * t))
    });
}

/// Framed pictures on the long wall.
fn pictures(b: &mut Builder, p: &Paints) {
    if !b.has(0.03) {
        return;
    }
    for (k, x) in [-2.6f32, 0.2, 2.2].into_iter().enumerate() {
        let (w, h, z) = (0.55, 0.38, D - 0.02);
        b.paint(p.black);
        for (a, c) in [(-1.0, -1.0), (1.0, 1.0)] {
            b.cuboid(vec3(x - w, 1.65 + c * h - 0.02, z - 0.03), vec3(x + w, 1.65 + c * h + 0.02, z));
            b.cuboid(vec3(x + a * w - 0.02, 1.65 - h, z - 0.029), vec3(x + a * w + 0.02, 1.65 + h, z));
        }
        b.paint(p.paper).quad(vec3(x + w, 1.65 - h, z - 0.005), Vec3::X * (-2.0 * w), Vec3::Y * (2.0 * h));
        // Overlapping bands of colour.
        let paints = [p.red, p.blue, p.gold, p.walnut];
        for i in 0..9 {
            let t = i as f32 / 9.0;
            let (x0, y0) = (x + w * (0.9 - 1.8 * t), 1.65 - h * 0.9);
            let top = h * (0.5 + 1.2 * ((i * 5 + k * 3) % 7) as f32 / 7.0);
            b.paint(paints[(i + k) % 4]).quad(
                vec3(x0, y0, z - 0.006 - 0.001 * i as f32),
                Vec3::X * -0.10,
                vec3(-0.12 * t, top, 0.0),
            );
        }
    }
}
