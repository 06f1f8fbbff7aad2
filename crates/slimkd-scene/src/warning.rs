//! What a loader tells although the scene was loaded.

use std::fmt;

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum WarningKind {
    /// The file holds something that this crate does not read, and that was left out: lines, skins, an extension.
    Ignored,
    /// The file refers to something that is not there: a texture, a material, a buffer.
    Missing,
    /// A part of the file breaks its format's rules; that part was left out or repaired.
    Invalid,
    /// A polygon has no single right triangulation, because its outline crosses itself.
    Polygon,
    /// The numbers of the file are finer than `f32` can hold, so vertices moved.
    Precision,
    /// Triangles have no area, or a coordinate that is not finite: they keep their ids and are never hit. Loaders do not look for them;
    /// [`slimkd::TreeStatistics::degenerate`] and [`crate::MeshCheck`] count them.
    Degenerate,
    /// There were more warnings than a scene keeps.
    More,
}

impl WarningKind {
    /// The kind in one word, as scripts read it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ignored => "ignored",
            Self::Missing => "missing",
            Self::Invalid => "invalid",
            Self::Polygon => "polygon",
            Self::Precision => "precision",
            Self::Degenerate => "degenerate",
            Self::More => "more",
        }
    }
}

impl fmt::Display for WarningKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// One thing that a loader left out, replaced or found odd. [`fmt::Display`] gives one line.
///
/// ```
/// use slimkd_scene::{Warning, WarningKind};
/// let warning = Warning::counted(WarningKind::Ignored, 3, 40, "primitives are lines and were left out");
/// assert_eq!(warning.to_string(), "3 of 40 primitives are lines and were left out");
/// assert_eq!(warning.count(), Some((3, 40)));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Warning {
    /// What it is about.
    pub kind: WarningKind,
    text: String,
    count: Option<(u64, u64)>,
}

impl Warning {
    /// A warning of that text; line breaks in it become blanks.
    pub fn new(kind: WarningKind, text: impl AsRef<str>) -> Self {
        Self { kind, text: text.as_ref().split_whitespace().collect::<Vec<_>>().join(" "), count: None }
    }

    /// A warning about `count` of `total` things; `what` goes on behind the numbers.
    pub fn counted(kind: WarningKind, count: u64, total: u64, what: impl fmt::Display) -> Self {
        Self { count: Some((count, total)), ..Self::new(kind, format!("{count} of {total} {what}")) }
    }

    /// The same warning about one of several files: its name stands before the text.
    #[must_use]
    pub fn within(self, file: impl fmt::Display) -> Self {
        Self { text: Self::new(self.kind, format!("{file}: {}", self.text)).text, ..self }
    }

    /// The whole warning in one line.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// How many things it is about, and how many there are of that sort; `None` where nothing was counted.
    pub fn count(&self) -> Option<(u64, u64)> {
        self.count
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Most warnings that a scene keeps: enough to see what is wrong.
const MAX_WARNINGS: usize = 100;

/// Adds a warning while there is room for it.
pub(crate) fn warn(warnings: &mut Vec<Warning>, warning: Warning) {
    if warnings.len() < MAX_WARNINGS {
        warnings.push(warning);
    } else if warnings.len() == MAX_WARNINGS {
        warnings.push(Warning::new(WarningKind::More, "there is more to warn of; these are the first"));
    }
}
