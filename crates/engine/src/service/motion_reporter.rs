//! Reports of the moving axis, 20 times per second.

use std::time::{Duration, Instant};

use drive::{CommandProgress, DriveEvent, MovePlan};
use units::{Degrees, Host, Stamp};

use super::DeviceService;
use super::axis_report::{is_referenced, state_name};
use super::events::{Event, MessageLevel};

/// Between two reports.
const INTERVAL: Duration = Duration::from_millis(50);

/// Turns samples of the shaft into status and events.
pub(super) struct MotionReporter<'a> {
    service: &'a DeviceService,
    last: Option<(Instant, Stamp<Host>, Degrees)>,
    /// Planned end of the move.
    until: Option<Instant>,
    /// Whether the axis was homed before it began to search its home again.
    referenced: bool,
    warnings: Vec<String>,
}

impl<'a> MotionReporter<'a> {
    pub(super) const fn new(service: &'a DeviceService) -> Self {
        Self {
            service,
            last: None,
            until: None,
            referenced: false,
            warnings: Vec::new(),
        }
    }

    /// The warnings so far, each with what to do about it.
    pub(super) fn into_warnings(self) -> Vec<String> {
        self.warnings
    }

    fn warn(&mut self, text: &str, help: Option<&str>) {
        let help = help.map(str::to_owned);
        self.warnings.push(match &help {
            Some(help) => format!("{text}; {help}"),
            None => text.to_owned(),
        });
        let events = self.service.events();
        events.message(MessageLevel::Warning, text, help);
    }

    /// Takes in an event of the drive client, except the start of a move. `packets` counts those of
    /// the lidar in this capture.
    pub(super) fn event(&mut self, event: &DriveEvent, packets: u64) {
        let gearing = self.service.axis.gearing;
        match event {
            DriveEvent::Sample(sample) => {
                self.moved(sample.answer, gearing.angle(sample.position), packets);
            }
            DriveEvent::Progress(CommandProgress::Homing) => {
                self.referenced = self.service.is_referenced();
                self.service
                    .update_activity(|activity| activity.homes = true);
                self.service.send_status();
            }
            // The demand counts from the old zero, which must be known.
            DriveEvent::Progress(CommandProgress::Searching { at, demand }) if self.referenced => {
                let packets = self.service.activity().received;
                self.moved(*at, gearing.angle(*demand), packets);
            }
            DriveEvent::Progress(CommandProgress::Statusword(word)) => self.statusword(*word),
            DriveEvent::Progress(CommandProgress::PowerCut) => self.warn(
                "the quick stop did not stop the axis; switching its power off did",
                Some("check the drive's settings and what moves the axis before it moves again"),
            ),
            DriveEvent::Progress(CommandProgress::MovedAfterPowerOff(moved)) => self.warn(
                &format!(
                    "the axis moved by {:.2} deg after its power was switched off",
                    moved.0
                ),
                Some(
                    "check the brake (brake_output, its polarity and supply); without one set \
                     without_brake = \"hold\" in [axis], or balance the head",
                ),
            ),
            DriveEvent::Progress(CommandProgress::StoppedAtTarget(silent)) => self.warn(
                &format!(
                    "the drive was silent for {:.0} ms at the end of the move: the axis was \
                     stopped, and rests at its target",
                    silent.as_secs_f64() * 1e3
                ),
                None,
            ),
            event => {
                if matches!(event, DriveEvent::Progress(_)) {
                    self.service.heartbeat();
                }
                tracing::debug!(?event);
            }
        }
    }

    /// Takes in the start of move number `step` of `steps`.
    pub(super) fn begin(&mut self, plan: &MovePlan, step: usize, steps: usize) {
        let seconds = plan.duration.as_secs_f64().max(0.0);
        self.until = Duration::try_from_secs_f64(seconds)
            .ok()
            .and_then(|duration| Instant::now().checked_add(duration));
        self.service.update_activity(|activity| {
            activity.step = step;
            activity.steps = steps;
            activity.from_deg = Some(plan.from.0);
            activity.to_deg = Some(plan.to.0);
            activity.left_s = Some(seconds);
            activity.homes = false;
        });
        self.service.send_status();
    }

    /// Takes in the drive's state.
    fn statusword(&self, word: u16) {
        self.service.heartbeat();
        let mut is_new = false;
        self.service.state.send_modify(|state| {
            is_new = state.statusword.replace(word) != Some(word);
            state.live_at = Some(Instant::now());
            if is_new {
                state.drive.cia402 = Some(state_name(word));
                state.drive.referenced = is_referenced(word);
            }
        });
        if is_new {
            self.service.send_status();
        }
    }

    /// Takes in the axis's angle at a time.
    fn moved(&mut self, at: Stamp<Host>, angle: Degrees, packets: u64) {
        let mut speed = 0.0;
        if let Some((reported, before, from)) = self.last {
            if reported.elapsed() < INTERVAL {
                return;
            }
            let seconds = at.saturating_since(before).as_secs_f64();
            if seconds > 0.0 {
                speed = (angle.0 - from.0) / seconds;
            }
        }
        self.last = Some((Instant::now(), at, angle));
        self.service.heartbeat();
        self.report(at, angle, speed, packets);
    }

    fn report(&self, at: Stamp<Host>, angle: Degrees, speed_deg_s: f64, packets: u64) {
        let left_s = self.until.map(|until| {
            until
                .saturating_duration_since(Instant::now())
                .as_secs_f64()
        });
        self.service.state.send_modify(|state| {
            state.activity.left_s = left_s;
            state.activity.received = packets;
            state.live_at = Some(Instant::now());
            state.drive.angle_deg = Some(angle.0);
            state.drive.speed_deg_s = speed_deg_s;
        });
        self.service.events.send(Event::Motion {
            angle_deg: angle.0,
            speed_deg_s,
            left_s,
            received: packets,
            at,
        });
    }

    /// Takes in the end of the motion.
    pub(super) fn end(&mut self) {
        self.until = None;
        if let Some((_, at, angle)) = self.last.take() {
            self.report(at, angle, 0.0, self.service.activity().received);
        }
    }
}
