//! The client with scripted responses, with a complete server, and with noise.

extern crate std;
mod both_ends;

use std::vec;
use std::vec::Vec;

use units::{Host, Span, Stamp};

use super::*;
use crate::canopen::AbortCode;
use crate::canopen::tests as objects;
use crate::canopen::{Address, Scalar};
use crate::canopen::{CanFrame, MessageError, NodeId};

const CAPACITY: usize = 40;
type Client = SdoClient<CAPACITY>;

const NAME: Address = Address::new(0x1008, 0);
const STATUS: Address = objects::STATUSWORD.address;
const POSITION: Address = objects::POSITION_ACTUAL.address;

fn node() -> NodeId {
    NodeId::new(1).unwrap()
}

fn at(ms: i64) -> Stamp<Host> {
    Stamp::from_nanos(ms * 1_000_000)
}

fn client() -> Client {
    SdoClient::new(node(), Span::from_millis(50))
}

fn expedited(address: Address, data: &[u8]) -> SdoResponse {
    let transfer = Initiate::Expedited(Expedited::new(data).unwrap());
    SdoResponse::InitiateUpload { address, transfer }
}

fn sized(address: Address, size: u32) -> SdoResponse {
    let transfer = Initiate::Segmented { size: Some(size) };
    SdoResponse::InitiateUpload { address, transfer }
}

fn part(toggle: bool, last: bool, bytes: &[u8]) -> SdoResponse {
    SdoResponse::UploadSegment(SdoSegment {
        toggle,
        last,
        bytes: crate::Bounded::from_slice(bytes).unwrap(),
    })
}

/// The client's next requests.
fn sent(client: &mut Client, now: Stamp<Host>) -> Vec<SdoRequest> {
    core::iter::from_fn(|| client.poll_transmit(now))
        .map(|frame| SdoRequest::parse(&frame).unwrap().1)
        .collect()
}

fn receive(client: &mut Client, answer: SdoResponse) -> FrameDisposition {
    client.handle_frame(&answer.to_frame(node()))
}

/// Plays a read with one response per request; returns the outcome and the client's last requests.
fn play(address: Address, answers: &[SdoResponse]) -> (SdoOutcome<CAPACITY>, Vec<SdoRequest>) {
    let mut client = client();
    client.read(address).unwrap();
    for answer in answers {
        assert_eq!(sent(&mut client, at(0)).len(), 1);
        assert_eq!(receive(&mut client, *answer), FrameDisposition::Accepted);
    }
    let outcome = client.poll_outcome().expect("the transfer has ended");
    assert_eq!((client.is_busy(), client.poll_timeout()), (false, None));
    (outcome, sent(&mut client, at(0)))
}

fn failure(address: Address, answers: &[SdoResponse]) -> (TransferError, Option<AbortCode>) {
    let (outcome, last) = play(address, answers);
    let abort = match last.as_slice() {
        [] => None,
        [
            SdoRequest::Abort {
                address: about,
                error,
            },
        ] => {
            assert_eq!(*about, address);
            Some(*error)
        }
        other => panic!("{other:?}"),
    };
    (outcome.result.unwrap_err(), abort)
}

#[test]
fn expedited_reads_complete() {
    let (outcome, last) = play(STATUS, &[expedited(STATUS, &[0x40, 0x01])]);
    let value = outcome.result.unwrap();
    assert_eq!(
        (outcome.address, outcome.direction),
        (STATUS, TransferDirection::Upload)
    );
    assert_eq!(value.scalar::<u16>(), Ok(0x0140));
    assert!(value.sized && last.is_empty());
    // The object's length differs from its type.
    let (expected, got) = (4, 2);
    assert_eq!(
        value.scalar::<i32>(),
        Err(TransferError::Size { expected, got })
    );
    assert_eq!(
        value.scalar::<u8>(),
        Err(TransferError::Size {
            expected: 1,
            got: 2
        })
    );
}

