//! What a run must show, and the table of all runs.

use std::fmt;

use crate::faults::{Expect, Misbehaviour};
use crate::rows::ROWS;
use crate::run::{Kept, MAX_GAP, Outcome, Transport};

/// Markers around the table in the page.
const MARKS: (&str, &str) = ("<!-- table -->\n", "<!-- end of the table -->");
/// Seconds without a request that show a machine too busy for the client.
const MAX_SILENCE: f64 = 0.02;
/// The same, of client or drive, where a brake stops the axis, for one pause and for all together:
/// [`BRAKED`] spares 3 ms of a sweep, and a quiet machine's pauses are of 2 ms.
const MAX_PAUSE_BRAKED: f64 = 0.004;
/// Milliseconds from the sample that shows it to the first stop; and where nothing shows it.
const STOP_MS: f64 = 50.0;
/// A move goes on through silence until its planned end, for a second at most; on RS232 the unit's
/// frame timeout comes in addition.
const SILENT_MS: f64 = 1_600.0;
/// Degrees beyond the limits in addition to a quick stop by 500 deg/s2.
const BEYOND: f64 = 0.1;
/// The same where a quick stop is ignored and the brake stops the axis.
const BRAKED: f64 = 0.5;
/// The same over RS232, where a sample takes 2.7 ms instead of 1.0 to 1.4 ms.
const BRAKED_RS232: f64 = 1.0;
/// The same where the first power off is lost, too.
const BRAKED_LATE: f64 = 2.0;
/// The same where the axis moves at 112 deg/s to a limit switch, which is read every 80 ms.
const UNSEEN: f64 = 1.0 + 0.09 * 112.5;
/// Degrees of homing without a switch: its bound, and a stop.
const HOMING: f64 = 45.0 + 1.0 + 10.0 + 1.0;

/// What a run showed.
#[derive(Default)]
pub struct Verdict {
    travel: f64,
    beyond: f64,
    /// Degrees of a quick stop from the highest speed of the axis.
    ramp: f64,
    is_rs232: bool,
    /// Milliseconds, and degrees at that speed, that a busy machine may add.
    delayed: (f64, f64),
    stop_ms: Option<f64>,
    moving: bool,
    powered: bool,
    braked: bool,
    exit: Option<i32>,
    kept: Option<Kept>,
    /// What must not be.
    pub wrong: Vec<String>,
    /// What the client printed.
    pub printed: String,
    /// The machine delayed the drive.
    pub is_disturbed: bool,
}

impl Verdict {
    /// A run that could not be judged.
    pub fn failed(why: String) -> Self {
        Self {
            wrong: vec![why],
            ..Self::default()
        }
    }

    /// Judges a run, in which the machine may hold up the client for `allowed` seconds.
    pub fn of(row: &Misbehaviour, transport: Transport, outcome: &Outcome, allowed: f64) -> Self {
        let drive = &outcome.drive;
        let began = drive.record.began.unwrap_or(f64::INFINITY);
        let last = drive.record.truth.last().map_or(0.0, |truth| truth.at);
        // A client asks for a sample every few milliseconds. One that never does fails every try.
        let is_shown = matches!(
            row.expect,
            Expect::Stopped
                | Expect::Unseen
                | Expect::Braked
                | Expect::BrakedLate
                | Expect::HomingStopped
        );
        let is_held_up = is_shown && !row.name.contains("output unread");
        let speed = drive.record.highest_speed().max(56.25);
        // An undisturbed run is judged as the table states it.
        let is_delayed = match row.expect {
            Expect::Braked | Expect::BrakedLate => {
                let longest = outcome.gap.max(outcome.silence);
                longest.max(outcome.held_up) > MAX_PAUSE_BRAKED
            }
            _ => outcome.gap > MAX_GAP || outcome.silence > MAX_SILENCE,
        };
        let allowed = if is_delayed { allowed } else { 0.0 };
        let mut verdict = Self {
            travel: drive.record.travel(began),
            beyond: drive.record.beyond(0.0),
            ramp: speed.powi(2) / 500.0 / 2.0,
            is_rs232: transport == Transport::Rs232,
            delayed: (allowed * 1e3, allowed * speed),
            stop_ms: outcome.stop_ms(),
            moving: drive.record.travel(last - 0.1) > 0.03,
            powered: drive.axis.powered,
            braked: drive.axis.braked,
            exit: outcome.exit,
            kept: Some(outcome.kept),
            wrong: Vec::new(),
            printed: outcome.printed.clone(),
            is_disturbed: outcome.gap > MAX_GAP,
        };
        if !outcome.has_begun(row) {
            verdict.wrong.push("it never began".to_owned());
            // Linux moves a terminal's bytes in a thread of its own, which a busy machine may hold
            // up for seconds.
            verdict.is_disturbed |= outcome.printed.contains("this program did not run for");
        }
        let hears = !drive.faults.is_deaf && !drive.faults.is_unplugged && !drive.record.can;
        if row.expect == Expect::Unstoppable && hears && !outcome.is_guarded() {
            verdict.wrong.push("no stop by the guardian".to_owned());
        }
        if row.expect == Expect::Unstoppable && drive.record.can {
            // The drive misses the host's heartbeat, and reacts as its 6007 says.
            if verdict.powered || verdict.moving {
                verdict.wrong.push("6007 had no effect".to_owned());
            }
        }
        verdict.check(row.expect);
        let is_late = is_held_up && is_delayed;
        verdict.is_disturbed |= is_late && !verdict.wrong.is_empty();
        verdict
    }

