//! Viridis with dark for many points. Its lightness is monotonic, so it works for colour-blind
//! readers and in grey print.

/// Viridis at eighths (Smith and van der Walt 2015, CC0). Linear interpolation is within 18 of 255.
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];

/// The SVG colour of a share from 0 (light) to 1 (dark).
pub(super) fn colour(share: f64) -> String {
    let place = (1.0 - share.clamp(0.0, 1.0)) * 8.0;
    let below = (place.floor() as usize).min(7);
    let part = place - below as f64;
    let of = |n: usize| VIRIDIS.get(n).copied().unwrap_or_default();
    let mut text = "#".to_owned();
    for (from, to) in of(below).into_iter().zip(of(below + 1)) {
        let value = f64::from(from) + part * (f64::from(to) - f64::from(from));
        text += &format!("{:02x}", value.round() as u8);
    }
    text
}

/// A logarithmic colour scale of whole numbers from the smallest above zero to the largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shades {
    pub low: u64,
    pub high: u64,
}

impl Shades {
    /// Number of colours.
    pub(super) const STEPS: usize = 40;

    /// The scale of these numbers; 1 to 1 if none is above zero.
    pub(super) fn new(numbers: impl Iterator<Item = u64>) -> Self {
        let (low, high) = numbers
            .filter(|n| *n > 0)
            .fold((u64::MAX, 1), |(low, high), n| (low.min(n), high.max(n)));
        Self {
            low: low.min(high),
            high,
        }
    }

    /// Position of a number between `low` and `high`, 0 to 1.
    pub(super) fn share(&self, number: f64) -> f64 {
        if self.high == self.low {
            return 0.5;
        }
        let low = self.low as f64;
        ((number.max(low) / low).ln() / (self.high as f64 / low).ln()).clamp(0.0, 1.0)
    }

    /// Index of the colour of a number above zero.
    pub(super) fn step(&self, number: u64) -> usize {
        ((self.share(number as f64) * Self::STEPS as f64) as usize).min(Self::STEPS - 1)
    }

    /// The colour at the middle of a step.
    pub(super) fn of_step(step: usize) -> String {
        colour((step as f64 + 0.5) / Self::STEPS as f64)
    }

    /// Labels of the scale: its ends, and round numbers that are not close to them or to each
    /// other.
    pub(super) fn ticks(&self) -> Vec<u64> {
        let mut ticks = vec![self.low];
        if self.high > self.low {
            ticks.push(self.high);
        }
        for digits in [[1, 1, 1], [2, 5, 2]] {
            for power in 0..19 {
                for digit in digits {
                    let round = digit * 10_u64.pow(power);
                    let inside = self.low < round && round < self.high;
                    let close = |tick: &u64| {
                        (self.share(*tick as f64) - self.share(round as f64)).abs() < 0.09
                    };
                    if inside && !ticks.iter().any(close) {
                        ticks.push(round);
                    }
                }
            }
        }
        ticks.sort_unstable();
        ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_falls_evenly_with_the_value() {
        assert_eq!(
            (colour(1.0), colour(0.0)),
            ("#440154".into(), "#fde725".into())
        );
        let lightness = |share: f64| -> f64 {
            let hex = colour(share);
            let part =
                |from: usize| f64::from(u8::from_str_radix(&hex[from..from + 2], 16).unwrap());
            0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
        };
        let steps: Vec<f64> = (0..=40).map(|i| lightness(f64::from(i) / 40.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[1] < pair[0]), "{steps:?}");
    }

    #[test]
    fn shades_are_logarithmic_from_minimum_to_maximum() {
        let shades = Shades::new([0, 10, 1_000, 40].into_iter());
        assert_eq!((shades.low, shades.high), (10, 1_000));
        assert_eq!(
            (shades.step(10), shades.step(100), shades.step(1_000)),
            (0, 20, 39)
        );
        assert_eq!(shades.ticks(), [10, 20, 50, 100, 200, 500, 1_000]);
        for none in [vec![], vec![0, 0], vec![7, 7]] {
            let shades = Shades::new(none.iter().copied());
            assert_eq!(shades.low, shades.high);
            assert_eq!(shades.ticks().len(), 1);
            assert!(shades.step(7) < Shades::STEPS);
        }
    }
}
