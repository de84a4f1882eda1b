//! A small CANopen master on an interface of the kernel. It runs one SDO transfer after the other
//! and keeps all other frames with the kernel's time.
//!
//! It shares nothing with the project's drive client, so its assertions are about the bus and the
//! node.

use io::can::{CanPort, SocketCan};
use io::clock;
use protocol::canopen::sdo::{FrameDisposition, SdoClient, SdoValue, TransferError};
use protocol::canopen::{CanFrame, NodeId};
use protocol::epos2::objects::{Address, Scalar, TypedObject};
use units::{Host, Span, Stamp};

/// Time limit of an answer and of a command's effect: an emulated machine on a busy host is slow.
pub const TIME_LIMIT: Span = Span::from_secs(5);
/// The longest object read here has 8 bytes.
type Sdo = SdoClient<16>;

/// A frame other than an SDO answer, with the kernel's receive time.
pub type ReceivedFrame = (CanFrame, Stamp<Host>);

/// Master of one node.
pub struct Master {
    bus: SocketCan,
    sdo: Sdo,
    received: Vec<ReceivedFrame>,
}

impl Master {
    /// Opens a master on an interface that is up. It receives frames sent from now on.
    pub fn open(interface: &str, node: NodeId) -> Self {
        Self {
            bus: SocketCan::open(interface).unwrap(),
            sdo: Sdo::new(node, TIME_LIMIT),
            received: Vec::new(),
        }
    }

    /// Sends a frame. Returns the time just before.
    pub fn send(&mut self, frame: &CanFrame) -> Stamp<Host> {
        self.bus.write_frame(frame).unwrap()
    }

    /// Receives frames until `end`, at least those already queued.
    pub fn listen(&mut self, end: Stamp<Host>) {
        loop {
            let left = end.saturating_since(clock::now());
            match self.bus.read(left).unwrap() {
                Some(received) => self.received.push(received),
                None => return,
            }
        }
    }

    /// Takes the frames received so far.
    pub fn take_received(&mut self) -> Vec<ReceivedFrame> {
        std::mem::take(&mut self.received)
    }

    /// Waits for a frame that `pick` accepts and drops those before it.
    pub fn wait_for<T>(&mut self, what: &str, pick: impl Fn(&ReceivedFrame) -> Option<T>) -> T {
        let end = clock::now() + TIME_LIMIT;
        while clock::now() < end {
            while !self.received.is_empty() {
                if let Some(found) = pick(&self.received.remove(0)) {
                    return found;
                }
            }
            let left = end.saturating_since(clock::now());
            self.received.extend(self.bus.read(left).unwrap());
        }
        panic!("waited {TIME_LIMIT:?} for {what}");
    }

    /// Reads objects until `done`.
    pub fn poll(&mut self, what: &str, mut done: impl FnMut(&mut Self) -> bool) {
        let end = clock::now() + TIME_LIMIT;
        while !done(self) {
            assert!(clock::now() < end, "waited {TIME_LIMIT:?} for {what}");
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

    /// Completes the transfer under way.
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
                Some(received) => match self.sdo.handle_frame(&received.0) {
                    FrameDisposition::Accepted => {}
                    FrameDisposition::Foreign => self.received.push(received),
                    other => panic!("{other:?}: {}", received.0),
                },
                None => self.sdo.handle_timeout(clock::now()),
            }
        }
    }
}
