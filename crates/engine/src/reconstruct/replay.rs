//! `velomotion replay`: a cloud from a log, or from anybody's lidar recording. `capture` ends with the same function.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use analysis::truth::Comparison;
use cloud::{Metadata, Sink, SinkError, TiltTrack};
use io::recording::{Gap, Pacer, Wait};
use lidar::{Options, Stats, UtcClock};
use protocol::record::{DriveLink, Record, Wire};
use protocol::vlp16::DATA_LEN;
use scanner::steps::SetClock;
use scanner::trajectory::Method;
use scanner::{
    Accuracy, Alignment, PlacementCounts, Placer, ScanConfig, ScanError, Survey, TiltSource,
};
use sim::Truth;
use units::{Host, Span, Stamp};

use super::contents::contents;
use super::doubts::{doubts, short};
use super::failures::scan_failure;
use super::frames::{FramePlan, FrameWriter, Written};
use crate::failure::{Failure, Kind};
use crate::output::{Target, sink_failure};
use crate::reconstruct::diagnostics as checks;
use crate::reconstruct::report::{self, Scan, StepReport, Sync, ToleranceReport};
use crate::reconstruct::source::{Pass, Source};
use crate::reconstruct::utc::{InUtc, UtcSurvey};

/// Clock that point times refer to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeOf {
    /// The recording host's clock.
    #[default]
    Host,
    /// UTC, while the lidar's clock is locked to a satellite receiver.
    Utc,
}

/// What to make a cloud of.
pub struct Request<'a> {
    /// Log or plain recording.
    pub recording: &'a Source,
    /// Where angles come from.
    pub tilt: TiltSource,
    /// How the lidar's packets are read.
    pub options: Options,
    /// Whose clock the points' times are of.
    pub time: TimeOf,
    /// How accurate angles are to be.
    pub accuracy: Accuracy,
    /// How many times as fast as they were recorded points are handed on; `None`: as fast as they are made.
    pub pace: Option<f64>,
    /// What truly happened, where a simulator knows.
    pub truth: Option<&'a Truth>,
    /// Records that the recording's making lost.
    pub lost_records: u64,
    /// Set where the user wants no more of it.
    pub interrupt: &'a AtomicBool,
}

/// Makes the cloud of a recording: two passes over it, points into the target.
///
/// # Errors
/// [`Kind::BadInput`] where the recording does not hold what is needed, [`Kind::Incomplete`] where the cloud cannot be written.
pub fn make(request: &Request<'_>, mut target: Target) -> Result<Scan, Failure> {
    let output = target.path().to_owned();
    let written = match request.truth {
        None => scan(request, target.sink(), &output)?,
        Some(truth) => {
            let mut comparison = Comparison::new(|time: units::Stamp<units::Lidar>, laser| {
                truth.point(time.as_nanos(), laser)
            });
            let written = scan(request, &mut (target.sink(), &mut comparison), &output)?;
            written.with_truth(comparison.report())
        }
    };
    target.commit()?;
    Ok(written)
}

/// What the first pass over a recording found.
struct Surveyed {
    config: ScanConfig,
    drive: Option<(DriveLink, u64)>,
    pass: Pass,
    alignment: Alignment,
    /// When the last data packet came.
    heard: Option<Stamp<Host>>,
    /// UTC by the lidar's receiver, where it was asked for.
    utc: Option<UtcClock>,
}

/// The first pass.
fn survey(request: &Request<'_>) -> Result<Surveyed, Failure> {
    let source = request.recording;
    let config = source.config()?;
    let cannot_scan = |error: ScanError| scan_failure(source.path(), &error);
    let mut survey = Survey::new(&config, request.options.clone()).map_err(cannot_scan)?;
    let mut utc = (request.time == TimeOf::Utc).then(|| UtcSurvey::new(request.options.clone()));
    let mut heard = None;
    let pass = source.read(|record| {
        survey.observe(record);
        if let Wire::Lidar { payload, .. } = record.wire
            && payload.len() == DATA_LEN
        {
            heard = Some(record.host);
        }
        if let Some(utc) = &mut utc {
            utc.observe(record);
        }
        go_on(request)
    })?;
    let drive = survey.drive();
    let alignment = survey
        .solve(&config, &request.tilt, request.accuracy)
        .map_err(cannot_scan)?;
    Ok(Surveyed {
        config,
        drive,
        pass,
        alignment,
        heard,
        utc: utc.map(UtcSurvey::solve),
    })
}

fn go_on(request: &Request<'_>) -> Result<(), Failure> {
    match request.interrupt.load(Ordering::Relaxed) {
        true => Err(stopped(request.recording.path())),
        false => Ok(()),
    }
}

