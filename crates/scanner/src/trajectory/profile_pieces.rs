//! A fitted motion as cubics.

use units::{Host, Span, Stamp};

use super::pieces::{CubicPiece, PiecewiseCubic};
use super::profile_fit::ProfileFit;

/// Limit of pieces for one servo's response.
const MAX_PIECES: usize = 4_000;

/// A profile as cubics from the origin until `end_s`: its corners, and steps behind them that grow
/// as the servo's response decays.
pub(super) fn of_profile(
    fit: &ProfileFit,
    origin: Stamp<Host>,
    end_s: f64,
) -> Option<PiecewiseCubic> {
    let profile = &fit.profile;
    let mut at = vec![0.0, end_s];
    let corners = profile.corners_s();
    for corner in corners {
        at.push(corner);
        let inertia = profile.inertia_s2;
        let (mut since, lag) = (0.0, profile.lag_s);
        // Time constant of the response, and its duration.
        let quick = if inertia > 0.0 {
            lag.min(inertia.sqrt())
        } else {
            lag
        };
        let over = if lag > 0.0 {
            lag.max(2.0 * inertia / lag)
        } else {
            0.0
        };
        // Hermite's error is (step / time constant)^4 / 384 of the response: below 1e-6 degrees for
        // any servo.
        while quick > 0.0 && since < 20.0 * over && at.len() < MAX_PIECES {
            since += quick / 8.0 * f64::exp((since / over / 4.0).min(3.0));
            at.push(corner + since);
        }
    }
    // The standard deviation varies along the cruise.
    let [_, up, brake, _] = corners;
    at.extend((1..32).map(|k| up + (brake - up) * f64::from(k) / 32.0));
    at.retain(|s| (0.0..=end_s).contains(s));
    at.sort_by(f64::total_cmp);
    let stamps: Vec<Stamp<Host>> = at
        .iter()
        .map(|s| origin.saturating_add(Span::from_secs_f64(*s)))
        .collect();
    let pieces = stamps.windows(2).filter_map(|pair| match pair {
        [a, b] if a < b => {
            let [from_s, to_s] = [a, b].map(|s| s.saturating_since(origin).as_secs_f64());
            let ns = b.saturating_since(*a).as_nanos() as f64;
            // At a corner of a profile without lag the acceleration jumps, but not the speed.
            let ends = [from_s, to_s].map(|s| {
                let (angle_deg, rate_deg_s) = profile.place(s);
                [angle_deg, rate_deg_s * 1e-9]
            });
            let sd = fit.sd_deg(0.5 * (from_s + to_s));
            Some(CubicPiece::hermite(*a, ns, ends[0], ends[1]).with_sd(sd))
        }
        _ => None,
    });
    PiecewiseCubic::new(pieces.collect(), *stamps.last()?)
}
