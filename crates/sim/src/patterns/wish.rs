//! Names of patterns, and the options behind them: `rmbl:120,rpm=600,tilt=stepped`.
//!
//! Left out: what the numbers may be ([`Pattern::new`] says that).

use super::{Head, Pattern, PatternError, Seam, Settings, Steps, Tilting};

/// The names: sensors that stand still; one or sixteen lasers turned half round the tilt axis (rotating single- and multi-beam lidar); and
/// velomotion's own sweep.
pub const NAMES: [&str; 6] = ["vlp16", "hdl32e", "vlp32c", "rmbl", "rsbl", "velomotion16"];

const KEYS: &str = "rpm, step, start, seam, from, to, speed, tilt, frames or d";
/// Those of them that are numbers.
const NUMBERS: [&str; 8] = ["rpm", "step", "start", "from", "to", "speed", "frames", "d"];

/// A pattern as it is asked for. Numbers may be set anew before it is built.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    name: String,
    settings: Settings,
    /// Steps of azimuth; by the turning of the head unless set.
    step_deg: Option<f64>,
    speed_deg_s: Option<f64>,
}

/// Firings a second: degrees of azimuth per turn a minute. The paper's 0.4 degrees at 1200, 0.2 at 600.
const STEP_DEG_PER_RPM: f64 = 1.0 / 3_000.0;
/// Where a frame begins and ends: across the tilt axis, as far from the poles of the pattern as can be.
const START_DEG: f64 = 90.0;
/// The paper's frames, 20 a second.
const RPM: f64 = 1_200.0;

impl Wish {
    /// Whether a text begins with the name of a pattern.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        NAMES.contains(&name_of(text))
    }

    /// Reads `NAME[:SPEED][,KEY=VALUE]...`.
    ///
    /// # Errors
    /// [`PatternError`] for a name or an option that there is not.
    pub fn parse(text: &str) -> Result<Self, PatternError> {
        let name = name_of(text);
        let (head, to_deg) = match name {
            "vlp16" => (Head::Vlp16, None),
            "hdl32e" => (Head::Hdl32e, None),
            "vlp32c" => (Head::Vlp32c, None),
            "rmbl" => (Head::Vlp16, Some(180.0)),
            "rsbl" => (Head::Single, Some(180.0)),
            "velomotion16" => (Head::Vlp16, Some(-45.0)),
            got => {
                let got = got.to_owned();
                return Err(PatternError::Name { got });
            }
        };
        let tilting = Tilting {
            from_deg: 0.0,
            to_deg: to_deg.unwrap_or(0.0),
            speed_deg_s: 0.0,
            steps: Steps::Continuous,
        };
        let mut wish = Self {
            name: text.to_owned(),
            settings: Settings {
                head,
                rpm: RPM,
                step_deg: 0.0,
                start_deg: START_DEG,
                seam: Seam::Twice,
                tilting,
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
            wish.set("speed", speed)?;
            set.push("speed");
        }
        for option in options.into_iter().flat_map(|options| options.split(',')) {
            match option.split_once('=') {
                Some((key, _)) if set.contains(&key) => {
                    return Err(wish.wrong(format!("{key} once"), format!("{option} as well")));
                }
                Some((key, value)) => {
                    wish.set(key, value)?;
                    set.push(key);
                }
                None => return Err(wish.wrong(format!("KEY=VALUE with {KEYS}"), option)),
            }
        }
        Ok(wish)
    }

    /// Sets an option.
    ///
    /// # Errors
    /// [`PatternError::Option`] for one that there is not, or a value that it has not.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), PatternError> {
        match (key, value) {
            ("seam", "once") => self.settings.seam = Seam::Once,
            ("seam", "twice") => self.settings.seam = Seam::Twice,
            ("seam", _) => return Err(self.wrong("seam=once or seam=twice", value)),
            ("tilt", "stepped") => self.settings.tilting.steps = Steps::Stepped,
            ("tilt", "continuous") => self.settings.tilting.steps = Steps::Continuous,
            ("tilt", _) => return Err(self.wrong("tilt=stepped or tilt=continuous", value)),
            _ => return self.set_text(key, value),
        }
        Ok(())
    }

    fn set_text(&mut self, key: &str, value: &str) -> Result<(), PatternError> {
        if !NUMBERS.contains(&key) {
            return Err(self.wrong(KEYS, key));
        }
        let number = value.parse::<f64>().ok().filter(|n| n.is_finite());
        let Some(number) = number else {
            return Err(self.wrong(format!("a number for {key}"), value));
        };
        self.set_number(key, number)
    }

    /// Sets an option that is a number.
    ///
    /// # Errors
    /// [`PatternError::Option`] for one that there is not.
    pub fn set_number(&mut self, key: &str, value: f64) -> Result<(), PatternError> {
        let stands = self.stands();
        let settings = &mut self.settings;
        match key {
            "rpm" => settings.rpm = value,
            "step" => self.step_deg = Some(value),
            "start" => settings.start_deg = value,
            "d" => settings.d_m = value,
            "from" if stands => {
                settings.tilting.from_deg = value;
                settings.tilting.to_deg = value;
            }
            "from" => settings.tilting.from_deg = value,
            "to" if !stands => settings.tilting.to_deg = value,
            "speed" if !stands => self.speed_deg_s = Some(value),
            "to" | "speed" => {
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

    /// The pattern.
    ///
    /// # Errors
    /// [`PatternError`] for what cannot be, such as one that turns without a speed.
    pub fn build(&self) -> Result<Pattern, PatternError> {
        let mut settings = self.settings;
        settings.step_deg = self.step_deg.unwrap_or(settings.rpm * STEP_DEG_PER_RPM);
        let tilting = settings.tilting;
        if !self.stands() && tilting.to_deg == tilting.from_deg {
            let got = format!("both {}", tilting.from_deg);
            return Err(self.wrong("from and to that differ (vlp16 stands still)", got));
        }
        if tilting.to_deg != tilting.from_deg {
            let Some(speed_deg_s) = self.speed_deg_s.filter(|speed| *speed > 0.0) else {
                let name = name_of(&self.name);
                let got = self
                    .speed_deg_s
                    .map_or("none".to_owned(), |s| s.to_string());
                return Err(self.wrong(format!("a speed above 0 deg/s, as in {name}:50"), got));
            };
            settings.tilting.speed_deg_s = speed_deg_s;
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

/// What stands before the speed and the options.
fn name_of(text: &str) -> &str {
    text.split([':', ',']).next().unwrap_or_default()
}
