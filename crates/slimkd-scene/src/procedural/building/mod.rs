//! `building`: a glazed office building of many storeys with furniture, after Soda Hall in Choi et al. (2013).

mod desk;
mod library;
mod shell;
mod stairs;

use super::builder::{Builder, Paint};
use super::frame::Frame;
use super::math::TURN;
use super::stage::{Filler, Stage, lamp, sun, view};
use super::tree::{self, Habit};
use glam::{Vec3, vec3};

/// Half the length (x) and half the depth (z) of the floors, metres.
const X: f32 = 18.0;
const Z: f32 = 8.0;
/// From floor to floor, metres; thickness of a slab.
const STOREY: f32 = 3.5;
const SLAB: f32 = 0.3;
/// Number of storeys.
const STOREYS: u32 = 6;

/// The materials of the building.
struct Paints {
    concrete: Paint,
    floor: Paint,
    carpet: Paint,
    wall: Paint,
    steel: Paint,
    dark_steel: Paint,
    chrome: Paint,
    pane: Paint,
    inner_pane: Paint,
    wood: Paint,
    white: Paint,
    black: Paint,
    display: Paint,
    lamp: Paint,
    fabric: [Paint; 3],
    books: [Paint; 6],
    paper: Paint,
    cable: [Paint; 3],
    leaf: Paint,
    leaf_light: Paint,
    bark: Paint,
    grass: Paint,
    paving: Paint,
}

impl Paints {
    fn new(b: &mut Builder) -> Self {
        Self {
            concrete: b.matte("concrete", [0.50, 0.49, 0.47]),
            floor: b.glossy("terrazzo", [0.56, 0.54, 0.50], 0.07),
            carpet: b.matte("carpet", [0.26, 0.30, 0.34]),
            wall: b.matte("plaster", [0.76, 0.75, 0.72]),
            steel: b.metal("steel", [0.58, 0.59, 0.61], 0.25),
            dark_steel: b.metal("anodised frame", [0.10, 0.11, 0.12], 0.08),
            chrome: b.metal("chrome", [0.80, 0.80, 0.82], 0.65),
            pane: b.pane("facade glass", 0.12),
            inner_pane: b.pane("partition glass", 0.06),
            wood: b.glossy("oak", [0.50, 0.31, 0.15], 0.06),
            white: b.glossy("white", [0.78, 0.78, 0.77], 0.04),
            black: b.glossy("black", [0.025, 0.025, 0.028], 0.06),
            display: b.glow("display", [0.16, 0.30, 0.48]),
            lamp: b.glow("lamp", [1.25, 1.2, 1.1]),
            fabric: [
                b.matte("blue fabric", [0.07, 0.15, 0.34]),
                b.matte("orange fabric", [0.62, 0.22, 0.04]),
                b.matte("grey fabric", [0.36, 0.37, 0.38]),
            ],
            books: [
                b.matte("red book", [0.45, 0.05, 0.04]),
                b.matte("green book", [0.06, 0.22, 0.10]),
                b.matte("blue book", [0.06, 0.12, 0.34]),
                b.matte("ochre book", [0.55, 0.36, 0.10]),
                b.matte("grey book", [0.35, 0.34, 0.32]),
                b.matte("cream book", [0.72, 0.66, 0.52]),
            ],
            paper: b.matte("paper", [0.85, 0.85, 0.83]),
            cable: [
                b.matte("black cable", [0.03, 0.03, 0.03]),
                b.matte("blue cable", [0.04, 0.12, 0.45]),
                b.matte("yellow cable", [0.65, 0.50, 0.05]),
            ],
            leaf: b.matte("leaf", [0.10, 0.30, 0.05]),
            leaf_light: b.matte("young leaf", [0.22, 0.42, 0.07]),
            bark: b.matte("bark", [0.22, 0.17, 0.12]),
            grass: b.matte("grass", [0.15, 0.30, 0.06]),
            paving: b.matte("paving", [0.42, 0.41, 0.39]),
        }
    }
}

pub(super) fn draw(b: &mut Builder) -> Stage {
    let p = Paints::new(b);
    shell::draw(b, &p);
    for storey in 0..STOREYS {
        b.within(Frame::at(0.0, STOREY * storey as f32, 0.0), |b| {
            if storey + 1 < STOREYS {
                stairs::draw(b, &p);
            }
            shell::services(b, &p);
            furnish(b, &p, storey);
        });
    }
    outside(b, &p);
    let eye = |storey: f32| STOREY * storey + 1.7;
    let mut lights = vec![sun([-0.42, -0.60, -0.68], [1.0, 0.92, 0.78])];
    for (storey, x) in [(2.0, -14.0), (2.0, -5.0), (4.0, 5.0), (4.0, 14.0)] {
        lights.push(lamp([x, STOREY * storey + 2.1, 3.6], 3.0, [0.52, 0.51, 0.48]));
    }
    Stage {
        cameras: vec![
            view([-4.1, eye(2.0), 6.9], [-12.0, eye(2.0) - 0.75, -0.6], 60.0),
            view([27.0, 5.5, 29.0], [-1.0, 8.6, 0.0], 46.0),
            view([4.0, eye(4.0), 6.9], [10.5, eye(4.0) - 0.55, -1.6], 60.0),
        ],
        lights,
        filler: Filler {
            paint: p.grass,
            areas: vec![
                (vec3(-30.0, 0.0, 14.0), vec3(30.0, 0.0, 24.0)),
                (vec3(-30.0, 0.0, -20.0), vec3(30.0, 0.0, -12.0)),
            ],
            length: 0.18,
            width: 0.015,
        },
    }
}

