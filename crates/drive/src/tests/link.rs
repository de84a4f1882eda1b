//! The link with every kind of loss, and with arbitrary input.

use proptest::prelude::*;
use protocol::canopen::CanFrame;
use protocol::canopen::sdo::{self, Expedited, Initiate};
use protocol::epos2::AbortCode;
use protocol::epos2::message::{ReadObject, SerialAnswer, SerialRequest as Wire, WriteObject};
use protocol::epos2::objects::Address;
use protocol::epos2::usb::{self, UsbDecoder};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use crate::codec::Codec;
use crate::exchange::ObjectAccess;
use crate::link::{LinkRequest, RequestFailure, RequestLink};
use crate::request_matcher::PROBES;
use crate::{AxisConfig, DriveClient, DriveCommand};

const TIMEOUT: Span = Span::from_millis(100);

fn request(index: u16, access: ObjectAccess) -> LinkRequest {
    LinkRequest {
        address: Address::new(index, 0),
        access,
        timeout: TIMEOUT,
        probe_timeout: TIMEOUT,
        retries: 2,
        silence_limit: Span::ZERO,
        is_urgent: false,
        is_last_attempt: false,
    }
}

fn read(index: u16) -> LinkRequest {
    request(index, ObjectAccess::Read)
}

fn at(ms: i64) -> Stamp<Host> {
    Stamp::from_nanos(ms * 1_000_000)
}

fn answer(value: u32) -> Vec<u8> {
    usb::to_bytes(&ReadObject::answer(Ok(value))).to_vec()
}

/// The reply to a probe.
fn absent(kind: usize) -> Vec<u8> {
    usb::to_bytes(&ReadObject::answer(Err(PROBES[kind].1))).to_vec()
}

fn probe(kind: usize) -> Vec<u8> {
    Codec::usb(1).encode(PROBES[kind].0, ObjectAccess::Read, at(0))
}

fn value(link: &mut RequestLink) -> Option<u32> {
    link.take_result()?.ok()?.reply.value()
}

#[test]
fn a_late_reply_does_not_answer_the_next_request() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    let first = link.transmit(at(0)).unwrap();
    link.abandon();
    link.submit(read(0x6041));
    assert_eq!(link.transmit(at(1)), None, "the first is still awaited");
    assert_eq!(link.deadline(), Some(at(51)), "but not for long");
    assert_eq!(link.transmit(at(51)), Some(probe(0)));
    link.handle_input(&answer(1), at(52));
    assert_eq!(
        link.take_result(),
        None,
        "the late answer belongs to no request"
    );
    link.handle_input(&absent(0), at(53));
    let second = link.transmit(at(53)).unwrap();
    assert_ne!(first, second);
    link.handle_input(&answer(2), at(54));
    let answered = link.take_result().unwrap().unwrap();
    assert_eq!(answered.reply.value(), Some(2));
    assert_eq!((answered.sent, answered.received), (at(53), at(54)));
}

#[test]
fn reads_are_repeated_a_bounded_number_of_times() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    let mut now = at(0);
    let mut sent = 0;
    let lost = loop {
        if let Some(frame) = link.transmit(now) {
            match (0..2).find(|&kind| frame == probe(kind)) {
                Some(kind) => link.handle_input(&absent(kind), now),
                None => sent += 1,
            }
        }
        if let Some(result) = link.take_result() {
            break result.unwrap_err();
        }
        now = link.deadline().unwrap_or(now);
        link.expire(now);
    };
    assert_eq!(sent, 3);
    assert_eq!(
        lost,
        RequestFailure::NoReply {
            attempts: 3,
            damaged: false
        }
    );
}

#[test]
fn a_request_is_repeated_at_once_after_a_damaged_reply() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    link.transmit(at(0)).unwrap();
    let mut bad = answer(7);
    bad[10] ^= 1;
    link.handle_input(&bad, at(2));
    assert_eq!(link.transmit(at(2)), Some(probe(0)));
    link.handle_input(&absent(0), at(4));
    assert!(link.transmit(at(4)).is_some());
    link.handle_input(&answer(7), at(6));
    assert_eq!(value(&mut link), Some(7));
}

#[test]
fn noise_before_a_reply_does_not_lose_it() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(request(0x6040, ObjectAccess::Write { value: 0, width: 2 }));
    link.transmit(at(0)).unwrap();
    link.handle_input(&[0x90, 2, 0x33, 1, 1, 1, 1, 1], at(1));
    assert_eq!(link.transmit(at(1)), Some(probe(0)));
    // The write's own reply precedes the probe's: it was executed.
    link.handle_input(&usb::to_bytes(&WriteObject::answer(Ok(()))), at(2));
    assert!(link.take_result().unwrap().is_ok());
}

