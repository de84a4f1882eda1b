//! Facts that a scene states in sections of its own, as the settings of the effects that they call
//! for.

use super::Sections;
use crate::effect_models::settings_of::RangeNoiseSettings;
use crate::effect_models::{EffectRequest, EffectsConfig};
use crate::scenery::line_of_value;

/// A stated fact: the effect that it calls for, and where it is in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct StatedFact {
    pub effect: &'static str,
    /// Its keys, joined by dots.
    pub path: &'static str,
    pub line: usize,
}

/// The facts that a file states.
pub(super) fn stated(sections: &Sections, text: &str) -> (EffectsConfig, Vec<StatedFact>) {
    let (mut config, mut facts) = (EffectsConfig::default(), Vec::new());
    macro_rules! state {
        ($($effect:ident = $value:expr, $path:literal;)*) => {
            $(if let Some(settings) = $value.clone() {
                config.$effect = EffectRequest::Settings(settings);
                facts.push(StatedFact {
                    effect: stringify!($effect),
                    path: $path,
                    line: line_of_value(text, $path),
                });
            })*
        };
    }
    let (sensor, drive, link) = (&sections.sensor, &sections.drive, &sections.link);
    state! {
        own_shadow = sections.mount.shadow, "mount.shadow";
        base_drift = sections.base, "base";
        weather = sections.weather, "weather";
        range_noise = sensor.noise, "sensor.noise";
        lidar_clock = sensor.clock, "sensor.clock";
        servo_lag = drive.servo, "drive.servo";
        tilt_limits = drive.stops, "drive.stops";
        gear_ripple = drive.gear_ripple, "drive.gear_ripple";
        eccentricity = drive.eccentricity, "drive.eccentricity";
        backlash = drive.backlash, "drive.backlash";
        encoder_quantisation = drive.encoder, "drive.encoder";
        duplicate = link.duplicate, "link.duplicate";
        loss = link.loss, "link.loss";
        link_jitter = link.delay, "link.delay";
        reorder = link.reorder, "link.reorder";
        batching = link.batching, "link.batching";
    }
    if sensor.noise.is_none() {
        // That of the lidar, at its far ranges.
        let [_, sd_m] = sensor.model().range_sd_m();
        config.range_noise = EffectRequest::Settings(RangeNoiseSettings { sd_m });
    }
    (config, facts)
}
