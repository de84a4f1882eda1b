//! `velomotion analyze`: density and evenness of scans.
//!
//! Patterns come from `sim`, clouds and logs from files (`input`); `analysis` measures.

mod directions;
mod folder;
pub(super) mod input;
pub(crate) mod report;
pub(crate) mod sweep;
mod text;
mod view;

use std::f64::consts::PI;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use analysis::density::{
    BinCounts, DensityError, Icosahedron, LargestHole, Locator, TOLERANCE_RAD, bands, holes,
    largest_hole, largest_hole_within, quantile, rows,
};
use analysis::figures::SPHERE_M;
use analysis::k::{self, Edges, Estimate, FrameRotation, KCurve, Sampling};
use glam::DVec3;
use sim::patterns::{AXIS, FieldOfView, Pattern};

pub use report::{
    AnalyzeReport, Blind, Density, DeviceReport, EmptiestBin, GapReport, HoleReport, KReport,
    PatternReport,
};
pub use view::ViewReport;

use super::CommandOutput;
use crate::cli::{self, Common};
use crate::signals;
use crate::terminal::Progress;
use directions::Directions;
use engine::failure::{Failure, Kind};
use folder::Folder;
use input::{Input, InputArgument};

/// Classes of the histogram.
const CLASSES: usize = 10;
/// Radius of the sphere for K - K_csr in the JSON.
const RADIUS_M: f64 = 1.0;
/// Share of pairs on bin edges below which no warning is due: a few in a cloud are chance.
const LEAST_ON_EDGES: f64 = 1e-8;
/// Interval of checks for an interrupt.
const LOOK_AGAIN: Duration = Duration::from_millis(20);
/// Least tolerance of K by draws: an hour of them would bound the error by a tenth of it.
const LEAST_DRAWN: f64 = 2e-5;
/// Number of points above which progress is reported.
const MANY_POINTS: u64 = 1_000_000;
/// Holes counted one by one; more would take half a minute at eleven million points.
const MOST_HOLES: usize = 2_000;

/// Runs the command.
///
/// # Errors
/// [`Kind::Usage`] for invalid patterns, [`Kind::BadInput`] for unreadable files.
pub fn run(arguments: &cli::Analyze, common: &Common) -> Result<CommandOutput, Failure> {
    let interrupt = signals::interrupt_flag()?;
    let (arguments, common, flag) = (arguments.clone(), common.clone(), Arc::clone(&interrupt));
    let (done, all) = mpsc::channel();
    // A measurement can take minutes and holds no resources to release, so Ctrl-C abandons its
    // thread.
    let work = move || drop(done.send(measured(&arguments, &common, &flag)));
    std::thread::Builder::new().spawn(work).map_err(|error| {
        Failure::new(Kind::Incomplete, format!("cannot start a thread: {error}"))
            .help("end other programs, or raise the limit of threads")
    })?;
    let (output, folder) = loop {
        match all.recv_timeout(LOOK_AGAIN) {
            Ok(found) => break found?,
            Err(RecvTimeoutError::Timeout) => go_on(&interrupt)?,
            Err(RecvTimeoutError::Disconnected) => {
                let what = "the analysis ended without a result";
                return Err(Failure::new(Kind::Incomplete, what)
                    .help("report it with the input: it is an error of this program"));
            }
        }
    };
    go_on(&interrupt)?;
    // Files are written on this thread, which is never abandoned.
    if let Some((folder, report, progress)) = folder {
        folder.write(&report, &progress)?;
    }
    Ok(output)
}

/// The output, and the folder to be written.
type AnalyzeOutcome = (CommandOutput, Option<(Folder, AnalyzeReport, Progress)>);

/// Measures all inputs.
fn measured(
    arguments: &cli::Analyze,
    common: &Common,
    interrupt: &AtomicBool,
) -> Result<AnalyzeOutcome, Failure> {
    let progress = Progress::new(common);
    let measure = Measure::new(arguments)?;
    if let Some(sweep) = &arguments.sweep {
        let report = sweep.run(&arguments.inputs, &measure, progress, interrupt)?;
        return Ok((CommandOutput::result(&report, report.text()), None));
    }
    let inputs: Vec<InputArgument<'_>> = arguments
        .inputs
        .iter()
        .map(|argument| InputArgument::new(argument))
        .collect::<Result<_, _>>()?;
    let origin_m = DVec3::from_array(arguments.origin.unwrap_or_default());
    if arguments.origin.is_some() && !inputs.iter().any(InputArgument::is_cloud) {
        let what = "--origin is where the scanner was in a cloud, and no cloud is named";
        let help = "leave it out: patterns and logs know where theirs is";
        return Err(Failure::new(Kind::Usage, what).help(help));
    }
    let mut folder = Folder::new(arguments)?;
    let mut patterns = Vec::with_capacity(inputs.len());
    for (input, name) in inputs.iter().zip(&arguments.inputs) {
        go_on(interrupt)?;
        if inputs.len() > 1 {
            progress.say(name);
        }
        let input = input.read(origin_m, interrupt)?;
        if input.simulated {
            progress.say(&format!("SIMULATED: {} is not of a real scan", input.name));
        }
        let pattern = measure.one(&input, &progress, interrupt)?;
        for warning in &pattern.warnings {
            progress.say(&format!("warning: {}: {warning}", pattern.name));
        }
        if let Some(folder) = &mut folder {
            folder.add(&input, &pattern);
        }
        patterns.push(pattern);
    }
    let report = AnalyzeReport { patterns };
    let output = CommandOutput::result(&report, report.text());
    Ok((output, folder.map(|folder| (folder, report, progress))))
}