    fn check(&mut self, expect: Expect) {
        let mut wrong = Vec::new();
        let mut must = |is_so: bool, what: String| {
            if !is_so {
                wrong.push(what);
            }
        };
        let stops = !matches!(expect, Expect::Unstoppable | Expect::Falls);
        must(!stops || !self.moving, "still moving".to_owned());
        match expect {
            Expect::Unstoppable => {
                must(self.exit == Some(5), format!("exit {:?}", self.exit));
                let tells = self.printed.to_lowercase().contains("supply");
                must(tells, "no word of the supply".to_owned());
            }
            _ => must(!self.powered, "still powered".to_owned()),
        }
        must(!stops || self.braked, "brake open".to_owned());
        let (delay_ms, delay_deg) = self.delayed;
        let beyond = self.ramp
            + delay_deg
            + match expect {
                Expect::Unstoppable | Expect::Falls => f64::INFINITY,
                Expect::HomingBound | Expect::HomingStopped => f64::INFINITY,
                Expect::Unseen => UNSEEN,
                Expect::Braked if self.is_rs232 => BRAKED_RS232,
                Expect::Braked => BRAKED,
                Expect::BrakedLate => BRAKED_LATE,
                _ => BEYOND,
            };
        let what = format!("{:.2} deg beyond the limits", self.beyond);
        must(self.beyond <= beyond, what);
        let stop = self.stop_ms.unwrap_or(f64::INFINITY);
        match expect {
            Expect::Completes => {
                must(self.exit == Some(0), format!("exit {:?}", self.exit));
                must(
                    self.kept == Some(Kept::Cloud),
                    format!("kept {:?}", self.kept),
                );
            }
            Expect::Refused => {
                must(self.travel < 0.01, format!("moved {:.3} deg", self.travel));
                must(
                    matches!(self.exit, Some(4 | 5)),
                    format!("exit {:?}", self.exit),
                );
            }
            Expect::Stopped | Expect::Unseen | Expect::Braked | Expect::BrakedLate => {
                must(
                    stop <= STOP_MS + delay_ms,
                    format!("stop after {stop:.0} ms"),
                );
                must(
                    !matches!(self.exit, Some(0) | None),
                    format!("exit {:?}", self.exit),
                );
                let tells = self.printed.contains("switching its power off did");
                must(
                    tells || !matches!(expect, Expect::Braked | Expect::BrakedLate),
                    "no word of what stopped the axis".to_owned(),
                );
            }
            Expect::Silent => {
                must(
                    stop <= SILENT_MS + delay_ms,
                    format!("stop after {stop:.0} ms"),
                );
                must(
                    !matches!(self.exit, Some(0) | None),
                    format!("exit {:?}", self.exit),
                );
            }
            Expect::HomingBound | Expect::HomingStopped => {
                must(
                    expect == Expect::HomingBound || stop <= STOP_MS + delay_ms,
                    format!("stop after {stop:.0} ms"),
                );
                must(
                    self.travel <= HOMING + delay_deg,
                    format!("travel {:.1} deg", self.travel),
                );
                must(self.exit == Some(5), format!("exit {:?}", self.exit));
            }
            Expect::Falls => {
                must(self.exit == Some(5), format!("exit {:?}", self.exit));
                let tells = self.printed.to_lowercase().contains("supply");
                must(tells, "no word of the supply".to_owned());
            }
            Expect::Safe => must(self.exit.is_some(), "no exit code".to_owned()),
            Expect::Unstoppable => {}
        }
        self.wrong = [std::mem::take(&mut self.wrong), wrong].concat();
    }
}

