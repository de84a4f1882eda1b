//! The K function by spherical harmonics, without looking at pairs.
//!
//! The sum of `P_l(a.b)` over all pairs is the power of the points' harmonics of degree `l`
//! (addition theorem), and the condition `a.b >= c` is a series of `P_l(a.b)`. So the share of
//! pairs up to an edge is a sum over degrees. The sum is truncated, which loses structure finer
//! than 180 degrees divided by the degree. Points are first put on a grid of rings, 8 rings per
//! degree of the harmonics. The error is not bounded; `docs/src/k.md` has measurements.

use std::f64::consts::PI;

use glam::DVec3;

use super::plain::check;
use super::{Edges, ErrorBound, Estimate, KError};

/// The highest degree up to which `sin^m` near the poles underflows only where it is negligible.
pub const MOST_DEGREE: usize = 512;

/// Rings per degree, from pole to pole.
const RINGS: usize = 8;
/// Positions along a ring per degree.
const PLACES: usize = 16;
/// Rings that are summed at once.
const AT_ONCE: usize = 8;

/// Estimates by harmonics up to a degree; 64 is usual. The error is unknown:
/// [`ErrorBound::Unknown`].
///
/// # Errors
/// [`KError::NotUnit`] and [`KError::TooMany`] for invalid directions, [`KError::Degree`] for 0 and
/// for degrees above [`MOST_DEGREE`].
pub fn harmonics(points: &[DVec3], edges: &Edges, degree: usize) -> Result<Estimate, KError> {
    check(points)?;
    if !(1..=MOST_DEGREE).contains(&degree) {
        return Err(KError::Degree { got: degree });
    }
    if points.len() < 2 {
        return Ok(Estimate::without_pairs("harmonics", edges, points.len()));
    }
    let spectrum = spectrum(points, degree);
    let mut shares: Vec<f64> = (0..edges.bins())
        .map(|bin| share(edges.cosine(bin), &spectrum).clamp(0.0, 1.0))
        .collect();
    // All pairs are within pi.
    if let Some(share) = shares.last_mut() {
        *share = 1.0;
    }
    Ok(Estimate {
        method: "harmonics",
        edges: edges.clone(),
        shares,
        bound: ErrorBound::Unknown,
        points: points.len(),
        on_edges: None,
    })
}

/// The mean of `P_l` over all pairs of different points, for every degree from 0.
fn spectrum(points: &[DVec3], degree: usize) -> Vec<f64> {
    let rings = rings(points, degree);
    let mut sums = vec![[0.0; 2]; (degree + 1) * (degree + 1)];
    for rings in rings.chunks(AT_ONCE) {
        add(rings, degree, &mut sums);
    }
    let n = points.len() as f64;
    let of = |(l, row): (usize, &[[f64; 2]])| {
        let squares = row.iter().take(l + 1).enumerate();
        // Of m and of -m.
        let squares = squares.map(|(m, [re, im])| {
            let twice = if m == 0 { 1.0 } else { 2.0 };
            twice * (re * re + im * im)
        });
        let power = squares.sum::<f64>() * 4.0 * PI / (2 * l + 1) as f64;
        // Without the pairs of each point with itself: P_l(1) = 1.
        (power - n) / (n * (n - 1.0))
    };
    let mut spectrum: Vec<f64> = sums.chunks(degree + 1).enumerate().map(of).collect();
    if let Some(first) = spectrum.first_mut() {
        *first = 1.0;
    }
    spectrum
}

/// A ring: the mean z of its points, and their Fourier sums `exp(-i m phi)` from m = 0.
struct Ring {
    z: f64,
    sums: Vec<[f64; 2]>,
}

/// Fourier sums of all rings with points, by polar angle and azimuth about z.
fn rings(points: &[DVec3], degree: usize) -> Vec<Ring> {
    let (rings, places) = (RINGS * degree, PLACES * degree);
    let mut grid = vec![0_u32; rings * places];
    let mut z_sums = vec![0.0_f64; rings];
    let (per_ring, per_place) = (rings as f32 / std::f32::consts::PI, places as f32 / 8.0);
    for p in points {
        let [x, y, z] = p.as_vec3().to_array();
        let ring = ((polar(z) * per_ring) as usize).min(rings - 1);
        let place = ((eighths(x, y) * per_place) as usize).min(places - 1);
        if let Some(count) = grid.get_mut(ring * places + place) {
            *count = count.saturating_add(1);
        }
        if let Some(sum) = z_sums.get_mut(ring) {
            *sum += f64::from(z);
        }
    }
    let waves = RingWaves::new(degree, places);
    let rings = grid.chunks(places).zip(&z_sums);
    let rings = rings.filter_map(|(counts, z_sum)| {
        let all: u64 = counts.iter().copied().map(u64::from).sum();
        (all > 0).then(|| Ring {
            z: (z_sum / all as f64).clamp(-1.0, 1.0),
            sums: waves.sums(counts),
        })
    });
    rings.collect()
}

