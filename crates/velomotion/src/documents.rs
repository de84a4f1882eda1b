//! The objects that commands print with `--json`. docs/src/schema has their schemas.

use std::path::PathBuf;

use engine::document::Document;
use serde::Serialize;
use utoipa::ToSchema;

use crate::commands::analyze::report::AnalyzeReport;
use crate::commands::analyze::sweep::SettingsReport;
#[cfg(devices)]
use crate::commands::doctor::DoctorReport;
#[cfg(devices)]
use crate::commands::doctor::bring_up::BringUpReport;

/// Names schemas.
macro_rules! documents {
    ($($document:ty: $name:literal;)*) => {
        $(impl Document for $document {
            const SCHEMA: &'static str = $name;
        })*
    };
}

documents! {
    AnalyzeReport: "analyze-1";
    SettingsReport: "analyze-sweep-1";
    ServedView: "view-1";
    HelpText: "help-1";
}

#[cfg(devices)]
documents! {
    DoctorReport: "doctor-1";
    BringUpReport: "bring-up-1";
    DaemonReport: "daemon-1";
    SimulatedDriveReady: "firmware-sim-1";
}

/// Printed by a daemon once it answers.
#[cfg(devices)]
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DaemonReport {
    /// Address and port of its page.
    pub address: String,
    /// Its page.
    pub url: String,
    /// Folder of the scans.
    pub scans: String,
    /// Whether the devices are simulated.
    pub simulated: bool,
}

/// Printed by `view` once it answers.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct ServedView {
    /// Its page, with the token.
    pub url: String,
    /// The files.
    #[schema(value_type = Vec<String>)]
    pub files: Vec<PathBuf>,
}

/// Printed by `firmware-sim` once the drive answers.
#[cfg(devices)]
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SimulatedDriveReady {
    /// Its terminal, or the CAN interface.
    #[schema(value_type = String)]
    pub port: PathBuf,
}

/// A page of `help`.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct HelpText {
    /// The words after `help`.
    pub topic: String,
    /// The text.
    pub text: String,
}

#[cfg(all(test, devices))]
mod tests {
    use std::collections::BTreeMap;
    use std::path::Path;

    use analysis::tradeoff::TradeoffReport;
    use clap::{Command, CommandFactory};
    use engine::accuracy::AccuracyReport;
    use engine::calibrate::CalibrateReport;
    use engine::capture::scan_planner::PlanReport;
    use engine::document::{ErrorReport, schema};
    use engine::reconstruct::lidar_copy::LidarCopyReport;
    use engine::reconstruct::report::{InfoReport, ScanReport};
    use engine::service::axis_report::{AxisReport, StoppedCommand};
    use engine::simulate::SimulationReport;
    use serde_json::Value;

    use super::*;
    use crate::cli::Cli;

    fn schemas() -> BTreeMap<String, Value> {
        fn of<T: Document>() -> (String, Value) {
            (format!("{}.json", T::SCHEMA), schema::<T>())
        }
        [
            of::<ScanReport>(),
            of::<InfoReport>(),
            of::<LidarCopyReport>(),
            of::<AxisReport>(),
            of::<StoppedCommand>(),
            of::<TradeoffReport>(),
            of::<CalibrateReport>(),
            of::<AccuracyReport>(),
            of::<ErrorReport>(),
            of::<PlanReport>(),
            of::<AnalyzeReport>(),
            of::<SettingsReport>(),
            of::<SimulationReport>(),
            of::<DoctorReport>(),
            of::<BringUpReport>(),
            of::<DaemonReport>(),
            of::<ServedView>(),
            of::<SimulatedDriveReady>(),
            of::<HelpText>(),
        ]
        .into()
    }

    /// `VELOMOTION_BLESS=1` writes them.
    #[test]
    fn the_schemas_of_the_book_are_those_of_the_program() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/schema");
        if std::env::var_os("VELOMOTION_BLESS").is_some() {
            std::fs::create_dir_all(&folder).unwrap();
            for (name, schema) in schemas() {
                std::fs::write(folder.join(name), format!("{schema:#}\n")).unwrap();
            }
        }
        let mut written = BTreeMap::new();
        for file in std::fs::read_dir(&folder).unwrap() {
            let file = file.unwrap();
            let text = std::fs::read_to_string(file.path()).unwrap();
            let name = file.file_name().into_string().unwrap();
            written.insert(name, serde_json::from_str::<Value>(&text).unwrap());
        }
        assert_eq!(written, schemas(), "remake with VELOMOTION_BLESS=1");
    }

    /// The reference of the book: commands with their arguments and options.
    fn commands_page() -> String {
        fn add(command: &Command, page: &mut String) {
            for command in command.get_subcommands() {
                let name = command.get_bin_name().unwrap_or_default();
                let help = command
                    .clone()
                    .term_width(100)
                    .render_long_help()
                    .to_string();
                let lines = help.lines().map(str::trim_end).collect::<Vec<_>>();
                let text = lines.join("\n");
                page.push_str(&format!(
                    "\n## {name}\n\n```text\n{}\n```\n",
                    text.trim_end()
                ));
                add(command, page);
            }
        }
        let mut cli = Cli::command();
        cli.build();
        let mut page = "# Commands\n\nEvery command with its arguments and options, as its `--help` prints them.\n".to_owned();
        add(&cli, &mut page);
        page.push_str("\nMade by `VELOMOTION_BLESS=1 cargo test -p velomotion --lib documents`.\n");
        page
    }

    /// `VELOMOTION_BLESS=1` writes it.
    #[test]
    fn the_commands_of_the_book_are_those_of_the_program() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/commands.md");
        if std::env::var_os("VELOMOTION_BLESS").is_some() {
            std::fs::write(&path, commands_page()).unwrap();
        }
        let written = std::fs::read_to_string(&path).unwrap();
        assert!(written == commands_page(), "remake with VELOMOTION_BLESS=1");
    }

    #[test]
    fn every_reference_of_a_schema_resolves() {
        fn check(value: &Value, whole: &Value) {
            match value {
                Value::Object(object) => object.iter().for_each(|(key, value)| {
                    if key == "$ref" {
                        let pointer = value.as_str().unwrap().trim_start_matches('#');
                        assert!(whole.pointer(pointer).is_some(), "{pointer}");
                    }
                    check(value, whole);
                }),
                Value::Array(array) => array.iter().for_each(|value| check(value, whole)),
                _ => {}
            }
        }
        for schema in schemas().values() {
            check(schema, schema);
        }
    }
}
