//! `candump` of can-utils on the bus: what somebody else's program hears there.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use io::can::{CanPort as _, SocketCan};
use io::clock;
use protocol::canopen::{CanFrame, CobId};
use units::Span;

use crate::{BUS, bus};

/// Between two looks at the file.
const LOOK: Span = Span::from_millis(10);
/// Bytes of its socket's queue: it, too, loses what does not fit.
const RECEIVE_BUFFER: &str = "4194304";

/// Frames that nobody answers to, by which is seen how far `candump` is: at its beginning, and at
/// its end.
const BEGIN: u8 = b'?';
const END: u8 = b'!';

/// Whether this is one of them.
pub fn is_probe(frame: &CanFrame) -> bool {
    [BEGIN, END].map(probe).contains(frame)
}

fn probe(mark: u8) -> CanFrame {
    CanFrame::of(CobId::MAX, [mark])
}

/// A `candump` that writes a file.
pub struct Onlooker {
    process: Child,
    file: PathBuf,
    bus: SocketCan,
}

impl Onlooker {
    /// Starts it and waits until it receives frames of the bus.
    pub fn start(file: &Path) -> Self {
        let process = Command::new("candump")
            .args(["-L", "-r", RECEIVE_BUFFER, BUS])
            .stdout(File::create(file).unwrap())
            .spawn()
            .unwrap();
        let mut onlooker = Self {
            process,
            file: file.to_owned(),
            bus: SocketCan::open(BUS).unwrap(),
        };
        onlooker.send_until_heard(BEGIN);
        onlooker
    }

    /// Ends it when it has written all that was on the bus so far.
    pub fn finish(mut self) {
        self.send_until_heard(END);
        self.process.kill().unwrap();
        self.process.wait().unwrap();
    }

    /// Sends a probe again and again, until it is in the file and with it all that came before it.
    fn send_until_heard(&mut self, mark: u8) {
        let line = format!("{:X}#{mark:02X}\n", CobId::MAX.get());
        let end = clock::now() + bus::PATIENCE;
        while !fs::read_to_string(&self.file).unwrap().contains(&line) {
            assert!(clock::now() < end, "candump hears nothing");
            self.bus.write_frame(&probe(mark)).unwrap();
            // What others say is of no interest here: the read is a pause that the bus may shorten.
            self.bus.read(LOOK).unwrap();
        }
    }
}