/// The two passes.
///
/// # Errors
/// As for [`make`].
pub fn scan(request: &Request<'_>, sink: &mut dyn Sink, output: &Path) -> Result<Scan, Failure> {
    let surveyed = survey(request)?;
    let Some(utc) = surveyed.utc.clone() else {
        let (placed, stats) = place(request, &surveyed, sink, output)?;
        let scan = report(request, &surveyed, placed, &stats, output)?;
        tell(sink, &scan, output)?;
        return Ok(scan);
    };
    let mut in_utc = InUtc::new(sink, utc);
    let (mut placed, stats) = place(request, &surveyed, &mut in_utc, output)?;
    let without = in_utc.without();
    placed.points -= without;
    if placed.points == 0 {
        return Err(never_locked(request));
    }
    let mut scan = report(request, &surveyed, placed, &stats, output)?;
    left_out(&mut scan, without);
    tell(&mut in_utc, &scan, output)?;
    Ok(scan)
}

/// Tells a sink what was found out about the scan.
fn tell(sink: &mut dyn Sink, scan: &Scan, output: &Path) -> Result<(), Failure> {
    sink.checks(&checks::of(scan))
        .map_err(|error| sink_failure(output, &error))
}

/// How the platform tilted, as sinks want it.
pub(crate) fn tilt_track(alignment: &Alignment) -> TiltTrack {
    let trajectory = &alignment.trajectory;
    let samples = trajectory.samples().iter();
    let sweeps = alignment.sweeps.iter();
    TiltTrack {
        mount: (trajectory.method() != Method::None).then_some(alignment.mount.d),
        samples: samples.map(|s| (s.host, s.angle)).collect(),
        sweeps: sweeps.map(|s| (s.start, s.end)).collect(),
    }
}

fn never_locked(request: &Request<'_>) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!(
            "{}: the lidar's clock was never locked to UTC while it fired",
            request.recording.path().display()
        ),
    )
    .help("info says why; without --time utc times are of the recording host's clock")
}

/// Says how many points have no UTC.
fn left_out(scan: &mut Scan, without_utc: u64) {
    if without_utc > 0 {
        scan.left_out += without_utc;
        scan.contents.warnings.push(format!(
            "{without_utc} points were left out: the lidar's clock was not locked to UTC"
        ));
    }
}

/// The second pass.
fn place(
    request: &Request<'_>,
    surveyed: &Surveyed,
    sink: &mut dyn Sink,
    output: &Path,
) -> Result<(PlacementCounts, Stats), Failure> {
    let mut pace = pacer(request.pace)?;
    let cannot_write = |error: SinkError| sink_failure(output, &error);
    sink.begin(&metadata(&surveyed.config, request))
        .map_err(cannot_write)?;
    if sink.wants_tilt() {
        let track = tilt_track(&surveyed.alignment);
        sink.tilt(&track).map_err(cannot_write)?;
    }
    let mut placer = Placer::new(&surveyed.alignment, request.options.clone(), sink);
    request.recording.read(|record| {
        if let Some(pace) = &mut pace {
            wait(pace, record, request.interrupt);
        }
        placer.observe(record).map_err(cannot_write)?;
        go_on(request)
    })?;
    placer.finish().map_err(cannot_write)
}

/// The two passes, a cloud a turn of the lidar.
///
/// # Errors
/// As for [`make`], and [`Kind::Usage`] for frames that cannot be.
pub fn frames(request: &Request<'_>, plan: &FramePlan) -> Result<Scan, Failure> {
    let surveyed = survey(request)?;
    let metadata = metadata(&surveyed.config, request);
    let mut pace = pacer(request.pace)?;
    let options = request.options.clone();
    let utc = surveyed.utc.as_ref();
    let mut writer = FrameWriter::new(plan, &surveyed.alignment, utc, options, metadata)?;
    let mut written = Written::default();
    request.recording.read(|record| {
        if let Some(pace) = &mut pace {
            wait(pace, record, request.interrupt);
        }
        writer.observe(record, &mut written)?;
        go_on(request)
    })?;
    let (stats, target) = writer.finish(&mut written)?;
    if written.placed.points == 0 && written.without_utc > 0 {
        return Err(never_locked(request));
    }
    let mut scan = report(request, &surveyed, written.placed, &stats, &plan.output)?;
    scan.clouds = Some(written.clouds);
    left_out(&mut scan, written.without_utc);
    if let Some(mut target) = target {
        tell(target.sink(), &scan, &plan.output)?;
        target.commit()?;
    }
    Ok(scan)
}