#[test]
fn an_urgent_request_does_not_wait_for_the_probe() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    link.transmit(at(0)).unwrap();
    link.expire(at(100));
    assert_eq!(link.transmit(at(100)), Some(probe(0)));
    link.abandon();
    let stop = request(
        0x6040,
        ObjectAccess::Write {
            value: 0x0B,
            width: 2,
        },
    );
    link.submit(LinkRequest {
        is_urgent: true,
        ..stop
    });
    let frame = Codec::usb(1).encode(stop.address, stop.access, at(0));
    assert_eq!(link.transmit(at(101)), Some(frame.clone()));
    assert_eq!(link.transmit(at(101)), None, "once");
    link.handle_input(&absent(0), at(102));
    link.handle_input(&usb::to_bytes(&WriteObject::answer(Ok(()))), at(103));
    assert!(link.take_result().unwrap().is_ok());
}

/// The host did not run while the reply came: the reply waits to be read.
#[test]
fn a_delayed_host_still_reads_the_reply() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    link.transmit(at(0)).unwrap();
    link.postpone(Span::from_millis(1_900));
    assert_eq!(link.deadline(), Some(at(2_000)));
    assert_eq!(link.transmit(at(1_900)), None);
    link.handle_input(&answer(7), at(1_900));
    assert_eq!(value(&mut link), Some(7));
}

/// The same in the middle of an RS232 dialogue.
#[test]
fn a_delayed_host_continues_its_dialogue() {
    let mut link = RequestLink::new(Codec::new(DriveLink::Rs232, 1));
    link.submit(read(0x6064));
    assert_eq!(link.transmit(at(0)).unwrap().len(), 1, "the opcode");
    link.postpone(Span::from_millis(1_900));
    assert_eq!(link.transmit(at(1_900)), None);
    link.handle_input(b"O", at(1_900));
    assert!(link.transmit(at(1_901)).unwrap().len() > 6, "the body");
}

/// And while a link is desynchronised: the delay uses up none of the time for probes.
#[test]
fn a_delayed_host_goes_on_probing() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    link.transmit(at(0)).unwrap();
    assert_eq!(link.transmit(at(100)), Some(probe(0)));
    link.postpone(Span::from_secs(2));
    // The reply to the request was late, and the host read it after its delay.
    link.handle_input(&answer(7), at(2_110));
    assert_eq!(value(&mut link), Some(7));
    link.submit(read(0x6064));
    link.handle_input(&absent(0), at(2_120));
    assert!(link.transmit(at(2_121)).is_some(), "the next request");
}

#[test]
fn silence_is_reported_after_two_probes() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    let mut frames = Vec::new();
    let mut now = at(0);
    let end = loop {
        frames.extend(link.transmit(now));
        if let Some(end) = link.take_result() {
            break end;
        }
        now = link.deadline().unwrap();
        link.expire(now);
    };
    assert_eq!(frames[1..], [probe(0), probe(1)]);
    assert_eq!(
        end,
        Err(RequestFailure::LinkLost {
            silent: Span::from_millis(300)
        })
    );
    // The link recovers: outstanding replies are identified, then requests work again.
    link.submit(read(0x6041));
    assert_eq!(link.transmit(at(400)), Some(probe(1)));
    for late in [answer(1), absent(0), absent(1), absent(1)] {
        link.handle_input(&late, at(401));
    }
    assert_eq!(link.take_result(), None);
    assert!(link.transmit(at(402)).is_some());
    link.handle_input(&answer(2), at(403));
    assert_eq!(value(&mut link), Some(2));
}

#[test]
fn a_lost_probe_reply_does_not_keep_the_link_desynchronised() {
    let mut link = RequestLink::new(Codec::usb(1));
    link.submit(read(0x6064));
    link.transmit(at(0)).unwrap();
    assert_eq!(link.transmit(at(100)), Some(probe(0)));
    assert_eq!(link.transmit(at(200)), Some(probe(1)));
    link.handle_input(&absent(1), at(201));
    assert!(link.transmit(at(201)).is_some());
    link.handle_input(&answer(9), at(202));
    assert_eq!(value(&mut link), Some(9));
}

