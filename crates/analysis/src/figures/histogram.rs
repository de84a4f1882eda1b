//! Numbers of bins by their number of points, with mean and standard deviation.

use super::frame::{MARGIN, TITLE, TextAnchor, WIDTH, colour, document, heading, levels, text};
use super::{AnalyzedScan, AnalyzedScans};
use crate::draw::Scale;
use crate::draw::axis::PlotAxis;

/// Approximate number of classes.
const CLASSES: u64 = 60;
const LEFT: f64 = 56.0;
const RIGHT: f64 = WIDTH - MARGIN;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 150.0;
const ROW: f64 = 182.0;

/// Width of the classes of a scan in points per bin, so that its fullest bin is in about the
/// sixtieth class.
#[must_use]
pub fn class_width(scan: &AnalyzedScan) -> u64 {
    (fullest(scan) + 1).div_ceil(CLASSES)
}

/// Points of the fullest bin.
fn fullest(scan: &AnalyzedScan) -> u64 {
    scan.counts.by_bin().iter().copied().max().unwrap_or(0)
}

/// The figure: a plot per scan. All share the vertical scale. Each has its own horizontal scale,
/// since short and long scans have nothing in common there.
#[must_use]
pub fn histogram(scans: &AnalyzedScans) -> String {
    let classes = |scan: &AnalyzedScan| scan.counts.histogram_by(class_width(scan));
    let all = scans.scans.iter().flat_map(classes);
    let most = all.map(|class| class.bins).max().unwrap_or(1);
    let y = PlotAxis::new(Scale::Log, [1.0, most as f64].into_iter(), BOTTOM, TOP);
    let mut body = String::new();
    let mut about =
        "The number of bins in classes of points a bin, on a logarithmic scale.".to_owned();
    let mut top = TITLE;
    for (number, scan) in scans.scans.iter().enumerate() {
        let (s, width) = (scan.counts.statistics(), class_width(scan));
        about += &format!(
            " {}: classes of {width}, mean {:.3}, standard deviation {:.2}.",
            scan.name, s.mean, s.sd
        );
        // Up to the end of the fullest class.
        let end = (fullest(scan) / width + 1) * width;
        let x = PlotAxis::new(Scale::Linear, [0.0, end as f64].into_iter(), LEFT, RIGHT);
        body += &format!("<g transform=\"translate(0 {top:.0})\">\n");
        body += &plot(scan, number, width, &x, &y);
        body += "</g>\n";
        top += ROW;
    }
    document(
        "How many bins have how many points",
        &about,
        top + 8.0,
        &body,
    )
}

fn plot(scan: &AnalyzedScan, number: usize, width: u64, x: &PlotAxis, y: &PlotAxis) -> String {
    let s = scan.counts.statistics();
    let more = format!(
        "mean {:.3} (line), sd {:.2} (dashed), {} to {} points a bin, classes of {width}",
        s.mean, s.sd, s.min, s.max
    );
    let mut svg = heading(&scan.name, &more, 14.0);
    svg += &grid(x, y);
    let mut bars = String::new();
    for class in scan
        .counts
        .histogram_by(width)
        .iter()
        .filter(|class| class.bins > 0)
    {
        let ends = (x.place(class.from as f64), x.place(class.to as f64 + 1.0));
        if let ((Some(left), Some(right)), Some(top)) = (ends, y.place(class.bins as f64)) {
            let right = right.min(RIGHT);
            bars += &format!("M{left:.1} {BOTTOM}V{top:.1}H{right:.1}V{BOTTOM}z");
        }
    }
    svg += &format!(
        "<path class=\"{} tv-fill\" d=\"{bars}\"/>\n",
        colour(number)
    );
    let lines = [
        (s.mean, "tv-mean"),
        (s.mean - s.sd, "tv-sd"),
        (s.mean + s.sd, "tv-sd"),
    ];
    for (value, class) in lines.into_iter().filter(|(value, _)| *value >= 0.0) {
        if let Some(x) = x.place(value).filter(|x| *x <= RIGHT) {
            svg += &format!("<path class=\"{class}\" d=\"M{x:.1} {TOP}V{BOTTOM}\"/>\n");
        }
    }
    svg
}

fn grid(x: &PlotAxis, y: &PlotAxis) -> String {
    let mut svg = String::new();
    for tick in x.ticks() {
        svg += &format!(
            "<path class=\"tv-grid\" d=\"M{:.1} {TOP}V{BOTTOM}\"/>\n",
            tick.at
        );
        svg += &text(
            tick.at,
            BOTTOM + 14.0,
            TextAnchor::Middle,
            "tv-soft tv-small",
            &tick.label,
        );
    }
    svg += &levels(y, LEFT, RIGHT);
    svg += &format!(
        "<rect class=\"tv-frame\" x=\"{LEFT}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"/>\n",
        RIGHT - LEFT,
        BOTTOM - TOP
    );
    svg += &text(
        RIGHT - 6.0,
        TOP + 14.0,
        TextAnchor::End,
        "tv-soft tv-small",
        "points a bin across, bins up",
    );
    svg
}