/// Settings common to all inputs.
struct Measure {
    level: u32,
    locator: Locator,
    /// Bins of the K function.
    edges: Edges,
    /// Tolerated error of K.
    tolerance: f64,
    /// Centres of the bins.
    places: Vec<DVec3>,
    /// Directions from which gaps are measured.
    gap_places: Vec<DVec3>,
}

/// Subdivisions of the icosahedron whose centres are the directions of gaps.
const GAP_LEVEL: u32 = 5;
/// Most bins listed as the emptiest.
const MOST_EMPTIEST: usize = 10;

impl Measure {
    fn new(arguments: &cli::Analyze) -> Result<Self, Failure> {
        let level = arguments.level;
        let edges = Edges::equal(usize::from(arguments.bins)).map_err(|error| {
            Failure::new(Kind::Usage, error.to_string()).help("the paper's are 151")
        })?;
        let icosahedron = Icosahedron::new(level).map_err(|error| {
            Failure::new(Kind::Usage, error.to_string()).help("the paper's is 4: 5120 bins")
        })?;
        let centres = |grid: &Icosahedron| grid.bins().iter().map(|bin| bin.centre).collect();
        let gap_grid = Icosahedron::new(GAP_LEVEL)
            .map_err(|error| Failure::new(Kind::Usage, error.to_string()))?;
        Ok(Self {
            gap_places: centres(&gap_grid),
            places: centres(&icosahedron),
            level,
            locator: Locator::new(&icosahedron),
            edges,
            tolerance: arguments.k_error,
        })
    }

    fn one(
        &self,
        input: &Input,
        progress: &Progress,
        interrupt: &AtomicBool,
    ) -> Result<PatternReport, Failure> {
        let say = |what: &str| {
            let points = input.directions.points();
            if points >= MANY_POINTS {
                progress.say(&format!("{}, {points} points: {what}", input.name));
            }
        };
        let wrong = |error: DensityError| failure(&input.name, &error);
        let directions = &input.directions;
        let view = input.view.as_ref().map(|seen| seen.view);
        say("density");
        let counts = directions.counts(&self.locator).map_err(wrong)?;
        go_on(interrupt)?;
        say("gaps");
        let gaps = self.gaps(input).map_err(wrong)?;
        let emptiest = self.emptiest(input, &counts).map_err(wrong)?;
        go_on(interrupt)?;
        say("largest holes");
        let (thinned, within_rad) = directions.thinned();
        let largest = largest_hole(&thinned, TOLERANCE_RAD).map_err(wrong)?;
        let largest = largest.ok_or_else(|| {
            Failure::new(Kind::BadInput, format!("{}: no points", input.name))
                .help("give one that has some")
        })?;
        go_on(interrupt)?;
        let hole_in_view = match view {
            Some(view) => {
                let depth = |direction: DVec3| view.depth_rad(direction);
                largest_hole_within(&thinned, TOLERANCE_RAD, &depth).map_err(wrong)?
            }
            None => None,
        };
        go_on(interrupt)?;
        say("blind spots");
        let least_rad = gaps.of_99_percent_deg.to_radians();
        let blind = blind(input, (&thinned, within_rad), least_rad).map_err(wrong)?;
        drop(thinned);
        let in_view = view.map(|view| self.in_view(&view));
        let in_view =
            in_view.map(|which| counts.statistics_of(|bin| which.get(bin) == Some(&true)));
        let hole = hole_report(&largest, within_rad);
        go_on(interrupt)?;
        say("K function");
        let (k, on_edges) = self.k(input)?;
        let outside = input.outside.as_ref();
        let mut warnings: Vec<String> = outside
            .and_then(|outside| outside.warning(hole.radius_deg))
            .into_iter()
            .collect();
        warnings.extend(input.warnings.iter().cloned().chain(on_edges));
        Ok(PatternReport {
            name: input.name.clone(),
            points: directions.points(),
            frames: input.frames,
            scan_s: input.scan_s,
            without_direction: input.without_direction,
            simulated: input.simulated,
            without_numbers: input.without_numbers,
            view: input.view,
            density: Density {
                bins: counts.statistics(),
                level: self.level,
                histogram: counts.histogram(CLASSES),
                counts,
            },
            density_in_view: in_view,
            hole,
            hole_in_view: hole_in_view.map(|found| hole_report(&found, within_rad)),
            gaps,
            emptiest,
            blind,
            k,
            warnings,
            device: input.pattern.as_ref().and_then(input::device),
        })
    }

