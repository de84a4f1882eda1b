//! A port that records: every frame written and every byte received is passed to a sink as a
//! record.
//!
//! On USB, received bytes are split into one record per frame, and bytes outside frames get records
//! of their own. RS232 alternates single bytes and frames, so a record there holds the bytes of one
//! read.

use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Span, Stamp};

use super::delimit::{Delimiter, StreamPiece};
use super::{Port, PortError};

/// Silence that ends an incomplete frame: the EPOS2's frame timeout.
const FRAME_TIMEOUT: Span = Span::from_millis(500);

/// A recording wrapper around a port.
///
/// The sink gets each record once, in order. The host time of a received frame is that of the read
/// that completed it.
pub struct RecordingPort<P, S: FnMut(&Record<'_>)> {
    port: P,
    link: DriveLink,
    sink: S,
    delimiter: Delimiter,
    /// Received bytes that are in no record yet, and the time of the last one.
    pending: Vec<u8>,
    last: Option<Stamp<Host>>,
}

impl<P: Port, S: FnMut(&Record<'_>)> RecordingPort<P, S> {
    /// Wraps `port`, the `link` of a drive.
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

impl<P, S: FnMut(&Record<'_>)> RecordingPort<P, S> {
    /// The wrapped port.
    pub fn port(&self) -> &P {
        &self.port
    }

    /// Records the bytes of an incomplete frame. Dropping the port does the same.
    pub fn flush(&mut self) {
        let piece = self.delimiter.flush();
        if let (Some(piece), Some(host)) = (piece, self.last) {
            self.emit(piece, host);
        }
    }

    fn received(&mut self, bytes: &[u8], host: Stamp<Host>) {
        if self.link != DriveLink::Usb {
            let record = self.record(host, Direction::FromDrive, bytes);
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

    /// Passes the first pending bytes to the sink.
    fn emit(&mut self, piece: StreamPiece, host: Stamp<Host>) {
        let (StreamPiece::Frame(length) | StreamPiece::Noise(length)) = piece;
        let length = length.min(self.pending.len());
        let bytes: Vec<u8> = self.pending.drain(..length).collect();
        let record = self.record(host, Direction::FromDrive, &bytes);
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

impl<P: Port, S: FnMut(&Record<'_>)> Port for RecordingPort<P, S> {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        let host = self.port.write_frame(frame)?;
        let record = self.record(host, Direction::ToDrive, frame);
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

impl<P, S: FnMut(&Record<'_>)> Drop for RecordingPort<P, S> {
    fn drop(&mut self) {
        self.flush();
    }
}

#[cfg(test)]
mod tests;
