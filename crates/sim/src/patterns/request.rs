//! Names of patterns with options: `rmbl:120,rpm=600,tilt=stepped`.

use super::{
    Pattern, PatternError, PatternSettings, PatternTilt, PlanarFront, RevolutionEnds, SensorName,
    TiltSteps,
};

/// Motion of a named pattern without options.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PatternMotion {
    /// At rest without a speed; with one it tilts, or spins with `spin`.
    Free,
    /// From 0 to -45 degrees.
    Tilt,
    /// By half a turn.
    Spin,
}

const SENSORS: [(&str, SensorName, PatternMotion); 10] = [
    ("vlp16", SensorName::Vlp16, PatternMotion::Free),
    ("hi-res", SensorName::HiRes, PatternMotion::Free),
    ("hdl32e", SensorName::Hdl32e, PatternMotion::Free),
    ("vlp32c", SensorName::Vlp32c, PatternMotion::Free),
    ("hdl64e", SensorName::Hdl64e, PatternMotion::Free),
    ("utm30lx", SensorName::Utm30lx, PatternMotion::Free),
    ("lms151", SensorName::Lms151, PatternMotion::Free),
    ("rmbl", SensorName::Vlp16, PatternMotion::Spin),
    ("rsbl", SensorName::SingleBeam, PatternMotion::Spin),
    ("velomotion16", SensorName::Vlp16, PatternMotion::Tilt),
];

/// All names: sensors, and the patterns of the paper: rotating multi- and single-beam lidar, and
/// velomotion's own sweep.
pub const NAMES: [&str; SENSORS.len()] = {
    let mut names = [""; SENSORS.len()];
    let mut at = 0;
    while at < SENSORS.len() {
        names[at] = SENSORS[at].0;
        at += 1;
    }
    names
};

const KEYS: &str =
    "rpm, step, start, seam, from, to, speed, accel, tilt, frames, d, spin, roll or pitch";
/// Keys with numbers.
const NUMBERS: [&str; 9] = [
    "rpm", "step", "start", "from", "to", "speed", "accel", "frames", "d",
];

/// A requested pattern. Options may be set again before it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternRequest {
    name: String,
    motion: PatternMotion,
    settings: PatternSettings,
    step_deg: Option<f64>,
    from_deg: Option<f64>,
    to_deg: Option<f64>,
    speed_deg_s: Option<f64>,
    spin: bool,
    front: Option<PlanarFront>,
}

/// Azimuth at which a frame begins and ends: across the tilt axis, as far as possible from the
/// poles of the pattern.
const START_DEG: f64 = 90.0;
/// Ends of velomotion's sweep, and of half a turn, degrees.
const TILT_DEG: f64 = -45.0;
const SPIN_DEG: f64 = 180.0;

