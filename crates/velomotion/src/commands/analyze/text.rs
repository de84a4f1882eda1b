//! Report of `analyze` as tables of 80 columns.

use std::fmt::{Display, Write};

use analysis::density::{EmptyBand, HistogramClass, Statistics};
use analysis::tilted_sensor::VisibleRange;
use engine::words::counted;

use super::report::{AnalyzeReport, BAND_DEG, DeviceReport, HoleReport, KReport, PatternReport};

const WIDTH: usize = 80;

impl AnalyzeReport {
    /// The report as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.table();
        for pattern in &self.patterns {
            text.push('\n');
            pattern.describe(&mut text);
        }
        text.trim_end().to_owned()
    }

    /// Columns of a comparison.
    fn table(&self) -> String {
        let names = self.patterns.iter().map(|p| p.name.chars().count());
        let long = names.clone().any(|length| length > NAME);
        let column = names.max().unwrap_or(0).clamp(8, NAME);
        let above = ["points", "scan", "points", "", "", "", "points", "hole in"];
        let below = ["", "s", "a bin", "sd", "min", "max", "a deg2", "view deg"];
        let mut text = format!(
            "{:column$} {}\n{:column$} {}\n",
            "",
            aligned(above, WIDTHS),
            "pattern",
            aligned(below, WIDTHS)
        );
        for pattern in &self.patterns {
            let s = &pattern.density.bins;
            let hole = pattern.hole_in_view.as_ref();
            if long {
                let _ = writeln!(text, "{}", pattern.name);
            }
            let cells = [
                pattern.points.to_string(),
                pattern.scan_s.map_or("-".to_owned(), |s| number(s, 6)),
                thousandths(s.mean, 7),
                thousandths(s.sd, 8),
                s.min.to_string(),
                s.max.to_string(),
                number(s.mean_per_deg2, 7),
                hole.map_or("-".to_owned(), |hole| number(hole.radius_deg, 6)),
            ];
            let name = if long { "" } else { &pattern.name };
            let _ = writeln!(text, "{name:column$} {}", aligned(cells, WIDTHS));
        }
        text
    }
}

/// Cells aligned right in columns of these widths.
pub(super) fn aligned<T: Display>(
    cells: impl IntoIterator<Item = T>,
    widths: impl IntoIterator<Item = usize>,
) -> String {
    let cells = cells.into_iter().zip(widths);
    let cells = cells.map(|(cell, width)| format!("{cell:>width$}"));
    cells.collect::<Vec<_>>().join(" ")
}

/// Longest name of a row label.
const NAME: usize = 14;
/// Widths of the other columns of a comparison.
const WIDTHS: [usize; 8] = [9, 6, 7, 8, 6, 7, 7, 8];

impl PatternReport {
    fn describe(&self, text: &mut String) {
        let s = &self.density.bins;
        let _ = writeln!(text, "{}", self.name);
        for line in self.lines() {
            let wrapped = textwrap::fill(
                &line,
                textwrap::Options::new(WIDTH)
                    .initial_indent("  ")
                    .subsequent_indent("    "),
            );
            let _ = writeln!(text, "{wrapped}");
        }
        let _ = writeln!(
            text,
            "  bins by their points ({} bins, {} without any):",
            s.bins, s.empty
        );
        text.push_str(&histogram(&self.density.histogram));
    }

    fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(frames) = self.frames {
            lines.push(format!("{} of the lidar", counted(frames, "revolution")));
        }
        let left_out = [
            (self.without_direction, "in the origin"),
            (self.without_numbers, "whose coordinates are no numbers"),
        ];
        for (points, which) in left_out.into_iter().filter(|(points, _)| *points > 0) {
            lines.push(format!("{} {which} left out", counted(points, "point")));
        }
        lines.push(self.hole.line("largest hole"));
        lines.push(match (&self.hole_in_view, &self.view) {
            (Some(hole), _) => hole.line("largest hole in view"),
            (None, Some(_)) => "nothing is in view at all distances".to_owned(),
            (None, None) => "largest hole in view: not known, as nothing in a cloud says what its scanner could see".to_owned(),
        });
        lines.push(self.gaps_line());
        lines.extend(self.emptiest_line());
        lines.extend(self.blind_line());
        lines.extend(self.band_line());
        lines.extend(bins_line("all", &self.density.bins));
        let in_view = self.density_in_view.as_ref();
        lines.extend(in_view.and_then(|bins| bins_line("in view", bins)));
        lines.push(self.k.line());
        if let Some(device) = &self.device {
            lines.extend(device.lines());
        }
        let warnings = self.warnings.iter();
        lines.extend(warnings.map(|warning| format!("warning: {warning}")));
        lines
    }

    fn gaps_line(&self) -> String {
        let gaps = &self.gaps;
        let of = match gaps.of {
            "view" => "directions in view",
            _ => "directions (the whole sphere)",
        };
        format!(
            "a point within {} deg of half of all {of}, within {} deg of 95 %, within {} deg of 99 %",
            number(gaps.median_deg, 6),
            number(gaps.of_95_percent_deg, 6),
            number(gaps.of_99_percent_deg, 6)
        )
    }

    /// Line about the location of the emptiest bins.
    fn emptiest_line(&self) -> Option<String> {
        let first = self.emptiest.first()?;
        let angles = self.emptiest.iter().map(|bin| bin.from_axis_deg);
        let (low, high) = angles.fold((f64::MAX, f64::MIN), |(low, high), angle| {
            (low.min(angle), high.max(angle))
        });
        Some(format!(
            "the {} emptiest bins have {} points and more, {} to {} deg from the tilt axis",
            self.emptiest.len(),
            first.points,
            number(low, 4),
            number(high, 4)
        ))
    }

    fn blind_line(&self) -> Option<String> {
        let blind = &self.blind;
        let (holes, least_deg) = (blind.holes?, blind.least_radius_deg?);
        let more = if blind.and_more? { "at least " } else { "" };
        Some(format!(
            "{more}{} (holes of {} deg and more), in {} about the tilt axis",
            counted(holes as u64, "blind spot"),
            number(least_deg, 6),
            counted(blind.rows.as_ref()?.len() as u64, "row"),
        ))
    }

    fn band_line(&self) -> Option<String> {
        let bands = &self.blind.bands;
        let widest = bands
            .iter()
            .max_by(|a, b| a.width_deg().total_cmp(&b.width_deg()))?;
        let sum: f64 = bands.iter().map(EmptyBand::width_deg).sum();
        let why = if self.blind.bands_at_any_speed {
            " at any speed"
        } else {
            ""
        };
        Some(format!(
            "{} about the tilt axis, {BAND_DEG} deg and wider, {} no point{why}: {} deg together, the widest from {} to {} deg",
            counted(bands.len() as u64, "band"),
            if bands.len() == 1 { "holds" } else { "hold" },
            number(sum, 6),
            number(widest.from_deg, 6),
            number(widest.to_deg, 6)
        ))
    }
}

/// Coverage and evenness of some bins.
fn bins_line(which: &str, s: &Statistics) -> Option<String> {
    let (coverage, uneven) = (s.coverage?, s.sd_over_mean?);
    Some(format!(
        "bins {which}: {} of {} hold a point ({:.1} %), sd / mean {uneven:.3}",
        s.bins.saturating_sub(s.empty),
        s.bins,
        100.0 * coverage,
    ))
}

impl KReport {
    fn line(&self) -> String {
        let (Some(d_min), Some(d_max), Some(bound)) = (self.d_min, self.d_max, self.d_error_bound)
        else {
            return "no K function: a single point has no pairs".to_owned();
        };
        let how = match bound {
            0.0 => "every pair counted".to_owned(),
            bound => format!(
                "{}, within {bound:.1e} but for a risk of 1 in {:.0}",
                self.method,
                self.risk.unwrap_or(1.0).recip()
            ),
        };
        format!("K - K_csr from {d_min:.5} to {d_max:+.5} of the sphere's area ({how})")
    }
}

