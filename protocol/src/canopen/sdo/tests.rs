//! Transfers with scripted responses, with a complete server, and with noise.

extern crate std;
mod both_ends;

use std::vec;
use std::vec::Vec;

use super::*;
use crate::canopen::AbortCode;
use crate::canopen::tests as objects;
use crate::canopen::{CanFrame, MessageError, NodeId};

const CAPACITY: usize = 40;
type Transfer = SdoTransfer<CAPACITY>;
type TransferResult = Result<crate::BoundedVec<u8, CAPACITY>, TransferError>;

const NAME: Address = Address::new(0x1008, 0);
const STATUS: Address = objects::STATUSWORD.address;
const POSITION: Address = objects::POSITION_ACTUAL.address;

fn node() -> NodeId {
    NodeId::new(1).unwrap()
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
        bytes: crate::BoundedVec::from_slice(bytes).unwrap(),
    })
}

/// Plays a transfer with one response per request; returns its result and the requests sent.
fn play(
    (mut transfer, request): (Transfer, SdoRequest),
    answers: &[SdoResponse],
) -> (TransferResult, Vec<SdoRequest>) {
    let mut requests = vec![request];
    for (n, answer) in answers.iter().enumerate() {
        let result = match transfer.handle_response(answer) {
            Ok(TransferStep::Send(request)) => {
                requests.push(request);
                continue;
            }
            Ok(TransferStep::Done(value)) => Ok(value),
            Err(error) => Err(error),
        };
        assert_eq!(n + 1, answers.len(), "the transfer has ended");
        return (result, requests);
    }
    panic!("the transfer has not ended");
}

fn read(address: Address, answers: &[SdoResponse]) -> TransferResult {
    play(Transfer::upload(address), answers).0
}

fn write(address: Address, data: &[u8]) -> (Transfer, SdoRequest) {
    Transfer::download(address, data, SEGMENT_LEN).unwrap()
}

fn failure(address: Address, answers: &[SdoResponse]) -> (TransferError, Option<AbortCode>) {
    let error = read(address, answers).unwrap_err();
    (error, error.abort_code())
}

#[test]
fn expedited_reads_complete() {
    let value = read(STATUS, &[expedited(STATUS, &[0x40, 0x01])]).unwrap();
    assert_eq!(value.as_slice(), [0x40, 0x01]);
}

#[test]
fn answers_without_a_size_have_four_bytes() {
    let transfer = Initiate::Unsized([0xFE, 0xFF, 0xAA, 0xBB]);
    let address = STATUS;
    let answer = SdoResponse::InitiateUpload { address, transfer };
    let value = read(STATUS, &[answer]).unwrap();
    assert_eq!(value.as_slice(), [0xFE, 0xFF, 0xAA, 0xBB]);
}

#[test]
fn segmented_reads_complete() {
    let answers = [sized(NAME, 5), part(false, true, b"EPOS2")];
    let value = read(NAME, &answers).unwrap();
    assert_eq!(value.as_slice(), b"EPOS2");
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
    let value = read(NAME, &answers).unwrap();
    assert_eq!(value.as_slice(), b"012345678");
    // With a size the last may be empty.
    let answers = [
        sized(NAME, 7),
        part(false, false, b"0123456"),
        part(true, true, b""),
    ];
    let value = read(NAME, &answers).unwrap();
    assert_eq!(value.as_slice(), b"0123456");
    // No data.
    let value = read(NAME, &[sized(NAME, 0), part(false, true, b"")]).unwrap();
    assert!(value.is_empty());
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
    let transfer = Initiate::Segmented { size: None };
    let address = NAME;
    let mut answers = vec![SdoResponse::InitiateUpload { address, transfer }];
    answers.extend((0..6).map(|n| part(n % 2 == 1, false, b"0123456")));
    let (max, got) = (CAPACITY, 42);
    assert_eq!(
        read(NAME, &answers),
        Err(TransferError::TooLong { max, got })
    );
}

#[test]
fn damaged_answers_give_a_typed_error() {
    let whole = expedited(STATUS, &[1, 2]).to_frame(node());
    let short = CanFrame::new(whole.id(), &whole.data()[..6]).unwrap();
    assert!(matches!(
        SdoResponse::parse(&short),
        Err(MessageError::Length {
            expected: 8,
            got: 6,
            ..
        })
    ));
}

#[test]
fn downloads_match_golden_bytes() {
    let wrote = SdoResponse::InitiateDownload { address: STATUS };
    let (result, requests) = play(write(STATUS, &0x000F_u16.to_le_bytes()), &[wrote]);
    assert!(result.unwrap().is_empty());
    assert_eq!(
        requests[0].to_frame(node()).data(),
        [0x2B, 0x41, 0x60, 0, 0x0F, 0, 0, 0]
    );
    // Nine bytes: announced, seven, two.
    let answers = [
        SdoResponse::InitiateDownload { address: NAME },
        SdoResponse::DownloadSegment { toggle: false },
        SdoResponse::DownloadSegment { toggle: true },
    ];
    let (result, requests) = play(write(NAME, b"123456789"), &answers);
    assert!(result.unwrap().is_empty());
    let data: Vec<_> = requests
        .iter()
        .map(|request| request.to_frame(node()).data().to_vec())
        .collect();
    assert_eq!(
        data,
        [
            vec![0x21, 0x08, 0x10, 0, 9, 0, 0, 0],
            b"\x001234567".to_vec(),
            b"\x1B89\0\0\0\0\0".to_vec()
        ]
    );
    let (max, got) = (CAPACITY, CAPACITY + 1);
    let refused = Transfer::download(NAME, &[0; CAPACITY + 1], SEGMENT_LEN);
    assert_eq!(refused.unwrap_err(), TransferError::TooLong { max, got });
}

#[test]
fn a_wrong_toggle_in_a_write_gives_a_typed_error() {
    let answers = [
        SdoResponse::InitiateDownload { address: NAME },
        SdoResponse::DownloadSegment { toggle: true },
    ];
    let (expected, got) = (false, true);
    assert_eq!(
        play(write(NAME, b"123456789"), &answers).0,
        Err(TransferError::Toggle { expected, got })
    );
}
