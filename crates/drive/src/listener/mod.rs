//! A passive decoder of drive traffic, for logs: shaft samples, object accesses and statuswords.
//!
//! It matches replies with requests, and PDOs with SYNCs, by the client's own rules, so it observes
//! what the client observed, without values that come late. Damaged frames, lost and unmatched
//! replies and missing records lead to fewer observations, never to wrong ones. USB, RS232 and CAN
//! records give the same observations. Segmented transfers are matched but not reported.

mod can;
mod recent_times;
mod rs232;
mod slow_polls;

use protocol::canopen::sdo::Initiate;
use protocol::epos2::objects::{self, Address};
use protocol::epos2::usb::UsbDecoder;
use protocol::epos2::{AbortCode, DeviceError, SerialFrame, SerialFrameError};
use protocol::record::{Direction, DriveLink};
use units::{Host, Quadcounts, Span, Stamp};

use crate::codec::parse_serial_request;
use crate::event::{SampleTrigger, ShaftSample};
use crate::exchange::{ObjectAccess, Reply, TransferRequest};
use crate::request_matcher::{ReplyMatch, RequestMatcher, SentRequest};
use can::{CanEvent, CanListener};
use recent_times::{LatenessThreshold, RecentTimes};
use rs232::{Rs232Listener, SerialEvent};
use slow_polls::SlowPolls;

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
        /// Time at which the request was sent.
        request: Stamp<Host>,
        /// Time at which the reply was complete.
        answer: Stamp<Host>,
    },
    /// Another object was read.
    Read {
        /// The object.
        address: Address,
        /// 32 bits as received; those above the object's width are undefined.
        value: u32,
        /// Time at which the request was sent.
        request: Stamp<Host>,
        /// Time at which the reply was complete.
        answer: Stamp<Host>,
    },
    /// An object was written. Reported with the drive's confirmation, or as soon as later traffic
    /// shows that the confirmation is not in the log.
    Wrote {
        /// The object.
        address: Address,
        /// The value as sent.
        value: u32,
        /// Time at which the request was sent.
        request: Stamp<Host>,
        /// Time at which the confirmation was complete; `None` if it is not in the log.
        answer: Option<Stamp<Host>>,
    },
    /// The drive refused a request.
    Refused {
        /// The object.
        address: Address,
        /// The drive's error code.
        error: AbortCode,
        /// Time at which the request was sent.
        request: Stamp<Host>,
        /// Time at which the reply was complete.
        answer: Stamp<Host>,
    },
    /// An EMCY message (CAN).
    Emergency {
        /// The error; [`DeviceError::NONE`] at the end of one.
        error: DeviceError,
        /// Time at which the message arrived.
        host: Stamp<Host>,
    },
    /// A boot-up message (CAN): the drive lost its position and settings.
    Restarted {
        /// Time at which the message arrived.
        host: Stamp<Host>,
    },
    /// An unmatched reply, a damaged frame, or one that is invalid in its direction.
    Noise {
        /// Direction of the frame.
        direction: Direction,
        /// Time at which it was recorded.
        host: Stamp<Host>,
    },
}

/// A position is late after 3 ms, and another value after the shortest timeout of this client: one
/// of many positions is not missed. A busy host hardly delays its links by more than it did before.
const LATE_POSITION: LatenessThreshold = LatenessThreshold {
    time: Span::from_millis(3),
    ratio: 4,
};
const LATE_VALUE: LatenessThreshold = LatenessThreshold {
    time: Span::from_millis(40),
    ..LATE_POSITION
};
/// The words of an answer on RS232 follow its announcement evenly: eleven bytes take 1 ms at
/// 115,200 baud. Beyond three times that the words may be of another answer.
const LATE_WORDS: LatenessThreshold = LatenessThreshold {
    time: Span::from_millis(3),
    ratio: 2,
};

/// Decodes the traffic of one node.
#[derive(Clone, Debug)]
pub struct DriveListener {
    node: u8,
    to_device: UsbDecoder,
    from_device: UsbDecoder,
    rs232: Rs232Listener,
    /// Time at which the answer on RS232 was announced.
    announced: Stamp<Host>,
    can: CanListener,
    matcher: RequestMatcher,
    last_id: u64,
    /// Time at which the last request, or probe request, was sent.
    last_sent: Stamp<Host>,
    /// From the last request or probe to a value.
    silences: RecentTimes,
    /// From the announcement of an answer on RS232 to its last word.
    words: RecentTimes,
    /// Shortest time between a request and its reply so far.
    shortest_reply: Option<Span>,
    slow_polls: SlowPolls,
}

