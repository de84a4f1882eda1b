//! A second client connects after the one that moved the axis has disconnected.

use std::sync::Arc;

use drive::{AxisConfig, DriveClient};
use engine::devices::drive_port::BusLine;
use engine::devices::drive_session::Session;
use io::can::Slcan;
use io::port::Port;
use protocol::canopen::slcan::Bitrate;
use protocol::record::DriveLink;
use sim::Attachment;
use units::Span;

use crate::port::VirtualPort;

/// Motion of the drive after its client disconnected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rejoined {
    /// Time for which it kept moving.
    pub went_on: Span,
    /// Whether it stopped before the next client connected.
    pub by_itself: bool,
    /// Time from the next client's connection until the axis stood with its power stage off.
    pub safe_after: Span,
}

/// Connection attempts of a restarted program before it reports failure.
const TRIES: u32 = 5;
/// Silence after which a serial line has nothing more to deliver.
const QUIET: Span = Span::from_millis(100);

/// Leaves the drive without a client for a while, then connects as a restarted program does.
pub(super) fn rejoin(
    port: &VirtualPort,
    (axis, link): (AxisConfig, DriveLink),
    attached: Attachment,
    after: Span,
) -> Rejoined {
    let mut quiet = port.clone();
    let gone = quiet.now();
    let mut went_on = Span::ZERO;
    while quiet.now() - gone < after {
        let _ = quiet.read(&mut [0; 512], Span::from_millis(1));
        if quiet.moves() {
            went_on = quiet.now() - gone;
        }
    }
    let by_itself = !quiet.moves();
    let came = quiet.now();
    let mut safe_after = None;
    for _ in 0..TRIES {
        // Answers on a serial line carry no address of their request: late ones are drained.
        while link != DriveLink::Can && quiet.read(&mut [0; 512], QUIET).unwrap().is_some() {}
        let line: Box<dyn Port> = match attached {
            Attachment::Slcan => Box::new(BusLine(
                Slcan::open(port.clone(), Bitrate::Kbit1000).unwrap(),
            )),
            Attachment::Usb | Attachment::Rs232 | Attachment::Can => Box::new(port.clone()),
        };
        let client = DriveClient::new(axis.clone(), link);
        let mut session = Session::new(client, line, Arc::default());
        let connected = session.run(drive::DriveCommand::Connect, &mut |_| {
            if !port.moves() && !port.is_powered() {
                safe_after.get_or_insert(port.now() - came);
            }
        });
        if connected.is_ok() {
            break;
        }
    }
    assert!(
        !port.moves() && !port.is_powered(),
        "connected, but the axis is not safe"
    );
    Rejoined {
        went_on,
        by_itself,
        safe_after: safe_after.unwrap_or(port.now() - came),
    }
}
