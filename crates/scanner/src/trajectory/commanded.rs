//! The motion that was commanded.

use super::choose::Candidates;
use super::profile::Profile;

impl Candidates<'_> {
    /// The commanded motion, completed by the sweep's ends.
    pub(super) fn guess(&self) -> Option<Profile> {
        let sweep = self.sweep;
        let way_deg = sweep.to.0 - sweep.from.0;
        let duration_s = sweep.end.saturating_since(sweep.start).as_secs_f64();
        let commanded = sweep.commanded;
        let speed = match commanded.speed.0.abs() {
            speed if speed > 0.0 => speed,
            _ => sweep.cruise.0.abs(),
        };
        let speed = if speed > 0.0 {
            speed
        } else {
            way_deg.abs() / duration_s
        };
        let measured = (duration_s - way_deg.abs() / speed).max(duration_s * 1e-3);
        let ramp = |rate: f64| if rate > 0.0 { speed / rate } else { measured };
        let (mut up, mut down) = (
            ramp(commanded.acceleration.0),
            ramp(commanded.deceleration.0),
        );
        let mut speed_deg_s = speed.copysign(way_deg);
        // Too short for the cruise: both ramps shrink alike, and with them the speed.
        let part = (way_deg / speed_deg_s) / ((up + down) / 2.0);
        if part < 1.0 {
            (up, down, speed_deg_s) = (
                up * part.sqrt(),
                down * part.sqrt(),
                speed_deg_s * part.sqrt(),
            );
            // Just enough to count as a triangle.
            speed_deg_s *= 1.0 + 1e-9;
        }
        let is_motion = way_deg != 0.0 && [up, down, speed_deg_s].iter().all(|x| x.is_finite());
        is_motion.then_some(Profile {
            start_s: sweep.start.saturating_since(self.origin).as_secs_f64(),
            speed_deg_s,
            ramp_up_s: up,
            ramp_down_s: down,
            from_deg: sweep.from.0,
            way_deg,
            lag_s: 0.0,
            inertia_s2: 0.0,
        })
    }
}
