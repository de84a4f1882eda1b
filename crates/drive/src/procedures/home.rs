//! Home: the client configures the drive's homing, monitors it and checks the result.

use protocol::epos2::cia402::{control, mode, status};
use protocol::epos2::objects;
use units::{Degrees, Host, Quadcounts, Span, Stamp};

use crate::config::AxisConfig;
use crate::error::{Deviation, DriveError};
use crate::event::{CommandOutcome, CommandProgress};
use crate::ops::Ops;

use super::configure::verify_before_move;
use super::motion::{PeriodicCheck, SWITCH_CHECKS};
use super::network;
use super::power::{check_enabled, enable, is_held, is_referenced, set_mode};
use super::stop::stop_after_failure;
use super::switches::SwitchWatch;

/// Runs [`crate::DriveCommand::Home`].
pub(crate) async fn home(mut ops: Ops) -> Result<CommandOutcome, DriveError> {
    ops.aborts_on_alarm = true;
    match run(&mut ops).await {
        Ok(outcome) => Ok(outcome),
        Err(cause) => Err(stop_after_failure(&mut ops, cause).await),
    }
}

async fn run(ops: &mut Ops) -> Result<CommandOutcome, DriveError> {
    verify_before_move(ops).await?;
    // A start bit left by another master must not act when the mode changes.
    let idle = match is_held(ops, ops.read(objects::STATUSWORD).await?) {
        true => control::ENABLE_OPERATION,
        false => control::SHUTDOWN,
    };
    ops.write(objects::CONTROLWORD, idle).await?;
    set_mode(ops, mode::HOMING).await?;
    configure(ops).await?;
    network::arm(ops).await?;
    enable(ops).await?;
    ops.is_moving = true;
    ops.set_referenced(false);
    let speed = ops.config.gearing.rate(ops.config.homing.switch_speed);
    let margin = Span::from_secs_f64(ops.config.guard.homing_margin.0 / speed.0);
    ops.silence_limit = ops.config.timing.silence_limit.min(margin);
    ops.loaded_silence_limit = ops.silence_limit;
    ops.set_lag(Degrees(speed.0 * ops.config.guard.servo_lag.as_secs_f64()));
    ops.write(objects::CONTROLWORD, control::START_HOMING)
        .await?;
    ops.report(CommandProgress::Homing);
    wait_until_attained(ops).await?;
    ops.is_moving = false;
    ops.loaded_silence_limit = ops.config.timing.silence_limit;
    ops.write(objects::CONTROLWORD, control::ENABLE_OPERATION)
        .await?;
    set_mode(ops, mode::PROFILE_POSITION).await?;
    let outcome = check_result(ops).await?;
    Ok(outcome)
}

async fn configure(ops: &Ops) -> Result<(), DriveError> {
    let config = &ops.config;
    let homing = config.homing;
    let offset = config.quadcounts("homing.offset", homing.offset)?;
    let position = config.quadcounts("homing.home_position", homing.home_position)?;
    ops.write_verified(objects::HOMING_METHOD, homing.method)
        .await?;
    for (object, value) in [
        (objects::HOMING_SWITCH_SPEED, homing.switch_speed.0),
        (objects::HOMING_ZERO_SPEED, homing.zero_speed.0),
        (objects::HOMING_ACCELERATION, homing.acceleration.0),
    ] {
        ops.write_verified(object, value).await?;
    }
    ops.write_verified(objects::HOME_OFFSET, offset.0).await?;
    ops.write_verified(objects::HOME_POSITION, position.0)
        .await?;
    if homing.detects_current() {
        ops.write_verified(objects::HOMING_CURRENT, homing.current_threshold_ma)
            .await?;
    }
    Ok(())
}

