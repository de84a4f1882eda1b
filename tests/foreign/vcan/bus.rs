//! A small CANopen master on an interface of the kernel. It runs one SDO transfer after the other
//! and keeps all other frames with the kernel's time.
//!
//! It shares nothing with the project's drive client, so its assertions are about the bus and the
//! node.

use io::can::{CanPort, SocketCan};
use io::clock;
use protocol::BoundedVec;
use protocol::canopen::sdo::{
    Expedited, SEGMENT_LEN, SdoRequest, SdoResponse, SdoTransfer, TransferError, TransferStep,
};
use protocol::canopen::{CanFrame, CommunicationObject, NodeId};
use protocol::epos2::objects::{Address, Scalar, TypedObject};
use units::{Host, Span, Stamp};

/// Time limit of an answer and of a command's effect: an emulated machine on a busy host is slow.
pub const TIME_LIMIT: Span = Span::from_secs(5);
/// The longest object read here has 8 bytes.
const MAX_OBJECT: usize = 16;
type Transfer = SdoTransfer<MAX_OBJECT>;
type ObjectData = BoundedVec<u8, MAX_OBJECT>;

/// A frame other than an SDO answer, with the kernel's receive time.
pub type ReceivedFrame = (CanFrame, Stamp<Host>);

/// Master of one node.
pub struct Master {
    bus: SocketCan,
    node: NodeId,
    received: Vec<ReceivedFrame>,
}

impl Master {
    /// Opens a master on an interface that is up. It receives frames sent from now on.
    pub fn open(interface: &str, node: NodeId) -> Self {
        Self {
            bus: SocketCan::open(interface).unwrap(),
            node,
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
        let bytes = self
            .read_raw(object.address)
            .unwrap_or_else(|error| panic!("{object:?}: {error}"));
        let width = usize::from(T::BYTES);
        assert_eq!(bytes.len(), width, "{object:?}");
        let value = Expedited::new(&bytes).expect("one to four bytes");
        T::from_raw(value.to_u32())
    }

    /// Reads an object of any length.
    pub fn read_raw(&mut self, address: Address) -> Result<ObjectData, TransferError> {
        self.run(Transfer::upload(address))
    }

    /// Writes an object of up to four bytes.
    pub fn write<T: Scalar>(&mut self, object: TypedObject<T>, value: T) {
        self.write_raw(object.address, Expedited::of(value).as_slice())
            .unwrap_or_else(|error| panic!("{object:?}: {error}"));
    }

    /// Writes bytes to an object.
    pub fn write_raw(&mut self, address: Address, bytes: &[u8]) -> Result<(), TransferError> {
        self.run(Transfer::download(address, bytes, SEGMENT_LEN)?)
            .map(drop)
    }

    /// Runs a transfer. After an error that the node did not report, the node gets an abort.
    fn run(
        &mut self,
        (mut transfer, mut request): (Transfer, SdoRequest),
    ) -> Result<ObjectData, TransferError> {
        let address = transfer.address();
        loop {
            self.send(&request.to_frame(self.node));
            match transfer.handle_response(&self.response()) {
                Ok(TransferStep::Send(next)) => request = next,
                Ok(TransferStep::Done(data)) => return Ok(data),
                Err(error) => {
                    if let Some(code) = error.abort_code() {
                        let abort = SdoRequest::Abort {
                            address,
                            error: code,
                        };
                        self.send(&abort.to_frame(self.node));
                    }
                    return Err(error);
                }
            }
        }
    }

    /// The node's next SDO response. Other frames are kept.
    fn response(&mut self) -> SdoResponse {
        let channel = CommunicationObject::SdoResponse(self.node).cob_id();
        let end = clock::now() + TIME_LIMIT;
        loop {
            let left = end.saturating_since(clock::now());
            let received = self.bus.read(left).unwrap().expect("an SDO response");
            if received.0.cob_id() == Some(channel) {
                return SdoResponse::parse(&received.0).unwrap().1;
            }
            self.received.push(received);
        }
    }
}
