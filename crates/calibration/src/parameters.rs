//! The parameters of the scanner: their order, names, units and priors.

use std::ops::Range;

/// Parameters of the mount and the axis, before those of the lasers.
pub(crate) const DEVICE: usize = 9;
pub(crate) const ROTATION_X: usize = 0;
pub(crate) const ROTATION_Z: usize = 1;
pub(crate) const POSITION_X: usize = 2;
pub(crate) const POSITION_Z: usize = 3;
pub(crate) const DELAY: usize = 4;
pub(crate) const SCALE: usize = 5;
pub(crate) const RIPPLE_SIN: usize = 6;
pub(crate) const RIPPLE_COS: usize = 7;
pub(crate) const PLAY: usize = 8;
/// Parameters of a log: velocity and rotation rate of its base.
pub(crate) const DRIFT: usize = 6;

/// The quantity that a parameter describes. Lasers are numbered from 0 in firing order, logs
/// from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// Rotation of the mount.
    MountRotation,
    /// Position of the mount.
    MountPosition,
    /// Time by which the platform is ahead of its angle samples.
    Delay,
    /// Relative error of the tilt angle.
    Scale,
    /// Ripple of the tilt angle, the sine's factor.
    RippleSin,
    /// Ripple of the tilt angle, the cosine's factor.
    RippleCos,
    /// Play of the gear.
    Play,
    /// Range offset of a laser.
    Range(usize),
    /// Elevation of a laser.
    Elevation(usize),
    /// Azimuth offset of a laser.
    Azimuth(usize),
    /// Motion of the base during a log.
    Drift(usize),
}

/// A parameter with its unit and prior.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Quantity.
    pub kind: ParameterKind,
    /// Name with unit, such as `mount_rotation_x_deg`.
    pub name: String,
    /// SI units (radians, metres, seconds) per unit of the name.
    pub(crate) si_per_unit: f64,
    /// Standard deviation before the scan, SI.
    pub(crate) prior_sd: f64,
    /// Largest error at 20 m per SI unit, metres.
    pub(crate) m_at_20_m: f64,
}

impl Parameter {
    /// Whether this is the parameter `name`, or one of a group by its first words: `laser_1` and
    /// `laser` are groups of `laser_1_range_m`, and of `laser_12_range_m` only `laser` is.
    pub(crate) fn is_in(&self, name: &str) -> bool {
        let rest = self.name.strip_prefix(name.trim_end_matches('_'));
        rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
    }
}

/// The list of parameters of a scanner with `lasers` lasers and `logs` logs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub lasers: usize,
    pub logs: usize,
}

/// Distance for which effects of parameters are stated.
const DISTANCE_M: f64 = 20.0;
/// Rate of the tilt for which the effect of a delay is stated: the scanner's fastest sweep.
const RATE_RAD_S: f64 = 56.25 * DEG;
const DEG: f64 = std::f64::consts::PI / 180.0;

impl Layout {
    pub const fn len(&self) -> usize {
        DEVICE + 3 * self.lasers + DRIFT * self.logs
    }

    pub const fn range(&self, laser: usize) -> usize {
        DEVICE + laser
    }

    pub const fn elevation(&self, laser: usize) -> usize {
        DEVICE + self.lasers + laser
    }

    pub const fn azimuth(&self, laser: usize) -> usize {
        DEVICE + 2 * self.lasers + laser
    }

    pub const fn drift(&self, log: usize) -> usize {
        DEVICE + 3 * self.lasers + DRIFT * log
    }

    /// The drift of a log.
    pub const fn drift_of(&self, log: usize) -> Range<usize> {
        self.drift(log)..self.drift(log) + DRIFT
    }

    pub const fn azimuths(&self) -> Range<usize> {
        self.azimuth(0)..self.azimuth(self.lasers)
    }

