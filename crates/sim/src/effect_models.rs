//! The effects, one file each, and the configuration that a scene file's `[effects]` maps to.
//!
//! Effects act in the order of [`EffectsConfig`], not of the file: light before noise,
//! the servo before the gear. A new effect needs a file, its `mod`, a line in `effects_config!`
//! and, if a fact of a scene calls for it, one in `settings_of`.

/// Implements what the effects have in common: the name, the reason for inactivity, and the
/// settings that add the effect to its list.
///
/// `$list` is a field of [`ConfiguredEffects`], and `$pointer` what that list holds: `Arc` where
/// threads share the effect, else `Box`. `needs` is what the effect asks of the simulator, `usual`
/// its settings for a scene that calls for it, where the defaults are others.
macro_rules! effect {
    ($effect:ident, $settings:ident, $($list:ident).+: $pointer:ident, $name:literal,
     idle: $idle:literal, $(needs: $needs:expr,)? $(usual: $usual:expr,)? new: $new:expr) => {
        impl $effect {
            /// The key in the scene file's `[effects]`.
            pub const NAME: &'static str = $name;
        }

        impl crate::effects::Effect for $effect {
            fn name(&self) -> &'static str {
                Self::NAME
            }

            $(fn needs(&self) -> crate::effects::Needs {
                let needs: fn(&Self) -> crate::effects::Needs = $needs;
                needs(self)
            })?

            fn idle_reason(&self) -> &'static str {
                $idle
            }
        }

        impl super::settings::EffectSettings for $settings {
            $(fn usual() -> Option<Self> {
                Some($usual)
            })?

            fn add(
                &self,
                seed: u64,
                stopwatch: crate::effects::Stopwatch,
                effects: &mut crate::effects::ConfiguredEffects,
            ) -> Result<(), super::settings::InvalidSetting> {
                let new: fn(&Self, u64) -> Result<$effect, super::settings::InvalidSetting> = $new;
                let effect = $pointer::new(new(self, seed)?);
                effects.$($list).+.push(crate::effects::MeteredEffect::new(effect, stopwatch));
                Ok(())
            }
        }
    };
}

mod backlash;
mod base_drift;
mod batching;
mod divergence;
mod duplicate;
mod eccentricity;
mod encoder_quantisation;
mod explain;
mod gear_ripple;
mod laser_errors;
mod lidar_clock;
mod light;
mod limited_field_of_view;
mod link_jitter;
mod loss;
mod moving_objects;
mod own_shadow;
pub(crate) mod range_noise;
mod reflectance;
mod reorder;
mod request;
mod returns;
mod selection;
mod servo_lag;
mod settings;
#[cfg(test)]
mod testing;
mod tilt_limits;
mod tolerance;
mod weather;

use serde::Deserialize;

use crate::effects::{ConfiguredEffects, Stopwatch};
use settings::EffectSettings;

pub use divergence::{Divergence, DivergenceSettings};
pub use explain::{EffectExplanation, EffectLine, Explanation};
pub use moving_objects::{Mover, MovingObjects};
pub use reflectance::ReflectanceSettings;
pub use request::EffectRequest;
pub use settings::InvalidSetting;
pub use tolerance::EffectTolerance;
pub(crate) use weather::Weather;

/// Settings of effects that facts of a scene call for.
pub(crate) mod settings_of {
    pub(crate) use super::backlash::Backlash;
    pub(crate) use super::base_drift::BaseDrift;
    pub(crate) use super::batching::Batching;
    pub(crate) use super::duplicate::DuplicateSettings;
    pub(crate) use super::eccentricity::Eccentricity;
    pub(crate) use super::encoder_quantisation::EncoderQuantisationSettings;
    pub(crate) use super::gear_ripple::GearRippleSettings;
    pub(crate) use super::lidar_clock::LidarClockSettings;
    pub(crate) use super::link_jitter::LinkJitterSettings;
    pub(crate) use super::loss::LossSettings;
    pub(crate) use super::own_shadow::OwnShadowSettings;
    pub(crate) use super::range_noise::RangeNoiseSettings;
    pub(crate) use super::reorder::ReorderSettings;
    pub(crate) use super::servo_lag::ServoLagSettings;
    pub(crate) use super::tilt_limits::TiltLimits;
    pub(crate) use super::weather::WeatherSettings;
}

