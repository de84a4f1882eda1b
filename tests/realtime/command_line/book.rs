//! The commands of the book and of the README, run as they are printed.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use super::*;
use crate::tilt::Bench;

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

/// Programs of a command that runs: velomotion, and what its tutorials use.
const PROGRAMS: [&str; 8] = [
    "velomotion ",
    "time velomotion ",
    "time taskset -c 0 velomotion ",
    "target/release/velomotion ",
    "ssh robot cat ",
    "sed ",
    "printf ",
    "(umask 77; ",
];

/// Beginnings of the other commands, and why they do not run here. `tests/architecture` looks
/// whether what they name exists.
const NOT_RUN: [(&str, &str); 37] = [
    ("cargo test -p ", "a test of its own, which CI runs"),
    ("cargo test --workspace", "this test is one of it"),
    ("cargo bench -p ", "measures for minutes"),
    ("cargo run --release -p ", "compiles with optimisation"),
    (
        "cargo run --release -- capture",
        "the quick start's test runs the program under test",
    ),
    ("cargo run --release --bin seeds", "fuzzing is by hand"),
    ("cargo build --release", "compiles with optimisation"),
    ("cargo run -p velomotion --example", "packaging/deb runs it"),
    (
        "cargo install --path",
        "tests/packaging/install-times runs it",
    ),
    ("cargo install cargo-", "another program"),
    ("cargo +nightly fuzz", "fuzzing is by hand"),
    ("cd fuzz", "fuzzing is by hand"),
    ("just ", "200 captures; CI runs some of them"),
    ("packaging/deb", "CI builds and checks the package"),
    ("sudo apt ", "tests/packaging/check installs and removes it"),
    ("sudo systemctl ", "tests/packaging/check uses the service"),
    ("systemctl status", "tests/packaging/check uses the service"),
    ("journalctl ", "tests/packaging/check reads the log"),
    ("systemd-analyze ", "tests/packaging/check runs it"),
    ("sudo adduser ", "changes this machine"),
    ("sudo install ", "changes this machine"),
    ("sudo tcpdump ", "needs a lidar"),
    ("sudo modprobe ", "needs a drive"),
    ("echo ", "needs a drive, or the bridge to DDS"),
    ("podman ", "tests/packaging/install-times runs it"),
    (
        "VELOMOTION_",
        "a test of its own, which writes into the sources",
    ),
    ("tests/foreign/vcan/in-vm", "CI runs it"),
    ("python3 benches/", "measures for minutes"),
    ("python3 -m venv", "CI makes one"),
    (". venv", "CI makes one"),
    ("pip install", "CI installs the wheel"),
    (
        "python crates/python/examples",
        "pytest runs it (crates/python/tests)",
    ),
    (
        "export RMW_IMPLEMENTATION",
        "ROS 2 is no package of this system",
    ),
    ("ros2 ", "ROS 2 is no package of this system"),
    ("rviz2 ", "ROS 2 is no package of this system"),
    ("ROS_DISTRO=", "tests/foreign/dds does it"),
    (
        "for scene in ",
        "makes pictures of the book, with optimisation",
    ),
];

/// Files that the commands of a page read and do not make.
const INPUTS: [(&str, &[&str]); 10] = [
    (
        "README",
        &[
            "walk.pcap",
            "scan.pcapng",
            "angles.csv",
            "mount.toml",
            "hall.ply",
        ],
    ),
    ("accuracy-study", &["mount.toml"]),
    ("formats", &["walk.pcap", "crates/sim/scenes/hall.toml"]),
    ("open-a-cloud", &["hall.pcapng"]),
    ("rays", &["crates/sim/scenes/hall.toml"]),
    ("patterns", &["hall.ply", "capture.pcapng", "survey.las"]),
    (
        "replay",
        &["walk.pcap", "rack.pcapng", "angles.csv", "mount.toml"],
    ),
    ("scenes", &["scene.toml"]),
    ("simulator", &["my-scene.toml"]),
    ("view", &["hall.pcapng", "hall.ply", "before.laz"]),
];

/// Exit codes of commands that do not succeed here.
const REFUSED: [(&str, &[i32], &str); 4] = [
    (
        "velomotion info absent.pcap --json",
        &[3],
        "the page shows its error",
    ),
    (
        "velomotion calibrate fast.pcapng slow.pcapng -o mount.toml",
        &[6],
        "the simulator's ranges have no noise",
    ),
    (
        "velomotion doctor --bring-up",
        &[5, 6],
        "the limit switches are not pressed; the machine may be too busy to poll",
    ),
    ("velomotion doctor", &[4], "the bench has no lidar"),
];

