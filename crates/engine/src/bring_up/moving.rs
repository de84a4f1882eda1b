//! Steps with power: homing, stops, brake, following error.

use drive::cia402::DeviceState;
use drive::config::AxisConfig;
use drive::{
    CommandKind, CommandOutcome, CommandProgress, DriveCommand, DriveEvent, MoveCommand,
    MoveReport, ShaftSample,
};
use protocol::epos2::objects::input;
use units::{DegPerS, Degrees, Host, Quadcounts, Rpm, Span, Stamp};

use super::at_rest::{REST_NS, inputs, judge_dither, positions};
use super::{BringUp, BringUpStep, Operator, SessionRecord};
use crate::devices::drive_session::SessionError;

/// Speed of the moves that are stopped.
const STOP_SPEED: DegPerS = DegPerS(20.0);
/// Delay of a stop: the position sample that shows it, its frame, and one control cycle.
const STOP_DELAY: Span = Span::from_millis(100);
/// Dither up to which the stop of an axis with power is confirmed, and for how long, to measure it.
const DITHER_LIMIT: Degrees = Degrees(0.2);
const DITHER_SPAN: Span = Span::from_millis(500);
/// Shares of the highest speed at which the axis is compared with its plan.
const SPEED_SHARES: [f64; 3] = [0.1, 0.5, 1.0];

pub(super) const HOMING: BringUpStep = BringUpStep {
    title: "homing",
    plan: "MOVES: samples the position with the power on, then homes the axis by the configured method, at the configured speed, in the direction of its switch. Have the supply switch in hand: cut it if the axis goes the wrong way",
    moves: true,
    run: home,
};

pub(super) const OTHER_SWITCH: BringUpStep = BringUpStep {
    title: "homing onto the other limit switch",
    plan: "MOVES: homes onto the opposite limit switch, then again by the configured method",
    moves: true,
    run: other_switch,
};

pub(super) const QUICK_STOP: BringUpStep = BringUpStep {
    title: "stops",
    plan: "MOVES: stops the drive with its power off, ready to switch on, with power at rest, while homing, and in a move of 20 deg/s",
    moves: true,
    run: stops,
};

pub(super) const BRAKE: BringUpStep = BringUpStep {
    title: "brake and drop",
    plan: "MOVES: goes to the middle of the range, switches the power off, and watches the position for 2 s: the head drops if nothing holds it",
    moves: true,
    run: brake,
};

pub(super) const FOLLOWING: BringUpStep = BringUpStep {
    title: "following error",
    plan: "MOVES: across half of the range at 10, 50 and 100 % of the highest speed",
    moves: true,
    run: following,
};

/// Judges the dither with the power on, to which the position controller adds its own. The stop
/// that follows the power confirms standstill over half a second.
fn powered_dither(bring_up: &mut BringUp<'_>) -> Result<(), SessionError> {
    let state = |event: &DriveEvent| match event {
        DriveEvent::Progress(CommandProgress::Statusword(word)) => {
            DeviceState::from_statusword(*word)
        }
        _ => None,
    };
    let has_power = |state| {
        matches!(
            state,
            DeviceState::OperationEnabled | DeviceState::QuickStopActive
        )
    };
    let mut axis = bring_up.axis.clone();
    axis.standstill_spread = DITHER_LIMIT;
    axis.timing.standstill = DITHER_SPAN;
    axis.hold_without_brake = false;
    let prepare = [DriveCommand::Connect, DriveCommand::Home];
    let recording = bring_up.run_as(axis, &prepare, &mut |event| {
        state(event) == Some(DeviceState::OperationEnabled)
    })?;
    let with_power = recording
        .events
        .iter()
        .skip_while(|event| !state(event).is_some_and(has_power))
        .take_while(|event| state(event).is_none_or(has_power));
    let samples: Vec<ShaftSample> = with_power
        .filter_map(|event| match event {
            DriveEvent::Sample(sample) => Some(*sample),
            _ => None,
        })
        .collect();
    let name = "dither with the power on";
    let Some(last) = samples.last() else {
        bring_up.problem(name, "no position came", "check the link (links.md)");
        return Ok(());
    };
    // Homing may have begun before the stop.
    let at_rest = samples
        .iter()
        .filter(|sample| last.answer.saturating_since(sample.request) < DITHER_SPAN);
    judge_dither(
        bring_up,
        name,
        &at_rest.copied().collect::<Vec<_>>(),
        "tune the drive's position controller with the maker's tool, check the encoder's cable, or raise [axis.guard] standstill_deg",
    );
    Ok(())
}

