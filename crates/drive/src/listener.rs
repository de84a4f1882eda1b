//! What a log's drive records say: shaft samples, object writes and statuswords, reconstructed by looking on.
//!
//! The listener pairs answers with requests, and process data with SYNC, by the same rules as the live client, so it sees what the
//! client saw; frames that are none, answers that never came and answers to nobody lead to fewer observations, never to
//! wrong ones. USB, RS232 and CAN records give the same observations. Segmented transfers are paired but not told.

mod bus;
mod rs232;

use protocol::epos2::message::{Request, SegmentedWrite};
use protocol::epos2::usb::UsbDecoder;
use protocol::epos2::{CommError, DeviceError, Frame, FrameError};
use protocol::record::{Direction, DriveLink};
use units::{Host, Quadcounts, Stamp};

use crate::codec::{Reply, Segment};
use crate::event::{ShaftSample, Taken};
use crate::objects::{self, Address};
use crate::pairing::{Access, Asked, Paired, Pairing};
use bus::BusWatch;
use rs232::{Rs232Watch, Said};

/// Something that the traffic shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// The shaft's position was read (6064), or came at a SYNC. In the latter case an observation of the drive's own time
    /// (1013) with the same stamps goes ahead, besides [`ShaftSample::device_us`].
    Sample(ShaftSample),
    /// The statusword was read (6041).
    Statusword {
        /// Its value.
        value: u16,
        /// When it was asked for.
        request: Stamp<Host>,
        /// When the answer had been read.
        answer: Stamp<Host>,
    },
    /// Another object was read.
    Read {
        /// The object.
        address: Address,
        /// 32 bits as they came; above the object's width they are garbage.
        value: u32,
        /// When it was asked for.
        request: Stamp<Host>,
        /// When the answer had been read.
        answer: Stamp<Host>,
    },
    /// An object was written and the drive acknowledged it.
    Wrote {
        /// The object.
        address: Address,
        /// The value as sent.
        value: u32,
        /// When it was sent.
        request: Stamp<Host>,
        /// When the acknowledgement had been read.
        answer: Stamp<Host>,
    },
    /// The drive refused a request.
    Refused {
        /// The object.
        address: Address,
        /// Its reason.
        error: CommError,
        /// When it was asked.
        request: Stamp<Host>,
        /// When the refusal had been read.
        answer: Stamp<Host>,
    },
    /// The drive told of an error the moment it happened (CAN).
    Emergency {
        /// The error; [`DeviceError::NONE`] where one is over.
        error: DeviceError,
        /// When the message came.
        host: Stamp<Host>,
    },
    /// The drive has just started: its position and settings are forgotten (CAN).
    Restarted {
        /// When the message came.
        host: Stamp<Host>,
    },
    /// An answer that belongs to no request for certain, or a frame that is damaged or makes no sense in its direction.
    Noise {
        /// Which way it went.
        direction: Direction,
        /// When.
        host: Stamp<Host>,
    },
}

/// Looks on at the traffic of one node.
#[derive(Clone, Debug)]
pub struct Listener {
    node: u8,
    to_device: UsbDecoder,
    from_device: UsbDecoder,
    rs232: Rs232Watch,
    /// When the answer on RS232 was announced.
    announced: Stamp<Host>,
    bus: BusWatch,
    pairing: Pairing,
    last_id: u64,
}

impl Listener {
    /// A listener to the drive with this node id (and to requests addressed to node 0, which every unit takes for itself).
    #[must_use]
    pub fn new(node: u8) -> Self {
        Self {
            node,
            to_device: UsbDecoder::new(),
            from_device: UsbDecoder::new(),
            rs232: Rs232Watch::new(),
            announced: Stamp::from_nanos(0),
            bus: BusWatch::new(node),
            pairing: Pairing::default(),
            last_id: 0,
        }
    }

    /// Takes a record; what it completes goes to `emit`.
    pub fn observe(
        &mut self,
        link: DriveLink,
        direction: Direction,
        frame: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        match link {
            DriveLink::Usb => self.usb(direction, frame, host, emit),
            DriveLink::Rs232 => self.rs232(direction, frame, host, emit),
            DriveLink::Can => self.can(direction, frame, host, emit),
        }
    }

    fn usb(
        &mut self,
        direction: Direction,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        for &byte in bytes {
            let decoder = match direction {
                Direction::ToDevice => &mut self.to_device,
                Direction::FromDevice => &mut self.from_device,
            };
            let Some(frame) = decoder.push(byte) else {
                continue;
            };
            let seen = match direction {
                Direction::ToDevice => self.request(&frame, host),
                Direction::FromDevice => self.answer(&frame),
            };
            tell(seen, direction, host, emit);
        }
    }

    fn rs232(
        &mut self,
        direction: Direction,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        for &byte in bytes {
            let seen = match self.rs232.hear(direction, byte) {
                Said::Nothing => Seen::Nothing,
                Said::Noise => Seen::Noise,
                Said::Request(frame) => self.request(&frame, host),
                Said::Announced => {
                    self.announced = host;
                    Seen::Nothing
                }
                Said::Answer(frame) => {
                    // The words that follow take longer than the drive took over the question.
                    tell(self.answer(&frame), direction, self.announced, emit);
                    Seen::Nothing
                }
            };
            tell(seen, direction, host, emit);
        }
    }

