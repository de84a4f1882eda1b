use super::*;
use crate::port::{PortError, Pty, SerialPort};

use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use protocol::canopen::CobId;
use protocol::canopen::slcan::CommandDecoder;

fn elapsed(begin: Instant) -> Span {
    Span::from_nanos(i64::try_from(begin.elapsed().as_nanos()).unwrap())
}

/// Behaviour of an adapter.
#[derive(Clone, Copy, PartialEq)]
enum Behaviour {
    /// Answers CR to commands and `z` CR to frames, like CANUSB.
    Lawicel,
    /// Answers nothing, like some firmware of the CANable.
    Silent,
    /// Refuses the bit rate.
    NoBitrate,
    /// Accepts commands and refuses frames.
    NoFrames,
}

/// An adapter on a pseudo-terminal, with a node on its bus that returns each frame with an
/// identifier lower by 080.
struct Adapter {
    thread: JoinHandle<Vec<SlcanCommand>>,
    end: mpsc::Sender<()>,
    path: std::path::PathBuf,
}

fn bytes(replies: &[SlcanReply]) -> Vec<u8> {
    let mut out = Vec::new();
    for reply in replies {
        reply.encode(&mut out);
    }
    out
}

fn echo(frame: &CanFrame) -> SlcanReply {
    let id = frame.cob_id().unwrap().get() - 0x80;
    SlcanReply::Received {
        frame: CanFrame::new(CobId::new(id).unwrap(), frame.data()).unwrap(),
        stamp_ms: None,
    }
}

fn answer(behaviour: Behaviour, command: &SlcanCommand) -> Vec<SlcanReply> {
    match (behaviour, command) {
        (Behaviour::Silent, SlcanCommand::Transmit(frame)) => vec![echo(frame)],
        (Behaviour::Silent, _) => vec![],
        (Behaviour::NoBitrate, SlcanCommand::Bitrate(_)) => vec![SlcanReply::Refused],
        (Behaviour::NoFrames, SlcanCommand::Transmit(_)) => vec![SlcanReply::Refused],
        (_, SlcanCommand::Transmit(frame)) => vec![SlcanReply::Sent, echo(frame)],
        // CANUSB refuses to close a closed channel.
        (_, SlcanCommand::Empty | SlcanCommand::Close) => vec![SlcanReply::Refused],
        (_, _) => vec![SlcanReply::Done],
    }
}

impl Adapter {
    /// The bus sends `on_open` as soon as the channel is open.
    fn start(behaviour: Behaviour, on_open: &[u8]) -> Self {
        let mut pty = Pty::open().unwrap();
        let path = pty.path().to_owned();
        let (end, ended) = mpsc::channel();
        let on_open = on_open.to_vec();
        let thread = thread::spawn(move || {
            let mut decoder = CommandDecoder::new();
            let mut got = Vec::new();
            let mut buffer = [0; 64];
            let mut ending = false;
            loop {
                // Commands sent before the stop are still read.
                ending |= ended.try_recv().is_ok();
                let Some((n, _)) = pty.read(&mut buffer, Span::from_millis(20)).unwrap() else {
                    if ending {
                        return got;
                    }
                    continue;
                };
                for command in buffer[..n].iter().filter_map(|&b| decoder.push(b)) {
                    let command = command.unwrap();
                    let mut out = bytes(&answer(behaviour, &command));
                    if command == SlcanCommand::Open {
                        out.extend(&on_open);
                    }
                    got.push(command);
                    pty.write_frame(&out).unwrap();
                }
            }
        });
        Self { thread, end, path }
    }

    fn port(&self) -> SerialPort {
        SerialPort::open(&self.path, 115_200).unwrap()
    }

    /// Stops the adapter and returns the commands it received.
    fn stop(self) -> Vec<SlcanCommand> {
        self.end.send(()).unwrap();
        self.thread.join().unwrap()
    }
}

fn request() -> CanFrame {
    CanFrame::of(
        CobId::new(0x601).unwrap(),
        [0x40, 0x41, 0x60, 0, 0, 0, 0, 0],
    )
}

fn answered() -> CanFrame {
    CanFrame::new(CobId::new(0x581).unwrap(), request().data()).unwrap()
}