#[test]
fn unsized_answers_have_four_bytes_truncated_to_the_type() {
    let transfer = Initiate::Unsized([0xFE, 0xFF, 0xAA, 0xBB]);
    let answer = SdoResponse::InitiateUpload {
        address: STATUS,
        transfer,
    };
    let value = play(STATUS, &[answer]).0.result.unwrap();
    assert!(!value.sized);
    assert_eq!(value.scalar::<i16>(), Ok(-2));
    assert_eq!(value.bytes.as_slice(), [0xFE, 0xFF, 0xAA, 0xBB]);
}

#[test]
fn segmented_reads_complete() {
    let answers = [sized(NAME, 5), part(false, true, b"EPOS2")];
    let (outcome, _) = play(NAME, &answers);
    assert_eq!(outcome.result.unwrap().bytes.as_slice(), b"EPOS2");
    // Without a size, in two segments.
    let unsized_ = SdoResponse::InitiateUpload {
        address: NAME,
        transfer: Initiate::Segmented { size: None },
    };
    let answers = [
        unsized_,
        part(false, false, b"0123456"),
        part(true, true, b"78"),
    ];
    let (outcome, _) = play(NAME, &answers);
    assert_eq!(outcome.result.unwrap().bytes.as_slice(), b"012345678");
    // With a size the last may be empty.
    let answers = [
        sized(NAME, 7),
        part(false, false, b"0123456"),
        part(true, true, b""),
    ];
    let (outcome, _) = play(NAME, &answers);
    assert_eq!(outcome.result.unwrap().bytes.as_slice(), b"0123456");
    // No data.
    let (outcome, _) = play(NAME, &[sized(NAME, 0), part(false, true, b"")]);
    assert!(outcome.result.unwrap().bytes.is_empty());
}

#[test]
fn an_abort_by_the_node_is_reported_and_not_answered() {
    let error = AbortCode::NO_OBJECT;
    let address = NAME;
    let refused = SdoResponse::Abort { address, error };
    let expected = (TransferError::Aborted(error), None);
    assert_eq!(failure(NAME, &[refused]), expected);
    assert_eq!(failure(NAME, &[sized(NAME, 9), refused]), expected);
}

#[test]
fn unexpected_responses_end_and_abort_the_transfer() {
    use TransferError::{EmptySegment, OtherObject, Size, Toggle, TooLong, Unexpected};
    let other = expedited(POSITION, &[1, 2, 3, 4]);
    let (expected, got) = (NAME, POSITION);
    assert_eq!(
        failure(NAME, &[other]),
        (OtherObject { expected, got }, Some(AbortCode::COMMAND))
    );
    let abort = SdoResponse::Abort {
        address: POSITION,
        error: AbortCode::RANGE,
    };
    assert!(matches!(failure(NAME, &[abort]).0, OtherObject { .. }));
    assert_eq!(
        failure(NAME, &[sized(NAME, 9), part(true, false, b"0123456")]),
        (
            Toggle {
                expected: false,
                got: true
            },
            Some(AbortCode::TOGGLE)
        )
    );
    // The same segment twice.
    let twice = [
        sized(NAME, 20),
        part(false, false, b"0123456"),
        part(false, false, b"0123456"),
    ];
    assert!(matches!(failure(NAME, &twice).0, Toggle { .. }));
    let wrote = SdoResponse::InitiateDownload { address: NAME };
    assert_eq!(
        failure(NAME, &[wrote]),
        (
            Unexpected {
                expected: "an upload response (4x)",
                got: 0x60
            },
            Some(AbortCode::COMMAND)
        )
    );
    for stray in [
        part(false, true, b"x"),
        SdoResponse::DownloadSegment { toggle: false },
        SdoResponse::Unknown([0xC0; 8]),
    ] {
        assert!(matches!(failure(NAME, &[stray]).0, Unexpected { .. }));
    }
    let (expected, got) = (5, 3);
    assert_eq!(
        failure(NAME, &[sized(NAME, 5), part(false, true, b"EPO")]),
        (Size { expected, got }, Some(AbortCode::LENGTH))
    );
    let (expected, got) = (5, 7);
    assert_eq!(
        failure(NAME, &[sized(NAME, 5), part(false, false, b"0123456")]).0,
        Size { expected, got }
    );
    let (max, got) = (CAPACITY, CAPACITY + 1);
    assert_eq!(
        failure(NAME, &[sized(NAME, 41)]),
        (TooLong { max, got }, Some(AbortCode::MEMORY))
    );
    assert_eq!(
        failure(NAME, &[sized(NAME, 41_000_000)]).0,
        TooLong {
            max,
            got: 41_000_000
        }
    );
    assert_eq!(
        failure(NAME, &[sized(NAME, 5), part(false, false, b"")]),
        (EmptySegment, Some(AbortCode::COMMAND))
    );
}

