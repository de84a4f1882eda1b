//! Features of RS232: a dialogue with missing bytes, and drives that stay behind in it.

use proptest::prelude::*;
use protocol::epos2::message::{ReadObject, SerialRequest as Wire, WriteObject};
use protocol::epos2::objects::Address;
use protocol::epos2::rs232::{BodyDecoder, FAILED, OKAY, encode_body};
use protocol::epos2::{AbortCode, SerialFrame};
use protocol::record::DriveLink;
use units::{Host, Span, Stamp};

use crate::codec::Codec;
use crate::exchange::ObjectAccess;
use crate::link::{LinkRequest, RequestFailure, RequestLink};
use crate::request_matcher::PROBES;
use crate::{AxisConfig, DriveClient, DriveCommand, DriveError, DriveEvent};

fn at(us: i64) -> Stamp<Host> {
    Stamp::from_nanos(us * 1_000)
}

fn request(index: u16, access: ObjectAccess) -> LinkRequest {
    LinkRequest {
        address: Address::new(index, 0),
        access,
        timeout: Span::from_millis(100),
        probe_timeout: Span::from_millis(100),
        retries: if access == ObjectAccess::Read { 2 } else { 0 },
        silence_limit: Span::ZERO,
        is_urgent: false,
        is_last_attempt: false,
    }
}

/// A drive whose object at index i has the value i.
struct ScriptedDrive {
    state: UnitState,
    observed: Stamp<Host>,
    executed: Vec<Wire>,
}

enum UnitState {
    Opcode,
    Body(BodyDecoder),
    Ready(SerialFrame),
    Receipt,
}

impl ScriptedDrive {
    fn new() -> Self {
        Self {
            state: UnitState::Opcode,
            observed: at(0),
            executed: Vec::new(),
        }
    }

    fn take(&mut self, byte: u8, now: Stamp<Host>) -> Vec<u8> {
        if now - self.observed > Span::from_millis(500) {
            self.state = UnitState::Opcode;
        }
        self.observed = now;
        match std::mem::replace(&mut self.state, UnitState::Opcode) {
            UnitState::Opcode if matches!(byte, 0x10 | 0x11) => {
                self.state = UnitState::Body(BodyDecoder::new(byte));
                vec![OKAY]
            }
            UnitState::Opcode => vec![FAILED],
            UnitState::Body(mut decoder) => match decoder.push(byte) {
                None => {
                    self.state = UnitState::Body(decoder);
                    Vec::new()
                }
                Some(Err(_)) => vec![FAILED],
                Some(Ok(frame)) => {
                    self.state = UnitState::Ready(self.execute(&frame));
                    vec![OKAY, 0]
                }
            },
            UnitState::Ready(answer) if byte == OKAY => {
                let mut body = Vec::new();
                encode_body(&answer, &mut body).unwrap();
                self.state = UnitState::Receipt;
                body
            }
            UnitState::Ready(_) | UnitState::Receipt => Vec::new(),
        }
    }

    fn execute(&mut self, frame: &SerialFrame) -> SerialFrame {
        let request = Wire::parse(frame).unwrap().unwrap();
        self.executed.push(request);
        match request {
            Wire::ReadObject(read) => {
                let probe = PROBES.iter().find(|(a, _)| *a == read.address);
                ReadObject::answer(match probe {
                    Some((_, error)) => Err(*error),
                    None => Ok(u32::from(read.address.index)),
                })
            }
            _ => WriteObject::answer(Ok(())),
        }
    }
}

#[test]
fn a_unit_that_always_refuses_is_reported() {
    let mut client = DriveClient::new(AxisConfig::default(), DriveLink::Rs232);
    client.start(DriveCommand::Status).unwrap();
    let mut now = at(0);
    for _ in 0..10_000 {
        while client.poll_transmit(now).is_some() {
            now += Span::from_micros(500);
            client.handle_input(&[FAILED], now);
        }
        match client.poll_event() {
            Some(DriveEvent::Failed(error)) => {
                assert!(
                    matches!(
                        error,
                        DriveError::LinkLost { .. }
                            | DriveError::NoAnswer { .. }
                            | DriveError::Handshake { .. }
                    ),
                    "{error:?}"
                );
                assert!(now < at(3_000_000));
                return;
            }
            Some(_) => continue,
            None => {}
        }
        now = client
            .poll_timeout()
            .unwrap()
            .max(now + Span::from_nanos(1));
        client.handle_timeout(now);
    }
    panic!("the command does not end: {client:?}");
}

/// Fault of a byte on the line.
#[derive(Clone, Copy, Debug)]
enum Fate {
    Arrives,
    IsLost,
    ComesTwice,
    Becomes(u8),
    TakesMs(u16),
}

