//! Captures in virtual time, stored as a daemon stores a recording: a folder with a log whose cloud
//! is still to be made.

use std::fs::File;

use daemon::scans::{LOG, Scans};
use drive::DriveError;
use engine::capture::capture_log::CaptureCounts;
use engine::capture::run::RecordingEnd;
use engine::capture_request::CaptureRequest;
use engine::devices::drive_session::SessionError;
use engine::service::scan_record::ScanState;
use io::recording::Recording;
use units::{Host, Span, Stamp};
use velomotion_tests::capture::{Captured, Rejoined, Setting};
use velomotion_tests::inject::Fault;
use velomotion_tests::port::Links;

use crate::check::Wanted;
use crate::plan::{Plan, Virtual};

/// Longest motion after the last heartbeat to a drive that monitors them: 100 ms of 1016h, then the
/// ramp.
const ALONE: Span = Span::from_millis(1_500);
/// Time within which a connecting client has the axis at rest with its power off.
const SAFE: Span = Span::from_secs(2);

/// Makes the capture of a plan and stores it in `scans`. Returns the required outcome.
pub fn make(plan: &Plan, what: Virtual, scans: &Scans) -> Result<Wanted, String> {
    let (captured, ended) = Captured::run(setting(plan, what));
    check_at_rest(plan, &captured, &ended)?;
    let request = CaptureRequest {
        speed_deg_s: plan.sweep_request.speed.0,
        name: Some(plan.name()),
        ..CaptureRequest::default()
    };
    let id = scans
        .begin(&request, true)
        .map_err(|f| f.to_string())?
        .head
        .id;
    let log = scans.place(&id).join(LOG);
    std::fs::copy(captured.log(), &log).map_err(|error| error.to_string())?;
    let mut wanted = match ended.is_ok() {
        true => required_outcome(&captured),
        false => Wanted::Less,
    };
    if let Virtual::Killed(per_mille) = what {
        let length = std::fs::metadata(&log).map_err(|error| error.to_string())?;
        let cut = length.len() * per_mille / 1_000;
        let file = File::options().write(true).open(&log);
        file.and_then(|file| file.set_len(cut))
            .map_err(|error| error.to_string())?;
        // Its record still has the state of a running capture.
        wanted = Wanted::Less;
    } else {
        done(scans, &id, ended)?;
    }
    Ok(wanted)
}

/// Required outcome by the lidar's packets. Losses before the first received packet or after the
/// sweep do not count.
fn required_outcome(captured: &Captured) -> Wanted {
    if captured.missed_packets() > 0 {
        return Wanted::Less;
    }
    if captured.lost_packets() == 0 {
        return Wanted::Whole;
    }
    match (last_packet(captured), captured.last_sweep_end()) {
        (Some(received), Some(end)) if received >= end => Wanted::Whole,
        (Some(received), Some(end)) if end - received < Span::from_millis(60) => Wanted::Any,
        _ => Wanted::Less,
    }
}

fn last_packet(captured: &Captured) -> Option<Stamp<Host>> {
    let mut recording = Recording::open(captured.log()).ok()?;
    let mut last = None;
    while let Ok(Some(record)) = recording.next_record() {
        if let protocol::record::Wire::Lidar { payload, .. } = record.wire
            && payload.len() == protocol::vlp16::DATA_LEN
        {
            last = Some(record.host);
        }
    }
    last
}

/// Ends the recording; its cloud is still to be made.
fn done(scans: &Scans, id: &str, ended: Result<(), SessionError>) -> Result<(), String> {
    let counts = CaptureCounts {
        lidar: io::udp::ListenCounts::default(),
        log: io::log::RecorderCounts::default(),
    };
    let outcome = RecordingEnd::new(ended, Ok(counts)).outcome();
    scans
        .change(id, |record| {
            record.state = ScanState::Making;
            record.recording = outcome.failure;
        })
        .map(drop)
        .map_err(|failure| failure.to_string())
}

fn setting(plan: &Plan, what: Virtual) -> Setting {
    let mut setting = Setting {
        sweep_request: plan.sweep_request,
        links: Links::usual(plan.attached, plan.seed),
        ..Setting::default()
    };
    match what {
        Virtual::Nothing => {}
        Virtual::Link(fault) => {
            setting.fault = Some((fault, plan.after));
            setting.rejoined_after = Some(Span::from_millis(200));
        }
        Virtual::Gone(after) => {
            setting.fault = Some((Fault::Unplugged, plan.after));
            setting.rejoined_after = Some(after);
        }
        Virtual::Lost(loss) => setting.packets_lost = Some(loss),
        Virtual::HostClock(by) => setting.host_set = Some((plan.after, by)),
        Virtual::LidarClock(by) => setting.lidar_set = Some((plan.after, by)),
        Virtual::Killed(_) => {}
        Virtual::Interrupted => setting.interrupt_after = Some(plan.after),
    }
    setting
}

/// Checks that the axis rests, or that the report says it may not and the next client stops it.
fn check_at_rest(
    plan: &Plan,
    captured: &Captured,
    ended: &Result<(), SessionError>,
) -> Result<(), String> {
    let Some(Rejoined {
        went_on,
        by_itself,
        safe_after,
    }) = captured.rejoined()
    else {
        return match captured.brake_is_set() {
            true => Ok(()),
            false => Err(format!("the axis is left with its power on: {ended:?}")),
        };
    };
    let printed = matches!(
        ended,
        Err(SessionError::Port(_)
            | SessionError::NotStopped(_)
            | SessionError::Drive(DriveError::NotStopped { .. }))
    );
    if went_on > Span::ZERO && !printed {
        return Err(format!(
            "the axis moved for another {went_on:?} without a report: {ended:?}"
        ));
    }
    let heartbeat = matches!(plan.attached, sim::Attachment::Slcan | sim::Attachment::Can);
    if heartbeat && went_on > ALONE {
        return Err(format!(
            "without a heartbeat the axis moved for another {went_on:?}"
        ));
    }
    // Over USB and RS232 a profile move ends at its target at the latest.
    let longest = plan.sweep_request.to.0.abs() / plan.sweep_request.speed.0 + 1.0;
    if went_on.as_secs_f64() > longest.max(HOMING_S) {
        return Err(format!(
            "the axis moved for another {went_on:?}; its move takes {longest} s"
        ));
    }
    if safe_after > SAFE {
        return Err(format!(
            "the next client had the axis at rest after {safe_after:?} (it stopped on its own: {by_itself})"
        ));
    }
    Ok(())
}

/// Longest travel to the switch and back.
const HOMING_S: f64 = 20.0;
