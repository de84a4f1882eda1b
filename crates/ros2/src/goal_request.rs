//! Goals of actions as requests to the daemon, and the results and progress that answer them.

use cloud::messages::actions::{GoalId, GoalStatus};
use cloud::messages::cdr::{Cdr, CdrError, CdrReader};
use engine::capture::jog::{GotoRequest, JogRequest};
use engine::capture_request::CaptureRequest;
use engine::failure::{Failure, Kind};

use crate::actions::Action;

/// Longest request, bytes.
pub(crate) const LONGEST: usize = 4096;

/// What a goal asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GoalRequest {
    /// A capture.
    Capture(CaptureRequest),
    /// A move of the axis.
    Move(JogRequest),
}

/// What a goal reached.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum GoalResult {
    /// Of a capture: the scan's id, its state, and its points.
    Capture {
        scan: String,
        state: &'static str,
        points: u64,
    },
    /// Of a move: angle of the axis, degrees; NaN if unknown.
    Move { angle_deg: f64 },
}

fn usage(error: &CdrError) -> Failure {
    Failure::new(Kind::Usage, error.to_string())
}

/// Reads a request that is not too long.
fn reader(payload: &[u8]) -> Result<CdrReader<'_>, Failure> {
    if payload.len() > LONGEST {
        let text = format!("expected a request of at most {LONGEST} bytes, got more");
        return Err(Failure::new(Kind::Usage, text));
    }
    CdrReader::new(payload).map_err(|error| usage(&error))
}

/// Reads a request with `read`.
pub(crate) fn read<T>(
    payload: &[u8],
    read: impl FnOnce(&mut CdrReader<'_>) -> Result<T, CdrError>,
) -> Result<T, Failure> {
    read(&mut reader(payload)?).map_err(|error| usage(&error))
}

/// Reads the request of `send_goal`. The daemon checks the numbers against the limits of the axis.
pub(crate) fn read_goal(action: Action, payload: &[u8]) -> Result<(GoalId, GoalRequest), Failure> {
    let mut cdr = reader(payload)?;
    let id = cdr.array().map_err(|error| usage(&error))?;
    let request = match action {
        Action::Capture => capture(&mut cdr).map(GoalRequest::Capture),
        Action::MoveTilt => jog(&mut cdr).map(GoalRequest::Move),
    };
    Ok((id, request?))
}

fn capture(cdr: &mut CdrReader<'_>) -> Result<CaptureRequest, Failure> {
    let mut read = || -> Result<_, CdrError> {
        let speed = cdr.optional(CdrReader::finite)?;
        let request = CaptureRequest {
            speed_deg_s: speed.unwrap_or_default(),
            from_deg: cdr.optional(CdrReader::finite)?,
            to_deg: cdr.optional(CdrReader::finite)?,
            accel_deg_s2: cdr.optional(CdrReader::finite)?,
            sweeps: cdr.optional(CdrReader::u32)?,
            both_ways: cdr.optional(CdrReader::u8)?.is_some_and(|value| value != 0),
            tolerance: cdr.optional(CdrReader::string)?,
            name: cdr.optional(CdrReader::string)?,
        };
        Ok(speed.map(|_| request))
    };
    let request = read().map_err(|error| usage(&error))?;
    request.ok_or_else(|| Failure::new(Kind::Usage, "speed_deg_s: expected a speed, got none"))
}

fn jog(cdr: &mut CdrReader<'_>) -> Result<JogRequest, Failure> {
    let mut read = || -> Result<_, CdrError> {
        Ok((
            cdr.u8()? != 0,
            cdr.optional(CdrReader::finite)?,
            cdr.optional(CdrReader::finite)?,
        ))
    };
    match read().map_err(|error| usage(&error))? {
        (true, None, None) => Ok(JogRequest::Home),
        (false, Some(to_deg), speed_deg_s) => Ok(JogRequest::Goto(GotoRequest {
            to_deg,
            speed_deg_s: speed_deg_s.unwrap_or_else(GotoRequest::default_speed),
            accel_deg_s2: None,
        })),
        (home, ..) => Err(Failure::new(
            Kind::Usage,
            format!("expected home alone, or an angle in to_deg; got home = {home}"),
        )),
    }
}

/// Response of `get_result`; without a result that of a goal that did not begin.
pub(crate) fn result_response(
    action: Action,
    status: GoalStatus,
    result: Option<&GoalResult>,
    message: &str,
) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.u8(status as u8);
    match (action, result) {
        (Action::Capture, result) => {
            let (scan, state, points) = match result {
                Some(GoalResult::Capture {
                    scan,
                    state,
                    points,
                }) => (scan.as_str(), *state, *points),
                _ => ("", "", 0),
            };
            cdr.string(scan);
            cdr.string(state);
            cdr.u64(points);
        }
        (Action::MoveTilt, Some(GoalResult::Move { angle_deg })) => cdr.f64(*angle_deg),
        (Action::MoveTilt, _) => cdr.f64(f64::NAN),
    }
    cdr.string(message);
    cdr
}

