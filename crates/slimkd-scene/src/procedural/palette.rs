//! Materials that several scenes share. Colours are linear.

use super::builder::{Builder, Paint};
use crate::Material;
use glam::Vec3;

fn named(name: &str, diffuse: [f32; 3]) -> Material {
    Material { name: name.to_owned(), diffuse: diffuse.into(), ..Material::default() }
}

impl Builder {
    /// No gloss at all.
    pub(crate) fn matte(&mut self, name: &str, diffuse: [f32; 3]) -> Paint {
        self.material(named(name, diffuse))
    }

    /// Varnish, glaze, plastic: a highlight and a share of mirror.
    pub(crate) fn glossy(&mut self, name: &str, diffuse: [f32; 3], reflection: f32) -> Paint {
        self.material(Material {
            specular: Vec3::splat(0.25),
            shininess: 60.0,
            reflection,
            ..named(name, diffuse)
        })
    }

    /// Polished or brushed metal.
    pub(crate) fn metal(&mut self, name: &str, color: [f32; 3], reflection: f32) -> Paint {
        self.material(Material {
            specular: Vec3::from(color) * 0.7,
            shininess: 90.0,
            reflection,
            ..named(name, Vec3::from(color).to_array().map(|c| c * (1.0 - reflection)))
        })
    }

    /// A solid piece of glass, or water.
    pub(crate) fn glass(&mut self, name: &str, ior: f32) -> Paint {
        self.material(Material {
            specular: Vec3::splat(0.5),
            shininess: 200.0,
            transmission: 0.92,
            ior,
            ..named(name, [0.03, 0.035, 0.035])
        })
    }

    /// A window pane of a single sheet: straight through, a faint mirror.
    pub(crate) fn pane(&mut self, name: &str, reflection: f32) -> Paint {
        self.material(Material {
            specular: Vec3::splat(0.4),
            shininess: 200.0,
            reflection,
            transmission: 0.9 - reflection,
            ior: 1.0,
            ..named(name, [0.02, 0.03, 0.03])
        })
    }

    /// Something that shines by itself.
    pub(crate) fn glow(&mut self, name: &str, emission: [f32; 3]) -> Paint {
        self.material(Material { emission: emission.into(), ..named(name, [0.8; 3]) })
    }
}
