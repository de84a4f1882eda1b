//! Writes man pages and shell completions: `cargo run -p velomotion --example manual -- FOLDER`.

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use clap::ValueEnum;
use clap_complete::Shell;
use velomotion::commands::help;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.ok_or("expected a folder to write to")?;
    let manual = folder.join("man");
    fs::create_dir_all(&manual)?;
    clap_mangen::generate_to(help::command(), &manual)?;
    let completions = folder.join("completions");
    fs::create_dir_all(&completions)?;
    for shell in Shell::value_variants() {
        let file =
            clap_complete::generate_to(*shell, &mut help::command(), "velomotion", &completions)?;
        println!("{}", file.display());
    }
    Ok(())
}
