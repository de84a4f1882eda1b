//! `velomotion tradeoff`: what every choice that buys accuracy costs in time, measured on this machine and now.
//!
//! One file a study; `studies` lists them. What a study is, and how findings become tables, figures and pages, is
//! `analysis::tradeoff`'s. Here are the clock, the machine's name and the files.

mod ball;
mod beam_sampling;
mod bvh_quality;
mod clocks;
mod formats;
mod granularity;
mod machine;
mod precision;
mod scan_speed;
mod shots;
mod trajectory;
mod trigonometry;
mod workload;

use std::path::{Path, PathBuf};

use analysis::tradeoff::{
    Bench, Effort, Findings, KFunction, Report, Study, html, json, markdown, svg, text,
};

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::terminal::Progress;
use engine::failure::{Failure, Kind};
use engine::output::{check_free, make_folder, write_text};

/// The studies, in the order of the page.
fn studies() -> Vec<&'static dyn Study> {
    vec![
        &granularity::Granularity,
        &trigonometry::Trigonometry,
        &trajectory::Trajectories,
        &clocks::Clocks,
        &formats::Formats,
        &beam_sampling::BeamSampling,
        &precision::Precision,
        &bvh_quality::BvhQuality,
        &KFunction,
        &scan_speed::ScanSpeed,
    ]
}

/// Runs the command.
///
/// # Errors
/// [`Kind::Usage`] for a study that there is not, or a file that is there; [`Kind::Incomplete`] where a study or a file fails.
pub fn run(arguments: &cli::Tradeoff, common: &Common) -> Result<CommandOutput, Failure> {
    let chosen = choose(&arguments.only)?;
    let names: Vec<&str> = chosen.iter().map(|study| study.name()).collect();
    let folders = Folders::new(arguments);
    folders.check(&names, arguments.force)?;
    let effort = if arguments.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let progress = Progress::new(common);
    let mut findings = Vec::with_capacity(chosen.len());
    for (number, study) in chosen.iter().enumerate() {
        progress.say(&format!(
            "{} of {}: {}",
            number + 1,
            chosen.len(),
            study.title()
        ));
        findings.push(measure(*study, effort, &progress)?);
    }
    let report = Report {
        program: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
        effort,
        machine: machine::this(),
        studies: findings,
    };
    for file in folders.write(&report, arguments.force)? {
        progress.say(&format!("wrote {}", file.display()));
    }
    Ok(CommandOutput::result(
        &json::report(&report),
        text::report(&report),
    ))
}

/// The studies asked for, in their own order; all where none is named.
fn choose(only: &[String]) -> Result<Vec<&'static dyn Study>, Failure> {
    let all = studies();
    let known = |name: &String| all.iter().any(|study| study.name() == name);
    if let Some(unknown) = only.iter().find(|name| !known(name)) {
        let names: Vec<&str> = all.iter().map(|study| study.name()).collect();
        return Err(
            Failure::new(Kind::Usage, format!("there is no study {unknown:?}")).help(format!(
                "choose of {} with --only, or leave it out for all",
                names.join(", ")
            )),
        );
    }
    let wanted =
        |study: &&dyn Study| only.is_empty() || only.iter().any(|name| study.name() == name);
    Ok(all.into_iter().filter(wanted).collect())
}

fn measure(study: &dyn Study, effort: Effort, progress: &Progress) -> Result<Findings, Failure> {
    let mut clock = io::clock::steady;
    let mut say = |line: &str| progress.say(&format!("  {line}"));
    let mut bench = Bench {
        clock: &mut clock,
        effort,
        say: &mut say,
    };
    study.measure(&mut bench).map_err(|error| {
        let name = study.name();
        Failure::new(Kind::Incomplete, format!("study {name}: {error}")).help(format!(
            "leave it out with --only, and report it with the output of --only {name} -vv"
        ))
    })
}

/// Where files go.
struct Folders<'a> {
    report: Option<&'a Path>,
    markdown: Option<&'a Path>,
}

/// The book's page, and the folder of its figures.
const PAGE: &str = "tradeoff";

impl<'a> Folders<'a> {
    fn new(arguments: &'a cli::Tradeoff) -> Self {
        Self {
            report: arguments.report.as_deref(),
            markdown: arguments.markdown.as_deref(),
        }
    }

    /// Refuses what would be overwritten unasked, before anything is measured, and makes the folders.
    fn check(&self, studies: &[&str], force: bool) -> Result<(), Failure> {
        let figures = |folder: PathBuf| {
            let names = studies.iter().map(|name| format!("{name}.svg"));
            names.map(move |name| folder.join(name)).collect::<Vec<_>>()
        };
        let mut files = Vec::new();
        let mut folders = Vec::new();
        if let Some(folder) = self.report {
            files.extend(["index.html", "tradeoff.json"].map(|name| folder.join(name)));
            files.extend(figures(folder.to_owned()));
            folders.push(folder.to_owned());
        }
        if let Some(folder) = self.markdown {
            files.push(folder.join(format!("{PAGE}.md")));
            files.extend(figures(folder.join(PAGE)));
            folders.push(folder.join(PAGE));
        }
        for file in &files {
            check_free(file, force)?;
        }
        folders.iter().try_for_each(|folder| make_folder(folder))
    }

    /// Writes everything; which files those were.
    fn write(&self, report: &Report, force: bool) -> Result<Vec<PathBuf>, Failure> {
        let mut files: Vec<(PathBuf, String)> = Vec::new();
        let figures = |folder: &Path| -> Vec<(PathBuf, String)> {
            let all = report.studies.iter();
            all.map(|study| {
                let name = format!("{}.svg", study.name);
                (folder.join(name), svg::figure(study))
            })
            .collect()
        };
        if let Some(folder) = self.report {
            files.push((folder.join("index.html"), html::page(report)));
            let json = super::json(&json::report(report));
            files.push((folder.join("tradeoff.json"), format!("{json:#}\n")));
            files.extend(figures(folder));
        }
        if let Some(folder) = self.markdown {
            let command = "velomotion tradeoff --markdown docs/src --force";
            let page = markdown::page(report, command, PAGE);
            files.push((folder.join(format!("{PAGE}.md")), page));
            files.extend(figures(&folder.join(PAGE)));
        }
        for (path, content) in &files {
            write_text(path, content, force)?;
        }
        Ok(files.into_iter().map(|(path, _)| path).collect())
    }
}
