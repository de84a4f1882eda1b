//! Steps without power: who the drive is, how it is set, how it answers.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use drive::{CommandOutcome, DriveCommand, SampleTrigger, ShaftSample};
use protocol::epos2::objects::{self, Address, input};
use protocol::record::DriveLink;
use units::Stamp;

use super::{BringUp, BringUpResult, BringUpStep, Judgement, Operator};
use crate::devices::drive_session::SessionError;
use crate::service::axis_report;

/// Duration of sampling at rest, ns.
pub(super) const REST_NS: i64 = 2_000_000_000;
/// Reads of an object whose time is measured.
const READS: usize = 50;
/// Attempts to see a pressed switch; each takes a few milliseconds.
const SWITCH_READS: usize = 2_000;
/// The longest gap between samples that the fit of the angle bridges within a count: the default
/// profile accelerates for 160 ms.
const LONGEST_GAP_MS: f64 = 50.0;

pub(super) const IDENTITY: BringUpStep = BringUpStep {
    title: "identity",
    plan: "asks the drive for its name, versions, state and error history; changes nothing",
    moves: false,
    run: identity,
};

pub(super) const OBJECTS: BringUpStep = BringUpStep {
    title: "configuration objects",
    plan: "reads every object that the program uses, and those of inputs, outputs, motor and controllers; changes nothing",
    moves: false,
    run: read_objects,
};

pub(super) const CONNECTION: BringUpStep = BringUpStep {
    title: "configuration",
    plan: "clears a fault, writes the settings of [axis], reads them back, and compares the motor's and the encoder's; the power stays off",
    moves: false,
    run: connect,
};

pub(super) const LINK: BringUpStep = BringUpStep {
    title: "link and encoder at rest",
    plan: "samples the position for 2 s with the power off, and times the reading of an object",
    moves: false,
    run: link,
};

pub(super) const SWITCHES: BringUpStep = BringUpStep {
    title: "limit switches",
    plan: "watches the inputs while you press each limit switch by hand; the power stays off",
    moves: false,
    run: switches,
};

fn identity(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let recording = bring_up.run(&[DriveCommand::Status])?;
    let Some(CommandOutcome::Status(status)) = recording.outcome else {
        return Ok(());
    };
    let identity = status.identity;
    bring_up.note("unit", axis_report::unit(&identity));
    let numbers = format!("{:08X}, {:08X}", identity.product, identity.revision);
    bring_up.note("product code (1018:2) and revision (1018:3)", numbers);
    let state = status
        .state
        .map_or("unknown".to_owned(), |state| state.to_string());
    bring_up.note("state", format!("{state} ({:04X})", status.statusword));
    bring_up.note(
        "error history",
        match status.history.as_slice() {
            [] => "empty".to_owned(),
            errors => errors
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join("; "),
        },
    );
    Ok(())
}

fn read_objects(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let used = objects::ALL
        .iter()
        .map(|object| (object.address, object.name));
    let others = OTHER_OBJECTS.iter().flat_map(|(index, subs, name)| {
        let addresses = subs.clone().map(|sub| Address::new(*index, sub));
        addresses.map(|address| (address, *name))
    });
    let is_used = |address: Address| objects::ALL.iter().any(|used| used.address == address);
    let others = others.filter(|(address, _)| !is_used(*address));
    for (address, name) in used.chain(others) {
        let value = match bring_up.read(address)? {
            None => "not readable".to_owned(),
            Some(bytes) => {
                let number = bytes
                    .iter()
                    .rev()
                    .fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
                format!("{number} (0x{number:X})")
            }
        };
        bring_up.note(&format!("{address} {name}"), value);
    }
    Ok(())
}

/// Objects that the program does not use, for the record of how the drive was set (EPOS2 Firmware
/// Specification, "Object Dictionary").
const OTHER_OBJECTS: [(u16, RangeInclusive<u8>, &str); 12] = [
    (0x1800, 1..=3, "TxPDO 1"),
    (0x1A00, 0..=8, "Mapping of TxPDO 1"),
    (0x2001, 0..=0, "CAN Bitrate"),
    (0x2002, 0..=0, "RS232 Baudrate"),
    (0x2070, 1..=9, "Configuration of a Digital Input"),
    (0x2079, 1..=5, "Configuration of a Digital Output"),
    (0x2100, 1..=3, "Brake"),
    (0x2210, 1..=4, "Position Sensor"),
    (0x60F6, 1..=2, "Current Regulator"),
    (0x60F9, 1..=5, "Speed Regulator"),
    (0x60FB, 1..=5, "Position Regulator"),
    (0x6410, 1..=5, "Motor Data"),
];