/// The angle from z in radians, to 7e-5 (Abramowitz and Stegun 4.4.45). It only selects the ring,
/// whose height is that of its points.
fn polar(z: f32) -> f32 {
    let near = z.abs().min(1.0);
    let series = (-0.018_729_3 * near + 0.074_261) * near - 0.212_114_4;
    let angle = (1.0 - near).sqrt() * (series * near + 1.570_728_8);
    if z < 0.0 {
        std::f32::consts::PI - angle
    } else {
        angle
    }
}

/// The azimuth from x towards y in eighths of a circle, 0 to 8, to 3e-6 (Abramowitz and Stegun
/// 4.4.49).
fn eighths(x: f32, y: f32) -> f32 {
    let (u, v) = (x.abs(), y.abs());
    let (least, most) = (u.min(v), u.max(v));
    let t = least / most.max(f32::MIN_POSITIVE);
    let s = t * t;
    let series = ((0.002_866_225_7 * s - 0.016_165_737) * s + 0.042_909_614) * s - 0.075_289_64;
    let series = ((series * s + 0.106_562_64) * s - 0.142_089) * s + 0.199_935_5;
    let angle = ((series * s - 0.333_331_45) * s + 1.0) * t * (4.0 / std::f32::consts::PI);
    let angle = if v > u { 2.0 - angle } else { angle };
    let angle = if x < 0.0 { 4.0 - angle } else { angle };
    if y < 0.0 { 8.0 - angle } else { angle }
}

/// Cosines and sines at the middles of a quarter of the positions, for every m.
struct RingWaves {
    quarter: usize,
    waves: Vec<[Vec<f64>; 2]>,
}

impl RingWaves {
    fn new(degree: usize, places: usize) -> Self {
        let quarter = places / 4;
        let angle = |m: usize, place: usize| {
            let turns = (m * (2 * place + 1)) % (2 * places);
            turns as f64 * PI / places as f64
        };
        let waves = (0..=degree).map(|m| {
            let cosines = (0..quarter).map(|place| angle(m, place).cos()).collect();
            let sines = (0..quarter).map(|place| angle(m, place).sin()).collect();
            [cosines, sines]
        });
        Self {
            quarter,
            waves: waves.collect(),
        }
    }

    /// Fourier sums of a ring. A wave half a revolution on is the same or the opposite, and so is
    /// its mirror image: only a quarter is multiplied.
    fn sums(&self, counts: &[u32]) -> Vec<[f64; 2]> {
        let at = |place: usize| counts.get(place).copied().map_or(0.0, f64::from);
        let half = 2 * self.quarter;
        // Sums and differences of mirrored positions, for even and odd m.
        let folded = [1.0, -1.0].map(|sign| {
            let half_turn = |place: usize| at(place) + sign * at(place + half);
            let places = 0..self.quarter;
            [1.0, -1.0].map(|mirrored| {
                let of = |place| half_turn(place) + mirrored * half_turn(half - 1 - place);
                places.clone().map(of).collect::<Vec<f64>>()
            })
        });
        let [[even_sum, even_difference], [odd_sum, odd_difference]] = &folded;
        let waves = self.waves.iter().enumerate();
        let sums = waves.map(|(m, [cosines, sines])| {
            // Mirrored at a quarter revolution, the cosine of an even m keeps its sign and its sine
            // changes it; for odd m it is the other way round.
            let (of_cosine, of_sine) = if m % 2 == 0 {
                (even_sum, even_difference)
            } else {
                (odd_difference, odd_sum)
            };
            [product(of_cosine, cosines), -product(of_sine, sines)]
        });
        sums.collect()
    }
}

/// The scalar product, in lanes.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let (whole_a, rest_a) = a.as_chunks::<8>();
    let (whole_b, rest_b) = b.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for (a, b) in whole_a.iter().zip(whole_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest = rest_a.iter().zip(rest_b).map(|(a, b)| a * b);
    sums.iter().sum::<f64>() + rest.sum::<f64>()
}

