//! `candump` of can-utils on the bus.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use io::can::{CanPort as _, SocketCan};
use io::clock;
use protocol::canopen::{CanFrame, CobId};
use units::Span;

use crate::{BUS, bus};

/// Interval between reads of the file.
const LOOK: Span = Span::from_millis(10);
/// Bytes of its socket's queue; `candump` loses frames that do not fit.
const RECEIVE_BUFFER: &str = "4194304";

/// Frames without an answer, which mark the progress of `candump` in the file: at its beginning and
/// at its end.
const BEGIN: u8 = b'?';
const END: u8 = b'!';

/// Whether the frame is such a mark.
pub fn is_probe(frame: &CanFrame) -> bool {
    [BEGIN, END].map(probe).contains(frame)
}

fn probe(mark: u8) -> CanFrame {
    CanFrame::of(CobId::MAX, [mark])
}

/// A `candump` that writes a file.
pub struct Candump {
    process: Child,
    file: PathBuf,
    bus: SocketCan,
}

impl Candump {
    /// Starts it and waits until it receives frames.
    pub fn start(file: &Path) -> Self {
        let process = Command::new("candump")
            .args(["-L", "-r", RECEIVE_BUFFER, BUS])
            .stdout(File::create(file).unwrap())
            .spawn()
            .unwrap();
        let mut candump = Self {
            process,
            file: file.to_owned(),
            bus: SocketCan::open(BUS).unwrap(),
        };
        candump.send_until_received(BEGIN);
        candump
    }

    /// Ends it once it has written all frames sent so far.
    pub fn finish(mut self) {
        self.send_until_received(END);
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }

    /// Sends a mark repeatedly until the file holds it, and with it all earlier frames.
    fn send_until_received(&mut self, mark: u8) {
        let line = format!("{:X}#{mark:02X}\n", CobId::MAX.get());
        let end = clock::now() + bus::TIME_LIMIT;
        while !fs::read_to_string(&self.file).unwrap().contains(&line) {
            assert!(clock::now() < end, "candump receives nothing");
            self.bus.write_frame(&probe(mark)).unwrap();
            // Received frames do not matter here: the read is a pause that traffic may shorten.
            self.bus.read(LOOK).unwrap();
        }
    }
}
