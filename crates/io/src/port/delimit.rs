//! Boundaries of EPOS2 USB frames in a byte stream, for the log, which keeps every raw byte.
//!
//! Frames are found by [`UsbDecoder`]; their content is ignored, and a frame with a wrong CRC
//! counts as a frame.

use protocol::epos2::SerialFrameError;
use protocol::epos2::usb::{DLE, UsbDecoder};

/// A run of bytes that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StreamPiece {
    /// A frame from `90 02` to its last CRC byte, stuffing included.
    Frame(usize),
    /// Bytes outside frames, or of an aborted frame.
    Noise(usize),
}

/// Splits a stream into pieces by length; every byte is in exactly one piece.
#[derive(Debug, Default)]
pub(super) struct Delimiter {
    decoder: UsbDecoder,
    /// Bytes since the end of the last piece, and the last byte.
    open: usize,
    last: u8,
}

impl Delimiter {
    /// Adds a byte. Returns the piece that ends with it, or noise that ends two bytes before it,
    /// where a frame starts.
    pub(super) fn push(&mut self, byte: u8) -> Option<StreamPiece> {
        self.open += 1;
        self.last = byte;
        let within = self.decoder.is_within_frame();
        match self.decoder.push(byte) {
            None if !within && self.decoder.is_within_frame() => self.start(),
            None => None,
            Some(Ok(_) | Err(SerialFrameError::Crc { .. })) => {
                Some(StreamPiece::Frame(self.take()))
            }
            // The sync pair of a new frame inside another frame.
            Some(Err(_)) if self.decoder.is_within_frame() => self.start(),
            Some(Err(_)) => Some(StreamPiece::Noise(self.take())),
        }
    }

    /// Whether the open piece may still become a frame.
    pub(super) fn in_frame(&self) -> bool {
        self.decoder.is_within_frame() || (self.open > 0 && self.last == DLE)
    }

    /// Ends the open piece.
    pub(super) fn flush(&mut self) -> Option<StreamPiece> {
        self.decoder.reset();
        match self.take() {
            0 => None,
            open => Some(StreamPiece::Noise(open)),
        }
    }

    fn take(&mut self) -> usize {
        std::mem::take(&mut self.open)
    }

    /// Starts a frame at a sync pair; the bytes before it are noise.
    fn start(&mut self) -> Option<StreamPiece> {
        let before = self.open.saturating_sub(2);
        self.open = 2;
        (before > 0).then_some(StreamPiece::Noise(before))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(bytes: &[u8]) -> Vec<StreamPiece> {
        let mut delimiter = Delimiter::default();
        let mut pieces: Vec<_> = bytes.iter().filter_map(|&b| delimiter.push(b)).collect();
        pieces.extend(delimiter.flush());
        pieces
    }

    /// The answer 0x0237 to reading the statusword.
    const ANSWER: [u8; 14] = [
        0x90, 0x02, 0x00, 0x04, 0, 0, 0, 0, 0x37, 0x02, 0, 0, 0x68, 0x00,
    ];
    /// An answer with the word 0x0090 in it, so with stuffing.
    const STUFFED: [u8; 15] = [
        0x90, 0x02, 0x00, 0x04, 0, 0, 0, 0, 0, 0, 0x90, 0x90, 0x80, 0x14, 0x35,
    ];

    #[test]
    fn adjacent_frames_are_separated() {
        let stream = [&ANSWER[..], &STUFFED, &ANSWER].concat();
        assert_eq!(
            pieces(&stream),
            [
                StreamPiece::Frame(14),
                StreamPiece::Frame(15),
                StreamPiece::Frame(14)
            ]
        );
    }

    #[test]
    fn noise_around_frames_is_separate() {
        let stream = [&[0x11, 0x90][..], &ANSWER, &[0x90, 0x33]].concat();
        assert_eq!(
            pieces(&stream),
            [
                StreamPiece::Noise(2),
                StreamPiece::Frame(14),
                StreamPiece::Noise(2)
            ]
        );
    }

    #[test]
    fn a_sync_pair_inside_a_frame_aborts_it() {
        let stream = [&ANSWER[..9], &ANSWER].concat();
        assert_eq!(
            pieces(&stream),
            [StreamPiece::Noise(9), StreamPiece::Frame(14)]
        );
    }

    #[test]
    fn a_single_dle_aborts_a_frame() {
        let stream = [&ANSWER[..8], &[0x90, 0x05], &ANSWER].concat();
        assert_eq!(
            pieces(&stream),
            [StreamPiece::Noise(10), StreamPiece::Frame(14)]
        );
    }

    #[test]
    fn frames_may_end_in_a_stuffed_dle() {
        let mut stream = ANSWER.to_vec();
        stream.pop();
        stream.extend([0x90, 0x90]);
        stream.extend(ANSWER);
        assert_eq!(
            pieces(&stream),
            [StreamPiece::Frame(15), StreamPiece::Frame(14)]
        );
    }

    #[test]
    fn stuffed_data_is_not_a_sync_pair() {
        let frame = [0x90, 0x02, 0x00, 0x01, 0x90, 0x90, 0x02, 0xAA, 0xBB];
        assert_eq!(pieces(&frame), [StreamPiece::Frame(9)]);
    }

    proptest::proptest! {
        #[test]
        fn every_byte_is_in_exactly_one_piece(bytes in proptest::collection::vec(
            proptest::prop_oneof![
                proptest::prelude::Just(0x90_u8), proptest::prelude::Just(2), proptest::prelude::any::<u8>()
            ], 0..200)) {
            let total: usize = pieces(&bytes).iter().map(|piece| match *piece {
                StreamPiece::Frame(n) | StreamPiece::Noise(n) => n,
            }).sum();
            proptest::prop_assert_eq!(total, bytes.len());
        }
    }
}