/// Adds rings to the sums of all harmonics, `l` by `m`.
///
/// The harmonics have unit norm. From `m` to `m + 1` they follow by a factor of the sine, from `l`
/// to `l + 1` by the three-term recurrence whose numbers stay near 1 (Holmes and Featherstone 2002,
/// Eq. 11 with a norm of 1 instead of 4 pi).
fn add(rings: &[Ring], degree: usize, sums: &mut [[f64; 2]]) {
    let mut z = [0.0; AT_ONCE];
    for (z, ring) in z.iter_mut().zip(rings) {
        *z = ring.z;
    }
    let sine = z.map(|z| ((1.0 - z) * (1.0 + z)).max(0.0).sqrt());
    let mut sectoral = [(1.0 / (4.0 * PI)).sqrt(); AT_ONCE];
    for m in 0..=degree {
        if m > 0 {
            let factor = ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
            for (sectoral, sine) in sectoral.iter_mut().zip(sine) {
                *sectoral *= factor * sine;
            }
        }
        let mut waves = [[0.0; AT_ONCE]; 2];
        for (lane, ring) in rings.iter().enumerate().take(AT_ONCE) {
            let [re, im] = ring.sums.get(m).copied().unwrap_or_default();
            let [res, ims] = &mut waves;
            if let (Some(to_re), Some(to_im)) = (res.get_mut(lane), ims.get_mut(lane)) {
                (*to_re, *to_im) = (re, im);
            }
        }
        let (mut before, mut now) = ([0.0; AT_ONCE], sectoral);
        for l in m..=degree {
            if let Some(sum) = sums.get_mut(l * (degree + 1) + m) {
                for (sum, wave) in sum.iter_mut().zip(&waves) {
                    let products = now.iter().zip(wave).map(|(now, wave)| now * wave);
                    *sum += products.sum::<f64>();
                }
            }
            let (a, b) = onward(l + 1, m);
            for ((before, now), z) in before.iter_mut().zip(&mut now).zip(&z) {
                let next = a * z * *now - b * *before;
                *before = *now;
                *now = next;
            }
        }
    }
}

/// The coefficients of `P(l) = a z P(l - 1) - b P(l - 2)` for an order m.
fn onward(l: usize, m: usize) -> (f64, f64) {
    let (l, m) = (l as f64, m as f64);
    let below = (l - m) * (l + m);
    let a = ((2.0 * l - 1.0) * (2.0 * l + 1.0) / below).sqrt();
    let b = (2.0 * l + 1.0) * (l + m - 1.0) * (l - m - 1.0) / ((2.0 * l - 3.0) * below);
    (a, b.max(0.0).sqrt())
}