/// West and east wing of a storey.
fn furnish(b: &mut Builder, p: &Paints, storey: u32) {
    b.paint(p.carpet);
    for x in [-17.2, 4.0] {
        b.quad(vec3(x, 0.004, -5.9), Vec3::Z * 11.6, Vec3::X * 13.2);
    }
    desks(b, p, -1.0);
    match storey % 3 {
        0 => lounge(b, p),
        1 => library::draw(b, p),
        _ => desks(b, p, 1.0),
    }
    let pots = if b.has(0.03) { 4 } else { 0 };
    for (x, z) in [(-17.2, 7.2), (17.2, 7.2), (-3.6, -7.2), (3.6, -7.2)].into_iter().take(pots) {
        b.within(Frame::at(x, 0.0, z), |b| potted(b, p));
    }
}

/// Rows of double desks in the wing on one side.
fn desks(b: &mut Builder, p: &Paints, side: f32) {
    let (columns, rows) = match () {
        () if b.has(0.10) => (4, 4),
        () if b.has(0.04) => (3, 2),
        () => (1, 1),
    };
    for i in 0..columns {
        let x = side * (4.2 + 12.4 * (i as f32 + 0.5) / columns as f32);
        for j in 0..rows {
            let z = -5.6 + 11.2 * (j as f32 + 0.5) / rows as f32;
            for half in [1.0, -1.0] {
                let turn = if half > 0.0 { 0.0 } else { 0.5 * TURN };
                b.within(Frame::at(x, 0.0, z + 0.42 * half).turned(turn), |b| desk::draw(b, p));
            }
            if b.has(0.06) {
                b.paint(p.fabric[2]).cuboid(vec3(x - 0.8, 0.5, z - 0.015), vec3(x + 0.8, 1.15, z + 0.015));
            }
        }
    }
}

/// Sofas and low tables.
fn lounge(b: &mut Builder, p: &Paints) {
    let groups = if b.has(0.04) { 3 } else { 0 };
    let (n, m) = (b.segments(12.0, 0), b.segments(56.0, 4));
    for k in 0..groups {
        let x = 6.5 + 4.2 * k as f32;
        for side in [-1.0, 1.0] {
            let frame = Frame::at(x, 0.0, 1.6 + 1.5 * side).turned(if side > 0.0 { 0.0 } else { 0.5 * TURN });
            b.within(frame, |b| {
                b.paint(p.fabric[k % 3]);
                b.pillow(vec3(0.0, 0.24, 0.0), vec3(1.0, 0.16, 0.42), 0.05, n / 2);
                b.pillow(vec3(0.0, 0.62, 0.38), vec3(1.0, 0.34, 0.10), 0.08, n / 2);
                for x in [-0.5, 0.5] {
                    b.pillow(vec3(x, 0.46, -0.05), vec3(0.48, 0.08, 0.36), 0.07, n);
                    b.pillow(vec3(2.2 * x, 0.42, 0.0), vec3(0.10, 0.24, 0.42), 0.06, n / 2);
                }
            });
        }
        b.paint(p.wood).rod(vec3(x, 0.36, 1.6), vec3(x, 0.40, 1.6), 0.5, m);
        b.paint(p.chrome).cone(vec3(x, 0.0, 1.6), vec3(x, 0.36, 1.6), 0.05, 0.04, m / 2, true);
        b.within(Frame::at(x, 0.40, 1.6), |b| desk::mug(b, p.white));
    }
}

/// A plant in a box.
fn potted(b: &mut Builder, p: &Paints) {
    b.paint(p.white).block(0.0, 0.0, 0.0, vec3(0.42, 0.5, 0.42));
    let count = b.count(520.0, 4, 60_000);
    let size = 0.16 * (520.0 / count as f32).sqrt().sqrt().clamp(0.5, 2.2);
    for paint in [p.leaf, p.leaf_light] {
        b.paint(paint).leaves(count as usize / 2, |rng| {
            let base = vec3(0.0, 1.1, 0.0) + rng.direction() * vec3(0.36, 0.62, 0.36) * rng.unit().sqrt();
            super::shapes::Leaf::scattered(rng, base, size, 0.8)
        });
    }
}

/// Paving, lawn, a row of trees.
fn outside(b: &mut Builder, p: &Paints) {
    b.paint(p.grass).quad(vec3(-60.0, -0.02, -50.0), Vec3::Z * 100.0, Vec3::X * 120.0);
    b.paint(p.paving).quad(vec3(-24.0, -0.01, -12.0), Vec3::Z * 26.0, Vec3::X * 48.0);
    let trees = if b.has(0.035) { 5 } else { 0 };
    for k in 0..trees {
        let habit = Habit { trunk: 1.9, girth: 0.17, leaves: 9_000.0, leaf: 0.16 };
        let x = -22.0 + 9.0 * k as f32;
        b.within(Frame::at(x, 0.0, if k % 2 == 0 { 16.5 } else { 18.5 }), |b| {
            tree::draw(b, p.bark, [p.leaf, p.leaf_light], habit);
        });
    }
}
