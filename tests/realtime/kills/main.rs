//! The program dies or hangs at any moment of a motion, on each transport: within a second the axis
//! is at rest, its power off and its brake set, or held where the configuration says so.
//!
//! `cargo test -p velomotion --test kills -- [--kills N] [--first SEED] [--transport NAME]
//! [--bless]`. Without arguments every signal meets every kind of motion, and five kills random
//! moments. With `--kills` only kills at random moments are made; `--bless` writes the table of
//! docs/src/kills.md.
#![allow(clippy::unwrap_used, clippy::panic, clippy::expect_used)] // a test

mod bench;
mod cases;
mod special;
mod table;

use std::sync::Mutex;
use std::time::Duration;

use bench::Bench;
use cases::{Case, Moment, Motion, NOT_HELD, SIGNALS, Signal};
use table::Table;

/// Transports; the last, a CAN interface of the kernel, only where it is chosen.
const TRANSPORTS: [&str; 4] = ["usb", "rs232", "slcan", "can"];
/// An axis with a brake.
pub const BRAKE: &str = "brake_output = 1";
/// An axis that the drive holds.
pub const HOLD: &str = "without_brake = 'hold'";
/// Runs of a signal during which the machine delays the drive by so much.
const TRIES: usize = 3;
const DELAY: Duration = Duration::from_millis(5);
/// Kills at random moments without arguments.
const FEW: u64 = 5;

struct Arguments {
    first: u64,
    kills: Option<u64>,
    transport: Option<String>,
    guardian_only: bool,
    bless: bool,
}

/// Results of the run.
#[derive(Default)]
struct Results {
    table: Mutex<Table>,
    failed: Mutex<Vec<String>>,
}

impl Results {
    fn check(&self, what: &str, result: Result<(), String>) {
        if let Err(why) = result {
            eprintln!("{what}: {why}");
            self.failed.lock().unwrap().push(format!("{what}: {why}"));
        }
    }
}

fn main() {
    let arguments = arguments();
    let results = Results::default();
    let chosen = |name: &&str| match &arguments.transport {
        Some(only) => only == name,
        None => *name != "can",
    };
    std::thread::scope(|scope| {
        let all = TRANSPORTS.into_iter().filter(|_| !arguments.guardian_only);
        for transport in all.filter(chosen) {
            let (arguments, results) = (&arguments, &results);
            scope.spawn(move || on_transport(transport, arguments, results));
        }
    });
    if arguments.kills.is_none() {
        results.check("service", special::service_spares_the_guardian());
        for transport in ["usb", "rs232"].into_iter().filter(chosen) {
            guardian(transport, &results);
        }
    }
    let table = results.table.into_inner().unwrap();
    println!("{table}");
    if arguments.bless {
        table.bless();
    }
    let failed = results.failed.into_inner().unwrap();
    for why in &failed {
        println!("FAILED: {why}");
    }
    if !failed.is_empty() {
        std::process::exit(1);
    }
}

fn on_transport(transport: &'static str, arguments: &Arguments, results: &Results) {
    if arguments.kills.is_none() {
        every_signal(transport, results);
    }
    let bench = Bench::start(transport, BRAKE);
    results.check(transport, bench.run("tilt home"));
    let kills = arguments.kills.unwrap_or(FEW);
    for seed in arguments.first..arguments.first + kills {
        let case = Case::random(seed);
        let what = format!(
            "{transport}: kill in {:?}, again: --test kills -- --transport {transport} --first {seed} --kills 1",
            case.motion
        );
        let result = case.run(&bench);
        let mut table = results.table.lock().unwrap();
        table.count(transport, result.as_ref());
        drop(table);
        results.check(&what, result.map(drop));
    }
}

/// Every signal meets every kind of motion, of an axis with a brake and of one that is held.
fn every_signal(transport: &str, results: &Results) {
    let check = |motion, signal: Signal, bench: &Bench, held| {
        let case = Case {
            motion,
            signal,
            moment: Moment::Moving,
            held,
        };
        let axis = if held { "a held axis" } else { "an axis" };
        let what = format!("{transport}: {} in {motion:?} of {axis}", signal.0);
        let mut result = case.run(bench);
        // A drive that is late obeys late, and a stop that does not show is followed by power off.
        let is_late = |result: &Result<_, String>| {
            let not_held = result.as_ref().is_err_and(|why| why.starts_with(NOT_HELD));
            not_held && bench.longest_delay() >= DELAY
        };
        for _ in 1..TRIES {
            if !is_late(&result) {
                break;
            }
            println!("{what}: again, the machine delayed the drive");
            result = case.run(bench);
        }
        results.check(&what, result.map(drop));
    };
    let braked = Bench::start(transport, BRAKE);
    results.check(transport, braked.run("tilt home"));
    for signal in SIGNALS {
        for motion in Motion::ALL {
            check(motion, signal, &braked, false);
        }
    }
    // Two drives on one bus would both answer.
    drop(braked);
    let held = Bench::start(transport, HOLD);
    results.check(transport, held.run("tilt home"));
    for signal in SIGNALS {
        for motion in Motion::ALL {
            check(motion, signal, &held, true);
        }
    }
}

/// The guardian itself, one transport after the other.
fn guardian(transport: &str, results: &Results) {
    let bench = Bench::start(transport, BRAKE);
    results.check(transport, bench.run("tilt home"));
    type Check = fn(&Bench) -> Result<(), String>;
    let checks: [(&str, Check); 4] = [
        ("the guardian is killed", special::guardian_killed),
        (
            "program and guardian are signalled together",
            special::signalled_together,
        ),
        (
            "the port is busy while the guardian acts",
            special::next_command_waits,
        ),
        ("a loaded machine", special::no_false_alarm),
    ];
    for (what, check) in checks {
        results.check(&format!("{transport}: {what}"), check(&bench));
    }
}

fn arguments() -> Arguments {
    let mut arguments = Arguments {
        first: 0,
        kills: None,
        transport: None,
        guardian_only: false,
        bless: false,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().expect("the option needs a value");
        match word.as_str() {
            "--first" => arguments.first = value().parse().expect("--first SEED"),
            "--kills" => arguments.kills = value().parse().ok(),
            "--transport" => arguments.transport = Some(value()),
            "--guardian" => arguments.guardian_only = true,
            "--bless" => arguments.bless = true,
            // Other arguments of `cargo test`.
            _ => {}
        }
    }
    arguments
}
