//! A passive decoder of drive traffic, for logs: shaft samples, object accesses and statuswords.
//!
//! It matches replies with requests, and PDOs with SYNCs, by the client's own rules, so it observes
//! what the client observed. Damaged frames, lost replies and unmatched replies lead to fewer
//! observations, never to wrong ones. USB, RS232 and CAN records give the same observations.
//! Segmented transfers are matched but not reported.

mod can;
mod rs232;

use protocol::canopen::sdo::Initiate;
use protocol::epos2::objects::{self, Address};
use protocol::epos2::usb::UsbDecoder;
use protocol::epos2::{CommError, DeviceError, SerialFrame, SerialFrameError};
use protocol::record::{Direction, DriveLink};
use units::{Host, Quadcounts, Stamp};

use crate::codec::parse_serial_request;
use crate::event::{SampleTrigger, ShaftSample};
use crate::exchange::{ObjectAccess, Reply, TransferRequest};
use crate::request_matcher::{ReplyMatch, RequestMatcher, SentRequest};
use can::{CanEvent, CanListener};
use rs232::{Rs232Event, Rs232Listener};

/// An event shown by the traffic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Observation {
    /// The position (6064) was read, or sent at a SYNC. In the second case a [`Observation::Read`]
    /// of the drive's time (1013) with the same stamps precedes it.
    Sample(ShaftSample),
    /// The statusword (6041) was read.
    Statusword {
        /// The statusword.
        value: u16,
        /// When the request was sent.
        request: Stamp<Host>,
        /// When the reply was complete.
        answer: Stamp<Host>,
    },
    /// Another object was read.
    Read {
        /// The object.
        address: Address,
        /// 32 bits as received; those above the object's width are undefined.
        value: u32,
        /// When the request was sent.
        request: Stamp<Host>,
        /// When the reply was complete.
        answer: Stamp<Host>,
    },
    /// An object was written and the drive confirmed it.
    Wrote {
        /// The object.
        address: Address,
        /// The value as sent.
        value: u32,
        /// When the request was sent.
        request: Stamp<Host>,
        /// When the confirmation was complete.
        answer: Stamp<Host>,
    },
    /// The drive refused a request.
    Refused {
        /// The object.
        address: Address,
        /// The drive's error code.
        error: CommError,
        /// When the request was sent.
        request: Stamp<Host>,
        /// When the reply was complete.
        answer: Stamp<Host>,
    },
    /// An EMCY message (CAN).
    Emergency {
        /// The error; [`DeviceError::NONE`] at the end of one.
        error: DeviceError,
        /// When the message arrived.
        host: Stamp<Host>,
    },
    /// A boot-up message (CAN): the drive lost its position and settings.
    Restarted {
        /// When the message arrived.
        host: Stamp<Host>,
    },
    /// An unmatched reply, a damaged frame, or one that is invalid in its direction.
    Noise {
        /// Direction of the frame.
        direction: Direction,
        /// When it was recorded.
        host: Stamp<Host>,
    },
}

/// Decodes the traffic of one node.
#[derive(Clone, Debug)]
pub struct DriveListener {
    node: u8,
    to_device: UsbDecoder,
    from_device: UsbDecoder,
    rs232: Rs232Listener,
    /// When the answer on RS232 was announced.
    announced: Stamp<Host>,
    can: CanListener,
    matcher: RequestMatcher,
    last_id: u64,
}

impl DriveListener {
    /// Creates a listener for the drive with this node id. It also takes requests to node 0, which
    /// every unit executes itself.
    #[must_use]
    pub fn new(node: u8) -> Self {
        Self {
            node,
            to_device: UsbDecoder::new(),
            from_device: UsbDecoder::new(),
            rs232: Rs232Listener::new(),
            announced: Stamp::from_nanos(0),
            can: CanListener::new(node),
            matcher: RequestMatcher::default(),
            last_id: 0,
        }
    }

    /// Processes a record; passes the observations it completes to `emit`.
    pub fn observe(
        &mut self,
        link: DriveLink,
        direction: Direction,
        bytes: &[u8],
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        let noise = Observation::Noise { direction, host };
        match link {
            DriveLink::Can => self.observe_can(bytes, host, noise, emit),
            DriveLink::Usb => {
                for &byte in bytes {
                    self.observe_usb(direction, byte, host, noise, emit);
                }
            }
            DriveLink::Rs232 => {
                for &byte in bytes {
                    self.observe_rs232(direction, byte, host, noise, emit);
                }
            }
        }
    }

    fn observe_usb(
        &mut self,
        direction: Direction,
        byte: u8,
        host: Stamp<Host>,
        noise: Observation,
        emit: &mut impl FnMut(Observation),
    ) {
        match direction {
            Direction::ToDevice => {
                if let Some(frame) = self.to_device.push(byte)
                    && !self.handle_request(&frame, host)
                {
                    emit(noise);
                }
            }
            Direction::FromDevice => {
                if let Some(frame) = self.from_device.push(byte) {
                    self.handle_answer(&frame, host, noise, emit);
                }
            }
        }
    }