/// Waits for bits 10 and 12. The first check follows a period later, when the bits of an earlier
/// homing are cleared.
async fn wait_until_attained(ops: &mut Ops) -> Result<(), DriveError> {
    const DONE: u16 = status::TARGET_REACHED | status::HOMING_ATTAINED;
    let homing = ops.config.homing;
    let began = ops.now();
    let limit = began.saturating_add(homing.time_limit);
    let mut travel = HomingTravel::default();
    let mut switches = SwitchWatch::of_homing(&ops.config);
    let mut switch_check = PeriodicCheck::new(ops, SWITCH_CHECKS);
    loop {
        // A deviation is confirmed at once.
        if !travel.is_suspicious {
            ops.sleep(ops.config.timing.status_period).await;
        }
        let requested = ops.now();
        let got = check_enabled(ops).await?;
        if got & status::HOMING_ERROR != 0 {
            return Err(DriveError::Homing {
                method: homing.method,
                got,
            });
        }
        if got & DONE == DONE {
            return Ok(());
        }
        // A missing answer does not end homing: a lost link fails the next check. A drive that
        // refuses to report its demand is watched by its position alone.
        match ops.read_timed(objects::POSITION_DEMAND).await {
            Ok((demand, reply)) => {
                travel
                    .demand
                    .add(&ops.config, demand, reply.sent, reply.received);
                if let Ok((position, later)) = ops.read_timed(objects::POSITION_ACTUAL).await {
                    travel.add_position(
                        &ops.config,
                        position,
                        [reply.sent, later.sent, later.received],
                    );
                }
                ops.report(CommandProgress::Searching {
                    at: reply.received,
                    demand: Quadcounts(demand),
                });
            }
            Err(DriveError::Refused { .. }) => {
                if let Ok((position, reply)) = ops.read_timed(objects::POSITION_ACTUAL).await {
                    (travel.position).add(&ops.config, position, reply.sent, reply.received);
                }
            }
            Err(_) => {}
        }
        travel.check(&ops.config)?;
        if let Some(waited) = travel.rest(&ops.config, requested) {
            return Err(DriveError::HomingRest {
                method: homing.method,
                moved: Degrees(travel.position.angle(&ops.config)),
                waited,
            });
        }
        if switch_check.is_due(ops.now()) {
            switches.check(ops).await?;
        }
        if requested > limit {
            return Err(DriveError::HomingTime {
                method: homing.method,
                limit: homing.time_limit,
                got,
            });
        }
    }
}

/// Longest time for which neither the axis nor its demand moves in homing: a second, the brake, and
/// twice the spread of an axis at rest at the slower speed.
fn rest_limit(config: &AxisConfig) -> Span {
    let slower = config.gearing.rate(config.homing.zero_speed).0;
    let brake = config.brake.map_or(Span::ZERO, |brake| brake.rise);
    Span::from_secs_f64(2.0 * config.standstill_spread.0 / slower)
        .saturating_add(brake)
        .saturating_add(Span::from_secs(1))
}

/// The farthest that homing may move the axis: its range, the home offset and the margin, degrees.
fn travel_bound(config: &AxisConfig) -> f64 {
    let range = config.limits.max.0 - config.limits.min.0;
    range + config.homing.offset.0.abs() + config.guard.homing_margin.0
}

/// The way of the axis in homing: of the demand, and of the position, since a drive may report a
/// demand that its axis does not follow.
#[derive(Default)]
struct HomingTravel {
    demand: TravelledWay,
    position: TravelledWay,
    /// Longest time between the first readings of both, and between the latest.
    first_apart: Span,
    apart: Span,
    /// The previous position was too far from the demand.
    is_suspicious: bool,
    rest: Option<RestInHoming>,
}

/// Angles at which demand and position rest, and the start of the rest.
struct RestInHoming {
    since: Stamp<Host>,
    ways: [f64; 2],
    readings: u32,
}

/// Readings that show an axis at rest in homing: of 0.1 s without delays of the host.
const LEAST_READINGS: u32 = 5;

/// A distance from the start, qc.
#[derive(Default)]
struct TravelledWay {
    /// The latest reading, and when it was requested.
    last: Option<(i32, Stamp<Host>)>,
    travelled: i64,
}

impl TravelledWay {
    /// Adds a reading that was requested and answered at these times.
    fn add(
        &mut self,
        config: &AxisConfig,
        position: i32,
        request: Stamp<Host>,
        answer: Stamp<Host>,
    ) {
        if let Some((last, since)) = self.last.replace((position, request)) {
            let moved = i64::from(position) - i64::from(last);
            // Where the drive sets its zero the position jumps, further than the axis can move.
            let seconds = answer.saturating_since(since).as_secs_f64();
            let fastest = Degrees(2.0 * config.gearing.rate(config.max_speed).0 * seconds + 1.0);
            if moved.unsigned_abs() <= u64::from(config.tolerance_qc(fastest).0.unsigned_abs()) {
                self.travelled += moved;
            }
        }
    }

