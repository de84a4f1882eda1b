//! `velomotion analyze PATTERN --sweep`: many settings of one pattern, and those on the Pareto
//! front against scan time.
//!
//! Three quantities are measured within the field of view: the largest hole; the distance to the
//! nearest point for 99 % of directions, which is not decided by a single place; and the evenness
//! of the bins (sd over mean).

use std::sync::atomic::AtomicBool;

use analysis::density::{DensityError, TOLERANCE_RAD, largest_hole_within, quantile};
use analysis::tradeoff::front::front;
use glam::DVec3;
use serde::Serialize;
use sim::patterns::{Pattern, PatternRequest};
use utoipa::ToSchema;

use super::directions::Directions;
use super::input::pattern_failure;
use super::text::{aligned, number};
use super::{Measure, failure, go_on};
use crate::sweep_ranges::SweepRanges;
use crate::terminal::Progress;
use engine::failure::{Failure, Kind};

/// Report on all settings.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct SettingsReport {
    /// Pattern as named by the user.
    pub pattern: String,
    /// Varied parameters, in the order of `values`.
    pub keys: Vec<String>,
    /// Settings ordered by scan time.
    pub settings: Vec<SweepSetting>,
}

/// Report on one setting.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct SweepSetting {
    /// Values of the parameters.
    pub values: Vec<f64>,
    /// Duration of a scan, seconds.
    pub scan_s: f64,
    /// Points.
    pub points: u64,
    /// Radius of the largest hole in view, degrees.
    pub hole_deg: f64,
    /// Distance to the nearest point that 99 % of directions in view do not exceed, degrees.
    pub gap_deg: f64,
    /// Standard deviation over mean of the points per bin in view.
    pub sd_over_mean_in_view: f64,
    /// Whether the setting is on the Pareto front of time and largest hole.
    pub best_hole: bool,
    /// Whether it is on the front of time and gap.
    pub best_gap: bool,
    /// Whether it is on the front of time and `sd_over_mean_in_view`.
    pub best_evenness: bool,
}

impl SweepRanges {
    /// Measures all settings of one named pattern.
    ///
    /// # Errors
    /// [`Kind::Usage`] for anything but one pattern, and for parameters it does not have.
    pub(super) fn run(
        &self,
        inputs: &[String],
        measure: &Measure,
        mut progress: Progress,
        interrupt: &AtomicBool,
    ) -> Result<SettingsReport, Failure> {
        let [name] = inputs else {
            let what = format!(
                "--sweep tries settings of one pattern, not of {}",
                inputs.len()
            );
            return Err(Failure::new(Kind::Usage, what).help(EXAMPLE));
        };
        let request =
            PatternRequest::parse(name).map_err(|error| pattern_failure(&error).help(EXAMPLE))?;
        // All are checked before the first is measured.
        let patterns = self.patterns(&request)?;
        let mut settings = Vec::with_capacity(patterns.len());
        progress.begin_count(patterns.len() as u64);
        for (number, (values, pattern)) in patterns.into_iter().enumerate() {
            go_on(interrupt)?;
            let measured = measured(values, &pattern, measure);
            settings.push(measured.map_err(|error| failure(pattern.name(), &error))?);
            progress.counted(number as u64 + 1);
        }
        progress.end_run();
        settings.sort_by(|a, b| a.scan_s.total_cmp(&b.scan_s));
        mark(&mut settings);
        Ok(SettingsReport {
            pattern: name.clone(),
            keys: self.ranges.iter().map(|range| range.key.clone()).collect(),
            settings,
        })
    }

    fn patterns(&self, request: &PatternRequest) -> Result<Vec<(Vec<f64>, Pattern)>, Failure> {
        let all: usize = self.ranges.iter().map(|range| range.steps).product();
        (0..all)
            .map(|mut number| {
                let mut request = request.clone();
                let mut values = Vec::with_capacity(self.ranges.len());
                for range in &self.ranges {
                    let value = range.value(number % range.steps);
                    number /= range.steps;
                    request
                        .set_number(&range.key, value)
                        .map_err(|error| pattern_failure(&error).help(EXAMPLE))?;
                    values.push(value);
                }
                let pattern = request.build().map_err(|error| pattern_failure(&error))?;
                Ok((values, pattern))
            })
            .collect()
    }
}

const EXAMPLE: &str = "as in: velomotion analyze velomotion16 --sweep speed=5..56.25,rpm=300..1200";

fn measured(
    values: Vec<f64>,
    pattern: &Pattern,
    measure: &Measure,
) -> Result<SweepSetting, DensityError> {
    let directions = Directions::of_pattern(pattern);
    let view = pattern.view();
    let depth = |direction: DVec3| view.depth_rad(direction);
    let in_view = measure.in_view(&view);
    let is_in_view = |bin: usize| in_view.get(bin).copied().unwrap_or(false);
    let counts = directions.counts(&measure.locator)?;
    let statistics = counts.statistics_of(is_in_view);
    let (thinned, _) = directions.thinned();
    let hole = largest_hole_within(&thinned, 100.0 * TOLERANCE_RAD, &depth)?;
    let gap = quantile(&measure.gaps_in_view(&directions, Some(&view))?, 0.99);
    Ok(SweepSetting {
        values,
        scan_s: pattern.scan_s(),
        points: directions.points(),
        hole_deg: hole.map_or(180.0, |hole| hole.hole.radius_rad.to_degrees()),
        gap_deg: gap.map_or(180.0, f64::to_degrees),
        // A scan without points in view counts as maximally uneven.
        sd_over_mean_in_view: statistics.sd_over_mean.unwrap_or(f64::MAX),
        best_hole: false,
        best_gap: false,
        best_evenness: false,
    })
}

