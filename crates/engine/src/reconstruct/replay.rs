//! From a log or recording to a cloud in two passes: solve clocks and angles, then place points.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use analysis::truth::Comparison;
use cloud::{EastNorthUp, Metadata, Sink, SinkError, TiltTrack};
use io::recording::{Gap, Pacer, Wait};
use lidar::{FrameCutter, Options, Stats, UtcClock, is_dual};
use protocol::record::{DriveLink, Record, Wire};
use protocol::vlp16::{DATA_LEN, DataPacket, PositionPacket};
use scanner::clock_steps::SetClock;
use scanner::trajectory::Method;
use scanner::{
    Accuracy, Alignment, PlacementCounts, Placer, ScanConfig, ScanError, Survey, TiltSource,
};
use sim::Truth;
use units::{Degrees, Host, Span, Stamp};

use super::contents::contents;
use super::failures::scan_failure;
use super::frames::{FrameFiles, FramePlan, OrganisedFrames, frame_cutter};
use super::georeference::FixSurvey;
use super::live::{LiveDifference, LivePoints};
use super::satellite::SatelliteReceiver;
use super::warnings::{alignment_warnings, incomplete_sweeps};
use crate::failure::{Failure, Kind};
use crate::output::{Target, sink_failure};
use crate::reconstruct::decoder_options::{DecoderRequest, decoder_options};
use crate::reconstruct::diagnostics;
use crate::reconstruct::report::{
    self, GeoreferenceReport, ScanReport, StepReport, SyncReport, ToleranceReport, TruthErrors,
};
use crate::reconstruct::source::{PassSummary, Source};
use crate::reconstruct::utc::{InUtc, UtcSurvey};
use crate::words::counted;

/// Clock of the point times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeReference {
    /// The recording host's clock.
    #[default]
    Host,
    /// UTC, while the lidar's clock is locked to a satellite receiver.
    Utc,
}

/// A reconstruction.
pub struct Reconstruction<'a> {
    /// Log or plain recording.
    pub recording: &'a Source,
    /// Source of the tilt angles.
    pub tilt: TiltSource,
    /// Options of the packet decoder.
    pub options: Options,
    /// Clock of the point times.
    pub time: TimeReference,
    /// Requested accuracy of the angles.
    pub accuracy: Accuracy,
    /// Playback speed relative to the recording; as fast as possible without it.
    pub pace: Option<f64>,
    /// Ground truth, if the recording is simulated.
    pub truth: Option<&'a Truth>,
    /// Whether to compare the cloud with the points of the live view.
    pub live: bool,
    /// Records lost during the recording.
    pub lost_records: u64,
    /// Heading of the scanner's y axis (forward), clockwise from true north, for a file in the
    /// local frame x east, y north, z up. The base is taken as level.
    pub georeference: Option<Degrees>,
    /// Stops the reconstruction when set.
    pub interrupt: &'a AtomicBool,
}

impl<'a> Reconstruction<'a> {
    /// The cloud of a log with its own tilt angles and calibration, in the recording host's time.
    ///
    /// # Errors
    /// [`Kind::BadInput`] for a calibration of another lidar.
    pub fn of_log(
        recording: &'a Source,
        accuracy: Accuracy,
        interrupt: &'a AtomicBool,
    ) -> Result<Self, Failure> {
        Ok(Self {
            recording,
            tilt: TiltSource::Log,
            options: decoder_options(&DecoderRequest::default(), recording)?,
            time: TimeReference::Host,
            accuracy,
            pace: None,
            truth: None,
            live: false,
            lost_records: 0,
            georeference: None,
            interrupt,
        })
    }

    /// Fails once the reconstruction is to stop.
    pub(super) fn check_interrupt(&self) -> Result<(), Failure> {
        match self.interrupt.load(Ordering::Relaxed) {
            true => Err(interrupted(self.recording.path())),
            false => Ok(()),
        }
    }
}

