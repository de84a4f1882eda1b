//! View: the sensor fires only between two azimuths, as its web interface sets it (63-9243,
//! sections 10.1 and 10.2.3.7).
//!
//! Outside, no block is sent. A packet is filled across the gap, so its last blocks can be later by
//! the whole gap. A block fires or does not as a whole, as in measured sensors.

use crate::effects::{Needs, ViewEffect};
use std::sync::Arc;

use serde::Deserialize;

use super::settings::{InvalidSetting, SettingCheck};

/// `[effects.limited_field_of_view]`. The view extends clockwise from the first azimuth to the
/// second, across 0 where the first is greater; equal azimuths are the whole revolution.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct LimitedFieldOfViewSettings {
    /// Begin of the view, 0 to 360 degrees.
    pub from_deg: f64,
    /// End of the view, exclusive, 0 to 360 degrees.
    pub to_deg: f64,
}

/// The part of a revolution in which the sensor fires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedFieldOfView {
    from_deg: f64,
    width_deg: f64,
}

impl LimitedFieldOfView {
    /// With these settings.
    ///
    /// # Errors
    /// [`InvalidSetting`] for azimuths out of range.
    pub fn new(settings: &LimitedFieldOfViewSettings) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let from_deg = check.within("from_deg", settings.from_deg, 0.0..=360.0)?;
        let to_deg = check.within("to_deg", settings.to_deg, 0.0..=360.0)?;
        let width_deg = (to_deg - from_deg).rem_euclid(360.0);
        Ok(Self {
            from_deg,
            width_deg: if width_deg == 0.0 { 360.0 } else { width_deg },
        })
    }
}

effect! {
    LimitedFieldOfView, LimitedFieldOfViewSettings, firings.view: Arc, "limited_field_of_view",
    idle: "every block fires within it",
    needs: |_| Needs {
            azimuths: true,
            ..Needs::default()
        },
    new: |settings, _| LimitedFieldOfView::new(settings)
}

impl ViewEffect for LimitedFieldOfView {
    fn fires(&self, azimuth_deg: f64) -> bool {
        (azimuth_deg - self.from_deg).rem_euclid(360.0) < self.width_deg
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_view_may_cross_zero() {
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
