//! Surface: the light that comes back, its detection, and the reported reflectivity.
//!
//! The light of a surface that fills the beam falls with the incidence ([`light::of_surface`]) and
//! the square of the range. A return is detected if light plus noise exceeds a threshold; the noise
//! is normal with a standard deviation of `1 / threshold_snr` of it, so the probability is 1/2
//! where the light equals the threshold. The sensor corrects the reflectivity for range (63-9243,
//! section 6.1) but not for incidence. The manual gives 1 to 100 m without a target. By default a
//! target of 10 % is detected half the time at 50 m, and one of 50 % nine times of ten at 100 m.
//! Speckle is not included.

use crate::effects::{Needs, SurfaceEffect};
use crate::firing::{Echo, Echoes, SimulatedFiring};
use std::sync::Arc;

use glam::DVec3;
use serde::Deserialize;

use super::light;
use super::settings::{InvalidSetting, SettingCheck};
use crate::random::RandomSource;

/// `[effects.reflectance]`.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct ReflectanceSettings {
    /// Range at which a target is detected half the time head-on, metres.
    pub half_range_m: f64,
    /// Reflectivity of that target, percent.
    pub half_reflectivity: f64,
    /// Detection threshold in standard deviations of the noise.
    pub threshold_snr: f64,
    /// Whether light falls with incidence, which needs normals; without, all light counts as
    /// diffuse.
    pub incidence: bool,
}

impl Default for ReflectanceSettings {
    fn default() -> Self {
        Self {
            half_range_m: light::HALF_RANGE_M,
            half_reflectivity: light::HALF_REFLECTIVITY,
            threshold_snr: 5.0,
            incidence: true,
        }
    }
}

impl ReflectanceSettings {
    /// Light that comes back from a surface over the threshold of detection. `cosine` is that of
    /// the incidence.
    pub(crate) fn detection(
        &self,
        reflectivity: u8,
        specular: f64,
        cosine: f64,
        range_m: f64,
    ) -> f64 {
        let head_on = light::of_reflectivity(f64::from(reflectivity));
        let light = match self.incidence {
            true => light::of_surface(head_on, specular, cosine),
            false => head_on,
        };
        self.over_threshold(light / (range_m * range_m))
    }

    /// Light over the square of its distance, by the threshold of detection.
    pub(crate) fn over_threshold(&self, strength: f64) -> f64 {
        let half_m2 = self.half_range_m * self.half_range_m;
        strength * half_m2 / light::of_reflectivity(self.half_reflectivity)
    }
}

/// Light and its detection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    threshold: f64,
    snr: f64,
    incidence: bool,
    random: RandomSource,
}

impl Reflectance {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for numbers out of range.
    pub fn new(settings: &ReflectanceSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let half_m = check.within("half_range_m", settings.half_range_m, 1.0..=1e4)?;
        let percent = check.within("half_reflectivity", settings.half_reflectivity, 0.1..=100.0)?;
        Ok(Self {
            threshold: light::of_reflectivity(percent) / (half_m * half_m),
            snr: check.within("threshold_snr", settings.threshold_snr, 1.0..=100.0)?,
            incidence: settings.incidence,
            random: RandomSource::new(seed, Self::NAME),
        })
    }

    /// The echo as the sensor reports it.
    #[inline]
    fn seen(&self, echo: &Echo, direction: DVec3, mut unit: impl FnMut() -> f64) -> Echo {
        let head_on = light::of_reflectivity(echo.reflectivity);
        let light = light::of_echo(echo, direction, self.incidence);
        let above = light / (echo.range_m * echo.range_m * self.threshold) - 1.0;
        let margin_sd = self.snr * above;
        // Beyond six standard deviations no draw is needed.
        if margin_sd < -6.0 || (margin_sd < 6.0 && unit() >= normal_below(margin_sd)) {
            return Echo::NONE;
        }
        Echo {
            reflectivity: match light == head_on {
                true => echo.reflectivity,
                false => light::to_reflectivity(light),
            },
            ..*echo
        }
    }
}

