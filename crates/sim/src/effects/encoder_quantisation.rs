//! Encoder: a counter of edges says the last edge that the shaft has passed, not the nearest.
//!
//! Without this effect positions are rounded to the nearest count of the drive's gearing. With it they are floored to counts of the encoder
//! named here, which is also what the log is of. Left out: edges that are not evenly spaced, and missed counts.

use serde::Deserialize;
use units::{Degrees, Gearing};

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Asked, Effect, Encoder, Listed};

/// `[effects.encoder_quantisation]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(deny_unknown_fields, default)]
pub struct EncoderQuantisationSettings {
    /// Lines of the encoder in a turn of the motor, four counts each; 500 unless said.
    pub encoder_lines: u32,
    /// The gear: turns of the motor in so many of the axis; 120 in 1 unless said.
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

/// An encoder that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EncoderQuantisation {
    gearing: Gearing,
    degrees_per_qc: f64,
}

/// An edge is passed within so much of a count: rounding of the angle, not of the encoder.
const ROUNDING_QC: f64 = 1e-6;

impl EncoderQuantisation {
    /// What the scene file calls it.
    pub const NAME: &'static str = "encoder_quantisation";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for a gearing that cannot be.
    pub fn new(settings: &EncoderQuantisationSettings) -> Result<Self, Unfit> {
        let [motor, axis] = settings.gear;
        let lines = settings.encoder_lines;
        let gearing = Gearing::new(lines, motor, axis).map_err(|_| Unfit {
            effect: Self::NAME,
            setting: "encoder_lines",
            expected: "1 to 2^30 lines, and gear turns above 0".to_owned(),
            got: f64::from(lines),
        })?;
        let degrees_per_qc =
            Check(Self::NAME).above_0("encoder_lines", gearing.degrees_per_qc())?;
        Ok(Self {
            gearing,
            degrees_per_qc,
        })
    }
}

impl Settings for EncoderQuantisationSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Box::new(EncoderQuantisation::new(self)?);
        asked.encoder.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for EncoderQuantisation {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn why_idle(&self) -> &'static str {
        "the shaft stood on an edge at every poll, or there was none"
    }
}

impl Encoder for EncoderQuantisation {
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
    fn it_says_the_edge_below() {
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
