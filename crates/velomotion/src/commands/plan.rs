//! `velomotion plan`: accuracy, density and time of a capture before it is made.

mod text;

use std::path::PathBuf;

use analysis::plan::{PlanLimits, PlanRow, figure};
use engine::capture::scan_planner::{PlanReport, PlanRequest, ScanPlanner};
use engine::config::{self, Config};
use engine::devices::profile;
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::output::{check_free, make_folder, write_text};

use super::CommandOutput;
use crate::cli::{self, Common};
use text::{subject, text};

/// Runs the command.
///
/// # Errors
/// [`Kind::Usage`] for impossible limits or a file that exists, [`Kind::Incomplete`], with the
/// table, if no setting meets the limits.
pub fn run(arguments: &cli::Plan, common: &Common) -> Result<CommandOutput, Failure> {
    let config = config::load(common.config.as_deref())?;
    let (name, device) = profile::choose(&config, arguments.device.name.as_deref())?;
    let files = ["plan.svg", "plan.json"].map(|file| {
        let folder = arguments.report.as_ref();
        folder.map(|folder| folder.join(file))
    });
    for file in files.iter().flatten() {
        check_free(file, arguments.force)?;
    }
    let request = request(arguments, &config);
    let mut report = ScanPlanner::new(&config, (&name, &device), request)?.plan()?;
    if let Some(file) = &common.config {
        let rows = report.rows.iter_mut();
        let rows = rows.chain(&mut report.chosen).chain(&mut report.nearest);
        for command in rows.filter_map(|row| row.command.as_mut()) {
            *command += &format!(" --config {}", quoted(&file.to_string_lossy()));
        }
    }
    if let ([Some(drawing), Some(json)], Some(folder)) = (&files, &arguments.report) {
        make_folder(folder)?;
        let rows: Vec<PlanRow> = report.rows.iter().map(|row| row.row.clone()).collect();
        let chosen = report.chosen.as_ref().map(|chosen| &chosen.row);
        write_text(
            drawing,
            &figure(&rows, chosen, (&subject(&report), report.at_m)),
            arguments.force,
        )?;
        let object = format!("{:#}\n", report.to_json());
        write_text(json, &object, arguments.force)?;
    }
    Ok(CommandOutput {
        failure: report
            .unmet
            .as_ref()
            .map(|unmet| Failure::new(Kind::Incomplete, unmet.clone()).help(help(&report))),
        ..CommandOutput::result(&report, text(&report, written(&files)))
    })
}

fn request(arguments: &cli::Plan, config: &Config) -> PlanRequest {
    let configured = config.lidar.sheet;
    let lidar = arguments.lidar.unwrap_or(configured);
    let rpm = match arguments.rpm.as_slice() {
        [] if lidar == configured => vec![config.lidar.rpm],
        [] => vec![lidar.usual_rpm()],
        given => given.to_vec(),
    };
    PlanRequest {
        limits: PlanLimits {
            // Whole nanometres: 0.009 m is 9 mm, not 9.000000000000002.
            error_mm: arguments.error.map(|metres| (1e9 * metres).round() / 1e6),
            gap_deg: arguments.gap,
            time_s: arguments.time,
        },
        rpm,
        range_sd_m: arguments.range_sd,
        mount_sd_deg: arguments.mount_sd,
        from_deg: arguments.from,
        to_deg: arguments.to,
        ..PlanRequest::new(arguments.at, lidar, 0)
    }
}

