//! Beam: fog and rain, which absorb light and scatter some back.
//!
//! Light falls with exp(-2 s R) there and back (Beer and Lambert). In fog, s follows from the
//! visibility, at which 5 % of the light is left (Koschmieder 1924; the meteorological optical
//! range of WMO): s = ln 20 / V = 3 / V, for droplets larger than the wavelength. In rain it is
//! 1.076 h^0.67 dB/km at h mm/h (Carbonneau and Wisely 1998).
//!
//! Drops scatter s / 18.8 per steradian back (O'Connor, Illingworth and Hogan 2004, at 905 nm).
//! Over the 0.9 m that a pulse of 6 ns illuminates at once, that is a surface of reflectivity pi *
//! 0.9 m * s / 18.8; the number of drops in it is exponentially distributed. There is at most one
//! such return per pulse, at a distance drawn with density 1 / R^2, if it exceeds the light of a 10
//! % target at 50 m. A surface below that is lost once the air takes 95 % of its light; detection
//! in clear air is the reflectance effect. Multiple scattering, gusts and drops on the window are
//! not included.

use crate::effects::BeamEffect;
use crate::firing::{Echo, Echoes, Firing, Surroundings};
use std::sync::Arc;

use serde::Deserialize;

use super::light;
use super::returns::{Return, reported};
use super::settings::{InvalidSetting, SettingCheck};
use crate::random::Source;

/// `[effects.weather]`; absent settings have no effect.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct WeatherSettings {
    /// Visibility in fog (meteorological optical range), metres.
    pub visibility_m: Option<f64>,
    /// Rain, millimetres per hour.
    pub rain_mm_h: Option<f64>,
}

/// Air that absorbs light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// Extinction per metre, one way.
    extinction_per_m: f64,
    /// Reflectivity of the drops within a pulse.
    drops: f64,
    random: Source,
}

/// Share of light left at the visibility.
const VISIBLE: f64 = 0.05;
/// Ratio of extinction to backscatter of water drops at 905 nm, steradians.
const LIDAR_RATIO_SR: f64 = 18.8;
/// Length that a pulse illuminates at once, metres.
const PULSE_M: f64 = 0.9;
/// Least light that is detected.
const LEAST: f64 = 0.01 * light::HALF_REFLECTIVITY / (light::HALF_RANGE_M * light::HALF_RANGE_M);

impl Weather {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a visibility below 1 m or rain outside 0 to 500 mm/h.
    pub fn new(settings: &WeatherSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let mut extinction_per_m = 0.0;
        if let Some(visibility_m) = settings.visibility_m {
            let visibility_m = check.within("visibility_m", visibility_m, 1.0..=1e6)?;
            extinction_per_m += -VISIBLE.ln() / visibility_m;
        }
        if let Some(rain_mm_h) = settings.rain_mm_h {
            let rain_mm_h = check.within("rain_mm_h", rain_mm_h, 0.0..=500.0)?;
            let db_per_km = 1.076 * rain_mm_h.powf(0.67);
            extinction_per_m += db_per_km * 1e-4 * core::f64::consts::LN_10;
        }
        Ok(Self {
            extinction_per_m,
            drops: core::f64::consts::PI * PULSE_M * extinction_per_m / LIDAR_RATIO_SR,
            random: Source::new(seed, Self::NAME),
        })
    }

    /// Share of light left after a range, there and back.
    fn left(&self, range_m: f64) -> f64 {
        (-2.0 * self.extinction_per_m * range_m).exp()
    }

    /// A surface behind the weather, if it is detected.
    fn dimmed(&self, echo: &Echo) -> Option<Return> {
        let clear = light::of_reflectivity(echo.reflectivity);
        let light = clear * self.left(echo.range_m);
        let echo = Echo {
            reflectivity: light::to_reflectivity(light),
            ..*echo
        };
        // A surface that is detected in clear air is not lost to a trace of rain, however faint.
        let least = LEAST.min(VISIBLE * clear / (echo.range_m * echo.range_m));
        detected(echo, light, least)
    }