fn connect(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let recording = bring_up.run(&[DriveCommand::Connect])?;
    let Some(CommandOutcome::Connected(report)) = recording.outcome else {
        return Ok(());
    };
    // A difference is an error of the connection.
    bring_up.note("settings", "written, read back, equal");
    bring_up.note(
        "source of the angle",
        format!("{:?}", report.angle).to_lowercase(),
    );
    let notices = "the drive itself notices a dead host";
    let is_can = bring_up.opened.link == DriveLink::Can;
    match (report.monitors_host, is_can) {
        (true, _) => bring_up.note(notices, "yes (heartbeat, 1016)"),
        // There is no guardian on a CAN bus.
        (false, true) => bring_up.judge(
            notices,
            "no (1016 is refused)",
            false,
            "nothing would stop the axis if the program died, so it is not moved: use USB or RS232",
        ),
        (false, false) => {
            bring_up.note(notices, "no: a guardian process stops the axis");
        }
    }
    Ok(())
}

fn link(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let hold = DriveCommand::Hold {
        until: Stamp::from_nanos(REST_NS),
    };
    let recording = bring_up.run(&[DriveCommand::Connect, hold])?;
    let samples = &recording.samples;
    let ms = |span: units::Span| span.as_secs_f64() * 1e3;
    let polled = samples
        .iter()
        .filter(|sample| sample.trigger == SampleTrigger::Request);
    let mut delays: Vec<f64> = polled
        .map(|sample| ms(sample.answer.saturating_since(sample.request)))
        .collect();
    positions(bring_up, "at rest", std::slice::from_ref(samples));
    if !delays.is_empty() {
        bring_up.note("time of a poll", spread(&mut delays));
    }
    let mut reads = Vec::new();
    for _ in 0..READS {
        let began = bring_up.opened.port.now();
        bring_up.read(objects::STATUSWORD.address)?;
        reads.push(ms(bring_up.opened.port.now().saturating_since(began)));
    }
    bring_up.note("time of reading an object", spread(&mut reads));
    judge_dither(
        bring_up,
        "dither of the encoder at rest",
        samples,
        "check the encoder's cable and shield, or raise [axis.guard] standstill_deg",
    );
    Ok(())
}

/// Judges by how much the position of an axis at rest deviates.
pub(super) fn judge_dither(
    bring_up: &mut BringUp<'_>,
    name: &str,
    samples: &[ShaftSample],
    advice: &str,
) {
    let counts = || samples.iter().map(|sample| sample.position.0);
    let range = counts().max().unwrap_or(0) - counts().min().unwrap_or(0);
    let degrees = f64::from(range) * bring_up.axis.gearing.degrees_per_qc();
    let limit = bring_up.axis.standstill_spread.0;
    bring_up.judge(
        name,
        format!("{range} qc, {degrees:.4} deg (limit {limit} deg)"),
        degrees <= limit,
        advice,
    );
}

/// Notes the rate of positions in some periods, and judges the time between them: on a CAN bus
/// SYNCs or positions may be lost.
pub(super) fn positions(bring_up: &mut BringUp<'_>, when: &str, periods: &[Vec<ShaftSample>]) {
    let ms = |pair: &[ShaftSample]| match pair {
        [before, after] => after.answer.saturating_since(before.answer).as_secs_f64() * 1e3,
        _ => 0.0,
    };
    let pairs = periods.iter().flat_map(|samples| samples.windows(2));
    let mut gaps: Vec<f64> = pairs.map(ms).collect();
    if gaps.is_empty() {
        let name = format!("positions {when}");
        return bring_up.problem(&name, "none came", "check the link (links.md)");
    }
    let rate = 1e3 * gaps.len() as f64 / gaps.iter().sum::<f64>();
    let is_polled = |sample: &ShaftSample| sample.trigger == SampleTrigger::Request;
    let by = match periods.iter().flatten().all(is_polled) {
        true => "polls",
        false => "SYNC",
    };
    bring_up.note(
        &format!("positions by {by} {when}"),
        format!("{rate:.0} per second"),
    );
    let worst = gaps.iter().copied().fold(0.0, f64::max);
    bring_up.judge(
        &format!("time between positions {when}"),
        spread(&mut gaps),
        worst <= LONGEST_GAP_MS,
        "see links.md: latency timer of the adapter, cable, termination, load of this machine",
    );
}

/// Median, 99th percentile and worst of some times, ms.
fn spread(values: &mut [f64]) -> String {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (values.len().saturating_sub(1) as f64 * share).round() as usize;
        values.get(index).copied().unwrap_or(f64::NAN)
    };
    format!(
        "median {:.2}, 99 % {:.2}, worst {:.2} ms",
        at(0.5),
        at(0.99),
        at(1.0)
    )
}

