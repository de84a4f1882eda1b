//! Findings as JSON.

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use super::{Effort, Machine, Measurement};
use super::{StudyFindings, StudyReport, Trade};

/// Findings of one run.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TradeoffReport {
    /// Name and version of the program.
    pub program: String,
    /// Size of the workloads.
    pub effort: Effort,
    /// The machine.
    pub machine: Machine,
    /// The studies.
    pub studies: Vec<TradeoffStudy>,
}

/// Findings of one study.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TradeoffStudy {
    /// Name, also of its figure.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// Subject of the choice.
    pub choice: &'static str,
    /// Quantities measured of each choice.
    pub columns: Vec<TradeoffColumn>,
    /// The choices.
    pub rows: Vec<TradeoffRow>,
    /// Costs against losses.
    pub trades: Vec<TradeoffFront>,
}

/// A column.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TradeoffColumn {
    /// Its key in `values`.
    pub key: &'static str,
    /// Heading, with the unit.
    pub heading: &'static str,
}

/// A choice.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TradeoffRow {
    /// Name.
    pub name: String,
    /// Choices of a group are compared.
    pub group: &'static str,
    /// Values by the keys of the columns.
    pub values: BTreeMap<&'static str, Measurement>,
}

/// A trade.
#[derive(Clone, Debug, Serialize, ToSchema)]
#[non_exhaustive]
pub struct TradeoffFront {
    /// Column of the cost.
    pub cost: &'static str,
    /// Column of the loss.
    pub loss: &'static str,
    /// Names of the choices that no other beats in both.
    pub front: Vec<String>,
}

impl TradeoffReport {
    /// A report in this form.
    #[must_use]
    pub fn new(report: &StudyReport) -> Self {
        Self {
            program: report.program.clone(),
            effort: report.effort,
            machine: report.machine.clone(),
            studies: report.studies.iter().map(study).collect(),
        }
    }
}

fn study(findings: &StudyFindings) -> TradeoffStudy {
    let of = &findings.study;
    let columns = || of.columns.iter().copied();
    let rows = findings.rows.iter().map(|row| TradeoffRow {
        name: row.name.clone(),
        group: row.group,
        values: columns()
            .map(|(key, _)| key)
            .zip(row.values.iter().copied())
            .collect(),
    });
    TradeoffStudy {
        name: of.name,
        title: of.title,
        choice: of.choice,
        columns: columns()
            .map(|(key, heading)| TradeoffColumn { key, heading })
            .collect(),
        rows: rows.collect(),
        trades: of
            .trades
            .iter()
            .map(|trade| front(findings, trade))
            .collect(),
    }
}

fn front(findings: &StudyFindings, trade: &Trade) -> TradeoffFront {
    let [(cost, _), (loss, _)] = [trade.cost, trade.loss].map(|column| findings.column(column));
    let rows = findings.rows.iter().zip(findings.front(trade));
    TradeoffFront {
        cost,
        loss,
        front: rows
            .filter(|(_, on)| *on)
            .map(|(row, _)| row.name.clone())
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::report::example;
    use super::*;

    /// The whole format: a key that is renamed, added or removed fails here.
    #[test]
    fn the_json_structure_is_stable() {
        let mut report = example();
        report.studies[0].rows.truncate(2);
        let json = serde_json::to_value(TradeoffReport::new(&report)).unwrap();
        let timed = |median: f64, min: f64, max: f64| serde_json::json!({"median": median, "min": min, "max": max, "runs": 5});
        let expected = serde_json::json!({
            "program": "velomotion 0.0.0",
            "effort": "quick",
            "machine": {"cpu": "Processor <4>", "cores": 2, "os": "Linux", "build": "release"},
            "studies": [{
                "name": "example",
                "title": "Ways & means",
                "choice": "way",
                "columns": [
                    {"key": "time_ns", "heading": "ns per point"},
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
    }
}
