//! `velomotion help`: commands with examples, and the pages of the book, which are in the program
//! because a laptop in the field may have no network.

use std::ffi::OsString;

use clap::FromArgMatches;
use clap::error::ErrorKind;
use engine::failure::{Failure, Kind};

use super::CommandOutput;
use crate::cli::{self, Cli};
use crate::documents::HelpText;
use crate::terminal::{width_of, wrapped};

/// Two examples of each command, and the page of the book about it.
const EXAMPLES: [(&str, [&str; 2], &str); 16] = [
    (
        "velomotion",
        ["capture --speed 56.25", "replay scan.pcapng -o scan.laz"],
        "quick-start",
    ),
    (
        "capture",
        [
            "capture --speed 56.25",
            "capture --speed 20 --both-ways -o hall.e57 --device sim",
        ],
        "capture",
    ),
    (
        "plan",
        [
            "plan --at 20m --error 65mm --gap 0.8deg",
            "plan --time 10s --lidar vlp16 --rpm 300,600,1200 --device auto",
        ],
        "plan",
    ),
    (
        "replay",
        [
            "replay hall.pcapng -o hall.laz --uncertainty",
            "replay street.pcap --tilt none --frames 0 -o street.mcap",
        ],
        "replay",
    ),
    (
        "calibrate",
        [
            "calibrate fast.pcapng slow.pcapng -o mount.toml",
            "calibrate hall.pcapng --fix play --level floor --report calibration",
        ],
        "calibration",
    ),
    (
        "accuracy",
        [
            "accuracy fast.pcapng slow.pcapng --mount mount.toml --report accuracy",
            "accuracy hall.pcapng --scene hall",
        ],
        "accuracy-study",
    ),
    (
        "simulate",
        [
            "simulate hall",
            "simulate scene.toml -o scene.pcapng --truth truth.ply --seed 7",
        ],
        "scenes",
    ),
    (
        "view",
        ["view hall.ply", "view hall.pcapng before.laz --no-open"],
        "view",
    ),
    (
        "info",
        ["info hall.pcapng", "info street.pcap --json"],
        "replay",
    ),
    (
        "analyze",
        [
            "analyze vlp16 velomotion16:50",
            "analyze hall.ply --report hall-report",
        ],
        "patterns",
    ),
    (
        "tradeoff",
        ["tradeoff --quick", "tradeoff --report tradeoff-report"],
        "tradeoff",
    ),
    ("tilt", ["tilt status", "tilt goto -20 --speed 5"], "tilt"),
    (
        "daemon",
        ["daemon --device sim", "daemon --listen 127.0.0.1:8016"],
        "daemon",
    ),
    (
        "doctor",
        ["doctor", "doctor --bring-up --device bench"],
        "bring-up",
    ),
    (
        "firmware-sim",
        [
            "firmware-sim --usb --link epos2",
            "firmware-sim --rs232 --gravity 200 --brake 20,30",
        ],
        "simulator",
    ),
    ("help", ["help capture", "help formats"], "quick-start"),
];

/// Builds the table of pages from their names.
macro_rules! pages {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../book/", $name, ".md")))),*]
    };
}

/// The pages of the book for users, in its order.
const PAGES: [(&str, &str); 32] = pages!(
    "quick-start",
    "first-scan",
    "which-speed",
    "calibrate-simulated",
    "open-a-cloud",
    "install",
    "wiring",
    "bring-up",
    "plan",
    "capture",
    "replay",
    "view",
    "calibration",
    "accuracy-study",
    "tilt",
    "daemon",
    "page",
    "python",
    "ros2",
    "formats",
    "json",
    "simulator",
    "scenes",
    "effects",
    "patterns",
    "accuracy",
    "tradeoff",
    "links",
    "k",
    "faults",
    "troubleshooting",
    "glossary",
);

/// The command line with examples at the end of every help text.
#[must_use]
pub fn command() -> clap::Command {
    let mut command = <Cli as clap::CommandFactory>::command();
    for (name, examples, page) in EXAMPLES {
        let end = format!(
            "Examples:\n  velomotion {}\n  velomotion {}\n\nBook: velomotion help {page}",
            examples[0], examples[1]
        );
        command = match command.get_name() == name {
            true => command.after_help(end),
            false => command.mut_subcommand(name, |own| {
                own.after_help(&end)
                    .mut_subcommands(|verb| verb.after_help(&end))
            }),
        };
    }
    command
}

