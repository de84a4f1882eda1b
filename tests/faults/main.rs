//! What becomes of a scan when something goes wrong in mid-sweep: every fault in virtual time, the table of the docs made of it.
//!
//! For every fault: no hang, no panic, no lost scan, and the axis told to stop soon after the fault can be seen.
//! `VELOMOTION_BLESS=1` writes docs/src/faults.md anew; without, the test fails where the page is not what happens.

use std::fmt::Write;

use drive::DriveError;
use protocol::epos2::DeviceError;
use units::{DegPerS, DegPerS2, Span, Stamp};
use velomotion::session::SessionError;
use velomotion_tests::capture::{Captured, Setting};
use velomotion_tests::inject::Fault;

/// What must come of a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Must {
    /// The sweep is made to its end all the same.
    Survive,
    /// Either that, or the axis is told to stop within 0.2 s: how long the line is dead to the client depends on which bits were hurt.
    SurviveOrStop,
    /// The axis is told to stop within this time of the fault.
    StopWithin(Span),
    /// Nothing can be sent any more: that is said.
    SayThatItCannot,
}

const fn ms(ms: i64) -> Span {
    Span::from_millis(ms)
}

/// A fault that the drive or its answers show at once: the next look is at most 20 ms away, and 100 ms are allowed after it.
const SEEN: Must = Must::StopWithin(ms(120));
/// A held motor is seen when the demand is 2000 qc (3 degrees) ahead of it: 100 ms at 30 deg/s.
const FOLLOWING: Must = Must::StopWithin(ms(220));
/// Silence is seen when three questions in a row were left without an answer, 100 ms each.
const SILENCE: Must = Must::StopWithin(ms(430));