fn boot_up() -> CanFrame {
    CanFrame::of(CobId::new(0x701).unwrap(), [0])
}

#[test]
fn the_channel_is_configured_opened_and_closed() {
    for behaviour in [Behaviour::Lawicel, Behaviour::Silent] {
        let adapter = Adapter::start(behaviour, b"");
        let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
        assert_eq!(can.answers, behaviour == Behaviour::Lawicel);
        let before = can.write_frame(&request()).unwrap();
        let (frame, host) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, answered());
        assert!(before <= host);
        assert_eq!(can.read(Span::from_millis(20)).unwrap(), None);
        assert_eq!(
            (can.noise(), can.unanswered),
            (0, u32::from(behaviour == Behaviour::Silent))
        );
        drop(can);
        let mut commands = adapter.stop();
        // On a slow machine a status query may occur.
        commands.retain(|command| *command != SlcanCommand::Status);
        assert_eq!(
            commands,
            [
                SlcanCommand::Empty,
                SlcanCommand::Close,
                SlcanCommand::Bitrate(Bitrate::Kbit1000),
                SlcanCommand::Open,
                SlcanCommand::Transmit(request()),
                SlcanCommand::Close,
            ]
        );
    }
}

#[test]
fn frames_during_opening_are_kept() {
    let boot = bytes(&[SlcanReply::Received {
        frame: boot_up(),
        stamp_ms: None,
    }]);
    for behaviour in [Behaviour::Lawicel, Behaviour::Silent] {
        let adapter = Adapter::start(behaviour, &boot);
        let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
        let (frame, _) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, boot_up());
        drop(can);
        adapter.stop();
    }
}

#[test]
fn errors_name_the_refused_command() {
    let adapter = Adapter::start(Behaviour::NoBitrate, b"");
    let error = Slcan::open(adapter.port(), Bitrate::Kbit500).unwrap_err();
    assert_eq!(error.to_string(), "SLCAN adapter: refused S6, expected CR");
    adapter.stop();
}

#[test]
fn refused_frames_are_reported_once() {
    let adapter = Adapter::start(Behaviour::NoFrames, &bytes(&[echo(&request())]));
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    let (frame, _) = can.read(Span::from_secs(5)).unwrap().unwrap();
    assert_eq!(frame, answered());
    can.write_frame(&request()).unwrap();
    let error = can.read(Span::from_secs(5)).unwrap_err();
    assert!(matches!(error, CanError::NotSent), "{error}");
    assert_eq!(can.read(Span::from_millis(20)).unwrap(), None);
    drop(can);
    adapter.stop();
}

#[test]
fn noise_is_counted_and_frames_around_it_pass() {
    let good = bytes(&[echo(&request())]);
    let noise = [&good[..], b"\x00\xFFt58\r?\r\x07", &good].concat();
    let adapter = Adapter::start(Behaviour::Lawicel, &noise);
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    for _ in 0..2 {
        let (frame, _) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, answered());
    }
    // An invalid frame, an unknown line, a refusal without a command.
    assert_eq!(can.noise(), 3);
    drop(can);
    adapter.stop();
}

#[test]
fn timeouts_hold_while_other_answers_arrive() {
    let adapter = Adapter::start(Behaviour::Lawicel, b"");
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    for timeout in [Span::from_micros(-5), Span::ZERO, Span::from_millis(20)] {
        let begin = Instant::now();
        assert_eq!(can.read(timeout).unwrap(), None);
        assert!(elapsed(begin) >= timeout);
        assert!(elapsed(begin) < Span::from_secs(1));
    }
    drop(can);
    adapter.stop();
    // A port that always returns another CR.
    struct RepeatingPort;
    impl Port for RepeatingPort {
        fn write_frame(&mut self, _: &[u8]) -> Result<Stamp<Host>, PortError> {
            Ok(Stamp::from_nanos(0))
        }
        fn read(
            &mut self,
            buffer: &mut [u8],
            _: Span,
        ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
            thread::sleep(Duration::from_micros(100));
            buffer[0] = b'\r';
            Ok(Some((1, Stamp::from_nanos(0))))
        }
    }
    let mut can = Slcan::open(RepeatingPort, Bitrate::Kbit1000).unwrap();
    for timeout in [Span::ZERO, Span::from_millis(20)] {
        let begin = Instant::now();
        assert_eq!(can.read(timeout).unwrap(), None);
        assert!(elapsed(begin) < Span::from_secs(1));
    }
}

