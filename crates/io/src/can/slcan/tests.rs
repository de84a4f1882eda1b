use super::*;
use crate::can::Recorder;
use crate::log::OwnedRecord;
use crate::port::{PortError, Pty, SerialPort};

use std::sync::mpsc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use protocol::canopen::CobId;
use protocol::canopen::slcan::CommandDecoder;
use protocol::record::Record;

fn elapsed(begin: Instant) -> Span {
    Span::from_nanos(i64::try_from(begin.elapsed().as_nanos()).unwrap())
}

/// How an adapter behaves towards commands and frames.
#[derive(Clone, Copy, PartialEq)]
enum Manner {
    /// CR to commands, `z` CR to frames, as CANUSB does.
    Lawicel,
    /// Nothing, as some firmware of the CANable does.
    Silent,
    /// BEL to the bit rate.
    NoBitrate,
    /// CR to commands, BEL to frames.
    NoFrames,
}

/// An adapter on a pseudo-terminal, with a node on its bus that sends each frame back with the
/// identifier 080 lower. It ends with the port or when told to, and says which commands it got.
struct Adapter {
    thread: JoinHandle<Vec<Command>>,
    end: mpsc::Sender<()>,
    path: std::path::PathBuf,
}

fn bytes(replies: &[Reply]) -> Vec<u8> {
    let mut out = Vec::new();
    for reply in replies {
        reply.encode(&mut out);
    }
    out
}

fn echo(frame: &CanFrame) -> Reply {
    let id = frame.cob_id().unwrap().get() - 0x80;
    Reply::Received {
        frame: CanFrame::new(CobId::new(id).unwrap(), frame.data()).unwrap(),
        stamp_ms: None,
    }
}

fn answer(manner: Manner, command: &Command) -> Vec<Reply> {
    match (manner, command) {
        (Manner::Silent, Command::Transmit(frame)) => vec![echo(frame)],
        (Manner::Silent, _) => vec![],
        (Manner::NoBitrate, Command::Bitrate(_)) => vec![Reply::Refused],
        (Manner::NoFrames, Command::Transmit(_)) => vec![Reply::Refused],
        (_, Command::Transmit(frame)) => vec![Reply::Sent, echo(frame)],
        // CANUSB refuses to close what is closed.
        (_, Command::Empty | Command::Close) => vec![Reply::Refused],
        (_, _) => vec![Reply::Done],
    }
}

