//! One scene of the raw JSON.

use crate::basics::number::{Json, Number};

/// What MiB are.
pub(crate) const MIB: f64 = 1_048_576.0;

/// The paper's methods and the presets that they are.
pub(crate) const METHODS: [(&str, &str); 3] =
    [("standard", "standard"), ("fast", "paper-fast"), ("small", "paper-small")];

/// A place in the raw JSON.
#[derive(Clone, Copy, Debug)]
pub struct SceneJson<'a> {
    /// The whole.
    pub json: Json<'a>,
    /// Which scene.
    pub index: usize,
}

impl<'a> SceneJson<'a> {
    /// A pointer below the scene.
    pub fn at(&self, rest: &str) -> String {
        format!("/scenes/{}{rest}", self.index)
    }

    /// A number below the scene.
    pub fn number(&self, rest: &str) -> Number {
        self.json.number(&self.at(rest))
    }

    /// The scene's name.
    pub fn name(&self) -> &'a str {
        self.json.text(&self.at("/name"))
    }

    /// A file name's beginning.
    pub fn slug(&self) -> String {
        crate::measure::slug(self.name())
    }

    /// The presets' names, in order.
    pub fn trees(&self) -> Vec<&'a str> {
        self.json.list(&self.at("/trees")).iter().filter_map(|tree| tree["name"].as_str()).collect()
    }

    /// A number of the tree of that index.
    pub fn tree(&self, index: usize, rest: &str) -> Number {
        self.number(&format!("/trees/{index}{rest}"))
    }

    /// The scene of the paper that it is or is like.
    pub fn published(&self) -> Option<&'a str> {
        self.json.value(&self.at("/published/name")).as_str()
    }

    /// True where it is the paper's own.
    pub fn is_published(&self) -> bool {
        self.json.value(&self.at("/published/same")).as_bool() == Some(true)
    }

    /// How published rows are headed.
    pub fn published_label(&self) -> String {
        let name = self.published().unwrap_or_default();
        if self.is_published() {
            format!("published, {name}")
        } else {
            format!("published, {name} (of its kind)")
        }
    }

    /// A published scene's column in tables that have a column a scene.
    pub(crate) fn published_column(&self) -> String {
        self.published().unwrap_or_default().to_lowercase().replace(' ', "_")
    }

    /// The row of a published table that is of this scene and method.
    pub(crate) fn published_row(&self, table: &str, method: Option<&str>) -> Option<String> {
        let name = self.published()?;
        let at = format!("/published/{table}");
        let row = self.json.list(&at).iter().position(|row| {
            row["scene"] == name && method.is_none_or(|method| row["method"].as_str() == Some(method))
        });
        row.map(|row| format!("{at}/{row}"))
    }
}