/// The normal distribution function (Abramowitz and Stegun 26.2.17, within 7.5e-8).
fn normal_below(x: f64) -> f64 {
    const TERMS: [f64; 5] = [
        0.319_381_530,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = TERMS.iter().rev().fold(0.0, |sum, term| t * (sum + term));
    let density = (-0.5 * x * x).exp() / core::f64::consts::TAU.sqrt();
    let above = density * series;
    if x >= 0.0 { 1.0 - above } else { above }
}

effect! {
    Reflectance, ReflectanceSettings, firings.surface: Arc, "reflectance",
    idle: "every return was strong enough, and none came in at an angle",
    needs: |effect| Needs {
            normals: effect.incidence,
            ..Needs::default()
        },
    new: Reflectance::new
}

impl SurfaceEffect for Reflectance {
    fn reflect(&self, firing: &SimulatedFiring, echoes: &mut Echoes) -> u32 {
        let mut acted = 0;
        for (echoes, set) in echoes.all_mut().zip(0_u32..) {
            let lasers = echoes.iter_mut().zip(&firing.directions).zip(0_u32..);
            for ((echo, direction), laser) in lasers {
                if !echo.is_present() {
                    continue;
                }
                let draw = || self.random.at(firing.number, 32 * set + laser).unit();
                let seen = self.seen(echo, *direction, draw);
                acted += u32::from(seen != *echo);
                *echo = seen;
            }
        }
        acted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect_models::testing::{echo, firing};
    use crate::effects::Effect;

    fn detected_share(reflectance: &Reflectance, of: Echo) -> f64 {
        let mut firing = firing(0.0, 0.0);
        let mut noticed = 0;
        for number in 0..500 {
            firing.number = number;
            let mut echoes = Echoes::new(16, false);
            echoes.strongest.fill(of);
            reflectance.reflect(&firing, &mut echoes);
            let seen = echoes.strongest.iter().take(16);
            noticed += seen.filter(|echo| echo.is_present()).count();
        }
        noticed as f64 / 8_000.0
    }

    #[test]
    fn targets_are_detected_as_far_as_they_return_enough_light() {
        let reflectance = Reflectance::new(&ReflectanceSettings::default(), 1).unwrap();
        let share =
            |range_m, reflectivity| detected_share(&reflectance, echo(range_m, reflectivity));
        let error = 4.0 * (0.25_f64 / 8_000.0).sqrt();
        assert!((share(50.0, 10.0) - 0.5).abs() < error);
        // Light falls by 1 / 1.1^2: by 0.1736 of the threshold, 0.868 standard deviations.
        assert!((share(55.0, 10.0) - 0.1927).abs() < error);
        assert_eq!(share(25.0, 10.0), 1.0);
        // Noise alone occasionally exceeds the threshold.
        assert!(share(100.0, 10.0) < 0.002);
        // The whole range of the manual, and a retroreflector outside the range of packets.
        assert!(share(100.0, 80.0) > 0.999);
        assert_eq!(share(250.0, 255.0), 1.0);
        assert_eq!(share(1.0, 0.0), 0.0);
    }

    #[test]
    fn light_and_reported_reflectivity_fall_with_incidence() {
        let reflectance = Reflectance::new(&ReflectanceSettings::default(), 1).unwrap();
        let slant = |deg: f64| Echo {
            normal: DVec3::new(deg.to_radians().sin(), -deg.to_radians().cos(), 0.0),
            ..echo(10.0, 60.0)
        };
        let seen = |echo: Echo| reflectance.seen(&echo, DVec3::Y, || 0.5);
        assert!((seen(slant(60.0)).reflectivity - 30.0).abs() < 1e-9);
        assert!((seen(slant(0.0)).reflectivity - 60.0).abs() < 1e-9);
        assert_eq!(seen(slant(60.0)).range_m, 10.0);
        assert!(!seen(slant(89.99)).is_present());
        let blind = ReflectanceSettings {
            incidence: false,
            ..Default::default()
        };
        let blind = Reflectance::new(&blind, 1).unwrap();
        assert!(!blind.needs().normals && reflectance.needs().normals);
        let slanted = slant(89.99);
        assert_eq!(blind.seen(&slanted, DVec3::Y, || 0.5), slanted);
    }

    /// A window returns little diffuse light at an angle, and much specular light at normal
    /// incidence.
    #[test]
    fn glass_returns_only_where_it_faces_the_sensor() {
        let reflectance = Reflectance::new(&ReflectanceSettings::default(), 1).unwrap();
        let seen = |deg: f64, range_m| {
            let pane = Echo {
                normal: DVec3::new(deg.to_radians().sin(), -deg.to_radians().cos(), 0.0),
                specular: 0.8,
                ..echo(range_m, 6.0)
            };
            reflectance.seen(&pane, DVec3::Y, || 0.5)
        };
        assert!(seen(0.0, 30.0).reflectivity > 100.0);
        assert!(!seen(10.0, 30.0).is_present());
        // 1.2 % diffuse, detected half the time at 50 m * sqrt(0.12) = 17.3 m.
        let near = seen(45.0, 10.0);
        assert!((near.reflectivity - 1.2 * 0.5_f64.sqrt()).abs() < 1e-9);
        assert!(!seen(45.0, 18.0).is_present());
    }

    #[test]
    fn the_normal_distribution_matches_known_values() {
        for (x, p) in [
            (0.0, 0.5),
            (1.0, 0.841_344_746),
            (-1.0, 0.158_655_254),
            (3.0, 0.998_650_102),
            (-6.0, 9.866e-10),
        ] {
            assert!((normal_below(x) - p).abs() < 1e-7, "{x}");
        }
    }
}
