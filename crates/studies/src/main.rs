//! Measurements behind velomotion's own choices. One file per study; `STUDIES` lists them. The
//! other modules are their parts.
//!
//! ```sh
//! cargo run --release -p studies -- --markdown docs/src
//! ```
//!
//! The study framework (tables, Pareto fronts, figures, pages) is `analysis::tradeoff`, which
//! `velomotion tradeoff` uses too.

mod ball;
mod beam_sampling;
mod bvh_quality;
mod clocks;
mod formats;
mod granularity;
mod k_function;
mod placing;
mod precision;
mod shots;
#[cfg(test)]
mod tests;
mod trajectory;
mod trigonometry;
mod workload;

use std::error::Error;
use std::path::PathBuf;

use analysis::tradeoff::{self, Bench, Book, Effort, Machine, Study, StudyReport};
use clap::Parser;

/// Measures the choices behind velomotion's own arithmetic.
#[derive(Parser)]
struct Arguments {
    /// Folder of the book's pages: writes studies.md, and its figures into studies/
    #[arg(long, value_name = "DIR")]
    markdown: Option<PathBuf>,
    /// Only these studies
    #[arg(long, value_name = "NAME[,NAME]", value_delimiter = ',')]
    only: Vec<String>,
    /// Smaller workloads and fewer rounds
    #[arg(long)]
    quick: bool,
}

/// The page of the book that this program writes.
const BOOK: Book<'_> = Book {
    title: "Studies behind velomotion's choices",
    command: "cargo run --release -p studies -- --markdown docs/src",
    name: "studies",
};

/// The studies in the order of the page.
const STUDIES: [Study; 9] = [
    trajectory::TRAJECTORIES,
    granularity::GRANULARITY,
    trigonometry::TRIGONOMETRY,
    clocks::CLOCKS,
    k_function::K_FUNCTION,
    formats::FORMATS,
    beam_sampling::BEAM_SAMPLING,
    precision::PRECISION,
    bvh_quality::BVH_QUALITY,
];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let effort = if arguments.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let bench = Bench {
        clock: &mut io::clock::steady,
        effort,
        say: &mut |line| eprintln!("{line}"),
    };
    let selected = tradeoff::select(&STUDIES, &arguments.only)?;
    let machine = Machine::current(|path| std::fs::read_to_string(path).ok());
    let report = StudyReport::measure(&selected, machine, bench)
        .map_err(|(name, error)| format!("study {name}: {error}"))?;
    if let Some(folder) = arguments.markdown {
        std::fs::create_dir_all(folder.join(BOOK.name))?;
        for (path, content) in BOOK.files(&report) {
            std::fs::write(folder.join(path), content)?;
        }
    }
    print!("{}", BOOK.page(&report));
    Ok(())
}
