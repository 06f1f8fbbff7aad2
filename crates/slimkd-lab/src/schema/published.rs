//! The paper's tables (talk at Pacific Graphics 2013), and which of its scenes ours are like.

use crate::schema::Published;
use serde_json::{Map, Number, Value};

const TABLES: [(&str, &str); 8] = [
    ("build_time", include_str!("published/build_time.csv")),
    ("duplication_histogram", include_str!("published/duplication_histogram.csv")),
    ("frame_rate", include_str!("published/frame_rate.csv")),
    ("geometry_size", include_str!("published/geometry_size.csv")),
    ("longest_edges", include_str!("published/longest_edges.csv")),
    ("max_depth", include_str!("published/max_depth.csv")),
    ("tree_size", include_str!("published/tree_size.csv")),
    ("very_large_scene", include_str!("published/very_large_scene.csv")),
];

/// Beginnings of names: the paper's own scene, then scenes of its kind.
const KINDS: [(&str, &str, bool); 10] = [
    ("bart_kitchen_101015", "Kitchen", true),
    ("kitchen", "Kitchen", false),
    ("conference", "Conference", false),
    ("clinic_architectural", "Conference", false),
    ("clinic", "Soda Hall", false),
    ("building", "Soda Hall", false),
    ("courtyard", "San Miguel", false),
    ("power-plant", "Power Plant", false),
    ("bodo_mep", "Power Plant", false),
    ("west_riverside_hospital", "Power Plant", false),
];

/// The scene of the paper that a scene of this name is, or is of the kind of.
pub(crate) fn of_scene(name: &str) -> Option<Published> {
    let (_, name, same) = KINDS.iter().find(|(start, ..)| name.starts_with(start))?;
    Some(Published { name: (*name).to_owned(), same: *same })
}

/// All tables: a list of rows each, by column name.
pub(crate) fn tables() -> Value {
    TABLES.iter().map(|(name, text)| ((*name).to_owned(), rows(text))).collect::<Map<_, _>>().into()
}

fn rows(text: &str) -> Value {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let row = |line: &str| names.iter().map(|&name| name.to_owned()).zip(line.split(',').map(cell)).collect();
    lines.map(|line| Value::Object(row(line))).collect()
}

fn cell(text: &str) -> Value {
    if let Ok(whole) = text.parse::<u64>() {
        return whole.into();
    }
    let number = text.parse().ok().and_then(Number::from_f64);
    number.map_or_else(|| if text.is_empty() { Value::Null } else { text.into() }, Value::Number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read() {
        let tables = tables();
        assert_eq!(tables["tree_size"][2]["t_inner_nodes"], 32_859);
        assert_eq!(tables["frame_rate"][0]["view1_cpu1"], 0.867);
        assert_eq!(tables["longest_edges"][0]["kitchen_mean_longest_edge"], Value::Null);
        assert_eq!(tables["longest_edges"][0]["references"], ">10000");
    }

    #[test]
    fn only_the_papers_kitchen_is_the_papers() {
        assert!(of_scene("bart_kitchen_101015").unwrap().same);
        assert!(!of_scene("kitchen").unwrap().same);
        assert_eq!(of_scene("scan_stanford_bunny"), None);
    }
}