/// The share of pairs up to an edge: `1[x >= c]` is the sum over degrees of `(P_(l-1)(c) -
/// P_(l+1)(c)) / 2 P_l(x)`, and `(1 - c) / 2` for degree 0.
fn share(cosine: f64, spectrum: &[f64]) -> f64 {
    let mut share = 0.0;
    // P_(l-1), which is 1 for l = 0, and P_l.
    let (mut below, mut now) = (1.0, 1.0);
    for (l, power) in spectrum.iter().enumerate() {
        let l = l as f64;
        let above = ((2.0 * l + 1.0) * cosine * now - l * below) / (l + 1.0);
        share += power * 0.5 * (below - above);
        (below, now) = (now, above);
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All harmonics of one point as one ring.
    fn of(z: f64, phi: f64, degree: usize) -> Vec<[f64; 2]> {
        let waves = (0..=degree).map(|m| {
            let (sine, cosine) = (m as f64 * phi).sin_cos();
            [cosine, -sine]
        });
        let ring = Ring {
            z,
            sums: waves.collect(),
        };
        let mut sums = vec![[0.0; 2]; (degree + 1) * (degree + 1)];
        add(&[ring], degree, &mut sums);
        sums
    }

    #[test]
    fn harmonics_of_high_degree_are_accurate_at_the_poles() {
        // The squares of all harmonics of a degree add up to (2 l + 1) / (4 pi) at every point
        // (addition theorem).
        for z in [
            1.0,
            -1.0,
            1.0 - 1e-15,
            1.0 - 1e-9,
            -1.0 + 1e-6,
            0.999,
            0.9,
            0.5,
            1e-12,
            0.0,
            -0.3,
        ] {
            let sums = of(z, 0.7, MOST_DEGREE);
            for (l, row) in sums.chunks(MOST_DEGREE + 1).enumerate() {
                let squares = row.iter().enumerate().map(|(m, [re, im])| {
                    assert!(re.is_finite() && im.is_finite(), "{l} {m} at {z}");
                    let twice = if m == 0 { 1.0 } else { 2.0 };
                    twice * (re * re + im * im)
                });
                let sum = squares.sum::<f64>() * 4.0 * PI / (2 * l + 1) as f64;
                assert!((sum - 1.0).abs() < 1e-10, "degree {l} at z = {z}: {sum}");
            }
        }
    }

    #[test]
    fn harmonics_of_low_degree_match_the_textbook() {
        let (z, phi) = (0.3_f64, 1.1_f64);
        let sine = (1.0 - z * z).sqrt();
        let sums = of(z, phi, 3);
        let near = |l: usize, m: usize, size: f64| {
            let [re, im] = sums[l * 4 + m];
            let wave = m as f64 * phi;
            assert!((re - size * wave.cos()).abs() < 1e-14, "{l} {m}");
            assert!((im + size * wave.sin()).abs() < 1e-14, "{l} {m}");
        };
        near(0, 0, (1.0 / (4.0 * PI)).sqrt());
        near(1, 0, (3.0 / (4.0 * PI)).sqrt() * z);
        near(1, 1, (3.0 / (8.0 * PI)).sqrt() * sine);
        near(2, 0, (5.0 / (16.0 * PI)).sqrt() * (3.0 * z * z - 1.0));
        near(2, 2, (15.0 / (32.0 * PI)).sqrt() * sine * sine);
        near(
            3,
            1,
            (21.0 / (64.0 * PI)).sqrt() * sine * (5.0 * z * z - 1.0),
        );
    }

    #[test]
    fn angles_are_within_their_stated_error() {
        for number in -2000..=2000_i32 {
            let z = f64::from(number) / 2000.0;
            assert!((f64::from(polar(z as f32)) - z.acos()).abs() < 1e-4, "{z}");
            let phi = (f64::from(number) + 0.5) / 2000.5 * PI;
            let expected = (phi.rem_euclid(2.0 * PI)) * 4.0 / PI;
            let got = f64::from(eighths(phi.cos() as f32, phi.sin() as f32));
            assert!((got - expected).abs() < 5e-6, "{phi}: {got} {expected}");
        }
    }

    #[test]
    fn folded_sums_agree_with_direct_sums() {
        let (degree, places) = (9, PLACES * 9);
        let counts: Vec<u32> = (0..places as u32)
            .map(|p| (p * p * 7 + 3 * p) % 11)
            .collect();
        for (m, [re, im]) in RingWaves::new(degree, places)
            .sums(&counts)
            .iter()
            .enumerate()
        {
            let (mut cosines, mut sines) = (0.0, 0.0);
            for (place, count) in counts.iter().enumerate() {
                let phi = (place as f64 + 0.5) * 2.0 * PI / places as f64;
                cosines += f64::from(*count) * (m as f64 * phi).cos();
                sines -= f64::from(*count) * (m as f64 * phi).sin();
            }
            assert!(
                (re - cosines).abs() < 1e-9 && (im - sines).abs() < 1e-9,
                "{m}"
            );
        }
    }

    #[test]
    fn a_spectrum_is_the_mean_of_legendre_polynomials_over_pairs() {
        let points: Vec<DVec3> = (0..60)
            .map(|i| {
                let t = f64::from(i);
                DVec3::new(t.sin() + 0.4, (1.7 * t).cos(), (0.3 * t).sin()).normalize()
            })
            .collect();
        let degree = 64;
        let mut plain = vec![0.0; degree + 1];
        for (i, a) in points.iter().enumerate() {
            for b in points.iter().take(i) {
                let (mut below, mut now) = (1.0, 1.0);
                for (l, sum) in plain.iter_mut().enumerate() {
                    *sum += now / (60.0 * 59.0 / 2.0);
                    let l = l as f64;
                    let above = ((2.0 * l + 1.0) * a.dot(*b) * now - l * below) / (l + 1.0);
                    (below, now) = (now, above);
                }
            }
        }
        for (l, (got, plain)) in spectrum(&points, degree).iter().zip(&plain).enumerate() {
            // Grid positions are off by up to pi/512, which changes degree l by some l^2 / 512 of a
            // squared radian, and randomly with few points.
            let off = 2e-3 * (1.0 + l as f64 / 8.0);
            assert!((got - plain).abs() < off, "{l}: {got} {plain}");
        }
    }
}