impl DriveListener {
    /// Creates a listener for the drive with this node id. It also takes requests to node 0, which
    /// every drive executes itself.
    #[must_use]
    pub fn new(node: u8) -> Self {
        Self {
            node,
            to_device: UsbDecoder::new(),
            from_device: UsbDecoder::new(),
            rs232: Rs232Listener::default(),
            announced: Stamp::from_nanos(0),
            can: CanListener::new(node),
            matcher: RequestMatcher::default(),
            last_id: 0,
            last_sent: Stamp::from_nanos(0),
            silences: RecentTimes::default(),
            words: RecentTimes::default(),
            shortest_reply: None,
            slow_polls: SlowPolls::default(),
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
        if link == DriveLink::Can {
            return self.observe_can(bytes, host, noise, emit);
        }
        for &byte in bytes {
            let event = match (link, direction) {
                (DriveLink::Rs232, _) => self.rs232.push(direction, byte),
                (_, Direction::ToDrive) => self.to_device.push(byte).map(SerialEvent::Request),
                (_, Direction::FromDrive) => self.from_device.push(byte).map(SerialEvent::Answer),
            };
            match event {
                None => {}
                Some(SerialEvent::Noise) => emit(noise),
                Some(SerialEvent::Request(frame)) => {
                    // A reply that is cut before its end would be completed by the next one's first
                    // byte, at a wrong time.
                    self.from_device.reset();
                    self.handle_request(&frame, host, noise, emit);
                }
                Some(SerialEvent::Announced) => self.announced = host,
                Some(SerialEvent::Answer(frame)) => {
                    // On RS232 the drive executed the request before it announced the answer; the
                    // words take longer.
                    let executed = match link {
                        DriveLink::Rs232 => self.announced,
                        _ => host,
                    };
                    self.handle_answer(&frame, executed, host, emit);
                }
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
            Some(CanEvent::Request(address, access)) => {
                self.handle_sent(self.node, address, access, host, emit);
            }
            Some(CanEvent::Response(reply)) => match self.matched(&reply, host, emit) {
                ReplyMatch::Request(sent) => {
                    self.can.learn_mapping(&sent, &reply);
                    self.report(&sent, &reply, host, emit);
                }
                ReplyMatch::Probe(_) => {}
                ReplyMatch::Unmatched => emit(noise),
            },
        }
    }

    /// Records a request of a serial link; an invalid one is noise.
    fn handle_request(
        &mut self,
        frame: &Result<SerialFrame, SerialFrameError>,
        host: Stamp<Host>,
        noise: Observation,
        emit: &mut impl FnMut(Observation),
    ) {
        let request = frame.as_ref().ok();
        let Some((node, address, access)) =
            request.and_then(|frame| parse_serial_request(frame, self.node))
        else {
            return emit(noise);
        };
        self.handle_sent(node, address, access, host, emit);
    }

    /// Matches a reply; reports the writes before it that have none.
    fn matched(
        &mut self,
        reply: &Reply,
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) -> ReplyMatch {
        if let Some([older, newer]) = self.matcher.newest_fitting(reply) {
            if self.slow_polls.is_of_newer([&older, &newer], reply, host) {
                self.matcher.retire_through(older.id);
            } else {
                self.slow_polls.note_unmatched(&newer, host);
            }
        }
        let matched = self.matcher.handle_reply(reply);
        self.report_lost_writes(emit);
        matched
    }

    /// Whether a value that was complete at `host` came later than usual after the last request or
    /// probe, or after the drive announced it.
    fn is_late(&mut self, sent: &SentRequest, executed: Stamp<Host>, host: Stamp<Host>) -> bool {
        let silence = host.saturating_since(self.last_sent);
        let words = host.saturating_since(executed);
        let limit = match sent.address == objects::POSITION_ACTUAL.address {
            true => LATE_POSITION,
            false => LATE_VALUE,
        };
        self.silences.is_late(silence, limit) | self.words.is_late(words, LATE_WORDS)
    }

    fn report_lost_writes(&mut self, emit: &mut impl FnMut(Observation)) {
        while let Some(sent) = self.matcher.take_lost_write() {
            if let (ObjectAccess::Write { value, .. }, true) = (sent.access, sent.id != 0) {
                emit(Observation::Wrote {
                    address: sent.address,
                    value,
                    request: sent.sent,
                    answer: None,
                });
            }
        }
    }

    /// Records a request; one to another node has the id 0.
    fn handle_sent(
        &mut self,
        node: u8,
        address: Address,
        access: ObjectAccess,
        sent: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        let is_own = node == self.node || node == 0;
        self.last_sent = sent;
        self.last_id += u64::from(is_own);
        let request = SentRequest {
            address,
            access,
            sent,
            id: if is_own { self.last_id } else { 0 },
        };
        // A recorder may have dropped a reply. A stop does not wait for the reply under way.
        if let Some(shortest) = self.shortest_reply
            && address != objects::CONTROLWORD.address
        {
            self.matcher.retire_answered(&request, shortest);
            if let Some(settled) = self.slow_polls.settled(sent) {
                self.matcher.retire_through(settled);
            }
            self.report_lost_writes(emit);
        }
        self.matcher.handle_sent(request);
    }

    /// Reports a request with its reply.
    fn report(
        &mut self,
        sent: &SentRequest,
        reply: &Reply,
        answer: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        let time = answer.saturating_since(sent.sent);
        let shortest = self.shortest_reply.unwrap_or(time);
        self.shortest_reply = Some(shortest.min(time));
        let seen = observation(sent, reply, answer);
        self.slow_polls.learn(seen.as_ref(), time);
        seen.into_iter().for_each(emit);
    }

    fn handle_answer(
        &mut self,
        frame: &Result<SerialFrame, SerialFrameError>,
        executed: Stamp<Host>,
        host: Stamp<Host>,
        emit: &mut impl FnMut(Observation),
    ) {
        let noise = Observation::Noise {
            direction: Direction::FromDrive,
            host,
        };
        let Ok(Ok(reply)) = frame.as_ref().map(Reply::parse) else {
            return emit(noise);
        };
        match self.matched(&reply, executed, emit) {
            // The log may lack records in between; the value may be of another request.
            ReplyMatch::Request(sent)
                if reply.value().is_some() && self.is_late(&sent, executed, host) =>
            {
                emit(noise);
            }
            ReplyMatch::Request(sent) if sent.id != 0 => {
                self.report(&sent, &reply, executed, emit);
            }
            ReplyMatch::Request(_) | ReplyMatch::Probe(_) => {}
            ReplyMatch::Unmatched => emit(noise),
        }
    }
}

/// The observation of a request with its reply; `None` for segments and other commands.
fn observation(sent: &SentRequest, reply: &Reply, answer: Stamp<Host>) -> Option<Observation> {
    let (address, request) = (sent.address, sent.sent);
    match sent.access {
        ObjectAccess::Read
        | ObjectAccess::Write { .. }
        | ObjectAccess::Transfer(
            TransferRequest::InitiateUpload { .. }
            | TransferRequest::InitiateDownload {
                transfer: Initiate::Segmented { .. },
                ..
            },
        ) => {}
        ObjectAccess::Transfer(_) | ObjectAccess::Other => return None,
    }
    if !reply.error().is_none() {
        return Some(Observation::Refused {
            address,
            error: reply.error(),
            request,
            answer,
        });
    }
    match sent.access {
        ObjectAccess::Write { value, .. } => {
            return Some(Observation::Wrote {
                address,
                value,
                request,
                answer: Some(answer),
            });
        }
        ObjectAccess::Transfer(TransferRequest::InitiateDownload { .. }) => return None,
        _ => {}
    }
    let origin = ValueOrigin {
        request,
        answer,
        trigger: SampleTrigger::Request,
        drive_us: None,
    };
    Some(origin.observation(address, reply.value()?))
}

/// Source and times of a value.
#[derive(Clone, Copy, Debug)]
struct ValueOrigin {
    request: Stamp<Host>,
    answer: Stamp<Host>,
    trigger: SampleTrigger,
    /// The drive's time in the same frame.
    drive_us: Option<u32>,
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
                drive_us: self.drive_us,
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
