//! Names of patterns with options: `rmbl:120,rpm=600,tilt=stepped`.

use super::{
    Pattern, PatternError, PatternSensor, PatternSettings, PatternTilt, RevolutionEnds, TiltSteps,
};

/// All names: fixed sensors; one or sixteen lasers tilted by half a revolution (rotating single-
/// and multi-beam lidar); and velomotion's own sweep.
pub const NAMES: [&str; 6] = ["vlp16", "hdl32e", "vlp32c", "rmbl", "rsbl", "velomotion16"];

const KEYS: &str = "rpm, step, start, seam, from, to, speed, accel, tilt, frames or d";
/// Keys with numbers.
const NUMBERS: [&str; 9] = [
    "rpm", "step", "start", "from", "to", "speed", "accel", "frames", "d",
];

/// A requested pattern. Options may be set again before it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct PatternRequest {
    name: String,
    settings: PatternSettings,
    /// Step of azimuth; absent: from the rotation of the head.
    step_deg: Option<f64>,
    speed_deg_s: Option<f64>,
}

/// Step of azimuth per revolution per minute: the paper's 0.4 degrees at 1200, 0.2 at 600.
const STEP_DEG_PER_RPM: f64 = 1.0 / 3_000.0;
/// Azimuth at which a frame begins and ends: across the tilt axis, as far as possible from the
/// poles of the pattern.
const START_DEG: f64 = 90.0;
/// The paper's 20 frames per second.
const RPM: f64 = 1_200.0;

impl PatternRequest {
    /// Whether a text begins with the name of a pattern.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        NAMES.contains(&name_of(text))
    }

    /// Parses `NAME[:SPEED][,KEY=VALUE]...`.
    ///
    /// # Errors
    /// [`PatternError`] for an unknown name or option.
    pub fn parse(text: &str) -> Result<Self, PatternError> {
        let name = name_of(text);
        let (head, to_deg) = match name {
            "vlp16" => (PatternSensor::Vlp16, None),
            "hdl32e" => (PatternSensor::Hdl32e, None),
            "vlp32c" => (PatternSensor::Vlp32c, None),
            "rmbl" => (PatternSensor::Vlp16, Some(180.0)),
            "rsbl" => (PatternSensor::Single, Some(180.0)),
            "velomotion16" => (PatternSensor::Vlp16, Some(-45.0)),
            got => {
                let got = got.to_owned();
                return Err(PatternError::Name { got });
            }
        };
        let tilt = PatternTilt {
            from_deg: 0.0,
            to_deg: to_deg.unwrap_or(0.0),
            speed_deg_s: 0.0,
            steps: TiltSteps::Continuous,
            accel_deg_s2: None,
        };
        let mut request = Self {
            name: text.to_owned(),
            settings: PatternSettings {
                head,
                rpm: RPM,
                step_deg: 0.0,
                start_deg: START_DEG,
                seam: RevolutionEnds::Twice,
                tilt,
                frames: None,
                d_m: 0.0,
            },
            step_deg: None,
            speed_deg_s: None,
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
            match option.split_once('=') {
                Some((key, _)) if set.contains(&key) => {
                    return Err(request.wrong(format!("{key} once"), format!("{option} as well")));
                }
                Some((key, value)) => {
                    request.set(key, value)?;
                    set.push(key);
                }
                None => return Err(request.wrong(format!("KEY=VALUE with {KEYS}"), option)),
            }
        }
        Ok(request)
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
        let stands = self.stands();
        let settings = &mut self.settings;
        match key {
            "rpm" => settings.rpm = value,
            "step" => self.step_deg = Some(value),
            "start" => settings.start_deg = value,
            "d" => settings.d_m = value,
            "from" if stands => {
                settings.tilt.from_deg = value;
                settings.tilt.to_deg = value;
            }
            "from" => settings.tilt.from_deg = value,
            "to" if !stands => settings.tilt.to_deg = value,
            "speed" if !stands => self.speed_deg_s = Some(value),
            "accel" if !stands => settings.tilt.accel_deg_s2 = Some(value),
            "to" | "speed" | "accel" => {
                let what =
                    "a sensor that stands still, without speed (rmbl:120 and velomotion16:50 turn)";
                return Err(self.wrong(what, format!("{key}={value}")));
            }
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
        settings.step_deg = self.step_deg.unwrap_or(settings.rpm * STEP_DEG_PER_RPM);
        let tilt = settings.tilt;
        if !self.stands() && tilt.to_deg == tilt.from_deg {
            let got = format!("both {}", tilt.from_deg);
            return Err(self.wrong("from and to that differ (vlp16 stands still)", got));
        }
        if tilt.accel_deg_s2.is_some()
            && (settings.frames.is_some() || tilt.steps == TiltSteps::Stepped)
        {
            let what = "accel without frames and tilt=stepped, which have no ramps";
            return Err(self.wrong(what, "both"));
        }
        if tilt.to_deg != tilt.from_deg {
            let Some(speed_deg_s) = self.speed_deg_s.filter(|speed| *speed > 0.0) else {
                let name = name_of(&self.name);
                let got = self
                    .speed_deg_s
                    .map_or("none".to_owned(), |s| s.to_string());
                return Err(self.wrong(format!("a speed above 0 deg/s, as in {name}:50"), got));
            };
            settings.tilt.speed_deg_s = speed_deg_s;
        }
        Pattern::new(&self.name, settings)
    }

    fn stands(&self) -> bool {
        matches!(name_of(&self.name), "vlp16" | "hdl32e" | "vlp32c")
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
