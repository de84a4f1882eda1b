//! Which request an answer belongs to.
//!
//! A serial answer of the EPOS2 names neither object nor request, so it can only be told by order and shape: answers come in
//! the order of the requests, some may be lost, and a read answers four words where a write answers two. An SDO answer names
//! its object (but for segments), which tells more, yet not which of two reads of one object it belongs to. An answer that
//! fits more than one outstanding request is given to none. After a loss the client asks for an object that does not
//! exist (a marker): its error comes after whatever was still under way, and from there on both sides are in step again.
//! There are two markers with different errors, taken in turn, so that a late answer to one is not taken for the other's.
//! The live client and the listener on a log share this code, so a log pairs the way the capture did.
//! When to give up waiting is decided elsewhere.

use std::collections::VecDeque;

use protocol::epos2::CommError;
use protocol::epos2::objects::Address;
use units::{Host, Span, Stamp};

use crate::codec::{Reply, Segment};

/// Entries that no EPOS2 has, with the errors that say so: an index at the end of the manufacturer's range of CiA 301, and a
/// subindex of an object that each device has.
pub const MARKERS: [(Address, CommError); 2] = [
    (Address::new(0x5FFF, 0), CommError::NO_OBJECT),
    (Address::new(0x1018, 0xFF), CommError::NO_SUB),
];

/// What was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Access {
    /// ReadObject.
    Read,
    /// WriteObject of this value.
    Write(u32),
    /// Begins a read in segments.
    Open,
    /// The next segment of the read that was begun last.
    Segment {
        /// Alternates, beginning with `false`.
        toggle: bool,
    },
    /// Begins a write in segments.
    OpenWrite {
        /// Bytes to come.
        len: u32,
    },
    /// The next segment of the write that was begun last. Serial links do not say which is the last.
    WriteSegment(Segment),
    /// Any other command; only the listener meets them.
    Other,
}

/// A request on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub address: Address,
    pub access: Access,
    pub at: Stamp<Host>,
    /// Tells copies of one request apart; 0 is a request to another node.
    pub id: u64,
}

/// What an answer turned out to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paired {
    /// The answer to this request; requests before it will not be answered any more.
    To(Asked),
    /// The answer to a marker, the oldest with this address: all requests before it will not be answered any more.
    Marker(Address),
    /// An answer that belongs to no request, or might belong to several.
    Stray,
}

/// Requests that may still be answered, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pairing {
    outstanding: VecDeque<Asked>,
}

/// More than this many unanswered requests say nothing any more.
const MAX_OUTSTANDING: usize = 32;
/// No drive answers after this long: its own frame timeout is 500 ms.
const EXPIRY: Span = Span::from_secs(2);

impl Pairing {
    /// A request went out.
    pub fn sent(&mut self, asked: Asked) {
        self.outstanding
            .retain(|old| asked.at.saturating_since(old.at) < EXPIRY);
        if self.outstanding.len() >= MAX_OUTSTANDING {
            self.outstanding.pop_front();
        }
        self.outstanding.push_back(asked);
    }

    /// The request is executed no earlier than at this time, later than it was asked.
    pub fn restamp(&mut self, id: u64, at: Stamp<Host>) {
        if let Some(asked) = self.outstanding.iter_mut().find(|asked| asked.id == id) {
            asked.at = at;
        }
    }

    /// An answer came in.
    pub fn received(&mut self, reply: &Reply) -> Paired {
        if let Some((marker, address)) = self.marker(reply) {
            self.outstanding.drain(..=marker);
            return Paired::Marker(address);
        }
        let mut fitting = (0..)
            .zip(&self.outstanding)
            .filter(|(_, asked)| marker_error(asked).is_none() && fits(asked, reply));
        match (fitting.next(), fitting.next()) {
            (Some((index, &asked)), None) => {
                self.outstanding.drain(..=index);
                Paired::To(asked)
            }
            _ => Paired::Stray,
        }
    }

