//! Findings as JSON. The format is a contract: [`SCHEMA`] increases when it changes.

use serde_json::{Map, Value, json};

use super::{StudyFindings, StudyReport, Trade};

/// Version of the format.
pub const SCHEMA: u32 = 1;

/// A report as one JSON object: `schema`, `program`, `effort`, `machine` {`cpu`, `cores`, `os`,
/// `build`} and `studies`, each {`name`, `title`, `choice`, `columns` [{`key`, `heading`}], `rows`
/// [{`name`, `group`, `values`}], `trades` [{`cost`, `loss`, `front`}]}. `values` goes by the
/// columns' keys; a timed one is {`median`, `min`, `max`, `runs`}, another a number. `front` has
/// the names of its rows.
#[must_use]
pub fn json(report: &StudyReport) -> Value {
    json!({
        "schema": SCHEMA,
        "program": report.program,
        "effort": report.effort,
        "machine": report.machine,
        "studies": report.studies.iter().map(study).collect::<Vec<_>>(),
    })
}

fn study(findings: &StudyFindings) -> Value {
    let of = &findings.study;
    let columns = of
        .columns
        .iter()
        .map(|(key, heading)| json!({"key": key, "heading": heading}));
    let rows = findings.rows.iter().map(|row| {
        let values = of.columns.iter().zip(&row.values);
        let values = values.map(|((key, _), value)| ((*key).to_owned(), json!(value)));
        json!({"name": row.name, "group": row.group, "values": values.collect::<Map<_, _>>()})
    });
    json!({
        "name": of.name,
        "title": of.title,
        "choice": of.choice,
        "columns": columns.collect::<Vec<_>>(),
        "rows": rows.collect::<Vec<_>>(),
        "trades": of.trades.iter().map(|trade| self::trade(findings, trade)).collect::<Vec<_>>(),
    })
}

fn trade(findings: &StudyFindings, trade: &Trade) -> Value {
    let [(cost, _), (loss, _)] = [trade.cost, trade.loss].map(|column| findings.column(column));
    let rows = findings.rows.iter().zip(findings.front(trade));
    let front = rows.filter_map(|(row, on)| on.then_some(&row.name));
    json!({"cost": cost, "loss": loss, "front": front.collect::<Vec<_>>()})
}

#[cfg(test)]
mod tests {
    use super::super::study::example;
    use super::*;

    /// The whole format: a key that is renamed, added or removed fails here, and [`SCHEMA`] must
    /// increase.
    #[test]
    fn the_json_structure_is_stable() {
        let mut report = example();
        report.studies[0].rows.truncate(2);
        let json = self::json(&report);
        let timed = |median: f64, min: f64, max: f64| serde_json::json!({"median": median, "min": min, "max": max, "runs": 5});
        let expected = serde_json::json!({
            "schema": 1,
            "program": "velomotion 0.0.0",
            "effort": "quick",
            "machine": {"cpu": "Processor <4>", "cores": 2, "os": "Linux", "build": "release"},
            "studies": [{
                "name": "example",
                "title": "Ways & means",
                "choice": "way",
                "columns": [
                    {"key": "time_ns", "heading": "ns a point"},
                    {"key": "error_mm", "heading": "worst error, mm"},
                    {"key": "size_bytes", "heading": "bytes"},
                ],
                "rows": [
                    {"name": "coarse <&> way", "group": "plain",
                     "values": {"time_ns": timed(2.0, 1.8, 3.4), "error_mm": 130.0, "size_bytes": 10.0}},
                    {"name": "fine <&> way", "group": "plain",
                     "values": {"time_ns": timed(9.0, 8.1, 15.299_999_999_999_999), "error_mm": 1e-6, "size_bytes": 12.0}},
                ],
                "trades": [
                    {"cost": "time_ns", "loss": "error_mm", "front": ["coarse <&> way", "fine <&> way"]},
                    {"cost": "size_bytes", "loss": "error_mm", "front": ["coarse <&> way", "fine <&> way"]},
                ],
            }],
        });
        assert_eq!(json, expected);
        assert_eq!(SCHEMA, 1);
    }
}
