//! Captures with a drive that misbehaves: a fake EPOS2 on a pseudo-terminal, which shares no code
//! with the client or the simulator, and logs how its axis truly moves.
//!
//! `cargo test -p velomotion --test misbehaviours -- [ROW...] [--include-ignored] [--bless]`.
//! Without arguments each misbehaviour runs on one link, and times and distances allow for a busy
//! machine; with arguments they are judged as the table states them. `--include-ignored` runs each
//! on every link, and `--bless` writes the table of docs/src/misbehaviours.md.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a test program

mod drive;
mod faults;
mod homing;
mod judge;
mod lidar;
mod motion;
mod objects;
mod record;
mod rows;
mod rs232;
mod run;
mod servo;
mod slcan;
mod usb;
mod wire;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use faults::Misbehaviour;
use judge::Verdict;
use rows::ROWS;
use run::Transport;

/// Runs at a time: they mostly wait.
const THREADS: usize = 3;
/// Runs of a row whose drive was not scheduled in time.
const TRIES: usize = 6;
/// Seconds that a busy machine may hold up the client before its stop, where the test runs among
/// others: it still finds a stop that waits for a timeout.
const BUSY: f64 = 0.3;

fn main() {
    check_frames();
    let words: Vec<String> = std::env::args().skip(1).collect();
    let has = |word: &str| words.iter().any(|given| given == word);
    let is_bless = has("--bless");
    let only: Vec<&String> = named(&words);
    let all = is_bless || has("--include-ignored") || !only.is_empty();
    let plan = plan(all, &only);
    let allowed = if all { 0.0 } else { BUSY };
    let begin = Instant::now();
    let next = AtomicUsize::new(0);
    let verdicts: Mutex<Vec<(usize, Transport, Verdict)>> = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                while let Some(&(row, transport)) = plan.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let verdict = one(&ROWS[row], transport, allowed);
                    println!("{:5} {:52} {verdict}", transport.kind(), ROWS[row].name);
                    let mut verdicts = verdicts.lock().unwrap();
                    verdicts.push((row, transport, verdict));
                    if is_bless {
                        judge::bless(&verdicts);
                    }
                }
            });
        }
    });
    let verdicts = verdicts.into_inner().unwrap();
    println!(
        "{} runs in {:.0} s",
        verdicts.len(),
        begin.elapsed().as_secs_f64()
    );
    let failed = verdicts
        .iter()
        .filter(|(.., verdict)| !verdict.wrong.is_empty());
    let mut count = 0;
    for (row, transport, verdict) in failed {
        count += 1;
        let name = ROWS[*row].name;
        println!(
            "FAILED: {name} on {}: {}\n{}",
            transport.kind(),
            verdict.wrong.join("; "),
            verdict.printed
        );
    }
    let missing = judge::missing();
    if !missing.is_empty() {
        println!("FAILED: docs/src/misbehaviours.md lacks {missing:?}: --bless");
    }
    if count > 0 || !missing.is_empty() {
        std::process::exit(1);
    }
}

/// Names of rows among the arguments; `--skip` has one that is not meant.
fn named(words: &[String]) -> Vec<&String> {
    let before = [String::new()];
    let pairs = before.iter().chain(words).zip(words);
    let names = pairs.filter(|(before, word)| !word.starts_with('-') && *before != "--skip");
    names.map(|(_, word)| word).collect()
}

/// The runs: each row on one link, or on all.
fn plan(all: bool, only: &[&String]) -> Vec<(usize, Transport)> {
    let mut plan = Vec::new();
    for (number, row) in ROWS.iter().enumerate() {
        let is_named = |part: &&String| {
            let (name, link) = part.split_once('@').unwrap_or((part, ""));
            (row.name.contains(name), link.to_owned())
        };
        let named: Vec<String> = only
            .iter()
            .map(is_named)
            .filter(|n| n.0)
            .map(|n| n.1)
            .collect();
        if !only.is_empty() && named.is_empty() {
            continue;
        }
        for (place, transport) in Transport::ALL.into_iter().enumerate() {
            let is_possible = row.is_possible(transport);
            let is_turn = all || row.only_can || number % 3 == place;
            let is_wanted =
                named.is_empty() || named.iter().any(|link| transport.kind().contains(link));
            if is_possible && is_turn && is_wanted {
                plan.push((number, transport));
            }
        }
    }
    plan
}

/// Runs a row until its drive was not disturbed by the machine, or the row is fulfilled in spite of
/// it where a delay is allowed.
fn one(row: &'static Misbehaviour, transport: Transport, allowed: f64) -> Verdict {
    let mut verdict = Verdict::default();
    for _ in 0..TRIES {
        verdict = match run::run(row, transport) {
            Ok(outcome) => Verdict::of(row, transport, &outcome, allowed),
            Err(why) => Verdict::failed(why),
        };
        if !verdict.is_disturbed || allowed > 0.0 && verdict.wrong.is_empty() {
            return verdict;
        }
    }
    let why = format!("the machine was too busy in {TRIES} runs");
    verdict.wrong.push(why);
    verdict
}

/// The fake drive's frames against those of a real one.
fn check_frames() {
    let usb = |opcode, data: &[u8]| usb::frame(opcode, data, 0);
    let hex = |text: &str| -> Vec<u8> {
        text.split(' ')
            .map(|byte| u8::from_str_radix(byte, 16).unwrap())
            .collect()
    };
    assert_eq!(
        usb(0x10, &[0x41, 0x60, 0, 1]),
        hex("90 02 10 02 41 60 00 01 64 CF")
    );
    assert_eq!(
        usb(0, &[0, 0, 0, 0, 0x37, 2, 0, 0]),
        hex("90 02 00 04 00 00 00 00 37 02 00 00 68 00")
    );
    assert_eq!(
        usb(0, &[0, 0, 0, 0, 0, 0, 0x90, 0x80]),
        hex("90 02 00 04 00 00 00 00 00 00 90 90 80 14 35")
    );
    assert_eq!(
        rs232::body(0x10, &[0x41, 0x60, 0, 1], 0),
        hex("01 41 60 00 01 AB F0")
    );
    assert_eq!(
        rs232::body(0, &[0, 0, 0, 0, 0x37, 2, 0, 0], 0),
        hex("03 00 00 00 00 37 02 00 00 19 80")
    );
}
