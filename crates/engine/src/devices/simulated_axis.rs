//! The mechanics around the simulated drive: where its switches, mechanical stops and index pulses
//! are, and where the shaft stands at power-on.
//!
//! They are placed so that homing as configured finds its reference where the configuration says
//! that it is. What homing does not look for is there all the same, as on a real axis: a limit
//! switch at least a degree beyond either end, a home switch in the middle (input 4, the factory's
//! choice), mechanical stops 15 degrees behind the limit switches. Left out: friction, load, play.

use drive::AxisConfig;
use firmware_sim::epos2::{Region, SimulatedDriveConfig, Switch};
use units::Degrees;

/// Digital input of the home switch (2070:4 from the factory).
const HOME_INPUT: u8 = 4;
/// Distance from the ends of the axis to its limit switches, and width of the home switch.
const DEGREE: Degrees = Degrees(1.0);
/// From a limit switch to the mechanical stop behind it.
const TO_STOP: Degrees = Degrees(15.0);

/// World positions, qc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Places {
    /// The lower limit switch is pressed here and below.
    low: i32,
    /// The upper limit switch is pressed here and above.
    high: i32,
    /// The home switch is pressed from the first to the second.
    home: (i32, i32),
    stops: (i32, i32),
    /// One of the index pulses.
    index: i32,
    /// At power-on.
    start: i32,
}

/// The simulated drive of an axis: encoder, switches and stops where homing expects them, and the
/// shaft some way below the upper limit.
#[must_use]
pub fn node(axis: &AxisConfig) -> SimulatedDriveConfig {
    let places = Places::of(axis);
    let switches = axis.limit_switches;
    let switch = |input: Option<u8>, pressed, normally_closed| {
        input.map(|input| Switch {
            input,
            pressed,
            normally_closed,
        })
    };
    let taken = [switches.negative, switches.positive].contains(&Some(HOME_INPUT));
    let (from, to) = places.home;
    SimulatedDriveConfig {
        node_id: axis.node,
        qc_per_turn: axis.gearing.qc_per_motor_turn(),
        initial_position: places.start,
        index_position: places.index,
        hard_stops: [Some(places.stops.0), Some(places.stops.1)],
        switches: [
            switch(
                switches.negative,
                Region::AtMost(places.low),
                switches.active_low,
            ),
            switch(
                switches.positive,
                Region::AtLeast(places.high),
                switches.active_low,
            ),
            switch(
                (!taken).then_some(HOME_INPUT),
                Region::Within(from, to),
                false,
            ),
            None,
        ],
        ..SimulatedDriveConfig::default()
    }
}

