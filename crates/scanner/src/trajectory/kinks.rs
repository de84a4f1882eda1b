//! Kinks: instants at which the speed changes at once, as where an obstacle stops the head.
//!
//! Around a kink two straight lines fit the samples better than one cubic, which has as many
//! parameters; around a ramp they do not.

use nalgebra::{SMatrix, SVector};

use super::profile_fit::Observed;

/// Samples on either side.
const SIDE: usize = 6;
/// By how much the sum of squares of the lines is below the cubic's, in variances of the samples.
/// That of errors alone differs by less in a whole scan.
const MIN_GAIN: f64 = 25.0;
/// Greatest sum of squares of both lines, in variances: twice its expectation.
const MAX_SQUARES: f64 = 2.0 * (2 * SIDE - 4) as f64;
/// Greatest number of kinks: more are a motion that splines follow as well.
const MAX_KINKS: usize = 12;

/// A kink, and the gain by it.
struct Kink {
    at_s: f64,
    gain: f64,
    index: usize,
}

/// The kinks of `observed`, in order of time.
pub(super) fn find(observed: &[Observed]) -> Vec<f64> {
    let around = observed.windows(2 * SIDE).enumerate();
    let mut kinks: Vec<Kink> = around
        .filter_map(|(index, window)| kink(window, index))
        .collect();
    kinks.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut kept: Vec<Kink> = Vec::new();
    for kink in kinks {
        let is_apart = |other: &Kink| other.index.abs_diff(kink.index) >= SIDE;
        if kept.len() < MAX_KINKS && kept.iter().all(is_apart) {
            kept.push(kink);
        }
    }
    kept.sort_by(|a, b| a.at_s.total_cmp(&b.at_s));
    kept.dedup_by(|b, a| b.at_s <= a.at_s);
    kept.into_iter().map(|kink| kink.at_s).collect()
}

/// The kink in the middle of `window`, if one is there.
fn kink(window: &[Observed], index: usize) -> Option<Kink> {
    let (before, after) = window.split_at_checked(SIDE)?;
    let (last, first) = (before.last()?, after.first()?);
    let origin = first.at_s;
    let (left, left_squares) = polynomial::<2>(before, origin)?;
    let (right, right_squares) = polynomial::<2>(after, origin)?;
    let at_s = origin + (left[0] - right[0]) / (right[1] - left[1]);
    // Beyond the neighbours of the middle one of the lines would have other samples.
    let margin_s = 0.5 * (first.at_s - last.at_s);
    if !(last.at_s - margin_s..=first.at_s + margin_s).contains(&at_s) {
        return None;
    }
    let (_, cubic_squares) = polynomial::<4>(window, origin)?;
    let gain = cubic_squares - left_squares - right_squares;
    // A quick ramp is no kink: the samples within it are off both lines.
    let is_straight = left_squares + right_squares < MAX_SQUARES;
    (is_straight && gain > MIN_GAIN).then_some(Kink { at_s, gain, index })
}

/// A polynomial of `N` coefficients through samples by least squares, and the sum of the squares of
/// its residuals in their variances.
fn polynomial<const N: usize>(samples: &[Observed], origin: f64) -> Option<(SVector<f64, N>, f64)> {
    let span_s = samples.last()?.at_s - samples.first()?.at_s;
    if span_s <= 0.0 {
        return None;
    }
    let row = |o: &Observed| {
        let x = (o.at_s - origin) / span_s;
        SVector::<f64, N>::from_fn(|power, _| x.powi(power as i32))
    };
    let (mut normal, mut right) = (SMatrix::<f64, N, N>::zeros(), SVector::<f64, N>::zeros());
    let zero = samples.first()?.angle_deg;
    for o in samples {
        let (row, weight) = (row(o), 1.0 / (o.sd_deg * o.sd_deg));
        normal += row * row.transpose() * weight;
        right += row * (o.angle_deg - zero) * weight;
    }
    let mut found = normal.cholesky()?.solve(&right);
    let squares = samples
        .iter()
        .map(|o| ((o.angle_deg - zero - row(o).dot(&found)) / o.sd_deg).powi(2))
        .sum();
    for (power, coefficient) in found.iter_mut().enumerate() {
        *coefficient /= span_s.powi(power as i32);
    }
    if let Some(constant) = found.get_mut(0) {
        *constant += zero;
    }
    Some((found, squares))
}
