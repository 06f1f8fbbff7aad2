//! What a caller may choose about loading.

use crate::Origin;

/// Choices for [`super::load_with`]; the default is what [`super::load`] does.
///
/// ```
/// let options = slimkd_scene::LoadOptions::new().scene_index(1);
/// assert_eq!(options.scene_index, Some(1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Which of a glTF file's scenes is loaded, from 0; `None`: the one that the file names as its default. Formats with
    /// one scene have only scene 0.
    pub scene_index: Option<usize>,
    /// Whether files that a scene names (materials, textures, buffers, shapes) may lie outside the scene file's folder.
    pub allow_outside: bool,
    /// Which point of the file's coordinates becomes the mesh's 0.
    pub origin: Origin,
}

impl LoadOptions {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets [`LoadOptions::scene_index`].
    #[must_use]
    pub fn scene_index(mut self, index: usize) -> Self {
        self.scene_index = Some(index);
        self
    }

    /// Sets [`LoadOptions::origin`].
    #[must_use]
    pub fn origin(mut self, origin: Origin) -> Self {
        self.origin = origin;
        self
    }

    /// Sets [`LoadOptions::allow_outside`].
    #[must_use]
    pub fn allow_outside(mut self, allow: bool) -> Self {
        self.allow_outside = allow;
        self
    }
}