#[test]
fn an_unplugged_adapter_is_a_port_error() {
    let pty = Pty::open().unwrap();
    let port = SerialPort::open(pty.path(), 115_200).unwrap();
    let waiting = thread::spawn(move || Slcan::open(port, Bitrate::Kbit1000));
    thread::sleep(Duration::from_millis(20));
    drop(pty);
    let error = waiting.join().unwrap().unwrap_err();
    assert!(
        matches!(error, CanError::Port(PortError::Disconnected { .. })),
        "{error}"
    );
}

#[test]
fn frames_pass_both_ways() {
    let adapter = Adapter::start(Behaviour::Lawicel, b"");
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    let sent = can.write_frame(&request()).unwrap();
    let (frame, received) = can.read(Span::from_secs(5)).unwrap().unwrap();
    drop(can);
    adapter.stop();
    assert_eq!(frame, answered());
    assert!(sent <= received);
}

/// A port with a clock of its own that answers status queries with the given flags.
#[derive(Default)]
struct Scripted {
    now_s: i64,
    flags: Option<u8>,
    written: Vec<u8>,
    answers: Vec<u8>,
}

impl Port for Scripted {
    fn write_frame(&mut self, line: &[u8]) -> Result<Stamp<Host>, PortError> {
        self.written.extend(line);
        let reply = match (line[0], self.flags) {
            (b't', _) => SlcanReply::Sent,
            (b'F', None) => SlcanReply::Refused,
            (b'F', Some(flags)) => SlcanReply::Status(flags),
            _ => SlcanReply::Done,
        };
        reply.encode(&mut self.answers);
        Ok(self.now())
    }

    fn read(
        &mut self,
        buffer: &mut [u8],
        _: Span,
    ) -> Result<Option<(usize, Stamp<Host>)>, PortError> {
        let count = self.answers.len();
        buffer[..count].copy_from_slice(&std::mem::take(&mut self.answers));
        Ok((count > 0).then(|| (count, self.now())))
    }

    fn now(&self) -> Stamp<Host> {
        Stamp::from_nanos(self.now_s * 1_000_000_000)
    }
}

impl Scripted {
    fn status_queries(&self) -> usize {
        self.written.iter().filter(|byte| **byte == b'F').count()
    }
}

#[test]
fn the_status_is_queried_every_second() {
    let mut can = Slcan::open(Scripted::default(), Bitrate::Kbit1000).unwrap();
    can.port.flags = Some(0);
    // No flag, a full receive queue, an overrun, bus errors without loss, both losses.
    for (second, flags, dropped) in [
        (0, 0xFF, 0),
        (1, 0x00, 0),
        (2, 0x01, 1),
        (3, 0x08, 2),
        (4, 0xF6, 2),
        (5, 0x09, 3),
    ] {
        can.port.now_s = second;
        can.port.flags = Some(flags);
        // Two frames within a second cause one query.
        for _ in 0..2 {
            can.write_frame(&request()).unwrap();
            assert_eq!(can.read(Span::ZERO).unwrap(), None);
        }
        assert_eq!(can.dropped(), dropped, "{second} s: {flags:02X}");
        assert_eq!(can.port.status_queries(), usize::try_from(second).unwrap());
    }
    assert_eq!((can.noise(), can.unanswered), (0, 0));
}

#[test]
fn adapters_without_status_flags_are_queried_once() {
    let mut can = Slcan::open(Scripted::default(), Bitrate::Kbit1000).unwrap();
    for second in 1..5 {
        can.port.now_s = second;
        can.write_frame(&request()).unwrap();
        can.write_frame(&request()).unwrap();
        assert_eq!(can.read(Span::ZERO).unwrap(), None);
    }
    assert_eq!(
        (can.port.status_queries(), can.dropped(), can.noise()),
        (1, 0, 0)
    );
}
