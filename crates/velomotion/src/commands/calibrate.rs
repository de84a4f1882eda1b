//! `velomotion calibrate`: mount, axis and lasers from ordinary scans, without targets.

mod page;

use std::path::Path;

use comfy_table::{CellAlignment, Table, presets::NOTHING};
use engine::calibrate::{
    CalibrateProgress, CalibrateReport, CalibrateRequest, ParameterReport, calibrate, to_toml,
};
use engine::config::load_mount;
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::output::{check_folder, check_free, make_folder, refuse_overwrite, write_text};

use super::CommandOutput;
use crate::cli::{self, Common, VERSION};
use crate::signals;
use crate::terminal::Progress;

/// Runs the command.
///
/// # Errors
/// [`Failure`] without a calibration.
pub fn run(arguments: &cli::Calibrate, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    if let Some(output) = &arguments.output {
        for log in &arguments.logs {
            refuse_overwrite(log, output)?;
        }
        check_folder(output)?;
        check_free(output, arguments.force)?;
        replaces_only_a_calibration(output)?;
    }
    let files = arguments
        .report
        .as_ref()
        .map(|folder| ["index.html", "calibrate.json"].map(|name| folder.join(name)));
    if let (Some(folder), Some(files)) = (&arguments.report, &files) {
        make_folder(folder)?;
        files
            .iter()
            .try_for_each(|file| check_free(file, arguments.force))?;
    }
    let start = arguments.mount.as_deref().map(load_mount).transpose()?;
    let request = CalibrateRequest {
        logs: &arguments.logs,
        start: start.map(|mount| mount.pose()),
        fixed: &arguments.fix,
        level_floor: arguments.level.is_some(),
        interrupt: &interrupt,
    };
    let progress = Progress::new(common);
    let calibrated = calibrate(&request, &mut |step| {
        progress.say(&match step {
            CalibrateProgress::Reading(log) => format!("reading {}", log.display()),
            CalibrateProgress::Shots(shots) => format!("{shots} shots"),
            CalibrateProgress::Loop(loops, moves_sd) => {
                format!("loop {loops}: parameters moved by up to {moves_sd:.1} standard deviations")
            }
        });
    })?;
    let mut report = CalibrateReport::new(&calibrated);
    if let Some([page, json]) = &files {
        write_text(
            page,
            &page::html(&report, &calibrated.calibration.evidence),
            arguments.force,
        )?;
        write_text(json, &format!("{:#}\n", report.to_json()), arguments.force)?;
    }
    if let Some(output) = &arguments.output {
        let text = to_toml(&calibrated, VERSION).map_err(|error| cannot_write(output, &error))?;
        write_text(output, &text, arguments.force)?;
        report.output = Some(output.display().to_string());
    }
    Ok(CommandOutput::result(&report, text(&report)))
}

/// Whether a file is of an earlier calibration.
fn is_calibration(file: &Path) -> bool {
    load_mount(file).is_ok_and(|mount| mount.calibration().is_some())
}

/// Refuses other extensions than `.toml`, and to replace a file that is no calibration: it may be
/// the configuration or a scene.
fn replaces_only_a_calibration(output: &Path) -> Result<(), Failure> {
    let wrong =
        |what: String| Err(Failure::new(Kind::Usage, what).help("name another file with -o"));
    if output.extension() != Some("toml".as_ref()) {
        return wrong(format!(
            "the mount {}: expected the extension .toml",
            output.display()
        ));
    }
    match output.exists() && !is_calibration(output) {
        true => wrong(format!("{} exists and is no calibration", output.display())),
        false => Ok(()),
    }
}

fn cannot_write(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::new(
        Kind::Incomplete,
        format!("the mount {} cannot be written: {error}", path.display()),
    )
    .help("report it with the logs")
}

/// Text of the report.
fn text(report: &CalibrateReport) -> String {
    let mut lines = Vec::new();
    if report.simulated {
        lines.push("SIMULATED: calibrated by logs of simulated devices".to_owned());
    }
    lines.push(format!(
        "{}: {} shots on {} surface elements, chi2 {:.2}, {} loops; residuals {:.1} mm before, {:.1} mm after",
        report.model,
        report.shots,
        report.patches,
        report.chi2,
        report.loops,
        report.residual_mm.before,
        report.residual_mm.after
    ));
    lines.extend((1..).zip(&report.bases).map(|(number, base)| {
        // A slow log shows hundredths of a millimetre.
        let unseen = base.unseen_mm_s;
        let decimals = if unseen < 1.0 { 2 } else { 0 };
        match base.stands {
            true => format!(
                "log {number}: the base is taken to stand; a drift below {unseen:.decimals$} mm/s at 20 m is not seen"
            ),
            false if base.moves => format!("log {number}: the base moves slowly: its drift is part of the result"),
            false => format!("log {number}: the base may drift by less than {unseen:.0} mm/s unseen: scan both ways"),
        }
    }));
    let mut table = Table::new();
    table.load_style(NOTHING);
    table.set_header(["parameter", "value", "sd", "of prior", "moves at 20 m", ""]);
    for parameter in &report.parameters {
        table.add_row(row(parameter));
    }
    for column in 1..=4 {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    lines.push(table.to_string());
    lines.extend(report.output.iter().map(|output| {
        format!(
            "wrote {output}: name it in [mount] file of the configuration, or with replay --mount"
        )
    }));
    lines.join("\n")
}

fn row(parameter: &ParameterReport) -> [String; 6] {
    let note = match (
        &parameter.help,
        &parameter.correlated_with,
        parameter.correlation,
    ) {
        (Some(help), ..) => format!("not determined: {help}"),
        (None, Some(other), Some(r)) if r.abs() > 0.8 => format!("{r:.2} with {other}"),
        _ => String::new(),
    };
    [
        parameter.name.clone(),
        format!("{:.5}", parameter.value),
        format!("{:.5}", parameter.sd),
        format!("{:.3}", parameter.posterior_over_prior),
        format!("{:.2} mm", parameter.moves_mm),
        note,
    ]
}
