//! Selection of the device profile, and the drive's axis configuration.

use drive::config::{AxisLimits, BrakeConfig, HomingConfig, LimitSwitchConfig, MotionGuardConfig};
use units::{DegPerS, DegPerS2, Degrees, RpmPerS, Span};

use crate::config::{AxisSettings, Config, Device, DeviceKind, WithoutBrake};
use crate::failure::{Failure, Kind};

/// Acceleration of homing, if the axis allows it.
const HOMING_ACCELERATION: RpmPerS = RpmPerS(5_000);

/// The device to use and its name: `--device`, else the configuration's, else `auto`, which is the
/// drive plugged in when its port is needed ([`port_path`](crate::devices::drive_port::port_path)).
///
/// # Errors
/// Returns [`Kind::Usage`] for an unknown name.
pub fn choose(config: &Config, requested: Option<&str>) -> Result<(String, Device), Failure> {
    let name = requested
        .or(config.device.default.as_deref())
        .unwrap_or("auto")
        .to_owned();
    if let Some(device) = config.device.profiles.get(&name) {
        return Ok((name, device.clone()));
    }
    match name.as_str() {
        "sim" => Ok((name, Device::simulator())),
        "auto" => Ok((name, Device::found())),
        _ => {
            let mut known: Vec<&str> = config.device.profiles.keys().map(String::as_str).collect();
            known.extend(["sim", "auto"]);
            Err(Failure::new(
                Kind::Usage,
                format!("no device is called {name}: expected one of {}", known.join(", ")),
            )
            .help("add it to the configuration as [device.NAME], whose keys name its ports, or use --device sim for simulated devices"))
        }
    }
}

/// The axis configuration of the drive client.
///
/// # Errors
/// Returns [`Kind::BadInput`] for an invalid axis configuration.
pub fn axis(axis: &AxisSettings) -> Result<drive::AxisConfig, Failure> {
    let wrong = |error: &dyn std::fmt::Display| {
        Failure::new(
            Kind::BadInput,
            format!("the configuration's [axis]: {error}"),
        )
        .help("correct that value in the configuration; velomotion help wiring describes every key")
    };
    let gearing = axis.scan().gearing().map_err(|error| wrong(&error))?;
    let rpm = |deg_s: f64| gearing.rpm(DegPerS(deg_s));
    let (homing, guard) = (&axis.homing, &axis.guard);
    let at_rest = drive::AxisConfig::rest_tolerance(gearing);
    let max_acceleration = gearing.rpm_per_s(DegPerS2(axis.max_accel_deg_s2));
    let config = drive::AxisConfig {
        node: axis.node,
        gearing,
        sensor_polarity: axis.sensor_polarity,
        limits: AxisLimits {
            min: Degrees(axis.min_deg),
            max: Degrees(axis.max_deg),
        },
        max_speed: rpm(axis.max_speed_deg_s),
        max_acceleration,
        quick_stop: gearing.rpm_per_s(DegPerS2(axis.quick_stop_deg_s2)),
        limit_switches: LimitSwitchConfig {
            negative: axis.limit_switches.negative,
            positive: axis.limit_switches.positive,
            active_low: axis.limit_switches.normally_closed,
        },
        brake: axis.brake_output.map(|output| BrakeConfig {
            output,
            inverted: axis.brake_inverted,
            ..BrakeConfig::default()
        }),
        hold_without_brake: axis.without_brake == WithoutBrake::Hold,
        homing: HomingConfig {
            method: homing.method,
            switch_speed: rpm(homing.speed_deg_s),
            zero_speed: rpm(homing.edge_speed_deg_s),
            acceleration: HOMING_ACCELERATION.min(max_acceleration),
            offset: Degrees(homing.to_deg - homing.at_deg),
            home_position: Degrees(homing.to_deg),
            time_limit: Span::from_secs(60),
            ..HomingConfig::default()
        },
        max_following_error: Degrees(guard.following_error_deg),
        arrival_tolerance: guard.arrival_deg.map_or(at_rest, Degrees),
        standstill_spread: guard.standstill_deg.map_or(at_rest, Degrees),
        guard: MotionGuardConfig {
            behind: Degrees(guard.behind_deg),
            servo_lag: Span::from_millis(guard.servo_lag_ms.into()),
            ahead: Degrees(guard.ahead_deg),
            beyond_limits: Degrees(guard.beyond_limits_deg),
            homing_margin: Degrees(guard.homing_margin_deg),
        },
        ..drive::AxisConfig::default()
    };
    config.check().map_err(|error| wrong(&error))?;
    Ok(config)
}

/// Whether the device is simulated.
#[must_use]
pub fn simulated(device: &Device) -> bool {
    device.kind == DeviceKind::Sim
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config;

    #[test]
    fn homing_keeps_to_the_acceleration_limit_of_the_axis() {
        let gentle = AxisSettings {
            max_accel_deg_s2: 100.0,
            ..AxisSettings::default()
        };
        let config = axis(&gentle).unwrap();
        assert_eq!(config.homing.acceleration, config.max_acceleration);
        let strong = axis(&AxisSettings::default()).unwrap();
        assert_eq!(strong.homing.acceleration, HOMING_ACCELERATION);
    }

    /// 200 counts per revolution behind 90:1 are 0.02 deg per count.
    #[test]
    fn tolerances_at_rest_grow_with_a_coarse_encoder() {
        let coarse = AxisSettings {
            encoder_lines: 50,
            gear: [90, 1],
            ..AxisSettings::default()
        };
        let config = axis(&coarse).unwrap();
        for tolerance in [config.standstill_spread, config.arrival_tolerance] {
            assert!((tolerance.0 - 0.4).abs() < 1e-9, "{tolerance:?}");
        }
        let fine = axis(&AxisSettings::default()).unwrap();
        assert_eq!(fine.standstill_spread, Degrees(0.03));
        let mut own = coarse;
        own.guard.standstill_deg = Some(0.1);
        assert_eq!(axis(&own).unwrap().standstill_spread, Degrees(0.1));
    }

    #[test]
    fn limit_switches_reach_the_client_as_configured() {
        let switches = config::LimitSwitchSettings {
            negative: None,
            positive: Some(2),
            normally_closed: true,
        };
        let config = axis(&AxisSettings {
            limit_switches: switches,
            ..AxisSettings::default()
        });
        let expected = LimitSwitchConfig {
            negative: None,
            positive: Some(2),
            active_low: true,
        };
        assert_eq!(config.unwrap().limit_switches, expected);
    }
}
