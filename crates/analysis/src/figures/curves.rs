//! The K function relative to randomness, and its first derivative: one curve per scan.

use std::f64::consts::PI;

use super::frame::{MARGIN, TITLE, WIDTH, document, legend, stroke};
use super::{AnalyzedScans, SPHERE_M};
use crate::draw::Scale;
use crate::draw::axis::{AxisTick, PlotAxis};
use crate::draw::plot::{PlotArea, TextAnchor, line, small, text};

const AREA: PlotArea = PlotArea {
    left: 62.0,
    right: WIDTH - MARGIN - 6.0,
    top: 24.0,
    bottom: 276.0,
};
const PLOT: f64 = 330.0;

/// A curve: angles in degrees and values.
type Curve = Vec<(f64, f64)>;

/// The figure: three plots over the angle, one below the other.
#[must_use]
pub fn curves(scans: &AnalyzedScans) -> String {
    let area = 4.0 * PI * SPHERE_M * SPHERE_M;
    let mut about = "K - K_csr over the area of the sphere, its first derivative, and that of K beside that of K_csr, over the angle from 0 to 180 degrees. Above 0 points cluster, below they keep apart.".to_owned();
    let (mut differences, mut slopes, mut all_slopes) = (Vec::new(), Vec::new(), Vec::new());
    let mut csr: Curve = Vec::new();
    for scan in &scans.scans {
        let theta = scan.k.theta_rad.iter().map(|theta| theta.to_degrees());
        let points = theta.zip(scan.k.d.iter().copied());
        let start = scan.k.has_pairs().then_some((0.0, 0.0));
        differences.push(start.into_iter().chain(points).collect());
        let slope = scan.k.derivative_m2_rad.iter().map(|slope| slope / area);
        let slope: Curve = middles_deg(&scan.k.theta_rad).zip(slope).collect();
        let of_csr = middles_deg(&scan.k.theta_rad).zip(csr_slopes(&scan.k.theta_rad));
        csr = of_csr.collect();
        let whole = slope.iter().zip(&csr).map(|((at, a), (_, b))| (*at, a + b));
        all_slopes.push(whole.collect());
        slopes.push(slope);
        about += &match scan.k.has_pairs() {
            true => format!(
                " {}: from {:.5} to {:.5}.",
                scan.name, scan.k.d_min, scan.k.d_max
            ),
            false => format!(" {}: no pairs.", scan.name),
        };
    }
    let mut body = plot(
        "K - K_csr, share of the sphere's area",
        &differences,
        &[],
        TITLE,
    );
    body += &plot(
        "first derivative of it, a radian",
        &slopes,
        &[],
        TITLE + PLOT,
    );
    let title = "first derivative of K, and of K_csr (grey)";
    body += &plot(title, &all_slopes, &csr, TITLE + 2.0 * PLOT);
    let names: Vec<&str> = scans.scans.iter().map(|scan| scan.name.as_str()).collect();
    let (names, end) = legend(&names, TITLE + 3.0 * PLOT + 4.0);
    document(
        "Ripley's K function against complete spatial randomness",
        &about,
        end + 4.0,
        &(body + &names),
    )
}

/// Centres of bins in degrees from their upper edges.
pub(super) fn middles_deg(upper_rad: &[f64]) -> impl Iterator<Item = f64> {
    let before = std::iter::once(&0.0).chain(upper_rad);
    let both = upper_rad.iter().zip(before);
    both.map(|(to, from)| f64::midpoint(*to, *from).to_degrees())
}

/// The derivative of K_csr over the area of the sphere in each bin, from their upper edges: the
/// difference of its ends divided by its width, as [`crate::k::KCurve`] has that of K - K_csr.
pub(super) fn csr_slopes(upper_rad: &[f64]) -> impl Iterator<Item = f64> {
    let before = std::iter::once(&0.0).chain(upper_rad);
    let csr = |theta: f64| (theta / 2.0).sin().powi(2);
    let ends = upper_rad.iter().zip(before);
    ends.map(move |(to, from)| (csr(*to) - csr(*from)) / (to - from))
}

fn plot(title: &str, curves: &[Curve], reference: &[(f64, f64)], top: f64) -> String {
    let PlotArea { left, right, .. } = AREA;
    let values = curves
        .iter()
        .flatten()
        .chain(reference)
        .map(|(_, value)| *value);
    let y = PlotAxis::new(Scale::Linear, values.chain([0.0]), AREA.bottom, AREA.top);
    let x = |degrees: f64| left + (right - left) * degrees / 180.0;
    let ticks = [0, 30, 60, 90, 120, 150, 180].map(|degrees| AxisTick {
        at: x(f64::from(degrees)),
        label: format!("{degrees}\u{b0}"),
    });
    let mut svg = format!("<g transform=\"translate(0 {top})\">\n");
    svg += &text(MARGIN, 14.0, TextAnchor::Start, "tv-ink", title);
    svg += &AREA.verticals(&ticks, 15.0);
    let name = "angle between two points, degrees";
    let middle = f64::midpoint(left, right);
    svg += &small(middle, AREA.bottom + 30.0, TextAnchor::Middle, name);
    svg += &AREA.horizontals(&y);
    if let Some(zero) = y.position(0.0) {
        svg += &AREA.horizontal("tv-zero", zero);
    }
    svg += &AREA.frame();
    let places = |curve: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let places = curve.iter();
        let places = places.filter_map(|(degrees, value)| Some((x(*degrees), y.position(*value)?)));
        places.collect()
    };
    if !reference.is_empty() {
        svg += &line("class=\"tv-zero tv-csr\"", places(reference));
    }
    for (number, curve) in curves.iter().enumerate() {
        svg += &line(&stroke(number), places(curve));
    }
    svg + "</g>\n"
}
