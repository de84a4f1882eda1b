//! A summary of the comparison in a few sentences. Which scan is best depends on its purpose, and
//! is left to the reader.

use super::{AnalyzedScan, AnalyzedScans};
use crate::draw::escaped;
use crate::draw::number::short;

/// The largest deviation of K from randomness, as a share of the sphere; `None` without pairs.
pub(super) fn farthest(scan: &AnalyzedScan) -> Option<f64> {
    let k = &scan.k;
    k.has_pairs().then(|| k.d_max.max(-k.d_min))
}

/// A sentence per scan, and one on the most even scan; empty without scans.
pub(super) fn conclusions(scans: &AnalyzedScans) -> String {
    let mut items = String::new();
    for scan in &scans.scans {
        items += &format!(
            "<li><b>{}</b> {}</li>\n",
            escaped(&scan.name),
            escaped(&of_one(scan))
        );
    }
    let mut html = match items.is_empty() {
        true => String::new(),
        false => format!("<ul class=\"conclusion\">\n{items}</ul>\n"),
    };
    if let Some(sentence) = of_all(&scans.scans) {
        html += &format!("<p>{}</p>\n", escaped(&sentence));
    }
    html
}

fn of_one(scan: &AnalyzedScan) -> String {
    let percent = |share: Option<f64>| format!("{:.1} %", 100.0 * share.unwrap_or(0.0));
    let sphere = percent(scan.counts.statistics().coverage);
    let hole = format!("{:.2}\u{b0}", scan.hole_deg);
    match &scan.in_view {
        Some(seen) => {
            let within = match seen.hole_deg {
                Some(deg) => format!("{deg:.2}\u{b0}"),
                None => "none".to_owned(),
            };
            format!(
                "covers {sphere} of the sphere and {} of what it could see; its largest hole in view has a radius of {within}, anywhere {hole}.",
                percent(seen.statistics.coverage)
            )
        }
        None => format!(
            "covers {sphere} of the sphere; its largest hole anywhere has a radius of {hole}. What it could see is not known, so neither is how much of that it misses."
        ),
    }
}

/// Sentence that names the best of several scans in each measure.
fn of_all(scans: &[AnalyzedScan]) -> Option<String> {
    if scans.len() < 2 {
        return None;
    }
    let even = least(scans, farthest)?;
    let mut sentence = format!(
        "Nearest to points at random over the whole sphere (largest |K - K_csr|): {} ({:.5})",
        even.name,
        farthest(even)?
    );
    let uneven = |scan: &AnalyzedScan| scan.in_view.as_ref()?.statistics.sd_over_mean;
    if let Some(best) = least(scans, uneven) {
        let value = short(uneven(best).unwrap_or(0.0));
        sentence += &format!(
            "; most even within its view (sd / mean): {} ({value})",
            best.name
        );
    }
    let hole = |scan: &AnalyzedScan| scan.in_view.as_ref()?.hole_deg;
    if let Some(best) = least(scans, hole) {
        let value = hole(best).unwrap_or(0.0);
        sentence += &format!(
            "; smallest largest hole in view: {} ({value:.2}\u{b0})",
            best.name
        );
    }
    Some(sentence + ".")
}

/// The scan with the smallest known value of a measure.
fn least(
    scans: &[AnalyzedScan],
    of: impl Fn(&AnalyzedScan) -> Option<f64>,
) -> Option<&AnalyzedScan> {
    let known = scans.iter().filter_map(|scan| Some((scan, of(scan)?)));
    let least = known.min_by(|a, b| a.1.total_cmp(&b.1));
    least.map(|(scan, _)| scan)
}