/// Parses the command line of this process; prints help or version and exits if it requests that.
///
/// # Errors
/// [`Kind::Usage`].
pub fn parse() -> Result<Cli, Failure> {
    parse_from(std::env::args_os())
}

fn parse_from(words: impl IntoIterator<Item = OsString>) -> Result<Cli, Failure> {
    let parsed = command().try_get_matches_from(words);
    let parsed = parsed.and_then(|matches| Cli::from_arg_matches(&matches));
    parsed.map_err(|error| match error.kind() {
        ErrorKind::DisplayHelp
        | ErrorKind::DisplayVersion
        | ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => error.exit(),
        _ => usage(&error),
    })
}

/// The failure of an invalid command line. Its help is the parser's tip, or the usage.
fn usage(error: &clap::Error) -> Failure {
    let text = error.render().to_string();
    let flat = |text: &str| {
        text.split_whitespace()
            .map(brief)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut paragraphs = text.split("\n\n").map(flat);
    let message = paragraphs.next().unwrap_or_default();
    let message = message.strip_prefix("error: ").unwrap_or(&message);
    // A long list of values is help, which is not cut.
    let (message, values) = match message.split_once(" [possible values: ") {
        Some((message, values)) => (message, Some(values.trim_end_matches(']'))),
        // The list has hidden subcommands; --help has the others.
        None => match message.split_once(" [subcommands: ") {
            Some((message, _)) => (message, None),
            None => (message, None),
        },
    };
    let values = values.map(|values| format!("use one of: {values}"));
    let message = match message.char_indices().nth(LONGEST_MESSAGE) {
        Some((end, _)) => format!("{}...", message.get(..end).unwrap_or_default()),
        None => message.to_owned(),
    };
    let help = paragraphs
        .filter(|paragraph| {
            !OMITTED_PARAGRAPHS
                .iter()
                .any(|words| paragraph.contains(words))
        })
        .map(|paragraph| match paragraph.strip_prefix("tip: ") {
            Some(tip) => tip.to_owned(),
            None => paragraph,
        })
        .chain(["--help lists all options".to_owned()]);
    let help = values.into_iter().chain(help);
    Failure::new(Kind::Usage, message).help(help.collect::<Vec<_>>().join("\n"))
}

/// Words of the parser's paragraphs that help no user: how to give a value that looks like an
/// option, and a command that this program alone runs.
const OMITTED_PARAGRAPHS: [&str; 3] = ["For more information", "tip: to pass", "guard-axis"];

/// Characters of a message; a value with many words is cut there.
const LONGEST_MESSAGE: usize = 300;

/// A word of a message; the middle of a long one, such as a file given for a number, is omitted.
fn brief(word: &str) -> String {
    const LONGEST: usize = 60;
    let length = word.chars().count();
    if length <= LONGEST {
        return word.to_owned();
    }
    let first: String = word.chars().take(LONGEST / 2).collect();
    let last: String = word.chars().skip(length - LONGEST / 3).collect();
    format!("{first}...{last}")
}

/// Runs the command.
///
/// # Errors
/// [`Kind::Usage`] for neither a command nor a page.
pub fn run(arguments: &cli::Help) -> Result<CommandOutput, Failure> {
    let topic = arguments.words.join(" ");
    let text = |width| text(&arguments.words, width);
    let page = text(None).ok_or_else(|| {
        let message = format!("{topic} is neither a command nor a page of the book");
        Failure::new(Kind::Usage, message).help("velomotion help lists both")
    })?;
    let shown = text(width_of(std::io::stdout())).unwrap_or_default();
    let page = HelpText { topic, text: page };
    Ok(CommandOutput::result(&page, shown))
}

/// Columns of a page on a wide terminal.
const MAX_WIDTH: usize = 100;

/// Fills the paragraphs and items of Markdown to a width. Headings, tables and code stay.
fn refilled(text: &str, width: usize) -> String {
    let mut lines: Vec<(String, bool)> = Vec::new();
    let mut is_code = false;
    for line in text.lines() {
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        let stays = is_code || is_fence || line.is_empty() || line.starts_with(['|', '#']);
        match lines.last_mut() {
            Some((paragraph, false)) if !stays && item_indentation(line).is_none() => {
                paragraph.push(' ');
                paragraph.push_str(line.trim_start());
            }
            _ => lines.push((line.to_owned(), stays)),
        }
    }
    let fill = |(line, stays): &(String, bool)| match stays {
        true => line.clone(),
        false => wrapped(line, Some(width), "", item_indentation(line).unwrap_or("")),
    };
    lines.iter().map(fill).collect::<Vec<_>>().join("\n")
}

/// The indentation of the further lines of an item of a list; `None` of any other line.
fn item_indentation(line: &str) -> Option<&'static str> {
    let (mark, _) = line.split_once(' ')?;
    let is_number = |mark: &str| mark.parse::<u8>().is_ok();
    match mark {
        "-" => Some("  "),
        _ => mark
            .strip_suffix('.')
            .is_some_and(is_number)
            .then_some("   "),
    }
}