fn home(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    powered_dither(bring_up)?;
    let axis = bring_up.axis.clone();
    let homed = home_as(bring_up, axis, "homing", false)?;
    let wanted = bring_up.axis.homing.home_position.0;
    let tolerance = bring_up.axis.arrival_tolerance.0;
    bring_up.judge(
        "angle after homing",
        format!("{homed:.3} deg (expected {wanted} deg)"),
        (homed - wanted).abs() <= tolerance,
        "check 2081 and the homing method",
    );
    let pressed = inputs(bring_up)? & (input::NEGATIVE_LIMIT | input::POSITIVE_LIMIT);
    let offset = bring_up.axis.homing.offset.0;
    bring_up.judge(
        "limit switches after homing",
        format!("{pressed:04X}; home offset (607C) {offset} deg"),
        pressed == 0,
        "the home offset drives onto the switch instead of away from it: exchange the sign of to_deg - at_deg in [axis.homing]",
    );
    Ok(())
}

/// Homes as `axis` says, and notes time and travel, which is judged if the axis comes from the
/// other end of its range; returns the angle.
fn home_as(
    bring_up: &mut BringUp<'_>,
    axis: AxisConfig,
    name: &str,
    from_end: bool,
) -> Result<f64, SessionError> {
    let method = axis.homing.method;
    let began = bring_up.opened.port.now();
    let commands = [
        DriveCommand::Connect,
        DriveCommand::Home,
        DriveCommand::Brake,
    ];
    let recording = bring_up.run_as(axis, &commands, &mut |_| false)?;
    let took = bring_up
        .opened
        .port
        .now()
        .saturating_since(began)
        .as_secs_f64();
    let travel = searched(&recording, &bring_up.axis);
    let value = format!("method {method}, {took:.1} s, {travel:.1} deg travelled");
    match from_end {
        false => bring_up.note(name, value),
        true => {
            // The switches are beyond the limits, and the axis comes from the offset beside one.
            let limits = bring_up.axis.limits;
            let least = limits.max.0 - limits.min.0 - bring_up.axis.homing.offset.0.abs();
            bring_up.judge(
                name,
                format!("{value} (expected at least {least:.1} deg)"),
                travel >= least,
                "the switches are closer to each other than the limits: check gear, encoder lines and limits",
            );
        }
    }
    let homed = recording.events.iter().find_map(|event| match event {
        DriveEvent::Done(CommandOutcome::Homed { angle, .. }) => Some(angle.0),
        _ => None,
    });
    Ok(homed.unwrap_or(f64::NAN))
}

/// Degrees between the ends of the demand's way in homing. Where the drive sets its zero the demand
/// jumps, further than the axis can move.
fn searched(recording: &SessionRecord, axis: &AxisConfig) -> f64 {
    let demands = recording.events.iter().filter_map(|event| match event {
        DriveEvent::Progress(CommandProgress::Searching { at, demand }) => Some((*at, *demand)),
        _ => None,
    });
    let demands: Vec<(Stamp<Host>, Quadcounts)> = demands.collect();
    let fastest = axis.gearing.rate(axis.max_speed).0;
    let (mut place, mut low, mut high) = (0.0, 0.0_f64, 0.0_f64);
    for pair in demands.windows(2) {
        let &[(since, before), (at, demand)] = pair else {
            continue;
        };
        let step = axis.gearing.angle(demand).0 - axis.gearing.angle(before).0;
        let seconds = at.saturating_since(since).as_secs_f64();
        if step.abs() <= 2.0 * fastest * seconds + 1.0 {
            place += step;
        }
        (low, high) = (low.min(place), high.max(place));
    }
    high - low
}

fn other_switch(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let switches = bring_up.axis.limit_switches;
    let other = match bring_up.axis.homing.method {
        17 => 18,
        18 => 17,
        1 => 2,
        2 => 1,
        method => {
            bring_up.note(
                "other switch",
                format!("method {method} uses no limit switch"),
            );
            return Ok(());
        }
    };
    if switches.negative.is_none() || switches.positive.is_none() {
        bring_up.note("other switch", "one limit switch is configured");
        return Ok(());
    }
    let mut axis = bring_up.axis.clone();
    axis.homing.method = other;
    axis.homing.offset = Degrees(-axis.homing.offset.0);
    home_as(bring_up, axis, "onto the other switch", true)?;
    let axis = bring_up.axis.clone();
    home_as(bring_up, axis, "back", true)?;
    Ok(())
}

