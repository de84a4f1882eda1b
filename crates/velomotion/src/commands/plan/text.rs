//! A plan for people.

use analysis::plan::PlanRow;
use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, Table};
use engine::capture::scan_planner::{CommandRow, PlanReport};
use engine::words::counted;

/// The lidar and the device.
pub(super) fn subject(report: &PlanReport) -> String {
    let simulated = if report.simulated { " (SIMULATED)" } else { "" };
    format!("{} on {}{simulated}", report.lidar, report.device)
}

/// Table, choice and assumptions.
pub(super) fn text(report: &PlanReport, written: Vec<String>) -> String {
    let mut lines = vec![
        format!(
            "{}: gaps and errors at {} m, times with homing",
            subject(report),
            report.at_m
        ),
        String::new(),
        table(report),
        String::new(),
        details(report),
        String::new(),
        "gap: distance to the nearest point, for that share of the directions in view".to_owned(),
        "error: 95 % of points are within it; n: sweeps, 2 with --both-ways".to_owned(),
        "cloud: millions of points, and MB".to_owned(),
        wrapped(&format!(
            "mean deg: between neighbouring lines; none: share of directions without a point within \
             {} deg; start: best azimuth of the lidar at the start, which a capture does not control",
            report.unseen_beyond_deg
        )),
        wrapped(
            "parts of the error, one standard deviation each: range and its steps; azimuth; tilt \
             angle and clock; delay that all angles share; mount",
        ),
    ];
    if report.rows.iter().any(|row| !row.unmet.is_empty()) {
        lines.push("!: beyond the limit".to_owned());
    }
    lines.push(wrapped(
        "rows are from fewer azimuths at the start and fewer directions than a choice: their gaps \
         may be some percent too narrow",
    ));
    match &report.chosen {
        Some(chosen) => {
            lines.push(">: the choice".to_owned());
            lines.extend(choice(chosen, report));
        }
        None => lines.extend(report.unmet.is_none().then(|| {
            "\n--error, --gap or --time choose a setting and print its command".to_owned()
        })),
    }
    let found = report.chosen.as_ref().or(report.nearest.as_ref());
    let no_command = report.no_command.iter();
    let no_command = no_command.filter(|_| match found {
        Some(found) => found.command.is_none(),
        None => report.rows.iter().all(|row| row.command.is_none()),
    });
    lines.extend(
        no_command.map(|why| format!("\n{}", wrapped(&format!("no capture command: {why}")))),
    );
    lines.push("\nassumed".to_owned());
    let assumptions = report.assumptions.iter();
    lines.extend(assumptions.map(|line| wrapped(&format!("- {line}"))));
    lines.extend(written);
    lines.join("\n")
}

/// Lines of at most 80 columns, those after the first indented.
fn wrapped(line: &str) -> String {
    textwrap::fill(line, textwrap::Options::new(80).subsequent_indent("  "))
}

const HEADINGS: [&str; 14] = [
    "\ndeg/s",
    "\ndeg/s2",
    "\nrpm",
    "\nn",
    "scan\ns",
    "gap\n50 %",
    "\n95 %",
    "\n99 %",
    "\nworst",
    "error\nmm",
    "cloud\nM",
    "replay\ns",
    "log\nMB",
    "cloud\nMB",
];

/// The rows and the choice in the order of time, and whether each is the choice.
fn by_time(report: &PlanReport) -> Vec<(&CommandRow, bool)> {
    let chosen = report.chosen.as_ref();
    let is_other =
        |row: &&CommandRow| chosen.is_none_or(|chosen| chosen.row.setting != row.row.setting);
    let others = report.rows.iter().filter(is_other).map(|row| (row, false));
    let mut rows: Vec<_> = others.chain(chosen.map(|row| (row, true))).collect();
    rows.sort_by(|(a, _), (b, _)| a.row.scan_s.total_cmp(&b.row.scan_s));
    rows
}

/// The speed of a row, with a mark if it is the choice.
fn speed(row: &PlanRow, is_chosen: bool) -> String {
    let mark = if is_chosen { ">" } else { "" };
    format!("{mark}{:.2}", row.setting.speed_deg_s)
}

/// Each setting, its time, gaps, error and sizes.
fn table(report: &PlanReport) -> String {
    let cells = by_time(report).into_iter().map(|(found, is_chosen)| {
        let CommandRow { row, unmet, .. } = found;
        let (setting, gap) = (&row.setting, &row.gap_deg);
        let marked = |limit: &str, value: String| match unmet.iter().any(|it| it.limit == limit) {
            true => value + "!",
            false => value,
        };
        [
            speed(row, is_chosen),
            format!("{:.0}", setting.accel_deg_s2),
            format!("{:.0}", setting.rpm),
            setting.sweeps.to_string(),
            marked("time", short(row.scan_s, 100.0, 1)),
            format!("{:.2}", gap.p50),
            format!("{:.2}", gap.p95),
            marked("gap", format!("{:.2}", gap.p99)),
            format!("{:.2}", gap.worst),
            marked("error", format!("{:.1}", row.error_mm.total)),
            short(row.points as f64 * 1e-6, 10.0, 2),
            row.replay_s.map_or("-".to_owned(), |s| format!("{s:.1}")),
            row.log_bytes
                .map_or("-".to_owned(), |bytes| format!("{:.0}", megabytes(bytes))),
            format!("{:.0}", megabytes(row.cloud_bytes)),
        ]
    });
    formatted(HEADINGS, cells)
}

