//! The curves as CSV (RFC 4180): one line per value, with the scan in the first column and numbers
//! in full precision.

use std::f64::consts::PI;
use std::fmt::Write;

use super::curves::{csr_slopes, middles_deg};
use super::histogram::class_width;
use super::{AnalyzedScans, SPHERE_M};

/// K on a sphere of 10 m at the upper edges of bins, its difference from randomness, that
/// difference divided by the area of the sphere, the derivative at the centres of the bins, and
/// that of randomness, which added to it is that of K.
#[must_use]
pub fn k(scans: &AnalyzedScans) -> String {
    let mut csv =
        "pattern,theta_deg,k_m2,k_minus_csr_m2,d,theta_middle_deg,derivative_m2_rad,csr_derivative_m2_rad\n".to_owned();
    for scan in &scans.scans {
        let (name, k) = (field(&scan.name), &scan.k);
        let sums = k
            .theta_rad
            .iter()
            .zip(&k.k_m2)
            .zip(&k.k_minus_csr_m2)
            .zip(&k.d);
        let slopes = middles_deg(&k.theta_rad).zip(&k.derivative_m2_rad);
        let area = 4.0 * PI * SPHERE_M * SPHERE_M;
        let slopes = slopes.zip(csr_slopes(&k.theta_rad).map(|slope| area * slope));
        for ((((theta, k), difference), d), ((middle, slope), csr)) in sums.zip(slopes) {
            let theta = theta.to_degrees();
            let _ = writeln!(
                csv,
                "{name},{theta},{k},{difference},{d},{middle},{slope},{csr}"
            );
        }
    }
    csv
}

/// Points per bin, and the centre of the bin.
#[must_use]
pub fn density(scans: &AnalyzedScans) -> String {
    let mut csv = "pattern,bin,x,y,z,count\n".to_owned();
    for scan in &scans.scans {
        let name = field(&scan.name);
        for (bin, (face, count)) in scans
            .bins
            .bins()
            .iter()
            .zip(scan.counts.by_bin())
            .enumerate()
        {
            let [x, y, z] = face.centre.to_array();
            let _ = writeln!(csv, "{name},{bin},{x},{y},{z},{count}");
        }
    }
    csv
}

/// Bins by their number of points, in the classes of the figure.
#[must_use]
pub fn histogram(scans: &AnalyzedScans) -> String {
    let mut csv = "pattern,from,to,bins\n".to_owned();
    for scan in &scans.scans {
        let name = field(&scan.name);
        for class in scan.counts.histogram_by(class_width(scan)) {
            let _ = writeln!(csv, "{name},{},{},{}", class.from, class.to, class.bins);
        }
    }
    csv
}

/// A CSV field, quoted if necessary.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
