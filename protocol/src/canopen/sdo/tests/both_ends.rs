//! Transfers with an independent server: every length, every value, and noise.

use std::vec::Vec;

use proptest::prelude::*;

use super::*;
use crate::canopen::Scalar;

/// An SDO server for one object, as CiA 301 describes it.
struct Server {
    data: Vec<u8>,
    expedite: bool,
    announce: bool,
    at: usize,
    toggle: bool,
    announced: Option<u32>,
}

impl Server {
    fn new(data: &[u8], expedite: bool, announce: bool) -> Self {
        Self {
            data: data.to_vec(),
            expedite,
            announce,
            at: 0,
            toggle: false,
            announced: None,
        }
    }

    fn answer(&mut self, request: SdoRequest) -> SdoResponse {
        match request {
            SdoRequest::InitiateUpload { address } => {
                (self.at, self.toggle) = (0, false);
                let size = self.announce.then_some(self.data.len() as u32);
                let transfer = Expedited::new(&self.data)
                    .filter(|_| self.expedite)
                    .map_or(Initiate::Segmented { size }, Initiate::Expedited);
                SdoResponse::InitiateUpload { address, transfer }
            }
            SdoRequest::UploadSegment { toggle } => {
                assert_eq!(toggle, self.toggle);
                let segment = SdoSegment::cut(&self.data, self.at, toggle, SEGMENT_LEN);
                self.at += segment.bytes.len();
                self.toggle = !toggle;
                SdoResponse::UploadSegment(segment)
            }
            SdoRequest::InitiateDownload { address, transfer } => {
                self.toggle = false;
                self.data.clear();
                match transfer {
                    Initiate::Expedited(data) => self.data.extend(data.as_slice()),
                    Initiate::Segmented { size } => self.announced = size,
                    Initiate::Unsized(_) => panic!("the client always sends sizes"),
                }
                SdoResponse::InitiateDownload { address }
            }
            SdoRequest::DownloadSegment(segment) => {
                assert_eq!(segment.toggle, self.toggle);
                self.data.extend(segment.bytes.as_slice());
                self.toggle = !self.toggle;
                if segment.last {
                    assert_eq!(self.announced, Some(self.data.len() as u32));
                }
                SdoResponse::DownloadSegment {
                    toggle: segment.toggle,
                }
            }
            SdoRequest::Abort { .. } | SdoRequest::Unknown(_) => panic!("{request:?}"),
        }
    }

    fn serve(&mut self, (mut transfer, mut request): (Transfer, SdoRequest)) -> TransferResult {
        for _ in 0..20 {
            match transfer.handle_response(&self.answer(request))? {
                TransferStep::Send(next) => request = next,
                TransferStep::Done(value) => return Ok(value),
            }
        }
        panic!("the transfer does not end");
    }
}

fn noise() -> impl Strategy<Value = SdoResponse> {
    let byte = prop_oneof![
        prop::sample::select(
            &[
                0x00_u8, 0x10, 0x01, 0x20, 0x30, 0x41, 0x43, 0x4B, 0x60, 0x80
            ][..]
        ),
        any::<u8>(),
    ];
    (byte, prop::bool::ANY, any::<[u8; 7]>()).prop_map(|(command, ours, rest)| {
        let mut bytes = [0; 8];
        bytes[0] = command;
        bytes[1..].copy_from_slice(&rest);
        if ours {
            bytes[1..4].copy_from_slice(&[0x08, 0x10, 0x00]);
        }
        SdoResponse::from_bytes(bytes)
    })
}

proptest! {
    #[test]
    fn every_length_round_trips(
        data in prop::collection::vec(any::<u8>(), 0..=CAPACITY), expedite: bool, announce: bool,
    ) {
        // Nothing shows that an empty value without a size is complete.
        let announce = announce || data.is_empty();
        let value = Server::new(&data, expedite, announce).serve(Transfer::upload(NAME)).unwrap();
        prop_assert_eq!(value.as_slice(), &data);
        let mut server = Server::new(&[], expedite, announce);
        prop_assert!(server.serve(write(NAME, &data)).is_ok());
        prop_assert_eq!(server.data, data);
    }

    #[test]
    fn scalars_of_every_type_round_trip(value in any::<i32>()) {
        fn round_trip<T: Scalar>(value: T) {
            let data = Expedited::of(value);
            let mut server = Server::new(&[], true, true);
            server.serve(write(NAME, data.as_slice())).unwrap();
            assert_eq!(server.data.len(), usize::from(T::BYTES));
            let read = server.serve(Transfer::upload(NAME)).unwrap();
            assert_eq!(Expedited::new(&read), Some(data));
            assert_eq!(T::from_raw(data.to_u32()).to_raw(), value.to_raw());
        }
        round_trip(value);
        round_trip(value as i16);
        round_trip(value as i8);
        round_trip(value as u32);
        round_trip(value as u16);
        round_trip(value as u8);
    }

    #[test]
    fn every_eight_bytes_decode_in_both_directions(bytes in any::<[u8; 8]>()) {
        let request = SdoRequest::from_bytes(bytes);
        prop_assert_eq!(SdoRequest::from_bytes(request.to_bytes()), request);
        let answer = SdoResponse::from_bytes(bytes);
        prop_assert_eq!(SdoResponse::from_bytes(answer.to_bytes()), answer);
        prop_assert_eq!(answer.to_bytes()[0] >> 5, bytes[0] >> 5);
    }

    /// With any responses, a transfer keeps asking or ends; it never exceeds its capacity.
    #[test]
    fn every_transfer_survives_noise(
        answers in prop::collection::vec(noise(), 0..40), len in 0..20_usize,
    ) {
        let (mut transfer, mut request) = match len {
            0 => Transfer::upload(NAME),
            len => write(NAME, &[0x55; CAPACITY][..len]),
        };
        for answer in answers {
            match transfer.handle_response(&answer) {
                Ok(TransferStep::Send(next)) => {
                    prop_assert!(answer.answers(&request));
                    request = next;
                }
                Ok(TransferStep::Done(value)) => {
                    prop_assert!(answer.answers(&request));
                    prop_assert!(len == 0 || value.is_empty());
                    break;
                }
                Err(error) => {
                    let is_abort = matches!(answer, SdoResponse::Abort { .. });
                    prop_assert!(is_abort || error.abort_code().is_some());
                    break;
                }
            }
        }
    }
}