/// Makes an input of this name in the place.
fn make_input(place: &Place, name: &str) {
    let log = |name: &str| {
        let made = place.run(&format!("simulate hall -o {name}"));
        assert!(made.status.success(), "{made:?}");
    };
    let cloud = |name: &str| {
        log("input.pcapng");
        let made = place.run(&format!("replay input.pcapng -o {name}"));
        assert!(made.status.success(), "{made:?}");
        std::fs::remove_file(place.path("input.pcapng")).unwrap();
    };
    let write = |bytes: &[u8]| std::fs::write(place.path(name), bytes).unwrap();
    match name {
        "walk.pcap" => {
            std::fs::copy(recording("vlp16-strongest-gps.pcap"), place.path(name)).unwrap();
        }
        // A sensor's packets, of which the second half comes from another address.
        "rack.pcapng" => {
            let mut packets = std::fs::read(recording("vlp16-dual.pcap")).unwrap();
            let (half, address) = (packets.len() / 2, [192, 168, 1, 201]);
            for at in half..packets.len() - address.len() {
                if packets[at..].starts_with(&address) {
                    packets[at + 3] = 202;
                }
            }
            write(&packets);
        }
        "crates/sim/scenes/hall.toml" => {
            std::fs::create_dir_all(place.path(name).parent().unwrap()).unwrap();
            std::fs::copy(book().join("../..").join(name), place.path(name)).unwrap();
        }
        "angles.csv" => write(b"time_s,angle_deg\n0.0,-10\n0.02,-20\n"),
        "mount.toml" => write(b"[mount]\nd_m = 0.06\n"),
        "scene.toml" | "my-scene.toml" => {
            let blocks = blocks_of(&book().join("scenes.md"));
            let scene = blocks.iter().find(|block| block.language == "toml");
            let scene = &scene.unwrap().text;
            // The page simulates a lidar without packets.
            let other = scene.replacen("vlp16", "hdl64e", 1);
            let scene = if name == "scene.toml" { &other } else { scene };
            write(scene.as_bytes());
        }
        _ if name.ends_with(".pcapng") => log(name),
        _ => cloud(name),
    }
}

/// Pages whose commands move the axis of a simulated drive that is a device of its own.
const BENCH: [&str; 3] = ["bring-up", "first-scan", "tilt"];

/// Pages that have a test of their own.
const TUTORIALS: [&str; 3] = ["calibrate-simulated", "quick-start", "which-speed"];

/// Runs the commands of a page in the order of their printing; returns each with its exit code and
/// messages, if it is not the expected one.
fn run_page(folder: &Path, page: &str) -> Vec<Result<(), String>> {
    let mut ran = Vec::new();
    for block in blocks_of(&book().join(page).with_extension("md")) {
        if block.before.starts_with("Save this as") {
            let name = block.before.split('`').nth(1).unwrap();
            std::fs::write(folder.join(name), &block.text).unwrap();
        }
        for line in shell_of(&block).lines() {
            let line = line.strip_prefix("$ ").unwrap_or(line);
            let Some(program) = PROGRAMS.iter().find(|start| line.starts_with(**start)) else {
                continue;
            };
            // The recording is here, and the program under test is not a release.
            let rest = line.strip_prefix(program).unwrap();
            let mut line = match *program {
                "ssh robot cat " => format!("cat {rest}"),
                "target/release/velomotion "
                | "time velomotion "
                | "time taskset -c 0 velomotion " => format!("velomotion {rest}"),
                // Sweeps of minutes become shorter: their points take long in a build of tests.
                "sed " => line.replace("speed_deg_s = 0.", "speed_deg_s = "),
                _ => line.to_owned(),
            };
            // The bench has no lidar, and no person answers its questions.
            if BENCH.contains(&page) && line.starts_with("velomotion capture") {
                line.push_str(" --device sim");
            }
            if line.starts_with("velomotion doctor --bring-up") {
                line = line.replacen("--bring-up", "--bring-up --yes", 1);
            }
            let (code, output) = run_line(folder, &line);
            let refused = REFUSED.iter().find(|(start, ..)| line.starts_with(start));
            let expected = refused.map_or(&[0][..], |(_, codes, _)| codes);
            let is_expected = code.is_some_and(|code| expected.contains(&code));
            let failure = || format!("{page}: {line}: {code:?}\n{output}");
            ran.push(is_expected.then_some(()).ok_or_else(failure));
        }
    }
    ran
}

