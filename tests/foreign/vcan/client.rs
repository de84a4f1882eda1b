//! The project's drive client on a bus of the kernel: it connects, homes and sweeps as a capture
//! does. Both it and `candump` log the frames.

use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use drive::{CommandOutcome, DriveClient, DriveCommand, DriveListener, Observation, ShaftSample};
use engine::capture::moves::{self as motion, SweepRequest};
use engine::config::AxisSettings;
use engine::devices::drive_port::BusLine;
use engine::devices::drive_session::Session;
use engine::devices::profile as devices;
use io::can::{CanPort as _, SocketCan};
use io::files::Overwrite;
use io::log::{LogConfig, LogWriter};
use io::port::RecordingPort;
use protocol::record::{DriveLink, Record, Wire};
use units::{DegPerS, DegPerS2, Degrees, Span};

use crate::BUS;
use crate::candump::Candump;
use crate::logs::{CANDUMP_LOG, LOG};

/// Frames of the sweep's log.
struct SweepFrames<W> {
    log: LogWriter<W>,
    listener: DriveListener,
    samples: Vec<ShaftSample>,
}

impl<W: std::io::Write> SweepFrames<W> {
    fn receive(&mut self, record: &Record<'_>) {
        self.log.write(record).unwrap();
        let Wire::Drive {
            link,
            direction,
            frame,
        } = record.wire
        else {
            return;
        };
        let samples = &mut self.samples;
        self.listener
            .observe(link, direction, frame, record.host, &mut |seen| {
                if let Observation::Sample(sample) = seen
                    && sample.drive_us.is_some()
                {
                    samples.push(sample);
                }
            });
    }
}

/// Sweeps 45 deg at 10 deg/s, sampled at 1 kHz. The logs go to the folder `out`.
pub fn sweep(out: &Path) {
    let candump = Candump::start(&out.join(CANDUMP_LOG));
    // With the brake of the repository's configuration.
    let mut axis = devices::axis(&AxisSettings {
        brake_output: Some(1),
        ..AxisSettings::default()
    })
    .unwrap();
    // An emulated machine on a busy host may pause for longer than the drive's silence limit;
    // virtual time tests that limit.
    axis.can.host_limit = Span::from_secs(2);
    axis.can.node_limit = Span::from_secs(2);
    axis.timing.timeout_moving = Span::from_secs(1);
    let sweep_request = SweepRequest {
        from: Degrees(0.0),
        to: Degrees(-45.0),
        speed: DegPerS(10.0),
        acceleration: DegPerS2(500.0),
        sweeps: 1,
        both_ways: false,
    };
    let steps = motion::steps(&sweep_request, &axis, Degrees(0.0)).unwrap();
    let gearing = axis.gearing;
    let head = LogConfig {
        metadata: String::new(),
        drive: Some(DriveLink::Can),
    };
    let received = RefCell::new(SweepFrames {
        log: LogWriter::create(out.join(LOG), &head, Overwrite::Refuse).unwrap(),
        listener: DriveListener::new(axis.node),
        samples: Vec::new(),
    });
    let line = BusLine(SocketCan::open(BUS).unwrap());
    let port = RecordingPort::new(line, DriveLink::Can, |record: &Record<'_>| {
        received.borrow_mut().receive(record);
    });
    let client = DriveClient::new(axis, DriveLink::Can);
    let mut session = Session::new(client, port, Arc::new(AtomicBool::new(false)));
    session.run(DriveCommand::Connect, &mut |_| {}).unwrap();
    session.run(DriveCommand::Home, &mut |_| {}).unwrap();
    let plan = steps[0].plan;
    let outcome = session
        .run(
            DriveCommand::Sweep(drive::MoveCommand {
                to: plan.to,
                speed: plan.speed,
                acceleration: plan.acceleration,
            }),
            &mut |_| {},
        )
        .unwrap();
    let CommandOutcome::Arrived(arrived) = outcome else {
        panic!("{outcome:?}");
    };
    assert!((arrived.angle.0 + 45.0).abs() < 0.01, "{arrived:?}");
    session.run(DriveCommand::Brake, &mut |_| {}).unwrap();
    // Answers to the last SYNCs may follow the command's end: another request brings them into the
    // log.
    session.run(DriveCommand::Status, &mut |_| {}).unwrap();
    assert_eq!(session.port().port().0.dropped(), 0);
    drop(session);
    candump.finish();
    let received = received.into_inner();
    received.log.finish().unwrap();
    let angles = received.samples.iter().map(|s| gearing.angle(s.position).0);
    let sweep = angles.filter(|a| *a < -1.0 && *a > -44.0).count();
    // 43 deg at 10 deg/s, less the samples that a busy machine misses.
    assert!(sweep > 1_000, "{sweep} samples in the sweep");
}
