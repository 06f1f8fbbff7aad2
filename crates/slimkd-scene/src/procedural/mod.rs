//! Built-in scenes of any size, of the kinds in Choi, Chang & Ihm (2013), section 5: a kitchen, a conference room, a
//! many-storeyed building, a planted courtyard and a power plant. They need no file and no licence.
//!
//! Like the paper's, they mix a few huge or long skinny triangles (walls, blinds, mullions, pipes, cables, braces)
//! with very many small ones, which is what makes a kd-tree refer to a triangle many times. More triangles mean
//! finer curves, more leaves, more cobbles; the architecture stays. The same name, number and seed give the same
//! bits on every machine.
//!
//! ```
//! let scene = slimkd_scene::procedural::generate("kitchen", 10_000).expect("a built-in scene");
//! assert_eq!(scene.mesh.len(), 10_000);
//! ```

mod builder;
mod building;
mod conference;
mod courtyard;
mod frame;
mod kitchen;
mod math;
mod palette;
mod power_plant;
mod shapes;
mod stage;
mod tree;

#[cfg(test)]
mod tests;

use crate::{Scene, UpAxis};
use builder::Builder;
use stage::Stage;

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct BuiltIn {
    /// What `generate` knows it by.
    pub name: &'static str,
    /// One line.
    pub description: &'static str,
    /// Number of triangles unless another one is asked for.
    pub triangles: usize,
    draw: fn(&mut Builder) -> Stage,
}

const SCENES: &[BuiltIn] = &[
    BuiltIn {
        name: "kitchen",
        description: "a kitchen with a laid table, pots, plates, glasses and fruit",
        triangles: 400_000,
        draw: kitchen::draw,
    },
    BuiltIn {
        name: "conference",
        description: "a conference room with swivel chairs, blinds, a screen and a louvred ceiling",
        triangles: 300_000,
        draw: conference::draw,
    },
    BuiltIn {
        name: "building",
        description: "a glazed office building of six storeys with stairs, desks, chairs, shelves and cables",
        triangles: 1_500_000,
        draw: building::draw,
    },
    BuiltIn {
        name: "courtyard",
        description: "a planted courtyard with arcades, tiled roofs, trees, hedges and a fountain",
        triangles: 1_000_000,
        draw: courtyard::draw,
    },
    BuiltIn {
        name: "power-plant",
        description: "a power plant: boiler house, turbines, pipe racks, stairs, tanks, chimneys, pylons",
        triangles: 2_000_000,
        draw: power_plant::draw,
    },
];

/// All built-in scenes.
pub fn list() -> &'static [BuiltIn] {
    SCENES
}

/// The built-in scene of that name.
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    SCENES.iter().find(|scene| scene.name == name)
}

/// The scene `name` with `triangles` triangles; `None` for an unknown name or more triangles than 32-bit ids can name.
/// Below what the bare architecture takes (under 3,000) it has more than was asked for.
pub fn generate(name: &str, triangles: usize) -> Option<Scene> {
    generate_seeded(name, triangles, 0)
}

/// The same with other random numbers: other leaves, other books, the same rooms.
pub fn generate_seeded(name: &str, triangles: usize, seed: u64) -> Option<Scene> {
    let scene = find(name)?;
    if triangles >= u32::MAX as usize {
        return None;
    }
    let detail = calibrate(scene, triangles, seed);
    let mut counter = Builder::counting(detail, seed);
    let stage = (scene.draw)(&mut counter);
    let rest = triangles.saturating_sub(counter.triangle_count());
    stage.filler.fill(&mut counter, rest);

    let mut builder = Builder::emitting(detail, seed, &counter);
    let stage = (scene.draw)(&mut builder);
    stage.filler.fill(&mut builder, rest);
    let mut scene = builder.finish(name)?;
    scene.cameras = stage.cameras;
    scene.lights = stage.lights;
    scene.up = Some(UpAxis::Y);
    Some(scene)
}

/// The finest detail whose count stays within `triangles`, by galloping and bisection.
fn calibrate(scene: &BuiltIn, triangles: usize, seed: u64) -> f32 {
    let count = |detail: f32| {
        let mut counter = Builder::counting(detail, seed);
        (scene.draw)(&mut counter);
        counter.triangle_count()
    };
    let (mut low, mut high) = (COARSEST, COARSEST * 1.5);
    while high < FINEST && count(high) <= triangles {
        (low, high) = (high, high * 1.5);
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if count(middle) <= triangles {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Detail at which every curve has its least number of segments.
const COARSEST: f32 = 0.02;
/// Detail beyond any mesh that 32-bit ids can name.
const FINEST: f32 = 150.0;
/// Halvings of the bracket: the remainder is then a few thousandths, which the filler takes.
const BISECTIONS: u32 = 18;
