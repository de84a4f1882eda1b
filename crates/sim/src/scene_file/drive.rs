//! `[drive]`: how often the host asks the drive where it is, and how long an answer takes.
//!
//! The encoder is ideal (a quarter of a millionth of a degree a count) unless an effect says otherwise.

use serde::Deserialize;
use toml::Spanned;
use units::Gearing;

use super::Wrong;
use crate::simulate::Polls;

/// The section as it is written.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Section {
    /// Requests a second.
    poll_hz: Option<Spanned<f64>>,
    /// From a request to its answer, milliseconds.
    answer_ms: Option<Spanned<f64>>,
}

/// An ideal encoder: 30,000 lines behind 12,000:1 are 2.5e-7 degrees a count and 0.0005 deg/s an rpm, and 32 bits of them hold 536 degrees.
const IDEAL: Gearing = match Gearing::new(30_000, 12_000, 1) {
    Ok(gearing) => gearing,
    Err(_) => unreachable!(),
};

impl Section {
    pub fn build(&self) -> Result<Polls, Wrong> {
        let poll_hz = within(&self.poll_hz, 400.0, 0.1..=20_000.0, "polls a second")?;
        let answer_ms = within(&self.answer_ms, 1.0, 0.0..=10_000.0, "milliseconds")?;
        Ok(Polls {
            period_ns: (1e9 / poll_hz).round() as i64,
            answer_ns: (answer_ms * 1e6).round() as i64,
            gearing: IDEAL,
        })
    }
}

fn within(
    key: &Option<Spanned<f64>>,
    otherwise: f64,
    range: std::ops::RangeInclusive<f64>,
    unit: &str,
) -> Result<f64, Wrong> {
    let Some(number) = key else {
        return Ok(otherwise);
    };
    let got = *number.get_ref();
    if range.contains(&got) {
        return Ok(got);
    }
    let (low, high) = (range.start(), range.end());
    let what = format!("expected {low} to {high} {unit}, got {got}");
    Err(Wrong::new(number.span(), what))
}
