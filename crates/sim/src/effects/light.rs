//! Calibrated reflectivity against the light that comes back.
//!
//! The sensor reports 0..=100 for diffuse surfaces, in percent, and 101..=255 for retroreflectors, 255 for an ideal one (63-9243, section 6.1).
//! The manual does not say how much more light a retroreflector returns; here the scale from 100 to 255 is logarithmic and ends at
//! [`RETRO_GAIN`], about what sheeting of road signs with 100 cd/lx/m2 sends back of what a white wall does (1/pi cd/lx/m2).

/// Light from an ideal retroreflector, where an ideal white wall gives 1.
pub(super) const RETRO_GAIN: f64 = 300.0;
/// At this range, metres, a target of [`HALF_REFLECTIVITY`] percent is noticed half the time unless something else is asked for.
pub(super) const HALF_RANGE_M: f64 = 50.0;
/// See [`HALF_RANGE_M`].
pub(super) const HALF_REFLECTIVITY: f64 = 10.0;
/// Reflectivities between a white wall and an ideal retroreflector.
const RETRO_STEPS: f64 = 155.0;

/// The light that comes back head-on, 1 for a white wall; more light for more reflectivity.
#[inline]
pub(super) fn of_reflectivity(reflectivity: f64) -> f64 {
    if reflectivity <= 100.0 {
        0.01 * reflectivity.max(0.0)
    } else {
        (RETRO_GAIN.ln() * (reflectivity.min(255.0) - 100.0) / RETRO_STEPS).exp()
    }
}

/// The reflectivity that a sensor reports of it, 0..=255.
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
    fn there_and_back() {
        for reflectivity in 0..=255_u8 {
            let light = of_reflectivity(f64::from(reflectivity));
            assert!((to_reflectivity(light) - f64::from(reflectivity)).abs() < 1e-9);
            assert!(reflectivity == 255 || of_reflectivity(f64::from(reflectivity) + 1.0) > light);
        }
        assert!((of_reflectivity(255.0) - RETRO_GAIN).abs() < 1e-9);
        assert_eq!(to_reflectivity(1e9), 255.0);
        assert_eq!(of_reflectivity(-1.0), 0.0);
        // Half of a retroreflector's light is still a retroreflector's.
        assert!(to_reflectivity(0.5 * RETRO_GAIN) > 200.0);
    }
}