/// Message about a goal's progress. Only captures have numbers of moves.
pub(crate) fn feedback_message(
    action: Action,
    goal: &GoalId,
    (step, steps): (usize, usize),
    (angle_deg, left_s): (f64, Option<f64>),
) -> Cdr {
    let mut cdr = Cdr::new();
    cdr.array(goal);
    if action == Action::Capture {
        cdr.u32(u32::try_from(step).unwrap_or(u32::MAX));
        cdr.u32(u32::try_from(steps).unwrap_or(u32::MAX));
    }
    cdr.f64(angle_deg);
    cdr.f64(left_s.unwrap_or(f64::NAN));
    cdr
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(cdr: &mut Cdr, values: &[Option<f64>]) {
        for value in values {
            cdr.length(value.iter().len());
            value.iter().for_each(|value| cdr.f64(*value));
        }
    }

    fn capture_goal(values: [Option<f64>; 4], name: &str) -> Vec<u8> {
        let mut cdr = Cdr::new();
        cdr.array(&[7; 16]);
        options(&mut cdr, &values);
        cdr.length(1);
        cdr.u32(3);
        cdr.length(1);
        cdr.u8(1);
        cdr.length(0);
        cdr.length(1);
        cdr.string(name);
        cdr.bytes().to_vec()
    }

    #[test]
    fn captures_are_read_with_their_options() {
        let goal = capture_goal([Some(20.0), Some(-10.0), None, None], "hall");
        let expected = CaptureRequest {
            speed_deg_s: 20.0,
            from_deg: Some(-10.0),
            sweeps: Some(3),
            both_ways: true,
            name: Some("hall".to_owned()),
            ..CaptureRequest::default()
        };
        let read = read_goal(Action::Capture, &goal).unwrap();
        assert_eq!(read, ([7; 16], GoalRequest::Capture(expected)));
        for end in 0..goal.len() {
            assert!(read_goal(Action::Capture, &goal[..end]).is_err(), "{end}");
        }
    }

    #[test]
    fn goals_with_invalid_values_are_refused() {
        let of = |values, name: &str| {
            let goal = capture_goal(values, name);
            read_goal(Action::Capture, &goal).unwrap_err().message
        };
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..4 {
                let mut values = [Some(20.0); 4];
                values[place] = Some(value);
                assert!(of(values, "").contains("a finite number"));
            }
        }
        assert!(of([None; 4], "").contains("expected a speed"));
        assert!(of([Some(20.0); 4], &"n".repeat(LONGEST)).contains("at most 4096 bytes"));
        // A length beyond the end of the message reserves no memory.
        let mut goal = capture_goal([Some(20.0); 4], "hall");
        let length = goal.len() - 9;
        goal[length..length + 4].fill(255);
        assert!(read_goal(Action::Capture, &goal).is_err());
    }

    #[test]
    fn a_move_is_home_or_to_an_angle() {
        let of = |home: u8, values: [Option<f64>; 2]| {
            let mut cdr = Cdr::new();
            cdr.array(&[7; 16]);
            cdr.u8(home);
            options(&mut cdr, &values);
            read_goal(Action::MoveTilt, cdr.bytes())
        };
        let home = GoalRequest::Move(JogRequest::Home);
        assert_eq!(of(1, [None, None]).unwrap().1, home);
        let to = GoalRequest::Move(JogRequest::Goto(GotoRequest {
            to_deg: -20.0,
            speed_deg_s: 10.0,
            accel_deg_s2: None,
        }));
        assert_eq!(of(0, [Some(-20.0), None]).unwrap().1, to);
        for (home, values) in [
            (0, [None, None]),
            (0, [None, Some(5.0)]),
            (1, [Some(0.0), None]),
            (1, [None, Some(5.0)]),
            (0, [Some(f64::NAN), None]),
            (0, [Some(0.0), Some(f64::INFINITY)]),
        ] {
            assert_eq!(of(home, values).unwrap_err().kind, Kind::Usage);
        }
    }
}
