//! Every number of a page is computed again from the raw JSON; runs differ in times alone; a run goes on where it stopped.

use crate::common::report;
use serde_json::Value;
use slimkd_lab::{ReportError, report::output};
use std::fs;
use std::time::Duration;

/// Computes expressions again, on its own.
struct Parser<'a> {
    text: &'a str,
    json: &'a Value,
}

impl Parser<'_> {
    fn expression(&mut self) -> f64 {
        if let Some(rest) = self.text.strip_prefix('(') {
            self.text = rest;
            let left = self.expression();
            let mut signs = self.text.chars().filter(|c| *c != ' ');
            let sign = signs.next().unwrap();
            self.text = self.text.trim_start().strip_prefix(sign).unwrap().trim_start();
            let right = self.expression();
            self.text = self.text.strip_prefix(')').unwrap();
            return match sign {
                '+' => left + right,
                '−' => left - right,
                '×' => left * right,
                '÷' => left / right,
                other => panic!("{other}"),
            };
        }
        if let Some(rest) = self.text.strip_prefix("median(") {
            let end = rest.find(')').unwrap();
            let mut values: Vec<f64> = match self.json.pointer(&rest[..end]) {
                Some(list) => list.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect(),
                None => panic!("nothing at {}", &rest[..end]),
            };
            self.text = &rest[end + 1..];
            values.sort_by(f64::total_cmp);
            let n = values.len();
            return (values[(n - 1) / 2] + values[n / 2]) / 2.0;
        }
        let end = self.text.find([' ', ')']).unwrap_or(self.text.len());
        let (leaf, rest) = self.text.split_at(end);
        self.text = rest;
        if leaf.starts_with('/') {
            self.json.pointer(leaf).and_then(Value::as_f64).unwrap_or(f64::NAN)
        } else {
            leaf.parse().unwrap()
        }
    }
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let start = tag.find(&format!(" {name}=\""))? + name.len() + 3;
    Some(&tag[start..start + tag[start..].find('"')?])
}

fn evaluate(from: &str, json: &Value) -> f64 {
    let from = from.replace("&amp;", "&");
    let mut parser = Parser { text: &from, json };
    let value = parser.expression();
    assert_eq!(parser.text, "", "{from}");
    value
}

#[test]
fn every_number_is_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    report(folder.path(), None).unwrap();
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("raw.json")).unwrap()).unwrap();
    let html = fs::read_to_string(folder.path().join("index.html")).unwrap();
    for outside in [" src=\"http", " href=\"http", "<script", "@import", "url("] {
        assert!(!html.contains(outside), "the page needs {outside}");
    }
    let mut fields = 0;
    for part in html.split('<').filter(|part| part.starts_with("td") || part.starts_with("span data-from")) {
        let (tag, text) = part.split_once('>').unwrap();
        let Some(from) = attribute(tag, "data-from") else {
            let looks = text.replace(['.', ',', '−', '%', ' '], "");
            assert!(looks.is_empty() || looks.parse::<f64>().is_err(), "{text} comes from nowhere");
            continue;
        };
        fields += 1;
        let value = evaluate(from, &json);
        if !value.is_finite() {
            assert_eq!(text, "–", "{from}");
            continue;
        }
        let digits: i32 = attribute(tag, "data-digits").unwrap().parse().unwrap();
        let shown: f64 =
            text.replace(',', "").replace('−', "-").parse().unwrap_or_else(|_| panic!("{text}: {from}"));
        let tolerance = 0.5 * 10f64.powi(-digits) * (1.0 + 1e-9) + 1e-9 * value.abs();
        assert!((shown - value).abs() <= tolerance, "{shown} is not {value}: {from}");
    }
    let mut marks = 0;
    for part in html.split('<').filter(|part| part.contains(" data-value=\"")) {
        let value: f64 = attribute(part, "data-value").unwrap().parse().unwrap();
        let again = evaluate(attribute(part, "data-from").unwrap(), &json);
        assert!((value - again).abs() <= 1e-9 * again.abs() + 1e-12, "{part}");
        marks += 1;
    }
    assert!(fields > 500 && marks > 100, "{fields} fields, {marks} marks");

    // The same numbers are in the CSVs, which have every table.
    let tables: Vec<_> = fs::read_dir(folder.path().join("tables")).unwrap().collect();
    let csv = tables.iter().filter(|entry| entry.as_ref().unwrap().path().extension().unwrap() == "csv");
    assert_eq!(csv.count(), html.matches("<table>").count());
    let plots = fs::read_dir(folder.path().join("plots")).unwrap().count();
    assert_eq!(plots, html.matches("class=\"plot\"").count());
    assert_eq!(html.matches("<img").count(), html.matches("data:image/").count());
    let on =
        |scene: usize| json["scenes"][scene]["frames"].as_array().unwrap().iter().map(|unit| &unit["device"]);
    assert!(on(0).any(|device| device == "gpu"));
    assert!(on(1).count() > 0 && on(1).all(|device| device == "cpu"), "the very large scene is for the CPU");
    for word in
        ["published, Kitchen", "The very large scene", "Beside other libraries", "kitchen &lt;&amp;&gt;"]
    {
        assert!(html.contains(word), "{word}");
    }
}

/// What may differ between two runs.
fn without_times(mut value: Value) -> Value {
    match &mut value {
        Value::Object(map) => {
            map.retain(|key, _| !key.contains("seconds") && key != "date");
            map.values_mut().for_each(|value| *value = without_times(value.take()));
        }
        Value::Array(list) => list.iter_mut().for_each(|value| *value = without_times(value.take())),
        _ => {}
    }
    value
}

#[test]
fn runs_differ_in_times_alone_and_go_on_where_they_stopped() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let raw = |folder: &tempfile::TempDir| -> Value {
        serde_json::from_slice(&fs::read(folder.path().join("raw.json")).unwrap()).unwrap()
    };
    report(one.path(), None).unwrap();
    let error = report(two.path(), Some(Duration::ZERO)).unwrap_err();
    assert!(matches!(error, ReportError::TimeUp { .. }), "{error}");
    assert!(!two.path().join("raw.json").exists());
    // A little at a time.
    let mut calls = 0;
    while let Err(error) = report(two.path(), Some(Duration::from_millis(400))) {
        assert!(matches!(error, ReportError::TimeUp { .. }), "{error}");
        calls += 1;
        assert!(calls < 1000);
    }
    assert_eq!(without_times(raw(&one)), without_times(raw(&two)));
    for entry in fs::read_dir(one.path().join("pictures")).unwrap() {
        let name = entry.unwrap().file_name();
        let read = |folder: &tempfile::TempDir| fs::read(folder.path().join("pictures").join(&name)).unwrap();
        assert!(read(&one) == read(&two), "{name:?}");
    }

    // Nothing is measured again, and the page follows from the raw JSON alone.
    let undated = |folder: &tempfile::TempDir| {
        let mut raw = raw(folder);
        raw["date"].take();
        raw
    };
    let before = undated(&one);
    report(one.path(), Some(Duration::ZERO)).unwrap();
    assert_eq!(undated(&one), before);
    let page = fs::read(one.path().join("index.html")).unwrap();
    let again = tempfile::tempdir().unwrap();
    let value = output::read_raw(&one.path().join("raw.json")).unwrap();
    output::render(again.path(), one.path(), &value).unwrap();
    assert!(fs::read(again.path().join("index.html")).unwrap() == page);
}