impl Adapter {
    /// `on_open` is what the bus has to say as soon as the channel is open.
    fn start(manner: Manner, on_open: &[u8]) -> Self {
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
                // What was sent before the end was asked for is still heard.
                ending |= ended.try_recv().is_ok();
                let Some((n, _)) = pty.read(&mut buffer, Span::from_millis(20)).unwrap() else {
                    if ending {
                        return got;
                    }
                    continue;
                };
                for command in buffer[..n].iter().filter_map(|&b| decoder.push(b)) {
                    let command = command.unwrap();
                    let mut out = bytes(&answer(manner, &command));
                    if command == Command::Open {
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

    /// Ends it; the commands it got.
    fn stop(self) -> Vec<Command> {
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
fn the_channel_is_closed_set_and_opened_and_closed_again() {
    for manner in [Manner::Lawicel, Manner::Silent] {
        let adapter = Adapter::start(manner, b"");
        let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
        assert_eq!(can.answers(), manner == Manner::Lawicel);
        let before = can.write_frame(&request()).unwrap();
        let (frame, host) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, answered());
        assert!(before <= host);
        assert_eq!(can.read(Span::from_millis(20)).unwrap(), None);
        assert_eq!(
            (can.noise(), can.unanswered),
            (0, u32::from(manner == Manner::Silent))
        );
        drop(can);
        let mut commands = adapter.stop();
        // On a machine so slow that the adapter was asked for its status meanwhile.
        commands.retain(|command| *command != Command::Status);
        assert_eq!(
            commands,
            [
                Command::Empty,
                Command::Close,
                Command::Bitrate(Bitrate::Kbit1000),
                Command::Open,
                Command::Transmit(request()),
                Command::Close,
            ]
        );
    }
}

#[test]
fn what_the_bus_says_at_once_is_not_lost() {
    let boot = bytes(&[Reply::Received {
        frame: boot_up(),
        stamp_ms: None,
    }]);
    for manner in [Manner::Lawicel, Manner::Silent] {
        let adapter = Adapter::start(manner, &boot);
        let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
        let (frame, _) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, boot_up());
        drop(can);
        adapter.stop();
    }
}

#[test]
fn a_refused_command_is_named() {
    let adapter = Adapter::start(Manner::NoBitrate, b"");
    let error = Slcan::open(adapter.port(), Bitrate::Kbit500).unwrap_err();
    assert_eq!(error.to_string(), "SLCAN adapter: refused S6, expected CR");
    adapter.stop();
}

#[test]
fn a_refused_frame_is_told_once_and_the_port_goes_on() {
    let adapter = Adapter::start(Manner::NoFrames, &bytes(&[echo(&request())]));
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
fn noise_is_counted_and_frames_around_it_come_through() {
    let good = bytes(&[echo(&request())]);
    let noise = [&good[..], b"\x00\xFFt58\r?\r\x07", &good].concat();
    let adapter = Adapter::start(Manner::Lawicel, &noise);
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    for _ in 0..2 {
        let (frame, _) = can.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(frame, answered());
    }
    // A line that is no frame, a line that is nothing, a refusal of nothing.
    assert_eq!(can.noise(), 3);
    drop(can);
    adapter.stop();
}

#[test]
fn timeouts_hold_even_while_answers_without_frames_come() {
    let adapter = Adapter::start(Manner::Lawicel, b"");
    let mut can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    for timeout in [Span::from_micros(-5), Span::ZERO, Span::from_millis(20)] {
        let begin = Instant::now();
        assert_eq!(can.read(timeout).unwrap(), None);
        assert!(elapsed(begin) >= timeout);
        assert!(elapsed(begin) < Span::from_secs(1));
    }
    drop(can);
    adapter.stop();
    // A port that always has another "done" to give.
    struct Chatter;
    impl Port for Chatter {
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
    let mut can = Slcan::open(Chatter, Bitrate::Kbit1000).unwrap();
    for timeout in [Span::ZERO, Span::from_millis(20)] {
        let begin = Instant::now();
        assert_eq!(can.read(timeout).unwrap(), None);
        assert!(elapsed(begin) < Span::from_secs(1));
    }
}

#[test]
fn an_unplugged_adapter_is_the_ports_error() {
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
fn a_recorder_around_it_keeps_frames_and_not_lines() {
    let adapter = Adapter::start(Manner::Lawicel, b"");
    let can = Slcan::open(adapter.port(), Bitrate::Kbit1000).unwrap();
    let mut seen = Vec::new();
    let mut can = Recorder::new(can, |record: &Record<'_>| {
        seen.push(OwnedRecord::from(record));
    });
    let sent = can.write_frame(&request()).unwrap();
    let (_, received) = can.read(Span::from_secs(5)).unwrap().unwrap();
    drop(can);
    adapter.stop();
    let frames: Vec<_> = seen
        .iter()
        .map(|record| match record.as_record().wire {
            protocol::record::Wire::Drive { frame, .. } => {
                (record.host(), CanFrame::from_socketcan(frame).unwrap())
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(frames, [(sent, request()), (received, answered())]);
}

/// A port with a clock of its own that answers each line as the script says; what was written is
/// kept.
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
            (b't', _) => Reply::Sent,
            (b'F', None) => Reply::Refused,
            (b'F', Some(flags)) => Reply::Status(flags),
            _ => Reply::Done,
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
    fn questions(&self) -> usize {
        self.written.iter().filter(|byte| **byte == b'F').count()
    }
}

#[test]
fn an_adapter_is_asked_every_second_whether_it_lost_frames() {
    let mut can = Slcan::open(Scripted::default(), Bitrate::Kbit1000).unwrap();
    can.port.flags = Some(0);
    // Nothing, a full receive queue, an overrun, errors of the bus that lost nothing, both losses.
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
        // Two in a second: it is asked once.
        for _ in 0..2 {
            can.write_frame(&request()).unwrap();
            assert_eq!(can.read(Span::ZERO).unwrap(), None);
        }
        assert_eq!(can.dropped(), dropped, "{second} s: {flags:02X}");
        assert_eq!(can.port.questions(), usize::try_from(second).unwrap());
    }
    assert_eq!((can.noise(), can.unanswered), (0, 0));
}

#[test]
fn an_adapter_without_status_flags_is_asked_once_and_refuses_no_frame_by_that() {
    let mut can = Slcan::open(Scripted::default(), Bitrate::Kbit1000).unwrap();
    for second in 1..5 {
        can.port.now_s = second;
        can.write_frame(&request()).unwrap();
        can.write_frame(&request()).unwrap();
        assert_eq!(can.read(Span::ZERO).unwrap(), None);
    }
    assert_eq!(
        (can.port.questions(), can.dropped(), can.noise()),
        (1, 0, 0)
    );
}