/// Makes the cloud of a recording and commits it to `target`.
///
/// # Errors
/// [`Kind::BadInput`] for an unsuitable recording, [`Kind::Incomplete`] if the cloud cannot be
/// written.
pub fn make(request: &Reconstruction<'_>, mut target: Target) -> Result<ScanReport, Failure> {
    let output = target.path().to_owned();
    let live = request.live.then(|| LivePoints::of(request)).transpose()?;
    let mut live = live.map(LiveDifference::new);
    let mut written = match (request.truth, &mut live) {
        (None, None) => scan(request, target.sink(), &output)?,
        (None, Some(live)) => scan(request, &mut (target.sink(), live), &output)?,
        (Some(truth), _) => {
            let mut comparison = Comparison::new(|time: units::Stamp<units::Lidar>, laser| {
                truth.point(time.as_nanos(), laser)
            });
            let sinks = (target.sink(), &mut comparison);
            let mut written = match &mut live {
                None => scan(request, &mut { sinks }, &output)?,
                Some(live) => scan(request, &mut (sinks, live), &output)?,
            };
            let errors = comparison.report();
            written.truth = Some(TruthErrors {
                rms_m: errors.rms_m,
                worst_m: errors.worst_m,
            });
            written
        }
    };
    written.live = live.map(|live| live.report());
    target.commit()?;
    Ok(written)
}

/// Result of the first pass.
struct FirstPass {
    config: ScanConfig,
    drive: Option<(DriveLink, u64)>,
    pass: PassSummary,
    alignment: Alignment,
    /// Receive times of the first and the last data packet.
    data_span: Option<[Stamp<Host>; 2]>,
    /// Whether a pulse has two returns, by the first packet.
    dual_return: bool,
    /// UTC clock of the lidar's receiver, if requested.
    utc: Option<UtcClock>,
    receiver: SatelliteReceiver,
    georeference: Option<GeoreferenceReport>,
}

/// First pass: clocks, angles and sweeps.
fn survey(request: &Reconstruction<'_>) -> Result<FirstPass, Failure> {
    let source = request.recording;
    let config = source.config()?;
    let cannot_scan = |link| {
        let path = source.path();
        move |error: ScanError| scan_failure(path, link, &error)
    };
    let mut survey = Survey::new(&config, request.options.clone()).map_err(cannot_scan(None))?;
    let mut utc =
        (request.time == TimeReference::Utc).then(|| UtcSurvey::new(request.options.clone()));
    let mut data_span: Option<[Stamp<Host>; 2]> = None;
    let mut dual_return = None;
    let mut receiver = SatelliteReceiver::default();
    let mut fixes = request.georeference.map(FixSurvey::new);
    let pass = source.read(|record| {
        survey.observe(record);
        if let Wire::Lidar { payload, .. } = record.wire {
            if payload.len() == DATA_LEN {
                let [first, last] = data_span.unwrap_or([record.host; 2]);
                data_span = Some([first.min(record.host), last.max(record.host)]);
                dual_return.get_or_insert_with(|| {
                    DataPacket::new(payload).is_ok_and(|packet| is_dual(&packet))
                });
            } else if let Ok(packet) = PositionPacket::new(payload) {
                receiver.observe(&packet);
                if let Some(fixes) = &mut fixes {
                    fixes.observe(&packet);
                }
            }
        }
        if let Some(utc) = &mut utc {
            utc.observe(record);
        }
        request.check_interrupt()
    })?;
    let drive = survey.drive();
    let solved = survey.solve(&config, &request.tilt, request.accuracy);
    let alignment = solved.map_err(|error| {
        let failure = cannot_scan(drive.map(|drive| drive.0))(error);
        let Some(truncated) = &pass.truncated else {
            return failure;
        };
        let message = format!(
            "{}, and the file is incomplete ({truncated})",
            failure.message
        );
        let help = failure.help.unwrap_or_default();
        Failure::new(failure.kind, message)
            .help(format!("copy it from its source again; otherwise: {help}"))
    })?;
    let georeference = fixes.map(|fixes| fixes.report(source.path(), receiver.pps));
    Ok(FirstPass {
        config,
        drive,
        pass,
        alignment,
        data_span,
        dual_return: dual_return == Some(true),
        utc: utc.map(|utc| utc.clock),
        receiver,
        georeference: georeference.transpose()?,
    })
}

/// Both passes, with points going to `sink`.
///
/// # Errors
/// As [`make`].
pub fn scan(
    request: &Reconstruction<'_>,
    sink: &mut dyn Sink,
    output: &Path,
) -> Result<ScanReport, Failure> {
    scan_into(request, None, sink, output)
}