/// Runs a line of bash; returns its exit code and messages. One that serves is interrupted once it
/// does.
fn run_line(folder: &Path, line: &str) -> (Option<i32>, String) {
    let program = Path::new(env!("CARGO_BIN_EXE_velomotion"));
    let path = std::env::var("PATH").unwrap();
    assert!(!line.contains("&&"), "{line}");
    // Nice, as analyses would take both processors from the tests beside this one. The time limit
    // ends a command that hangs.
    let mut child = Command::new("timeout")
        .args([
            "--signal=KILL",
            "900",
            "nice",
            "bash",
            "-eo",
            "pipefail",
            "-c",
        ])
        .arg(format!(
            "exec 2>&1\n{}{line}",
            if line.starts_with('(') { "" } else { "exec " }
        ))
        .current_dir(folder)
        .env(
            "PATH",
            format!("{}:{path}", program.parent().unwrap().display()),
        )
        .env("XDG_RUNTIME_DIR", folder)
        .env("XDG_STATE_HOME", folder)
        .env("XDG_CONFIG_HOME", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let serves = line.starts_with("velomotion view") || line.starts_with("velomotion daemon");
    let mut output = String::new();
    for printed in BufReader::new(child.stdout.take().unwrap()).lines() {
        let printed = printed.unwrap();
        if serves && printed.starts_with("http") {
            let id = child.id().to_string();
            Command::new("kill").args(["-INT", &id]).status().unwrap();
        }
        output.push_str(&format!("{printed}\n"));
    }
    (child.wait().unwrap().code(), output)
}

/// The pages of the book, and the README.
fn pages() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(book()).unwrap();
    let pages = entries.map(|entry| entry.unwrap().path());
    let mut pages: Vec<PathBuf> = pages
        .filter(|page| page.extension().is_some_and(|is| is == "md"))
        .collect();
    pages.push(book().join("../../README.md"));
    pages
}

/// The number of commands that ran; none failed.
fn count(ran: Vec<Result<(), String>>) -> usize {
    let count = ran.len();
    let wrong: Vec<String> = ran.into_iter().filter_map(Result::err).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    count
}

#[test]
fn the_commands_of_pages_with_a_drive_run_as_printed() {
    let ran = BENCH.iter().flat_map(|page| {
        let bench = Bench::new("--usb");
        let folder = bench.folder.path();
        let config = std::fs::read_to_string(folder.join("velomotion.toml")).unwrap();
        let config = config.replace("soft", "bench");
        std::fs::write(folder.join("velomotion.toml"), config).unwrap();
        run_page(folder, page)
    });
    assert!(count(ran.collect()) > 12);
}

#[test]
#[ignore = "needs minutes: every analysis of the book"]
fn the_commands_of_all_other_pages_run_as_printed() {
    let ran = pages().into_iter().flat_map(|page| {
        let name = page.file_stem().unwrap().to_str().unwrap();
        if TUTORIALS.contains(&name) || BENCH.contains(&name) {
            return Vec::new();
        }
        let place = Place::new();
        let daemon = "device = \"sim\"\n[daemon]\nlisten = \"127.0.0.1:0\"\n";
        std::fs::write(place.path("velomotion.toml"), daemon).unwrap();
        for input in INPUTS.iter().filter(|(page, _)| *page == name) {
            input.1.iter().for_each(|input| make_input(&place, input));
        }
        run_page(place.0.path(), page.to_str().unwrap())
    });
    assert!(count(ran.collect()) > 40);
}

#[test]
fn the_first_scan_runs_as_printed() {
    let place = Place::new();
    // The checkout's first command, by the program under test.
    let captured = place.run("capture --speed 56.25");
    assert!(captured.status.success(), "{captured:?}");
    assert!(count(run_page(place.0.path(), "quick-start")) > 0);
    assert!(place.path("hall.laz").exists());
}

#[test]
fn the_choice_of_a_speed_runs_as_printed() {
    assert!(count(run_page(Place::new().0.path(), "which-speed")) > 0);
}

