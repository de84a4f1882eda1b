//! Encoder: a counter reports the last edge that the shaft passed, not the nearest.
//!
//! Without this effect, positions are rounded to the nearest count of the drive's gearing. With it,
//! they are rounded down to counts of the encoder configured here, which the log then carries.
//! Uneven edges and missed counts are not included.

use crate::effects::EncoderEffect;
use serde::Deserialize;
use units::{Degrees, Gearing};

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.encoder_quantisation]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct EncoderQuantisationSettings {
    /// Encoder lines per motor revolution, four counts each; default 500.
    pub encoder_lines: u32,
    /// Gear: motor revolutions, axis revolutions; default 120 and 1.
    pub gear: [u32; 2],
}

impl Default for EncoderQuantisationSettings {
    fn default() -> Self {
        Self {
            encoder_lines: 500,
            gear: [120, 1],
        }
    }
}

/// An encoder that counts edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderQuantisation {
    gearing: Gearing,
    degrees_per_qc: f64,
}

/// Tolerance at an edge, counts: covers the rounding of the angle.
const ROUNDING_QC: f64 = 1e-6;

impl EncoderQuantisation {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for an invalid gearing.
    pub fn new(settings: &EncoderQuantisationSettings) -> Result<Self, InvalidSetting> {
        let [motor, axis] = settings.gear;
        let lines = settings.encoder_lines;
        let gearing = Gearing::new(lines, motor, axis).map_err(|_| InvalidSetting {
            effect: Self::NAME,
            setting: "encoder_lines",
            expected: "1 to 2^30 - 1 lines, and gear turns above 0".to_owned(),
            got: f64::from(lines),
        })?;
        let degrees_per_qc =
            SettingCheck(Self::NAME).above_0("encoder_lines", gearing.degrees_per_qc())?;
        Ok(Self {
            gearing,
            degrees_per_qc,
        })
    }
}

effect! {
    EncoderQuantisation, EncoderQuantisationSettings, encoder: Box, "encoder_quantisation",
    idle: "the shaft stood on an edge at every poll, or there was none",
    new: |settings, _| EncoderQuantisation::new(settings)
}

impl EncoderEffect for EncoderQuantisation {
    fn read(&mut self, _: u64, shaft: Degrees) -> Degrees {
        let counts = (shaft.0 / self.degrees_per_qc + ROUNDING_QC).floor();
        Degrees(counts * self.degrees_per_qc)
    }

    fn gearing(&self) -> Option<Gearing> {
        Some(self.gearing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_encoder_reports_the_edge_below() {
        let mut encoder =
            EncoderQuantisation::new(&EncoderQuantisationSettings::default()).unwrap();
        for (shaft, counts) in [
            (0.0, 0.0),
            (0.0014, 0.0),
            (0.0015, 1.0),
            (0.0045, 3.0),
            (-0.0001, -1.0),
            (-45.0, -30_000.0),
        ] {
            let read = encoder.read(0, Degrees(shaft)).0;
            assert!((read - counts * 0.0015).abs() < 1e-12, "{shaft}: {read}");
        }
        let none = EncoderQuantisationSettings {
            encoder_lines: 0,
            ..Default::default()
        };
        assert!(EncoderQuantisation::new(&none).is_err());
    }
}
