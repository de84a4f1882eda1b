//! Faults during a sweep over every attachment of the drive, in virtual time, and the tables of the
//! documentation.
//!
//! After every fault there is no hang, no panic and no lost scan, and the axis is stopped soon
//! after the fault is detectable. `VELOMOTION_BLESS=1` writes docs/src/faults.md; without it the
//! test fails if the page differs.

use std::fmt::Write;

use drive::DriveError;
use engine::devices::drive_session::SessionError;
use protocol::epos2::DeviceError;
use sim::Attachment;
use units::{DegPerS, DegPerS2, Span, Stamp};
use velomotion_tests::capture::{Captured, Setting};
use velomotion_tests::inject::Fault;

/// The required outcome of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Requirement {
    /// The sweep ends as planned.
    Survive,
    /// Either that, or the axis is stopped within 0.2 s: the damaged bits decide how long the
    /// client takes the line for dead.
    SurviveOrStop,
    /// The axis is stopped within this time of the fault.
    StopWithin(Span),
    /// Nothing can be sent, and the report states it.
    SayThatItCannot,
    /// The line is unusable; the report states it, and everything before is saved.
    End,
}

const fn ms(ms: i64) -> Span {
    Span::from_millis(ms)
}

/// A fault that the drive or its answers show at once: the next poll is at most 20 ms later, plus
/// 100 ms.
const SEEN: Requirement = Requirement::StopWithin(ms(120));
/// A blocked motor is detected when its position is 2000 qc (3 deg) behind the demand: 100 ms at 30
/// deg/s.
const FOLLOWING: Requirement = Requirement::StopWithin(ms(220));
/// A second of silence, to the end of the probe under way; on RS232 that takes 500 ms more.
const SILENCE: Requirement = Requirement::StopWithin(ms(1_560));

const FAULTS: [(&str, Fault, Requirement); 35] = [
    (
        "an answer lost",
        Fault::AnswersLost(ms(2)),
        Requirement::Survive,
    ),
    (
        "answers lost for 50 ms",
        Fault::AnswersLost(ms(50)),
        Requirement::SurviveOrStop,
    ),
    (
        "answers lost for ever",
        Fault::AnswersLost(Span::from_secs(1_000)),
        SILENCE,
    ),
    (
        "a request lost",
        Fault::RequestsLost(ms(2)),
        Requirement::Survive,
    ),
    (
        "requests lost for 50 ms",
        Fault::RequestsLost(ms(50)),
        Requirement::SurviveOrStop,
    ),
    (
        "requests lost for ever",
        Fault::RequestsLost(Span::from_secs(1_000)),
        SILENCE,
    ),
    (
        "an answer 30 ms late",
        Fault::AnswersLate(ms(2), ms(30)),
        Requirement::Survive,
    ),
    (
        "an answer 150 ms late",
        Fault::AnswersLate(ms(2), ms(150)),
        Requirement::Survive,
    ),
    (
        "every answer 30 ms late",
        Fault::AnswersLate(Span::from_secs(1_000), ms(30)),
        Requirement::Survive,
    ),
    (
        "a read held for 150 ms",
        Fault::ReadHeld(ms(150), Span::ZERO),
        Requirement::Survive,
    ),
    (
        "a read held for 1.3 s",
        Fault::ReadHeld(ms(1_300), Span::ZERO),
        Requirement::Survive,
    ),
    (
        "a wrong CRC in an answer",
        Fault::AnswersFlipped(ms(2)),
        Requirement::Survive,
    ),
    (
        "wrong CRCs in answers for 50 ms",
        Fault::AnswersFlipped(ms(50)),
        Requirement::SurviveOrStop,
    ),
    (
        "wrong CRCs in answers for ever",
        Fault::AnswersFlipped(Span::from_secs(1_000)),
        SILENCE,
    ),
    (
        "a wrong CRC in a request",
        Fault::RequestsFlipped(ms(2)),
        Requirement::Survive,
    ),
    (
        "wrong CRCs in requests for 50 ms",
        Fault::RequestsFlipped(ms(50)),
        Requirement::SurviveOrStop,
    ),
    (
        "an answer cut off",
        Fault::AnswersCut(ms(2)),
        Requirement::Survive,
    ),
    (
        "answers cut off for 50 ms",
        Fault::AnswersCut(ms(50)),
        Requirement::SurviveOrStop,
    ),
    (
        "answers doubled",
        Fault::AnswersDoubled(Span::from_secs(1_000)),
        Requirement::Survive,
    ),
    (
        "an old answer instead of the new",
        Fault::AnswersStale(ms(2)),
        Requirement::Survive,
    ),
    (
        "answers a byte at a time",
        Fault::AnswersInBytes(Span::from_secs(1_000)),
        Requirement::Survive,
    ),
    (
        "noise before every answer",
        Fault::Noise(Span::from_secs(1_000)),
        Requirement::Survive,
    ),
    (
        "noise with frame starts for 20 ms",
        Fault::NoiseWithFrameStarts(ms(20)),
        Requirement::Survive,
    ),
    ("unplugged", Fault::Unplugged, Requirement::SayThatItCannot),
    (
        "the port takes no bytes",
        Fault::WriteBlocked,
        Requirement::SayThatItCannot,
    ),
    (
        "the drive's supply fails for a moment",
        Fault::PowerCycle,
        SEEN,
    ),
    ("motor blocked", Fault::Blocked, FOLLOWING),
    ("overcurrent", Fault::Device(DeviceError::OVERCURRENT), SEEN),
    ("overvoltage", Fault::Device(DeviceError::OVERVOLTAGE), SEEN),
    (
        "undervoltage",
        Fault::Device(DeviceError::UNDERVOLTAGE),
        SEEN,
    ),
    (
        "power stage too hot",
        Fault::Device(DeviceError::TEMPERATURE),
        SEEN,
    ),
    (
        "position sensor error",
        Fault::Device(DeviceError::POSITION_SENSOR),
        SEEN,
    ),
    (
        "following error",
        Fault::Device(DeviceError::FOLLOWING),
        SEEN,
    ),
    (
        "negative limit switch",
        Fault::Device(DeviceError::NEGATIVE_LIMIT),
        SEEN,
    ),
    ("CAN overrun", Fault::Device(DeviceError::CAN_OVERRUN), SEEN),
];

