//! What the client must know about the axis before it may move it.
//!
//! Plain data with a check. Reading it from a file is somebody else's business, and so is anything about the link
//! itself (device names, baud rates).

use units::{Degrees, Gearing, Quadcounts, Rpm, RpmPerS, Span};

use crate::error::DriveError;

/// The tilt axis: gearing, limits, switches, brake, homing and timing.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisConfig {
    /// CANopen node id of the drive, 1..=127.
    pub node: u8,
    /// Encoder and gear.
    pub gearing: Gearing,
    /// Range of tilt angles; targets outside are refused and the drive's own software limits (607D) are set to it.
    pub limits: Limits,
    /// Fastest motor speed, written to 607F.
    pub max_speed: Rpm,
    /// Largest acceleration a move or homing may ask for; 60C5 gets it, or the quick stop's where that is larger.
    pub max_acceleration: RpmPerS,
    /// Deceleration of a quick stop, written to 6085.
    pub quick_stop: RpmPerS,
    /// Largest following error before the drive faults, written to 6065.
    pub max_following_error: Quadcounts,
    /// How far from its target the axis may come to rest and still have arrived.
    pub arrival_tolerance: Quadcounts,
    /// Inputs of the limit switches.
    pub limit_switches: LimitSwitches,
    /// The holding brake; `None` leaves the outputs alone.
    pub brake: Option<Brake>,
    /// How the axis finds its zero.
    pub homing: Homing,
    /// Periods and time limits.
    pub timing: Timing,
    /// What is said on a CAN bus beside requests; the other links have none of it.
    pub can: CanBus,
}

/// Signs of life on a CAN bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanBus {
    /// Node id under which the host sends its heartbeat while the axis may move, 1..=127, not the drive's.
    pub host_node: u8,
    /// How often it does.
    pub host_heartbeat: Span,
    /// Silence of the host after which the drive stops (whole milliseconds, 1016:1).
    pub host_limit: Span,
    /// How often the drive sends its heartbeat (whole milliseconds, 1017).
    pub node_heartbeat: Span,
    /// Silence of the drive after which it counts as lost.
    pub node_limit: Span,
}

/// A closed range of tilt angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Lowest angle.
    pub min: Degrees,
    /// Highest angle.
    pub max: Degrees,
}

/// Digital inputs (1..=9) of the limit switches; `None` where the axis has no such switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LimitSwitches {
    /// Input of the negative limit switch.
    pub negative: Option<u8>,
    /// Input of the positive limit switch.
    pub positive: Option<u8>,
    /// Whether a switch is active when its input is low (a normally closed contact: a broken wire stops the axis).
    pub active_low: bool,
}

/// The holding brake on a digital output of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brake {
    /// Digital output, 1..=5, that feeds the brake (2079).
    pub output: u8,
    /// Time the brake takes to open, whole milliseconds up to 65535 (2100:1).
    pub rise: Span,
    /// Time the brake takes to close, whole milliseconds up to 65535 (2100:2).
    pub fall: Span,
}

/// How the axis finds its zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homing {
    /// Homing method (6098): 1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35 or -1 to -4.
    pub method: i8,
    /// Speed of the search for the switch or stop (6099:1).
    pub switch_speed: Rpm,
    /// Speed of the search for the edge or index (6099:2).
    pub zero_speed: Rpm,
    /// Acceleration while homing (609A).
    pub acceleration: RpmPerS,
    /// How far the axis moves on after detection (607C), as an angle; its sign is the direction.
    pub offset: Degrees,
    /// The tilt angle of the place it then stands at (2081).
    pub home_position: Degrees,
    /// Current that tells a mechanical stop, mA (2080); written for methods -1 to -4 alone.
    pub current_threshold_ma: u16,
    /// Homing that takes longer has failed.
    pub time_limit: Span,
}

