//! Beam: fog and rain, which absorb light and scatter some back.
//!
//! The link budget of Rasshofer, Spies and Spies (2011, Advances in Radio Science 9), as Hahner et
//! al. (2021, ICCV) use it. Light falls with exp(-2 s R) there and back (Beer and Lambert). In fog,
//! s follows from the visibility V, at which 5 % of the light is left (Koschmieder 1924; the
//! meteorological optical range of WMO): s = ln 20 / V. In rain it is 1.076 h^0.67 dB/km at h mm/h
//! (Carbonneau and Wisely 1998).
//!
//! Fog scatters 0.046 / V per metre and steradian back (Rasshofer et al.). Over the 0.9 m that a
//! pulse of 6 ns illuminates at once, this is a surface of reflectivity pi * 0.9 m * 0.046 / V at
//! every distance. The receiver sees of its light the share o(R), which rises from 0 to 1 between
//! two distances, as the beam enters the view of the detector. The return comes from the maximum of
//! o(R) exp(-2 s R) / R^2. Rain drops scatter s / 18.8 per steradian back (O'Connor, Illingworth
//! and Hogan 2004, at 905 nm); few are in a pulse, so their number is exponentially distributed,
//! and their distance is drawn with density 1 / R^2.
//!
//! No manual gives o(R) of a VLP-16. By default it ends at 10 m, where lenses side by side that
//! share a view of 3 mrad have it whole. Fog of 50 m visibility is then seen at 2 m, fog of 200 m
//! is not.
//!
//! Which returns are detected is the reflectance effect's decision. Without it, fog and drops count
//! that exceed the light of its default target, and a surface is lost below that once the air takes
//! 95 % of its light. Multiple scattering, gusts and drops on the window are not included.

use crate::effects::BeamEffect;
use crate::firing::{Echo, Echoes, SimulatedFiring, Surroundings};
use std::sync::Arc;

use glam::DVec3;
use serde::Deserialize;

use super::light;
use super::reflectance::ReflectanceSettings;
use super::returns::{Return, reported};
use super::settings::{InvalidSetting, SettingCheck};
use crate::random::RandomSource;

/// `[effects.weather]`; absent settings have no effect.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields, default)]
#[non_exhaustive]
pub struct WeatherSettings {
    /// Visibility in fog (meteorological optical range), metres.
    pub visibility_m: Option<f64>,
    /// Rain, millimetres per hour.
    pub rain_mm_h: Option<f64>,
    /// Distances at which the receiver begins to see the beam and sees all of it, metres.
    pub overlap_m: [f64; 2],
    /// The effect that decides which returns are detected, if it is on.
    #[serde(skip)]
    reflectance: Option<ReflectanceSettings>,
}

impl Default for WeatherSettings {
    fn default() -> Self {
        Self {
            visibility_m: None,
            rain_mm_h: None,
            overlap_m: [0.9, 10.0],
            reflectance: None,
        }
    }
}

impl WeatherSettings {
    /// The same weather, whose returns the reflectance effect detects, if it is on.
    pub(crate) fn detected_by(self, reflectance: Option<ReflectanceSettings>) -> Self {
        Self {
            reflectance,
            ..self
        }
    }
}

/// Air that absorbs light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weather {
    /// Extinction per metre, one way.
    extinction_per_m: f64,
    /// Reflectivity of the fog within a pulse.
    fog: f64,
    /// Mean reflectivity of the drops within a pulse.
    drops: f64,
    overlap_m: [f64; 2],
    reflectance: Option<ReflectanceSettings>,
    random: RandomSource,
}

/// Share of light left at the visibility.
const VISIBLE: f64 = 0.05;
/// Backscatter of fog times its visibility, per steradian.
const FOG_BACKSCATTER: f64 = 0.046;
/// Ratio of extinction to backscatter of rain drops at 905 nm, steradians.
const LIDAR_RATIO_SR: f64 = 18.8;
/// Length that a pulse illuminates at once, metres.
const PULSE_M: f64 = 0.9;
/// Least light that is detected without the reflectance effect.
const LEAST: f64 = 0.01 * light::HALF_REFLECTIVITY / (light::HALF_RANGE_M * light::HALF_RANGE_M);