    /// Whether the centre of each bin is in view.
    fn in_view(&self, view: &FieldOfView) -> Vec<bool> {
        let depths = self.places.iter().map(|place| view.depth_rad(*place));
        depths.map(|depth| depth >= 0.0).collect()
    }

    fn k(&self, input: &Input) -> Result<(KReport, Vec<String>), Failure> {
        let rotation = input.pattern.as_ref().and_then(Pattern::frame_rotation);
        let rotation = rotation
            .filter(|rotation| rotation.frames > 1)
            .map(|rotation| FrameRotation {
                axis: rotation.axis,
                step_rad: rotation.step_rad,
                frames: rotation.frames as usize,
            });
        let sampling = Sampling {
            tolerance: self.tolerance,
            ..Sampling::default()
        };
        let threads = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let estimate = match &input.directions {
            Directions::Stored(directions) => {
                let rotation = rotation.as_ref();
                k::estimate(directions, rotation, &self.edges, &sampling, threads)
            }
            Directions::Streamed(pattern) if self.tolerance < LEAST_DRAWN => {
                let what = format!(
                    "--k-error: expected at least {LEAST_DRAWN}, got {}",
                    self.tolerance
                );
                let help = format!(
                    "{} has {} points, of which pairs are drawn",
                    input.name,
                    pattern.points()
                );
                return Err(Failure::new(Kind::Usage, what).help(help));
            }
            Directions::Streamed(pattern) => {
                let direction = |point: u64| pattern.direction(point);
                k::drawn(pattern.points(), &direction, &self.edges, &sampling)
            }
        };
        let estimate = estimate.map_err(|error| {
            Failure::new(Kind::BadInput, format!("{}: {error}", input.name))
                .help("--k-error 0 counts every pair, whatever the points")
        })?;
        let curve = KCurve::new(&estimate, SPHERE_M);
        let area = 4.0 * PI * RADIUS_M * RADIUS_M;
        let has_pairs = curve.has_pairs();
        let bound = has_pairs.then_some(curve.d_error_bound);
        let mut warnings: Vec<String> = on_edges(&estimate).into_iter().collect();
        if estimate.points < 2 {
            warnings.push("one point has no pairs, and so no K: null".to_owned());
        }
        let report = KReport {
            method: estimate.method,
            bins: self.edges.bins(),
            radius_m: RADIUS_M,
            error_bound: bound.map(|bound| area * bound),
            theta_deg: curve
                .theta_rad
                .iter()
                .map(|theta| theta.to_degrees())
                .collect(),
            k_minus_csr: has_pairs.then(|| curve.d.iter().map(|d| area * d).collect()),
            max_abs: has_pairs.then(|| area * curve.d_max.max(-curve.d_min)),
            d_error_bound: bound,
            risk: has_pairs.then_some(estimate.risk),
            d: has_pairs.then(|| curve.d.clone()),
            d_max: has_pairs.then_some(curve.d_max),
            d_min: has_pairs.then_some(curve.d_min),
            on_edges: estimate.on_edges,
            curve,
        };
        Ok((report, warnings))
    }

    /// The bins with the fewest points; among equal ones those farthest from any point.
    fn emptiest(
        &self,
        input: &Input,
        counts: &BinCounts,
    ) -> Result<Vec<EmptiestBin>, DensityError> {
        let is_in_view = |place: &DVec3| match &input.view {
            Some(seen) => seen.view.depth_rad(*place) >= 0.0,
            None => true,
        };
        let bins = self.places.iter().zip(counts.by_bin());
        let mut bins: Vec<(DVec3, u64)> = bins
            .filter(|(place, _)| is_in_view(place))
            .map(|(place, points)| (*place, *points))
            .collect();
        bins.sort_by_key(|(_, points)| *points);
        // All bins as empty as the last of the list, since their gaps decide.
        let most = bins.get(MOST_EMPTIEST.saturating_sub(1)).or(bins.last());
        let most = most.map_or(0, |(_, points)| *points);
        bins.retain(|(_, points)| *points <= most);
        let places: Vec<DVec3> = bins.iter().map(|(place, _)| *place).collect();
        let gaps = input.directions.gaps(&places)?;
        let mut found: Vec<EmptiestBin> = bins
            .iter()
            .zip(gaps)
            .map(|((place, points), gap)| EmptiestBin {
                points: *points,
                centre: place.to_array(),
                from_axis_deg: place.dot(AXIS).clamp(-1.0, 1.0).acos().to_degrees(),
                gap_deg: gap.to_degrees(),
            })
            .collect();
        found.sort_by(|a, b| {
            let by_gap = b.gap_deg.total_cmp(&a.gap_deg);
            a.points.cmp(&b.points).then(by_gap)
        });
        found.truncate(MOST_EMPTIEST);
        Ok(found)
    }

