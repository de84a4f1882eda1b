//! Features of a CAN bus: the stream at SYNC, NMT states, heartbeats both ways, boot-up.

use protocol::canopen::nmt::NmtCommand;
use protocol::epos2::message::SerialRequest;
use protocol::epos2::{AbortCode, DeviceError};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use super::rig::{Rig, to};
use super::test_drive::Fate;
use crate::{
    AngleSource, AxisConfig, CommandOutcome, CommandProgress, DriveCommand, DriveError,
    Observation, ShaftSample,
};
use protocol::epos2::cia402::DeviceState;

fn can() -> Rig {
    Rig::on(DriveLink::Can, AxisConfig::default())
}

fn homed() -> Rig {
    Rig::homed_on(DriveLink::Can)
}

#[test]
fn the_stream_is_sampled_at_1_khz_with_none_lost() {
    let mut rig = homed();
    let until = rig.now + Span::from_secs(60);
    let before = rig.drive.bus.syncs.len();
    rig.run(DriveCommand::Hold { until }).unwrap();
    let syncs = &rig.drive.bus.syncs[before..];
    let samples = rig.samples();
    assert!(samples.len() > 59_500, "{}", samples.len());
    assert!(
        syncs.len() - samples.len() <= 1,
        "the last frame may be in flight"
    );
    for (sample, sync) in samples.iter().zip(syncs) {
        assert_eq!(sample.request, *sync);
        assert_eq!(sample.answer - sample.request, Span::from_micros(300));
    }
}

/// Positions of a sweep from -60 to -15 deg at constant speed.
const CRUISE: std::ops::Range<i32> = -37_500..-12_500;

#[test]
fn the_stream_continues_while_the_state_is_read() {
    let mut rig = homed();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let moving: Vec<_> = rig
        .samples()
        .into_iter()
        .filter(|s| !matches!(s.position.0, -40_000 | -10_000))
        .collect();
    for pair in moving.windows(2) {
        let apart = pair[1].request - pair[0].request;
        assert!(apart <= Span::from_micros(1_001), "{apart:?}");
    }
    // 800 ms at 56.25 deg/s and 112.5 ms of ramps.
    assert!((905..=920).contains(&moving.len()), "{}", moving.len());
    // The position was not polled.
    let is_position_read = |(_, request): &(Stamp<Host>, SerialRequest)| matches!(request, SerialRequest::ReadObject(r) if r.address.index == 0x6064);
    assert!(!rig.drive.requests.iter().any(is_position_read));
}

#[test]
fn a_drive_that_refuses_the_mapping_is_polled() {
    for refused in [(0x1A00, 2), (0x1A00, 0), (0x1800, 1), (0x1800, 2)] {
        let mut rig = can();
        let (index, sub) = refused;
        rig.drive
            .on_write(index, sub, Fate::Refused(AbortCode::PDO_MAPPING));
        let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
            panic!("{:?}", rig.events.last())
        };
        assert_eq!(connected.angle, AngleSource::Polls);
        rig.run(DriveCommand::Home).unwrap();
        rig.forget();
        rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
        assert!(rig.samples().len() > 700, "{}", rig.samples().len());
    }
}

#[test]
fn a_refused_inhibit_time_keeps_the_stream() {
    let mut rig = can();
    rig.drive
        .on_write(0x1800, 3, Fate::Refused(AbortCode::PDO_MAPPING));
    let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
        panic!("{:?}", rig.events.last())
    };
    assert_eq!(connected.angle, AngleSource::Stream);
}

#[test]
fn a_drive_that_does_not_monitor_the_host_is_not_moved() {
    let mut rig = can();
    rig.drive
        .on_write(0x1016, 1, Fate::Refused(AbortCode::PDO_MAPPING));
    let Ok(CommandOutcome::Connected(connected)) = rig.run(DriveCommand::Connect) else {
        panic!("{:?}", rig.events.last())
    };
    assert!(!connected.monitors_host);
    let homing = rig.run(DriveCommand::Home);
    assert!(
        matches!(homing, Err(DriveError::HostNotMonitored)),
        "{homing:?}"
    );
}

/// It would go on if the host died.
#[test]
fn a_drive_that_keeps_its_reaction_to_a_lost_host_is_not_moved() {
    let mut rig = can();
    rig.drive.on_write(0x6007, 0, Fate::Ignored);
    let error = rig.run(DriveCommand::Connect).unwrap_err();
    assert_eq!(
        error.to_string(),
        "object 6007:00 read back: expected 0x1, got 0x3"
    );
}

