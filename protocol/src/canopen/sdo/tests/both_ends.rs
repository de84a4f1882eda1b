//! The client with an independent server: every length, every value, and noise.

use std::vec::Vec;

use proptest::prelude::*;

use super::*;

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

    fn serve(&mut self, client: &mut Client) -> SdoOutcome<CAPACITY> {
        for _ in 0..20 {
            for request in sent(client, at(0)) {
                assert_eq!(
                    receive(client, self.answer(request)),
                    FrameDisposition::Accepted
                );
            }
            if let Some(outcome) = client.poll_outcome() {
                return outcome;
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
        let mut client = client();
        client.read(NAME).unwrap();
        // Nothing shows that an empty value without a size is complete.
        let announce = announce || data.is_empty();
        let outcome = Server::new(&data, expedite, announce).serve(&mut client);
        let value = outcome.result.unwrap();
        prop_assert_eq!(value.bytes.as_slice(), &data);
        client.write(NAME, &data).unwrap();
        let mut server = Server::new(&[], expedite, announce);
        prop_assert!(server.serve(&mut client).result.is_ok());
        prop_assert_eq!(server.data, data);
    }

    #[test]
    fn scalars_of_every_type_round_trip(value in any::<i32>()) {
        fn round_trip<T: Scalar + PartialEq + core::fmt::Debug>(value: T) {
            let mut client = client();
            client.write_scalar(NAME, value).unwrap();
            let mut server = Server::new(&[], true, true);
            server.serve(&mut client).result.unwrap();
            assert_eq!(server.data.len(), usize::from(T::BYTES));
            client.read(NAME).unwrap();
            assert_eq!(server.serve(&mut client).result.unwrap().scalar::<T>(), Ok(value));
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

    /// With any responses, a transfer ends by them or by its time limit.
    #[test]
    fn every_transfer_ends_under_noise(answers in prop::collection::vec(noise(), 0..40), write in 0..20_usize) {
        let mut client = client();
        match write {
            0 => client.read(NAME).unwrap(),
            n => client.write(NAME, &[0x55; CAPACITY][..n]).unwrap(),
        }
        for answer in answers {
            sent(&mut client, at(0));
            receive(&mut client, answer);
        }
        let mut outcome = client.poll_outcome();
        if outcome.is_none() {
            prop_assert!(client.is_busy());
            sent(&mut client, at(0));
            client.handle_timeout(at(50));
            outcome = client.poll_outcome();
        }
        prop_assert_eq!(outcome.unwrap().address, NAME);
        prop_assert!(!client.is_busy());
        prop_assert!(client.read(STATUS).is_ok());
    }
}
