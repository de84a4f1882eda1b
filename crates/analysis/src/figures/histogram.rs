//! Numbers of bins by their number of points, with mean and standard deviation.

use super::frame::{MARGIN, TITLE, WIDTH, colour, document, heading};
use super::{AnalyzedScan, AnalyzedScans};
use crate::draw::Scale;
use crate::draw::axis::PlotAxis;
use crate::draw::plot::{PlotArea, TextAnchor, small};

/// Approximate number of classes.
const CLASSES: u64 = 60;
const AREA: PlotArea = PlotArea {
    left: 56.0,
    right: WIDTH - MARGIN,
    top: 24.0,
    bottom: 150.0,
};
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
    let y = PlotAxis::new(
        Scale::Log,
        [1.0, most as f64].into_iter(),
        AREA.bottom,
        AREA.top,
    );
    let mut body = String::new();
    let mut about =
        "The number of bins in classes of points per bin, on a logarithmic scale.".to_owned();
    let mut top = TITLE;
    for (number, scan) in scans.scans.iter().enumerate() {
        let (s, width) = (scan.counts.statistics(), class_width(scan));
        about += &format!(
            " {}: classes of {width}, mean {:.3}, standard deviation {:.2}.",
            scan.name, s.mean, s.sd
        );
        // Up to the end of the fullest class.
        let end = (fullest(scan) / width + 1) * width;
        let x = PlotAxis::new(
            Scale::Linear,
            [0.0, end as f64].into_iter(),
            AREA.left,
            AREA.right,
        );
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
        "mean {:.3} (line), sd {:.2} (dashed), {} to {} points per bin, classes of {width}",
        s.mean, s.sd, s.min, s.max
    );
    let mut svg = heading(&scan.name, &more, 14.0);
    svg += &AREA.verticals(&x.ticks(), 14.0);
    svg += &AREA.horizontals(y);
    svg += &AREA.frame();
    let (across, up) = (AREA.right - 6.0, AREA.top + 14.0);
    svg += &small(
        across,
        up,
        TextAnchor::End,
        "points per bin across, bins up",
    );
    let (mut bars, bottom) = (String::new(), AREA.bottom);
    for class in scan
        .counts
        .histogram_by(width)
        .iter()
        .filter(|class| class.bins > 0)
    {
        let ends = (
            x.position(class.from as f64),
            x.position(class.to as f64 + 1.0),
        );
        if let ((Some(left), Some(right)), Some(top)) = (ends, y.position(class.bins as f64)) {
            let right = right.min(AREA.right);
            bars += &format!("M{left:.1} {bottom}V{top:.1}H{right:.1}V{bottom}z");
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
        if let Some(x) = x.position(value).filter(|x| *x <= AREA.right) {
            svg += &AREA.vertical(class, x);
        }
    }
    svg
}
