//! The project's own client of the drive on a bus of the kernel: connects, homes and sweeps as a capture does.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use drive::{Client, Command, Listener, Observation, Outcome, ShaftSample};
use io::can::SocketCan;
use io::port::Recorder;
use protocol::canopen::{CanFrame, CobId};
use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{DegPerS, DegPerS2, Degrees};
use velomotion::config::Axis;
use velomotion::devices;
use velomotion::motion::{self, Wish};
use velomotion::ports::BusLine;
use velomotion::session::Session;

use crate::BUS;

/// What a log of the sweep would tell.
struct Heard {
    listener: Listener,
    beats: u64,
    samples: Vec<ShaftSample>,
}

impl Heard {
    fn hear(&mut self, record: &Record<'_>) {
        let Wire::Drive {
            link,
            direction,
            frame,
        } = record.wire
        else {
            return;
        };
        let is_sync =
            CanFrame::from_socketcan(frame).is_ok_and(|frame| frame.cob_id() == Some(CobId::SYNC));
        self.beats += u64::from(is_sync && direction == Direction::ToDevice);
        let samples = &mut self.samples;
        self.listener
            .observe(link, direction, frame, record.host, &mut |seen| {
                if let Observation::Sample(sample) = seen
                    && sample.device_us.is_some()
                {
                    samples.push(sample);
                }
            });
    }
}

/// 45 degrees at 30 deg/s, sampled at 1 kHz.
pub fn sweep() {
    let axis = devices::axis(&Axis::default()).unwrap();
    let wish = Wish {
        from: Degrees(0.0),
        to: Degrees(-45.0),
        speed: DegPerS(30.0),
        acceleration: DegPerS2(500.0),
        sweeps: 1,
        both_ways: false,
    };
    let steps = motion::steps(&wish, &axis, Degrees(0.0)).unwrap();
    let gearing = axis.gearing;
    let heard = RefCell::new(Heard {
        listener: Listener::new(axis.node),
        beats: 0,
        samples: Vec::new(),
    });
    let line = BusLine(SocketCan::open(BUS).unwrap());
    let port = Recorder::new(line, DriveLink::Can, |record: &Record<'_>| {
        heard.borrow_mut().hear(record);
    });
    let client = Client::with_link(axis, DriveLink::Can);
    let mut session = Session::new(client, port, Arc::new(AtomicBool::new(false)));
    session.run(Command::Connect, &mut |_| {}).unwrap();
    session.run(Command::Home, &mut |_| {}).unwrap();
    let plan = steps[0].plan;
    let outcome = session
        .run(
            Command::Sweep(drive::Move {
                to: plan.to,
                speed: plan.speed,
                acceleration: plan.acceleration,
            }),
            &mut |_| {},
        )
        .unwrap();
    let Outcome::Arrived(arrived) = outcome else {
        panic!("{outcome:?}");
    };
    assert!((arrived.angle.0 + 45.0).abs() < 0.01, "{arrived:?}");
    session.run(Command::Brake, &mut |_| {}).unwrap();
    let dropped = session.port().port().0.dropped();
    drop(session);
    let heard = heard.into_inner();
    let lost = heard.beats - heard.samples.len() as u64;
    println!(
        "{} SYNCs, {} samples, {lost} lost, {dropped} dropped by the kernel",
        heard.beats,
        heard.samples.len()
    );
    // Before a SYNC is known to be answered alone the stream's beats cannot be told apart: some of the first go unpaired.
    assert_eq!(dropped, 0);
    assert!(lost <= 3 + heard.beats / 100, "{lost} of {}", heard.beats);
    let angles: Vec<f64> = heard
        .samples
        .iter()
        .map(|s| gearing.angle(s.position).0)
        .collect();
    let sweep = angles.iter().filter(|a| **a < -1.0 && **a > -44.0).count();
    // 43 degrees at 30 deg/s.
    assert!(sweep > 1_000, "{sweep} samples in the sweep");
}