    /// The oldest marker that an error answers. Where only markers are out, an unexpected error answers the first of them.
    fn marker(&self, reply: &Reply) -> Option<(usize, Address)> {
        if reply.error.is_none() {
            return None;
        }
        let about = |asked: &Asked| reply.about.is_none_or(|about| about.fits(asked));
        let expected = |asked: &Asked| marker_error(asked) == Some(reply.error) && about(asked);
        let only_markers = || self.outstanding.iter().all(|a| marker_error(a).is_some());
        let position = self.outstanding.iter().position(expected).or_else(|| {
            only_markers()
                .then(|| self.outstanding.iter().position(about))
                .flatten()
        })?;
        let marker = self.outstanding.get(position)?;
        Some((position, marker.address))
    }

    /// Whether a read of this object is outstanding.
    pub fn awaits(&self, address: Address) -> bool {
        self.outstanding
            .iter()
            .any(|asked| asked.access == Access::Read && asked.address == address)
    }

    /// Whether nothing is outstanding.
    pub fn in_step(&self) -> bool {
        self.outstanding.is_empty()
    }
}

/// The error that answers a request, if it is a marker.
fn marker_error(asked: &Asked) -> Option<CommError> {
    MARKERS
        .iter()
        .find(|(address, _)| {
            matches!(asked.access, Access::Read | Access::Open) && asked.address == *address
        })
        .map(|(_, error)| *error)
}