/// Advice where no setting keeps the limits.
fn help(report: &PlanReport) -> String {
    let nearest = report.nearest.as_ref();
    match nearest.and_then(|nearest| nearest.command.as_deref()) {
        Some(command) => format!("give other limits, by the table, or take the nearest: {command}"),
        None => "give other limits, by the table".to_owned(),
    }
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    match word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

fn written(files: &[Option<PathBuf>]) -> Vec<String> {
    let files = files.iter().flatten();
    files
        .map(|file| format!("wrote {}", file.display()))
        .collect()
}

#[cfg(test)]
mod tests {
    use engine::capture::scan_planner::CommandRow;
    use engine::config::{Config, Device};
    use engine::lidars::{self, LIDARS};

    use super::*;

    fn report(limits: PlanLimits) -> PlanReport {
        let request = PlanRequest {
            limits,
            ..PlanRequest::new(20.0, &lidars::VLP_16, 600)
        };
        let device = Device::simulator();
        ScanPlanner::new(&Config::default(), ("sim", &device), request)
            .unwrap()
            .plan()
            .unwrap()
    }

    #[test]
    fn the_command_of_the_choice_is_accepted() {
        let report = report(PlanLimits {
            error_mm: Some(9.0),
            gap_deg: Some(0.8),
            time_s: None,
        });
        let chosen = report.chosen.as_ref().unwrap();
        let command = chosen.command.as_deref().unwrap();
        let words = command.split(' ').map(std::ffi::OsString::from);
        let cli = <cli::Cli as clap::Parser>::try_parse_from(words).unwrap();
        let cli::Command::Capture(capture) = cli.command else {
            panic!("{command}");
        };
        let same = (capture.speed - chosen.row.setting.speed_deg_s).abs() < 1e-6;
        assert!(same, "{} {chosen:?}", capture.speed);
        let text = text(&report, Vec::new());
        let words: Vec<&str> = text.split_whitespace().collect();
        assert!(words.join(" ").contains("mount not calibrated"), "{text}");
        assert!(
            text.lines().all(|line| line.chars().count() <= 100),
            "{text}"
        );
    }

    #[test]
    fn another_lidar_than_the_simulated_has_no_command() {
        let config = Config::default();
        let device = Device::simulator();
        let limits = PlanLimits {
            gap_deg: Some(0.5),
            time_s: Some(4.0),
            ..PlanLimits::default()
        };
        for (model, rpm, has_command) in [
            (&lidars::VLP_16, 600, true),
            (&lidars::VLP_16, 1_200, false),
            (&lidars::HDL_32E, 600, false),
        ] {
            let request = PlanRequest {
                limits,
                ..PlanRequest::new(20.0, model, rpm)
            };
            let planner = ScanPlanner::new(&config, ("sim", &device), request).unwrap();
            let report = planner.plan().unwrap();
            let all = report
                .rows
                .iter()
                .all(|row| row.command.is_some() == has_command);
            assert!(all && !report.rows.is_empty(), "{} {rpm}", model.name);
            assert_eq!(report.no_command.is_none(), has_command);
            // Ranges of a lidar that is not simulated are those of the data sheet.
            let ranges_mm = report.rows[0].row.error_mm.range;
            assert_eq!(ranges_mm > 6.0, !has_command, "{ranges_mm}");
            for CommandRow { row, unmet, .. } in &report.rows {
                let names: Vec<&str> = unmet.iter().map(|unmet| unmet.limit).collect();
                assert_eq!(names.contains(&"gap"), row.gap_deg.p99 > 0.5, "{row:?}");
                assert_eq!(names.contains(&"time"), row.scan_s > 4.0, "{row:?}");
                assert!(unmet.iter().all(|unmet| !unmet.cause.is_empty()));
            }
            let text = text(&report, Vec::new());
            let chosen = text.lines().filter(|line| {
                let rest = line.trim_start().strip_prefix('>');
                rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
            });
            // In both tables.
            let tables = 2 * usize::from(report.chosen.is_some());
            assert_eq!(chosen.count(), tables, "{text}");
            assert!(text.contains("beyond the limit"), "{text}");
            assert!(
                text.lines().all(|line| line.chars().count() <= 80),
                "{text}"
            );
        }
    }

    /// Every lidar gives a table, with a setting for the gap. Those that velomotion does not
    /// capture have no log, replay and command, and the text says so.
    #[test]
    fn every_lidar_has_a_plan() {
        let config = Config::default();
        for lidar in LIDARS {
            let request = PlanRequest {
                limits: PlanLimits {
                    gap_deg: Some(1.5),
                    ..PlanLimits::default()
                },
                ..PlanRequest::new(20.0, lidar, lidar.usual_rpm())
            };
            let planner = ScanPlanner::new(&config, ("found", &Device::found()), request);
            let report = planner.unwrap().plan().unwrap();
            let chosen = report
                .chosen
                .as_ref()
                .unwrap_or_else(|| panic!("{report:?}"));
            let row = &chosen.row;
            assert!(row.gap_deg.p99 <= 1.5 && row.scan_s < 20.0, "{chosen:?}");
            let sd_mm = 1e3 * lidar.range_sd_m(20.0);
            assert!((row.error_mm.range.hypot(row.error_mm.range_step) - sd_mm).abs() < 1e-9);
            let is_captured = lidar.model.is_some();
            assert_eq!(chosen.command.is_some(), is_captured, "{}", lidar.name);
            assert_eq!(row.log_bytes.is_some(), is_captured);
            let text = text(&report, Vec::new());
            let says_so = format!(
                "no capture command: velomotion does not capture the {}",
                lidar.title
            );
            assert_eq!(text.contains(&says_so), !is_captured, "{text}");
            assert!(
                text.lines().all(|line| line.chars().count() <= 80),
                "{text}"
            );
        }
    }

    #[test]
    fn rates_that_the_lidar_does_not_have_are_refused() {
        for (lidar, rpm) in [
            (&lidars::VLP_16, 601),
            (&lidars::VLP_16, 1_260),
            (LIDARS[5], 600),
        ] {
            let request = PlanRequest::new(20.0, lidar, rpm);
            let device = Device::simulator();
            let planner = ScanPlanner::new(&Config::default(), ("sim", &device), request);
            let failure = planner.unwrap().plan().unwrap_err();
            assert_eq!(failure.kind, Kind::Usage);
            assert!(
                failure.message.starts_with("--rpm: expected "),
                "{}",
                failure.message
            );
        }
        // Farther than a UTM-30LX sees.
        let request = PlanRequest::new(40.0, LIDARS[5], 2_400);
        let device = Device::simulator();
        let planner = ScanPlanner::new(&Config::default(), ("sim", &device), request);
        assert!(
            planner
                .err()
                .unwrap()
                .message
                .contains("0.1 to 30 m, the range of the UTM-30LX")
        );
    }

    #[test]
    fn sweeps_outside_the_axis_are_refused() {
        for to_deg in [0.0, -50.0, f64::NAN] {
            let request = PlanRequest {
                to_deg: Some(to_deg),
                ..PlanRequest::new(20.0, &lidars::VLP_16, 600)
            };
            let device = Device::simulator();
            let planner = ScanPlanner::new(&Config::default(), ("sim", &device), request);
            let failure = planner.unwrap().plan().unwrap_err();
            assert_eq!(failure.kind, Kind::Usage, "{to_deg}");
        }
    }

    /// The simulator's lidar has one rate.
    #[test]
    fn a_choice_at_the_rate_of_the_simulator_has_a_command() {
        for gap_deg in [None, Some(0.3)] {
            let request = PlanRequest {
                limits: PlanLimits {
                    gap_deg,
                    ..PlanLimits::default()
                },
                rpm: vec![300, 600],
                ..PlanRequest::new(20.0, &lidars::VLP_16, 0)
            };
            let device = Device::simulator();
            let planner = ScanPlanner::new(&Config::default(), ("sim", &device), request);
            let report = planner.unwrap().plan().unwrap();
            for CommandRow { command, row, .. } in report.rows.iter().chain(&report.chosen) {
                assert_eq!(command.is_some(), row.setting.rpm == 600.0, "{row:?}");
            }
            // No row within the limits is faster than the choice.
            let within = report.rows.iter().filter(|row| row.unmet.is_empty());
            for CommandRow { row, .. } in within {
                let chosen = report.chosen.as_ref();
                assert!(chosen.is_none_or(|chosen| chosen.row.scan_s <= row.scan_s));
            }
            let found = report.chosen.as_ref().or(report.rows.first());
            let has_command = found.is_some_and(|found| found.command.is_some());
            let says_why = text(&report, Vec::new()).contains("no capture command");
            assert!(gap_deg.is_none() || says_why != has_command, "{report:?}");
        }
    }

    #[test]
    fn limits_that_no_setting_meets_are_explained() {
        for (limits, words) in [
            (
                PlanLimits {
                    error_mm: Some(0.5),
                    ..PlanLimits::default()
                },
                "the fastest within 4 % of it has",
            ),
            (
                PlanLimits {
                    error_mm: Some(0.5),
                    gap_deg: Some(0.5),
                    ..PlanLimits::default()
                },
                "of it that keeps the gap has",
            ),
            (
                PlanLimits {
                    error_mm: Some(0.5),
                    gap_deg: Some(0.01),
                    ..PlanLimits::default()
                },
                "none within 4 % of it keeps the gap; the densest has",
            ),
            (
                PlanLimits {
                    gap_deg: Some(0.01),
                    ..PlanLimits::default()
                },
                "0.20 deg apart in azimuth",
            ),
            (
                PlanLimits {
                    time_s: Some(1.0),
                    ..PlanLimits::default()
                },
                "the shortest takes",
            ),
        ] {
            let report = report(limits);
            assert!(report.chosen.is_none());
            let nearest = report.nearest.as_ref().unwrap();
            assert!(help(&report).ends_with(nearest.command.as_deref().unwrap()));
            let unmet = report.unmet.unwrap();
            assert!(unmet.contains(words), "{unmet}");
        }
    }
}
