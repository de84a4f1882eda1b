//! What is doubtful about a cloud whose angles were found all the same, and what it lacks.

use scanner::{Alignment, ScanConfig};

/// Above this a point 10 m away may be off by more than 17 mm.
const DOUBTFUL_DEG: f64 = 0.1;
/// A sweep that ends farther than this from where it was to end was cut short.
const SHORT_DEG: f64 = 0.1;

/// What is doubtful about the angles: polls too slow or too few, sweeps that are not as planned.
pub(super) fn doubts(alignment: &Alignment) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Some(bound) = alignment
        .angle_bound_deg()
        .filter(|bound| *bound > DOUBTFUL_DEG)
    {
        doubts.push(format!(
            "the drive's answers were slow or missing: angles may be off by {bound:.2} deg in places, {:.0} mm at 10 m",
            bound.to_radians() * 10e3
        ));
    }
    if alignment.implausible > 0 {
        doubts.push(format!(
            "{} shaft positions were far beside their neighbours and were left out: the drive's link corrupts data",
            alignment.implausible
        ));
    }
    for (number, fit) in alignment.trajectory.fits().iter().enumerate() {
        let remarks = fit.remarks.iter();
        doubts.extend(remarks.map(|remark| format!("sweep {}: {remark}", number + 1)));
    }
    doubts
}

/// What is missing of the sweeps that the log was to have. A log that says nothing of a plan lacks nothing, nor one without any sweep, of
/// which there is no cloud.
pub(super) fn short(config: &ScanConfig, alignment: &Alignment) -> Vec<String> {
    let Some(plan) = config.sweep.filter(|_| !alignment.sweeps.is_empty()) else {
        return Vec::new();
    };
    let mut short = Vec::new();
    for (number, sweep) in alignment.sweeps.iter().enumerate() {
        let back = plan.both_ways && number % 2 == 1;
        let end = if back { plan.from_deg } else { plan.to_deg };
        if (sweep.to.0 - end).abs() > SHORT_DEG {
            short.push(format!(
                "sweep {} was cut short at {:.3} deg of {end} deg",
                number + 1,
                sweep.to.0
            ));
        }
    }
    let made = alignment.sweeps.len();
    if (made as u64) < u64::from(plan.sweeps) {
        short.push(format!("{made} of {} sweeps were made", plan.sweeps));
    }
    short
}