const DETAILS: [&str; 14] = [
    "\ndeg/s",
    "\nn",
    "start\ndeg",
    "mean\ndeg",
    "none\n%",
    "gap,\n50 %",
    "mm\n95 %",
    "\n99 %",
    "\nworst",
    "error\nrange",
    "parts,\nazim",
    "mm\nangle",
    "\ndelay",
    "\nmount",
];

/// Table by setting: the start, the density, the gaps at the distance and the parts of the error.
fn details(report: &PlanReport) -> String {
    let cells = by_time(report).into_iter().map(|(found, is_chosen)| {
        let row = &found.row;
        let (gap, error) = (&row.gap_mm, &row.error_mm);
        [
            speed(row, is_chosen),
            row.setting.sweeps.to_string(),
            format!("{:.0}", row.best_start_deg),
            format!("{:.3}", row.resolution_deg),
            short(100.0 * row.share_without_point, 10.0, 2),
            format!("{:.0}", gap.p50),
            format!("{:.0}", gap.p95),
            format!("{:.0}", gap.p99),
            format!("{:.0}", gap.worst),
            format!("{:.1}", error.range.hypot(error.range_step)),
            format!("{:.1}", error.azimuth),
            format!("{:.1}", error.tilt.hypot(error.clock)),
            format!("{:.1}", error.delay),
            error.mount.map_or("-".to_owned(), |mm| format!("{mm:.1}")),
        ]
    });
    formatted(DETAILS, cells)
}

fn formatted<const N: usize>(
    headings: [&str; N],
    cells: impl Iterator<Item = [String; N]>,
) -> String {
    let mut table = Table::new();
    table
        .load_style(NOTHING)
        .set_header(headings)
        .add_rows(cells);
    for column in table.column_iter_mut() {
        column
            .set_padding((0, 1))
            .set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// A number with so many decimals, one fewer from a value on.
fn short(value: f64, from: f64, decimals: usize) -> String {
    let scale = 10_f64.powi(decimals as i32);
    let is_large = (value * scale).round() >= from * scale;
    format!("{value:.*}", decimals - usize::from(is_large))
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 * 1e-6
}

/// The chosen row in words.
fn choice(chosen: &CommandRow, report: &PlanReport) -> Vec<String> {
    let at_m = report.at_m;
    let row = &chosen.row;
    let (gap, mm, error) = (&row.gap_deg, &row.gap_mm, &row.error_mm);
    let mount = error
        .mount
        .map_or("not calibrated".to_owned(), |mm| format!("{mm:.2}"));
    let log = row.replay_s.zip(row.log_bytes);
    let log = log.map_or(String::new(), |(replay_s, bytes)| {
        format!("replay {replay_s:.1} s; log {:.1} MB, ", megabytes(bytes))
    });
    let paragraphs = [
        format!(
            "{:.1} s with homing; at most {} points; {}cloud {:.1} MB; mean resolution {:.3} deg (mean angle between scan lines)",
            row.scan_s,
            row.points,
            log,
            megabytes(row.cloud_bytes),
            row.resolution_deg,
        ),
        format!(
            "gap at {at_m} m: 50 % of directions {:.2} deg ({:.0} mm), 95 % {:.2} deg ({:.0} mm), 99 % {:.2} deg ({:.0} mm), the widest found \
             {:.2} deg ({:.0} mm); without a point within {} deg: {:.2} %; with the lidar at {:.0} deg at the start, which a capture does not \
             control, 99 % {:.2} deg",
            gap.p50,
            mm.p50,
            gap.p95,
            mm.p95,
            gap.p99,
            mm.p99,
            gap.worst,
            mm.worst,
            report.unseen_beyond_deg,
            100.0 * row.share_without_point,
            row.best_start_deg,
            row.best_start_p99_deg,
        ),
        format!(
            "error at {at_m} m in mm, one standard deviation: range {:.2}, its steps {:.2}, azimuth {:.2}, tilt angle {:.2}, clock {:.3}, \
             common delay {:.2}, mount {mount}",
            error.range, error.range_step, error.azimuth, error.tilt, error.clock, error.delay,
        ),
        format!(
            "sum: {:.1} mm for 95 % of points; the cloud's column sd will have {:.2} mm, which leaves out constant errors (delay, mount)",
            error.total, error.column_sd,
        ),
    ];
    let paragraphs = paragraphs.iter().map(|line| wrapped(&format!("  {line}")));
    let setting = &row.setting;
    let first = match &chosen.command {
        Some(command) => format!("\n{command}\n  with the lidar at {} rpm", setting.rpm),
        None => format!(
            "\n{} deg/s, {} deg/s2, {} rpm, {}",
            (setting.speed_deg_s * 1e6).round() / 1e6,
            (setting.accel_deg_s2 * 1e6).round() / 1e6,
            setting.rpm,
            counted(setting.sweeps, "sweep"),
        ),
    };
    std::iter::once(first).chain(paragraphs).collect()
}
