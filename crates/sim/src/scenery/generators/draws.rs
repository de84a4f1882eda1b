//! Random numbers of generators: a sequence per object, and smooth noise over the plane.

use crate::random::{GOLDEN, mix, unit_interval};

/// The seed of an object's generator from the scene's seed and the object's number.
pub(in super::super) const fn seed(scene: u64, object: u64) -> u64 {
    mix(mix(scene.wrapping_add(GOLDEN)).wrapping_add((object + 1).wrapping_mul(GOLDEN)))
}

/// Smooth noise over the plane, -1..1: random values at integer points, interpolated in between.
pub(super) fn noise(seed: u64, x: f64, y: f64) -> f64 {
    let at = |i: f64, j: f64| {
        let (i, j) = (i as i64 as u64, j as i64 as u64);
        let key = mix(seed.wrapping_add(i.wrapping_mul(GOLDEN)));
        2.0 * unit_interval(mix(key.wrapping_add(j.wrapping_mul(GOLDEN)))) - 1.0
    };
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (s, t) = (ease(x - i), ease(y - j));
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let (low, high) = (
        mix(at(i, j), at(i + 1.0, j), s),
        mix(at(i, j + 1.0), at(i + 1.0, j + 1.0), s),
    );
    mix(low, high, t)
}

/// Noise of four octaves, each with half the wavelength and half the amplitude of the one before.
pub(super) fn rough(seed: u64, x: f64, y: f64) -> f64 {
    let (mut sum, mut height, mut fine) = (0.0, 0.5, 1.0);
    for octave in 0..4 {
        sum += height * noise(seed.wrapping_add(octave), x * fine, y * fine);
        height *= 0.5;
        fine *= 2.0;
    }
    sum
}