/// The same, with [`Sink::revolution`] at the end of each revolution of the lidar, which ends at
/// azimuth `cut`.
///
/// # Errors
/// As [`make`], and [`Kind::Usage`] for an invalid azimuth.
pub fn scan_by_revolution(
    request: &Reconstruction<'_>,
    cut: Degrees,
    sink: &mut dyn Sink,
    output: &Path,
) -> Result<ScanReport, Failure> {
    scan_into(request, Some(frame_cutter(cut)?), sink, output)
}

fn scan_into(
    request: &Reconstruction<'_>,
    cutter: Option<FrameCutter>,
    sink: &mut dyn Sink,
    output: &Path,
) -> Result<ScanReport, Failure> {
    let first_pass = survey(request)?;
    let Some(utc) = first_pass.utc.clone() else {
        let (placed, stats) = place(request, &first_pass, cutter, sink, output)?;
        let scan = report(request, &first_pass, placed, &stats, output)?;
        send_summary(sink, &scan, output)?;
        return Ok(scan);
    };
    let mut in_utc = InUtc::new(sink, utc);
    let (mut placed, stats) = place(request, &first_pass, cutter, &mut in_utc, output)?;
    let without = in_utc.without;
    placed.points -= without;
    if placed.points == 0 && without > 0 {
        return Err(utc_never_locked(request));
    }
    let mut scan = report(request, &first_pass, placed, &stats, output)?;
    omit_without_utc(&mut scan, without);
    send_summary(&mut in_utc, &scan, output)?;
    Ok(scan)
}

/// Sends the summary of a scan to a sink.
fn send_summary(sink: &mut dyn Sink, scan: &ScanReport, output: &Path) -> Result<(), Failure> {
    sink.diagnostics(&diagnostics::of(scan))
        .map_err(|error| sink_failure(output, &error))
}

/// Tilt samples and sweeps for sinks that store them.
pub(crate) fn tilt_track(alignment: &Alignment) -> TiltTrack {
    let trajectory = &alignment.trajectory;
    let samples = trajectory.samples().iter();
    let sweeps = alignment.sweeps.iter();
    TiltTrack {
        mount: (trajectory.method() != Method::None).then_some(alignment.mount),
        samples: samples.map(|s| (s.host, s.angle)).collect(),
        sweeps: sweeps.map(|s| (s.start, s.end)).collect(),
    }
}

fn utc_never_locked(request: &Reconstruction<'_>) -> Failure {
    Failure::new(
        Kind::BadInput,
        format!(
            "{}: the lidar's clock was never locked to UTC while it fired",
            request.recording.path().display()
        ),
    )
    .help("velomotion info shows the reason; omit --time utc to use the recording host's clock")
}

/// Times of firings whose returns do not become points, as text.
const fn outside_of(alignment: &Alignment) -> &'static str {
    match alignment.sweeps.is_empty() {
        false => "fired before, between or after the sweeps, or without a known angle",
        true => "fired before the first or after the last known angle",
    }
}

/// Counts points without UTC as omitted, with a warning.
fn omit_without_utc(scan: &mut ScanReport, without_utc: u64) {
    if without_utc > 0 {
        scan.left_out += without_utc;
        let reason = format!("{without_utc} without UTC");
        scan.left_out_because = Some(match scan.left_out_because.take() {
            Some(others) => format!("{others}; {reason}"),
            None => reason,
        });
        scan.contents.warnings.push(format!(
            "{} omitted: the lidar's clock was not locked to UTC",
            counted(without_utc, "point")
        ));
    }
}

/// Second pass: places every return.
fn place(
    request: &Reconstruction<'_>,
    first_pass: &FirstPass,
    cutter: Option<FrameCutter>,
    sink: &mut dyn Sink,
    output: &Path,
) -> Result<(PlacementCounts, Stats), Failure> {
    let mut pace = pacer(request.pace)?;
    let cannot_write = |error: SinkError| sink_failure(output, &error);
    sink.begin(&metadata(first_pass, request))
        .map_err(cannot_write)?;
    if sink.wants_tilt() {
        let track = tilt_track(&first_pass.alignment);
        sink.tilt(&track).map_err(cannot_write)?;
    }
    let mut placer = Placer::new(&first_pass.alignment, request.options.clone(), sink);
    if let Some(cutter) = cutter {
        placer = placer.by_revolution(cutter);
    }
    request.recording.read(|record| {
        if let Some(pace) = &mut pace {
            wait_until_due(pace, record, request.interrupt);
        }
        placer.observe(record).map_err(cannot_write)?;
        request.check_interrupt()
    })?;
    placer.finish().map_err(cannot_write)
}

