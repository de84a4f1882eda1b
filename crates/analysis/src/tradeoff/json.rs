//! Findings as JSON. The format is a contract: [`SCHEMA`] increases when it changes.

use std::collections::BTreeMap;

use serde::Serialize;

use super::{Effort, Machine, Measurement, StudyFindings, StudyReport, Trade};

/// Version of the format.
pub const SCHEMA: u32 = 1;

/// A report as one JSON object: `schema`, `program`, `effort`, `machine` {`cpu`, `cores`, `os`,
/// `build`} and `studies`, each {`name`, `title`, `choice`, `columns` [{`key`, `heading`}], `rows`
/// [{`name`, `group`, `values`}], `trades` [{`cost`, `loss`, `front`}]}. `values` goes by the
/// columns' keys; a timed one is {`median`, `min`, `max`, `runs`}, another a number. `front` has
/// the names of its rows.
#[derive(Debug, Serialize)]
pub struct Json<'a> {
    schema: u32,
    program: &'a str,
    effort: Effort,
    machine: &'a Machine,
    studies: Vec<StudyJson<'a>>,
}

#[derive(Debug, Serialize)]
struct StudyJson<'a> {
    name: &'a str,
    title: &'a str,
    choice: &'a str,
    columns: Vec<ColumnJson>,
    rows: Vec<RowJson<'a>>,
    trades: Vec<TradeJson<'a>>,
}

#[derive(Debug, Serialize)]
struct ColumnJson {
    key: &'static str,
    heading: &'static str,
}

#[derive(Debug, Serialize)]
struct RowJson<'a> {
    name: &'a str,
    group: &'a str,
    values: BTreeMap<&'static str, &'a Measurement>,
}

#[derive(Debug, Serialize)]
struct TradeJson<'a> {
    cost: &'static str,
    loss: &'static str,
    front: Vec<&'a str>,
}

/// A report, ready to be serialised.
#[must_use]
pub fn report(report: &StudyReport) -> Json<'_> {
    Json {
        schema: SCHEMA,
        program: &report.program,
        effort: report.effort,
        machine: &report.machine,
        studies: report.studies.iter().map(study).collect(),
    }
}

fn study(findings: &StudyFindings) -> StudyJson<'_> {
    let columns = findings.columns.iter().map(|column| ColumnJson {
        key: column.key,
        heading: column.heading,
    });
    let rows = findings.rows.iter().map(|row| RowJson {
        name: &row.name,
        group: row.group,
        values: findings
            .columns
            .iter()
            .map(|c| c.key)
            .zip(&row.values)
            .collect(),
    });
    StudyJson {
        name: findings.name,
        title: findings.title,
        choice: findings.choice,
        columns: columns.collect(),
        rows: rows.collect(),
        trades: findings.trades.iter().map(|t| trade(findings, t)).collect(),
    }
}

fn trade<'a>(findings: &'a StudyFindings, trade: &Trade) -> TradeJson<'a> {
    let key = |column: usize| findings.columns.get(column).map_or("", |c| c.key);
    let on = findings.front(trade);
    let rows = findings.rows.iter().zip(on).filter(|(_, on)| *on);
    TradeJson {
        cost: key(trade.cost),
        loss: key(trade.loss),
        front: rows.map(|(row, _)| row.name.as_str()).collect(),
    }
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
        let json = serde_json::to_value(self::report(&report)).unwrap();
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
