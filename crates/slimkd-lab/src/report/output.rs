//! The report's files, from the raw JSON.

use crate::basics::error::ReportError;
use crate::basics::number::Json;
use crate::measure::write;
use crate::report::page::{Content, page};
use crate::schema::{Peers, Raw, SCHEMA};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Name of the raw measurements below the report's folder.
pub const RAW: &str = "raw.json";
/// Name of the page.
pub const PAGE: &str = "index.html";

/// Writes the raw measurements, then everything that follows from them.
pub fn write_all(folder: &Path, raw: &Raw) -> Result<(), ReportError> {
    let path = folder.join(RAW);
    let fail = |error| ReportError::file(&path, error);
    let value = serde_json::to_value(raw).map_err(fail)?;
    let mut text = serde_json::to_vec_pretty(&value).map_err(fail)?;
    text.push(b'\n');
    write(&path, &text)?;
    render(folder, folder, &value)
}

/// Writes page, tables and plots into `folder`; pictures are below `pictures`.
pub fn render(folder: &Path, pictures: &Path, raw: &Value) -> Result<(), ReportError> {
    let content = Content::new(Json(raw));
    for table in content.tables() {
        write(&folder.join(format!("tables/{}.csv", table.id)), table.csv().as_bytes())?;
        write(&folder.join(format!("tables/{}.md", table.id)), table.markdown().as_bytes())?;
    }
    for figure in content.figures() {
        write(&folder.join(format!("plots/{}.svg", figure.id)), figure.standalone().as_bytes())?;
    }
    let picture = |name: &str| {
        // Only what a report wrote: a name leads nowhere else.
        let plain = name.starts_with("pictures/") && !name.contains("..");
        plain.then(|| fs::read(pictures.join(name)).ok()).flatten()
    };
    write(&folder.join(PAGE), page(&content, &picture).as_bytes())
}

/// Reads raw measurements.
pub fn read_raw(path: &Path) -> Result<Value, ReportError> {
    let text =
        fs::read(path).map_err(|error| ReportError::file(path, format_args!("cannot read: {error}")))?;
    let unusable =
        |error| ReportError::file(path, format_args!("{error}; give a raw.json of `slimkd report`"));
    let value: Value = serde_json::from_slice(&text).map_err(unusable)?;
    let raw: Raw = serde_json::from_value(value.clone()).map_err(unusable)?;
    if raw.schema != SCHEMA {
        let what = format!("version {} of the keys, {SCHEMA} is known; measure again", raw.schema);
        return Err(ReportError::file(path, what));
    }
    Ok(value)
}

/// Reads a file of `slimkd-bench --json`.
pub fn read_peers(path: &Path) -> Result<Peers, ReportError> {
    let text =
        fs::read(path).map_err(|error| ReportError::file(path, format_args!("cannot read: {error}")))?;
    serde_json::from_slice(&text).map_err(|error| {
        ReportError::file(path, format_args!("{error}; give a file of `slimkd-bench --json`"))
    })
}