impl PatternRequest {
    /// Whether a text begins with the name of a pattern.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        NAMES.contains(&name_of(text))
    }

    /// Parses `NAME[:SPEED][,KEY=VALUE|,spin|,roll|,pitch]...`.
    ///
    /// # Errors
    /// [`PatternError`] for an unknown name or option.
    pub fn parse(text: &str) -> Result<Self, PatternError> {
        let name = name_of(text);
        let known = SENSORS.into_iter().find(|(known, ..)| *known == name);
        let Some((_, head, motion)) = known else {
            let got = name.to_owned();
            return Err(PatternError::Name { got });
        };
        let mut request = Self {
            name: text.to_owned(),
            motion,
            settings: PatternSettings {
                head,
                rpm: head.usual_rpm(),
                step_deg: 0.0,
                start_deg: START_DEG,
                front: PlanarFront::Pitch,
                seam: RevolutionEnds::Twice,
                tilt: PatternTilt {
                    from_deg: 0.0,
                    to_deg: 0.0,
                    speed_deg_s: 0.0,
                    steps: TiltSteps::Continuous,
                    accel_deg_s2: None,
                },
                frames: None,
                d_m: 0.0,
            },
            step_deg: None,
            from_deg: None,
            to_deg: None,
            speed_deg_s: None,
            spin: motion == PatternMotion::Spin,
            front: None,
        };
        let rest = text.get(name.len()..).unwrap_or_default();
        let (speed, options) = match rest.strip_prefix(':') {
            Some(rest) => match rest.split_once(',') {
                Some((speed, options)) => (Some(speed), Some(options)),
                None => (Some(rest), None),
            },
            None => (None, rest.strip_prefix(',')),
        };
        let mut set = Vec::new();
        if let Some(speed) = speed {
            request.set("speed", speed)?;
            set.push("speed");
        }
        for option in options.into_iter().flat_map(|options| options.split(',')) {
            let key = option.split('=').next().unwrap_or_default();
            if set.contains(&key) {
                return Err(request.wrong(format!("{key} once"), format!("{option} as well")));
            }
            match option.split_once('=') {
                Some((key, value)) => request.set(key, value)?,
                None => request.set_word(option)?,
            }
            set.push(key);
        }
        Ok(request)
    }

    /// Sets an option without a value.
    fn set_word(&mut self, word: &str) -> Result<(), PatternError> {
        let is_planar = self.settings.head.aperture_deg().is_some();
        match word {
            "spin" if self.motion == PatternMotion::Free => self.spin = true,
            "roll" | "pitch" if !is_planar => {
                let expected =
                    "a planar scanner (a rotating head has no front: roll and pitch are one)";
                return Err(self.wrong(expected, word));
            }
            "roll" => self.front = Some(PlanarFront::Roll),
            "pitch" => self.front = Some(PlanarFront::Pitch),
            _ => return Err(self.wrong(format!("KEY=VALUE or a word of {KEYS}"), word)),
        }
        Ok(())
    }

    /// Sets an option.
    ///
    /// # Errors
    /// [`PatternError::Option`] for an unknown option or value.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), PatternError> {
        match (key, value) {
            ("seam", "once") => self.settings.seam = RevolutionEnds::Once,
            ("seam", "twice") => self.settings.seam = RevolutionEnds::Twice,
            ("seam", _) => return Err(self.wrong("seam=once or seam=twice", value)),
            ("tilt", "stepped") => self.settings.tilt.steps = TiltSteps::Stepped,
            ("tilt", "continuous") => self.settings.tilt.steps = TiltSteps::Continuous,
            ("tilt", _) => return Err(self.wrong("tilt=stepped or tilt=continuous", value)),
            _ if NUMBERS.contains(&key) => {
                let number = value.parse::<f64>().ok().filter(|n| n.is_finite());
                let Some(number) = number else {
                    return Err(self.wrong(format!("a number for {key}"), value));
                };
                return self.set_number(key, number);
            }
            _ => return Err(self.wrong(KEYS, key)),
        }
        Ok(())
    }

    /// Sets an option with a number.
    ///
    /// # Errors
    /// [`PatternError::Option`] for an unknown option.
    pub fn set_number(&mut self, key: &str, value: f64) -> Result<(), PatternError> {
        let settings = &mut self.settings;
        match key {
            "rpm" => settings.rpm = value,
            "step" => self.step_deg = Some(value),
            "start" if settings.head.aperture_deg().is_some() => {
                let what = "no start: a planar scanner begins at the edge of its aperture";
                return Err(self.wrong(what, format!("{key}={value}")));
            }
            "start" => settings.start_deg = value,
            "d" => settings.d_m = value,
            "from" => self.from_deg = Some(value),
            "to" => self.to_deg = Some(value),
            "speed" => self.speed_deg_s = Some(value),
            "accel" => settings.tilt.accel_deg_s2 = Some(value),
            "frames" if value.fract() == 0.0 && (1.0..=1e6).contains(&value) => {
                settings.frames = Some(value as u32);
            }
            "frames" => {
                let what = "frames as a whole number from 1 to 1000000";
                return Err(self.wrong(what, value.to_string()));
            }
            "tilt" | "seam" => {
                let what = match key {
                    "tilt" => "tilt=stepped or tilt=continuous, which is no number",
                    _ => "seam=once or seam=twice, which is no number",
                };
                return Err(self.wrong(what, format!("{key}={value}")));
            }
            _ => return Err(self.wrong(format!("a number: {}", NUMBERS.join(", ")), key)),
        }
        Ok(())
    }

    /// Builds the pattern.
    ///
    /// # Errors
    /// [`PatternError`] for invalid options, such as a motion without a speed.
    pub fn build(&self) -> Result<Pattern, PatternError> {
        let mut settings = self.settings;
        let head = settings.head;
        let steps_per_s = head.steps_per_s();
        settings.step_deg = self.step_deg.unwrap_or(settings.rpm * (6.0 / steps_per_s));
        if settings.d_m != 0.0 && head.aperture_deg().is_some() {
            let what = "d=0: the view of a planar scanner is known on the axis only";
            return Err(self.wrong(what, settings.d_m.to_string()));
        }
        let usual = if self.spin {
            PlanarFront::Roll
        } else {
            PlanarFront::Pitch
        };
        settings.front = self.front.unwrap_or(usual);
        let at_rest = self.motion == PatternMotion::Free && self.speed_deg_s.is_none();
        settings.tilt.from_deg = self.from_deg.unwrap_or(0.0);
        settings.tilt.to_deg = match (self.to_deg, self.spin) {
            _ if at_rest => settings.tilt.from_deg,
            (Some(to_deg), _) => to_deg,
            (None, true) => SPIN_DEG,
            (None, false) => TILT_DEG,
        };
        let tilt = &mut settings.tilt;
        if at_rest && (self.to_deg.is_some() || self.spin || tilt.accel_deg_s2.is_some()) {
            let what = "a speed with to, accel and spin, as in vlp16:50,to=-30";
            return Err(self.wrong(what, "none"));
        }
        if at_rest {
            return Pattern::new(&self.name, settings);
        }
        if tilt.to_deg == tilt.from_deg {
            let got = format!("both {}", tilt.from_deg);
            return Err(self.wrong("from and to that differ (vlp16 stands still)", got));
        }
        if tilt.accel_deg_s2.is_some()
            && (settings.frames.is_some() || tilt.steps == TiltSteps::Stepped)
        {
            let what = "accel without frames and tilt=stepped, which have no ramps";
            return Err(self.wrong(what, "both"));
        }
        let Some(speed_deg_s) = self.speed_deg_s.filter(|speed| *speed > 0.0) else {
            let name = name_of(&self.name);
            let speed = self.speed_deg_s;
            let got = speed.map_or("none".to_owned(), |speed| speed.to_string());
            return Err(self.wrong(format!("a speed above 0 deg/s, as in {name}:50"), got));
        };
        tilt.speed_deg_s = speed_deg_s;
        Pattern::new(&self.name, settings)
    }

    fn wrong(&self, expected: impl Into<String>, got: impl Into<String>) -> PatternError {
        PatternError::Option {
            name: self.name.clone(),
            expected: expected.into(),
            got: got.into(),
        }
    }
}

/// The part before speed and options.
fn name_of(text: &str) -> &str {
    text.split([':', ',']).next().unwrap_or_default()
}