impl fmt::Display for Verdict {
    /// The cells of the table after the row's name and link.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stop = self.stop_ms.map_or("-".to_owned(), |ms| format!("{ms:.0}"));
        let exit = self.exit.map_or("-".to_owned(), |exit| exit.to_string());
        let kept = match self.kept {
            Some(Kept::Cloud) => "cloud",
            Some(Kept::Log) => "log",
            _ => "-",
        };
        let power = if self.powered { "**on**" } else { "off" };
        let brake = if self.braked { "shut" } else { "**open**" };
        let moving = if self.moving { ", **moving**" } else { "" };
        write!(
            f,
            "{:.1} | {:.2} | {stop} | {power}, {brake}{moving} | {exit} | {kept}",
            self.travel, self.beyond
        )?;
        if f.alternate() || self.wrong.is_empty() {
            return Ok(());
        }
        write!(
            f,
            "   <- {}{}",
            self.wrong.join("; "),
            if self.is_disturbed {
                " (disturbed)"
            } else {
                ""
            }
        )
    }
}

/// Heading of the second part of the table.
const UNSTOPPABLE: &str =
    "\nWhat no program can stop: the drive obeys or hears nothing, or the brake fails.\n\n";
const HEAD: &str = "| misbehaviour | link | travel, deg | beyond the limits, deg | first stop, ms | power, brake | exit | kept |\n\
     |---|---|---|---|---|---|---|---|\n";

/// Whether a program can stop the axis.
fn is_stoppable(row: &Misbehaviour) -> bool {
    !matches!(row.expect, Expect::Unstoppable | Expect::Falls)
}

/// The page, and the beginning of a run's line in its table.
fn page() -> (&'static str, String) {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/src/misbehaviours.md"
    );
    (path, std::fs::read_to_string(path).unwrap())
}

fn key(row: &Misbehaviour, transport: Transport) -> String {
    format!("| {} | {} | ", row.name, transport.kind())
}

/// Runs that the page does not show.
pub fn missing() -> Vec<String> {
    let (_, page) = page();
    let runs = ROWS.iter().flat_map(|row| {
        let links = Transport::ALL.into_iter();
        let possible = links.filter(|link| row.is_possible(*link));
        possible.map(|link| key(row, link)).collect::<Vec<_>>()
    });
    runs.filter(|key| !page.lines().any(|line| line.starts_with(key)))
        .collect()
}

/// Writes the table of the page. Rows that did not run yet stay as they are.
pub fn bless(verdicts: &[(usize, Transport, Verdict)]) {
    let (path, page) = page();
    let (before, rest) = page.split_once(MARKS.0).unwrap();
    let (old, after) = rest.split_once(MARKS.1).unwrap();
    let mut parts = [HEAD.to_owned(), format!("{UNSTOPPABLE}{HEAD}")];
    for (number, row) in ROWS.iter().enumerate() {
        for transport in Transport::ALL {
            let key = key(row, transport);
            let found = verdicts.iter().find(|v| v.0 == number && v.1 == transport);
            let line = match found {
                Some((.., verdict)) => Some(format!("{key}{verdict:#} |")),
                None => old
                    .lines()
                    .find(|line| line.starts_with(&key))
                    .map(str::to_owned),
            };
            if let Some(line) = line {
                let part = &mut parts[usize::from(!is_stoppable(row))];
                part.push_str(&line);
                part.push('\n');
            }
        }
    }
    let [stopped, other] = parts;
    let table = format!("{}{stopped}{other}{}", MARKS.0, MARKS.1);
    std::fs::write(path, format!("{before}{table}{after}")).unwrap();
}
