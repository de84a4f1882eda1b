//! Tests on a CAN interface of the kernel. They are ignored by default; `tests/foreign/vcan/in-vm`
//! runs them in a virtual machine.

use protocol::canopen::{CobId, ExtendedId};
use socketcan::Frame as _;

use super::*;

const BUS: &str = "vcan0";

/// Two ports on the bus.
fn pair() -> (SocketCan, SocketCan) {
    (SocketCan::open(BUS).unwrap(), SocketCan::open(BUS).unwrap())
}

fn frames() -> Vec<CanFrame> {
    let id = |id| CobId::new(id).unwrap();
    let extended = ExtendedId::new(0x1234_5678).unwrap();
    vec![
        CanFrame::of(id(0x080), []),
        CanFrame::of(id(0x601), [0x40, 0x41, 0x60, 0, 0, 0, 0, 0]),
        CanFrame::of(CobId::MAX, [1, 2, 3]),
        CanFrame::of(extended, [0xAA]),
        CanFrame::remote(id(0x701), 1).unwrap(),
        CanFrame::remote(extended, 8).unwrap(),
    ]
}

/// The bytes of the kernel's `struct can_frame` (linux/can.h).
fn as_received(frame: &socketcan::CanFrame) -> [u8; SOCKETCAN_LEN] {
    let mut bytes = [0; SOCKETCAN_LEN];
    bytes[..4].copy_from_slice(&frame.id_word().to_ne_bytes());
    bytes[4] = u8::try_from(frame.dlc()).unwrap();
    bytes[8..8 + frame.data().len()].copy_from_slice(frame.data());
    bytes
}

#[test]
fn frames_convert_to_the_kernel_and_back() {
    for frame in frames() {
        let kernel = to_kernel(&frame).unwrap();
        assert_eq!(from_kernel(as_received(&kernel)), Some(frame));
        // The crate's view of the frame and our own bytes of a log agree.
        let bytes = frame.to_socketcan();
        let word = u32::from_be_bytes(*bytes.first_chunk().unwrap());
        assert_eq!(kernel.id_word(), word, "{frame}");
        assert_eq!(kernel.data(), frame.data());
    }
    let report = socketcan::CanErrorFrame::new_error(0x40, &[0; 8]).unwrap();
    assert_eq!(from_kernel(as_received(&report.into())), None);
}

#[test]
#[ignore = "needs the CAN interface vcan0"]
fn frames_pass_between_two_ports_with_kernel_times() {
    let (mut one, mut other) = pair();
    assert_eq!(one.name(), BUS);
    for frame in frames() {
        let sent = one.write_frame(&frame).unwrap();
        // The time is that of the transfer, not of the read.
        thread::sleep(Duration::from_millis(5));
        let before_read = clock::now();
        let (got, host) = other.read(Span::from_secs(5)).unwrap().unwrap();
        assert_eq!(got, frame);
        assert!(sent <= host && host < before_read, "{sent:?} {host:?}");
        // Own frames are not received.
        assert_eq!(one.read(Span::ZERO).unwrap(), None);
    }
}

#[test]
#[ignore = "needs the CAN interface vcan0"]
fn timeouts_hold_below_and_above_a_millisecond() {
    let (mut one, _other) = pair();
    for us in [-5, 0, 300, 20_000] {
        let begin = Instant::now();
        assert_eq!(one.read(Span::from_micros(us)).unwrap(), None);
        let waited = begin.elapsed();
        assert!(waited >= Duration::from_micros(u64::try_from(us).unwrap_or(0)));
        assert!(waited < Duration::from_secs(1), "{waited:?}");
    }
}

#[test]
fn open_errors_name_the_reason() {
    let error = SocketCan::open("nocan7").unwrap_err();
    assert!(
        matches!(error, CanError::NoCan { .. } | CanError::NoInterface { .. }),
        "{error}"
    );
    // The loopback interface is no CAN interface.
    let error = SocketCan::open("lo").unwrap_err();
    assert!(
        matches!(error, CanError::NoCan { .. } | CanError::NotCan { .. }),
        "{error}"
    );
}

/// Uses an interface of its own, which it takes down; adding one needs administrator rights.
#[test]
#[ignore = "needs the rights to add a CAN interface"]
fn errors_of_interfaces_that_are_down_name_the_command() {
    const OWN: &str = "vcan7";
    let ip = |arguments: &str| {
        std::process::Command::new("ip")
            .args(arguments.split(' '))
            .output()
            .is_ok_and(|output| output.status.success())
    };
    assert!(ip(&format!("link add {OWN} type vcan")));
    let never_up = SocketCan::open(OWN).map(drop);
    let listed_down = interfaces();
    assert!(ip(&format!("link set {OWN} up")));
    let listed_up = interfaces();
    let mut port = SocketCan::open(OWN).unwrap();
    assert_eq!(port.read(Span::ZERO).unwrap(), None);
    assert!(ip(&format!("link set {OWN} down")));
    let read = port.read(Span::from_secs(5)).map(drop);
    let written = port.write_frame(&frames()[0]).map(drop);
    assert!(ip(&format!("link del {OWN}")));
    let gone = port.write_frame(&frames()[0]).unwrap_err();
    for outcome in [never_up, read, written] {
        assert_eq!(
            outcome.unwrap_err().to_string(),
            "CAN interface vcan7: it is down; bring it up with `sudo ip link set vcan7 up`"
        );
    }
    assert!(matches!(gone, CanError::Disconnected { .. }), "{gone}");
    for (list, up) in [(listed_down, false), (listed_up, true)] {
        let name = OWN.to_owned();
        assert!(
            list.contains(&crate::can::CanInterface { name, up }),
            "{list:?}"
        );
    }
}

/// An unread socket buffers a number of frames. The kernel drops further ones and reports their
/// number with the next frame.
#[test]
#[ignore = "needs the CAN interface vcan0"]
fn dropped_frames_are_counted() {
    const SENT: u64 = 20_000;
    let (mut one, mut other) = pair();
    let frame = CanFrame::of(CobId::new(0x181).unwrap(), [7; 8]);
    for _ in 0..SENT {
        one.write_frame(&frame).unwrap();
    }
    let mut received = 0;
    while other.read(Span::from_millis(50)).unwrap().is_some() {
        received += 1;
    }
    assert!((100..SENT).contains(&received), "{received}");
    one.write_frame(&frame).unwrap();
    assert!(other.read(Span::from_secs(5)).unwrap().is_some());
    assert_eq!(received + other.dropped(), SENT);
}