    /// Drops between two distances, if they are detected.
    fn drops(&self, from_m: f64, to_m: f64, draw: (u64, u32)) -> Option<Return> {
        let mut draws = self.random.at(draw.0, draw.1);
        let (place, many) = (draws.unit(), -(1.0 - draws.unit()).ln());
        if to_m <= from_m {
            return None;
        }
        // Density 1 / R^2 between the two.
        let range_m = 1.0 / (1.0 / from_m - place * (1.0 / from_m - 1.0 / to_m));
        let light = self.drops * many * self.left(range_m);
        let echo = Echo {
            range_m,
            // No surface: no true point.
            true_range_m: f64::INFINITY,
            reflectivity: light::to_reflectivity(light),
            share: 1.0,
            normal: glam::DVec3::ZERO,
            specular: 0.0,
        };
        detected(echo, light, LEAST)
    }
}

fn detected(echo: Echo, light: f64, least: f64) -> Option<Return> {
    let strength = light / (echo.range_m * echo.range_m);
    (strength >= least).then_some(Return { echo, strength })
}

effect! {
    Weather, WeatherSettings, firings.beam: Arc, "weather",
    idle: "the air is clear: neither visibility_m nor rain_mm_h takes light away",
    new: Weather::new
}

impl BeamEffect for Weather {
    fn receive(&self, firing: &Firing, surroundings: &Surroundings, echoes: &mut Echoes) -> u32 {
        if self.extinction_per_m == 0.0 {
            return 0;
        }
        let (reach, two) = (surroundings.range(), echoes.two);
        let mut acted = 0;
        for laser in firing.alive() {
            let (Some(strongest), Some(other)) =
                (echoes.strongest.get_mut(laser), echoes.other.get_mut(laser))
            else {
                continue;
            };
            let farthest_m = match strongest.is_present() {
                true => strongest.range_m,
                false => reach.max_m,
            };
            let mut returns = [None; 3];
            // An unreported second return may hold anything.
            let others = if two { *other } else { Echo::NONE };
            for (place, echo) in returns.iter_mut().zip([*strongest, others]) {
                *place = echo.is_present().then(|| self.dimmed(&echo)).flatten();
            }
            let [_, _, last] = &mut returns;
            let draw = (firing.number, laser as u32);
            *last = self.drops(reach.min_m.max(0.1), farthest_m, draw);
            let mut received = [Return {
                echo: Echo::NONE,
                strength: 0.0,
            }; 3];
            let mut count = 0;
            for (place, found) in received.iter_mut().zip(returns.into_iter().flatten()) {
                *place = found;
                count += 1;
            }
            let was = *strongest;
            [*strongest, *other] = reported(received.get(..count).unwrap_or_default());
            acted += u32::from(*strongest != was);
        }
        acted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cast::{Object, Sphere};
    use crate::effect_models::testing::{around, cast, firing};
    use crate::scene::Scene;

    fn seen(settings: WeatherSettings, radius_m: f64, reflectivity: u8) -> (f64, f64, f64) {
        let weather = Weather::new(&settings, 11).unwrap();
        let scene = Scene::new()
            .with(Object::new(Sphere { radius_m }), reflectivity)
            .unwrap();
        let surroundings = around(scene);
        let mut firing = firing(0.0, 0.0);
        let (mut wall, mut fog, mut reported) = (0, 0, 0.0);
        for number in 0..500 {
            firing.number = number;
            let mut echoes = cast(&firing, &surroundings);
            weather.receive(&firing, &surroundings, &mut echoes);
            for echo in echoes.strongest.iter().take(16).filter(|e| e.is_present()) {
                if echo.true_range_m.is_finite() {
                    wall += 1;
                    reported = echo.reflectivity;
                } else {
                    fog += 1;
                    assert!(echo.range_m >= 1.0 && echo.range_m <= radius_m);
                }
            }
        }
        (f64::from(wall) / 8e3, f64::from(fog) / 8e3, reported)
    }

    #[test]
    fn light_follows_the_beer_lambert_law() {
        let fog = |visibility_m| WeatherSettings {
            visibility_m: Some(visibility_m),
            rain_mm_h: None,
        };
        // A fifth of the visibility, there and back.
        let (wall, fog_share, reported) = seen(fog(100.0), 10.0, 80);
        assert!(wall > 0.5 && wall + fog_share == 1.0, "{wall} {fog_share}");
        assert!(
            (reported - 80.0 * 0.05_f64.powf(0.2)).abs() < 0.05,
            "{reported}"
        );
        // 80 % at 40 m returns 5e-4, and exp(-12) of that is negligible.
        let (wall, fog_share, _) = seen(fog(20.0), 40.0, 80);
        assert_eq!(wall, 0.0);
        assert!(fog_share > 0.3, "{fog_share}");
        let (wall, fog_share, _) = seen(fog(10_000.0), 20.0, 80);
        assert!(wall == 1.0 && fog_share == 0.0);
    }

    /// A faint surface is not lost to a trace of rain, and is lost gradually as the air thickens.
    #[test]
    fn a_faint_surface_disappears_gradually_with_extinction() {
        let share = |rain_mm_h| {
            let settings = WeatherSettings {
                visibility_m: None,
                rain_mm_h: Some(rain_mm_h),
            };
            seen(settings, 99.0, 30).0
        };
        assert_eq!(share(0.001), 1.0);
        // Drops occasionally return more light.
        let some = share(5.0);
        assert!(some > 0.5, "{some}");
        // 1.076 * 500^0.67 dB/km: 13.7 dB there and back.
        assert_eq!(share(500.0), 0.0);
    }

    /// The remaining light against the laws: 5 % one way at the visibility (Koschmieder's 3 / V),
    /// decibels per kilometre of rain, and the sum of both.
    #[test]
    fn extinction_follows_koschmieder_plus_rain() {
        let one_way = |visibility_m: f64, rain_mm_h: f64, range_m: f64| {
            let fog = match visibility_m {
                clear if clear.is_infinite() => 1.0,
                visibility_m => 0.05_f64.powf(range_m / visibility_m),
            };
            fog * 10_f64.powf(-0.1 * 1.076 * rain_mm_h.powf(0.67) * range_m / 1_000.0)
        };
        for (visibility_m, rain_mm_h) in [
            (200.0, 0.0),
            (500.0, 0.0),
            (2_000.0, 0.0),
            (f64::INFINITY, 5.0),
            (f64::INFINITY, 50.0),
            (500.0, 25.0),
        ] {
            let settings = WeatherSettings {
                visibility_m: visibility_m.is_finite().then_some(visibility_m),
                rain_mm_h: (rain_mm_h > 0.0).then_some(rain_mm_h),
            };
            let weather = Weather::new(&settings, 1).unwrap();
            if rain_mm_h == 0.0 {
                let koschmieder = weather.extinction_per_m * visibility_m;
                assert!((koschmieder - 3.0).abs() < 5e-3, "{koschmieder}");
            }
            for range_m in [2.0, 10.0, 30.0] {
                let left = one_way(visibility_m, rain_mm_h, range_m).powi(2);
                assert!((weather.left(range_m) / left - 1.0).abs() < 1e-12);
                // Where drops return more light than the wall, the wall is the other return.
                let (wall, _, reported) = seen(settings, range_m, 90);
                assert!(wall > 0.5, "{wall}");
                assert!((reported - 90.0 * left).abs() < 0.05, "{reported} {left}");
            }
        }
    }

    #[test]
    fn rain_is_much_clearer_than_fog() {
        let rain = Weather::new(
            &WeatherSettings {
                visibility_m: None,
                rain_mm_h: Some(25.0),
            },
            1,
        )
        .unwrap();
        // 9.3 dB/km.
        assert!((rain.extinction_per_m - 2.14e-3).abs() < 1e-5);
        let none = Weather::new(&WeatherSettings::default(), 1).unwrap();
        let (firing, around) = (firing(0.0, 0.0), around(Scene::new()));
        assert_eq!(
            none.receive(&firing, &around, &mut cast(&firing, &around)),
            0
        );
        let wrong = WeatherSettings {
            visibility_m: Some(0.0),
            rain_mm_h: None,
        };
        assert!(Weather::new(&wrong, 1).is_err());
    }
}