fn stops(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let recording = bring_up.run(&[DriveCommand::Stop, DriveCommand::Status])?;
    if let Some(CommandOutcome::Status(status)) = recording.outcome {
        let state = status.state;
        bring_up.judge(
            "with the power off",
            state.map_or("unknown".to_owned(), |state| state.to_string()),
            state == Some(DeviceState::SwitchOnDisabled),
            "the drive does not obey disable voltage: check its firmware with its own tool",
        );
    }
    let axis = bring_up.axis.clone();
    let prepare = [DriveCommand::Connect, DriveCommand::Home];
    // The client passes through this state when it switches the power on.
    let recording = bring_up.run_as(axis.clone(), &prepare, &mut |event| {
        let DriveEvent::Progress(CommandProgress::Statusword(word)) = event else {
            return false;
        };
        DeviceState::from_statusword(*word) == Some(DeviceState::ReadyToSwitchOn)
    })?;
    judge_stop(bring_up, "ready to switch on", &recording, 0.0);
    let across = across(bring_up, STOP_SPEED);
    let mut sweeps = false;
    // The first positions of a sweep are those before it moves.
    let sweep = DriveCommand::Sweep(across);
    let commands = [prepare[0], prepare[1], sweep];
    let recording = bring_up.run_as(axis.clone(), &commands, &mut |event| {
        let began = CommandProgress::Started(CommandKind::Sweep);
        sweeps |= *event == DriveEvent::Progress(began);
        sweeps && matches!(event, DriveEvent::Sample(_))
    })?;
    judge_stop(bring_up, "with power, at rest", &recording, 0.0);
    let homing = axis.gearing.rate(axis.homing.switch_speed).0;
    let mut searched = 0;
    let recording = bring_up.run_as(axis.clone(), &prepare, &mut |event| {
        let searching = matches!(
            event,
            DriveEvent::Progress(CommandProgress::Searching { .. })
        );
        searched += usize::from(searching);
        searched >= 5
    })?;
    judge_stop(bring_up, "while homing", &recording, homing);
    let half = DriveCommand::Goto(across);
    let middle = (axis.limits.min.0 + axis.limits.max.0) / 2.0;
    let gearing = axis.gearing;
    let mut moving = false;
    let recording = bring_up.run_as(axis, &[prepare[0], prepare[1], half], &mut |event| {
        match event {
            DriveEvent::Progress(CommandProgress::Moving(_)) => moving = true,
            DriveEvent::Sample(sample) if moving => {
                let angle = gearing.angle(sample.position).0;
                // Halfway between start and target.
                return (angle - across.to.0).abs() < (middle - across.to.0).abs();
            }
            _ => {}
        }
        false
    })?;
    judge_stop(bring_up, "in a move", &recording, STOP_SPEED.0);
    Ok(())
}

/// Judges how far the axis went after the stop, from this speed.
fn judge_stop(bring_up: &mut BringUp<'_>, name: &str, recording: &SessionRecord, speed: f64) {
    let stopped_at = recording.stopped_at.unwrap_or(0);
    let after = recording
        .samples
        .get(stopped_at.saturating_sub(1)..)
        .unwrap_or_default();
    let (Some(first), Some(last)) = (after.first(), after.last()) else {
        bring_up.problem(name, "no position came after the stop", "repeat the step");
        return;
    };
    let gearing = bring_up.axis.gearing;
    let travelled = (gearing.angle(last.position).0 - gearing.angle(first.position).0).abs();
    let seconds = last.answer.saturating_since(first.answer).as_secs_f64();
    let ramp = speed * speed / (2.0 * gearing.acceleration(bring_up.axis.quick_stop).0);
    let limit = ramp + speed * STOP_DELAY.as_secs_f64() + bring_up.axis.standstill_spread.0;
    bring_up.judge(
        name,
        format!(
            "at rest after {travelled:.3} deg (limit {limit:.3} deg), observed for {seconds:.2} s"
        ),
        travelled <= limit,
        "check 6085 and the supply: a quick stop needs a supply that takes the braking energy",
    );
}

/// A move from home to the end of the range that is further away.
fn across(bring_up: &BringUp<'_>, speed: DegPerS) -> MoveCommand {
    let axis = &bring_up.axis;
    let home = axis.homing.home_position.0;
    let middle = (axis.limits.min.0 + axis.limits.max.0) / 2.0;
    // A tenth of the range away from the limit.
    let margin = (axis.limits.max.0 - axis.limits.min.0) / 10.0;
    let to = match home > middle {
        true => axis.limits.min.0 + margin,
        false => axis.limits.max.0 - margin,
    };
    MoveCommand {
        to: Degrees(to),
        speed: axis.gearing.rpm(speed).clamp(Rpm(1), axis.max_speed),
        acceleration: axis.gearing.rpm_per_s(bring_up.acceleration),
    }
}

