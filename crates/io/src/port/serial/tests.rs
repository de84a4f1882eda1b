use std::thread;
use std::time::{Duration, Instant};

use super::*;
use crate::clock;
use crate::port::wait::duration;
use crate::port::{Pty, RecordingPort};

fn pair() -> (Pty, SerialPort) {
    let pty = Pty::open().unwrap();
    let port = SerialPort::open(pty.path(), 1_000_000).unwrap();
    (pty, port)
}

fn read_all(port: &mut impl Port, wanted: usize) -> Vec<u8> {
    let mut out = Vec::new();
    let mut buffer = [0; 64];
    while out.len() < wanted {
        let (n, _) = port
            .read(&mut buffer, Span::from_secs(5))
            .unwrap()
            .expect("bytes within 5 s");
        out.extend(&buffer[..n]);
    }
    out
}

#[test]
fn all_byte_values_pass_both_ways() {
    let (mut pty, mut port) = pair();
    // All 256 values, including ^C, ^D, XON, XOFF, CR and LF.
    let all: Vec<u8> = (0..=255).collect();
    let before = clock::now();
    let wrote = port.write_frame(&all).unwrap();
    assert_eq!(read_all(&mut pty, 256), all);
    pty.write_frame(&all).unwrap();
    assert_eq!(read_all(&mut port, 256), all);
    assert!(before <= wrote && wrote <= clock::now());
    assert_eq!(port.latency, LatencyTimer::Unknown);
}

#[test]
fn timeouts_hold_below_and_above_a_millisecond() {
    let (mut pty, mut port) = pair();
    let mut buffer = [0; 16];
    for timeout in [
        Span::from_micros(-5),
        Span::ZERO,
        Span::from_micros(300),
        Span::from_millis(20),
    ] {
        for port in [&mut pty as &mut dyn Port, &mut port] {
            let start = Instant::now();
            assert!(port.read(&mut buffer, timeout).unwrap().is_none());
            let waited = start.elapsed();
            assert!(waited >= duration(timeout), "{waited:?} of {timeout:?}");
            assert!(waited < Duration::from_secs(1), "{waited:?} of {timeout:?}");
        }
    }
    assert!(port.read(&mut [], Span::from_millis(1)).unwrap().is_none());
}

#[test]
fn a_read_returns_the_time_after_the_bytes() {
    let (mut pty, mut port) = pair();
    let answering = thread::spawn(move || {
        thread::sleep(Duration::from_millis(30));
        (pty.write_frame(b"answer").unwrap(), pty)
    });
    let mut buffer = [0; 16];
    let (n, read) = port.read(&mut buffer, Span::from_secs(5)).unwrap().unwrap();
    let (wrote, _pty) = answering.join().unwrap();
    assert_eq!(&buffer[..n], b"answer");
    assert!(wrote <= read, "{wrote:?} {read:?}");
}

#[test]
fn an_unplugged_device_is_disconnected_on_read_and_write() {
    let (pty, mut port) = pair();
    let waiting = thread::spawn(move || {
        let read = port.read(&mut [0; 16], Span::from_secs(10));
        (port, read)
    });
    thread::sleep(Duration::from_millis(50));
    drop(pty);
    let (mut port, read) = waiting.join().unwrap();
    let error = read.unwrap_err();
    assert!(matches!(error, PortError::Disconnected { .. }), "{error}");
    let error = port.write_frame(b"x").unwrap_err();
    assert!(matches!(error, PortError::Disconnected { .. }), "{error}");
}

#[test]
fn ports_are_exclusive_and_can_be_reopened() {
    let (mut pty, mut port) = pair();
    let error = SerialPort::open(pty.path(), 1_000_000).unwrap_err();
    assert!(matches!(error, PortError::Busy { .. }), "{error}");
    pty.write_frame(b"left unread").unwrap();
    // Time for the bytes to reach the queue of the client.
    let first = read_all(&mut port, 1);
    assert!(b"left unread".starts_with(&first));
    pty.write_frame(b"left unread too").unwrap();
    drop(port);
    let mut port = SerialPort::open(pty.path(), 115_200).unwrap();
    pty.write_frame(b"fresh").unwrap();
    assert_eq!(read_all(&mut port, 5), b"fresh");
}

#[test]
fn a_client_that_does_not_read_is_a_write_timeout() {
    let (mut pty, _port) = pair();
    let block = [0x55; 1024];
    let error = (0..1000)
        .find_map(|_| pty.write_frame(&block).err())
        .expect("the queue is finite");
    assert!(
        matches!(error, PortError::WriteTimeout { expected: 1024, .. }),
        "{error}"
    );
}

#[test]
fn open_errors_name_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let missing = SerialPort::open(folder.path().join("ttyUSB7"), 115_200).unwrap_err();
    assert!(matches!(missing, PortError::NotFound { .. }), "{missing}");
    let file = folder.path().join("file");
    fs::write(&file, "x").unwrap();
    let unsuitable = SerialPort::open(&file, 115_200).unwrap_err();
    assert!(
        matches!(unsuitable, PortError::Unsuitable { baud: 115_200, .. }),
        "{unsuitable}"
    );
}

#[test]
fn the_latency_timer_is_set_if_present() {
    let sysfs = tempfile::tempdir().unwrap();
    let dev = tempfile::tempdir().unwrap();
    let port = dev.path().join("ttyUSB0");
    fs::write(&port, "").unwrap();
    let by_id = dev.path().join("usb-maxon_motor_EPOS2-if00");
    std::os::unix::fs::symlink(&port, &by_id).unwrap();
    assert_eq!(latency_file(sysfs.path(), &by_id), None);
    let device = sysfs.path().join("class/tty/ttyUSB0/device");
    fs::create_dir_all(&device).unwrap();
    fs::write(device.join("latency_timer"), "16\n").unwrap();
    let file = latency_file(sysfs.path(), &by_id).unwrap();
    assert_eq!(set_latency(&file), LatencyTimer::Low);
    assert_eq!(fs::read_to_string(&file).unwrap(), "1");
    // A directory in its place is neither readable nor writable.
    assert_eq!(set_latency(&device), LatencyTimer::Unknown);
}

#[test]
fn a_recording_port_does_not_split_frames() {
    let (mut pty, port) = pair();
    let answer = [0x90, 2, 0, 4, 0, 0, 0, 0, 0x37, 2, 0, 0, 0x68, 0];
    let mut seen = Vec::new();
    {
        let mut port = RecordingPort::new(port, protocol::record::DriveLink::Usb, |record| {
            seen.push(crate::log::OwnedRecord::from(record));
        });
        port.write_frame(b"question").unwrap();
        assert_eq!(read_all(&mut pty, 8), b"question");
        for half in answer.chunks(5) {
            pty.write_frame(half).unwrap();
            assert_eq!(read_all(&mut port, half.len()), half);
        }
    }
    let frames: Vec<_> = seen
        .iter()
        .map(|record| match record.as_record().wire {
            protocol::record::Wire::Drive { frame, .. } => frame.to_vec(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(frames, [b"question".to_vec(), answer.to_vec()]);
}
