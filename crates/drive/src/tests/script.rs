//! The first frames of commands, byte for byte in the Communication Guide's format.

use units::{Span, Stamp};

use crate::{
    AxisConfig, CommandProgress, DriveClient, DriveCommand, DriveError, DriveEvent, DriveLink,
};

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|byte| u8::from_str_radix(byte, 16).unwrap())
        .collect()
}

/// Quick stop, then statusword and position; the replies are the guide's examples.
#[test]
fn stop_sends_the_frames_of_the_communication_guide() {
    let mut client = DriveClient::new(AxisConfig::default(), DriveLink::Usb);
    let mut now = Stamp::from_nanos(0);
    client.start(DriveCommand::Stop).unwrap();
    let quick_stop = client.poll_transmit(now).unwrap();
    assert_eq!(quick_stop[..12], hex("90 02 11 04 40 60 00 01 0B 00 00 00"));
    assert_eq!(client.poll_transmit(now), None, "one request at a time");
    now += Span::from_millis(2);
    client.handle_input(&hex("90 02 00 02 00 00 00 00 40 8B"), now);
    assert_eq!(
        client.poll_transmit(now).unwrap(),
        hex("90 02 10 02 64 60 00 01 52 A2")
    );
    // The reply arrives in three portions and has the time of the last.
    for part in ["90 02 00 04 00 00", "00 00 00 00 90 90", "80 14 35"] {
        now += Span::from_millis(1);
        client.handle_input(&hex(part), now);
    }
    let events: Vec<_> = std::iter::from_fn(|| client.poll_event()).collect();
    let [
        DriveEvent::Progress(CommandProgress::Started(_)),
        DriveEvent::Sample(sample),
    ] = events[..]
    else {
        panic!("{events:?}")
    };
    assert_eq!(sample.request, Stamp::from_nanos(2_000_000));
    assert_eq!(sample.answer, Stamp::from_nanos(5_000_000));
    assert_eq!(sample.position.0, 0x8090_0000u32 as i32);
}

#[test]
fn a_refusal_by_the_drive_is_reported() {
    for refusal in [
        "90 02 00 02 00 00 02 06 A4 01",
        "90 02 00 04 00 00 02 06 00 00 00 00 57 64",
    ] {
        let mut client = DriveClient::new(AxisConfig::default(), DriveLink::Usb);
        client.start(DriveCommand::Status).unwrap();
        let now = Stamp::from_nanos(0);
        client.poll_transmit(now).unwrap();
        client.handle_input(&hex(refusal), now);
        let events: Vec<_> = std::iter::from_fn(|| client.poll_event()).collect();
        let [
            _,
            DriveEvent::Failed(DriveError::Refused { operation, error }),
        ] = &events[..]
        else {
            panic!("{events:?}")
        };
        assert_eq!(operation.to_string(), "reading object 1000:00");
        assert_eq!(error.0, 0x0602_0000);
    }
}