fn brake(bring_up: &mut BringUp<'_>, operator: &mut dyn Operator) -> Result<(), SessionError> {
    let limits = bring_up.axis.limits;
    let to_middle = MoveCommand {
        to: Degrees((limits.min.0 + limits.max.0) / 2.0),
        ..across(bring_up, STOP_SPEED)
    };
    let hold = DriveCommand::Hold {
        until: Stamp::from_nanos(REST_NS),
    };
    let moves = [
        DriveCommand::Connect,
        DriveCommand::Home,
        DriveCommand::Goto(to_middle),
    ];
    let before = bring_up.run(&[moves[0], moves[1], moves[2], DriveCommand::Brake])?;
    let after = bring_up.run(&[DriveCommand::Connect, hold])?;
    let gearing = bring_up.axis.gearing;
    // Power off ends where the axis rests, after its fall. It fell from where the move ended.
    let arrived = before.events.iter().find_map(|event| match event {
        DriveEvent::Done(CommandOutcome::Arrived(report)) => Some(report.position),
        _ => None,
    });
    let positions = after.samples.iter().map(|sample| sample.position);
    let angles = positions
        .chain(arrived)
        .map(|position| gearing.angle(position).0);
    let (low, high) = angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| {
        (low.min(angle), high.max(angle))
    });
    let drop = high - low;
    // The axis may still settle where the move ends.
    let limit = bring_up.axis.standstill_spread.0 + bring_up.axis.arrival_tolerance.0;
    let has_brake = bring_up.axis.brake.is_some();
    bring_up.judge(
        "drop in 2 s with the power off",
        format!("{drop:.3} deg (limit {limit:.3} deg)"),
        drop <= limit,
        match has_brake {
            true => "the brake does not hold: check its output (2079), polarity (2078:3) and supply",
            false => "the head falls without power: fit a brake, or set without_brake = \"hold\" in [axis]",
        },
    );
    if !has_brake {
        bring_up.note("brake", "none configured (brake_output)");
    } else if operator.has_done("try to turn the axis by hand: does the brake hold it?") {
        bring_up.judge("brake by hand", "holds", true, "");
    } else {
        bring_up.unchecked("brake by hand", "not confirmed");
    }
    Ok(())
}

fn following(bring_up: &mut BringUp<'_>, _: &mut dyn Operator) -> Result<(), SessionError> {
    let axis = bring_up.axis.clone();
    let fastest = axis.gearing.rate(axis.max_speed).0;
    let home = axis.homing.home_position;
    for share in SPEED_SHARES {
        let there = across(bring_up, DegPerS(fastest * share));
        let back = MoveCommand { to: home, ..there };
        let commands = [
            DriveCommand::Connect,
            DriveCommand::Home,
            DriveCommand::Goto(there),
            DriveCommand::Goto(back),
            DriveCommand::Brake,
        ];
        let recording = bring_up.run(&commands)?;
        let speed = axis.gearing.rate(there.speed).0;
        let worst = largest_deviation(&recording, &axis);
        let limit = axis.guard.behind.0 + axis.guard.servo_lag.as_secs_f64() * speed;
        bring_up.judge(
            &format!("largest distance from the plan at {speed:.2} deg/s"),
            format!("{worst:.3} deg (the guard stops at {limit:.2} deg)"),
            worst <= limit / 2.0,
            "tune the drive's position controller, or lower the speed; [axis.guard] servo_lag_ms sets the limit",
        );
        let moves = moves(&recording).map(|report| {
            let all = recording.samples.iter().copied();
            all.filter(|sample| is_within(sample, report)).collect()
        });
        let moves: Vec<Vec<ShaftSample>> = moves.collect();
        positions(bring_up, &format!("at {speed:.2} deg/s"), &moves);
    }
    Ok(())
}

/// The recorded moves.
fn moves(recording: &SessionRecord) -> impl Iterator<Item = &MoveReport> {
    recording.events.iter().filter_map(|event| match event {
        DriveEvent::Done(CommandOutcome::Arrived(report)) => Some(report),
        _ => None,
    })
}

fn is_within(sample: &ShaftSample, report: &MoveReport) -> bool {
    sample.request >= report.started && sample.answer <= report.arrived
}

/// The largest distance between samples and plan of the recorded moves, degrees.
fn largest_deviation(recording: &SessionRecord, axis: &AxisConfig) -> f64 {
    let mut worst: f64 = 0.0;
    for report in moves(recording) {
        let samples = recording.samples.iter();
        for sample in samples.filter(|sample| is_within(sample, report)) {
            let angle = axis.gearing.angle(sample.position).0;
            let direction = (report.plan.to.0 - report.plan.from.0).signum();
            let at = |stamp: Stamp<Host>| {
                let travelled = report
                    .plan
                    .travelled(stamp.saturating_since(report.started));
                report.plan.from.0 + direction * travelled.0
            };
            // The position belongs to a time between request and answer.
            let (early, late) = (at(sample.request), at(sample.answer));
            let (low, high) = (early.min(late), early.max(late));
            worst = worst.max(low - angle).max(angle - high);
        }
    }
    worst
}