    /// Angle to the nearest point, radians, from the directions of gaps that are in view.
    fn gaps_in_view(
        &self,
        directions: &Directions,
        view: Option<&FieldOfView>,
    ) -> Result<Vec<f64>, DensityError> {
        let mut places = self.gap_places.clone();
        if let Some(view) = view {
            places.retain(|place| view.depth_rad(*place) >= 0.0);
        }
        directions.gaps(&places)
    }

    fn gaps(&self, input: &Input) -> Result<GapReport, DensityError> {
        let view = input.view.as_ref().map(|seen| &seen.view);
        let gaps = self.gaps_in_view(&input.directions, view)?;
        let of = |share: f64| quantile(&gaps, share).unwrap_or(0.0).to_degrees();
        Ok(GapReport {
            of: if input.view.is_some() { "view" } else { "all" },
            median_deg: of(0.5),
            of_95_percent_deg: of(0.95),
            of_99_percent_deg: of(0.99),
        })
    }
}

/// Holes in view that are larger than most gaps, and bands.
fn blind(
    input: &Input,
    (directions, within_rad): (&[DVec3], f64),
    least_rad: f64,
) -> Result<Blind, DensityError> {
    let least_rad = least_rad.max(TOLERANCE_RAD);
    let found = match &input.view {
        Some(seen) => {
            let depth = |direction: DVec3| seen.view.depth_rad(direction);
            // A hole among thinned points is larger by at most the distance of those left out.
            Some(holes(
                directions,
                least_rad + within_rad,
                MOST_HOLES,
                &depth,
            )?)
        }
        None => None,
    };
    // The distance of a ray from the axis is independent of the tilt if it starts on the axis.
    let pattern = input.pattern.as_ref();
    let on_axis = pattern.is_some_and(|pattern| pattern.settings().d_m == 0.0);
    let found = found.as_ref();
    Ok(Blind {
        least_radius_deg: found.map(|_| least_rad.to_degrees()),
        holes: found.map(Vec::len),
        and_more: found.map(|found| found.len() == MOST_HOLES),
        rows: found.map(|found| rows(found, AXIS, 0.5 * least_rad)),
        bands: bands(directions, AXIS, report::BAND_DEG.to_radians())?,
        bands_at_any_speed: on_axis,
    })
}

/// Warning about pairs on bin edges, which rounding decides.
fn on_edges(estimate: &Estimate) -> Option<String> {
    let (pairs, bins) = (estimate.on_edges, estimate.edges.bins());
    let n = estimate.points as f64;
    if (pairs as f64) <= LEAST_ON_EDGES * n * (n - 1.0) / 2.0 {
        return None;
    }
    let about = match estimate.largest_bound() {
        0.0 => "",
        _ => "about ",
    };
    Some(format!(
        "K function: {about}{pairs} pairs lie on the edges of {bins} bins within rounding. They are counted to the smaller angle as far as their last digits say so, \
         and others would count them differently; --bins 151 has no such pair with azimuths of a grid of 0.4 degrees"
    ))
}

fn hole_report(largest: &LargestHole, within_rad: f64) -> HoleReport {
    let hole = largest.hole;
    HoleReport {
        radius_deg: (hole.radius_rad - within_rad).max(0.0).to_degrees(),
        at_most_deg: largest.bound_rad.to_degrees(),
        centre: hole.centre.to_array(),
        from_axis_deg: hole.centre.angle_between(AXIS).to_degrees(),
    }
}

fn failure(name: &str, error: &DensityError) -> Failure {
    Failure::new(Kind::BadInput, format!("{name}: {error}")).help("remove the invalid points")
}

/// Checks for an interrupt.
fn go_on(interrupt: &AtomicBool) -> Result<(), Failure> {
    match interrupt.load(Ordering::Relaxed) {
        true => Err(
            Failure::new(Kind::Interrupted, "stopped by the user while analysing")
                .help("nothing was written; run the same command again"),
        ),
        false => Ok(()),
    }
}
