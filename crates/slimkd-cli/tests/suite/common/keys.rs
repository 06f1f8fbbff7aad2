//! Which keys a JSON value has: an interface that scripts rely on.

use std::collections::BTreeSet;

/// All keys of a JSON value, those of nested objects behind a dot, those of lists' elements behind `[]`.
pub fn keys(value: &serde_json::Value) -> BTreeSet<String> {
    fn walk(prefix: &str, value: &serde_json::Value, out: &mut BTreeSet<String>) {
        match value {
            serde_json::Value::Object(map) => {
                for (key, value) in map {
                    let path = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
                    walk(&path, value, out);
                }
            }
            serde_json::Value::Array(list) => {
                list.iter().for_each(|value| walk(&format!("{prefix}[]"), value, out));
            }
            _ => {
                out.insert(prefix.to_owned());
            }
        }
    }
    let mut out = BTreeSet::new();
    walk("", value, &mut out);
    out
}

/// The set of these keys.
pub fn set(keys: &str) -> BTreeSet<String> {
    keys.split_whitespace().map(str::to_owned).collect()
}
