//! What `analyze` says: JSON for programs, tables of 80 columns for people.

use std::fmt::Write;

use analysis::density::{Band, Class, Counts, Row, Statistics};
use analysis::device::View;
use analysis::k::KCurve;
use serde::Serialize;

/// All that was asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// One entry a pattern, cloud or log, in the order asked for.
    pub patterns: Vec<PatternReport>,
}

/// Of one pattern, cloud or log.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PatternReport {
    /// Its name as it was asked for.
    pub name: String,
    /// Points that have a direction.
    pub points: u64,
    /// Turns of the lidar; null where they are not known.
    pub frames: Option<u64>,
    /// How long the scan takes, seconds; null where it is not known.
    pub scan_s: Option<f64>,
    /// Points in the origin, left out.
    pub without_direction: u64,
    /// Points a bin.
    pub density: Density,
    /// The largest circle without a point, anywhere.
    pub hole: HoleReport,
    /// The largest with its middle where the scan can see at all; only of patterns, whose fields of view are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hole_in_view: Option<HoleReport>,
    /// How far it is from directions that the scan can see to the nearest point.
    pub gaps: Gaps,
    /// Blind spots.
    pub blind: Blind,
    /// How evenly points lie, by the angles between them.
    pub k: KReport,
    /// What may mislead.
    pub warnings: Vec<String>,
    /// What the mount makes of the sensor; only where it is tilted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub device: Option<DeviceReport>,
}

/// Points a bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Density {
    /// What their numbers are like.
    #[serde(flatten)]
    pub statistics: Statistics,
    /// How often the icosahedron is cut.
    pub level: u32,
    /// Bins by their points.
    pub histogram: Vec<Class>,
    /// Points in each, for figures.
    #[serde(skip)]
    pub counts: Counts,
}

/// The largest circle without a point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HoleReport {
    /// Its radius, degrees.
    pub radius_deg: f64,
    /// No such circle is larger than this, degrees.
    pub at_most_deg: f64,
    /// The direction of its middle: x right, y along the tilt axis, z up.
    pub centre: [f64; 3],
    /// The angle of its middle from the tilt axis (+y), degrees.
    pub from_axis_deg: f64,
}

/// Ripley's K function beside that of points at random: above 0 points cluster, below they keep apart. `k_minus_csr` is K - K_csr on a sphere of `radius_m`, square metres; `d` is
/// the same over the area of the sphere, whatever its radius: so much larger is the share of all pairs that are within an angle. Null without pairs: of a single point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KReport {
    /// How pairs were counted: exact, turned (exact, too), sampled, gridded or harmonics.
    pub method: &'static str,
    /// Bins.
    pub bins: usize,
    /// The radius of the sphere that square metres are of: 1.
    pub radius_m: f64,
    /// How far any of `k_minus_csr` may be off, square metres: 0 for exact counts; null where it is not known.
    pub error_bound: Option<f64>,
    /// The upper end of each bin, degrees.
    pub theta_deg: Vec<f64>,
    /// K - K_csr there, square metres.
    pub k_minus_csr: Option<Vec<f64>>,
    /// The largest of them, whatever its sign.
    pub max_abs: Option<f64>,
    /// How far any of `d` may be off; null where it is not known.
    pub d_error_bound: Option<f64>,
    /// D = (K - K_csr) / (4 pi R2), a share.
    pub d: Option<Vec<f64>>,
    /// The largest D.
    pub d_max: Option<f64>,
    /// The smallest.
    pub d_min: Option<f64>,
    /// Pairs that lie on an edge between two bins within rounding: counted, of samples estimated; null where the method cannot tell. They count to the smaller angle.
    pub on_edges: Option<u64>,
    /// All of it, for figures.
    #[serde(skip)]
    pub curve: KCurve,
}

/// How far it is to the nearest point, from the middles of bins; of patterns those in view.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Gaps {
    /// From half of them it is at most this, degrees.
    pub median_deg: f64,
    /// From 99 % of them.
    pub of_99_percent_deg: f64,
}

/// Holes in view that are larger than what 99 % of directions have to the nearest point, and bands about the tilt axis that no point comes into.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Blind {
    /// The least radius of the holes counted, degrees.
    pub least_radius_deg: f64,
    /// How many holes there are, no middle in a larger one.
    pub holes: usize,
    /// Whether there are more than were counted.
    pub and_more: bool,
    /// The rows that they stand in about the tilt axis, by angle.
    pub rows: Vec<Row>,
    /// Bands of at least `BAND_DEG` about the tilt axis without a point.
    pub bands: Vec<Band>,
    /// Whether they hold no point at any speed of the axis: so with patterns of a sensor on it.
    pub bands_at_any_speed: bool,
}

/// What the mount makes of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeviceReport {
    /// Ranges and fields of view.
    #[serde(flatten)]
    pub view: View,
    /// The mean angle between neighbouring rays one above the other.
    pub vertical_resolution_deg: f64,
}

/// The least width of a band, degrees.
pub const BAND_DEG: f64 = 0.1;
const WIDTH: usize = 80;

