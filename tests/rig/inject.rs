//! Fault injection: a wrapper around a port that damages traffic, and faults of the drive behind
//! it.
//!
//! On a serial line bytes are damaged. A CAN controller passes no damaged frame: it destroys it on
//! the bus and the sender repeats it. Faults that corrupt bytes on a serial line therefore delay
//! frames on CAN, or lose them if they never pass whole. Everything is seeded and runs in virtual
//! time, so failures repeat.

use std::collections::VecDeque;

use io::port::{Port, PortError};
use protocol::canopen::{CanFrame, CobId};
use protocol::epos2::DeviceError;
use sim::Attachment;
use units::{Host, Span, Stamp};

use crate::port::VirtualPort;

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Answers are lost for a span.
    AnswersLost(Span),
    /// Requests are lost for a span.
    RequestsLost(Span),
    /// Answers come this much later, for a span.
    AnswersLate(Span, Span),
    /// Answers have a flipped bit, for a span.
    AnswersFlipped(Span),
    /// Requests have a flipped bit, for a span.
    RequestsFlipped(Span),
    /// The last bytes of answers are missing, for a span.
    AnswersCut(Span),
    /// Answers come twice, for a span.
    AnswersDoubled(Span),
    /// Instead of an answer the one before it comes again, for a span.
    AnswersStale(Span),
    /// Answers arrive one byte at a time, for a span.
    AnswersInBytes(Span),
    /// Random bytes precede every answer, for a span.
    Noise(Span),
    /// Random bytes with frame starts among them precede every answer, for a span.
    NoiseWithFrameStarts(Span),
    /// The port is gone: every call fails.
    Unplugged,
    /// The port takes no more bytes.
    WriteBlocked,
    /// A read ends this much later and without the bytes that arrived, as on a machine that runs
    /// neither the program nor the kernel's work for the terminal; 30 ms after that answers are
    /// lost for a second span.
    ReadHeld(Span, Span),
    /// The drive loses and regains its supply.
    PowerCycle,
    /// The drive reports an error.
    Device(DeviceError),
    /// The motor is held.
    Blocked,
}

/// A port on which one fault begins at a given time.
pub struct FaultInjector {
    port: VirtualPort,
    fault: Fault,
    from: Stamp<Host>,
    done: bool,
    /// Bytes on their way to the client, with their arrival times.
    pending: VecDeque<(Stamp<Host>, Vec<u8>)>,
    /// Whether the port carries frames of a CAN bus.
    bus: bool,
    last_answer: Vec<u8>,
    random: u64,
}

impl FaultInjector {
    /// Wraps a port. `fault` begins at `from`; its random parts follow from `seed`.
    #[must_use]
    pub fn new(
        port: VirtualPort,
        attached: Attachment,
        fault: Fault,
        from: Stamp<Host>,
        seed: u64,
    ) -> Self {
        Self {
            port,
            fault,
            from,
            done: false,
            pending: VecDeque::new(),
            bus: attached == Attachment::Can,
            last_answer: Vec::new(),
            random: seed | 1,
        }
    }

    /// The port behind it.
    #[must_use]
    pub fn port(&self) -> &VirtualPort {
        &self.port
    }

    /// Whether a fault of this duration is active.
    fn on(&self, span: Span) -> bool {
        let now = self.port.now();
        self.from <= now && now < self.from + span
    }

    /// Whether an answer is lost after a read that was held.
    fn is_lost(&self, held: Span, lost: Span) -> bool {
        let from = self.from + held + Span::from_millis(30);
        from <= self.port.now() && self.port.now() < from + lost
    }

