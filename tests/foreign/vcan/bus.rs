//! A CANopen master of few lines on an interface of the kernel: SDO transfers one after the other,
//! and all else that is heard kept with the kernel's time.
//!
//! It is not the project's own client of the drive: what it asserts it asserts about the bus and
//! the node.

use io::can::{CanPort, SocketCan};
use io::clock;
use protocol::canopen::sdo::{FrameDisposition, SdoClient, SdoValue, TransferError};
use protocol::canopen::{CanFrame, NodeId};
use protocol::epos2::objects::{Address, Scalar, TypedObject};
use units::{Host, Span, Stamp};

/// For an answer, and for what a command brings about: an emulated machine on a busy host is slow.
pub const PATIENCE: Span = Span::from_secs(5);
/// The longest object read here has 8 bytes.
type Sdo = SdoClient<16>;

/// A frame that was no answer to an SDO request, and when the kernel got it.
pub type Heard = (CanFrame, Stamp<Host>);

/// The master of one node.
pub struct Master {
    bus: SocketCan,
    sdo: Sdo,
    heard: Vec<Heard>,
}

impl Master {
    /// A master on an interface that is up. It hears what is sent from now on.
    pub fn open(interface: &str, node: NodeId) -> Self {
        Self {
            bus: SocketCan::open(interface).unwrap(),
            sdo: Sdo::new(node, PATIENCE),
            heard: Vec::new(),
        }
    }

    /// Sends a frame; the time just before.
    pub fn send(&mut self, frame: &CanFrame) -> Stamp<Host> {
        self.bus.write_frame(frame).unwrap()
    }

    /// Listens until `end`, at least to what is there already.
    pub fn listen(&mut self, end: Stamp<Host>) {
        loop {
            let left = end.saturating_since(clock::now());
            match self.bus.read(left).unwrap() {
                Some(heard) => self.heard.push(heard),
                None => return,
            }
        }
    }

    /// Takes the frames heard so far.
    pub fn take_heard(&mut self) -> Vec<Heard> {
        std::mem::take(&mut self.heard)
    }

    /// Waits for a frame that `pick` wants; those before it are dropped.
    pub fn wait_for<T>(&mut self, what: &str, pick: impl Fn(&Heard) -> Option<T>) -> T {
        let end = clock::now() + PATIENCE;
        while clock::now() < end {
            while !self.heard.is_empty() {
                if let Some(found) = pick(&self.heard.remove(0)) {
                    return found;
                }
            }
            let left = end.saturating_since(clock::now());
            self.heard.extend(self.bus.read(left).unwrap());
        }
        panic!("waited {PATIENCE:?} for {what}");
    }

    /// Reads objects until `done`.
    pub fn poll(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let end = clock::now() + PATIENCE;
        while !done(self) {
            assert!(clock::now() < end, "waited {PATIENCE:?} for {what}");
        }
    }

    /// Reads an object of up to four bytes.
    pub fn read<T: Scalar>(&mut self, object: TypedObject<T>) -> T {
        let value = self.read_raw(object.address);
        value
            .and_then(|value| value.scalar())
            .unwrap_or_else(|error| panic!("{object:?}: {error}"))
    }

    /// Reads an object of any length.
    pub fn read_raw(&mut self, address: Address) -> Result<SdoValue<16>, TransferError> {
        self.sdo.read(address).unwrap();
        self.transfer()
    }

    /// Writes an object of up to four bytes.
    pub fn write<T: Scalar>(&mut self, object: TypedObject<T>, value: T) {
        self.sdo.write_scalar(object.address, value).unwrap();
        self.transfer()
            .unwrap_or_else(|error| panic!("{object:?}: {error}"));
    }

    /// Writes bytes to an object.
    pub fn write_raw(&mut self, address: Address, bytes: &[u8]) -> Result<(), TransferError> {
        self.sdo.write(address, bytes).unwrap();
        self.transfer().map(drop)
    }

    /// Brings the transfer that was begun to its end.
    fn transfer(&mut self) -> Result<SdoValue<16>, TransferError> {
        loop {
            while let Some(frame) = self.sdo.poll_transmit(clock::now()) {
                self.send(&frame);
            }
            if let Some(outcome) = self.sdo.poll_outcome() {
                return outcome.result;
            }
            let left = self
                .sdo
                .poll_timeout()
                .map_or(Span::ZERO, |end| end.saturating_since(clock::now()));
            match self.bus.read(left).unwrap() {
                Some(heard) => match self.sdo.handle_frame(&heard.0) {
                    FrameDisposition::Accepted => {}
                    FrameDisposition::Foreign => self.heard.push(heard),
                    other => panic!("{other:?}: {}", heard.0),
                },
                None => self.sdo.handle_timeout(clock::now()),
            }
        }
    }
}
