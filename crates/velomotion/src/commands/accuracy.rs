//! `velomotion accuracy`: how accurate the points of logs are.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets::NOTHING};
use engine::accuracy::{AccuracyReport, AccuracyRequest, ResidualReport, TruePlaces, accuracy};
use engine::config::load_mount;
use engine::document::Document;
use engine::failure::Failure;
use engine::output::{check_free, make_folder, write_text};
use engine::words::counted;

use super::CommandOutput;
use crate::cli::{AccuracyStudyArguments, Common};
use crate::signals;
use crate::terminal::Progress;

/// Runs the command.
///
/// # Errors
/// [`Failure`] without a study.
pub fn run(arguments: &AccuracyStudyArguments, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    let files = arguments
        .report
        .as_ref()
        .map(|folder| ["index.html", "accuracy.json"].map(|name| folder.join(name)));
    if let (Some(folder), Some(files)) = (&arguments.report, &files) {
        make_folder(folder)?;
        files
            .iter()
            .try_for_each(|file| check_free(file, arguments.force))?;
    }
    let scene = arguments.scene.as_deref();
    let places = scene
        .map(|scene| TruePlaces::new(scene, arguments.seed, &arguments.logs))
        .transpose()?;
    let place = places
        .as_ref()
        .map(|places| |time_ns, laser| places.place(time_ns, laser));
    let request = AccuracyRequest {
        logs: &arguments.logs,
        mount: arguments.mount.as_deref().map(load_mount).transpose()?,
        truth: place
            .as_ref()
            .map(|place| place as &dyn Fn(i64, u8) -> Option<[f64; 3]>),
        interrupt: &interrupt,
    };
    let progress = Progress::new(common);
    let studied = accuracy(&request, &mut |log| {
        progress.say(&format!("reading {}", log.display()));
    })?;
    let report = AccuracyReport::new(&studied);
    let tables = tables(&report);
    if let Some([page, json]) = &files {
        write_text(page, &html(&report, &tables), arguments.force)?;
        write_text(json, &format!("{:#}\n", report.to_json()), arguments.force)?;
    }
    Ok(CommandOutput::result(&report, text(&report, &tables)))
}

/// A table with its title.
struct TitledTable {
    title: &'static str,
    head: Vec<&'static str>,
    rows: Vec<Vec<String>>,
}

fn tables(report: &AccuracyReport) -> Vec<TitledTable> {
    let mut tables = vec![lasers(report)];
    tables.push(residuals(report));
    tables.extend(sweeps(report));
    tables.extend(stations(report));
    tables.push(budget(report));
    tables
}

/// A length with a number of decimals, if it is known.
fn known(mm: Option<f64>, decimals: usize) -> String {
    mm.map_or("unknown".to_owned(), |mm| format!("{mm:.decimals$}"))
}

fn lasers(report: &AccuracyReport) -> TitledTable {
    let rows = report.lasers.iter().map(|laser| {
        vec![
            laser.laser.to_string(),
            known(laser.noise_mm, 1),
            known(laser.offset_mm, 1),
        ]
    });
    TitledTable {
        title: "Lasers, mm",
        head: vec!["laser", "noise", "offset"],
        rows: rows.collect(),
    }
}

fn residuals(report: &AccuracyReport) -> TitledTable {
    let row = |by: &str, bin: &ResidualReport| {
        let mut row = vec![
            by.to_owned(),
            format!("{:.4}", bin.from)
                .trim_end_matches('0')
                .trim_end_matches('.')
                .to_owned(),
            bin.shots.to_string(),
            format!("{:.2}", bin.mean_mm),
            format!("{:.2}", bin.rms_mm),
            format!("{:.2}", bin.rms_mm / bin.expected_mm),
        ];
        row.extend(bin.truth.iter().flat_map(|truth| {
            [
                format!("{:.2}", truth.rms_mm),
                format!("{:.2}", truth.stated_mm),
                format!("{:.2}", truth.error_over_sd),
            ]
        }));
        row
    };
    let groups = report.residuals.iter().filter(|group| group.by != "laser");
    let rows: Vec<Vec<String>> = groups
        .flat_map(|group| group.bins.iter().map(|bin| row(&group.by, bin)))
        .collect();
    let mut head = vec!["by", "from", "shots", "mean", "rms", "of expected"];
    if rows.iter().any(|row| row.len() > head.len()) {
        head.extend(["error", "stated", "error / sd"]);
    }
    TitledTable {
        title: "Residuals of ranges on surface elements, mm",
        head,
        rows,
    }
}