/// Explains a command, with the page of its name if there is one, or a page; without words lists
/// both. Pages are filled to a width if there is one.
fn text(words: &[String], width: Option<usize>) -> Option<String> {
    let mut command = command();
    command.build();
    let [first, ..] = words else {
        let longest = PAGES.iter().map(|(name, _)| name.len()).max();
        let width = longest.unwrap_or_default();
        let pages = PAGES.map(|(name, text)| {
            let title = text.lines().find_map(|line| line.strip_prefix("# "));
            format!("  {name:width$}  {}", title.unwrap_or_default())
        });
        let help = command.render_long_help();
        return Some(format!(
            "{help}\n\nPages of the book:\n{}",
            pages.join("\n")
        ));
    };
    let page = match words {
        [name] => PAGES.iter().find(|(known, _)| known == name),
        _ => None,
    };
    let page = page.map(|(_, text)| match width {
        Some(width) => refilled(text.trim_end(), width.min(MAX_WIDTH)),
        None => text.trim_end().to_owned(),
    });
    if command.find_subcommand(first).is_none() {
        return page;
    }
    let mut found = &mut command;
    for word in words {
        found = found.find_subcommand_mut(word)?;
    }
    let help = found.render_long_help().to_string();
    let both = [Some(help.trim_end().to_owned()), page].into_iter();
    Some(both.flatten().collect::<Vec<_>>().join("\n\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_help_ends_with_two_valid_examples_and_a_page_of_the_book() {
        let root = command();
        let visible = root.get_subcommands().filter(|own| !own.is_hide_set());
        let visible: Vec<&clap::Command> = visible.collect();
        let verbs = visible.iter().flat_map(|own| own.get_subcommands());
        for own in [&root]
            .into_iter()
            .chain(visible.iter().copied())
            .chain(verbs)
        {
            let name = own.get_name();
            let help = own.clone().render_long_help().to_string();
            let (_, end) = help.split_once("Examples:\n").expect(name);
            let (examples, page) = end.split_once("\n\nBook: velomotion help ").expect(name);
            assert_eq!(examples.lines().count(), 2, "{name}: {examples}");
            for example in examples.lines() {
                let words = example.split_whitespace().map(OsString::from);
                assert_eq!(parse_from(words).err(), None, "{example}");
            }
            let known = PAGES.iter().any(|(known, _)| *known == page.trim());
            assert!(known, "{name}: {page}");
        }
    }

    /// Commands of the program in a page's shell blocks, without prompts, pipes and comments.
    fn commands_of(page: &str) -> Vec<String> {
        let mut commands = Vec::new();
        let mut language = "";
        for line in page.replace("\\\n", " ").lines() {
            if let Some(begun) = line.strip_prefix("```") {
                language = match (language, begun) {
                    ("", "") => "text",
                    ("", begun) => begun,
                    _ => "",
                };
                continue;
            }
            let line = match language {
                "sh" => line,
                // The other lines are output.
                "console" => line.strip_prefix("$ ").unwrap_or_default(),
                _ => "",
            };
            let line = line.split(" #").next().unwrap_or_default();
            let parts = line.split(['|', ';', '&', '>']);
            let own = parts.map(str::trim).filter_map(|part| {
                let part = part.strip_prefix("sudo ").unwrap_or(part);
                let words = part
                    .strip_prefix("cargo run --release -- ")
                    .or_else(|| part.strip_prefix("velomotion "))?;
                Some(format!("velomotion {words}"))
            });
            commands.extend(own);
        }
        commands
    }

    #[test]
    fn every_command_of_the_book_is_understood() {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
        let book = std::fs::read_dir(format!("{root}/docs/src")).unwrap();
        let pages = book.map(|entry| entry.unwrap().path());
        let pages = pages.chain([format!("{root}/README.md").into()]);
        let mut count = 0;
        for page in pages.filter(|page| page.extension() == Some("md".as_ref())) {
            let text = std::fs::read_to_string(&page).unwrap();
            for command in commands_of(&text) {
                let words = command.split_whitespace().map(OsString::from);
                let refused = parse_from(words).err();
                assert_eq!(refused, None, "{}: {command}", page.display());
                count += 1;
            }
        }
        assert!(count > 60, "{count} commands");
    }

    #[test]
    fn commands_verbs_and_pages_are_explained() {
        let of = |words: &[&str]| {
            text(
                &words
                    .iter()
                    .map(|&word| word.to_owned())
                    .collect::<Vec<_>>(),
                None,
            )
        };
        assert!(of(&["capture"]).unwrap().contains("--both-ways"));
        assert!(of(&["tilt", "goto"]).unwrap().contains("Target angle"));
        assert!(of(&["formats"]).unwrap().starts_with("# Formats"));
        let all = of(&[]).unwrap();
        let page = |line: &str| line.split_whitespace().eq(["formats", "Formats"]);
        assert!(
            all.contains("firmware-sim") && all.lines().any(page),
            "{all}"
        );
        assert_eq!(of(&["nothing"]), None);
        assert_eq!(of(&["tilt", "nothing"]), None);
    }

    #[test]
    fn pages_are_filled_to_the_width_of_the_terminal() {
        let text = "# A long heading stays\n\nSome words\nof a paragraph.\n\n- one item\n  goes on\n2. two\n\n\
                    ```sh\ncode that stays as it is\n```\n| a table that stays |";
        let filled = "# A long heading stays\n\nSome words of\na paragraph.\n\n- one item\n  goes on\n2. two\n\n\
                      ```sh\ncode that stays as it is\n```\n| a table that stays |";
        assert_eq!(refilled(text, 14), filled);
        for (name, page) in PAGES {
            let words = |text: &str| {
                text.split_whitespace()
                    .map(str::to_owned)
                    .collect::<Vec<_>>()
            };
            assert_eq!(words(&refilled(page, 80)), words(page), "{name}");
        }
    }

    #[test]
    fn invalid_values_are_named_in_one_short_line() {
        for (line, message) in [
            (
                "simulate hall --threads 0",
                "invalid value '0' for '--threads <N>': expected a whole number from 1 to 65535",
            ),
            (
                "simulate hall --seed -1",
                "invalid value '-1' for '--seed <N>': expected a whole number from 0 to 18446744073709551615",
            ),
            (
                "analyze vlp16 --level -1",
                "invalid value '-1' for '--level <N>': expected a whole number from 0 to 8",
            ),
            (
                "firmware-sim --usb --dither -1",
                "invalid value '-1' for '--dither <QC>': expected a whole number from 0 to 255",
            ),
            (
                "daemon --listen 8016",
                "invalid value '8016' for '--listen <ADDRESS:PORT>': expected an address and a port, such as 127.0.0.1:8016",
            ),
            (
                "capture --speed 1e300",
                "invalid value '1e300' for '--speed <DEG_PER_S>': expected a number from -1e6 to 1e6, such as 56.25",
            ),
            (
                "tilt goto 1e300",
                "invalid value '1e300' for '<DEG>': expected a number from -1e6 to 1e6, such as 56.25",
            ),
            (
                "capture",
                "the following required arguments were not provided: --speed <DEG_PER_S>",
            ),
            (
                "info log.pcapng --device sim",
                "unexpected argument '--device' found",
            ),
        ] {
            let words = ["velomotion"].into_iter().chain(line.split(' '));
            let failure = parse_from(words.map(OsString::from)).unwrap_err();
            assert_eq!(failure.message, message, "{line}");
        }
    }
}
