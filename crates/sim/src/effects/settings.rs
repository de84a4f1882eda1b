//! Settings of effects: what a scene file's `[effects.NAME]` may say, and what is wrong with it.
//!
//! A file of an effect has a struct of settings that maps to its table one to one; what can be left out has a default there. Left out: reading
//! the file, and lines ([`super::Wishes`] keeps where each table stands).

use core::ops::RangeInclusive;

use serde::de::DeserializeOwned;
use thiserror::Error;

use super::Asked;

/// A setting that cannot be.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("sim: effects.{effect}.{setting}: expected {expected}, got {got}")]
pub struct Unfit {
    /// Of which effect.
    pub effect: &'static str,
    /// Which setting.
    pub setting: &'static str,
    /// What it may be.
    pub expected: String,
    /// What it is.
    pub got: f64,
}

/// Nanoseconds from any beginning, where the cost of effects is to be measured.
pub type Stopwatch = Option<fn() -> u64>;

/// Settings of an effect.
pub trait Settings: DeserializeOwned {
    /// Puts the effect into its list, for a run with `seed`.
    ///
    /// # Errors
    /// [`Unfit`] for a setting that cannot be; nothing is added then.
    fn ask(&self, seed: u64, clock: Stopwatch, asked: &mut Asked) -> Result<(), Unfit>;
}

/// Checks of one effect's settings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Check(pub &'static str);

impl Check {
    /// Within, ends included; not a number is not.
    pub fn within(
        self,
        setting: &'static str,
        got: f64,
        range: RangeInclusive<f64>,
    ) -> Result<f64, Unfit> {
        let expected = || format!("{} to {}", range.start(), range.end());
        self.that(setting, got, range.contains(&got), expected)
    }

    /// Finite and above 0.
    pub fn above_0(self, setting: &'static str, got: f64) -> Result<f64, Unfit> {
        let fits = got > 0.0 && got.is_finite();
        self.that(setting, got, fits, || "a number above 0".to_owned())
    }

    /// Finite and not negative.
    pub fn not_negative(self, setting: &'static str, got: f64) -> Result<f64, Unfit> {
        let fits = got >= 0.0 && got.is_finite();
        self.that(setting, got, fits, || "0 or more".to_owned())
    }

    /// Finite.
    pub fn finite(self, setting: &'static str, got: f64) -> Result<f64, Unfit> {
        self.that(setting, got, got.is_finite(), || {
            "a finite number".to_owned()
        })
    }

    /// Whatever else has to hold.
    pub fn that(
        self,
        setting: &'static str,
        got: f64,
        fits: bool,
        expected: impl FnOnce() -> String,
    ) -> Result<f64, Unfit> {
        match fits {
            true => Ok(got),
            false => Err(Unfit {
                effect: self.0,
                setting,
                expected: expected(),
                got,
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_said() {
        let check = Check("backlash");
        assert_eq!(check.within("play_deg", 0.5, 0.0..=1.0), Ok(0.5));
        for wrong in [
            check.within("play_deg", f64::NAN, 0.0..=1.0),
            check.within("play_deg", 1.5, 0.0..=1.0),
            check.above_0("play_deg", 0.0),
            check.above_0("play_deg", f64::INFINITY),
            check.not_negative("play_deg", -0.1),
            check.finite("play_deg", f64::NAN),
        ] {
            let said = wrong.unwrap_err().to_string();
            assert!(
                said.starts_with("sim: effects.backlash.play_deg: expected "),
                "{said}"
            );
        }
    }
}