#[test]
fn a_request_rejected_for_its_checksum_is_repeated_even_if_it_writes() {
    let mut link = RequestLink::new(Codec::usb(1));
    let write = LinkRequest {
        retries: 0,
        ..request(0x607A, ObjectAccess::Write { value: 5, width: 2 })
    };
    link.submit(write);
    let first = link.transmit(at(0)).unwrap();
    link.handle_input(
        &usb::to_bytes(&WriteObject::answer(Err(AbortCode::CRC))),
        at(1),
    );
    assert_eq!(link.take_result(), None);
    assert_eq!(link.transmit(at(1)), Some(first));
    link.handle_input(&usb::to_bytes(&WriteObject::answer(Ok(()))), at(2));
    assert!(link.take_result().unwrap().is_ok());
}

/// Fault of a reply.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    IsLost,
    IsDamaged,
    TakesMs(u16),
}

fn fate() -> impl Strategy<Value = Fate> {
    prop_oneof![
        6 => Just(Fate::Arrives),
        1 => Just(Fate::IsLost),
        1 => Just(Fate::IsDamaged),
        2 => (1..260u16).prop_map(Fate::TakesMs),
    ]
}

/// A device whose object at index i has the value i.
fn serve(frame: &[u8]) -> Vec<u8> {
    let mut decoder = UsbDecoder::new();
    let frame = frame
        .iter()
        .find_map(|&b| decoder.push(b))
        .unwrap()
        .unwrap();
    let answer = match Wire::parse(&frame).unwrap().unwrap() {
        Wire::ReadObject(read) => {
            let probe = PROBES.iter().find(|(address, _)| *address == read.address);
            ReadObject::answer(match probe {
                Some((_, error)) => Err(*error),
                None => Ok(u32::from(read.address.index)),
            })
        }
        Wire::WriteObject(_) => WriteObject::answer(Ok(())),
        other => panic!("{other:?}"),
    };
    usb::to_bytes(&answer).to_vec()
}