const WAYS: [(Attachment, &str); 4] = [
    (Attachment::Usb, "USB"),
    (Attachment::Rs232, "RS232"),
    (Attachment::Slcan, "SLCAN"),
    (Attachment::Can, "SocketCAN"),
];

/// The required outcome, weaker for attachments that cannot do better.
fn must(attached: Attachment, fault: Fault, must: Requirement) -> Requirement {
    match (attached, fault) {
        // The RS232 exchange has no frame starts: permanently duplicated or inserted bytes look
        // like part of it.
        (Attachment::Rs232, Fault::AnswersDoubled(_) | Fault::Noise(_)) => Requirement::End,
        // Late frames delay those behind them: meanwhile neither positions nor heartbeats arrive.
        (Attachment::Slcan | Attachment::Can, Fault::AnswersLate(_, late)) if late > ms(100) => {
            Requirement::SurviveOrStop
        }
        // The drive watches its master's heartbeats, and stops the axis itself.
        (Attachment::Slcan | Attachment::Can, Fault::ReadHeld(span, _)) if span > ms(500) => {
            Requirement::StopWithin(span + ms(100))
        }
        _ => must,
    }
}

/// A sweep of 1.5 s with a fault in its middle.
fn setting(attached: Attachment) -> Setting {
    let mut setting = Setting::over(attached);
    setting.sweep_request.speed = DegPerS(30.0);
    setting.sweep_request.acceleration = DegPerS2(500.0);
    setting
}

/// Outcome of a fault over one attachment.
struct Cell {
    /// The error message, if the sweep did not end as planned.
    printed: Option<String>,
    stop: Option<Span>,
    worst_mm: f64,
    is_warned: bool,
}

/// Greatest error of a point without a warning, however the polls were damaged.
const WORST_MM: f64 = 20.0;