/// Nothing shows that such a value is complete.
#[test]
fn an_empty_last_segment_without_a_size_aborts_the_transfer() {
    let without_size = SdoResponse::InitiateUpload {
        address: NAME,
        transfer: Initiate::Segmented { size: None },
    };
    let expected = (TransferError::EmptySegment, Some(AbortCode::COMMAND));
    assert_eq!(
        failure(NAME, &[without_size, part(false, true, b"")]),
        expected
    );
    let after_data = [
        without_size,
        part(false, false, b"0123456"),
        part(true, true, b""),
    ];
    assert_eq!(failure(NAME, &after_data), expected);
}

#[test]
fn endless_uploads_end_at_the_capacity() {
    let mut client = client();
    client.read(NAME).unwrap();
    sent(&mut client, at(0));
    let transfer = Initiate::Segmented { size: None };
    let address = NAME;
    receive(
        &mut client,
        SdoResponse::InitiateUpload { address, transfer },
    );
    let mut toggle = false;
    for _ in 0..6 {
        sent(&mut client, at(0));
        receive(&mut client, part(toggle, false, b"0123456"));
        toggle = !toggle;
    }
    let (max, got) = (CAPACITY, 42);
    assert_eq!(
        client.poll_outcome().unwrap().result,
        Err(TransferError::TooLong { max, got })
    );
}

#[test]
fn damaged_answers_give_a_typed_error() {
    let mut client = client();
    client.read(STATUS).unwrap();
    sent(&mut client, at(0));
    let whole = expedited(STATUS, &[1, 2]).to_frame(node());
    let short = CanFrame::new(whole.id(), &whole.data()[..6]).unwrap();
    assert_eq!(client.handle_frame(&short), FrameDisposition::Accepted);
    assert!(matches!(
        client.poll_outcome().unwrap().result,
        Err(TransferError::Message(MessageError::Length {
            expected: 8,
            got: 6,
            ..
        }))
    ));
}

#[test]
fn downloads_match_golden_bytes() {
    let mut client = client();
    client.write_scalar(STATUS, 0x000F_u16).unwrap();
    assert_eq!(
        client.poll_transmit(at(0)).unwrap().data(),
        [0x2B, 0x41, 0x60, 0, 0x0F, 0, 0, 0]
    );
    receive(
        &mut client,
        SdoResponse::InitiateDownload { address: STATUS },
    );
    let outcome = client.poll_outcome().unwrap();
    assert_eq!(outcome.direction, TransferDirection::Download);
    assert!(outcome.result.unwrap().bytes.is_empty());
    // Nine bytes: announced, seven, two.
    client.write(NAME, b"123456789").unwrap();
    let mut data = vec![];
    for answer in [
        SdoResponse::InitiateDownload { address: NAME },
        SdoResponse::DownloadSegment { toggle: false },
        SdoResponse::DownloadSegment { toggle: true },
    ] {
        data.push(client.poll_transmit(at(0)).unwrap().data().to_vec());
        receive(&mut client, answer);
    }
    assert_eq!(
        data,
        [
            vec![0x21, 0x08, 0x10, 0, 9, 0, 0, 0],
            b"\x001234567".to_vec(),
            b"\x1B89\0\0\0\0\0".to_vec()
        ]
    );
    assert!(client.poll_outcome().unwrap().result.is_ok());
    let (max, got) = (CAPACITY, CAPACITY + 1);
    assert_eq!(
        client.write(NAME, &[0; CAPACITY + 1]),
        Err(StartError::TooLong { max, got })
    );
}