    fn next(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    fn flip(&mut self, bytes: &mut [u8]) {
        if !bytes.is_empty() {
            let at = usize::try_from(self.next()).unwrap() % bytes.len();
            bytes[at] ^= 1 << (self.next() % 8);
        }
    }

    /// Applies faults of the drive itself once, when they are due.
    fn apply_drive_fault(&mut self) {
        if self.done || self.port.now() < self.from || matches!(self.fault, Fault::ReadHeld(..)) {
            return;
        }
        self.done = true;
        match self.fault {
            Fault::PowerCycle => self.port.with_drive(|node| node.power_cycle()),
            Fault::Device(error) => self.port.with_drive(|node| node.inject(error)),
            Fault::Blocked => self.port.with_drive(|node| node.block()),
            _ => {}
        }
    }

    fn unplugged(&self) -> Result<(), PortError> {
        let gone = self.fault == Fault::Unplugged && self.port.now() >= self.from;
        if gone {
            return Err(PortError::Disconnected {
                port: "virtual".to_owned(),
                reason: "unplugged by the test".to_owned(),
            });
        }
        Ok(())
    }

    /// Damages an answer. Returns its pieces with their arrival times.
    fn damage_answer(
        &mut self,
        at: Stamp<Host>,
        mut bytes: Vec<u8>,
    ) -> Vec<(Stamp<Host>, Vec<u8>)> {
        let before = std::mem::replace(&mut self.last_answer, bytes.clone());
        if self.bus {
            return self.damage_frame(at, bytes, before);
        }
        match self.fault {
            Fault::AnswersLost(span) if self.on(span) => Vec::new(),
            Fault::ReadHeld(held, lost) if self.is_lost(held, lost) => Vec::new(),
            Fault::AnswersLate(span, late) if self.on(span) => vec![(at + late, bytes)],
            Fault::AnswersFlipped(span) if self.on(span) => {
                self.flip(&mut bytes);
                vec![(at, bytes)]
            }
            Fault::AnswersCut(span) if self.on(span) => {
                let keep = usize::try_from(self.next()).unwrap() % bytes.len();
                bytes.truncate(keep);
                vec![(at, bytes)]
            }
            Fault::AnswersDoubled(span) if self.on(span) => vec![(at, bytes.repeat(2))],
            Fault::AnswersStale(span) if self.on(span) => vec![(at, before)],
            Fault::AnswersInBytes(span) if self.on(span) => {
                let step = Span::from_micros(87); // a byte at 115,200 baud
                let mut when = at;
                bytes
                    .into_iter()
                    .map(|byte| {
                        when += step;
                        (when, vec![byte])
                    })
                    .collect()
            }
            Fault::Noise(span) if self.on(span) => {
                let noise: Vec<u8> = (0..7).map(|_| (self.next() >> 24) as u8 & 0x7F).collect();
                vec![(at, noise), (at, bytes)]
            }
            Fault::NoiseWithFrameStarts(span) if self.on(span) => {
                let noise = vec![(self.next() >> 24) as u8, 0x90, 0x02, 0x00];
                vec![(at, noise), (at, bytes)]
            }
            _ => vec![(at, bytes)],
        }
    }
}

/// Faults longer than this never end.
const FOR_EVER: Span = Span::from_secs(100);

impl FaultInjector {
    /// Damages a frame of a bus.
    fn damage_frame(
        &mut self,
        at: Stamp<Host>,
        frame: Vec<u8>,
        before: Vec<u8>,
    ) -> Vec<(Stamp<Host>, Vec<u8>)> {
        match self.fault {
            Fault::AnswersLost(span) if self.on(span) => Vec::new(),
            Fault::ReadHeld(held, lost) if self.is_lost(held, lost) => Vec::new(),
            Fault::AnswersLate(span, late) if self.on(span) => vec![(at + late, frame)],
            Fault::AnswersFlipped(span) | Fault::AnswersCut(span) if self.on(span) => {
                if span >= FOR_EVER {
                    return Vec::new();
                }
                vec![(at.max(self.from + span), frame)]
            }
            Fault::AnswersDoubled(span) if self.on(span) => vec![(at, frame.clone()), (at, frame)],
            Fault::AnswersStale(span) if self.on(span) => vec![(at, before)],
            Fault::Noise(span) | Fault::NoiseWithFrameStarts(span) if self.on(span) => {
                let other = self.other_nodes_frame();
                vec![(at, other), (at, frame)]
            }
            _ => vec![(at, frame)],
        }
    }

    /// A random frame of another node on the bus.
    fn other_nodes_frame(&mut self) -> Vec<u8> {
        let services = [0x080, 0x180, 0x280, 0x380, 0x480, 0x580, 0x700];
        let service = services[usize::try_from(self.next() % 7).unwrap()];
        let id = CobId::new(service | 0x33).unwrap();
        let data = self.next().to_le_bytes();
        let length = usize::try_from(self.next() % 9).unwrap();
        let frame = CanFrame::new(id, &data[..length]).unwrap();
        frame.to_socketcan().to_vec()
    }

    /// Delay after which a damaged request passes on a bus; `None` if it never does.
    fn request_repeated(&self, span: Span) -> Option<Span> {
        (span < FOR_EVER).then(|| (self.from + span).saturating_since(self.port.now()))
    }
}

impl Port for FaultInjector {
    fn write_frame(&mut self, frame: &[u8]) -> Result<Stamp<Host>, PortError> {
        self.apply_drive_fault();
        self.unplugged()?;
        let now = self.port.now();
        match self.fault {
            Fault::WriteBlocked if now >= self.from => Err(PortError::WriteTimeout {
                port: "virtual".to_owned(),
                expected: frame.len(),
                got: 0,
            }),
            Fault::RequestsLost(span) if self.on(span) => Ok(now),
            Fault::RequestsFlipped(span) if self.on(span) && self.bus => {
                Ok(match self.request_repeated(span) {
                    Some(late) => self.port.write_late(frame, late),
                    None => now,
                })
            }
            Fault::RequestsFlipped(span) if self.on(span) => {
                let mut frame = frame.to_vec();
                self.flip(&mut frame);
                self.port.write_frame(&frame)
            }
            _ => self.port.write_frame(frame),
        }
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        timeout: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        if let Fault::ReadHeld(span, _) = self.fault
            && !self.done
            && self.port.now() >= self.from
        {
            self.done = true;
            self.port.skip(span);
            return Ok(None);
        }
        self.apply_drive_fault();
        self.unplugged()?;
        let until = self.port.now() + timeout;
        // Everything that arrives by then, damaged, in order of arrival at the client.
        while self
            .pending
            .front()
            .is_none_or(|(at, _)| *at > self.port.now())
        {
            let left = until.saturating_since(self.port.now());
            let next = self
                .pending
                .front()
                .map(|(at, _)| at.saturating_since(self.port.now()));
            let wait = next.map_or(left, |next| next.min(left));
            match self.port.read(buffer, wait)? {
                Some((count, at)) => {
                    let pieces = self.damage_answer(at, buffer[..count].to_vec());
                    for (at, piece) in pieces {
                        // A serial line keeps its order: late bytes delay those behind them.
                        let after = self.pending.back().map_or(at, |(last, _)| at.max(*last));
                        self.pending.push_back((after, piece));
                    }
                }
                None if self.port.now() >= until => break,
                None => {}
            }
        }
        match self.pending.front() {
            Some((at, _)) if *at <= self.port.now() => {}
            _ => return Ok(None),
        }
        let Some((at, bytes)) = self.pending.pop_front() else {
            return Ok(None);
        };
        buffer[..bytes.len()].copy_from_slice(&bytes);
        Ok(Some((bytes.len(), at.max(self.port.now()))))
    }

    fn now(&self) -> Stamp<Host> {
        self.port.now()
    }
}