    fn angle(&self, config: &AxisConfig) -> f64 {
        let most = i64::from(i32::MAX);
        let qc = self.travelled.clamp(-most, most) as i32;
        config.gearing.angle(Quadcounts(qc)).0
    }
}

impl HomingTravel {
    /// Adds a position. Times: request of the demand before it, its own request and answer.
    fn add_position(
        &mut self,
        config: &AxisConfig,
        position: i32,
        [demand_request, request, answer]: [Stamp<Host>; 3],
    ) {
        self.apart = answer.saturating_since(demand_request);
        let is_first = self.position.last.is_none();
        self.position.add(config, position, request, answer);
        // Both ways begin together. A host that was delayed between the two readings begins them
        // again, so that the delay does not widen the tolerance for the rest of homing.
        let is_closer = self.apart + self.apart < self.first_apart;
        if is_first || is_closer && !self.is_suspicious {
            self.first_apart = self.apart;
            self.position.travelled = self.demand.travelled;
        }
    }

    /// Time for which neither the demand nor the position has moved, if that is too long: the
    /// switch may be dead, and both values frozen.
    fn rest(&mut self, config: &AxisConfig, now: Stamp<Host>) -> Option<Span> {
        let ways = [self.demand.angle(config), self.position.angle(config)];
        let spread = config.standstill_spread.0;
        let moved = |rest: &RestInHoming| {
            let apart = ways.iter().zip(&rest.ways).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max) > spread
        };
        match &mut self.rest {
            Some(rest) if !moved(rest) => rest.readings += 1,
            _ => {
                self.rest = Some(RestInHoming {
                    since: now,
                    ways,
                    readings: 0,
                });
            }
        }
        let rest = self.rest.as_ref()?;
        let waited = now.saturating_since(rest.since);
        // A delayed host has not seen what the axis did meanwhile.
        (waited > rest_limit(config) && rest.readings >= LEAST_READINGS).then_some(waited)
    }

    /// Compares the distance from the start with the range of the axis, and the way of the position
    /// with that of the demand.
    fn check(&mut self, config: &AxisConfig) -> Result<(), DriveError> {
        let (demand, position) = (self.demand.angle(config), self.position.angle(config));
        let guard = &config.guard;
        let speed = config.gearing.rate(config.homing.switch_speed).0;
        let lag = guard.servo_lag.as_secs_f64();
        let tolerance = config.standstill_spread.0
            + speed * (self.first_apart + self.apart).as_secs_f64()
            + match config.homing.detects_current() {
                // The axis is at its mechanical stop, and the demand moves on.
                true => config.max_following_error.0,
                false => (guard.behind.0 + speed * lag).min(config.max_following_error.0),
            };
        let is_off = demand != 0.0 && (position - demand).abs() > tolerance;
        // The zero may be set between the two reads.
        if std::mem::replace(&mut self.is_suspicious, is_off) && is_off {
            return Err(DriveError::OffPlan {
                deviation: match position * demand {
                    opposite if opposite < 0.0 => Deviation::WrongWay,
                    _ if position.abs() < demand.abs() => Deviation::Behind,
                    _ => Deviation::Ahead,
                },
                expected: Degrees(demand),
                got: Degrees(position),
            });
        }
        let travelled = demand.abs().max(position.abs());
        let bound = travel_bound(config);
        if travelled > bound {
            return Err(DriveError::HomingTravel {
                method: config.homing.method,
                travelled: Degrees(travelled),
                bound: Degrees(bound),
            });
        }
        Ok(())
    }
}