impl Weather {
    /// With these settings, in a run with `seed`.
    ///
    /// # Errors
    /// [`InvalidSetting`] for a visibility below 1 m, rain outside 0 to 500 mm/h, or distances of
    /// the overlap that do not rise within 1 km.
    pub fn new(settings: &WeatherSettings, seed: u64) -> Result<Self, InvalidSetting> {
        let check = SettingCheck(Self::NAME);
        let per_m = core::f64::consts::PI * PULSE_M;
        let (mut extinction_per_m, mut fog, mut drops) = (0.0, 0.0, 0.0);
        if let Some(visibility_m) = settings.visibility_m {
            let visibility_m = check.within("visibility_m", visibility_m, 1.0..=1e6)?;
            extinction_per_m += -VISIBLE.ln() / visibility_m;
            fog = per_m * FOG_BACKSCATTER / visibility_m;
        }
        if let Some(rain_mm_h) = settings.rain_mm_h {
            let rain_mm_h = check.within("rain_mm_h", rain_mm_h, 0.0..=500.0)?;
            let db_per_km = 1.076 * rain_mm_h.powf(0.67);
            let rain_per_m = db_per_km * 1e-4 * core::f64::consts::LN_10;
            extinction_per_m += rain_per_m;
            drops = per_m * rain_per_m / LIDAR_RATIO_SR;
        }
        let [from_m, to_m] = settings.overlap_m;
        let from_m = check.within("overlap_m", from_m, 0.0..=999.0)?;
        let to_m = check.within("overlap_m", to_m, from_m + 1e-3..=1e3)?;
        Ok(Self {
            extinction_per_m,
            fog,
            drops,
            overlap_m: [from_m, to_m],
            reflectance: settings.reflectance,
            random: RandomSource::new(seed, Self::NAME),
        })
    }

    /// Share of light left after a range, there and back.
    pub(crate) fn left(&self, range_m: f64) -> f64 {
        (-2.0 * self.extinction_per_m * range_m).exp()
    }

    /// Light of the brightest fog and drops between two distances, over the square of the distance.
    pub(crate) fn in_air(&self, [from_m, to_m]: [f64; 2], draw: u64) -> f64 {
        let air = [self.fog(from_m, to_m), self.drops(from_m, to_m, (draw, 0))];
        let strengths = air.into_iter().flatten().map(|seen| seen.strength);
        strengths.fold(0.0, f64::max)
    }

    /// Share of the scattered light of a distance that the receiver sees.
    fn overlap(&self, range_m: f64) -> f64 {
        let [from_m, to_m] = self.overlap_m;
        ((range_m - from_m) / (to_m - from_m)).clamp(0.0, 1.0)
    }

    /// A surface behind the weather, if it may be detected.
    fn dimmed(&self, echo: &Echo, direction: DVec3) -> Option<Return> {
        let (clear, left) = (
            light::of_reflectivity(echo.reflectivity),
            self.left(echo.range_m),
        );
        let square = echo.range_m * echo.range_m;
        let incidence = self.reflectance.is_some_and(|effect| effect.incidence);
        let strength = light::of_echo(echo, direction, incidence) * left / square;
        // A surface that is detected in clear air is not lost to a trace of rain, however faint.
        let is_lost = self.reflectance.is_none() && strength < LEAST.min(VISIBLE * clear / square);
        let echo = Echo {
            reflectivity: light::to_reflectivity(clear * left),
            ..*echo
        };
        (!is_lost).then_some(Return { echo, strength })
    }

    /// Light of the air at a distance, of this reflectivity, if it may be detected.
    fn scattered(&self, reflectivity: f64, range_m: f64) -> Option<Return> {
        let light = reflectivity * self.overlap(range_m) * self.left(range_m);
        let strength = light / (range_m * range_m);
        let least = match self.reflectance {
            Some(_) => f64::MIN_POSITIVE,
            None => LEAST,
        };
        let echo = Echo {
            range_m,
            // No surface: no true point.
            true_range_m: f64::INFINITY,
            reflectivity: light::to_reflectivity(light),
            share: 1.0,
            normal: DVec3::ZERO,
            specular: 0.0,
        };
        (strength >= least).then_some(Return { echo, strength })
    }

    /// Fog between two distances, at its brightest.
    fn fog(&self, from_m: f64, to_m: f64) -> Option<Return> {
        let [begins_m, ends_m] = self.overlap_m;
        // Where the overlap rises, the derivative of (R - b) exp(-2 s R) / R^2 is zero at the root
        // of 2 s R^2 + (1 - 2 s b) R - 2 b.
        let (s, b) = (self.extinction_per_m, begins_m);
        let linear = 1.0 - 2.0 * s * b;
        let root = 4.0 * b / (linear + (linear * linear + 16.0 * s * b).sqrt());
        let range_m = root.min(ends_m).max(from_m);
        (range_m < to_m)
            .then(|| self.scattered(self.fog, range_m))
            .flatten()
    }

    /// Drops between two distances.
    fn drops(&self, from_m: f64, to_m: f64, draw: (u64, u32)) -> Option<Return> {
        if self.drops == 0.0 || to_m <= from_m {
            return None;
        }
        let mut draws = self.random.at(draw.0, draw.1);
        let (place, many) = (draws.unit(), -(1.0 - draws.unit()).ln());
        // Density 1 / R^2 between the two.
        let range_m = 1.0 / (1.0 / from_m - place * (1.0 / from_m - 1.0 / to_m));
        self.scattered(self.drops * many, range_m)
    }
}

effect! {
    Weather, WeatherSettings, firings.beam: Arc, "weather",
    idle: "the air is clear: neither visibility_m nor rain_mm_h takes light away",
    new: Weather::new
}