/// What there is to say of a scan.
fn report(
    request: &Request<'_>,
    surveyed: &Surveyed,
    placed: PlacementCounts,
    stats: &Stats,
    output: &Path,
) -> Result<Scan, Failure> {
    let (alignment, path) = (&surveyed.alignment, request.recording.path());
    if placed.points == 0 && placed.outside > 0 {
        return Err(Failure::new(
            Kind::BadInput,
            format!(
                "{}: none of {} returns falls into the time for which a tilt angle is known",
                path.display(),
                placed.outside
            ),
        )
        .help("see whether the angles belong to this recording; --tilt none needs none"));
    }
    if let Some(lasers) = stats.corrections_refused {
        return Err(Failure::new(
            Kind::BadInput,
            format!("the calibration is of {lasers} lasers, the lidar has another number"),
        )
        .help("give the calibration of this very lidar"));
    }
    let mut contents = contents(
        &surveyed.config,
        stats,
        surveyed.drive,
        &surveyed.pass,
        &alignment.steps,
    );
    let short = short(&surveyed.config, alignment);
    let doubts = doubts(alignment).into_iter();
    contents
        .warnings
        .extend(doubts.chain(short.iter().cloned()));
    Ok(Scan {
        contents,
        points: placed.points,
        left_out: placed.outside,
        clouds: None,
        sweeps: alignment
            .sweeps
            .iter()
            .map(|sweep| report::SweepReport::new(sweep, stats.rpm))
            .collect(),
        sync: sync(alignment),
        output: output.display().to_string(),
        log: path.display().to_string(),
        lost_records: request.lost_records,
        unheard_s: unheard_s(surveyed),
        short,
        reception: None,
        truth: None,
    })
}

/// How long the lidar was silent at the end of the last sweep, seconds.
fn unheard_s(surveyed: &Surveyed) -> f64 {
    let alignment = &surveyed.alignment;
    // Sweeps are by the host's clock as it was before it was set.
    let host_was_set = alignment
        .steps
        .iter()
        .any(|step| step.clock == SetClock::Host);
    match (surveyed.heard, alignment.sweeps.last()) {
        (Some(heard), Some(sweep)) if !host_was_set => {
            sweep.end.saturating_since(heard).as_secs_f64().max(0.0)
        }
        _ => 0.0,
    }
}

/// A recording that is silent for longer is not waited for.
const LONGEST_SILENCE: Span = Span::from_secs(10);

fn pacer(factor: Option<f64>) -> Result<Option<Pacer>, Failure> {
    let pacer = factor.map(|factor| Pacer::new(factor, LONGEST_SILENCE));
    pacer.transpose().map_err(|error| {
        Failure::new(Kind::Usage, format!("--realtime: {error}"))
            .help("1 is as fast as it was recorded, 2 twice as fast")
    })
}

/// Waits until a record is due. What is not waited for is said.
fn wait(pace: &mut Pacer, record: &Record<'_>, interrupt: &AtomicBool) {
    if let Wait::Restarted(gap) = pace.wait(record.host, interrupt) {
        let (what, span) = match gap {
            Gap::Silence(span) => ("not waited for: the recording is silent for", span),
            Gap::Backwards(span) => ("the recording's time goes back by", span),
            Gap::Behind(span) => ("behind the recording's time by", span),
        };
        tracing::warn!("{what} {:.1} s", span.as_secs_f64());
    }
}

fn stopped(path: &Path) -> Failure {
    Failure::new(
        Kind::Interrupted,
        "stopped by the user while making the cloud",
    )
    .help(format!("replay {} makes it again", path.display()))
}

fn sync(alignment: &Alignment) -> Sync {
    Sync {
        clock_method: "lower envelope",
        clock_residual_us: alignment.clock.residual().as_micros_f64(),
        clock_bound_us: alignment.clock.bound().as_micros_f64(),
        clock_drift_ppm: alignment.clock.drift_ppm(),
        steps: alignment.steps.iter().map(StepReport::new).collect(),
        angle_method: alignment.trajectory.method().name(),
        tolerance: alignment.choice.as_ref().map(ToleranceReport::new),
        angle_rms_deg: alignment.angle_rms_deg(),
        angle_bound_deg: alignment.angle_bound_deg(),
    }
}

/// What the cloud says about itself. Nothing of the file's name or of today: a log gives the same bytes wherever it lies.
fn metadata(config: &ScanConfig, request: &Request<'_>) -> Metadata {
    let mut comments = Vec::new();
    if request.tilt == TiltSource::None {
        comments.push("not tilted: the sensor's own frame".to_owned());
    }
    Metadata {
        simulated: config.simulated,
        source: format!("device {}", config.device),
        software: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
        time_reference: match request.time {
            TimeOf::Host => "Unix seconds (UTC) of the recording host's clock",
            TimeOf::Utc => "Unix seconds (UTC) by the lidar's satellite receiver",
        }
        .to_owned(),
        comments,
    }
}
