//! A way to a bus that records: every frame sent and every frame received goes to a sink as a
//! record.

use protocol::canopen::CanFrame;
use protocol::record::{Direction, DriveLink, Record, Wire};
use units::{Host, Span, Stamp};

use super::{CanError, CanPort};

/// A recording wrapper around a way to a bus.
///
/// The sink gets each frame once, as a record with the port's own time: on SocketCAN the kernel's
/// receive time. Records come in the order in which frames were handed over, so times may run back
/// by what a received frame had waited.
#[derive(Debug)]
pub struct Recorder<P, S> {
    port: P,
    sink: S,
}

impl<P: CanPort, S: FnMut(&Record<'_>)> Recorder<P, S> {
    /// Wraps `port`.
    pub fn new(port: P, sink: S) -> Self {
        Self { port, sink }
    }

    fn record(&mut self, host: Stamp<Host>, direction: Direction, frame: &CanFrame) {
        (self.sink)(&Record {
            host,
            wire: Wire::Drive {
                link: DriveLink::Can,
                direction,
                frame: &frame.to_socketcan(),
            },
        });
    }
}

impl<P, S> Recorder<P, S> {
    /// The port inside.
    pub fn port(&self) -> &P {
        &self.port
    }
}

impl<P: CanPort, S: FnMut(&Record<'_>)> CanPort for Recorder<P, S> {
    fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
        let host = self.port.write_frame(frame)?;
        self.record(host, Direction::ToDevice, frame);
        Ok(host)
    }

    fn read(&mut self, timeout: Span) -> Result<Option<(CanFrame, Stamp<Host>)>, CanError> {
        let read = self.port.read(timeout)?;
        if let Some((frame, host)) = &read {
            self.record(*host, Direction::FromDevice, frame);
        }
        Ok(read)
    }

    fn dropped(&self) -> u64 {
        self.port.dropped()
    }

    fn name(&self) -> &str {
        self.port.name()
    }

    fn now(&self) -> Stamp<Host> {
        self.port.now()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::OwnedRecord;
    use protocol::canopen::CobId;
    use std::collections::VecDeque;

    type Read = Result<Option<(CanFrame, Stamp<Host>)>, CanError>;

    struct Script(VecDeque<Read>);

    impl CanPort for Script {
        fn write_frame(&mut self, frame: &CanFrame) -> Result<Stamp<Host>, CanError> {
            if frame.data().is_empty() {
                return Err(CanError::NotSent);
            }
            Ok(Stamp::from_nanos(1))
        }

        fn read(&mut self, _: Span) -> Read {
            self.0.pop_front().unwrap()
        }

        fn dropped(&self) -> u64 {
            0
        }

        fn name(&self) -> &str {
            "script"
        }
    }

    #[test]
    fn each_frame_that_passed_is_one_record() {
        let id = |id| CobId::new(id).unwrap();
        let request = CanFrame::of(id(0x601), [0x40, 0x41, 0x60, 0, 0, 0, 0, 0]);
        let answer = CanFrame::of(id(0x581), [0x4B, 0x41, 0x60, 0, 0x40, 1, 0, 0]);
        let script = [
            Ok(None),
            Ok(Some((answer, Stamp::from_nanos(2)))),
            Err(CanError::NotSent),
        ];
        let mut seen = Vec::new();
        let mut port = Recorder::new(Script(script.into()), |record: &Record<'_>| {
            seen.push(OwnedRecord::from(record));
        });
        port.write_frame(&request).unwrap();
        port.write_frame(&CanFrame::of(id(0x80), [])).unwrap_err();
        assert_eq!(port.read(Span::ZERO).unwrap(), None);
        assert_eq!(
            port.read(Span::ZERO).unwrap(),
            Some((answer, Stamp::from_nanos(2)))
        );
        port.read(Span::ZERO).unwrap_err();
        assert!(port.port().0.is_empty());
        let expected = [
            (1, Direction::ToDevice, request.to_socketcan()),
            (2, Direction::FromDevice, answer.to_socketcan()),
        ];
        let records: Vec<_> = seen.iter().map(OwnedRecord::as_record).collect();
        assert_eq!(records.len(), expected.len());
        for (record, (ns, direction, frame)) in records.iter().zip(&expected) {
            assert_eq!(record.host.as_nanos(), *ns);
            let wire = Wire::Drive {
                link: DriveLink::Can,
                direction: *direction,
                frame,
            };
            assert_eq!(record.wire, wire);
        }
    }
}