    fn observe_rs232(
        &mut self,
        direction: Direction,
        byte: u8,
        host: Stamp<Host>,
        noise: Observation,
        emit: &mut impl FnMut(Observation),
    ) {
        match self.rs232.push(direction, byte) {
            None => {}
            Some(Rs232Event::Noise) => emit(noise),
            Some(Rs232Event::Request(frame)) => {
                let is_valid = self.handle_request(&frame, host);
                if !is_valid {
                    emit(noise);
                }
            }
            Some(Rs232Event::Announced) => self.announced = host,
            Some(Rs232Event::Answer(frame)) => {
                // The drive executed the request before it announced the answer; the words take
                // longer.
                let host = self.announced;
                let noise = Observation::Noise { direction, host };
                self.handle_answer(&frame, host, noise, emit);
            }
        }
    }

    fn observe_can(
        &mut self,
        bytes: &[u8],
        host: Stamp<Host>,
        noise: Observation,
        emit: &mut impl FnMut(Observation),
    ) {
        match self.can.observe(bytes, host, emit) {
            None => {}
            Some(CanEvent::Noise) => emit(noise),
            Some(CanEvent::Request(address, access)) => self.handle_sent(address, access, host),
            Some(CanEvent::Response(reply)) => match self.matcher.handle_reply(&reply) {
                ReplyMatch::Request(sent) => {
                    self.can.learn_mapping(&sent, &reply);
                    observation(&sent, &reply, host).into_iter().for_each(emit);
                }
                ReplyMatch::Probe(_) => {}
                ReplyMatch::Unmatched => emit(noise),
            },
        }
    }

    /// Records a request of a serial link; returns whether it is valid.
    fn handle_request(
        &mut self,
        frame: &Result<SerialFrame, SerialFrameError>,
        host: Stamp<Host>,
    ) -> bool {
        let request = frame.as_ref().ok();
        let Some((node, address, access)) =
            request.and_then(|frame| parse_serial_request(frame, self.node))
        else {
            return false;
        };
        if node == self.node || node == 0 {
            self.handle_sent(address, access, host);
        } else {
            self.matcher.handle_sent(SentRequest {
                address,
                access,
                sent: host,
                id: 0,
            });
        }
        true
    }

    fn handle_sent(&mut self, address: Address, access: ObjectAccess, sent: Stamp<Host>) {
        self.last_id += 1;
        self.matcher.handle_sent(SentRequest {
            address,
            access,
            sent,
            id: self.last_id,
        });
    }

    fn handle_answer(
        &mut self,
        frame: &Result<SerialFrame, SerialFrameError>,
        host: Stamp<Host>,
        noise: Observation,
        emit: &mut impl FnMut(Observation),
    ) {
        let Ok(Ok(reply)) = frame.as_ref().map(Reply::parse) else {
            return emit(noise);
        };
        match self.matcher.handle_reply(&reply) {
            ReplyMatch::Request(sent) if sent.id != 0 => {
                observation(&sent, &reply, host).into_iter().for_each(emit);
            }
            ReplyMatch::Request(_) | ReplyMatch::Probe(_) => {}
            ReplyMatch::Unmatched => emit(noise),
        }
    }
}

/// The observation of a request with its reply; `None` for segments and other commands.
fn observation(sent: &SentRequest, reply: &Reply, answer: Stamp<Host>) -> Option<Observation> {
    let (address, request) = (sent.address, sent.sent);
    let is_read = match sent.access {
        ObjectAccess::Read | ObjectAccess::Transfer(TransferRequest::InitiateUpload { .. }) => true,
        ObjectAccess::Write { .. } => false,
        ObjectAccess::Transfer(TransferRequest::InitiateDownload {
            transfer: Initiate::Segmented { .. },
            ..
        }) => false,
        ObjectAccess::Transfer(_) | ObjectAccess::Other => return None,
    };
    if !reply.error().is_none() {
        return Some(Observation::Refused {
            address,
            error: reply.error(),
            request,
            answer,
        });
    }
    if let ObjectAccess::Write { value, .. } = sent.access {
        return Some(Observation::Wrote {
            address,
            value,
            request,
            answer,
        });
    }
    let origin = ValueOrigin {
        request,
        answer,
        trigger: SampleTrigger::Request,
        device_us: None,
    };
    is_read
        .then(|| reply.value())
        .flatten()
        .map(|value| origin.observation(address, value))
}

/// How and when a value was obtained.
#[derive(Clone, Copy, Debug)]
struct ValueOrigin {
    request: Stamp<Host>,
    answer: Stamp<Host>,
    trigger: SampleTrigger,
    /// The drive's time in the same frame.
    device_us: Option<u32>,
}

impl ValueOrigin {
    /// The observation of an object's value.
    fn observation(self, address: Address, value: u32) -> Observation {
        let (request, answer) = (self.request, self.answer);
        if address == objects::POSITION_ACTUAL.address {
            Observation::Sample(ShaftSample {
                request,
                answer,
                position: Quadcounts(objects::POSITION_ACTUAL.decode(value)),
                trigger: self.trigger,
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