impl BeamEffect for Weather {
    fn receive(
        &self,
        firing: &SimulatedFiring,
        surroundings: &Surroundings,
        echoes: &mut Echoes,
    ) -> u32 {
        if self.extinction_per_m == 0.0 {
            return 0;
        }
        let (reach, two) = (surroundings.range(), echoes.two);
        let nearest_m = reach.min_m.max(0.1);
        let mut acted = 0;
        for laser in firing.alive() {
            let (Some(strongest), Some(other), Some(direction)) = (
                echoes.strongest.get_mut(laser),
                echoes.other.get_mut(laser),
                firing.directions.get(laser),
            ) else {
                continue;
            };
            let farthest_m = match strongest.is_present() {
                true => strongest.range_m,
                false => reach.max_m,
            };
            // An unreported second return may hold anything.
            let others = if two { *other } else { Echo::NONE };
            let surface = |echo: Echo| {
                let present = echo.is_present();
                present.then(|| self.dimmed(&echo, *direction)).flatten()
            };
            let returns = [
                surface(*strongest),
                surface(others),
                self.fog(nearest_m, farthest_m),
                self.drops(nearest_m, farthest_m, (firing.number, laser as u32)),
            ];
            let mut received = [Return {
                echo: Echo::NONE,
                strength: 0.0,
            }; 4];
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
    use crate::effect_models::reflectance::Reflectance;
    use crate::effect_models::testing::{around, cast, firing};
    use crate::effects::SurfaceEffect;
    use crate::scene::Scene;

    /// The shares of returns from a wall and from the air, and the wall's reported reflectivity.
    fn seen(settings: WeatherSettings, radius_m: f64, reflectivity: u8) -> (f64, f64, f64) {
        let detection = settings
            .reflectance
            .map(|effect| Reflectance::new(&effect, 11));
        let detection = detection.transpose().unwrap();
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
            if let Some(detection) = detection {
                detection.reflect(&firing, &mut echoes);
            }
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
            ..Default::default()
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
                rain_mm_h: Some(rain_mm_h),
                ..Default::default()
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
                ..Default::default()
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
                rain_mm_h: Some(25.0),
                ..Default::default()
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
            ..Default::default()
        };
        assert!(Weather::new(&wrong, 1).is_err());
    }

    /// The distance of the brightest fog against a search in steps of a millimetre.
    #[test]
    fn fog_returns_from_where_it_is_brightest() {
        for visibility_m in [10.0, 50.0, 200.0, 1_000.0] {
            for overlap_m in [[0.9, 1.0], [0.9, 10.0], [0.0, 5.0], [2.0, 50.0]] {
                let settings = WeatherSettings {
                    visibility_m: Some(visibility_m),
                    overlap_m,
                    reflectance: Some(ReflectanceSettings::default()),
                    ..Default::default()
                };
                let weather = Weather::new(&settings, 1).unwrap();
                let strength = |range_m: f64| {
                    let found = weather.scattered(weather.fog, range_m);
                    found.map_or(0.0, |found| found.strength)
                };
                let steps = (1..60_000).map(|step| 0.5 + 1e-3 * f64::from(step));
                let best = steps.map(strength).fold(0.0, f64::max);
                let found = weather.fog(0.5, 100.0).unwrap();
                let ratio = found.strength / best;
                assert!(ratio > 0.999_999, "{visibility_m} {overlap_m:?}: {ratio}");
            }
        }
    }

    /// The link budget of the reflectance effect decides: walls at 20 m stay in fog of 200 m
    /// visibility, and dark ones are replaced by the air near the sensor in fog of 30 m. A receiver
    /// that sees twice as far sees thinner fog, too.
    #[test]
    fn the_link_budget_decides_between_walls_and_fog() {
        let in_fog = |visibility_m, half_range_m, reflectivity| {
            let settings = WeatherSettings {
                visibility_m: Some(visibility_m),
                reflectance: Some(ReflectanceSettings {
                    half_range_m,
                    ..Default::default()
                }),
                ..Default::default()
            };
            let (wall, fog, _) = seen(settings, 20.0, reflectivity);
            (wall, fog)
        };
        for reflectivity in [20, 50, 80] {
            let (wall, fog) = in_fog(200.0, 50.0, reflectivity);
            assert!(wall > 0.999 && fog < 1e-3, "{reflectivity}: {wall} {fog}");
        }
        let (wall, fog) = in_fog(30.0, 50.0, 20);
        assert!(wall < 1e-3 && fog > 0.99, "{wall} {fog}");
        let (wall, fog) = in_fog(30.0, 50.0, 80);
        assert!(wall + fog > 0.99, "{wall} {fog}");
        let (nothing, fog) = in_fog(200.0, 50.0, 0);
        let (_, sensitive) = in_fog(200.0, 100.0, 0);
        assert!(
            nothing == 0.0 && fog < 0.05 && sensitive > 0.9,
            "{fog} {sensitive}"
        );
    }
}
