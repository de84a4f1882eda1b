//! `velomotion tradeoff`: the time that gaps and errors cost.
//!
//! `analysis::tradeoff` has tables and pages; the study and the files are here. Studies behind the
//! program's own choices are in the crate `studies`.

mod scan_speed;
mod text;

use std::path::{Path, PathBuf};

use analysis::tradeoff::{Bench, Book, Effort, Machine, StudyReport, TradeoffReport, html, svg};

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::terminal::Progress;
use engine::document::Document;
use engine::failure::{Failure, Kind};
use engine::output::{check_free, make_folder, write_text};

/// The page of the book that `--markdown` writes.
const BOOK: Book<'_> = Book {
    title: "What accuracy costs in time",
    command: "velomotion tradeoff --markdown docs/src --force",
    name: "tradeoff",
};

/// Runs the command.
///
/// # Errors
/// [`Kind::Usage`] for a file that exists; [`Kind::Incomplete`] if the study or a file fails.
pub fn run(arguments: &cli::Tradeoff, common: &Common) -> Result<CommandOutput, Failure> {
    let study = scan_speed::SCAN_SPEED;
    prepare(arguments, study.name)?;
    let effort = if arguments.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let progress = Progress::new(common);
    let bench = Bench {
        clock: &mut io::clock::steady,
        effort,
        say: &mut |line| progress.say(line),
    };
    let machine = Machine::current(|path| std::fs::read_to_string(path).ok());
    let report = StudyReport::measure(&[study], machine, bench).map_err(|(name, error)| {
        Failure::new(Kind::Incomplete, format!("study {name}: {error}"))
            .help("report it with the output of velomotion tradeoff -vv")
    })?;
    for (path, content) in files(arguments, &report) {
        write_text(&path, &content, arguments.force)?;
        progress.say(&format!("wrote {}", path.display()));
    }
    Ok(CommandOutput::result(
        &TradeoffReport::new(&report),
        text::report(&report),
    ))
}

/// Creates the folders, and refuses to overwrite files without `--force`, before any measurement.
fn prepare(arguments: &cli::Tradeoff, study: &str) -> Result<(), Failure> {
    let figure = |folder: &Path| folder.join(format!("{study}.svg"));
    let mut files = Vec::new();
    if let Some(folder) = &arguments.report {
        files.extend(["index.html", "tradeoff.json"].map(|name| folder.join(name)));
        files.push(figure(folder));
    }
    if let Some(folder) = &arguments.markdown {
        files.push(folder.join(format!("{}.md", BOOK.name)));
        files.push(figure(&folder.join(BOOK.name)));
    }
    for file in &files {
        check_free(file, arguments.force)?;
    }
    let folders = files.iter().filter_map(|file| file.parent());
    folders.into_iter().try_for_each(make_folder)
}

/// Paths and contents of the files to write.
fn files(arguments: &cli::Tradeoff, report: &StudyReport) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    if let Some(folder) = &arguments.report {
        files.push((folder.join("index.html"), html::page(report)));
        let json = TradeoffReport::new(report).to_json();
        files.push((folder.join("tradeoff.json"), format!("{json:#}\n")));
        files.extend(report.studies.iter().map(|study| {
            let path = folder.join(format!("{}.svg", study.study.name));
            (path, svg::figure(study))
        }));
    }
    if let Some(folder) = &arguments.markdown {
        let book = BOOK.files(report).into_iter();
        files.extend(book.map(|(path, content)| (folder.join(path), content)));
    }
    files
}