    /// Names, units and priors in order.
    pub fn parameters(&self) -> Vec<Parameter> {
        use ParameterKind::{
            Azimuth, Delay, Drift, Elevation, MountPosition, MountRotation, Play, Range, RippleCos,
            RippleSin, Scale,
        };
        let mut all = Vec::with_capacity(self.len());
        let mut add = |kind, name: &str, si_per_unit: f64, prior_sd: f64, m_at_20_m: f64| {
            all.push(Parameter {
                kind,
                name: name.to_owned(),
                si_per_unit,
                prior_sd,
                m_at_20_m,
            });
        };
        for axis in ["x", "z"] {
            let name = format!("mount_rotation_{axis}_deg");
            add(MountRotation, &name, DEG, 3.0 * DEG, DISTANCE_M);
        }
        add(MountPosition, "mount_position_x_m", 1.0, 0.03, 1.0);
        add(MountPosition, "mount_position_z_m", 1.0, 0.03, 1.0);
        add(Delay, "delay_us", 1e-6, 5e-3, RATE_RAD_S * DISTANCE_M);
        add(Scale, "scale", 1.0, 5e-3, 45.0 * DEG * DISTANCE_M);
        add(RippleSin, "ripple_sin_deg", DEG, 0.05 * DEG, DISTANCE_M);
        add(RippleCos, "ripple_cos_deg", DEG, 0.05 * DEG, DISTANCE_M);
        add(Play, "play_deg", DEG, 0.1 * DEG, 0.5 * DISTANCE_M);
        for laser in 0..self.lasers {
            add(
                Range(laser),
                &format!("laser_{laser}_range_m"),
                1.0,
                0.02,
                1.0,
            );
        }
        for laser in 0..self.lasers {
            let name = format!("laser_{laser}_elevation_deg");
            add(Elevation(laser), &name, DEG, 0.1 * DEG, DISTANCE_M);
        }
        for laser in 0..self.lasers {
            let name = format!("laser_{laser}_azimuth_deg");
            add(Azimuth(laser), &name, DEG, 0.1 * DEG, DISTANCE_M);
        }
        for log in 1..=self.logs {
            for axis in ["x", "y", "z"] {
                let name = format!("drift_{log}_velocity_{axis}_m_s");
                add(Drift(log), &name, 1.0, 0.05, 1.0);
            }
            for axis in ["x", "y", "z"] {
                let name = format!("drift_{log}_rotation_{axis}_deg_s");
                add(Drift(log), &name, DEG, 0.5 * DEG, DISTANCE_M);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_where_the_layout_says() {
        let layout = Layout {
            lasers: 16,
            logs: 2,
        };
        let all = layout.parameters();
        assert_eq!(all.len(), layout.len());
        let mut names: Vec<&str> = all.iter().map(|p| &*p.name).collect();
        assert_eq!(names[PLAY], "play_deg");
        assert_eq!(all[PLAY].kind, ParameterKind::Play);
        assert_eq!(all[layout.azimuth(3)].kind, ParameterKind::Azimuth(3));
        assert_eq!(all[layout.drift(1) + 5].kind, ParameterKind::Drift(2));
        assert_eq!(names[layout.range(3)], "laser_3_range_m");
        assert_eq!(names[layout.elevation(15)], "laser_15_elevation_deg");
        assert_eq!(names[layout.azimuth(0)], "laser_0_azimuth_deg");
        assert_eq!(names[layout.drift(1)], "drift_2_velocity_x_m_s");
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), all.len());
    }

    #[test]
    fn a_group_is_named_by_whole_words() {
        let layout = Layout {
            lasers: 16,
            logs: 1,
        };
        let all = layout.parameters();
        let count = |name: &str| all.iter().filter(|p| p.is_in(name)).count();
        assert_eq!(
            ["laser_1", "laser", "laser_1_range_m"].map(count),
            [3, 48, 1]
        );
        assert_eq!(["drift_", "play", "pl", "p"].map(count), [6, 1, 0, 0]);
    }
}
