//! Warnings about a reconstructed scan: uncertain times and angles, and incomplete sweeps.

use scanner::sweeps::Sweep;
use scanner::trajectory::Method;
use scanner::{Alignment, ScanConfig, SweepPlan, TiltSource};
use units::Span;

/// Angle bound above which a warning is due: 17 mm at 10 m.
const WARNING_BOUND_DEG: f64 = 0.1;
/// Greatest age of a position: one control cycle of an EPOS2.
const MAX_AGE_S: f64 = 1e-3;
/// Clock bound above which a warning is due: the networks of the trials stay below half of it.
const WARNING_CLOCK_BOUND: Span = Span::from_micros(500);
/// Drift above which a warning is due: crystals stay within 100 ppm each.
const WARNING_DRIFT_PPM: f64 = 200.0;
/// Distance from the planned end above which a sweep counts as cut short.
const CUT_SHORT_DEG: f64 = 0.1;

/// Warnings about times and angles: packets that all came late, slow or missing polls, sweeps that
/// deviate from the plan.
pub(super) fn alignment_warnings(
    config: &ScanConfig,
    alignment: &Alignment,
    tilt: &TiltSource,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let clock_bound = alignment.clock.bound();
    if let Some(change) = delay_change_warning(alignment) {
        warnings.push(change);
    } else if clock_bound > WARNING_CLOCK_BOUND {
        warnings.push(format!(
            "for a while all packets of the lidar came late, or the host's clock was slewed or set by a little: times may be wrong by {:.1} ms",
            clock_bound.as_secs_f64() * 1e3
        ));
    }
    let drift_ppm = alignment.clock.drift_ppm();
    if drift_ppm.abs() > WARNING_DRIFT_PPM + alignment.clock.drift_bound_ppm() {
        warnings.push(format!(
            "the clocks of host and lidar drift by {drift_ppm:.0} ppm, more than two crystals do: the host's clock was slewed, or one is faulty; times are those of the host's clock"
        ));
    }
    // The accuracy of a table is not known.
    if !matches!(tilt, TiltSource::Table(_)) {
        warnings.extend(angle_warning(alignment));
    }
    if alignment.implausible > 0 {
        warnings.push(format!(
            "{} shaft positions contradict their neighbours and were omitted: the drive's link corrupts data",
            alignment.implausible
        ));
    }
    warnings.extend(alignment.inferred_sweeps.iter().map(|index| {
        format!(
            "the log lacks a command of sweep {}: it was found by the positions",
            index + 1
        )
    }));
    for (number, fit) in alignment.trajectory.fits().iter().enumerate() {
        let remarks = fit.remarks.iter();
        warnings.extend(remarks.map(|remark| format!("sweep {}: {remark}", number + 1)));
    }
    if let Some(plan) = &config.sweep {
        warnings.extend(overshoots(plan, alignment));
    }
    warnings
}

/// A warning if the packets' delay changed and stayed so.
fn delay_change_warning(alignment: &Alignment) -> Option<String> {
    let changes = &alignment.delay_changes;
    let change = changes
        .iter()
        .max_by_key(|change| change.by.as_nanos().abs())?;
    let (way, set, became) = match change.by < Span::ZERO {
        true => ("earlier", "back", "shorter"),
        false => ("later", "forward", "longer"),
    };
    let more = match changes.len() - 1 {
        0 => String::new(),
        others => format!(" (the greatest of {} such changes)", others + 1),
    };
    let ms = |span: Span| span.as_secs_f64() * 1e3;
    Some(format!(
        "{:.3} s into the recording packets begin to arrive {:.2} ms {way}{more}: the host's clock was set {set}, or the network's delay became {became}; times may be wrong by {:.2} ms",
        change.after.as_secs_f64(),
        ms(change.by).abs(),
        ms(alignment.clock.bound())
    ))
}