/// Periods and time limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Time an answer may take before it counts as lost (the drive's own frame timeout is 500 ms).
    pub timeout: Span,
    /// The same while the axis moves, when silence costs more than a repeated question.
    pub timeout_moving: Span,
    /// How often a read is repeated after its answer was lost. Writes are never repeated by themselves.
    pub read_retries: u8,
    /// Least time between two position samples; zero polls as fast as answers come. The position loop runs at 1 kHz.
    pub poll_period: Span,
    /// Time between two looks at the statusword during motion.
    pub status_period: Span,
    /// Sampling at standstill before and after a sweep.
    pub hold: Span,
    /// How much longer than planned a move may take.
    pub arrival_margin: Span,
    /// Time a change of state (enable, fault reset, setpoint acknowledge) may take.
    pub state_limit: Span,
    /// Time without motion that counts as standstill.
    pub standstill: Span,
}

impl Default for AxisConfig {
    /// The Velomotion-16's axis: 500 lines, 120:1, up to 75 deg/s and 1000 deg/s2, factory inputs for the switches, brake on output 1.
    fn default() -> Self {
        Self {
            node: 1,
            gearing: default_gearing(),
            limits: Limits {
                min: Degrees(-60.0),
                max: Degrees(60.0),
            },
            max_speed: Rpm(1_500),
            max_acceleration: RpmPerS(20_000),
            quick_stop: RpmPerS(20_000),
            max_following_error: Quadcounts(2_000),
            arrival_tolerance: Quadcounts(20),
            limit_switches: LimitSwitches::default(),
            brake: Some(Brake::default()),
            homing: Homing::default(),
            timing: Timing::default(),
            can: CanBus::default(),
        }
    }
}

impl Default for CanBus {
    /// Heartbeats every 50 ms; the drive waits for four of the host's, whose threads may be held up, the host for two and a
    /// half of the drive's.
    fn default() -> Self {
        Self {
            host_node: 127,
            host_heartbeat: Span::from_millis(50),
            host_limit: Span::from_millis(200),
            node_heartbeat: Span::from_millis(50),
            node_limit: Span::from_millis(125),
        }
    }
}

/// 500 lines behind 120:1.
fn default_gearing() -> Gearing {
    const PAPER: Gearing = match Gearing::new(500, 120, 1) {
        Ok(gearing) => gearing,
        Err(_) => unreachable!(),
    };
    PAPER
}

impl Default for LimitSwitches {
    /// The factory's choice: input 6 negative, input 5 positive, active high (EPOS2 object 2070).
    fn default() -> Self {
        Self {
            negative: Some(6),
            positive: Some(5),
            active_low: false,
        }
    }
}

impl LimitSwitches {
    /// The switches' bits in 2071 (bit 0 negative, bit 1 positive).
    #[must_use]
    pub fn mask(self) -> u16 {
        u16::from(self.negative.is_some()) | u16::from(self.positive.is_some()) << 1
    }
}

impl Default for Brake {
    /// Output 1, 10 ms each way as from the factory.
    fn default() -> Self {
        Self {
            output: 1,
            rise: Span::from_millis(10),
            fall: Span::from_millis(10),
        }
    }
}

impl Default for Homing {
    /// Method 17: the edge of the negative limit switch, without index; then 5 degrees off the switch.
    fn default() -> Self {
        Self {
            method: 17,
            switch_speed: Rpm(400),
            zero_speed: Rpm(40),
            acceleration: RpmPerS(5_000),
            offset: Degrees(5.0),
            home_position: Degrees(-60.0),
            current_threshold_ma: 500,
            time_limit: Span::from_secs(60),
        }
    }
}

impl Default for Timing {
    fn default() -> Self {
        Self {
            timeout: Span::from_millis(500),
            timeout_moving: Span::from_millis(100),
            read_retries: 2,
            poll_period: Span::from_millis(1),
            status_period: Span::from_millis(20),
            hold: Span::from_millis(50),
            arrival_margin: Span::from_secs(1),
            state_limit: Span::from_secs(2),
            standstill: Span::from_millis(50),
        }
    }
}

/// Limits in the drive's own units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LimitsQc {
    pub min: Quadcounts,
    pub max: Quadcounts,
}

