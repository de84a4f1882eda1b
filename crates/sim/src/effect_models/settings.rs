//! Checks of the effects' settings.

use crate::effects::{ConfiguredEffects, Stopwatch};
use core::ops::RangeInclusive;

use serde::de::DeserializeOwned;
use serde::de::value::{self, MapDeserializer};
use thiserror::Error;

/// A setting with an invalid value.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("effects.{effect}.{setting}: expected {expected}, got {got}")]
#[non_exhaustive]
pub struct InvalidSetting {
    /// The effect.
    pub effect: &'static str,
    /// The setting.
    pub setting: &'static str,
    /// Valid values.
    pub expected: String,
    /// The value.
    pub got: f64,
}

/// Settings of an effect, the table `[effects.NAME]`.
pub trait EffectSettings: DeserializeOwned {
    /// The usual settings: the default of every key; `None` if a key has none.
    fn usual() -> Option<Self> {
        let nothing = core::iter::empty::<(&str, f64)>();
        Self::deserialize(MapDeserializer::<_, value::Error>::new(nothing)).ok()
    }

    /// Adds the effect to its list, for a run with `seed`.
    fn add(
        &self,
        seed: u64,
        stopwatch: Stopwatch,
        effects: &mut ConfiguredEffects,
    ) -> Result<(), InvalidSetting>;
}

/// Checks of the settings of the named effect.
#[derive(Clone, Copy, Debug)]
pub(super) struct SettingCheck(pub &'static str);

impl SettingCheck {
    /// Within a range, ends included.
    pub fn within(
        self,
        setting: &'static str,
        got: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, InvalidSetting> {
        match range.contains(&got) {
            true => Ok(got),
            false => {
                let expected = format!("{} to {}", range.start(), range.end());
                Err(self.invalid(setting, got, expected))
            }
        }
    }

    /// Finite and above 0.
    pub fn above_0(self, setting: &'static str, got: f64) -> Result<f64, InvalidSetting> {
        match got > 0.0 && got.is_finite() {
            true => Ok(got),
            false => Err(self.invalid(setting, got, "a number above 0")),
        }
    }

    /// Finite and not negative.
    pub fn not_negative(self, setting: &'static str, got: f64) -> Result<f64, InvalidSetting> {
        match got >= 0.0 && got.is_finite() {
            true => Ok(got),
            false => Err(self.invalid(setting, got, "0 or more")),
        }
    }

    /// Finite.
    pub fn finite(self, setting: &'static str, got: f64) -> Result<f64, InvalidSetting> {
        match got.is_finite() {
            true => Ok(got),
            false => Err(self.invalid(setting, got, "a finite number")),
        }
    }

    /// The error for a value.
    pub fn invalid(
        self,
        setting: &'static str,
        got: f64,
        expected: impl Into<String>,
    ) -> InvalidSetting {
        InvalidSetting {
            effect: self.0,
            setting,
            expected: expected.into(),
            got,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_reported() {
        let check = SettingCheck("backlash");
        assert_eq!(check.within("play_deg", 0.5, 0.0..=1.0), Ok(0.5));
        for invalid in [
            check.within("play_deg", f64::NAN, 0.0..=1.0),
            check.within("play_deg", 1.5, 0.0..=1.0),
            check.above_0("play_deg", 0.0),
            check.above_0("play_deg", f64::INFINITY),
            check.not_negative("play_deg", -0.1),
            check.finite("play_deg", f64::NAN),
        ] {
            let message = invalid.unwrap_err().to_string();
            assert!(
                message.starts_with("effects.backlash.play_deg: expected "),
                "{message}"
            );
        }
    }
}