#[test]
fn a_wrong_toggle_in_a_write_gives_a_typed_error() {
    let mut client = client();
    client.write(NAME, b"123456789").unwrap();
    sent(&mut client, at(0));
    receive(&mut client, SdoResponse::InitiateDownload { address: NAME });
    sent(&mut client, at(0));
    receive(&mut client, SdoResponse::DownloadSegment { toggle: true });
    let (expected, got) = (false, true);
    assert_eq!(
        client.poll_outcome().unwrap().result,
        Err(TransferError::Toggle { expected, got })
    );
}

#[test]
fn the_timeout_starts_when_the_request_is_sent() {
    let mut client = client();
    client.read(NAME).unwrap();
    assert_eq!(client.poll_timeout(), None);
    client.handle_timeout(at(1_000));
    assert!(client.is_busy());
    assert!(client.poll_transmit(at(100)).is_some());
    assert_eq!(client.poll_timeout(), Some(at(150)));
    client.handle_timeout(at(149));
    assert!(client.is_busy());
    // Each response has its own time limit.
    receive(&mut client, sized(NAME, 5));
    assert_eq!(client.poll_timeout(), None);
    assert!(client.poll_transmit(at(200)).is_some());
    assert_eq!(client.poll_timeout(), Some(at(250)));
    client.handle_timeout(at(250));
    let error = client.poll_outcome().unwrap().result.unwrap_err();
    let expected = "an upload segment (0x, 1x)";
    assert_eq!(error, TransferError::Timeout { expected });
    assert_eq!(
        sent(&mut client, at(250)),
        [SdoRequest::Abort {
            address: NAME,
            error: AbortCode::TIMEOUT
        }]
    );
}

#[test]
fn only_one_transfer_runs_at_a_time() {
    let mut client = client();
    client.read(NAME).unwrap();
    let busy = Err(StartError::Busy { address: NAME });
    assert_eq!(client.read(STATUS), busy);
    assert_eq!(client.write(STATUS, &[1]), busy);
    // Nothing was sent, so there is nothing to abort and no stale response.
    client.cancel();
    assert_eq!(client.read(STATUS), busy, "the outcome is not fetched");
    assert_eq!(
        client.poll_outcome().unwrap().result,
        Err(TransferError::Cancelled)
    );
    assert_eq!(
        (client.pending_stale_response(), sent(&mut client, at(0))),
        (None, vec![])
    );
    assert_eq!(client.read(STATUS), Ok(()));
    sent(&mut client, at(0));
    client.cancel();
    let aborted = sent(&mut client, at(0));
    assert!(matches!(aborted[..], [SdoRequest::Abort { .. }]));
    assert_eq!(client.pending_stale_response(), Some(STATUS));
}

/// Lets a read of `address` time out.
fn time_out(client: &mut Client, address: Address) {
    client.read(address).unwrap();
    sent(client, at(0));
    client.handle_timeout(at(50));
    client.poll_outcome().unwrap();
    sent(client, at(50));
    assert_eq!(client.pending_stale_response(), Some(address));
}

