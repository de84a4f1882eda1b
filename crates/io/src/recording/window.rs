//! A sliding window over a byte stream, as long as one record needs.

use std::io::{self, Read};

/// Read-ahead of some two hundred packets.
const INITIAL_LEN: usize = 256 * 1024;

/// Bytes of a stream from `offset` on.
pub(super) struct Window<R> {
    reader: R,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    offset: u64,
    /// The reader reached its end and is not read again.
    ended: bool,
}

impl<R> std::fmt::Debug for Window<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Window")
            .field("offset", &self.offset)
            .field("available", &(self.end - self.start))
            .finish_non_exhaustive()
    }
}

impl<R> Window<R> {
    /// Offset of the window in the stream.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// The bytes in the window.
    pub(super) fn bytes(&self) -> &[u8] {
        self.buffer.get(self.start..self.end).unwrap_or_default()
    }

    /// Bytes of memory in use.
    #[cfg(test)]
    pub(super) fn capacity(&self) -> usize {
        self.buffer.len()
    }

    /// Advances the window, at most to its end.
    pub(super) fn consume(&mut self, bytes: usize) {
        let bytes = bytes.min(self.end - self.start);
        self.start += bytes;
        self.offset += bytes as u64;
    }
}

impl<R: Read> Window<R> {
    pub(super) fn new(reader: R) -> Self {
        Self {
            reader,
            buffer: vec![0; INITIAL_LEN],
            start: 0,
            end: 0,
            offset: 0,
            ended: false,
        }
    }

    /// Reads until the window has `wanted` bytes or the stream ends. Returns the window, which may
    /// be longer.
    pub(super) fn fill(&mut self, wanted: usize) -> io::Result<&[u8]> {
        // Bytes move only if the rest of the buffer is too short, not for every read of a slow
        // stream.
        let short = self.end - self.start < wanted && !self.ended;
        if short && self.buffer.len() - self.start < wanted {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
            // Twice the length bounds the cost of moves by that of reads.
            let room = wanted.saturating_mul(2);
            if self.buffer.len() < room {
                self.buffer.resize(room, 0);
            }
        }
        while self.end - self.start < wanted && !self.ended {
            let Some(space) = self.buffer.get_mut(self.end..) else {
                break;
            };
            match self.reader.read(space) {
                Ok(0) => self.ended = true,
                Ok(n) => self.end = (self.end + n).min(self.buffer.len()),
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                Err(e) => return Err(e),
            }
        }
        Ok(self.bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Yields one byte per read, like a slow pipe.
    struct ByteReader(Vec<u8>);

    impl Read for ByteReader {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.0.is_empty() {
                return Ok(0);
            }
            buffer[0] = self.0.remove(0);
            Ok(1)
        }
    }

    #[test]
    fn the_window_moves_grows_and_ends() {
        let mut window = Window::new(ByteReader((0..=9).collect()));
        assert_eq!(window.fill(4).unwrap(), [0, 1, 2, 3]);
        window.consume(3);
        assert_eq!((window.offset(), window.bytes()), (3, &[3][..]));
        assert_eq!(window.fill(100).unwrap(), [3, 4, 5, 6, 7, 8, 9]);
        window.consume(100);
        assert_eq!(window.offset(), 10, "only as far as there were bytes");
        assert!(window.fill(1).unwrap().is_empty());
    }

    #[test]
    fn records_may_exceed_the_initial_size() {
        let long = vec![7; INITIAL_LEN * 2 + 5];
        let mut window = Window::new(long.as_slice());
        window.fill(10).unwrap();
        window.consume(1);
        assert_eq!(window.fill(long.len() - 1).unwrap(), &long[1..]);
    }
}
