//! What a log's drive records say: shaft samples, object writes and statuswords, reconstructed by looking on.
//!
//! The listener pairs answers with requests by the same rules as the live client, so it sees what the client saw; frames
//! that are none, answers that never came and answers to nobody lead to fewer observations, never to wrong ones.
//! It understands USB frames; records of other links are passed over, as nothing writes them yet. Segmented transfers are paired but not told.

use protocol::epos2::message::{Answer, Request};
use protocol::epos2::usb::UsbDecoder;
use protocol::epos2::{CommError, Frame, FrameError};
use protocol::record::{Direction, DriveLink};
use units::{Host, Quadcounts, Stamp};

use crate::codec::Reply;
use crate::event::ShaftSample;
use crate::objects::{self, Address};
use crate::pairing::{Access, Asked, Paired, Pairing};

/// Something that the traffic shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observation {
    /// The shaft's position was read (6064).
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
            pairing: Pairing::default(),
            last_id: 0,
        }
    }

    /// Takes the bytes of one record (one frame, as logs are written; a part or several do no harm) that passed at `host`.
    pub fn observe(
        &mut self,
        link: DriveLink,
        direction: Direction,
        frame: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        if link != DriveLink::Usb {
            return;
        }
        for &byte in frame {
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
            match seen {
                Seen::Nothing => {}
                Seen::Noise => emit(Observation::Noise { direction, host }),
                Seen::Pair(asked, reply) => emit(observation(&asked, &reply, host)),
            }
        }
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
            Ok(Some(_)) => (self.node, Address::default(), Access::Other),
            Ok(None) | Err(_) => return Seen::Noise,
        };
        self.last_id += 1;
        let ours = node == self.node || node == 0;
        self.pairing.sent(Asked {
            address,
            access,
            at: host,
            id: if ours { self.last_id } else { 0 },
        });
        Seen::Nothing
    }

    fn answer(&mut self, frame: &Result<Frame, FrameError>) -> Seen {
        let Ok(Ok(answer)) = frame.as_ref().map(Answer::parse) else {
            return Seen::Noise;
        };
        let reply = Reply::from(&answer);
        match self.pairing.received(&reply) {
            Paired::To(asked) if asked.id != 0 && asked.access != Access::Other => {
                Seen::Pair(asked, reply)
            }
            Paired::To(_) | Paired::Marker => Seen::Nothing,
            Paired::Stray => Seen::Noise,
        }
    }
}

enum Seen {
    Nothing,
    Noise,
    Pair(Asked, Reply),
}

fn observation(asked: &Asked, reply: &Reply, answer: Stamp<Host>) -> Observation {
    let (address, request) = (asked.address, asked.at);
    if !reply.error.is_none() {
        return Observation::Refused {
            address,
            error: reply.error,
            request,
            answer,
        };
    }
    let value = match asked.access {
        Access::Write(value) => {
            return Observation::Wrote {
                address,
                value,
                request,
                answer,
            };
        }
        Access::Read | Access::Other => reply.value.unwrap_or_default(),
    };
    if address == objects::POSITION_ACTUAL.address {
        Observation::Sample(ShaftSample {
            request,
            answer,
            position: Quadcounts(objects::POSITION_ACTUAL.decode(value)),
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
