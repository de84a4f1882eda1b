//! The axis itself: motor, head, brake and encoder; and the motion profiles of the firmware.

/// Quadcounts of a degree of tilt: 500 lines and 120:1.
pub const QC_PER_DEG: f64 = 4.0 * 500.0 * 120.0 / 360.0;
/// Tilt speed of a motor that turns once a minute.
pub const DEG_S_PER_RPM: f64 = 360.0 / 120.0 / 60.0;
/// Angles at which the limit switches close.
pub const SWITCHES: (f64, f64) = (-46.0, 1.0);

/// Largest acceleration of the motor, and decelerations of a shut brake and of the gear's friction,
/// deg/s2.
const TORQUE: f64 = 4_000.0;
const BRAKE: f64 = 3_000.0;
const FRICTION: f64 = 60.0;

/// The truth about the axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct Axis {
    /// Tilt angle, degrees.
    pub deg: f64,
    /// Tilt speed, deg/s.
    pub speed: f64,
    /// The motor has current.
    pub powered: bool,
    /// The brake is closed.
    pub braked: bool,
    /// Acceleration by the weight of the head, deg/s2.
    pub gravity: f64,
    /// The closed brake lets the head slip at this speed, deg/s.
    pub slip: f64,
    /// Degrees that the encoder has counted.
    pub counted: f64,
    /// Counts per count of a healthy encoder.
    pub counting: f64,
}

impl Axis {
    /// An axis at rest, switched off.
    pub fn new(deg: f64) -> Self {
        Self {
            deg,
            braked: true,
            counting: 1.0,
            ..Self::default()
        }
    }

    /// Moves on by `dt` seconds. `wanted` is the speed that the servo asks of the motor.
    pub fn step(&mut self, dt: f64, wanted: f64) {
        let before = self.deg;
        let towards = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        self.speed = match (self.braked, self.powered) {
            (true, _) => towards(self.speed, self.slip, BRAKE * dt),
            (false, true) => towards(self.speed, wanted, TORQUE * dt),
            (false, false) => towards(self.speed, 0.0, FRICTION * dt) + self.gravity * dt,
        };
        self.deg += self.speed * dt;
        self.counted += (self.deg - before) * self.counting;
    }
}

/// A trapezoid in degrees of the drive's own zero.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    /// Where it starts.
    pub from: f64,
    /// Its target.
    pub to: f64,
    /// Cruise speed, deg/s.
    pub speed: f64,
    /// Acceleration and deceleration, deg/s2.
    pub acceleration: f64,
    /// When it starts, seconds of the drive.
    pub start: f64,
}

impl Profile {
    fn peak(&self) -> f64 {
        let distance = (self.to - self.from).abs();
        self.speed.min((distance * self.acceleration).sqrt())
    }

    /// Seconds from start to end.
    pub fn duration(&self) -> f64 {
        let peak = self.peak();
        if peak <= 0.0 {
            return 0.0;
        }
        (self.to - self.from).abs() / peak + peak / self.acceleration
    }

    /// Position and speed at a time.
    pub fn at(&self, now: f64) -> (f64, f64) {
        let (peak, total) = (self.peak(), self.duration());
        let sign = (self.to - self.from).signum();
        let t = now - self.start;
        let ramp = peak / self.acceleration;
        if t <= 0.0 {
            return (self.from, 0.0);
        }
        if t >= total {
            return (self.to, 0.0);
        }
        if t < ramp {
            let speed = self.acceleration * t;
            return (self.from + sign * speed * t / 2.0, sign * speed);
        }
        let left = total - t;
        if left < ramp {
            let speed = self.acceleration * left;
            return (self.to - sign * speed * left / 2.0, sign * speed);
        }
        (self.from + sign * peak * (t - ramp / 2.0), sign * peak)
    }
}
