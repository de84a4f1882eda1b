//! The axis as it moves, told twenty times a second.

use std::time::{Duration, Instant};

use drive::{CommandProgress, MovePlan};
use units::{Degrees, Gearing, Host, Stamp};

use super::hub::Event;
use super::shared::Shared;

/// Between two messages.
const PAUSE: Duration = Duration::from_millis(50);

/// Follows samples of the shaft.
pub struct Motions<'a> {
    shared: &'a Shared,
    told: Option<(Instant, Stamp<Host>, Degrees)>,
    until: Option<Instant>,
    /// Whether the axis knew where it was before it began to search its home.
    referenced: bool,
}

impl<'a> Motions<'a> {
    /// Tells through `shared`.
    #[must_use]
    pub const fn new(shared: &'a Shared) -> Self {
        Self {
            shared,
            told: None,
            until: None,
            referenced: false,
        }
    }

    /// The drive's client says how far it is, moves to a plan left out.
    pub fn progress(&mut self, step: &CommandProgress, gearing: &Gearing) {
        match step {
            CommandProgress::Homing => {
                let known = self.shared.report();
                self.referenced = known.is_some_and(|report| report.referenced);
                self.shared.note(|activity| activity.homes = true);
                self.shared.tell_status();
            }
            // An axis that has lost its zero is somewhere.
            CommandProgress::Searching { at, demand } if self.referenced => {
                let packets = self.shared.activity().packets;
                self.moved(*at, gearing.angle(*demand), packets);
            }
            step => {
                self.shared.beat();
                tracing::debug!(?step);
            }
        }
    }

    /// A move begins: number `step` of `steps`.
    pub fn begin(&mut self, plan: &MovePlan, step: usize, steps: usize) {
        let seconds = plan.duration.as_secs_f64().max(0.0);
        self.until = Duration::try_from_secs_f64(seconds)
            .ok()
            .and_then(|duration| Instant::now().checked_add(duration));
        self.shared.note(|activity| {
            activity.step = step;
            activity.steps = steps;
            activity.from_deg = Some(plan.from.0);
            activity.to_deg = Some(plan.to.0);
            activity.left_s = Some(seconds);
            activity.homes = false;
        });
        self.shared.tell_status();
    }

    /// The axis was at `angle` at `at`.
    pub fn moved(&mut self, at: Stamp<Host>, angle: Degrees, packets: u64) {
        let mut speed = 0.0;
        if let Some((when, before, from)) = self.told {
            if when.elapsed() < PAUSE {
                return;
            }
            let seconds = at.saturating_since(before).as_secs_f64();
            if seconds > 0.0 {
                speed = (angle.0 - from.0) / seconds;
            }
        }
        self.told = Some((Instant::now(), at, angle));
        self.shared.beat();
        self.tell(at, angle, speed, packets);
    }

    fn tell(&self, at: Stamp<Host>, angle: Degrees, speed_deg_s: f64, packets: u64) {
        let left_s = self.until.map(|until| {
            until
                .saturating_duration_since(Instant::now())
                .as_secs_f64()
        });
        self.shared.note(|activity| {
            activity.left_s = left_s;
            activity.packets = packets;
        });
        self.shared.set_drive(|drive| {
            drive.angle_deg = Some(angle.0);
            drive.speed_deg_s = speed_deg_s;
        });
        self.shared.hub.tell(Event::Motion {
            angle_deg: angle.0,
            speed_deg_s,
            left_s,
            packets,
            at,
        });
    }

    /// The axis stands.
    pub fn end(&mut self) {
        self.until = None;
        if let Some((_, at, angle)) = self.told.take() {
            self.tell(at, angle, 0.0, self.shared.activity().packets);
        }
    }
}