fn fates() -> impl Strategy<Value = Vec<Fate>> {
    proptest::collection::vec(
        prop_oneof![
            200 => Just(Fate::Arrives),
            2 => Just(Fate::IsLost),
            1 => Just(Fate::ComesTwice),
            // A handshake changed into its opposite is undetectable; other changes are detected.
            2 => any::<u8>().prop_filter("handshake", |b| ![OKAY, FAILED].contains(b)).prop_map(Fate::Becomes),
            1 => (1..250u16).prop_map(Fate::TakesMs),
        ],
        100..1500,
    )
}

struct Line {
    /// In flight, in order.
    bytes: Vec<(Stamp<Host>, u8)>,
    fates: Box<dyn Iterator<Item = Fate>>,
}

impl Line {
    fn new(fates: Vec<Fate>) -> Self {
        Self {
            bytes: Vec::new(),
            fates: Box::new(fates.into_iter().cycle()),
        }
    }

    fn send(&mut self, bytes: &[u8], now: Stamp<Host>) {
        for &byte in bytes {
            let free = self.bytes.last().map_or(now, |b| b.0.max(now));
            let arrives = free + Span::from_micros(87);
            match self.fates.next().unwrap() {
                Fate::Arrives => self.bytes.push((arrives, byte)),
                Fate::IsLost => {}
                Fate::ComesTwice => self.bytes.extend([(arrives, byte); 2]),
                Fate::Becomes(other) => self.bytes.push((arrives, other)),
                Fate::TakesMs(ms) => {
                    self.bytes
                        .push((arrives + Span::from_millis(ms.into()), byte));
                }
            }
        }
    }

    fn take(&mut self, now: Stamp<Host>) -> Option<u8> {
        (self.bytes.first()?.0 <= now).then(|| self.bytes.remove(0).1)
    }

    fn next(&self) -> Option<Stamp<Host>> {
        self.bytes.first().map(|b| b.0)
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// With any loss and damage a reply belongs to its request, and every request ends. A write is
    /// executed at most once per reported success.
    #[test]
    fn replies_belong_to_their_requests(there in fates(), back in fates(), abandons in proptest::collection::vec(any::<bool>(), 12)) {
        let mut link = RequestLink::new(Codec::new(DriveLink::Rs232, 1));
        let mut drive = ScriptedDrive::new();
        let (mut out, mut home) = (Line::new(there), Line::new(back));
        let mut now = at(0);
        for (n, abandon) in (0u16..).zip(abandons) {
            let access = if n % 4 == 3 { ObjectAccess::Write { value: 1, width: 2 } } else { ObjectAccess::Read };
            link.submit(request(0x6000 + n, access));
            let began = now;
            let executed_before = drive.executed.len();
            for _ in 0..20_000 {
                while let Some(bytes) = link.transmit(now) {
                    out.send(&bytes, now);
                }
                match link.take_result() {
                    Some(Ok(answered)) => {
                        let value = (access == ObjectAccess::Read).then_some(u32::from(0x6000 + n));
                        prop_assert_eq!(answered.reply.value(), value);
                        prop_assert_eq!(answered.reply.error(), AbortCode::NONE);
                        prop_assert!(answered.sent >= began && answered.received == now);
                        let ours = |w: &Wire| match w {
                            Wire::ReadObject(r) => r.address.index == 0x6000 + n,
                            Wire::WriteObject(w) => w.address.index == 0x6000 + n,
                            _ => false,
                        };
                        prop_assert!(drive.executed[executed_before..].iter().any(ours));
                        break;
                    }
                    Some(Err(RequestFailure::NoReply { .. } | RequestFailure::LinkLost { .. } | RequestFailure::HandshakeRefused { .. })) => break,
                    None => {}
                }
                if abandon && now > began + Span::from_millis(30) {
                    link.abandon();
                    break;
                }
                let next = [out.next(), home.next(), link.deadline()];
                now = next.into_iter().flatten().min().unwrap().max(now);
                while let Some(byte) = out.take(now) {
                    let replies = drive.take(byte, now);
                    home.send(&replies, now + Span::from_micros(300));
                }
                while let Some(byte) = home.take(now) {
                    link.handle_input(&[byte], now);
                }
                link.expire(now);
            }
            prop_assert!(now - began < Span::from_secs(5), "{:?}", now - began);
        }
    }

    /// Arbitrary bytes cause no panic, and every command ends.
    #[test]
    fn arbitrary_bytes_do_not_hang_the_client(inputs in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..12), 0..60)) {
        let mut client = DriveClient::new(AxisConfig::default(), DriveLink::Rs232);
        client.start(DriveCommand::Connect).unwrap();
        let mut now = at(0);
        for bytes in &inputs {
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