/// A device that replies with the number of the request.
fn count(attached: DriveLink, frame: &[u8], number: u32) -> Vec<u8> {
    let outcome = |address| match PROBES.iter().find(|(probe, _)| *probe == address) {
        Some((_, error)) => Err(*error),
        None => Ok(number),
    };
    if attached == DriveLink::Usb {
        let mut decoder = UsbDecoder::new();
        let frame = frame.iter().find_map(|&b| decoder.push(b)).unwrap();
        let read = ReadObject::parse(&frame.unwrap()).unwrap();
        return usb::to_bytes(&ReadObject::answer(outcome(read.address))).to_vec();
    }
    let frame = CanFrame::from_socketcan(frame).unwrap();
    let (node, request) = sdo::SdoRequest::parse(&frame).unwrap();
    let sdo::SdoRequest::InitiateUpload { address } = request else {
        panic!("{request:?}")
    };
    let answer = match outcome(address) {
        Ok(number) => sdo::SdoResponse::InitiateUpload {
            address,
            transfer: Initiate::Expedited(Expedited::of(number)),
        },
        Err(error) => sdo::SdoResponse::Abort { address, error },
    };
    answer.to_frame(node).to_socketcan().to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// With any loss, damage or delay, a reply belongs to its request, and every request ends.
    #[test]
    fn replies_belong_to_their_requests(
        fates in proptest::collection::vec(fate(), 1..60),
        abandons in proptest::collection::vec(any::<bool>(), 12),
    ) {
        let mut link = RequestLink::new(Codec::usb(1));
        let mut wire: Vec<(Stamp<Host>, Vec<u8>)> = Vec::new();
        let mut fates = fates.into_iter().cycle();
        let mut now = at(0);
        for (n, abandon) in (0u16..).zip(abandons) {
            let access = if n % 4 == 3 { ObjectAccess::Write { value: 1, width: 2 } } else { ObjectAccess::Read };
            let retries = if n % 4 == 3 { 0 } else { 2 };
            link.submit(LinkRequest { retries, ..request(0x6000 + n, access) });
            let began = now;
            for _ in 0..400 {
                if let Some(frame) = link.transmit(now) {
                    let earliest = wire.last().map_or(now, |w| w.0.max(now));
                    let mut bytes = serve(&frame);
                    match fates.next().unwrap() {
                        Fate::Arrives => wire.push((earliest + Span::from_millis(1), bytes)),
                        Fate::IsLost => {}
                        Fate::IsDamaged => {
                            bytes[2] ^= 0x40;
                            wire.push((earliest + Span::from_millis(1), bytes));
                        }
                        Fate::TakesMs(ms) => wire.push((earliest + Span::from_millis(ms.into()), bytes)),
                    }
                }
                if let Some(end) = link.take_result() {
                    if let Ok(answered) = end {
                        let value = (access == ObjectAccess::Read).then_some(u32::from(0x6000 + n));
                        prop_assert_eq!(answered.reply.value(), value);
                        prop_assert_eq!(answered.reply.error(), AbortCode::NONE);
                        prop_assert!(answered.sent >= began && answered.received == now);
                    }
                    break;
                }
                if abandon && now > began + Span::from_millis(30) {
                    link.abandon();
                    break;
                }
                let next = [wire.first().map(|w| w.0), link.deadline()];
                now = next.into_iter().flatten().min().unwrap().max(now);
                while wire.first().is_some_and(|w| w.0 <= now) {
                    let (_, bytes) = wire.remove(0);
                    link.handle_input(&bytes, now);
                }
                link.expire(now);
            }
            prop_assert!(now - began < Span::from_secs(3));
        }
    }

    /// The same object read repeatedly on both links without handshake: each value was read for the
    /// request whose time it has.
    #[test]
    fn values_are_not_older_than_their_requests(
        fates in proptest::collection::vec(fate(), 1..80),
        on_can in any::<bool>(),
        abandons in proptest::collection::vec(prop::bool::weighted(0.3), 16),
    ) {
        let attached = if on_can { DriveLink::Can } else { DriveLink::Usb };
        let mut link = RequestLink::new(Codec::new(attached, 1));
        let mut wire: Vec<(Stamp<Host>, Vec<u8>)> = Vec::new();
        let mut fates = fates.into_iter().cycle();
        let mut sent: Vec<Stamp<Host>> = Vec::new();
        let mut now = at(0);
        for abandon in abandons {
            link.submit(read(0x6064));
            let began = now;
            for _ in 0..400 {
                if let Some(frame) = link.transmit(now) {
                    let earliest = wire.last().map_or(now, |w| w.0.max(now));
                    sent.push(now);
                    let mut bytes = count(attached, &frame, sent.len() as u32);
                    match fates.next().unwrap() {
                        Fate::Arrives => wire.push((earliest + Span::from_millis(1), bytes)),
                        Fate::IsLost => {}
                        Fate::IsDamaged => {
                            bytes[4] ^= 0x41;
                            wire.push((earliest + Span::from_millis(1), bytes));
                        }
                        Fate::TakesMs(ms) => wire.push((earliest + Span::from_millis(ms.into()), bytes)),
                    }
                }
                if let Some(end) = link.take_result() {
                    if let Ok(answered) = end {
                        let value = answered.reply.value().unwrap() as usize;
                        prop_assert_eq!(sent[value - 1], answered.sent);
                        prop_assert!(answered.sent >= began);
                    }
                    break;
                }
                if abandon && now > began + Span::from_millis(30) {
                    link.abandon();
                    break;
                }
                let next = [wire.first().map(|w| w.0), link.deadline()];
                now = next.into_iter().flatten().min().unwrap().max(now);
                while wire.first().is_some_and(|w| w.0 <= now) {
                    let (_, bytes) = wire.remove(0);
                    link.handle_input(&bytes, now);
                }
                link.expire(now);
            }
            prop_assert!(now - began < Span::from_secs(3));
        }
    }

    /// With arbitrary input there is no panic, only one request at a time, and every command ends.
    #[test]
    fn the_client_survives_arbitrary_bytes(
        inputs in proptest::collection::vec(
            prop_oneof![
                proptest::collection::vec(any::<u8>(), 0..30),
                Just(usb::to_bytes(&WriteObject::answer(Ok(()))).to_vec()),
                any::<u32>().prop_map(answer),
                any::<u32>().prop_map(|code| {
                    usb::to_bytes(&SerialAnswer::bare(AbortCode(code)).to_frame()).to_vec()
                }),
            ],
            0..60,
        ),
        stop_after in 0..60usize,
        on_can in any::<bool>(),
    ) {
        let attached = if on_can { DriveLink::Can } else { DriveLink::Usb };
        let mut client = DriveClient::new(AxisConfig::default(), attached);
        client.start(DriveCommand::Connect).unwrap();
        let mut now = at(0);
        for (n, bytes) in inputs.iter().enumerate() {
            if n == stop_after {
                client.start(DriveCommand::Stop).unwrap();
            }
            while client.poll_transmit(now).is_some() {}
            now += Span::from_millis(1);
            client.handle_input(bytes, now);
        }
        for _ in 0..4000 {
            while client.poll_transmit(now).is_some() {}
            let Some(next) = client.poll_timeout() else { break };
            now = next.max(now + Span::from_nanos(1));
            client.handle_timeout(now);
        }
        prop_assert_eq!(client.running(), None);
    }
}