/// Both passes, with one cloud per revolution of the lidar.
///
/// # Errors
/// As [`make`], and [`Kind::Usage`] for invalid frame settings.
pub fn frames(request: &Reconstruction<'_>, plan: &FramePlan) -> Result<ScanReport, Failure> {
    let mut files = FrameFiles::new(plan)?;
    let made = match plan.organised {
        true => organised(request, &mut files, &plan.output),
        false => scan_by_revolution(request, plan.cut, &mut files, &plan.output),
    };
    let mut scan = made.map_err(|failure| files.cause(failure))?;
    scan.clouds = Some(files.clouds);
    files.commit()?;
    Ok(scan)
}

/// Both passes, with organised frames.
fn organised(
    request: &Reconstruction<'_>,
    files: &mut FrameFiles<'_>,
    output: &Path,
) -> Result<ScanReport, Failure> {
    let first_pass = survey(request)?;
    let metadata = metadata(&first_pass, request);
    let mut pace = pacer(request.pace)?;
    let (alignment, utc) = (&first_pass.alignment, first_pass.utc.as_ref());
    let options = request.options.clone();
    let mut frames = OrganisedFrames::new(files, alignment, utc, options, &metadata)?;
    request.recording.read(|record| {
        if let Some(pace) = &mut pace {
            wait_until_due(pace, record, request.interrupt);
        }
        frames.observe(record)?;
        request.check_interrupt()
    })?;
    let (placed, without_utc, stats) = frames.finish()?;
    if placed.points == 0 && without_utc > 0 {
        return Err(utc_never_locked(request));
    }
    let mut scan = report(request, &first_pass, placed, &stats, output)?;
    omit_without_utc(&mut scan, without_utc);
    Ok(scan)
}

/// Report on a scan.
fn report(
    request: &Reconstruction<'_>,
    first_pass: &FirstPass,
    placed: PlacementCounts,
    stats: &Stats,
    output: &Path,
) -> Result<ScanReport, Failure> {
    let (alignment, path) = (&first_pass.alignment, request.recording.path());
    if placed.points == 0 && placed.outside > 0 {
        return Err(Failure::new(
            Kind::BadInput,
            format!(
                "{}: no tilt angle is known at the time of any of the {} returns",
                path.display(),
                placed.outside
            ),
        )
        .help("check that the angles belong to this recording, or use --tilt none"));
    }
    if let Some(lasers) = stats.corrections_refused {
        return Err(Failure::new(
            Kind::BadInput,
            format!("the calibration has {lasers} lasers, the lidar has a different number"),
        )
        .help("use the calibration of this individual lidar"));
    }
    let mut contents = contents(
        &first_pass.config,
        stats,
        first_pass.drive,
        &first_pass.pass,
        &alignment.steps,
    );
    let incomplete = incomplete_sweeps(&first_pass.config, alignment);
    let warnings = alignment_warnings(&first_pass.config, alignment, &request.tilt).into_iter();
    contents
        .warnings
        .extend(warnings.chain(incomplete.iter().cloned()));
    Ok(ScanReport {
        contents,
        points: placed.points,
        left_out: placed.outside,
        left_out_because: (placed.outside > 0).then(|| outside_of(alignment).to_owned()),
        clouds: None,
        sweeps: alignment
            .sweeps
            .iter()
            .map(|sweep| report::SweepReport::new(sweep, stats.rpm))
            .collect(),
        sync: sync(alignment, &request.tilt),
        output: output.display().to_string(),
        log: path.display().to_string(),
        lost_records: request.lost_records,
        lidar_gaps_s: lidar_gaps_s(first_pass),
        residuals: alignment.residuals.iter().map(Into::into).collect(),
        incomplete_sweeps: incomplete,
        reception: None,
        truth: None,
        live: None,
        georeference: first_pass.georeference.clone(),
    })
}