#[test]
fn a_stale_response_is_not_used_for_another_request() {
    let mut client = client();
    time_out(&mut client, POSITION);
    client.read(STATUS).unwrap();
    sent(&mut client, at(60));
    let late = expedited(POSITION, &[1, 2, 3, 4]);
    assert_eq!(receive(&mut client, late), FrameDisposition::Stale);
    assert_eq!(client.pending_stale_response(), None);
    let answer = expedited(STATUS, &[0x40, 1]);
    assert_eq!(receive(&mut client, answer), FrameDisposition::Accepted);
    assert!(client.poll_outcome().unwrap().result.is_ok());
    // Without a request it is dropped as well, but only once.
    time_out(&mut client, POSITION);
    assert_eq!(receive(&mut client, late), FrameDisposition::Stale);
    assert_eq!(receive(&mut client, late), FrameDisposition::Unsolicited);
    // For another service the object's name alone is no match.
    time_out(&mut client, POSITION);
    client.write(POSITION, &[1, 2, 3, 4]).unwrap();
    sent(&mut client, at(60));
    assert_eq!(receive(&mut client, late), FrameDisposition::Stale);
    let wrote = SdoResponse::InitiateDownload { address: POSITION };
    assert_eq!(receive(&mut client, wrote), FrameDisposition::Accepted);
    assert!(client.poll_outcome().unwrap().result.is_ok());
}

#[test]
fn an_unrelated_response_is_not_stale() {
    for stray in [
        expedited(NAME, &[1, 2, 3, 4]),
        SdoResponse::InitiateDownload { address: NAME },
        SdoResponse::Abort {
            address: NAME,
            error: AbortCode::STATE,
        },
    ] {
        let mut client = client();
        time_out(&mut client, POSITION);
        client.read(STATUS).unwrap();
        sent(&mut client, at(60));
        assert_eq!(receive(&mut client, stray), FrameDisposition::Accepted);
        let (expected, got) = (STATUS, NAME);
        assert_eq!(
            client.poll_outcome().unwrap().result,
            Err(TransferError::OtherObject { expected, got })
        );
    }
}

#[test]
fn a_response_in_order_clears_a_pending_stale_one() {
    for answer in [
        expedited(STATUS, &[0x40, 1]),
        SdoResponse::Abort {
            address: STATUS,
            error: AbortCode::STATE,
        },
    ] {
        let mut client = client();
        time_out(&mut client, POSITION);
        client.read(STATUS).unwrap();
        sent(&mut client, at(60));
        assert_eq!(receive(&mut client, answer), FrameDisposition::Accepted);
        client.poll_outcome().unwrap();
        assert_eq!(client.pending_stale_response(), None);
    }
}

#[test]
fn a_stale_segment_does_not_disturb_the_next_transfer() {
    let mut client = client();
    client.read(NAME).unwrap();
    sent(&mut client, at(0));
    receive(&mut client, sized(NAME, 20));
    sent(&mut client, at(0));
    client.handle_timeout(at(50));
    client.poll_outcome().unwrap();
    client.read(STATUS).unwrap();
    assert_eq!(
        sent(&mut client, at(60)).len(),
        2,
        "abort, then the request"
    );
    assert_eq!(
        receive(&mut client, part(false, false, b"0123456")),
        FrameDisposition::Stale
    );
    assert_eq!(
        receive(&mut client, expedited(STATUS, &[0x40, 1])),
        FrameDisposition::Accepted
    );
}

#[test]
fn foreign_and_unsolicited_frames_are_ignored() {
    let mut client = client();
    client.read(STATUS).unwrap();
    let answer = expedited(STATUS, &[0x40, 1]);
    // It fits, but the request was not sent yet.
    assert_eq!(receive(&mut client, answer), FrameDisposition::Unsolicited);
    sent(&mut client, at(0));
    let two = NodeId::new(2).unwrap();
    assert_eq!(
        client.handle_frame(&answer.to_frame(two)),
        FrameDisposition::Foreign
    );
    let request = SdoRequest::InitiateUpload { address: STATUS };
    assert_eq!(
        client.handle_frame(&request.to_frame(node())),
        FrameDisposition::Foreign
    );
    assert_eq!(receive(&mut client, answer), FrameDisposition::Accepted);
    // The bus controller may deliver a frame twice.
    assert_eq!(receive(&mut client, answer), FrameDisposition::Unsolicited);
}
