//! `kitchen`: a fitted kitchen with a laid table, after the Kitchen of Choi et al. (2013).

mod fittings;
mod table;
mod tableware;

use super::builder::{Builder, Paint};
use super::frame::Frame;
use super::math::TURN;
use super::stage::{Filler, Stage, lamp, sun, view};
use glam::{Vec2, Vec3, vec2, vec3};

/// Room: x from -W to W, y from 0 to H, z from -D to D; metres.
const W: f32 = 3.0;
const H: f32 = 2.7;
const D: f32 = 2.6;

/// The materials of the room.
struct Paints {
    wall: Paint,
    ceiling: Paint,
    tile_light: Paint,
    tile_dark: Paint,
    cabinet: Paint,
    worktop: Paint,
    wood: Paint,
    wood_dark: Paint,
    steel: Paint,
    chrome: Paint,
    copper: Paint,
    black: Paint,
    china: Paint,
    blue: Paint,
    glass: Paint,
    pane: Paint,
    cloth: Paint,
    bulb: Paint,
    red: Paint,
    yellow: Paint,
    orange: Paint,
    green: Paint,
    leaf: Paint,
    clay: Paint,
    wine: Paint,
}

impl Paints {
    fn new(b: &mut Builder) -> Self {
        Self {
            wall: b.matte("wall", [0.78, 0.72, 0.60]),
            ceiling: b.matte("ceiling", [0.85, 0.84, 0.80]),
            tile_light: b.glossy("light tile", [0.72, 0.68, 0.60], 0.12),
            tile_dark: b.glossy("dark tile", [0.16, 0.10, 0.07], 0.12),
            cabinet: b.glossy("cabinet", [0.30, 0.44, 0.42], 0.03),
            worktop: b.glossy("worktop", [0.09, 0.085, 0.08], 0.15),
            wood: b.glossy("oak", [0.46, 0.26, 0.12], 0.04),
            wood_dark: b.glossy("walnut", [0.22, 0.11, 0.05], 0.04),
            steel: b.metal("steel", [0.62, 0.62, 0.64], 0.35),
            chrome: b.metal("chrome", [0.80, 0.80, 0.82], 0.75),
            copper: b.metal("copper", [0.85, 0.42, 0.24], 0.40),
            black: b.glossy("black", [0.02, 0.02, 0.022], 0.08),
            china: b.glossy("china", [0.82, 0.82, 0.80], 0.06),
            blue: b.glossy("blue glaze", [0.06, 0.14, 0.42], 0.08),
            glass: b.glass("glass", 1.5),
            pane: b.pane("window pane", 0.06),
            cloth: b.matte("cloth", [0.70, 0.20, 0.14]),
            bulb: b.glow("bulb", [1.6, 1.35, 0.95]),
            red: b.glossy("apple", [0.62, 0.04, 0.03], 0.05),
            yellow: b.glossy("lemon", [0.82, 0.62, 0.05], 0.03),
            orange: b.glossy("orange", [0.85, 0.32, 0.03], 0.03),
            green: b.glossy("pear", [0.35, 0.52, 0.08], 0.03),
            leaf: b.matte("herb", [0.10, 0.32, 0.06]),
            clay: b.matte("clay", [0.55, 0.24, 0.13]),
            wine: b.glossy("wine bottle", [0.02, 0.07, 0.03], 0.15),
        }
    }
}

pub(super) fn draw(b: &mut Builder) -> Stage {
    let p = Paints::new(b);
    room(b, &p);
    fittings::draw(b, &p);
    table::draw(b, &p);
    lamps(b, &p);
    Stage {
        cameras: vec![
            view([2.45, 1.75, 2.35], [-0.45, 0.85, -0.9], 58.0),
            view([-2.2, 1.45, 1.2], [0.6, 0.95, -1.6], 58.0),
            view([0.95, 1.30, 1.25], [-0.1, 0.86, 0.0], 50.0),
        ],
        lights: vec![
            lamp([-0.62, 1.56, 0.15], 1.0, [0.62, 0.54, 0.40]),
            lamp([0.62, 1.56, 0.15], 1.0, [0.62, 0.54, 0.40]),
            lamp([0.4, 2.45, 1.6], 2.4, [0.42, 0.40, 0.36]),
            lamp([-1.2, 2.3, -0.9], 1.5, [0.30, 0.30, 0.30]),
            sun([0.25, -0.75, 0.62], [1.1, 1.0, 0.85]),
        ],
        filler: Filler {
            paint: p.cloth,
            areas: vec![(vec3(-1.5, 0.006, -0.95), vec3(1.5, 0.006, 1.25))],
            length: 0.02,
            width: 0.004,
        },
    }
}

fn room(b: &mut Builder, p: &Paints) {
    b.paint(p.wall);
    b.within(Frame::at(-W, 0.0, -D), |b| b.wall(2.0 * W, H, Some([2.3, 1.12, 3.9, 2.2])));
    b.within(Frame::at(W, 0.0, D).turned(0.5 * TURN), |b| b.wall(2.0 * W, H, None));
    b.within(Frame::at(-W, 0.0, D).turned(0.25 * TURN), |b| b.wall(2.0 * D, H, None));
    b.within(Frame::at(W, 0.0, -D).turned(-0.25 * TURN), |b| b.wall(2.0 * D, H, None));
    b.paint(p.ceiling).quad(vec3(-W, H, -D), Vec3::X * (2.0 * W), Vec3::Z * (2.0 * D));
    // Ceiling beams and skirting boards run through the whole room.
    b.paint(p.wood_dark);
    for k in 0..5 {
        let x = -W + 0.6 + 1.2 * k as f32;
        b.cuboid(vec3(x - 0.07, H - 0.16, -D), vec3(x + 0.07, H - 0.01, D));
    }
    floor(b, p);
    window(b, p);
    rug(b, p);
}