#[test]
fn a_stalled_stream_is_replaced_by_polls() {
    let mut rig = homed();
    rig.drive.bus.copies = Box::new(|n| usize::from(!(300..600).contains(&n)));
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let samples = rig.samples();
    for pair in samples.windows(2) {
        let apart = pair[1].request - pair[0].request;
        assert!(apart < Span::from_millis(25), "{apart:?}");
    }
    assert!(samples.len() > 800);
}

#[test]
fn lost_and_repeated_stream_frames_do_not_affect_the_others() {
    let mut rig = homed();
    rig.drive.bus.copies = Box::new(|n| match n % 17 {
        3 => 0,
        9 => 2,
        _ => 1,
    });
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let samples = rig.samples();
    for sample in &samples {
        assert_eq!(sample.answer - sample.request, Span::from_micros(300));
    }
    let observed: Vec<ShaftSample> = rig
        .observations()
        .into_iter()
        .filter_map(|seen| match seen {
            Observation::Sample(sample) => Some(sample),
            _ => None,
        })
        .collect();
    assert!(observed.len() >= samples.len());
}

#[test]
fn logged_samples_have_the_drives_time() {
    let mut rig = homed();
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    let observed = rig.observations();
    let mut timed = 0;
    for pair in observed.windows(2) {
        if let [
            Observation::Read {
                address,
                value,
                request,
                ..
            },
            Observation::Sample(sample),
        ] = pair
        {
            assert_eq!(address.index, 0x1013);
            assert_eq!(*request, sample.request);
            let latched = sample.request + Span::from_micros(120);
            assert_eq!(*value, rig.drive.drive_us(latched));
            timed += 1;
        }
    }
    assert_eq!(timed, rig.samples().len());
}

#[test]
fn a_log_without_the_mapping_gives_no_samples() {
    let mut rig = homed();
    let until = rig.now + Span::from_millis(200);
    rig.run(DriveCommand::Hold { until }).unwrap();
    let sampled = rig
        .observations()
        .iter()
        .any(|seen| matches!(seen, Observation::Sample(_)));
    assert!(!rig.samples().is_empty() && !sampled);
}

#[test]
fn the_drive_stops_when_the_host_dies() {
    let mut rig = homed();
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(600)), None);
    assert_eq!(rig.drive.get(0x1016, 1), 127 << 16 | 500);
    // The host stops calling the client.
    let died = rig.now;
    while rig.drive.state() == DeviceState::OperationEnabled {
        rig.now += Span::from_millis(1);
        rig.drive.live(rig.now);
        assert!(rig.now - died < Span::from_millis(550));
    }
    // The ramp from 1125 rpm takes 57 ms, then the standstill and the brake.
    rig.drive.live(rig.now + Span::from_millis(150));
    assert_eq!(rig.drive.state(), DeviceState::Fault);
    assert_eq!(rig.drive.get(0x1003, 1), 0x8130);
}

#[test]
fn the_host_sends_heartbeats_until_a_stop_is_complete() {
    let mut rig = homed();
    rig.client
        .start(DriveCommand::Goto(crate::MoveCommand {
            speed: units::Rpm(300),
            ..to(45.0)
        }))
        .unwrap();
    assert_eq!(rig.run_for(Span::from_secs(2)), None);
    rig.client.start(DriveCommand::Stop).unwrap();
    let Ok(CommandOutcome::Stopped(stopped)) = rig.finish() else {
        panic!("{:?}", rig.events.last())
    };
    assert!(!stopped.fault);
}

/// A powered axis is monitored between commands, too; at rest with its power off it is not.
#[test]
fn the_host_may_be_silent_once_the_power_is_off() {
    let mut rig = homed();
    rig.run(DriveCommand::Goto(to(0.0))).unwrap();
    rig.run(DriveCommand::Brake).unwrap();
    rig.now += Span::from_secs(30);
    rig.drive.live(rig.now);
    assert_ne!(rig.drive.state(), DeviceState::Fault);
    rig.run(DriveCommand::Goto(to(10.0))).unwrap();
    rig.now += Span::from_secs(30);
    rig.drive.live(rig.now);
    assert_eq!(rig.drive.state(), DeviceState::Fault);
}