fn switches(bring_up: &mut BringUp<'_>, operator: &mut dyn Operator) -> Result<(), SessionError> {
    let switches = bring_up.axis.limit_switches;
    let both = [
        (
            "negative limit switch",
            switches.negative,
            input::NEGATIVE_LIMIT,
        ),
        (
            "positive limit switch",
            switches.positive,
            input::POSITIVE_LIMIT,
        ),
    ];
    for (name, wired, bit) in both {
        let Some(number) = wired else {
            bring_up.note(name, "none configured");
            continue;
        };
        let advice = format!(
            "check the wiring of input {number}, and [axis.limit_switches] (input, normally_closed)"
        );
        let before = inputs(bring_up)?;
        bring_up.judge(
            &format!("{name}, free"),
            format!("2071:1 is {before:04X}"),
            before & bit == 0,
            &advice,
        );
        let request = format!("press the {name} by hand and keep it pressed");
        if !operator.has_done(&request) {
            bring_up.unchecked(&format!("{name}, pressed"), "not tried");
            continue;
        }
        let mut pressed = inputs(bring_up)?;
        for _ in 0..SWITCH_READS {
            if pressed & bit != 0 {
                break;
            }
            pressed = inputs(bring_up)?;
        }
        bring_up.judge(
            &format!("{name}, pressed"),
            format!("2071:1 is {pressed:04X}"),
            pressed & bit != 0 && pressed & !bit == before & !bit,
            &advice,
        );
    }
    Ok(())
}

/// Digital input functionalities (2071:1).
pub(super) fn inputs(bring_up: &mut BringUp<'_>) -> Result<u16, SessionError> {
    let bytes = bring_up
        .read(objects::INPUT_STATE.address)?
        .unwrap_or_default();
    Ok(bytes
        .iter()
        .take(2)
        .rev()
        .fold(0, |sum, byte| sum << 8 | u16::from(*byte)))
}

/// Time in which a killed process's axis must be at rest without power, with the time to open the
/// port again.
const REST_LIMIT: Duration = Duration::from_secs(2);

/// The axis of a killed process.
#[derive(Clone, Copy, Debug)]
struct KilledAxis {
    is_still: bool,
    has_power: bool,
}

impl KilledAxis {
    /// Whether it is at rest as it is meant to be left: without power, or held where the
    /// configuration says so.
    const fn is_safe(self, holds: bool) -> bool {
        self.is_still && (!self.has_power || holds)
    }

    /// The state as found, and the judgement.
    fn judged(self, holds: bool, seconds: f64) -> BringUpResult {
        let motion = if self.is_still { "at rest" } else { "MOVES" };
        let power = if self.has_power {
            "power on"
        } else {
            "power off"
        };
        let is_safe = self.is_safe(holds);
        let advice = match self.is_still {
            false => "cut the supply: the axis of a killed program moves",
            true => {
                "cut the supply: the axis of a killed program stays powered, and its brake open; check that the guardian process runs (USB, RS232) or that 1016 and 6007 are honoured (CAN)"
            }
        };
        BringUpResult {
            name: "axis".to_owned(),
            value: format!("{motion}, {power}, {seconds:.2} s after the kill"),
            judgement: if is_safe {
                Judgement::Good
            } else {
                Judgement::Problem
            },
            advice: (!is_safe).then(|| advice.to_owned()),
        }
    }
}

impl BringUp<'_> {
    /// Looks whether the axis is at rest, and without power unless the drive is meant to hold it,
    /// after its process was killed.
    pub fn rest_after(&mut self, killed: Instant) -> BringUpResult {
        match self.wait_for_rest(killed) {
            Ok(axis) => axis.judged(self.axis.holds(), killed.elapsed().as_secs_f64()),
            Err(error) => BringUpResult {
                name: "axis".to_owned(),
                value: error.to_string(),
                judgement: Judgement::Problem,
                advice: Some("cut the supply: the axis may move".to_owned()),
            },
        }
    }

    fn wait_for_rest(&mut self, killed: Instant) -> Result<KilledAxis, SessionError> {
        let mut before = None;
        loop {
            let recording = self.run(&[DriveCommand::Status])?;
            // A drive whose state is unknown counts as powered and in motion.
            let Some(CommandOutcome::Status(status)) = recording.outcome else {
                return Ok(KilledAxis {
                    is_still: false,
                    has_power: true,
                });
            };
            let at = self.axis.gearing.angle(status.position).0;
            let is_second = before.is_some();
            let axis = KilledAxis {
                is_still: before.replace(at).is_some_and(|before: f64| {
                    (before - at).abs() <= self.axis.standstill_spread.0
                }),
                has_power: axis_report::has_power(status.statusword),
            };
            // Motion shows in the second reading.
            let is_over = axis.is_safe(self.axis.holds()) || killed.elapsed() > REST_LIMIT;
            if is_over && is_second {
                return Ok(axis);
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The judgement of an axis with a brake, and of one that the drive is meant to hold.
    fn judgements(is_still: bool, has_power: bool) -> [Judgement; 2] {
        let axis = KilledAxis {
            is_still,
            has_power,
        };
        [false, true].map(|holds| axis.judged(holds, 1.0).judgement)
    }

    #[test]
    fn a_killed_axis_is_good_only_at_rest_and_without_power() {
        use Judgement::{Good, Problem};
        assert_eq!(judgements(true, false), [Good, Good]);
        // Power on: only where the configuration says hold.
        assert_eq!(judgements(true, true), [Problem, Good]);
        assert_eq!(judgements(false, false), [Problem, Problem]);
        assert_eq!(judgements(false, true), [Problem, Problem]);
    }
}