fn sweeps(report: &AccuracyReport) -> Option<TitledTable> {
    let rows = report.sweeps.iter().map(|pair| {
        vec![
            pair.log.to_string(),
            format!("{} and {}", pair.first, pair.second),
            if pair.both_ways {
                "both ways"
            } else {
                "same way"
            }
            .to_owned(),
            pair.patches.to_string(),
            format!("{:.2}", pair.mean_mm),
            format!("{:.2}", pair.rms_mm),
            format!("{:.2}", pair.expected_mm),
            format!("{:.2} +- {:.2}", pair.tilt_mdeg, pair.tilt_sd_mdeg),
        ]
    });
    (!report.sweeps.is_empty()).then(|| TitledTable {
        title: "Sweeps against the next ones, mm",
        head: vec![
            "log",
            "sweeps",
            "",
            "elements",
            "mean",
            "rms",
            "expected",
            "tilt, mdeg",
        ],
        rows: rows.collect(),
    })
}

fn stations(report: &AccuracyReport) -> Option<TitledTable> {
    let rows = report.stations.iter().map(|pair| {
        vec![
            format!("{} and {}", pair.first, pair.second),
            pair.corners.to_string(),
            pair.distances.to_string(),
            format!("{:.1} to {:.1} m", pair.shortest_m, pair.longest_m),
            format!("{:.2}", pair.mean_mm),
            format!("{:.2}", pair.rms_mm),
            format!("{:.2}", pair.worst_mm),
        ]
    });
    (!report.stations.is_empty()).then(|| TitledTable {
        title: "Distances of corners from two stations, mm",
        head: vec![
            "logs",
            "corners",
            "distances",
            "lengths",
            "mean",
            "rms",
            "worst",
        ],
        rows: rows.collect(),
    })
}

fn budget(report: &AccuracyReport) -> TitledTable {
    let known = |mm| known(mm, 2);
    let rows = report.budget.iter().map(|bin| {
        vec![
            format!("{} to {} m", bin.from_m, bin.to_m),
            format!("{:.2}", bin.range_mm),
            format!("{:.2}", bin.azimuth_mm),
            format!("{:.2}", bin.tilt_mm),
            format!("{:.2}", bin.clock_mm),
            known(bin.mount_mm),
            known(bin.axis_mm),
            known(bin.lasers_mm),
            known(bin.calibration_mm),
            format!("{:.2}", bin.total_mm),
        ]
    });
    TitledTable {
        title: "Error budget, mm",
        head: vec![
            "range",
            "noise",
            "azimuth",
            "tilt",
            "clock",
            "mount",
            "axis",
            "lasers",
            "these three",
            "all",
        ],
        rows: rows.collect(),
    }
}

/// Basis of the study: lidar, calibration, shots and logs.
fn summary(report: &AccuracyReport) -> String {
    let state = if report.calibrated {
        "calibrated"
    } else {
        "not calibrated"
    };
    let without_truth = match (report.points_without_truth, report.points) {
        (Some(without), Some(points)) if without > 0 => format!(
            "; {without} of {points} points have no truth (no surface returned them) and no error"
        ),
        _ => String::new(),
    };
    format!(
        "{}, {state}: {} shots on {} surface elements of {}{without_truth}",
        report.model,
        report.shots,
        report.patches,
        counted(report.logs.len() as u64, "log")
    )
}

fn text(report: &AccuracyReport, tables: &[TitledTable]) -> String {
    let mut lines = Vec::new();
    if report.simulated {
        lines.push("SIMULATED: logs of simulated devices".to_owned());
    }
    lines.push(summary(report));
    for titled in tables {
        let mut table = Table::new();
        table.load_style(NOTHING);
        table.set_header(titled.head.clone());
        for row in &titled.rows {
            table.add_row(row.clone());
        }
        for column in 1..titled.head.len() {
            if let Some(column) = table.column_mut(column) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        lines.push(format!("\n{}\n{table}", titled.title));
    }
    lines.join("\n")
}

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:56rem;margin:0 auto;padding:1rem}\
table{border-collapse:collapse;font-size:.85rem}td,th{padding:.2rem .6rem;border-bottom:1px solid #ccc;text-align:right}\
td:first-child,th:first-child{text-align:left}";

fn html(report: &AccuracyReport, tables: &[TitledTable]) -> String {
    let simulated = match report.simulated {
        true => "<p><strong>SIMULATED</strong>: logs of simulated devices.</p>\n",
        false => "",
    };
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Accuracy</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{STYLE}</style></head><body>\n\
         <h1>Accuracy</h1>\n{simulated}<p>{}</p>\n",
        summary(report)
    );
    for titled in tables {
        let cells = |row: &[String], tag: &str| -> String {
            row.iter()
                .map(|cell| format!("<{tag}>{cell}</{tag}>"))
                .collect()
        };
        let head: Vec<String> = titled.head.iter().map(|cell| (*cell).to_owned()).collect();
        let _ = writeln!(
            html,
            "<h2>{}</h2>\n<table><tr>{}</tr>",
            titled.title,
            cells(&head, "th")
        );
        for row in &titled.rows {
            let _ = writeln!(html, "<tr>{}</tr>", cells(row, "td"));
        }
        html += "</table>\n";
    }
    html + "</body></html>\n"
}
