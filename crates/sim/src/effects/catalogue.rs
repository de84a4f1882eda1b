//! All effects by name: what `[effects]` of a scene file can ask for, and what is made of it.
//!
//! Effects act in the order of this list, whatever the file's: light before noise, the servo before the gear behind it. One line here is all
//! that a new effect needs beside its file. Left out: the rest of a scene file.

use core::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::settings::{Settings, Stopwatch, Unfit};
use super::{
    Asked, BacklashSettings, BatchingSettings, DivergenceSettings, DuplicateSettings,
    EncoderQuantisationSettings, GearRippleSettings, LidarClockSettings,
    LimitedFieldOfViewSettings, LinkJitterSettings, LossSettings, MovingObjectsSettings,
    OwnShadowSettings, RangeNoiseSettings, ReflectanceSettings, ReorderSettings, ServoLagSettings,
    TiltLimitsSettings, WeatherSettings,
};

/// A setting that cannot be, and where its table stands in the file's text.
#[derive(Clone, Debug, PartialEq)]
pub struct Misplaced {
    /// What is wrong.
    pub unfit: Unfit,
    /// Bytes of the text.
    pub at: Range<usize>,
}

impl Misplaced {
    /// Where the setting stands in the file's text: its line if the table has lines, else the table.
    #[must_use]
    pub fn offset(&self, text: &str) -> usize {
        let from = self.at.start;
        let mut offset = from;
        let lines = text.get(from..).unwrap_or_default().split_inclusive('\n');
        for (number, line) in lines.enumerate() {
            let words = line.trim_start();
            if number > 0 && words.starts_with('[') {
                break;
            }
            let rest = words.strip_prefix(self.unfit.setting);
            if rest.is_some_and(|rest| rest.trim_start().starts_with('=')) {
                return offset;
            }
            offset += line.len();
        }
        from
    }
}

/// An effect that is asked for, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wish {
    /// Its name.
    pub name: &'static str,
    /// Bytes of the text.
    pub at: Range<usize>,
}

macro_rules! catalogue {
    ($($name:ident: $settings:ty,)*) => {
        /// `[effects]` as it is written: a table for each effect, nothing for those that are not asked for.
        #[derive(Clone, Debug, Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Wishes {
            $(#[doc = concat!("`[effects.", stringify!($name), "]`.")]
            pub $name: Option<Spanned<$settings>>,)*
        }

        impl Wishes {
            /// All names that there are.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($name)),*];

            /// Those that are asked for, in the order in which they act.
            #[must_use]
            pub fn asked_for(&self) -> Vec<Wish> {
                let mut wishes = Vec::new();
                $(if let Some(table) = &self.$name {
                    wishes.push(Wish { name: stringify!($name), at: table.span() });
                })*
                wishes
            }

            /// Makes them, for a run with `seed`; `clock` gives nanoseconds from any beginning where costs are to be measured.
            ///
            /// # Errors
            /// [`Misplaced`] for the first setting that cannot be.
            pub fn make(&self, seed: u64, clock: Stopwatch) -> Result<Asked, Misplaced> {
                let mut asked = Asked::default();
                $(if let Some(table) = &self.$name {
                    table.get_ref().ask(seed, clock, &mut asked).map_err(|unfit| Misplaced {
                        unfit,
                        at: table.span(),
                    })?;
                })*
                Ok(asked)
            }
        }
    };
}

catalogue! {
    limited_field_of_view: LimitedFieldOfViewSettings,
    own_shadow: OwnShadowSettings,
    moving_objects: MovingObjectsSettings,
    divergence: DivergenceSettings,
    weather: WeatherSettings,
    reflectance: ReflectanceSettings,
    range_noise: RangeNoiseSettings,
    lidar_clock: LidarClockSettings,
    servo_lag: ServoLagSettings,
    tilt_limits: TiltLimitsSettings,
    gear_ripple: GearRippleSettings,
    backlash: BacklashSettings,
    encoder_quantisation: EncoderQuantisationSettings,
    duplicate: DuplicateSettings,
    loss: LossSettings,
    link_jitter: LinkJitterSettings,
    reorder: ReorderSettings,
    batching: BatchingSettings,
}

#[cfg(test)]
mod tests;
