//! The figure of a plan: gap and error against scan time.

use super::PlanRow;
use crate::tradeoff::{Row, Study, StudyFindings, StudyRows, Trade, svg};

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
    finding: StudyFindings::ends_of_front,
    measure: |_| Ok(StudyRows::default()),
};

/// The rows of a table, with the chosen one in a colour of its own. Its title is the finding, of
/// a subject such as a lidar and a device.
#[must_use]
pub fn figure(rows: &[PlanRow], chosen: Option<&PlanRow>, (subject, at_m): (&str, f64)) -> String {
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
    let table = rows.iter().map(|found| row(found, "fastest for their gap"));
    let rows_drawn = table.chain(chosen.map(|found| row(found, "chosen")));
    let findings = StudyFindings {
        study: STUDY,
        about: Vec::new(),
        rows: rows_drawn.collect(),
    };
    let title = match (chosen, rows.first(), rows.last()) {
        (Some(found), ..) => format!(
            "{subject}: {:.1} s give gaps of {:.2} deg, errors of {:.1} mm at {at_m} m",
            found.scan_s, found.gap_deg.p99, found.error_mm.total
        ),
        (None, Some(fast), Some(slow)) => format!(
            "{subject}: {:.1} to {:.0} s, gaps of {:.2} to {:.2} deg, errors of {:.0} to {:.1} mm at {at_m} m",
            fast.scan_s,
            slow.scan_s,
            fast.gap_deg.p99,
            slow.gap_deg.p99,
            fast.error_mm.total,
            slow.error_mm.total
        ),
        _ => STUDY.title.to_owned(),
    };
    svg::titled(&findings, &title)
}
