//! The moves of a capture.

use drive::{AxisConfig, MovePlan};
use units::{DegPerS, DegPerS2, Degrees};

use crate::failure::{Failure, Kind};

/// Requested sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SweepRequest {
    /// Angle where sweeps start.
    pub from: Degrees,
    /// Angle where sweeps end.
    pub to: Degrees,
    /// Cruise speed.
    pub speed: DegPerS,
    /// Acceleration.
    pub acceleration: DegPerS2,
    /// Number of sweeps.
    pub sweeps: u32,
    /// Whether the return move is a sweep too.
    pub both_ways: bool,
}

/// One move of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Step {
    /// Motion as the drive will run it.
    pub plan: MovePlan,
    /// Whether returns during the move become points.
    pub sweep: bool,
}

/// Plans the moves from an axis at `home`.
///
/// # Errors
/// [`Kind::Usage`] for speeds, accelerations and angles outside the axis's limits.
pub fn steps(
    request: &SweepRequest,
    axis: &AxisConfig,
    home: Degrees,
) -> Result<Vec<Step>, Failure> {
    let refuse =
        |error: drive::DriveError| Failure::new(Kind::Usage, error.to_string()).help(error.help());
    let plan = |from, to| {
        axis.plan(from, to, request.speed, request.acceleration)
            .map_err(refuse)
    };
    // Both ends are checked before the first move.
    let end = |flag: &str, from, to| {
        let planned = axis.plan(from, to, request.speed, request.acceleration);
        planned.map_err(|error| match error {
            drive::DriveError::Limits { .. } => {
                Failure::new(Kind::Usage, format!("{flag}: {error}")).help(error.help())
            }
            _ => refuse(error),
        })
    };
    end("--from", request.to, request.from)?;
    let first = end("--to", request.from, request.to)?;
    if first.from == first.to {
        return Err(Failure::new(
            Kind::Usage,
            format!(
                "a sweep from {} to {} deg has no length",
                request.from.0, request.to.0
            ),
        )
        .help("choose two different angles with --from and --to"));
    }
    let mut steps = Vec::new();
    let mut position = home;
    let mut ends = (request.from, request.to);
    for _ in 0..request.sweeps {
        let approach = plan(position, ends.0)?;
        if approach.from != approach.to {
            steps.push(Step {
                plan: approach,
                sweep: false,
            });
        }
        steps.push(Step {
            plan: plan(ends.0, ends.1)?,
            sweep: true,
        });
        position = ends.1;
        if request.both_ways {
            ends = (ends.1, ends.0);
        }
    }
    Ok(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request() -> SweepRequest {
        SweepRequest {
            from: Degrees(0.0),
            to: Degrees(-45.0),
            speed: DegPerS(56.25),
            acceleration: DegPerS2(500.0),
            sweeps: 1,
            both_ways: false,
        }
    }

    fn axis() -> AxisConfig {
        crate::devices::profile::axis(&crate::config::AxisSettings::default()).unwrap()
    }

    fn ways(request: SweepRequest, home: f64) -> Vec<(f64, f64, bool)> {
        steps(&request, &axis(), Degrees(home))
            .unwrap()
            .iter()
            .map(|s| (s.plan.from.0, s.plan.to.0, s.sweep))
            .collect()
    }

    #[test]
    fn a_sweep_from_home_is_one_move() {
        assert_eq!(ways(request(), 0.0), [(0.0, -45.0, true)]);
    }

    #[test]
    fn one_way_sweeps_return_in_between() {
        let request = SweepRequest {
            sweeps: 2,
            ..request()
        };
        assert_eq!(
            ways(request, 0.0),
            [(0.0, -45.0, true), (-45.0, 0.0, false), (0.0, -45.0, true)]
        );
    }

    #[test]
    fn every_move_of_both_ways_is_a_sweep_after_the_approach() {
        let request = SweepRequest {
            sweeps: 3,
            both_ways: true,
            from: Degrees(-45.0),
            to: Degrees(-15.0),
            ..request()
        };
        assert_eq!(
            ways(request, 0.0),
            [
                (0.0, -45.0, false),
                (-45.0, -15.0, true),
                (-15.0, -45.0, true),
                (-45.0, -15.0, true)
            ]
        );
    }

    #[test]
    fn the_papers_scan_takes_0_9_seconds_with_the_drives_factory_ramps() {
        let steps = steps(&request(), &axis(), Degrees(0.0)).unwrap();
        let plan = steps[0].plan;
        assert_eq!(plan.speed.0, 1125);
        assert!((plan.duration.as_secs_f64() - (0.8 + 56.25 / 500.0)).abs() < 1e-6);
    }

    #[test]
    fn moves_outside_the_limits_of_the_axis_are_refused() {
        let tries = [
            SweepRequest {
                to: Degrees(-45.1),
                ..request()
            },
            SweepRequest {
                from: Degrees(0.1),
                ..request()
            },
            SweepRequest {
                speed: DegPerS(0.0),
                ..request()
            },
            SweepRequest {
                speed: DegPerS(100.0),
                ..request()
            },
            SweepRequest {
                speed: DegPerS(f64::NAN),
                ..request()
            },
            SweepRequest {
                acceleration: DegPerS2(-1.0),
                ..request()
            },
            SweepRequest {
                to: Degrees(0.0),
                ..request()
            },
        ];
        for request in tries {
            let failure = steps(&request, &axis(), Degrees(0.0)).unwrap_err();
            assert_eq!(failure.kind, Kind::Usage, "{request:?}");
            assert!(failure.help.is_some(), "{request:?}");
        }
    }
}
