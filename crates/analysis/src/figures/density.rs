//! Points per bin on the sphere, seen from three sides in orthographic projection.

use glam::DVec3;

use super::colour::Shades;
use super::frame::{MARGIN, TITLE, document, heading, scale_name};
use super::sides::{RADIUS, ROW, SIDES, Side, captions, centre};
use super::{AnalyzedScan, AnalyzedScans};
use crate::density::IcosahedronFace;
use crate::draw::plot::{TextAnchor, small};

/// The finest level of bins that is drawn; finer bins are merged, since there are more of them than
/// pixels.
const FINEST: usize = 5;
/// Path units per pixel.
const FINE: f64 = 10.0;

/// The figure: a row per scan, a column per side.
#[must_use]
pub fn density(scans: &AnalyzedScans) -> String {
    let levels = scans.bins.levels();
    let drawn = levels.len().saturating_sub(1).min(FINEST);
    let faces = levels.get(drawn).map_or(&[][..], Vec::as_slice);
    let within = 1_usize << (2 * (levels.len().saturating_sub(1) - drawn));
    let together = |scan: &AnalyzedScan| -> Vec<u64> {
        let parts = scan.counts.by_bin().chunks(within);
        parts.map(|part| part.iter().sum()).collect()
    };
    let all: Vec<Vec<u64>> = scans.scans.iter().map(together).collect();
    let shades = Shades::new(all.iter().flatten().copied());
    let mut body = String::new();
    let mut top = TITLE;
    for (scan, counts) in scans.scans.iter().zip(&all) {
        body += &row(scan, faces, counts, &shades, top);
        top += ROW;
    }
    body += &scale(&shades, top);
    let bins = faces.len();
    let title = format!("Points per bin on the sphere ({bins} bins)");
    let about = about(scans, &shades);
    document(&title, &about, top + 58.0, &body)
}

fn about(scans: &AnalyzedScans, shades: &Shades) -> String {
    let mut about = format!(
        "Hemispheres seen from +x, from -y and from +z, one row per scan; bins from {} to {} points, darker is more.",
        shades.low, shades.high
    );
    for scan in &scans.scans {
        let s = scan.counts.statistics();
        about += &format!(
            " {}: mean {:.3}, standard deviation {:.2}, {} to {} points per bin, {} bins empty.",
            scan.name, s.mean, s.sd, s.min, s.max, s.empty
        );
    }
    about
}

fn row(
    scan: &AnalyzedScan,
    faces: &[IcosahedronFace],
    counts: &[u64],
    shades: &Shades,
    top: f64,
) -> String {
    let s = scan.counts.statistics();
    let more = format!(
        "{} points; {:.3} per bin on average, sd {:.2}, from {} to {}; {} empty",
        scan.points, s.mean, s.sd, s.min, s.max, s.empty
    );
    let mut svg = heading(&scan.name, &more, top + 14.0);
    for (number, side) in SIDES.iter().enumerate() {
        let at = centre(number, top);
        svg += &sphere(side, faces, counts, shades, at);
        svg += &captions(side, at);
    }
    svg
}

/// A hemisphere with one path per colour. Triangles have an outline of their own colour, which
/// hides the gaps between them.
fn sphere(
    side: &Side,
    faces: &[IcosahedronFace],
    counts: &[u64],
    shades: &Shades,
    (x, y): (f64, f64),
) -> String {
    let mut paths = vec![String::new(); Shades::STEPS];
    let mut empty = String::new();
    for (face, &count) in faces.iter().zip(counts) {
        if face.centre.dot(side.to) <= 0.0 {
            continue;
        }
        let path = match count {
            0 => Some(&mut empty),
            _ => paths.get_mut(shades.step(count)),
        };
        if let Some(path) = path {
            triangle(path, side, face);
        }
    }
    let mut svg = format!(
        "<g transform=\"translate({x:.1} {y:.1}) scale({})\">\n<circle class=\"tv-paper\" r=\"{:.0}\" stroke-width=\"{FINE}\"/>\n",
        1.0 / FINE,
        RADIUS * FINE
    );
    if !empty.is_empty() {
        svg += &format!("<path class=\"tv-empty\" d=\"{empty}\"/>\n");
    }
    for (step, path) in paths
        .iter()
        .enumerate()
        .filter(|(_, path)| !path.is_empty())
    {
        let colour = Shades::of_step(step);
        svg += &format!(
            "<path fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"4\" stroke-linejoin=\"round\" d=\"{path}\"/>\n"
        );
    }
    svg + "</g>\n"
}

fn triangle(path: &mut String, side: &Side, face: &IcosahedronFace) {
    let place = |corner: DVec3| {
        let size = RADIUS * FINE;
        let (right, up) = (corner.dot(side.right.0), corner.dot(side.up.0));
        ((size * right).round() as i32, (-size * up).round() as i32)
    };
    let [(ax, ay), (bx, by), (cx, cy)] = face.corners.map(place);
    // A minus sign separates numbers as a space does.
    *path += &format!(
        "M{ax} {ay}l{} {} {} {}z",
        bx - ax,
        by - ay,
        cx - bx,
        cy - by
    );
}

/// The scale of colours.
fn scale(shades: &Shades, top: f64) -> String {
    let (left, wide, high) = (MARGIN + 90.0, 430.0, 12.0);
    let y = top + 12.0;
    let mut svg = scale_name(y, "points per bin");
    if shades.high == shades.low {
        let colour = Shades::of_step(shades.step(shades.low));
        svg += &format!(
            "<rect fill=\"{colour}\" x=\"{left}\" y=\"{y}\" width=\"{wide}\" height=\"{high}\"/>\n"
        );
    } else {
        let each = wide / Shades::STEPS as f64;
        for step in 0..Shades::STEPS {
            svg += &format!(
                "<rect fill=\"{}\" x=\"{:.2}\" y=\"{y}\" width=\"{:.2}\" height=\"{high}\"/>\n",
                Shades::of_step(step),
                left + each * step as f64,
                each + 0.3
            );
        }
    }
    for tick in shades.ticks() {
        let x = left + wide * shades.share(tick as f64);
        svg += &format!(
            "<path class=\"tv-frame\" d=\"M{x:.1} {:.1}v4\"/>\n",
            y + high
        );
        svg += &small(x, y + high + 16.0, TextAnchor::Middle, &tick.to_string());
    }
    let (x, bottom) = (left + wide + 34.0, y + high);
    svg += &format!(
        "<g transform=\"translate({x:.1} {bottom:.1}) scale(0.1)\"><path class=\"tv-empty\" d=\"M0 0h160l-80 -120zM160 0l80 -120h-160z\"/></g>\n"
    );
    svg + &small(x + 30.0, bottom - 2.0, TextAnchor::Start, "without a point")
}