fn run_fault(
    attached: Attachment,
    name: &str,
    fault: Fault,
    expected: Requirement,
    at: Span,
) -> Cell {
    let name = format!("{name} over {attached:?}");
    let begin = setting(attached).start + at;
    let (captured, ended) = Captured::run(Setting {
        fault: Some((fault, at)),
        ..setting(attached)
    });
    let truth = captured.truth();
    let took = truth.end() - begin;
    assert!(
        took < Span::from_secs(12),
        "{name}: hangs for {} s",
        took.as_secs_f64()
    );
    let (scan, cloud) = captured
        .try_scan()
        .unwrap_or_else(|failure| panic!("{name}: the scan is lost: {failure}"));
    let [_] = scan.sweeps[..] else {
        panic!("{name}: {:?}", scan.sweeps);
    };
    assert!(cloud.len() > 10_000, "{name}: {} points", cloud.len());
    let worst_mm = captured.error().worst_m * 1e3;
    let is_warned = scan
        .contents
        .warnings
        .iter()
        .any(|w| w.contains("angle error may reach"));
    assert!(
        worst_mm < WORST_MM || is_warned,
        "{name}: worst point {worst_mm} mm off without a warning"
    );
    let stop = captured.stop_sent(begin).map(|at| at - begin);
    match must(attached, fault, expected) {
        Requirement::Survive => assert!(ended.is_ok(), "{name}: {ended:?}"),
        Requirement::SurviveOrStop => {
            let limit = ms(200);
            let stopped = matches!(ended, Err(SessionError::Drive(_))) && stop <= Some(limit);
            assert!(
                ended.is_ok() || stopped,
                "{name}: {ended:?}, stop after {stop:?}"
            );
        }
        Requirement::StopWithin(limit) => {
            assert!(
                matches!(ended, Err(SessionError::Drive(_))),
                "{name}: {ended:?}"
            );
            if is_received(fault) {
                assert!(is_at_rest(&captured), "{name}: the axis still moves");
            }
            let stop = stop.unwrap_or_else(|| panic!("{name}: no report that the axis stopped"));
            assert!(
                stop <= limit,
                "{name}: stop after {} ms",
                stop.as_secs_f64() * 1e3
            );
        }
        Requirement::SayThatItCannot => {
            assert!(
                matches!(ended, Err(SessionError::Port(_))),
                "{name}: {ended:?}"
            );
        }
        Requirement::End => assert!(ended.is_err(), "{name}: {ended:?}"),
    }
    let failed = ended.is_err();
    Cell {
        printed: ended.err().map(|error| error.to_string()),
        stop: stop.filter(|_| failed),
        worst_mm,
        is_warned,
    }
}

/// Whether the drive receives commands, even if its answers are lost.
fn is_received(fault: Fault) -> bool {
    !matches!(fault, Fault::RequestsLost(_) | Fault::RequestsFlipped(_))
}

/// Whether the axis rests. After a second of silence it has completed its sweep.
fn is_at_rest(captured: &Captured) -> bool {
    let last = captured.truth().end() - ms(1);
    let angle = |at| captured.truth().tilt_deg_at(at).unwrap();
    angle(last) == angle(last - ms(10))
}

/// Every fault over one attachment, 0.7 s into the sweep.
fn column(attached: Attachment) -> Vec<Cell> {
    let usual = Captured::new(setting(attached));
    let at = usual.sweep_span().0 - setting(attached).start + ms(700);
    let cell = |(name, fault, must)| run_fault(attached, name, fault, must, at);
    FAULTS.into_iter().map(cell).collect()
}

#[test]
fn no_fault_hangs_panics_or_loses_the_scan() {
    let columns: Vec<Vec<Cell>> = std::thread::scope(|scope| {
        let threads = WAYS.map(|(attached, _)| scope.spawn(move || column(attached)));
        threads.map(|thread| thread.join().unwrap()).into()
    });
    let page = page(&columns);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/faults.md");
    if std::env::var_os("VELOMOTION_BLESS").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        written == page,
        "docs/src/faults.md differs from the result; VELOMOTION_BLESS=1 rewrites it:\n{page}"
    );
}

/// Other phases of the motion: ramps, homing, the move to the start.
#[test]
fn no_fault_at_any_moment_hangs_or_leaves_the_axis_uncontrolled() {
    std::thread::scope(|scope| {
        for first in 0..WAYS.len() {
            scope.spawn(move || {
                for (number, (name, fault, _)) in FAULTS.into_iter().enumerate() {
                    // Each fault at four moments, each over another attachment.
                    let (attached, _) = WAYS[(first + number) % WAYS.len()];
                    let step = 937 * i64::try_from(first).unwrap();
                    let after = ms(150 + step + 29 * i64::try_from(number).unwrap());
                    assert_left_at_rest(attached, name, fault, after);
                }
            });
        }
    });
}