macro_rules! effects_config {
    ($($name:ident: $settings:ty,)*) => {
        /// `[effects]`: one key per effect, with its settings, `true` or `false`.
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct EffectsConfig {
            /// `all = false`: no effect but those that have a key.
            pub all: Option<bool>,
            $(#[doc = concat!("`[effects.", stringify!($name), "]`.")]
            pub $name: EffectRequest<$settings>,)*
        }

        impl EffectsConfig {
            /// All names, in the order in which effects act.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];

            /// Names of the configured effects, in the order in which they act.
            pub fn configured(&self) -> impl Iterator<Item = &'static str> {
                let names = [$(self.$name.settings().map(|_| stringify!($name))),*];
                names.into_iter().flatten()
            }

            /// Names of the effects that are `true`: they are on in any case.
            pub fn forced(&self) -> impl Iterator<Item = &'static str> {
                let names = [
                    $(matches!(self.$name, EffectRequest::On(_)).then_some(stringify!($name))),*
                ];
                names.into_iter().flatten()
            }

            /// Whether the effect has a key.
            #[must_use]
            pub fn has_key(&self, name: &str) -> bool {
                match name {
                    $(stringify!($name) => !matches!(self.$name, EffectRequest::Absent),)*
                    _ => false,
                }
            }

            /// Whether the effect is `false`, or has no key and `all` is `false`.
            #[must_use]
            pub fn is_off(&self, name: &str) -> bool {
                match name {
                    $(stringify!($name) => match &self.$name {
                        EffectRequest::Off => true,
                        EffectRequest::Absent => self.all == Some(false),
                        _ => false,
                    })*
                    _ => false,
                }
            }

            /// Takes the settings of `facts` for effects that have none here, or that are only
            /// switched on.
            pub(crate) fn complete(&mut self, facts: Self) {
                $(match (&mut self.$name, facts.$name) {
                    (EffectRequest::On(own), EffectRequest::Settings(fact)) => *own = fact,
                    (own, fact) if own.settings().is_none() => *own = fact,
                    _ => {}
                })*
            }

            /// Configures an effect with its usual settings, if it is not configured and has any.
            pub(crate) fn add_usual(&mut self, name: &str) {
                match name {
                    $(stringify!($name) if self.$name.settings().is_none() => {
                        if let Some(usual) = settings::EffectSettings::usual() {
                            self.$name = EffectRequest::Settings(usual);
                        }
                    })*
                    _ => {}
                }
            }

            /// Only the effects that `keep` selects.
            #[must_use]
            pub(crate) fn only(mut self, keep: impl Fn(&str) -> bool) -> Self {
                $(if !keep(stringify!($name)) {
                    self.$name = EffectRequest::Absent;
                })*
                self
            }

            /// Creates the configured effects for a run with `seed`. `stopwatch` measures their
            /// cost.
            ///
            /// # Errors
            /// [`InvalidSetting`] for the first setting that is invalid.
            pub fn build(
                &self,
                seed: u64,
                stopwatch: Stopwatch,
            ) -> Result<ConfiguredEffects, InvalidSetting> {
                let mut effects = ConfiguredEffects::default();
                let mut config = self.clone();
                if let EffectRequest::On(weather) | EffectRequest::Settings(weather) =
                    &mut config.weather
                {
                    *weather = weather.detected_by(self.reflectance.settings().copied());
                }
                $(if let Some(settings) = config.$name.settings() {
                    settings.add(seed, stopwatch, &mut effects)?;
                })*
                Ok(effects)
            }
        }
    };
}

effects_config! {
    limited_field_of_view: limited_field_of_view::LimitedFieldOfViewSettings,
    own_shadow: own_shadow::OwnShadowSettings,
    base_drift: base_drift::BaseDrift,
    moving_objects: moving_objects::MovingObjectsSettings,
    divergence: divergence::DivergenceSettings,
    weather: weather::WeatherSettings,
    reflectance: reflectance::ReflectanceSettings,
    laser_errors: laser_errors::LaserErrorsSettings,
    range_noise: range_noise::RangeNoiseSettings,
    lidar_clock: lidar_clock::LidarClockSettings,
    servo_lag: servo_lag::ServoLagSettings,
    tilt_limits: tilt_limits::TiltLimits,
    gear_ripple: gear_ripple::GearRippleSettings,
    eccentricity: eccentricity::Eccentricity,
    backlash: backlash::Backlash,
    encoder_quantisation: encoder_quantisation::EncoderQuantisationSettings,
    duplicate: duplicate::DuplicateSettings,
    loss: loss::LossSettings,
    link_jitter: link_jitter::LinkJitterSettings,
    reorder: reorder::ReorderSettings,
    batching: batching::Batching,
}

#[cfg(test)]
mod tests;