#[test]
fn a_missing_heartbeat_in_mid_sweep_stops_the_axis() {
    let mut rig = homed();
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(600)), None);
    let at = rig.now;
    rig.drive.bus.silent = true;
    let error = rig.finish().unwrap_err();
    assert!(
        matches!(error, DriveError::NodeSilent { node: 1, .. }),
        "{error}"
    );
    let reaction = rig.quick_stop().unwrap() - at;
    assert!(reaction < Span::from_millis(1_015), "{reaction:?}");
    let safe = |p: &CommandProgress| matches!(p, CommandProgress::StoppedAfterFailure(_));
    assert!(rig.progress().iter().any(safe));
}

/// The node's frames wait to be read: its emergency message is the cause.
#[test]
fn the_delay_of_a_suspended_host_is_not_a_missing_heartbeat() {
    let mut rig = homed();
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(600)), None);
    let delay = Span::from_millis(1_050);
    rig.sleep(delay);
    rig.client.handle_host_delay(delay, rig.now);
    // The host is slow, too: it writes twice before it reads.
    rig.sleep(Span::from_millis(15));
    rig.sleep(Span::from_millis(1));
    let error = rig.finish().unwrap_err();
    let monitored = DriveError::Fault {
        error: Some(DeviceError(0x8130)),
    };
    assert_eq!(error, monitored);
}

#[test]
fn a_node_stopped_by_another_master_is_reported() {
    let mut rig = homed();
    rig.client.start(DriveCommand::Sweep(to(45.0))).unwrap();
    assert_eq!(rig.run_for(Span::from_millis(600)), None);
    rig.drive.node.nmt(NmtCommand::EnterPreOperational);
    let error = rig.finish().unwrap_err();
    assert!(matches!(error, DriveError::NodeLeft { .. }), "{error}");
}

#[test]
fn a_restart_between_commands_prevents_the_next_move() {
    let mut rig = homed();
    rig.drive.restart(rig.now);
    rig.now += Span::from_millis(5);
    let error = rig.run(DriveCommand::Goto(to(0.0))).unwrap_err();
    assert!(matches!(error, DriveError::Restarted { .. }), "{error}");
    assert!(!rig.writes().iter().any(|w| w.0 == 0x607A));
}

#[test]
fn replies_about_another_object_or_of_another_node_are_ignored() {
    use protocol::canopen::NodeId;
    use protocol::canopen::sdo::{Expedited, Initiate, SdoResponse};
    use protocol::epos2::objects::Address;
    let mut rig = can();
    let answer = |index, node| {
        let transfer = Initiate::Expedited(Expedited::of(0x1234_5678_u32));
        let address = Address::new(index, 0);
        SdoResponse::InitiateUpload { address, transfer }
            .to_frame(NodeId::new(node).unwrap())
            .to_socketcan()
            .to_vec()
    };
    rig.client.start(DriveCommand::Connect).unwrap();
    for n in 0..2_000 {
        let frame = match n % 3 {
            0 => answer(0x6064, 1),
            1 => answer(0x1000, 2),
            _ => answer(0x607D, 1),
        };
        rig.client.handle_input(&frame, rig.now);
        if let Some(end) = rig.step() {
            assert!(end.is_ok(), "{end:?}");
            assert!(rig.client.link_stats().unmatched > 50);
            return;
        }
    }
    panic!("the command does not end: {:?}", rig.client);
}

#[test]
fn a_late_reply_is_not_used_for_the_next_read_of_the_same_object() {
    let mut rig = can();
    rig.drive
        .on_write(0x1A00, 0, Fate::Refused(AbortCode::PDO_MAPPING));
    rig.run(DriveCommand::Connect).unwrap();
    rig.run(DriveCommand::Home).unwrap();
    rig.forget();
    rig.drive.hand = Box::new(|n, request| match request {
        SerialRequest::ReadObject(read) if read.address.index == 0x6064 && n % 37 == 0 => {
            Fate::Late(Span::from_millis(150))
        }
        _ => Fate::Sent,
    });
    rig.run(DriveCommand::Sweep(to(-15.0))).unwrap();
    // At 37,500 qc/s, after the ramp, a reply of another time would be off by thousands.
    let moving: Vec<_> = rig
        .samples()
        .into_iter()
        .filter(|s| CRUISE.contains(&s.position.0))
        .collect();
    assert!(moving.len() > 20);
    for pair in moving.windows(2) {
        let way = f64::from(pair[1].position.0 - pair[0].position.0);
        let least = 37_500.0 * (pair[1].request - pair[0].answer).as_secs_f64() - 1.0;
        let most = 37_500.0 * (pair[1].answer - pair[0].request).as_secs_f64() + 1.0;
        assert!((least..=most).contains(&way), "{least} {way} {most}");
    }
}