impl Report {
    /// For people.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = self.table();
        for pattern in &self.patterns {
            text.push('\n');
            pattern.describe(&mut text);
        }
        text.trim_end().to_owned()
    }

    /// Side by side.
    fn table(&self) -> String {
        let names = self.patterns.iter().map(|p| p.name.chars().count());
        let long = names.clone().any(|length| length > NAME);
        let column = names.max().unwrap_or(0).clamp(8, NAME);
        let mut text = String::new();
        let _ = writeln!(
            text,
            "{:column$} {:>9} {:>6} {:>7} {:>8} {:>6} {:>7} {:>7} {:>6}",
            "", "points", "scan", "points", "", "", "", "points", "hole"
        );
        let _ = writeln!(
            text,
            "{:column$} {:>9} {:>6} {:>7} {:>8} {:>6} {:>7} {:>7} {:>6}",
            "pattern", "", "s", "a bin", "sd", "min", "max", "a deg2", "deg"
        );
        for pattern in &self.patterns {
            let s = &pattern.density.statistics;
            let scan = pattern.scan_s.map_or("-".to_owned(), |s| number(s, 6));
            if long {
                let _ = writeln!(text, "{}", pattern.name);
            }
            let name = if long { "" } else { &pattern.name };
            let _ = writeln!(
                text,
                "{name:column$} {:>9} {scan:>6} {:>7} {:>8} {:>6} {:>7} {:>7} {:>6}",
                pattern.points,
                thousandths(s.mean, 7),
                thousandths(s.sd, 8),
                s.min,
                s.max,
                number(s.mean_per_deg2, 7),
                number(pattern.worst().radius_deg, 6),
            );
        }
        text
    }
}

/// The longest name that stands beside its numbers.
const NAME: usize = 14;

impl PatternReport {
    fn describe(&self, text: &mut String) {
        let s = &self.density.statistics;
        let _ = writeln!(text, "{}", self.name);
        let mut lines = Vec::new();
        if let Some(frames) = self.frames {
            let turns = if frames == 1 { "turn" } else { "turns" };
            lines.push(format!("{frames} {turns} of the lidar"));
        }
        if self.without_direction > 0 {
            lines.push(format!(
                "{} {} in the origin left out",
                self.without_direction,
                if self.without_direction == 1 {
                    "point"
                } else {
                    "points"
                }
            ));
        }
        lines.push(self.hole.line("largest hole"));
        if let Some(hole) = &self.hole_in_view {
            lines.push(hole.line("largest hole in view"));
        }
        let gaps = &self.gaps;
        lines.push(format!(
            "a point within {} deg of half of all directions in view, within {} deg of 99 %",
            number(gaps.median_deg, 6),
            number(gaps.of_99_percent_deg, 6)
        ));
        lines.push(self.blind_line());
        lines.extend(self.band_line());
        lines.push(self.k.line());
        if let Some(device) = &self.device {
            lines.extend(device.lines());
        }
        for line in lines {
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

    /// The largest hole that counts: in view, where the view is known.
    pub(super) fn worst(&self) -> &HoleReport {
        self.hole_in_view.as_ref().unwrap_or(&self.hole)
    }

    fn blind_line(&self) -> String {
        let blind = &self.blind;
        let more = if blind.and_more { "at least " } else { "" };
        let rows = match blind.rows.len() {
            1 => "1 row".to_owned(),
            rows => format!("{rows} rows"),
        };
        let spots = if blind.holes == 1 { "spot" } else { "spots" };
        format!(
            "{more}{} blind {spots} (holes of {} deg and more), in {rows} about the tilt axis",
            blind.holes,
            number(blind.least_radius_deg, 6),
        )
    }

    fn band_line(&self) -> Option<String> {
        let bands = &self.blind.bands;
        let widest = bands
            .iter()
            .max_by(|a, b| a.width_deg().total_cmp(&b.width_deg()))?;
        let sum: f64 = bands.iter().map(Band::width_deg).sum();
        let why = if self.blind.bands_at_any_speed {
            " at any speed"
        } else {
            ""
        };
        Some(format!(
            "{} about the tilt axis, {BAND_DEG} deg and wider, {} no point{why}: {} deg together, the widest from {} to {} deg",
            match bands.len() {
                1 => "1 band".to_owned(),
                bands => format!("{bands} bands"),
            },
            if bands.len() == 1 { "holds" } else { "hold" },
            number(sum, 6),
            number(widest.from_deg, 6),
            number(widest.to_deg, 6)
        ))
    }
}

impl KReport {
    fn line(&self) -> String {
        let how = match self.d_error_bound {
            Some(0.0) => "every pair counted".to_owned(),
            Some(bound) => format!("{}, within {bound:.1e}", self.method),
            None => format!("{}, error unknown", self.method),
        };
        let (Some(d_min), Some(d_max)) = (self.d_min, self.d_max) else {
            return "no K function: a single point has no pairs".to_owned();
        };
        format!("K - K_csr from {d_min:.5} to {d_max:+.5} of the sphere's area ({how})")
    }
}

impl HoleReport {
    fn line(&self, what: &str) -> String {
        // No zero with a sign.
        let [x, y, z] = self
            .centre
            .map(|axis| if axis.abs() < 5e-4 { 0.0 } else { axis });
        format!(
            "{what}: {} deg about ({x:.3}, {y:.3}, {z:.3}), {} deg from the tilt axis",
            number(self.radius_deg, 7),
            number(self.from_axis_deg, 6)
        )
    }
}

impl DeviceReport {
    fn lines(&self) -> [String; 2] {
        let View {
            range_m: [near, far],
            forwards_deg,
            backwards_deg,
        } = self.view;
        [
            format!("the device sees from {near:.3} to {far:.3} m"),
            format!(
                "elevations {} to {} deg towards -x, {} to {} towards +x, {} deg apart on average",
                forwards_deg[0],
                forwards_deg[1],
                backwards_deg[0],
                backwards_deg[1],
                number(self.vertical_resolution_deg, 7)
            ),
        ]
    }
}

/// A bar a class, the longest as long as there is room.
fn histogram(classes: &[Class]) -> String {
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

/// A number of four digits or so, in at most so many places.
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

/// A number with three decimals, as far as there is room: means are of whole points, and half a hundredth is not to be rounded by its last bit.
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
    fn means_are_not_rounded_where_the_table_has_room() {
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
        let class = |from, bins| Class {
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
