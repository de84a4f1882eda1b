//! View: the sensor fires between two azimuths only, as its web interface sets it (63-9243, sections 10.1 and 10.2.3.7).
//!
//! Nothing is fired beyond them and no block is sent, so a packet is filled across the gap and its last blocks can be a whole gap later than its
//! first. Left out: azimuths of single lasers; a block fires or does not as a whole, as measured sensors do.

use std::sync::Arc;

use serde::Deserialize;

use super::settings::{Check, Settings, Stopwatch, Unfit};
use super::{Absorb, Asked, Effect, Listed, Needs, View};

/// `[effects.limited_field_of_view]`. It goes clockwise from one azimuth to the other, over 0 where the first is the greater; the same azimuth
/// twice is the whole turn.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct LimitedFieldOfViewSettings {
    /// Where firing begins, 0 to 360 degrees.
    pub from_deg: f64,
    /// Where it ends, 0 to 360 degrees, not included.
    pub to_deg: f64,
}

/// The part of a turn in which the sensor fires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedFieldOfView {
    from_deg: f64,
    width_deg: f64,
}

impl LimitedFieldOfView {
    /// What the scene file calls it.
    pub const NAME: &'static str = "limited_field_of_view";

    /// With these settings.
    ///
    /// # Errors
    /// [`Unfit`] for azimuths out of their range.
    pub fn new(settings: &LimitedFieldOfViewSettings) -> Result<Self, Unfit> {
        let check = Check(Self::NAME);
        let from_deg = check.within("from_deg", settings.from_deg, 0.0..=360.0)?;
        let to_deg = check.within("to_deg", settings.to_deg, 0.0..=360.0)?;
        let width_deg = (to_deg - from_deg).rem_euclid(360.0);
        Ok(Self {
            from_deg,
            width_deg: if width_deg == 0.0 { 360.0 } else { width_deg },
        })
    }
}

impl Settings for LimitedFieldOfViewSettings {
    fn ask(&self, _: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit> {
        let effect = Arc::new(LimitedFieldOfView::new(self)?);
        asked.firings.view.push(Listed::new(effect, clock));
        Ok(())
    }
}

impl Effect for LimitedFieldOfView {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn needs(&self) -> Needs {
        Needs {
            azimuths: true,
            ..Needs::NOTHING
        }
    }

    fn why_idle(&self) -> &'static str {
        "every block fires within it"
    }
}

impl Absorb for LimitedFieldOfView {}

impl View for LimitedFieldOfView {
    fn fires(&self, azimuth_deg: f64) -> bool {
        (azimuth_deg - self.from_deg).rem_euclid(360.0) < self.width_deg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_clockwise_over_zero_too() {
        let view = |from_deg, to_deg| {
            LimitedFieldOfView::new(&LimitedFieldOfViewSettings { from_deg, to_deg }).unwrap()
        };
        let fires = |view: LimitedFieldOfView, at: &[f64]| {
            at.iter().map(|deg| view.fires(*deg)).collect::<Vec<_>>()
        };
        let at = [0.0, 89.9, 90.0, 269.9, 270.0, 359.9];
        let (yes, no) = (true, false);
        assert_eq!(fires(view(90.0, 270.0), &at), [no, no, yes, yes, no, no]);
        assert_eq!(fires(view(270.0, 90.0), &at), [yes, yes, no, no, yes, yes]);
        assert_eq!(fires(view(0.0, 360.0), &at), [yes; 6]);
        assert_eq!(fires(view(10.0, 10.0), &at), [yes; 6]);
        let wrong = LimitedFieldOfViewSettings {
            from_deg: -1.0,
            to_deg: 0.0,
        };
        assert_eq!(
            LimitedFieldOfView::new(&wrong).unwrap_err().setting,
            "from_deg"
        );
    }
}
