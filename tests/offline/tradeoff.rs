//! `velomotion tradeoff`.

use super::*;

/// A quick run gives one JSON object, the same on stdout and in the report, and
/// overwrites nothing.
#[test]
fn the_cost_of_accuracy_is_measured_and_reported() {
    let place = Place::new();
    let output = place.run("tradeoff --quick --json --report out --markdown book");
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{printed}");
    let report = json(&output);
    assert_eq!(
        (&report["schema"], &report["effort"]),
        (&"tradeoff-1".into(), &"quick".into())
    );
    for key in ["cpu", "cores", "os", "build"] {
        assert!(!report["machine"][key].is_null(), "{key}");
    }
    let studies = report["studies"].as_array().unwrap();
    assert_eq!(studies.len(), 1);
    let study = &studies[0];
    assert_eq!(study["name"], "scan-speed");
    assert_study_complete(study);
    assert!(
        printed.contains(study["title"].as_str().unwrap()),
        "{printed}"
    );
    let file = |name: &str| std::fs::read_to_string(place.path(name)).unwrap();
    assert_eq!(
        serde_json::from_str::<serde_json::Value>(&file("out/tradeoff.json")).unwrap(),
        report
    );
    let (html, page) = (file("out/index.html"), file("book/tradeoff.md"));
    let figure = file("out/scan-speed.svg");
    assert!(figure.starts_with("<svg") && html.contains(&figure));
    assert_eq!(file("book/tradeoff/scan-speed.svg"), figure);
    assert!(page.contains("(tradeoff/scan-speed.svg)"));
    place.fails(
        "tradeoff --quick --report out",
        2,
        &["index.html", "--force"],
    );

    // Computed values repeat, and the text fits a terminal.
    let again = json(&place.run("tradeoff --quick --json"));
    assert_eq!(again["studies"], report["studies"]);
    let text = place.run("tradeoff --quick");
    let text = String::from_utf8(text.stdout).unwrap();
    assert!(
        text.contains("56.25 deg/s") && text.contains("A quick look"),
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
}

/// Checks that every row has every column, that spreads are ordered, and that fronts name rows.
fn assert_study_complete(study: &serde_json::Value) {
    let rows = study["rows"].as_array().unwrap();
    let columns = study["columns"].as_array().unwrap();
    assert!(rows.len() > 3 && columns.len() > 1, "{study}");
    for row in rows {
        let values = row["values"].as_object().unwrap();
        assert_eq!(values.len(), columns.len(), "{row}");
        for column in columns {
            let value = &values[column["key"].as_str().unwrap()];
            let of = |name: &str| value[name].as_f64().unwrap();
            if value.is_object() {
                assert!(
                    0.0 < of("min") && of("min") <= of("median") && of("median") <= of("max"),
                    "{row}"
                );
                assert!(value["runs"].as_u64().unwrap() > 1, "{row}");
            } else {
                // An unknown bound is null.
                assert!(value.is_null() || value.as_f64().unwrap() >= 0.0, "{row}");
            }
        }
    }
    for trade in study["trades"].as_array().unwrap() {
        let front = trade["front"].as_array().unwrap();
        assert!(!front.is_empty(), "{trade}");
        assert!(
            front
                .iter()
                .all(|name| rows.iter().any(|row| row["name"] == *name)),
            "{trade}"
        );
    }
}