const FAULTS: [(&str, Fault, Must); 33] = [
    ("an answer lost", Fault::AnswersLost(ms(2)), Must::Survive),
    (
        "answers lost for 50 ms",
        Fault::AnswersLost(ms(50)),
        Must::SurviveOrStop,
    ),
    (
        "answers lost for ever",
        Fault::AnswersLost(Span::from_secs(1_000)),
        SILENCE,
    ),
    ("a request lost", Fault::RequestsLost(ms(2)), Must::Survive),
    (
        "requests lost for 50 ms",
        Fault::RequestsLost(ms(50)),
        Must::SurviveOrStop,
    ),
    (
        "requests lost for ever",
        Fault::RequestsLost(Span::from_secs(1_000)),
        SILENCE,
    ),
    (
        "an answer 30 ms late",
        Fault::AnswersLate(ms(2), ms(30)),
        Must::Survive,
    ),
    (
        "an answer 150 ms late",
        Fault::AnswersLate(ms(2), ms(150)),
        Must::Survive,
    ),
    (
        "every answer 30 ms late",
        Fault::AnswersLate(Span::from_secs(1_000), ms(30)),
        Must::Survive,
    ),
    (
        "a wrong CRC in an answer",
        Fault::AnswersFlipped(ms(2)),
        Must::Survive,
    ),
    (
        "wrong CRCs in answers for 50 ms",
        Fault::AnswersFlipped(ms(50)),
        Must::SurviveOrStop,
    ),
    (
        "wrong CRCs in answers for ever",
        Fault::AnswersFlipped(Span::from_secs(1_000)),
        SILENCE,
    ),
    (
        "a wrong CRC in a request",
        Fault::RequestsFlipped(ms(2)),
        Must::Survive,
    ),
    (
        "wrong CRCs in requests for 50 ms",
        Fault::RequestsFlipped(ms(50)),
        Must::SurviveOrStop,
    ),
    ("an answer cut off", Fault::AnswersCut(ms(2)), Must::Survive),
    (
        "answers cut off for 50 ms",
        Fault::AnswersCut(ms(50)),
        Must::SurviveOrStop,
    ),
    (
        "answers doubled",
        Fault::AnswersDoubled(Span::from_secs(1_000)),
        Must::Survive,
    ),
    (
        "an old answer instead of the new",
        Fault::AnswersStale(ms(2)),
        Must::Survive,
    ),
    (
        "answers a byte at a time",
        Fault::AnswersInBytes(Span::from_secs(1_000)),
        Must::Survive,
    ),
    (
        "noise before every answer",
        Fault::Noise(Span::from_secs(1_000)),
        Must::Survive,
    ),
    (
        "noise with frame starts for 20 ms",
        Fault::NoiseWithFrameStarts(ms(20)),
        Must::Survive,
    ),
    ("unplugged", Fault::Unplugged, Must::SayThatItCannot),
    (
        "the port takes no bytes",
        Fault::WriteBlocked,
        Must::SayThatItCannot,
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

/// A sweep of 1.5 s in the middle of which things go wrong.
fn setting() -> Setting {
    let mut setting = Setting::default();
    setting.wish.speed = DegPerS(30.0);
    setting.wish.acceleration = DegPerS2(500.0);
    setting
}

/// One row: what was tried and what came of it.
struct Row {
    fault: &'static str,
    outcome: String,
    stop: Option<Span>,
    swept_deg: f64,
    worst_mm: f64,
    doubted: bool,
}

/// However the polls were hurt, no point of the cloud may be farther than this from the truth without a warning.
const WORST_MM: f64 = 20.0;

fn try_out(name: &'static str, fault: Fault, must: Must, at: Span) -> Row {
    let begin = setting().start + at;
    let (captured, ended) = Captured::run(Setting {
        fault: Some((fault, at)),
        ..setting()
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
    let [sweep] = scan.sweeps[..] else {
        panic!("{name}: {:?}", scan.sweeps);
    };
    assert!(cloud.len() > 10_000, "{name}: {} points", cloud.len());
    let worst_mm = captured.error().worst_m * 1e3;
    let doubted = scan
        .contents
        .warnings
        .iter()
        .any(|w| w.contains("angles may be off"));
    assert!(
        worst_mm < WORST_MM || doubted,
        "{name}: worst point {worst_mm} mm off, and no word of it"
    );
    let stop = captured.stop_sent(begin).map(|at| at - begin);
    match must {
        Must::Survive => assert!(ended.is_ok(), "{name}: {ended:?}"),
        Must::SurviveOrStop => {
            let limit = ms(200);
            let stopped = matches!(ended, Err(SessionError::Drive(_))) && stop <= Some(limit);
            assert!(
                ended.is_ok() || stopped,
                "{name}: {ended:?}, stop after {stop:?}"
            );
        }
        Must::StopWithin(limit) => {
            assert!(
                matches!(ended, Err(SessionError::Drive(_))),
                "{name}: {ended:?}"
            );
            let stop = stop.unwrap_or_else(|| panic!("{name}: nobody told the axis to stop"));
            assert!(
                stop <= limit,
                "{name}: stop after {} ms",
                stop.as_secs_f64() * 1e3
            );
        }
        Must::SayThatItCannot => {
            assert!(
                matches!(ended, Err(SessionError::Port(_))),
                "{name}: {ended:?}"
            );
        }
    }
    let failed = ended.is_err();
    Row {
        fault: name,
        outcome: match ended {
            Ok(()) => "goes on".to_owned(),
            Err(error) => error.to_string(),
        },
        stop: stop.filter(|_| failed),
        swept_deg: (sweep.to_deg - sweep.from_deg).abs(),
        worst_mm,
        doubted,
    }
}

#[test]
fn no_fault_hangs_panics_or_loses_the_scan() {
    let usual = Captured::new(setting());
    let start = usual.sweep_span().0;
    let at = start - setting().start + ms(700);
    let rows: Vec<Row> = FAULTS
        .into_iter()
        .map(|(name, fault, must)| try_out(name, fault, must, at))
        .collect();
    let page = page(&rows);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/src/faults.md");
    if std::env::var_os("VELOMOTION_BLESS").is_some() {
        std::fs::write(path, &page).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    assert!(
        written == page,
        "docs/src/faults.md is not what happens now; VELOMOTION_BLESS=1 writes it anew:\n{page}"
    );
}

/// Other seconds of the same motion: the ramps, the homing, the way to the start.
#[test]
fn no_fault_at_any_moment_hangs_or_leaves_the_axis_on_its_own() {
    for (number, (name, fault, _)) in FAULTS.into_iter().enumerate() {
        for k in 0..3 {
            let after = ms(150 + 937 * k + 29 * i64::try_from(number).unwrap());
            let (captured, ended) = Captured::run(Setting {
                fault: Some((fault, after)),
                ..setting()
            });
            let end = captured.truth().end();
            let took = end - setting().start;
            assert!(took < Span::from_secs(90), "{name} after {after:?}: hangs");
            let said = matches!(
                ended,
                Err(SessionError::Port(_)
                    | SessionError::NotStopped(_)
                    | SessionError::Drive(DriveError::NotStopped { .. }))
            );
            if !said {
                let angle = |t: Stamp<units::Host>| captured.truth().tilt_deg_at(t);
                let last = end - ms(1);
                assert_eq!(
                    angle(last),
                    angle(last - ms(10)),
                    "{name} after {after:?}: still moves"
                );
            }
        }
    }
}

/// In steps, so that the last bit of a sine does not change the page.
fn below(worst_mm: f64) -> String {
    match [5.0, 10.0, 20.0]
        .into_iter()
        .find(|limit| worst_mm < *limit)
    {
        Some(limit) => format!("under {limit} mm off"),
        None => "farther off".to_owned(),
    }
}

fn page(rows: &[Row]) -> String {
    let mut page = String::from(
        "# Faults\n\n\
         What becomes of a sweep when something goes wrong 0.7 s into it: 45 degrees at 30 deg/s with ramps of 500 deg/s2, over USB. In every case the\n\
         log and the cloud of what was swept are saved. The stop is the quick stop sent by the client, counted from the beginning of the fault. *Warned*: the report\n\
         says that angles may be off, and by how much.\n\n\
         | fault | what happens | stop sent after | swept | worst point |\n|---|---|---|---|---|\n",
    );
    for row in rows {
        let stop = row.stop.map_or("-".to_owned(), |stop| {
            format!("{:.0} ms", stop.as_secs_f64() * 1e3)
        });
        writeln!(
            page,
            "| {} | {} | {stop} | {:.1} deg | {}{} |",
            row.fault,
            row.outcome,
            row.swept_deg,
            below(row.worst_mm),
            if row.doubted { ", warned" } else { "" }
        )
        .unwrap();
    }
    page.push_str(
        "\nMade by `VELOMOTION_BLESS=1 cargo test -p velomotion-tests --test faults`, in virtual time; the test fails where the page is not what happens.\n",
    );
    page
}