/// Marks the Pareto fronts.
fn mark(settings: &mut [SweepSetting]) {
    let costs = |of: fn(&SweepSetting) -> f64| -> Vec<bool> {
        let costs = settings
            .iter()
            .map(|setting| vec![setting.scan_s, of(setting)]);
        front(&costs.collect::<Vec<_>>())
    };
    // Hole sizes are accurate to 100 times the smallest tolerance.
    let holes = costs(|setting| (setting.hole_deg * 100.0).round());
    let gaps = costs(|setting| setting.gap_deg);
    let even = costs(|setting| setting.sd_over_mean_in_view);
    for (((setting, hole), gap), even) in settings.iter_mut().zip(holes).zip(gaps).zip(even) {
        setting.best_hole = hole;
        setting.best_gap = gap;
        setting.best_evenness = even;
    }
}

impl SettingsReport {
    /// Table of the settings on the fronts.
    #[must_use]
    pub fn text(&self) -> String {
        let best = |s: &&SweepSetting| s.best_hole || s.best_gap || s.best_evenness;
        let shown = self.settings.iter().filter(best);
        let mut text = format!(
            "{}: {} settings; those that no other beats for their scan time\n\n",
            self.pattern,
            self.settings.len()
        );
        // All three columns refer to the field of view, so their headings differ from those of
        // other tables.
        let keys = self.keys.len();
        let mut line = |values: Vec<String>, others: [String; 5]| {
            let widths = std::iter::repeat_n(8, keys).chain([8, 9, 9, 9, 10]);
            text += &aligned(values.into_iter().chain(others), widths);
            text.push('\n');
        };
        let above = ["", "", "in view ", "in view ", "in view "];
        let below = ["scan s", "points", "hole deg ", "99 % deg ", "sd / mean "];
        line(vec![String::new(); keys], above.map(str::to_owned));
        line(self.keys.clone(), below.map(str::to_owned));
        for setting in shown {
            let values = setting.values.iter().map(|value| number(*value, 8));
            let marked = |value: f64, best: bool| {
                let mark = if best { "*" } else { " " };
                format!("{}{mark}", number(value, 7))
            };
            let others = [
                number(setting.scan_s, 7),
                setting.points.to_string(),
                marked(setting.hole_deg, setting.best_hole),
                marked(setting.gap_deg, setting.best_gap),
                marked(setting.sd_over_mean_in_view, setting.best_evenness),
            ];
            line(values.collect(), others);
        }
        text.push_str(
            "\nall in view, where the scan can see: radius of the largest hole; 99 % of\n\
             directions have a point within; sd / mean of points per bin, bins in view\n\
             * no other setting is as good in this and as quick, and better in one of them\n",
        );
        text.trim_end().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_parsed_and_include_their_ends() {
        let sweep: SweepRanges = "speed=5..56.25,start=-90..90/5".parse().unwrap();
        let [speed, start] = sweep.ranges.as_slice() else {
            panic!("{sweep:?}");
        };
        assert_eq!(
            (speed.value(0), speed.value(7), speed.steps),
            (5.0, 56.25, 8)
        );
        // Geometric steps, and linear steps through 0.
        assert!((speed.value(1) / speed.value(0) - speed.value(7) / speed.value(6)).abs() < 1e-12);
        let starts: Vec<f64> = (0..5).map(|step| start.value(step)).collect();
        assert_eq!(starts, [-90.0, -45.0, 0.0, 45.0, 90.0]);
    }

    #[test]
    fn invalid_ranges_are_reported() {
        for text in [
            "",
            "speed",
            "speed=5",
            "speed=5..",
            "speed=a..b",
            "speed=5..6/0",
            "speed=5..6/1",
            "speed=5..6/x",
            "speed=5..inf",
        ] {
            assert!(text.parse::<SweepRanges>().is_err(), "{text}");
        }
        let many = "speed=1..2/101,rpm=1..2/100".parse::<SweepRanges>();
        assert_eq!(many.unwrap_err(), "expected at most 10000 settings in all");
        let twice = "rpm=300..600,rpm=600..900".parse::<SweepRanges>();
        assert_eq!(twice.unwrap_err(), "rpm: expected one range of it, got two");
        let tilt = "tilt=1..2".parse::<SweepRanges>().unwrap_err();
        assert!(
            tilt.contains("tilt is no number") && tilt.contains("tilt=stepped"),
            "{tilt}"
        );
        for one in ["speed=5..5/1", "speed=5..5", "speed=5..5/9"] {
            assert_eq!(
                one.parse::<SweepRanges>().unwrap().ranges[0].steps,
                1,
                "{one}"
            );
        }
    }

    #[test]
    fn fronts_contain_the_undominated_settings() {
        let setting =
            |scan_s: f64, hole_deg: f64, gap_deg: f64, sd_over_mean_in_view: f64| SweepSetting {
                values: vec![scan_s],
                scan_s,
                points: 1,
                hole_deg,
                gap_deg,
                sd_over_mean_in_view,
                best_hole: false,
                best_gap: false,
                best_evenness: false,
            };
        let mut settings = [
            setting(1.0, 3.0, 2.0, 0.5),
            setting(2.0, 3.0, 1.0, 0.6),
            setting(3.0, 2.0, 1.5, 0.4),
        ];
        mark(&mut settings);
        assert_eq!(
            settings.each_ref().map(|s| s.best_hole),
            [true, false, true]
        );
        assert_eq!(settings.each_ref().map(|s| s.best_gap), [true, true, false]);
        assert_eq!(
            settings.each_ref().map(|s| s.best_evenness),
            [true, false, true]
        );
    }
}