    fn can(
        &mut self,
        direction: Direction,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        let seen = match self.bus.hear(bytes, host, emit) {
            bus::Said::Nothing => Seen::Nothing,
            bus::Said::Noise => Seen::Noise,
            bus::Said::Request(address, access) => self.asked(address, access, host),
            bus::Said::Answer(reply) => self.paired(&reply),
        };
        if let Seen::Pair(asked, reply) = &seen {
            self.bus.learn(asked, reply);
        }
        tell(seen, direction, host, emit);
    }

    fn request(&mut self, frame: &Result<Frame, FrameError>, host: Stamp<Host>) -> Seen {
        let Ok(frame) = frame else {
            return Seen::Noise;
        };
        let (node, address, access) = match Request::parse(frame) {
            Ok(Some(Request::ReadObject(read))) => (read.node, read.address, Access::Read),
            Ok(Some(Request::WriteObject(write))) => {
                (write.node, write.address, Access::Write(write.value))
            }
            Ok(Some(Request::InitiateSegmentedRead(open))) => {
                (open.node, open.address, Access::Open)
            }
            Ok(Some(Request::SegmentedRead(segment))) => (
                self.node,
                Address::default(),
                Access::Segment {
                    toggle: segment.toggle,
                },
            ),
            Ok(Some(Request::InitiateSegmentedWrite(open))) => {
                (open.node, open.address, Access::OpenWrite { len: open.len })
            }
            Ok(Some(Request::SegmentedWrite(SegmentedWrite(segment)))) => {
                let written = Segment {
                    toggle: segment.toggle,
                    last: false,
                    bytes: segment.bytes,
                };
                let access = Access::WriteSegment(written);
                (self.node, Address::default(), access)
            }
            Ok(Some(_)) => (self.node, Address::default(), Access::Other),
            Ok(None) | Err(_) => return Seen::Noise,
        };
        let ours = node == self.node || node == 0;
        if ours {
            return self.asked(address, access, host);
        }
        self.pairing.sent(Asked {
            address,
            access,
            at: host,
            id: 0,
        });
        Seen::Nothing
    }

    fn asked(&mut self, address: Address, access: Access, at: Stamp<Host>) -> Seen {
        self.last_id += 1;
        self.pairing.sent(Asked {
            address,
            access,
            at,
            id: self.last_id,
        });
        Seen::Nothing
    }

    fn answer(&mut self, frame: &Result<Frame, FrameError>) -> Seen {
        match frame.as_ref().map(Reply::parse) {
            Ok(Ok(reply)) => self.paired(&reply),
            Ok(Err(_)) | Err(_) => Seen::Noise,
        }
    }

    fn paired(&mut self, reply: &Reply) -> Seen {
        match self.pairing.received(reply) {
            Paired::To(asked) if asked.id != 0 => Seen::Pair(asked, *reply),
            Paired::To(_) | Paired::Marker(_) => Seen::Nothing,
            Paired::Stray => Seen::Noise,
        }
    }
}

fn tell(seen: Seen, direction: Direction, host: Stamp<Host>, emit: &mut impl FnMut(Observation)) {
    match seen {
        Seen::Nothing => {}
        Seen::Noise => emit(Observation::Noise { direction, host }),
        Seen::Pair(asked, reply) => {
            if let Some(observation) = observation(&asked, &reply, host) {
                emit(observation);
            }
        }
    }
}

#[expect(
    clippy::large_enum_variant,
    reason = "handed on at once, one at a time"
)]
enum Seen {
    Nothing,
    Noise,
    Pair(Asked, Reply),
}

fn observation(asked: &Asked, reply: &Reply, answer: Stamp<Host>) -> Option<Observation> {
    let (address, request) = (asked.address, asked.at);
    match asked.access {
        Access::Segment { .. } | Access::WriteSegment(_) | Access::Other => None,
        _ if !reply.error.is_none() => Some(Observation::Refused {
            address,
            error: reply.error,
            request,
            answer,
        }),
        Access::Write(value) => Some(Observation::Wrote {
            address,
            value,
            request,
            answer,
        }),
        Access::OpenWrite { .. } => None,
        Access::Read | Access::Open => {
            let given = Given {
                request,
                answer,
                taken: Taken::Asked,
                device_us: None,
            };
            Some(given.value(address, reply.value?))
        }
    }
}

/// How a value came.
#[derive(Clone, Copy, Debug)]
struct Given {
    request: Stamp<Host>,
    answer: Stamp<Host>,
    taken: Taken,
    /// The drive's time that came with it.
    device_us: Option<u32>,
}

impl Given {
    /// A value of an object as an observation.
    fn value(self, address: Address, value: u32) -> Observation {
        let (request, answer) = (self.request, self.answer);
        if address == objects::POSITION_ACTUAL.address {
            Observation::Sample(ShaftSample {
                request,
                answer,
                position: Quadcounts(objects::POSITION_ACTUAL.decode(value)),
                taken: self.taken,
                device_us: self.device_us,
            })
        } else if address == objects::STATUSWORD.address {
            Observation::Statusword {
                value: objects::STATUSWORD.decode(value),
                request,
                answer,
            }
        } else {
            Observation::Read {
                address,
                value,
                request,
                answer,
            }
        }
    }
}
