//! Light that comes back from a surface, and the calibrated reflectivity.
//!
//! Diffusely reflected light falls with the cosine of incidence (Lambert). Specular light comes
//! back only from surfaces that face the sensor: a normalised Phong lobe about the mirrored ray
//! (Lafortune and Willems 1994; for terrestrial scanners Tan and Cheng 2017), `(n + 2) / 2 cos^n(2
//! i)`, where a white wall gives 1. The exponent n is [`GLOSS`], between car paint and window
//! panes. Head-on such a surface is a hundred times brighter than a white wall, at 2.4 degrees half
//! of that, and at 9 degrees less than a hundredth. Light through glass or between surfaces is not
//! included.
//!
//! The sensor reports 0..=100 percent for diffuse surfaces and 101..=255 for retroreflectors, 255
//! for an ideal one (63-9243, section 6.1). The manual does not give the light of a retroreflector.
//! Here the scale from 100 to 255 is logarithmic and ends at [`RETRO_GAIN`], about the ratio of
//! road sign sheeting with 100 cd/lx/m2 to a white wall (1/pi cd/lx/m2).

use glam::DVec3;

use crate::firing::Echo;

/// Light from an ideal retroreflector relative to an ideal white wall.
pub(super) const RETRO_GAIN: f64 = 300.0;
/// Default range, metres, at which a target of [`HALF_REFLECTIVITY`] percent is detected half the
/// time.
pub(super) const HALF_RANGE_M: f64 = 50.0;
/// See [`HALF_RANGE_M`].
pub(super) const HALF_REFLECTIVITY: f64 = 10.0;
/// Exponent of the specular lobe.
const GLOSS: i32 = 200;
/// Reflectivity steps between a white wall and an ideal retroreflector.
const RETRO_STEPS: f64 = 155.0;

/// Light that comes back head-on, 1 for a white wall; monotonic in the reflectivity.
#[inline]
pub(super) fn of_reflectivity(reflectivity: f64) -> f64 {
    if reflectivity <= 100.0 {
        0.01 * reflectivity.max(0.0)
    } else {
        (RETRO_GAIN.ln() * (reflectivity.min(255.0) - 100.0) / RETRO_STEPS).exp()
    }
}

/// Light that comes back at an incidence with this cosine, if the share `specular` (0..=1) of
/// `light` is specular. Specular light is at most 1.
#[inline]
pub(super) fn of_surface(light: f64, specular: f64, cosine: f64) -> f64 {
    let scattered = (1.0 - specular) * light;
    if specular == 0.0 {
        return scattered * cosine;
    }
    let off_mirror = (2.0 * cosine * cosine - 1.0).max(0.0);
    let lobe = 0.5 * f64::from(GLOSS + 2) * off_mirror.powi(GLOSS);
    (scattered + specular * light.min(1.0) * lobe) * cosine
}

/// Light of an echo that arrives from `direction`; diffuse and head-on without `incidence` or a
/// normal.
#[inline]
pub(super) fn of_echo(echo: &Echo, direction: DVec3, incidence: bool) -> f64 {
    let head_on = of_reflectivity(echo.reflectivity);
    match incidence && echo.normal != DVec3::ZERO {
        true => of_surface(head_on, echo.specular, echo.normal.dot(direction).abs()),
        false => head_on,
    }
}

/// The reported reflectivity, 0..=255.
#[inline]
pub(super) fn to_reflectivity(light: f64) -> f64 {
    if light <= 1.0 {
        100.0 * light.max(0.0)
    } else {
        (100.0 + RETRO_STEPS * light.ln() / RETRO_GAIN.ln()).min(255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reflectivity_and_light_round_trip() {
        for reflectivity in 0..=255_u8 {
            let light = of_reflectivity(f64::from(reflectivity));
            assert!((to_reflectivity(light) - f64::from(reflectivity)).abs() < 1e-9);
            assert!(reflectivity == 255 || of_reflectivity(f64::from(reflectivity) + 1.0) > light);
        }
        assert!((of_reflectivity(255.0) - RETRO_GAIN).abs() < 1e-9);
        assert_eq!(to_reflectivity(1e9), 255.0);
        assert_eq!(of_reflectivity(-1.0), 0.0);
        // Lambert's cosine for diffuse light; specular light only within a few degrees.
        let of = |specular, deg: f64| of_surface(0.06, specular, deg.to_radians().cos());
        assert!((of(0.0, 60.0) - 0.03).abs() < 1e-12);
        assert!((of(0.8, 60.0) - 0.006).abs() < 1e-12);
        assert!((of(0.8, 0.0) - (0.012 + 0.048 * 101.0)).abs() < 1e-12);
        // cos(4.77 deg)^200 is 1/2.
        let half = 2.385_f64.to_radians().cos();
        assert!((of(1.0, 2.385) / (0.06 * 101.0 * half) - 0.5).abs() < 1e-2);
        assert!(of(1.0, 9.0) < 0.06 * 0.01 && of(1.0, 60.0) == 0.0);
        // Normalisation: the integral over the hemisphere, 2 pi sin a da at angle a from the
        // mirrored ray.
        let steps = 10_000;
        let all: f64 = (0..steps)
            .map(|step| (f64::from(step) + 0.5) / f64::from(steps) * core::f64::consts::FRAC_PI_2)
            .map(|a| 0.5 * f64::from(GLOSS + 2) * a.cos().powi(GLOSS) * a.cos() * 2.0 * a.sin())
            .sum::<f64>()
            * core::f64::consts::FRAC_PI_2
            / f64::from(steps);
        assert!((all - 1.0).abs() < 1e-4, "{all}");
        // Half of a retroreflector's light is still that of a retroreflector.
        assert!(to_reflectivity(0.5 * RETRO_GAIN) > 200.0);
    }
}