impl HoleReport {
    fn line(&self, what: &str) -> String {
        // Avoids a signed zero.
        let [x, y, z] = self
            .centre
            .map(|axis| if axis.abs() < 5e-4 { 0.0 } else { axis });
        // Below it the bound is that of the search.
        let is_wide = self.at_most_deg - self.radius_deg > 1e-3;
        let to = if is_wide {
            format!(" to {}", number(self.at_most_deg, 7))
        } else {
            String::new()
        };
        format!(
            "{what}: {}{to} deg about ({x:.3}, {y:.3}, {z:.3}), {} deg from the tilt axis",
            number(self.radius_deg, 7),
            number(self.from_axis_deg, 6)
        )
    }
}

impl DeviceReport {
    fn lines(&self) -> [String; 3] {
        let VisibleRange {
            range_m: [near, far],
            forwards_deg,
            backwards_deg,
            ..
        } = self.view;
        [
            format!("the device sees from {near:.3} to {far:.3} m"),
            format!(
                "elevations towards -x: {}, towards +x: {}",
                elevations(forwards_deg),
                elevations(backwards_deg)
            ),
            format!(
                "mean vertical resolution {} deg, tilt per revolution {} deg",
                number(self.mean_vertical_resolution_deg, 7),
                number(self.tilt_per_turn_deg, 7)
            ),
        ]
    }
}

fn elevations(range_deg: Option<[f64; 2]>) -> String {
    let trim = |x: f64| (x * 1e6).round() / 1e6;
    range_deg.map_or("none".to_owned(), |[low, high]| {
        format!("{} to {} deg", trim(low), trim(high))
    })
}

/// One bar per class; the longest fills the available width.
fn histogram(classes: &[HistogramClass]) -> String {
    const BAR: usize = 50;
    let most = classes
        .iter()
        .map(|class| class.bins)
        .max()
        .unwrap_or(0)
        .max(1);
    let digits = classes.last().map_or(1, |class| class.to.to_string().len());
    let mut text = String::new();
    for class in classes {
        let bar = (class.bins * BAR).div_ceil(most);
        let line = format!(
            "  {:>digits$} to {:>digits$} {:>8} {}",
            class.from,
            class.to,
            class.bins,
            "#".repeat(bar)
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// A number with about four digits and at most `places` decimals.
pub(super) fn number(x: f64, places: usize) -> String {
    let decimals = match x.abs() {
        size if size < 1.0 => 4,
        size if size < 10.0 => 3,
        _ => 2,
    };
    let whole = format!("{:.0}", x.trunc()).len();
    let decimals = decimals.min(places.saturating_sub(whole + 1));
    format!("{x:.decimals$}")
}

/// A number with three decimals if there is room, so that rounding does not depend on the last bit
/// of a half.
fn thousandths(x: f64, places: usize) -> String {
    let whole = format!("{:.0}", x.trunc()).len();
    let decimals = places.saturating_sub(whole + 1).min(3);
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (x, places, expected) in [
            (84.468_75, 7, "84.47"),
            (0.586, 7, "0.5860"),
            (1_037_952.0, 7, "1037952"),
            (202.732, 7, "202.73"),
            (1.5, 6, "1.500"),
            (-0.25, 6, "-0.250"),
            (75.0, 6, "75.00"),
        ] {
            assert_eq!(number(x, places), expected);
        }
    }

    #[test]
    fn means_are_printed_in_full_where_the_table_has_room() {
        for (x, places, expected) in [
            (1_037_952.0 / 5_120.0, 7, "202.725"),
            (133.948_6, 8, "133.949"),
            (84.468_75, 7, "84.469"),
            (12_345.678_9, 7, "12345.7"),
            (1_234_567.8, 7, "1234568"),
            (0.000_4, 7, "0.000"),
        ] {
            assert_eq!(thousandths(x, places), expected);
        }
    }

    #[test]
    fn bars_are_as_long_as_there_is_room() {
        let class = |from, bins| HistogramClass {
            from,
            to: from + 99,
            bins,
        };
        let text = histogram(&[class(0, 5_000), class(100, 1), class(200, 0)]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0].matches('#').count(), 50);
        assert_eq!(lines[1].matches('#').count(), 1);
        assert!(lines[2].ends_with(" 0"));
        assert!(lines.iter().all(|line| line.len() <= WIDTH));
    }
}
