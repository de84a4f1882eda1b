//! A port that records: every frame written and every byte received goes to a sink as a record,
//! none is lost.
//!
//! On USB the received bytes are cut at frame boundaries, one whole frame a record, and bytes
//! outside frames become records of their own. RS232 is a dialogue of single bytes and frames;
//! there a record is what one read gave.

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Span, Stamp};

use super::delimit::{Delimiter, Piece};
use super::{Port, PortError};

/// A frame that has not gone on for this long will not: the EPOS2's own frame timeout.
const FRAME_TIMEOUT: Span = Span::from_millis(500);

/// A recording wrapper around a port.
///
/// The sink gets each record once, in the order in which the bytes passed; the host time of a
/// received frame is that of the read which completed it.
pub struct Recorder<P, S: FnMut(&Record<'_>)> {
    port: P,
    link: DriveLink,
    sink: S,
    delimiter: Delimiter,
    /// Received bytes that are in no record yet, and when the last of them came.
    pending: Vec<u8>,
    last: Option<Stamp<Host>>,
}

impl<P: Port, S: FnMut(&Record<'_>)> Recorder<P, S> {
    /// Wraps `port`, to which a drive is attached by `link`.
    pub fn new(port: P, link: DriveLink, sink: S) -> Self {
        Self {
            port,
            link,
            sink,
            delimiter: Delimiter::default(),
            pending: Vec::new(),
            last: None,
        }
    }
}

impl<P, S: FnMut(&Record<'_>)> Recorder<P, S> {
    /// The port inside.
    pub fn port(&self) -> &P {
        &self.port
    }

    /// Records the bytes of a frame that has not been completed. Done by itself when the recorder
    /// is dropped.
    pub fn flush(&mut self) {
        let piece = self.delimiter.flush();
        if let (Some(piece), Some(host)) = (piece, self.last) {
            self.emit(piece, host);
        }
    }

    fn received(&mut self, bytes: &[u8], host: Stamp<Host>) {
        if self.link != DriveLink::Usb {
            let record = self.record(host, Direction::FromDevice, bytes);
            (self.sink)(&record);
            return;
        }
        if self
            .last
            .is_some_and(|last| host.saturating_since(last) > FRAME_TIMEOUT)
        {
            self.flush();
        }
        self.last = Some(host);
        for &byte in bytes {
            self.pending.push(byte);
            if let Some(piece) = self.delimiter.push(byte) {
                self.emit(piece, host);
            }
        }
        if !self.delimiter.in_frame() {
            self.flush();
        }
    }

    /// Gives the sink the first of the pending bytes.
    fn emit(&mut self, piece: Piece, host: Stamp<Host>) {
        let (Piece::Frame(length) | Piece::Noise(length)) = piece;
        let length = length.min(self.pending.len());
        let bytes: Vec<u8> = self.pending.drain(..length).collect();
        let record = self.record(host, Direction::FromDevice, &bytes);
        (self.sink)(&record);
    }

    fn record<'a>(&self, host: Stamp<Host>, direction: Direction, frame: &'a [u8]) -> Record<'a> {
        Record {
            host,
            wire: Wire::Drive {
                link: self.link,
                direction,
                frame,
            },
        }
    }
}

impl<P: Port, S: FnMut(&Record<'_>)> Port for Recorder<P, S> {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let host = self.port.write_frame(frame)?;
        let record = self.record(host, Direction::ToDevice, frame);
        (self.sink)(&record);
        Ok(host)
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let read = self.port.read(buffer, timeout)?;
        if let Some((length, host)) = read {
            self.received(buffer.get(..length).unwrap_or_default(), host);
        }
        Ok(read)
    }

    fn now(&self) -> Stamp<Host> {
        self.port.now()
    }
}

impl<P, S: FnMut(&Record<'_>)> Drop for Recorder<P, S> {
    fn drop(&mut self) {
        self.flush();
    }
}

#[cfg(test)]
mod tests;
