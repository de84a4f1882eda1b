//! The moves of a capture: what is asked of the axis, checked before a device is touched, and how it is then run.

use drive::{AxisConfig, Command, Event, Plan};
use io::port::Port;
use units::{DegPerS, DegPerS2, Degrees};

use crate::devices::drive_session::{Session, SessionError};
use crate::failure::{Failure, Kind};

/// What was asked for.
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
    /// How many sweeps.
    pub sweeps: u32,
    /// Whether the way back is a sweep too.
    pub both_ways: bool,
}

/// One move of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// As the drive will run it.
    pub plan: Plan,
    /// Whether the lidar's returns during it become points.
    pub sweep: bool,
}

/// The moves that fulfil a wish, from an axis that stands at `home`.
///
/// # Errors
/// [`Kind::Usage`] for speeds, accelerations and angles that this axis cannot do.
pub fn steps(wish: &SweepRequest, axis: &AxisConfig, home: Degrees) -> Result<Vec<Step>, Failure> {
    let refuse =
        |error: drive::DriveError| Failure::new(Kind::Usage, error.to_string()).help(error.help());
    let plan = |from, to| {
        axis.plan(from, to, wish.speed, wish.acceleration)
            .map_err(refuse)
    };
    // Both ends are checked before anything else, whatever the order of the moves.
    plan(wish.to, wish.from)?;
    let there = plan(wish.from, wish.to)?;
    if there.from == there.to {
        return Err(Failure::new(
            Kind::Usage,
            format!(
                "a sweep from {} to {} deg goes nowhere",
                wish.from.0, wish.to.0
            ),
        )
        .help("choose two different angles with --from and --to"));
    }
    let mut steps = Vec::new();
    let mut at = home;
    let mut ends = (wish.from, wish.to);
    for _ in 0..wish.sweeps {
        let approach = plan(at, ends.0)?;
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
        at = ends.1;
        if wish.both_ways {
            ends = (ends.1, ends.0);
        }
    }
    Ok(steps)
}

/// What a watcher of the motion is told.
pub enum Told<'a> {
    /// A step begins.
    Step(&'a Step),
    /// The client's own words.
    Event(&'a Event),
}

/// Connects, homes, makes every step, and leaves the axis disabled with its brake set.
///
/// # Errors
/// [`SessionError`]; the axis has been stopped unless the error says that it could not be.
pub fn run<P: Port>(
    session: &mut Session<P>,
    steps: &[Step],
    told: &mut dyn FnMut(Told<'_>),
) -> Result<(), SessionError> {
    for command in [Command::Connect, Command::Home] {
        session.run(command, &mut |event| told(Told::Event(event)))?;
    }
    for step in steps {
        told(Told::Step(step));
        let to = drive::Move {
            to: step.plan.to,
            speed: step.plan.speed,
            acceleration: step.plan.acceleration,
        };
        let command = if step.sweep {
            Command::Sweep(to)
        } else {
            Command::Goto(to)
        };
        session.run(command, &mut |event| told(Told::Event(event)))?;
    }
    session.run(Command::Brake, &mut |event| told(Told::Event(event)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish() -> SweepRequest {
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
        crate::devices::profile::axis(&crate::config::Axis::default()).unwrap()
    }

    fn ways(wish: SweepRequest, home: f64) -> Vec<(f64, f64, bool)> {
        steps(&wish, &axis(), Degrees(home))
            .unwrap()
            .iter()
            .map(|s| (s.plan.from.0, s.plan.to.0, s.sweep))
            .collect()
    }

    #[test]
    fn one_sweep_from_home_is_one_move() {
        assert_eq!(ways(wish(), 0.0), [(0.0, -45.0, true)]);
    }

    #[test]
    fn sweeps_one_way_go_back_in_between() {
        let wish = SweepRequest {
            sweeps: 2,
            ..wish()
        };
        assert_eq!(
            ways(wish, 0.0),
            [(0.0, -45.0, true), (-45.0, 0.0, false), (0.0, -45.0, true)]
        );
    }

    #[test]
    fn both_ways_every_move_is_a_sweep_once_there() {
        let wish = SweepRequest {
            sweeps: 3,
            both_ways: true,
            from: Degrees(-45.0),
            to: Degrees(-15.0),
            ..wish()
        };
        assert_eq!(
            ways(wish, 0.0),
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
        let steps = steps(&wish(), &axis(), Degrees(0.0)).unwrap();
        let plan = steps[0].plan;
        assert_eq!(plan.speed.0, 1125);
        assert!((plan.duration.as_secs_f64() - (0.8 + 56.25 / 500.0)).abs() < 1e-6);
    }

    #[test]
    fn what_the_axis_cannot_do_is_refused() {
        let tries = [
            SweepRequest {
                to: Degrees(-45.1),
                ..wish()
            },
            SweepRequest {
                from: Degrees(0.1),
                ..wish()
            },
            SweepRequest {
                speed: DegPerS(0.0),
                ..wish()
            },
            SweepRequest {
                speed: DegPerS(100.0),
                ..wish()
            },
            SweepRequest {
                speed: DegPerS(f64::NAN),
                ..wish()
            },
            SweepRequest {
                acceleration: DegPerS2(-1.0),
                ..wish()
            },
            SweepRequest {
                to: Degrees(0.0),
                ..wish()
            },
        ];
        for wish in tries {
            let failure = steps(&wish, &axis(), Degrees(0.0)).unwrap_err();
            assert_eq!(failure.kind, Kind::Usage, "{wish:?}");
            assert!(failure.help.is_some(), "{wish:?}");
        }
    }
}
