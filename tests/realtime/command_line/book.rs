//! The book's tutorials, run as they are printed.

use super::*;

/// A fenced block of a page: its language, its text, and the line of prose before it.
struct Block {
    language: String,
    text: String,
    before: String,
}

fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src")
}

fn blocks_of(page: &Path) -> Vec<Block> {
    let page = std::fs::read_to_string(page).unwrap();
    let mut blocks = Vec::new();
    let mut before = String::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        match line.strip_prefix("```") {
            Some(language) => {
                let text = lines.by_ref().take_while(|line| *line != "```");
                blocks.push(Block {
                    language: language.to_owned(),
                    text: text.flat_map(|line| [line, "\n"]).collect(),
                    before: std::mem::take(&mut before),
                });
            }
            None if !line.is_empty() => line.clone_into(&mut before),
            None => {}
        }
    }
    blocks
}

/// Runs the commands of a page in the order of their printing, but those for a checkout (`cargo`)
/// and for a browser (`velomotion view`).
fn run_page(place: &Place, page: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_velomotion"));
    let path = std::env::var("PATH").unwrap();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    let mut ran = 0;
    for block in blocks_of(&book().join(page).with_extension("md")) {
        match block.language.as_str() {
            "toml" => {
                // "Save this as `NAME`:"
                let name = block.before.split('`').nth(1).unwrap();
                std::fs::write(place.path(name), block.text).unwrap();
            }
            "sh" | "console" => {
                let is_console = block.language == "console";
                let commands = block.text.lines().filter_map(|line| match is_console {
                    true => line.strip_prefix("$ "),
                    false => Some(line),
                });
                let elsewhere =
                    |line: &&str| line.starts_with("cargo ") || line.starts_with("velomotion view");
                let commands: Vec<&str> = commands.filter(|line| !elsewhere(line)).collect();
                let output = Command::new("bash")
                    .args(["-ec", &commands.join("\n")])
                    .current_dir(place.0.path())
                    .env("PATH", &path)
                    .env("XDG_RUNTIME_DIR", place.0.path())
                    .output()
                    .unwrap();
                let said = String::from_utf8_lossy(&output.stderr).into_owned();
                assert!(output.status.success(), "{page}: {commands:#?}\n{said}");
                ran += commands.len();
            }
            _ => {}
        }
    }
    assert!(ran > 0, "{page} has no command");
}

#[test]
fn the_first_scan_runs_as_printed() {
    let place = Place::new();
    // The checkout's first command, by the program under test.
    let captured = place.run("capture --speed 56.25");
    assert!(captured.status.success(), "{captured:?}");
    run_page(&place, "quick-start");
    assert!(place.path("hall.laz").exists());
}

#[test]
fn the_choice_of_a_speed_runs_as_printed() {
    run_page(&Place::new(), "which-speed");
}

#[test]
#[ignore = "needs two minutes: 3 million shots"]
fn the_calibration_of_a_simulated_scanner_runs_as_printed() {
    let place = Place::new();
    run_page(&place, "calibrate-simulated");
    let mount = std::fs::read_to_string(place.path("mount.toml")).unwrap();
    assert!(mount.contains("rotation_deg"), "{mount}");
}

/// The commands of velomotion in a line for a shell, without pipes, redirections and comments.
fn commands_of(line: &str) -> Vec<Vec<String>> {
    let line = line.strip_prefix("$ ").unwrap_or(line);
    let line = line.split(" # ").next().unwrap_or_default();
    let parts = line.split(['|', ';', '&']).map(str::trim);
    let commands = parts.filter_map(|part| {
        let part = part.split(" > ").next().unwrap_or_default();
        let program = [
            "velomotion ",
            "target/release/velomotion ",
            "cargo run --release -- ",
        ];
        let arguments = program.iter().find_map(|name| part.strip_prefix(name))?;
        Some(shlex::split(&format!("velomotion {arguments}")).unwrap())
    });
    commands.collect()
}

/// The lines of a block for a shell, whole.
fn shell_of(block: &Block) -> String {
    let text = block.text.replace("\\\n", "");
    let is_typed = |line: &&str| match block.language.as_str() {
        "sh" => true,
        "console" => line.starts_with("$ "),
        _ => false,
    };
    let lines = text.lines().filter(is_typed);
    lines.flat_map(|line| [line, "\n"]).collect()
}

/// Tutorials run; of all other commands verbs, options and values exist, of those in prose verbs
/// and options.
#[test]
fn every_command_of_the_book_is_understood() {
    use clap::error::ErrorKind;
    let mut pages = vec![book().join("../../README.md")];
    for page in std::fs::read_dir(book()).unwrap() {
        let page = page.unwrap().path();
        pages.extend((page.extension().is_some_and(|is| is == "md")).then_some(page));
    }
    let (mut commands, mut wrong) = ([0, 0], Vec::new());
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let mut is_block = false;
        let prose = text.lines().filter(|line| {
            let is_fence = line.starts_with("```");
            is_block ^= is_fence;
            !is_block && !is_fence
        });
        let prose = prose.collect::<Vec<_>>().join(" ");
        let spans = prose.split('`').skip(1).step_by(2);
        let blocks: String = blocks_of(&page).iter().map(shell_of).collect();
        let lines = blocks.lines().map(|line| (0, line));
        for (is_span, line) in lines.chain(spans.map(|span| (1, span))) {
            for words in commands_of(line) {
                let parsed = <velomotion::cli::Cli as clap::Parser>::try_parse_from(&words);
                let is_accepted = match parsed.map_err(|error| error.kind()) {
                    Ok(_) => true,
                    Err(ErrorKind::UnknownArgument) => false,
                    Err(ErrorKind::InvalidSubcommand) => line.contains('<'),
                    // In prose a name such as "velomotion plan", or a placeholder.
                    Err(_) => is_span == 1,
                };
                if !is_accepted {
                    wrong.push(format!("{}: {words:?}", page.display()));
                }
                commands[is_span] += 1;
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(commands[0] > 60 && commands[1] > 40, "{commands:?}");
}
