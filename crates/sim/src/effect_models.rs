//! The effects, one file each, and the configuration that a scene file's `[effects]` maps to.
//!
//! Effects act in the order of [`EffectsConfig`], not of the file: light before noise,
//! the servo before the gear. A new effect needs a file and a line in the list below.

/// Implements what the effects have in common: the name, the reason for inactivity, and the
/// settings that add the effect to its list.
macro_rules! effect {
    ($effect:ident, $settings:ident, $($list:ident).+: $pointer:ident, $name:literal,
     idle: $idle:literal, $(needs: $needs:expr,)? new: $new:expr) => {
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
pub use settings::InvalidSetting;
pub use tolerance::EffectTolerance;

macro_rules! effects_config {
    ($($name:ident: $settings:ty,)*) => {
        /// `[effects]`: one table per configured effect.
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct EffectsConfig {
            $(#[doc = concat!("`[effects.", stringify!($name), "]`.")]
            pub $name: Option<$settings>,)*
        }

        impl EffectsConfig {
            /// All names, in the order in which effects act.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];

            /// Names of the configured effects, in the order in which they act.
            pub fn configured(&self) -> impl Iterator<Item = &'static str> {
                let names = [$(self.$name.is_some().then_some(stringify!($name))),*];
                names.into_iter().flatten()
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
                if let Some(weather) = &mut config.weather {
                    weather.reflectance = self.reflectance;
                }
                $(if let Some(settings) = &config.$name {
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