impl Places {
    fn of(axis: &AxisConfig) -> Self {
        let qc = |angle: Degrees| axis.gearing.position(angle).map_or(0, |qc| qc.0);
        let degree = qc(DEGREE);
        let (min, max) = (qc(axis.limits.min), qc(axis.limits.max));
        let middle = qc(Degrees(0.5 * (axis.limits.min.0 + axis.limits.max.0)));
        // Homing finds its reference at the home position less the distance that it moves on from
        // there.
        let home_position = axis.homing.home_position;
        let reference = qc(Degrees(home_position.0 - axis.homing.offset.0));
        let method = axis.homing.method;
        // If an index pulse is the reference, the switch or stop before it is half a revolution of
        // the motor farther on.
        let by_index = matches!(method, 1 | 2 | 7 | 11 | 33 | 34 | -1 | -2);
        let half_turn = i32::try_from(axis.gearing.qc_per_motor_turn() / 2).unwrap_or(0);
        let before = if by_index { half_turn } else { 0 };
        let up = reference.saturating_add(before);
        let down = reference.saturating_sub(before);

        let mut places = Self {
            low: min.saturating_sub(degree),
            high: max.saturating_add(degree),
            home: (middle, middle.saturating_add(degree)),
            stops: (i32::MIN, i32::MAX),
            index: if by_index { reference } else { 0 },
            start: middle.midpoint(max),
        };
        match method {
            1 | 17 => places.low = down,
            2 | 18 => places.high = up,
            _ => {
                places.low = places.low.min(down.saturating_sub(degree));
                places.high = places.high.max(up.saturating_add(degree));
            }
        }
        places.stops = (
            places.low.saturating_sub(qc(TO_STOP)),
            places.high.saturating_add(qc(TO_STOP)),
        );
        match method {
            7 | 23 => places.home = (up, up.saturating_add(degree)),
            11 | 27 => places.home = (down.saturating_sub(degree), down),
            33 => places.start = up,
            34 => places.start = down,
            // The user has put the axis there by hand.
            35 => places.start = qc(home_position),
            -1 | -3 => places.stops.1 = up,
            -2 | -4 => places.stops.0 = down,
            _ => {}
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use firmware_sim::epos2::SimulatedDrive;
    use protocol::epos2::DeviceError;
    use protocol::epos2::cia402::{control, mode, status};
    use protocol::epos2::objects::{self, Scalar, TypedObject};

    use super::*;
    use crate::config::{AxisSettings, HomingSettings};
    use crate::devices::profile as devices;

    fn set<T: Scalar>(node: &mut SimulatedDrive, object: TypedObject<T>, value: T) {
        node.write(object.address, object.encode(value)).unwrap();
    }

    fn get<T: Scalar>(node: &SimulatedDrive, object: TypedObject<T>) -> T {
        object.decode(node.read(object.address).unwrap().raw().unwrap())
    }

    /// Homes as the client does, and returns the node.
    fn homed(axis: &AxisConfig) -> SimulatedDrive {
        let qc = |angle| axis.gearing.position(angle).unwrap().0;
        let homing = axis.homing;
        let mut node = SimulatedDrive::new(SimulatedDriveConfig {
            fault_at_power_on: DeviceError::NONE,
            ..node(axis)
        });
        set(&mut node, objects::INPUT_EXECUTION_MASK, 0b1011);
        set(&mut node, objects::MODE, mode::HOMING);
        set(&mut node, objects::HOMING_METHOD, homing.method);
        set(
            &mut node,
            objects::HOMING_SWITCH_SPEED,
            homing.switch_speed.0,
        );
        set(&mut node, objects::HOMING_ZERO_SPEED, homing.zero_speed.0);
        set(
            &mut node,
            objects::HOMING_ACCELERATION,
            homing.acceleration.0,
        );
        set(&mut node, objects::HOME_OFFSET, qc(homing.offset));
        set(&mut node, objects::HOME_POSITION, qc(homing.home_position));
        for word in [control::SHUTDOWN, control::ENABLE_OPERATION] {
            set(&mut node, objects::CONTROLWORD, word);
            for _ in 0..100 {
                node.tick();
            }
        }
        set(&mut node, objects::CONTROLWORD, control::START_HOMING);
        for _ in 0..60_000 {
            if get(&node, objects::STATUSWORD) & status::HOMING_ATTAINED != 0 {
                return node;
            }
            node.tick();
        }
        panic!(
            "method {}: statusword {:04X}",
            homing.method,
            get(&node, objects::STATUSWORD)
        );
    }

    #[test]
    fn every_homing_method_finds_the_configured_angle() {
        // Method, position of its reference, and where the axis moves from there.
        let cases = [
            (1, -46.0, -45.0),
            (2, 1.0, 0.0),
            (7, -20.0, -20.0),
            (11, -20.0, -10.0),
            (17, -46.0, -45.0),
            (18, 1.0, 0.0),
            (23, -20.0, -25.0),
            (27, -20.0, -15.0),
            (33, -10.0, -10.0),
            (34, -10.0, -12.0),
            (35, -7.0, -7.0),
            (-1, 3.0, 0.0),
            (-2, -48.0, -45.0),
            (-3, 3.0, 0.0),
            (-4, -48.0, -45.0),
        ];
        for (method, at_deg, to_deg) in cases {
            let axis = devices::axis(&AxisSettings {
                homing: HomingSettings {
                    method,
                    at_deg,
                    to_deg,
                    ..HomingSettings::default()
                },
                ..AxisSettings::default()
            })
            .unwrap();
            let node = homed(&axis);
            // World position and angle have one zero: the reported position is that of the shaft.
            let world = node.segment().end >> 32;
            let reported = i64::from(get(&node, objects::POSITION_ACTUAL));
            // A switch is sampled once per millisecond; a stop is detected by the rising current.
            assert!(
                (world - reported).abs() <= 2,
                "{method}: {world} {reported}"
            );
            let wanted = axis.gearing.position(axis.homing.home_position).unwrap();
            assert_eq!(reported, i64::from(wanted.0), "{method}");
            let limits = get(&node, objects::INPUT_STATE) & 0b11;
            assert_eq!(limits, 0, "{method}: on a limit switch");
        }
    }

    #[test]
    fn a_home_switch_does_not_use_the_input_of_a_limit_switch() {
        let mut axis = AxisConfig::default();
        assert!(node(&axis).switches[2].is_some());
        axis.limit_switches.positive = Some(HOME_INPUT);
        assert_eq!(node(&axis).switches[2], None);
    }
}