/// A warning if the angles are less certain than those of a good scan. An age of the positions of
/// up to [`MAX_AGE_S`], which samples cannot always show, is part of a good scan, if its motion is
/// the commanded one.
fn angle_warning(alignment: &Alignment) -> Option<String> {
    let speeds = alignment.sweeps.iter().map(|sweep| sweep.cruise.0.abs());
    let fits = alignment.trajectory.fits();
    let age_deg = match fits.iter().any(|fit| fit.method == Method::Spline) {
        true => 0.0,
        false => MAX_AGE_S * speeds.fold(0.0, f64::max),
    };
    // The clock has its own warning.
    let bound = alignment.trajectory_bound_deg()?;
    let gaps = alignment.sample_gaps;
    let longest_s = gaps.longest.as_secs_f64();
    let gaps_text = match gaps.count {
        1 => format!("the sweeps have a gap of {longest_s:.2} s without a position of the drive"),
        count => format!(
            "the sweeps have {count} gaps of up to {longest_s:.2} s without a position of the drive"
        ),
    };
    let cause = match gaps.count {
        0 => "the drive's positions are few, late or scattered",
        _ => &gaps_text,
    };
    if bound > WARNING_BOUND_DEG + age_deg {
        return Some(format!(
            "{cause}: the angle error may reach {bound:.2} deg, {:.0} mm at 10 m",
            bound.to_radians() * 10e3
        ));
    }
    // Nothing that happens within a gap shows, so that no bound contains it.
    (gaps.count > 0)
        .then(|| format!("{gaps_text}: a knock or a halt of the head within a gap would not show"))
}

/// Start and end of a sweep by the plan.
fn planned_ends(plan: &SweepPlan, sweep: &Sweep) -> (f64, f64) {
    let is_forth = (sweep.to.0 - sweep.from.0) * (plan.to_deg - plan.from_deg) > 0.0;
    match is_forth {
        true => (plan.from_deg, plan.to_deg),
        false => (plan.to_deg, plan.from_deg),
    }
}

/// Degrees by which a sweep ended short of `end`; negative beyond it.
fn short_of(end: f64, start: f64, sweep: &Sweep) -> f64 {
    (end - sweep.to.0) * (end - start).signum()
}

/// Sweeps whose last position is beyond the end of the plan.
fn overshoots(plan: &SweepPlan, alignment: &Alignment) -> Vec<String> {
    let sweeps = alignment.sweeps.iter().enumerate();
    let beyond = sweeps.filter_map(|(index, sweep)| {
        let (start, end) = planned_ends(plan, sweep);
        (short_of(end, start, sweep) < -CUT_SHORT_DEG).then(|| {
            format!(
                "sweep {} ended at {:.3} deg, beyond {end} deg",
                index + 1,
                sweep.to.0
            )
        })
    });
    beyond.collect()
}

/// Planned sweeps that are cut short or absent. Empty for a log without a plan or
/// without any sweep.
pub(super) fn incomplete_sweeps(config: &ScanConfig, alignment: &Alignment) -> Vec<String> {
    let Some(plan) = config.sweep.filter(|_| !alignment.sweeps.is_empty()) else {
        return Vec::new();
    };
    let mut incomplete = Vec::new();
    for (index, sweep) in alignment.sweeps.iter().enumerate() {
        let (start, end) = planned_ends(&plan, sweep);
        if (sweep.from.0 - start).abs() > CUT_SHORT_DEG {
            incomplete.push(format!(
                "the positions of sweep {} begin at {:.3} deg, not at {start} deg",
                index + 1,
                sweep.from.0
            ));
        }
        let (short_deg, to_deg) = (short_of(end, start, sweep), sweep.to.0);
        if short_deg > CUT_SHORT_DEG {
            let number = index + 1;
            incomplete.push(match alignment.unobserved_ends.contains(&index) {
                true => format!(
                    "the log has no positions of sweep {number} after {to_deg:.3} deg: its points up to {end} deg are missing"
                ),
                false => format!("sweep {number} was cut short at {to_deg:.3} deg of {end} deg"),
            });
        }
    }
    incomplete.extend(alignment.unseen_sweeps.iter().map(|(from, to)| {
        format!(
            "the log holds no positions of the sweep from {:.3} to {:.3} deg: no cloud of it",
            from.0, to.0
        )
    }));
    let made = alignment.sweeps.len() + alignment.unseen_sweeps.len();
    if (made as u64) < u64::from(plan.sweeps) {
        incomplete.extend(alignment.ambiguous_motions.iter().map(|(from, to)| {
            format!(
                "the axis moved from {:.3} to {:.3} deg, but the log lacks the target: no cloud of it",
                from.0, to.0
            )
        }));
        incomplete.push(format!(
            "{made} of {} planned sweeps are in the log",
            plan.sweeps
        ));
    }
    incomplete
}
