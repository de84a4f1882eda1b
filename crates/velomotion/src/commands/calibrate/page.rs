//! The page of `--report`: residuals before and after, by laser and by surface element.

use std::fmt::Write;

use calibration::CalibrationEvidence;
use engine::calibrate::CalibrateReport;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:56rem;margin:0 auto;padding:1rem}\
table{border-collapse:collapse;font-size:.85rem}td,th{padding:.2rem .6rem;border-bottom:1px solid #ccc;text-align:right}\
td:first-child,th:first-child,td:last-child{text-align:left}svg{width:100%;height:auto}\
.before{fill:#c2410c}.after{fill:#0b62b8}text{font:11px system-ui,sans-serif;fill:currentColor}.axis{stroke:currentColor}";

/// Size of a figure.
const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 240.0;
/// Room for labels.
const MARGIN: f64 = 40.0;
/// Bins of the elements' residuals.
const BINS: usize = 36;

/// The page.
pub fn html(report: &CalibrateReport, evidence: &CalibrationEvidence) -> String {
    let simulated = match report.simulated {
        true => "<p><strong>SIMULATED</strong>: calibrated by logs of simulated devices.</p>",
        false => "",
    };
    let lasers: Vec<[f64; 2]> = report
        .lasers
        .iter()
        .map(|laser| [laser.mean_mm.before, laser.mean_mm.after])
        .collect();
    let by_laser = bars(&lasers, &|index| index.to_string());
    let elements = histogram(&evidence.patches_m);
    let most = elements.1;
    let by_element = bars(&elements.0, &|bin| {
        if bin % 6 == 0 {
            format!("{:.0} mm", most * bin as f64 / BINS as f64)
        } else {
            String::new()
        }
    });
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Calibration</title>\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><style>{STYLE}</style></head><body>\n\
         <h1>Calibration</h1>\n{simulated}<p>{}: {} shots on {} surface elements, chi2 {:.3}, {} loops. \
         Residuals of ranges: {:.2} mm before, {:.2} mm after.</p>\n\
         <h2>Mean residual of each laser, mm</h2>\n{by_laser}\n\
         <h2>Surface elements by their residual</h2>\n{by_element}\n\
         <p>Orange: before. Blue: after.</p>\n<h2>Parameters</h2>\n{}</body></html>\n",
        report.model,
        report.shots,
        report.patches,
        report.chi2,
        report.loops,
        report.residual_mm.before,
        report.residual_mm.after,
        parameters(report)
    )
}

/// Elements by their root mean square residual, before and after, and the end of the last bin in
/// millimetres.
fn histogram(residuals_m: &[Vec<f64>; 2]) -> (Vec<[f64; 2]>, f64) {
    let most_m = residuals_m.iter().flatten().copied().fold(1e-6, f64::max);
    let mut bins = vec![[0.0; 2]; BINS];
    for (side, residuals) in residuals_m.iter().enumerate() {
        for residual in residuals {
            let bin = (residual / most_m * BINS as f64) as usize;
            if let Some(bin) = bins.get_mut(bin.min(BINS - 1)) {
                bin[side] += 1.0;
            }
        }
    }
    (bins, 1e3 * most_m)
}

/// Pairs of bars with a label below each.
fn bars(pairs: &[[f64; 2]], label: &dyn Fn(usize) -> String) -> String {
    let largest = pairs
        .iter()
        .flatten()
        .map(|value| value.abs())
        .fold(1e-9, f64::max);
    let has_negative = pairs.iter().flatten().any(|value| *value < 0.0);
    let zero = if has_negative {
        HEIGHT / 2.0
    } else {
        HEIGHT - MARGIN / 2.0
    };
    let scale = (zero - MARGIN / 2.0) / largest;
    let step = (WIDTH - MARGIN) / pairs.len().max(1) as f64;
    let mut svg = format!("<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\">");
    for (index, pair) in pairs.iter().enumerate() {
        let left = MARGIN + step * index as f64;
        for (side, (value, class)) in pair.iter().zip(["before", "after"]).enumerate() {
            let (x, height) = (left + 0.4 * step * side as f64, value.abs() * scale);
            let y = if *value < 0.0 { zero } else { zero - height };
            let _ = write!(
                svg,
                "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{height:.1}\"/>",
                0.4 * step
            );
        }
        let _ = write!(
            svg,
            "<text x=\"{left:.1}\" y=\"{:.1}\">{}</text>",
            HEIGHT - 4.0,
            label(index)
        );
    }
    let _ = write!(
        svg,
        "<line class=\"axis\" x1=\"{MARGIN}\" y1=\"{zero}\" x2=\"{WIDTH}\" y2=\"{zero}\"/>\
         <text x=\"0\" y=\"{:.1}\">{largest:.1}</text></svg>",
        MARGIN / 2.0
    );
    svg
}

fn parameters(report: &CalibrateReport) -> String {
    let mut html = "<table><tr><th>parameter</th><th>value</th><th>sd</th><th>of prior</th>\
                    <th>moves at 20 m, mm</th><th>sd at 20 m, mm</th><th></th></tr>\n"
        .to_owned();
    for parameter in &report.parameters {
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td>{:.5}</td><td>{:.5}</td><td>{:.3}</td><td>{:.2}</td><td>{:.2}</td><td>{}</td></tr>",
            parameter.name,
            parameter.value,
            parameter.sd,
            parameter.posterior_over_prior,
            parameter.moves_mm,
            parameter.sd_mm,
            parameter.help.as_deref().unwrap_or_default()
        );
    }
    html + "</table>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_is_in_a_bin_and_every_pair_has_bars() {
        let (bins, most_mm) = histogram(&[vec![0.001, 0.02, 0.04], vec![0.01]]);
        let count = |side: usize| bins.iter().map(|bin| bin[side]).sum::<f64>();
        assert_eq!((count(0), count(1), most_mm), (3.0, 1.0, 40.0));
        let svg = bars(&[[1.0, -0.5], [0.0, 0.2]], &|index| format!("L{index}"));
        assert_eq!(svg.matches("<rect").count(), 4);
        assert!(svg.contains(">L1</text>"));
    }
}