#[test]
#[ignore = "needs two minutes: 3 million shots"]
fn the_calibration_of_a_simulated_scanner_runs_as_printed() {
    let place = Place::new();
    assert!(count(run_page(place.0.path(), "calibrate-simulated")) > 0);
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

/// The commands of a page's tables with a column of commands.
fn commands_of_tables(page: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(page).unwrap();
    let mut lines = text.lines();
    let mut commands = Vec::new();
    while let Some(head) = lines.next() {
        let cells = |row: &str| -> Vec<String> {
            let row = row.trim_matches('|').split(" | ");
            row.map(|cell| cell.trim().to_owned()).collect()
        };
        let column = cells(head).iter().position(|cell| cell == "command");
        let Some(column) = column.filter(|_| head.starts_with('|')) else {
            continue;
        };
        for row in lines
            .by_ref()
            .skip(1)
            .take_while(|row| row.starts_with('|'))
        {
            let cell = &cells(row)[column];
            let command = cell
                .strip_prefix('`')
                .and_then(|cell| cell.strip_suffix('`'));
            commands.extend(command.map(str::to_owned));
        }
    }
    commands
}

#[test]
fn the_commands_of_tables_run_as_printed() {
    let mut ran = Vec::new();
    for page in pages() {
        let commands = commands_of_tables(&page);
        let name = page.file_stem().unwrap().to_str().unwrap();
        let place = Place::new();
        for input in INPUTS.iter().filter(|(page, _)| *page == name) {
            input.1.iter().for_each(|input| make_input(&place, input));
        }
        for (at, line) in commands.iter().enumerate() {
            // Two programs may read one file.
            if line.starts_with("velomotion replay") && !commands[..at].contains(line) {
                let (code, output) = run_line(place.0.path(), line);
                let failure = || format!("{name}: {line}: {code:?}\n{output}");
                ran.push((code == Some(0)).then_some(()).ok_or_else(failure));
            }
        }
    }
    assert!(count(ran) >= 4);
}

/// The page's requests, to a daemon of this test.
#[test]
fn the_requests_of_the_daemons_page_run_as_printed() {
    let folder = crate::daemon::rig::place();
    let daemon = crate::daemon::rig::Process::start(folder.path());
    crate::daemon::rig::ready(daemon.address);
    let lines: String = blocks_of(&book().join("daemon.md"))
        .iter()
        .map(shell_of)
        .collect();
    let mut id = String::new();
    let mut requests = 0;
    for line in lines.lines().filter(|line| line.starts_with("$ curl ")) {
        let address = format!("http://{}", daemon.address);
        let mut line = line[2..].replace("http://127.0.0.1:8016", &address);
        if let Some(at) = line.find("simulated-") {
            let end = at + line[at..].find('Z').unwrap() + 1;
            line.replace_range(at..end, &id);
        }
        // What it prints is read here.
        let line = line.split(" | ").next().unwrap();
        let (code, output) = run_line(folder.path(), line);
        assert_eq!(code, Some(0), "{line}\n{output}");
        if id.is_empty() {
            let scan: serde_json::Value = serde_json::from_str(&output).unwrap();
            scan["id"].as_str().unwrap().clone_into(&mut id);
            crate::daemon::rig::finished(daemon.address, &id);
        }
        requests += 1;
    }
    assert_eq!(requests, 3);
    let mut files = std::fs::read_dir(folder.path()).unwrap();
    let is_laz = |path: &Path| path.extension().is_some_and(|is| is == "laz");
    assert!(files.any(|file| is_laz(&file.unwrap().path())));
}

/// A command that no test runs has a reason.
#[test]
fn every_other_command_has_a_reason_not_to_run() {
    let mut used = std::collections::BTreeSet::new();
    let mut wrong = Vec::new();
    for page in pages() {
        let lines: String = blocks_of(&page).iter().map(shell_of).collect();
        let (mut of_loop, is_daemon) = (false, page.ends_with("daemon.md"));
        for line in lines.lines() {
            let line = line.strip_prefix("$ ").unwrap_or(line).trim();
            let runs = PROGRAMS.iter().any(|start| line.starts_with(start));
            // A request of the daemon's page, or words of a loop.
            let known = (is_daemon && line.starts_with("curl ")) || of_loop || line.is_empty();
            of_loop = (of_loop || line.starts_with("for ")) && !line.ends_with("done");
            if runs || known || line.starts_with('#') {
                continue;
            }
            match NOT_RUN.iter().find(|(start, _)| line.starts_with(start)) {
                Some((start, _)) => _ = used.insert(*start),
                None => wrong.push(format!("{}: {line}", page.display())),
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let unused = NOT_RUN.iter().filter(|(start, _)| !used.contains(start));
    assert_eq!(unused.count(), 0, "{used:?}");
}

/// Of all commands verbs, options and values exist, of those in prose verbs and options.
#[test]
fn every_command_of_the_book_is_understood() {
    use clap::error::ErrorKind;
    let (mut commands, mut wrong) = ([0, 0], Vec::new());
    for page in pages() {
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
