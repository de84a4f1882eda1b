//! The figure of a plan: gap and error against scan time.

use super::PlanRow;
use crate::tradeoff::{Measured, Row, Study, StudyFindings, Trade, svg};

const STUDY: Study = Study {
    name: "plan",
    title: "Gap and error against scan time",
    choice: "setting",
    columns: &[
        ("scan_s", "scan time with homing, s"),
        ("gap_p99_deg", "gap of 99 % of directions, deg"),
        ("error_total_mm", "error of 95 % of points, mm"),
    ],
    trades: &[Trade::new(0, 1), Trade::new(0, 2)],
    measure: |_| Ok(Measured::default()),
};

/// The rows of a table, with the chosen one in a colour of its own. Its title is the finding.
#[must_use]
pub fn figure(rows: &[PlanRow], chosen: Option<&PlanRow>, at_m: f64) -> String {
    let row = |row: &PlanRow, group: &'static str| {
        let setting = &row.setting;
        let label = format!("{:.1} deg/s", setting.speed_deg_s);
        let name = format!(
            "{label}, {} deg/s2, {} rpm, {} sweeps, {group}",
            setting.accel_deg_s2, setting.rpm, setting.sweeps
        );
        let values = [row.scan_s, row.gap_deg.p99, row.error_mm.total];
        Row::new(name, label, group, values)
    };
    let table = rows.iter().map(|found| row(found, "best for their time"));
    let rows_drawn = table.chain(chosen.map(|found| row(found, "chosen")));
    let findings = StudyFindings {
        study: STUDY,
        about: Vec::new(),
        rows: rows_drawn.collect(),
    };
    let finding = |from: &PlanRow, to: &PlanRow| {
        format!(
            "{:.1} to {:.1} s: {:.2} to {:.2} deg, {:.0} to {:.0} mm at {at_m} m",
            from.scan_s,
            to.scan_s,
            from.gap_deg.p99,
            to.gap_deg.p99,
            from.error_mm.total,
            to.error_mm.total
        )
    };
    let title = match (rows.first(), chosen.or(rows.last())) {
        (Some(fastest), Some(found)) => finding(fastest, found),
        _ => STUDY.title.to_owned(),
    };
    svg::titled(&findings, &title)
}