impl AxisConfig {
    /// Refuses what no axis can be.
    ///
    /// # Errors
    /// [`DriveError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), DriveError> {
        within("node", self.node, 1, 127)?;
        within("max_speed", self.max_speed.0, 1, MAX_SPEED_RPM)?;
        within("max_acceleration", self.max_acceleration.0, 1, u32::MAX)?;
        within("quick_stop", self.quick_stop.0, 1, u32::MAX)?;
        within(
            "max_following_error",
            self.max_following_error.0,
            1,
            i32::MAX,
        )?;
        within("arrival_tolerance", self.arrival_tolerance.0, 0, i32::MAX)?;
        self.limits_qc()?;
        self.limit_switches.check()?;
        if let Some(brake) = self.brake {
            brake.check()?;
        }
        self.homing.check(self)?;
        self.timing.check()?;
        self.can.check(self.node)
    }

    /// The limits in quadcounts, rounded to the nearest.
    pub(crate) fn limits_qc(&self) -> Result<LimitsQc, DriveError> {
        let min = self.quadcounts("limits.min", self.limits.min)?;
        let max = self.quadcounts("limits.max", self.limits.max)?;
        if min >= max {
            return Err(DriveError::Config {
                field: "limits",
                expected: "min below max".into(),
                got: format!("{} to {} deg", self.limits.min.0, self.limits.max.0),
            });
        }
        Ok(LimitsQc { min, max })
    }

    /// An angle of the configuration as quadcounts.
    pub(crate) fn quadcounts(
        &self,
        field: &'static str,
        angle: Degrees,
    ) -> Result<Quadcounts, DriveError> {
        self.gearing
            .position(angle)
            .map_err(|_| DriveError::Config {
                field,
                expected: "an angle whose quadcounts fit 32 bits".into(),
                got: format!("{} deg", angle.0),
            })
    }
}

/// Upper limit of 607F in the EPOS2's device description.
const MAX_SPEED_RPM: u32 = 25_000;
const METHODS: [i8; 15] = [1, 2, 7, 11, 17, 18, 23, 27, 33, 34, 35, -1, -2, -3, -4];

impl LimitSwitches {
    fn check(self) -> Result<(), DriveError> {
        for (field, input) in [
            ("limit_switches.negative", self.negative),
            ("limit_switches.positive", self.positive),
        ] {
            if let Some(input) = input {
                within(field, input, 1, 9)?;
            }
        }
        if self.negative.is_some() && self.negative == self.positive {
            return Err(DriveError::Config {
                field: "limit_switches",
                expected: "two different inputs".into(),
                got: format!("{:?} for both", self.negative),
            });
        }
        Ok(())
    }
}

impl Brake {
    fn check(self) -> Result<(), DriveError> {
        within("brake.output", self.output, 1, 5)?;
        for (field, span) in [("brake.rise", self.rise), ("brake.fall", self.fall)] {
            within(field, whole_ms(span), 0, i64::from(u16::MAX))?;
        }
        Ok(())
    }
}

impl Homing {
    /// Whether a mechanical stop is found by the motor's current.
    pub(crate) fn by_current(&self) -> bool {
        self.method < 0
    }

    fn check(&self, axis: &AxisConfig) -> Result<(), DriveError> {
        if !METHODS.contains(&self.method) {
            return Err(DriveError::Config {
                field: "homing.method",
                expected: format!("one of {METHODS:?}"),
                got: self.method.to_string(),
            });
        }
        within(
            "homing.switch_speed",
            self.switch_speed.0,
            1,
            axis.max_speed.0,
        )?;
        within("homing.zero_speed", self.zero_speed.0, 1, axis.max_speed.0)?;
        within(
            "homing.acceleration",
            self.acceleration.0,
            1,
            axis.max_acceleration.0,
        )?;
        axis.quadcounts("homing.offset", self.offset)?;
        axis.quadcounts("homing.home_position", self.home_position)?;
        within(
            "homing.time_limit (ms)",
            whole_ms(self.time_limit),
            1,
            i64::MAX,
        )
    }
}