/// Whether a reply has the shape of an answer to a request. An error may answer anything.
fn fits(asked: &Asked, reply: &Reply) -> bool {
    if let Some(about) = reply.about {
        return about.fits(asked) && (asked.access != Access::Read || reply.is_value());
    }
    match asked.access {
        _ if !reply.error.is_none() => true,
        Access::Read => reply.value.is_some(),
        Access::Write(_) | Access::Open | Access::OpenWrite { .. } => reply.words == 0,
        Access::Segment { .. } => reply.segment.is_some(),
        Access::WriteSegment(_) => {
            reply.words == 1
                && reply
                    .segment
                    .is_some_and(|confirmed| confirmed.bytes.is_empty())
        }
        Access::Other => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::{About, Kind};

    const READ_OK: Reply = Reply {
        error: CommError::NONE,
        words: 2,
        value: Some(7),
        segment: None,
        about: None,
    };
    const WRITE_OK: Reply = Reply {
        error: CommError::NONE,
        words: 0,
        value: None,
        segment: None,
        about: None,
    };
    const ABSENT: Reply = Reply {
        error: CommError::NO_OBJECT,
        words: 0,
        value: None,
        segment: None,
        about: None,
    };

    fn asked(id: u64, access: Access) -> Asked {
        Asked {
            address: Address::new(0x6064, 0),
            access,
            at: Stamp::from_nanos(1_000_000 * id as i64),
            id,
        }
    }

    const NO_SUB: Reply = Reply {
        error: CommError::NO_SUB,
        ..ABSENT
    };

    fn marker(id: u64, kind: usize) -> Asked {
        Asked {
            address: MARKERS[kind].0,
            ..asked(id, Access::Read)
        }
    }

    fn pairing(sent: &[Asked]) -> Pairing {
        let mut pairing = Pairing::default();
        sent.iter().for_each(|asked| pairing.sent(*asked));
        pairing
    }

    #[test]
    fn one_request_gets_its_answer() {
        let read = asked(1, Access::Read);
        let mut pairing = pairing(&[read]);
        assert_eq!(pairing.received(&READ_OK), Paired::To(read));
        assert_eq!(pairing.received(&READ_OK), Paired::Stray);
    }

    #[test]
    fn a_write_does_not_take_the_answer_to_a_read() {
        let write = asked(1, Access::Write(0));
        let mut pairing = pairing(&[write]);
        assert_eq!(pairing.received(&READ_OK), Paired::Stray);
        assert_eq!(pairing.received(&WRITE_OK), Paired::To(write));
    }

    #[test]
    fn an_answer_that_fits_two_requests_goes_to_none() {
        let mut pairing = pairing(&[asked(1, Access::Read), asked(2, Access::Read)]);
        assert_eq!(pairing.received(&READ_OK), Paired::Stray);
        assert!(!pairing.in_step());
    }

    #[test]
    fn an_answer_retires_what_was_asked_before() {
        let write = asked(2, Access::Write(0));
        let mut pairing = pairing(&[asked(1, Access::Read), write]);
        assert_eq!(pairing.received(&WRITE_OK), Paired::To(write));
        assert!(pairing.in_step());
    }

    #[test]
    fn a_late_answer_before_the_marker_is_still_told_apart() {
        let read = asked(1, Access::Read);
        let mut pairing = pairing(&[read, marker(2, 0)]);
        assert_eq!(pairing.received(&READ_OK), Paired::To(read));
        assert!(!pairing.in_step());
        assert_eq!(pairing.received(&ABSENT), Paired::Marker(MARKERS[0].0));
        assert!(pairing.in_step());
    }

    #[test]
    fn each_marker_is_answered_for_itself() {
        let sent = [asked(1, Access::Read), marker(2, 0), marker(3, 1)];
        let mut both = pairing(&sent);
        assert_eq!(both.received(&ABSENT), Paired::Marker(MARKERS[0].0));
        assert!(!both.in_step());
        assert_eq!(both.received(&NO_SUB), Paired::Marker(MARKERS[1].0));
        assert!(both.in_step());
        let mut second_only = pairing(&sent);
        assert_eq!(second_only.received(&NO_SUB), Paired::Marker(MARKERS[1].0));
        assert!(second_only.in_step());
    }

    #[test]
    fn an_unexpected_error_answers_a_marker_that_is_alone() {
        let other = Reply {
            error: CommError::GENERAL,
            ..ABSENT
        };
        let read = asked(1, Access::Read);
        assert_eq!(
            pairing(&[marker(1, 1)]).received(&other),
            Paired::Marker(MARKERS[1].0)
        );
        let mut with_read = pairing(&[read, marker(2, 1)]);
        assert_eq!(with_read.received(&other), Paired::To(read));
    }

    #[test]
    fn old_requests_are_forgotten() {
        let late = asked(3_000, Access::Read);
        let mut pairing = pairing(&[asked(1, Access::Read), late]);
        assert_eq!(pairing.received(&READ_OK), Paired::To(late));
    }

    /// An SDO answer about an object.
    fn about(sub: u8, kind: Kind, reply: Reply) -> Reply {
        let address = Some(Address::new(0x6064, sub));
        Reply {
            about: Some(About { address, kind }),
            ..reply
        }
    }

    #[test]
    fn an_sdo_answer_belongs_to_its_object_and_direction() {
        let read = asked(1, Access::Read);
        for other in [
            about(1, Kind::Upload, READ_OK),
            about(0, Kind::Download, WRITE_OK),
            about(1, Kind::Abort, ABSENT),
        ] {
            assert_eq!(pairing(&[read]).received(&other), Paired::Stray);
        }
        for own in [
            about(0, Kind::Upload, READ_OK),
            about(0, Kind::Abort, ABSENT),
        ] {
            assert_eq!(pairing(&[read]).received(&own), Paired::To(read));
        }
    }

    #[test]
    fn an_abort_of_another_object_is_no_marker() {
        let mut pairing = pairing(&[marker(1, 0)]);
        let other = about(0, Kind::Abort, ABSENT);
        assert_eq!(pairing.received(&other), Paired::Stray);
        let own = Reply {
            about: Some(About {
                address: Some(MARKERS[0].0),
                kind: Kind::Abort,
            }),
            ..ABSENT
        };
        assert_eq!(pairing.received(&own), Paired::Marker(MARKERS[0].0));
    }

    #[test]
    fn two_reads_of_one_object_are_not_told_apart_on_can_either() {
        let mut pairing = pairing(&[asked(1, Access::Read), asked(2, Access::Read)]);
        let answer = about(0, Kind::Upload, READ_OK);
        assert_eq!(pairing.received(&answer), Paired::Stray);
    }
}
