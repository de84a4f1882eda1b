//! `analyze --report DIR`: page, figures and curves.
//!
//! `analysis::figures` draws. There are no PNG pictures: an SVG renderer would be larger than the
//! program's own code.

use std::path::{Path, PathBuf};

use analysis::density::Icosahedron;
use analysis::figures::{self, AnalyzedScan, AnalyzedScans, InView, csv};

use super::input::Input;
use super::report::{AnalyzeReport, PatternReport};
use crate::cli;
use crate::terminal::Progress;
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::output::{make_folder, write_text};

/// A report folder under construction.
pub struct Folder {
    path: PathBuf,
    force: bool,
    scans: AnalyzedScans,
}

impl Folder {
    /// Creates the requested folder, before anything is measured.
    ///
    /// # Errors
    /// [`Kind::Usage`] for a folder with files, without `--force`; [`Kind::BadInput`] if it cannot
    /// be created.
    pub fn new(arguments: &cli::Analyze) -> Result<Option<Self>, Failure> {
        let Some(path) = arguments.report.clone() else {
            return Ok(None);
        };
        if !arguments.force && holds_something(&path) {
            let what = format!("{} exists already and is not empty", path.display());
            let help = "name another folder, or write into it with --force";
            return Err(Failure::new(Kind::Usage, what).help(help));
        }
        make_folder(&path)?;
        let bins = Icosahedron::new(arguments.level)
            .map_err(|error| Failure::new(Kind::Usage, error.to_string()))?;
        Ok(Some(Self {
            path,
            force: arguments.force,
            scans: AnalyzedScans {
                program: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
                command: command(arguments),
                bins,
                scans: Vec::new(),
            },
        }))
    }

    /// Stores what the figures need of a scan, independent of its size.
    pub fn add(&mut self, input: &Input, pattern: &PatternReport) {
        let (planes, sphere) = input.directions.pictures();
        self.scans.scans.push(AnalyzedScan {
            name: pattern.name.clone(),
            points: pattern.points,
            scan_s: pattern.scan_s,
            hole_deg: pattern.hole.radius_deg,
            in_view: pattern.density_in_view.map(|statistics| InView {
                statistics,
                hole_deg: pattern.hole_in_view.map(|hole| hole.radius_deg),
            }),
            warnings: pattern.warnings.clone(),
            counts: pattern.density.counts.clone(),
            k: pattern.k.curve.clone(),
            method: pattern.k.method,
            planes,
            sphere,
        });
    }

    /// Writes all files and reports them.
    ///
    /// # Errors
    /// [`Kind::BadInput`] if the system refuses.
    pub fn write(&self, report: &AnalyzeReport, progress: &Progress) -> Result<(), Failure> {
        let scans = &self.scans;
        let json = report.to_json();
        let files = [
            ("points.svg", figures::points(scans)),
            ("density.svg", figures::density(scans)),
            ("histogram.svg", figures::histogram(scans)),
            ("planes.svg", figures::planes(scans)),
            ("k.svg", figures::curves(scans)),
            ("density.csv", csv::density(scans)),
            ("histogram.csv", csv::histogram(scans)),
            ("k.csv", csv::k(scans)),
            ("analyze.json", format!("{json:#}\n")),
            ("index.html", figures::page(scans)),
        ];
        for (name, content) in &files {
            let file = self.path.join(name);
            write_text(&file, content, self.force)?;
            progress.say(&format!("wrote {}", file.display()));
        }
        Ok(())
    }
}

/// Whether the path exists and is more than an empty folder.
fn holds_something(path: &Path) -> bool {
    match std::fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => path.exists(),
    }
}

/// The command that repeats the measurement.
fn command(arguments: &cli::Analyze) -> String {
    let mut words = vec!["velomotion analyze".to_owned()];
    let inputs = arguments.inputs.iter();
    words.extend(
        inputs.map(|input| match input.contains(char::is_whitespace) {
            true => format!("'{input}'"),
            false => input.clone(),
        }),
    );
    let cli::Analyze {
        level,
        k_error,
        bins,
        origin,
        ..
    } = arguments;
    if let Some([x, y, z]) = origin {
        words.push(format!("--origin={x},{y},{z}"));
    }
    words.push(format!("--level {level} --bins {bins} --k-error {k_error}"));
    words.join(" ")
}