/// Square tiles, laid as a diamond-free checker; one quad below the detail where tiles pay.
fn floor(b: &mut Builder, p: &Paints) {
    if !b.has(0.15) {
        b.paint(p.tile_light).quad(vec3(-W, 0.0, -D), Vec3::Z * (2.0 * D), Vec3::X * (2.0 * W));
        return;
    }
    b.paint(p.black).quad(vec3(-W, -0.004, -D), Vec3::Z * (2.0 * D), Vec3::X * (2.0 * W));
    const SIZE: f32 = 0.4;
    let n = b.segments(2.0, 1);
    for i in 0..15 {
        for j in 0..13 {
            b.paint(if (i + j) % 2 == 0 { p.tile_light } else { p.tile_dark });
            let corner = vec3(-W + SIZE * i as f32 + 0.003, 0.0, -D + SIZE * j as f32 + 0.003);
            b.panel(corner, Vec3::Z * (SIZE - 0.006), Vec3::X * (SIZE - 0.006), n, n);
        }
    }
}

fn window(b: &mut Builder, p: &Paints) {
    let (x0, x1, y0, y1, z) = (-0.7, 0.9, 1.12, 2.2, -D);
    b.paint(p.wood);
    for x in [x0, 0.5 * (x0 + x1), x1] {
        b.cuboid(vec3(x - 0.025, y0, z - 0.06), vec3(x + 0.025, y1, z + 0.02));
    }
    for k in 0..4 {
        let y = y0 + (y1 - y0) * k as f32 / 3.0;
        let depth = if k == 0 { 0.12 } else { 0.015 };
        b.cuboid(vec3(x0, y - 0.016, z - 0.05), vec3(x1, y + 0.016, z + depth));
    }
    if b.has(0.2) {
        b.paint(p.pane);
        b.quad(vec3(x0, y0, z - 0.03), Vec3::X * (x1 - x0), Vec3::Y * (y1 - y0));
    }
    // Two curtains in folds on a rail.
    b.paint(p.chrome);
    let n = b.segments(16.0, 3);
    b.rod(vec3(x0 - 0.25, y1 + 0.09, z + 0.09), vec3(x1 + 0.25, y1 + 0.09, z + 0.09), 0.010, n);
    let (nu, nv) = (b.segments(120.0, 6), b.segments(40.0, 1));
    for (left, width) in [(x0 - 0.2, 0.42), (x1 - 0.22, 0.42)] {
        b.paint(p.china);
        b.patch(nu, nv, super::builder::Closure::OPEN, |u, v| {
            let (s, c) = super::math::sin_cos(u * 7.0 * TURN);
            let depth = 0.025 * (1.0 - 0.5 * v);
            let position = vec3(left + u * width, y0 - 0.02 + (y1 - y0 + 0.10) * v, z + 0.09 + depth * s);
            (position, vec3(-depth * c * 7.0 * TURN / width, 0.0, 1.0))
        });
    }
}

/// A rug under the table, woven of blades.
fn rug(b: &mut Builder, p: &Paints) {
    b.paint(p.cloth).cuboid(vec3(-1.5, 0.001, -0.95), vec3(1.5, 0.006, 1.25));
    let pile = b.count(60_000.0, 0, 4_000_000) as usize;
    for (paint, inset) in [(p.cloth, 0.0), (p.wall, 0.12), (p.blue, 0.3)] {
        b.paint(paint).blades(pile / 3, 0.004, |rng| {
            let mut root =
                rng.point(vec3(-1.5 + inset, 0.006, -0.95 + inset), vec3(1.5 - inset, 0.006, 1.25 - inset));
            root.y = 0.006;
            (root, vec3(0.008 * rng.signed(), rng.range(0.010, 0.018), 0.008 * rng.signed()))
        });
    }
}

/// Two lamps over the table, on cords.
fn lamps(b: &mut Builder, p: &Paints) {
    let shade: [Vec2; 5] =
        [vec2(0.19, 0.0), vec2(0.17, 0.06), vec2(0.10, 0.13), vec2(0.04, 0.17), vec2(0.03, 0.22)];
    for x in [-0.62, 0.62] {
        b.within(Frame::at(x, 1.62, 0.15), |b| {
            let (n, m) = (b.segments(64.0, 6), b.segments(24.0, 2));
            b.paint(p.copper).lathe(&shade, n, m);
            b.paint(p.bulb).ball(vec3(0.0, 0.07, 0.0), vec3(0.045, 0.055, 0.045), n / 2);
            b.paint(p.black).cable(vec3(0.0, 0.22, 0.0), vec3(0.03, H - 1.62, 0.06), 0.0, 0.005, n / 8, 2);
        });
    }
}
