//! Plot axes: positions of values, and ticks.

use super::number;

/// Mapping of an axis from values to positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Even steps.
    Linear,
    /// Powers of ten; zero has a place of its own below them.
    Log,
}

/// An axis that maps values from `low` to `high` to pixels from `from` to `to`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlotAxis {
    scale: Scale,
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    /// Position of zero on a logarithmic axis that shows it.
    zero: Option<f64>,
}

/// A grid line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AxisTick {
    pub at: f64,
    /// Empty for a line without a number.
    pub label: String,
}

/// Share of a logarithmic axis that zero takes.
const ZERO_SHARE: f64 = 0.08;
/// The largest number of labels on an axis.
const MOST_LABELS: i32 = 7;

impl PlotAxis {
    /// An axis that shows `values` from pixel `from` to pixel `to`, with margins.
    pub(crate) fn new(scale: Scale, values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let mut low = f64::INFINITY;
        let mut high = f64::NEG_INFINITY;
        let mut has_zero = false;
        for value in values.filter(|v| v.is_finite()) {
            if scale == Scale::Log && value <= 0.0 {
                has_zero = true;
            } else {
                low = low.min(value);
                high = high.max(value);
            }
        }
        if low > high {
            (low, high) = (1.0, 1.0);
        }
        let zero = has_zero.then_some(from + (to - from) * ZERO_SHARE / 2.0);
        let from = if has_zero {
            from + (to - from) * ZERO_SHARE
        } else {
            from
        };
        let (low, high) = match scale {
            Scale::Linear => {
                let air = if high > low { 0.08 * (high - low) } else { 1.0 };
                let floor = if low >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
                ((low - air).max(floor), high + air)
            }
            Scale::Log => {
                let air = (high / low).powf(0.07).max(1.3);
                (low / air, high * air)
            }
        };
        Self {
            scale,
            low,
            high,
            from,
            to,
            zero,
        }
    }

    /// Position of a value; `None` if it has none.
    pub(crate) fn position(&self, value: f64) -> Option<f64> {
        let part = match self.scale {
            _ if !value.is_finite() => return None,
            Scale::Log if value <= 0.0 => return self.zero,
            Scale::Log => (value / self.low).ln() / (self.high / self.low).ln(),
            Scale::Linear => (value - self.low) / (self.high - self.low),
        };
        Some(self.from + (self.to - self.from) * part)
    }

    /// Grid lines and labels.
    pub(crate) fn ticks(&self) -> Vec<AxisTick> {
        let mut ticks = match self.scale {
            Scale::Log => self.powers(),
            Scale::Linear => self.steps(),
        };
        if let Some(at) = self.zero {
            ticks.push(AxisTick {
                at,
                label: "0".to_owned(),
            });
        }
        ticks
    }

    fn powers(&self) -> Vec<AxisTick> {
        let (first, last) = (self.low.log10().floor(), self.high.log10().ceil());
        let (first, last) = (first as i32, last as i32);
        let decades = (self.high / self.low).log10();
        let every = (decades / f64::from(MOST_LABELS)).ceil().max(1.0) as i32;
        let digits: &[f64] = match decades {
            d if d < 0.8 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
            d if d < 2.2 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let mut ticks = Vec::new();
        for power in first..=last {
            for digit in digits {
                let value = digit * 10_f64.powi(power);
                if value < self.low || value > self.high {
                    continue;
                }
                let label = match digits.len() {
                    1 if power % every != 0 => String::new(),
                    1 => number::decade(power),
                    _ => number::short(value),
                };
                if let Some(at) = self.position(value) {
                    ticks.push(AxisTick { at, label });
                }
            }
        }
        ticks
    }

    fn steps(&self) -> Vec<AxisTick> {
        let rough = (self.high - self.low) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|digit| digit * power)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        (first..=last.min(first.saturating_add(20)))
            .filter_map(|i| {
                let value = i as f64 * step;
                Some(AxisTick {
                    at: self.position(value)?,
                    label: number::short(value),
                })
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn labels(axis: &PlotAxis) -> Vec<String> {
        axis.ticks().into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn log_axes_label_decades_and_zero() {
        let axis = PlotAxis::new(Scale::Log, [0.0, 2e-6, 150.0].into_iter(), 100.0, 0.0);
        assert_eq!(axis.position(0.0), Some(96.0));
        assert!(axis.position(2e-6).unwrap() < 92.0);
        let labels = labels(&axis);
        assert!(labels.contains(&"100".to_owned()), "{labels:?}");
        assert_eq!(labels.last().unwrap(), "0");
        assert_eq!(axis.position(f64::NAN), None);
        let positive = PlotAxis::new(Scale::Log, [1.0, 2.0].into_iter(), 0.0, 100.0);
        assert_eq!(positive.position(0.0), None);
    }

    #[test]
    fn short_log_axes_have_labels_within_a_decade() {
        let axis = PlotAxis::new(Scale::Log, [9.0, 30.0].into_iter(), 0.0, 100.0);
        assert_eq!(labels(&axis), ["8", "10", "15", "20", "30"]);
        let axis = PlotAxis::new(Scale::Linear, [9.0, 43.0].into_iter(), 0.0, 100.0);
        assert_eq!(labels(&axis), ["10", "20", "30", "40"]);
    }

    proptest! {
        #[test]
        fn axes_keep_the_order_of_values(
            values in prop::collection::vec((1.0..10.0_f64, -12..12_i32), 1..20), log: bool,
        ) {
            let scale = if log { Scale::Log } else { Scale::Linear };
            let mut values: Vec<f64> = values.iter().map(|(x, p)| x * 10_f64.powi(*p)).collect();
            values.sort_by(f64::total_cmp);
            let axis = PlotAxis::new(scale, values.iter().copied(), 40.0, 400.0);
            let places: Vec<f64> = values.iter().map(|v| axis.position(*v).unwrap()).collect();
            prop_assert!(places.iter().all(|p| (40.0..=400.0).contains(p)), "{:?}", places);
            prop_assert!(places.is_sorted());
            let ticks = axis.ticks();
            prop_assert!(ticks.len() < 40);
            prop_assert!(ticks.iter().all(|t| (39.9..=400.1).contains(&t.at)));
        }
    }
}
