//! `power-plant`: boiler house, turbines, pipe racks, tanks, chimneys, pylons, after UNC's Power Plant in Choi et al.
//! (2013): the scene with the most long pipes, braces and railings.

mod boiler;
mod piping;
mod steelwork;
mod tanks;
mod towers;
mod turbines;

use super::builder::{Builder, Paint};
use super::stage::{Filler, Stage, lamp, sun, view};
use glam::{Vec3, vec3};

/// The materials of the plant.
struct Paints {
    ground: Paint,
    gravel: Paint,
    concrete: Paint,
    steel: Paint,
    galvanised: Paint,
    grating: Paint,
    yellow: Paint,
    red: Paint,
    white: Paint,
    blue: Paint,
    green: Paint,
    orange: Paint,
    lagging: Paint,
    copper: Paint,
    chrome: Paint,
    boiler: Paint,
    dark: Paint,
    cable: Paint,
    insulator: Paint,
    lamp: Paint,
}

impl Paints {
    fn new(b: &mut Builder) -> Self {
        Self {
            ground: b.matte("ground", [0.34, 0.33, 0.29]),
            gravel: b.matte("gravel", [0.42, 0.40, 0.37]),
            concrete: b.matte("concrete", [0.52, 0.51, 0.48]),
            steel: b.glossy("painted steel", [0.16, 0.24, 0.32], 0.02),
            galvanised: b.metal("galvanised steel", [0.52, 0.54, 0.56], 0.12),
            grating: b.matte("grating", [0.30, 0.31, 0.32]),
            yellow: b.glossy("safety yellow", [0.80, 0.52, 0.03], 0.02),
            red: b.glossy("red pipe", [0.58, 0.06, 0.04], 0.04),
            white: b.matte("white paint", [0.80, 0.80, 0.78]),
            blue: b.glossy("blue pipe", [0.05, 0.17, 0.46], 0.04),
            green: b.glossy("green pipe", [0.06, 0.30, 0.16], 0.04),
            orange: b.glossy("orange casing", [0.72, 0.27, 0.05], 0.04),
            lagging: b.metal("aluminium lagging", [0.72, 0.73, 0.74], 0.30),
            copper: b.metal("copper", [0.82, 0.42, 0.25], 0.30),
            chrome: b.metal("polished steel", [0.80, 0.80, 0.82], 0.60),
            boiler: b.matte("boiler skin", [0.48, 0.46, 0.42]),
            dark: b.matte("dark steel", [0.07, 0.07, 0.08]),
            cable: b.matte("cable", [0.03, 0.03, 0.03]),
            insulator: b.glossy("porcelain", [0.33, 0.14, 0.07], 0.10),
            lamp: b.glow("lamp", [1.4, 1.3, 1.0]),
        }
    }
}

pub(super) fn draw(b: &mut Builder) -> Stage {
    let p = Paints::new(b);
    b.paint(p.ground).quad(vec3(-140.0, 0.0, -160.0), Vec3::Z * 300.0, Vec3::X * 300.0);
    b.paint(p.gravel).quad(vec3(-30.0, 0.02, -22.0), Vec3::Z * 56.0, Vec3::X * 72.0);
    boiler::draw(b, &p);
    turbines::draw(b, &p);
    piping::draw(b, &p);
    tanks::draw(b, &p);
    towers::draw(b, &p);
    Stage {
        cameras: vec![
            view([43.0, 11.0, 42.0], [-4.0, 13.0, -8.0], 55.0),
            view([30.2, 8.6, 6.4], [8.0, 6.6, -3.0], 60.0),
            view([26.5, 2.0, 17.4], [2.0, 5.2, 11.5], 60.0),
        ],
        lights: vec![
            sun([-0.55, -0.72, -0.45], [1.15, 1.05, 0.90]),
            sun([-0.3, -0.25, -0.8], [0.20, 0.22, 0.26]),
            lamp([-10.0, 10.5, 0.0], 4.0, [0.35, 0.30, 0.22]),
        ],
        filler: Filler {
            paint: p.gravel,
            areas: vec![(vec3(-30.0, 0.02, 22.0), vec3(42.0, 0.02, 34.0))],
            length: 0.08,
            width: 0.05,
        },
    }
}