async fn check_result(ops: &mut Ops) -> Result<CommandOutcome, DriveError> {
    let got = check_enabled(ops).await?;
    if !is_referenced(got) {
        return Err(DriveError::NotReferenced { got });
    }
    ops.set_referenced(true);
    let position = settled_position(ops).await?;
    let angle = ops.config.gearing.angle(position);
    if !is_inside(ops, position)? {
        return Err(DriveError::Outside {
            at: angle,
            min: ops.config.limits.min,
            max: ops.config.limits.max,
        });
    }
    let (homing, guard) = (&ops.config.homing, &ops.config.guard);
    let lag = ops.config.gearing.rate(homing.switch_speed).0 * guard.servo_lag.as_secs_f64();
    let tolerance = guard.behind.0 + lag + ops.config.arrival_tolerance.0;
    if (angle.0 - homing.home_position.0).abs() > tolerance {
        return Err(DriveError::HomePosition {
            method: homing.method,
            expected: homing.home_position,
            got: angle,
        });
    }
    Ok(CommandOutcome::Homed { position, angle })
}

/// The position once it is within the limits or constant. The drive reports homing attained when
/// its demand has arrived; the axis lags behind.
async fn settled_position(ops: &mut Ops) -> Result<Quadcounts, DriveError> {
    let timing = ops.config.timing;
    let limit = ops.now().saturating_add(timing.state_limit);
    let mut last = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
    let mut since = ops.now();
    // A lagging axis comes closer.
    let ahead = ops.config.tolerance_qc(ops.config.guard.ahead).0;
    let farthest = outside(ops, last)?.saturating_add(ahead);
    while !is_inside(ops, last)? && outside(ops, last)? <= farthest {
        let requested = ops.now();
        if requested.saturating_since(since) >= timing.standstill || requested > limit {
            break;
        }
        ops.sleep(timing.status_period).await;
        let position = Quadcounts(ops.read(objects::POSITION_ACTUAL).await?);
        if position != last {
            (last, since) = (position, ops.now());
        }
    }
    Ok(last)
}

/// Quadcounts beyond the limits, negative within.
fn outside(ops: &Ops, position: Quadcounts) -> Result<i32, DriveError> {
    let limits = ops.config.limits_qc()?;
    let above = position.0.saturating_sub(limits.max.0);
    Ok(limits.min.0.saturating_sub(position.0).max(above))
}

/// Whether a position is within the limits and the arrival tolerance.
fn is_inside(ops: &Ops, position: Quadcounts) -> Result<bool, DriveError> {
    let tolerance = ops.config.tolerance_qc(ops.config.arrival_tolerance);
    Ok(outside(ops, position)? <= tolerance.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads demand and position of an axis that homes at 20 deg/s: every 20 ms, each reading
    /// takes a millisecond, and after `delayed` demands the host does not run for 0.5 s.
    fn homing(delayed: &[i64], angle: impl Fn(f64) -> f64) -> Result<(), DriveError> {
        let config = AxisConfig::default();
        let qc = |angle| config.gearing.position(Degrees(angle)).unwrap().0;
        let at = |ms: i64| Stamp::from_nanos(ms * 1_000_000);
        let demand = |ms: i64| 0.02 * ms as f64;
        let mut travel = HomingTravel::default();
        let mut now = 0;
        for number in 0..60 {
            let sampled = demand(now);
            travel
                .demand
                .add(&config, qc(sampled), at(now), at(now + 1));
            let delay = if delayed.contains(&number) { 500 } else { 1 };
            let times = [at(now), at(now + delay), at(now + delay + 1)];
            travel.add_position(&config, qc(angle(demand(now + delay))), times);
            travel.check(&config)?;
            now += delay + 20;
        }
        Ok(())
    }

    #[test]
    fn a_delayed_host_is_no_deviation() {
        for delayed in [&[][..], &[0], &[7], &[0, 1, 7, 8]] {
            assert!(homing(delayed, |demand| demand).is_ok(), "{delayed:?}");
        }
    }

    /// Without delays, and after one that began the comparison.
    #[test]
    fn a_deviation_is_found_behind_a_delay() {
        for delayed in [&[][..], &[0]] {
            let stalled = homing(delayed, |demand| demand.min(11.0));
            let Err(DriveError::OffPlan { expected, .. }) = stalled else {
                panic!("{stalled:?}");
            };
            assert!(expected.0 < 16.0, "{expected:?}");
        }
    }
}