/// Seconds without lidar packets at the start of the first sweep and at the end of the last.
fn lidar_gaps_s(first_pass: &FirstPass) -> [f64; 2] {
    let alignment = &first_pass.alignment;
    // Sweep times refer to the host clock before its step.
    let host_was_set = alignment
        .steps
        .iter()
        .any(|step| step.clock == SetClock::Host);
    let sweeps = (alignment.sweeps.first(), alignment.sweeps.last());
    match (first_pass.data_span, sweeps) {
        (Some([first_data, last_data]), (Some(first), Some(last))) if !host_was_set => [
            (first_data.saturating_since(first.start), first),
            (last.end.saturating_since(last_data), last),
        ]
        .map(|(gap, sweep)| {
            let sweep_s = sweep.end.saturating_since(sweep.start).as_secs_f64();
            gap.as_secs_f64().min(sweep_s).max(0.0)
        }),
        _ => [0.0; 2],
    }
}

/// Gaps over 10 s are reported and skipped.
const MAX_GAP: Span = Span::from_secs(10);

fn pacer(factor: Option<f64>) -> Result<Option<Pacer>, Failure> {
    let pacer = factor.map(|factor| Pacer::new(factor, MAX_GAP));
    pacer.transpose().map_err(|error| {
        Failure::new(Kind::Usage, format!("--realtime: {error}"))
            .help("1 is as fast as it was recorded, 2 twice as fast")
    })
}

/// Waits until a record is due. Skipped gaps are logged.
fn wait_until_due(pace: &mut Pacer, record: &Record<'_>, interrupt: &AtomicBool) {
    if let Wait::Restarted(gap) = pace.wait(record.host, interrupt) {
        let (what, span) = match gap {
            Gap::Silence(span) => ("gap in the recording skipped:", span),
            Gap::Backwards(span) => ("the recording's time goes back by", span),
            Gap::Behind(span) => ("playback lags the recording by", span),
        };
        tracing::warn!("{what} {:.1} s", span.as_secs_f64());
    }
}

pub(super) fn interrupted(path: &Path) -> Failure {
    Failure::new(
        Kind::Interrupted,
        "interrupted by the user during reconstruction",
    )
    .help(format!(
        "velomotion replay {} makes the cloud",
        path.display()
    ))
}

fn sync(alignment: &Alignment, tilt: &TiltSource) -> SyncReport {
    // The accuracy of a table is not known.
    let is_table = matches!(tilt, TiltSource::Table(_));
    let speeds = alignment.sweeps.iter().map(|sweep| sweep.cruise.0.abs());
    let clock_s = alignment.clock.bound().as_secs_f64();
    let clock_bound_deg = speeds.reduce(f64::max).map(|speed| speed * clock_s);
    SyncReport {
        clock_bound_deg,
        clock_bound_mm_at_20m: clock_bound_deg.map(|deg| 20e3 * deg.to_radians()),
        clock_method: "lower envelope".to_owned(),
        clock_residual_us: alignment.clock.residual().as_micros_f64(),
        clock_bound_us: alignment.clock.bound().as_micros_f64(),
        clock_drift_ppm: alignment.clock.drift_ppm(),
        steps: alignment.steps.iter().map(StepReport::new).collect(),
        angle_method: alignment.trajectory.method().name().to_owned(),
        tolerance: alignment.choice.as_ref().map(ToleranceReport::new),
        angle_rms_deg: alignment.angle_rms_deg(),
        angle_bound_deg: alignment.angle_bound_deg().filter(|_| !is_table),
        angle_gaps: alignment.sample_gaps.count,
        longest_angle_gap_s: alignment.sample_gaps.longest.as_secs_f64(),
    }
}

/// Metadata of the cloud. Independent of file names and of the date, so that a log always gives the
/// same bytes.
fn metadata(first_pass: &FirstPass, request: &Reconstruction<'_>) -> Metadata {
    let config = &first_pass.config;
    Metadata {
        simulated: config.simulated,
        source: format!("device {}", config.device),
        software: concat!("velomotion ", env!("CARGO_PKG_VERSION")).to_owned(),
        time_reference: match request.time {
            TimeReference::Host => "Unix seconds (UTC) of the recording host's clock",
            TimeReference::Utc => "Unix seconds (UTC) from the lidar's satellite receiver",
        }
        .to_owned(),
        dual_return: first_pass.dual_return,
        sensor_frame: request.tilt == TiltSource::None,
        east_north_up: request.georeference.map(EastNorthUp::new),
        comments: match &first_pass.georeference {
            Some(georeference) => georeference.comments(),
            None => first_pass.receiver.comment().into_iter().collect(),
        },
    }
}