/// Silence before the end of a sweep stops it, unless the program itself was delayed: then the
/// machine may delay the answers too, and the sweep goes on.
#[test]
fn a_delayed_program_waits_for_answers_at_the_end_of_a_sweep() {
    for attached in [Attachment::Usb, Attachment::Can] {
        let usual = Captured::new(setting(attached));
        let at = usual.sweep_span().1 - setting(attached).start - ms(150);
        let ended = |fault| {
            let (_, ended) = Captured::run(Setting {
                fault: Some((fault, at)),
                ..setting(attached)
            });
            ended
        };
        let silent = ended(Fault::AnswersLost(ms(730)));
        assert!(silent.is_err(), "{attached:?}: {silent:?}");
        let delayed = ended(Fault::ReadHeld(ms(40), ms(660)));
        assert!(delayed.is_ok(), "{attached:?}: {delayed:?}");
    }
}

/// Checks that the axis rests after the fault, or that the report warns that it may move.
fn assert_left_at_rest(attached: Attachment, name: &str, fault: Fault, after: Span) {
    let (captured, ended) = Captured::run(Setting {
        fault: Some((fault, after)),
        ..setting(attached)
    });
    let name = format!("{name} over {attached:?} after {after:?}");
    let end = captured.truth().end();
    let took = end - setting(attached).start;
    assert!(took < Span::from_secs(90), "{name}: hangs");
    let printed = matches!(
        ended,
        Err(SessionError::Port(_)
            | SessionError::NotStopped(_)
            | SessionError::Drive(DriveError::NotStopped { .. }))
    );
    if !printed {
        let angle = |t: Stamp<units::Host>| captured.truth().tilt_deg_at(t);
        let last = end - ms(1);
        assert_eq!(
            angle(last),
            angle(last - ms(10)),
            "{name}: the axis still moves, {ended:?}"
        );
    }
}

/// Rounds to steps, so that the last bit of a sine does not change the page.
fn below(worst_mm: f64) -> String {
    match [5.0, 10.0, 20.0]
        .into_iter()
        .find(|limit| worst_mm < *limit)
    {
        Some(limit) => format!("under {limit} mm off"),
        None => "farther off".to_owned(),
    }
}

fn cell(cell: &Cell) -> String {
    let what = match (&cell.printed, cell.stop) {
        (None, _) => "goes on".to_owned(),
        (Some(_), Some(stop)) => format!("stop after {:.0} ms", stop.as_secs_f64() * 1e3),
        (Some(_), None) => "says it cannot stop".to_owned(),
    };
    let warned = if cell.is_warned { ", warned" } else { "" };
    format!("{what}; {}{warned}", below(cell.worst_mm))
}

fn page(columns: &[Vec<Cell>]) -> String {
    let mut page = String::from(
        "# Faults\n\n\
         Faults that occur 0.7 s into a sweep of 45 degrees at 30 deg/s with ramps of 500 deg/s2, on each link to the drive. In every\n\
         case the log and the cloud of the part already swept are saved. *Stop* is the time from the fault to the client's quick stop;\n\
         then follows the worst point error of the cloud against the simulated truth. *Warned*: the report warns of uncertain angles\n\
         and gives a bound.\n\n\
         A CAN controller discards damaged frames and repeats them: what corrupts a serial line only delays CAN.\n\n",
    );
    page.push_str("| fault |");
    for (_, name) in WAYS {
        write!(page, " {name} |").unwrap();
    }
    page.push_str("\n|---|---|---|---|---|\n");
    for (row, (name, _, _)) in FAULTS.iter().enumerate() {
        write!(page, "| {name} |").unwrap();
        for column in columns {
            write!(page, " {} |", cell(&column[row])).unwrap();
        }
        page.push('\n');
    }
    page.push_str("\n## Messages\n\n| fault | over | message |\n|---|---|---|\n");
    for (row, (name, _, _)) in FAULTS.iter().enumerate() {
        for (message, over) in messages(columns, row) {
            writeln!(page, "| {name} | {} | {message} |", over.join(", ")).unwrap();
        }
    }
    page.push_str(
        "\nMade by `VELOMOTION_BLESS=1 cargo test -p velomotion-tests --test virtual faults`, in virtual time.\nThe test fails if the page differs from the result.\n",
    );
    page
}

/// Messages of a fault, each with the links that report it.
fn messages(columns: &[Vec<Cell>], row: usize) -> Vec<(&str, Vec<&'static str>)> {
    let mut messages: Vec<(&str, Vec<&'static str>)> = Vec::new();
    for (column, (_, way)) in columns.iter().zip(WAYS) {
        let Some(printed) = column[row].printed.as_deref() else {
            continue;
        };
        match messages.iter_mut().find(|(message, _)| *message == printed) {
            Some((_, over)) => over.push(way),
            None => messages.push((printed, vec![way])),
        }
    }
    messages
}