impl Timing {
    fn check(&self) -> Result<(), DriveError> {
        for (field, span, least) in [
            ("timing.timeout", self.timeout, 1),
            ("timing.timeout_moving", self.timeout_moving, 1),
            ("timing.poll_period", self.poll_period, 0),
            ("timing.status_period", self.status_period, 0),
            ("timing.hold", self.hold, 0),
            ("timing.arrival_margin", self.arrival_margin, 1),
            ("timing.state_limit", self.state_limit, 1),
            ("timing.standstill", self.standstill, 1),
        ] {
            within(field, whole_ms(span), least, MAX_SPAN_MS)?;
        }
        Ok(())
    }
}

impl CanBus {
    fn check(&self, node: u8) -> Result<(), DriveError> {
        within("can.host_node", self.host_node, 1, 127)?;
        if self.host_node == node {
            return Err(DriveError::Config {
                field: "can.host_node",
                expected: "another node than the drive's".into(),
                got: node.to_string(),
            });
        }
        for (field, span, more_than) in [
            ("can.host_heartbeat", self.host_heartbeat, Span::ZERO),
            ("can.host_limit", self.host_limit, self.host_heartbeat),
            ("can.node_heartbeat", self.node_heartbeat, Span::ZERO),
            ("can.node_limit", self.node_limit, self.node_heartbeat),
        ] {
            let least = whole_ms(more_than).saturating_add(1);
            within(field, whole_ms(span), least, i64::from(u16::MAX))?;
        }
        Ok(())
    }
}

/// An hour: nothing here is meant to wait longer, and sums of such spans stay far from overflow.
const MAX_SPAN_MS: i64 = 3_600_000;

/// Whole milliseconds, rounded away from zero so that a negative span never becomes zero.
pub(crate) fn whole_ms(span: Span) -> i64 {
    let ns = span.as_nanos();
    ns / 1_000_000 + (ns % 1_000_000).signum()
}

fn within<T: PartialOrd + std::fmt::Display>(
    field: &'static str,
    value: T,
    min: T,
    max: T,
) -> Result<(), DriveError> {
    if value < min || value > max {
        return Err(DriveError::Config {
            field,
            expected: format!("{min} to {max}"),
            got: value.to_string(),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(change: impl FnOnce(&mut AxisConfig)) -> &'static str {
        let mut config = AxisConfig::default();
        change(&mut config);
        match config.check() {
            Err(DriveError::Config { field, .. }) => field,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_default_rig_is_sound() {
        assert_eq!(AxisConfig::default().check(), Ok(()));
        let limits = AxisConfig::default().limits_qc().unwrap();
        assert_eq!((limits.min.0, limits.max.0), (-40_000, 40_000));
    }

    #[test]
    fn each_impossible_field_is_named() {
        assert_eq!(field(|c| c.node = 0), "node");
        assert_eq!(field(|c| c.node = 128), "node");
        assert_eq!(field(|c| c.max_speed = Rpm(25_001)), "max_speed");
        assert_eq!(field(|c| c.limits.min = Degrees(60.0)), "limits");
        assert_eq!(field(|c| c.limits.max = Degrees(f64::NAN)), "limits.max");
        assert_eq!(field(|c| c.homing.method = 3), "homing.method");
        assert_eq!(field(|c| c.homing.zero_speed = Rpm(0)), "homing.zero_speed");
        assert_eq!(
            field(|c| c.limit_switches.positive = Some(6)),
            "limit_switches"
        );
        assert_eq!(
            field(|c| c.brake = Some(Brake {
                output: 6,
                ..Brake::default()
            })),
            "brake.output"
        );
        assert_eq!(field(|c| c.timing.timeout = Span::ZERO), "timing.timeout");
        assert_eq!(field(|c| c.can.host_node = 1), "can.host_node");
        assert_eq!(
            field(|c| c.can.node_limit = Span::from_millis(50)),
            "can.node_limit"
        );
        assert_eq!(
            field(|c| c.timing.hold = Span::from_nanos(-1)),
            "timing.hold"
        );
    }

    #[test]
    fn limit_switch_bits_are_those_of_2071() {
        assert_eq!(LimitSwitches::default().mask(), 0b11);
        let one = LimitSwitches {
            negative: None,
            ..LimitSwitches::default()
        };
        assert_eq!(one.mask(), 0b10);
    }
}
