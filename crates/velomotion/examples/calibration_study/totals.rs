//! Errors of calibrations over seeds.

use engine::calibrate::CalibrateReport;

/// Kinds of parameters in the table: their ends of names and the factor of the column's unit.
const KINDS: [(&str, f64); 8] = [
    ("rotation_x_deg", 1.0),
    ("rotation_z_deg", 1.0),
    ("position_x_m", 1e3),
    ("position_z_m", 1e3),
    ("delay_us", 1.0),
    ("range_m", 1e3),
    ("elevation_deg", 1e3),
    ("azimuth_deg", 1e3),
];
/// Index of the ranges, whose common part has a column of its own.
const RANGES: usize = 5;

/// Sums over the seeds of a scene.
#[derive(Default)]
pub struct Totals {
    /// Squared errors, squared stated deviations and number of each kind.
    kinds: [[f64; 3]; KINDS.len()],
    common_range_m2: f64,
    /// Squares of errors over stated deviations, and their number.
    stated: [f64; 2],
    worst_sd: f64,
    runs: f64,
    pub shots: usize,
    pub seconds: f64,
    pub refused: usize,
}

impl Totals {
    /// Adds a calibration. Returns its pooled and worst error in standard deviations.
    pub fn add(&mut self, truth: &[(String, f64)], report: &CalibrateReport) -> (f64, f64, String) {
        let mut ranges = Vec::new();
        let (mut squares, mut count, mut worst) = (0.0, 0.0, (0.0, String::new()));
        for (name, value) in truth {
            let Some(estimate) = report
                .parameters
                .iter()
                .find(|p| p.name == *name && p.sd > 0.0)
            else {
                continue;
            };
            let error = estimate.value - value;
            let off = (error / estimate.sd).abs();
            if off > worst.0 {
                worst = (off, name.clone());
            }
            squares += off * off;
            count += 1.0;
            if name.ends_with("range_m") {
                ranges.push(error);
            }
            let kind = KINDS.iter().position(|(end, _)| name.ends_with(end));
            if let Some(kind) = kind.filter(|kind| *kind != RANGES) {
                add(&mut self.kinds[kind], error, estimate.sd);
            }
        }
        let mean = ranges.iter().sum::<f64>() / ranges.len().max(1) as f64;
        self.common_range_m2 += mean * mean;
        for range in ranges {
            add(&mut self.kinds[RANGES], range - mean, 0.0);
        }
        self.runs += 1.0;
        self.stated[0] += squares;
        self.stated[1] += count;
        self.worst_sd = self.worst_sd.max(worst.0);
        ((squares / f64::max(count, 1.0)).sqrt(), worst.0, worst.1)
    }

    /// The head of the table.
    pub const HEAD: &str = "| RMS (stated) | rx, deg | rz, deg | x, mm | z, mm | delay, us | ranges, mm | common range, mm \
        | elevations, mdeg | azimuths, mdeg | error / sd | worst | refused | s for 460,000 points |\n\
        |---|---|---|---|---|---|---|---|---|---|---|---|---|---|";

    /// The row of a scene.
    pub fn row(&self, name: &str) -> String {
        let rms = |kind: usize, digits: usize| {
            let [errors, stated, count] = self.kinds[kind];
            let of = |sum: f64| KINDS[kind].1 * (sum / f64::max(count, 1.0)).sqrt();
            let (error, stated) = (of(errors), of(stated));
            if stated > 0.0 {
                format!("{error:.digits$} ({stated:.digits$})")
            } else {
                format!("{error:.digits$}")
            }
        };
        format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {:.2} | {} | {} | {:.2} | {:.1} | {} | {:.1} |",
            rms(0, 4),
            rms(1, 4),
            rms(2, 2),
            rms(3, 2),
            rms(4, 1),
            rms(RANGES, 2),
            1e3 * (self.common_range_m2 / f64::max(self.runs, 1.0)).sqrt(),
            rms(6, 2),
            rms(7, 2),
            (self.stated[0] / f64::max(self.stated[1], 1.0)).sqrt(),
            self.worst_sd,
            self.refused,
            460e3 * self.seconds / f64::max(self.shots as f64, 1.0)
        )
    }
}

fn add(sums: &mut [f64; 3], error: f64, sd: f64) {
    sums[0] += error * error;
    sums[1] += sd * sd;
    sums[2] += 1.0;
}
