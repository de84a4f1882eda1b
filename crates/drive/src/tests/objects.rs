//! Direct access to any object, expedited and in segments, both ways, with aborts.

use protocol::canopen::sdo::TransferError;
use protocol::epos2::message::SerialRequest;
use protocol::epos2::objects::Address;
use protocol::epos2::{AbortCode, BoundedVec};
use protocol::record::DriveLink;

use super::long_object::LongObject;
use super::rig::{Rig, to};
use super::test_drive::Fate;
use crate::{AxisConfig, CommandOutcome, DriveCommand, DriveError, Observation};

const LINKS: [DriveLink; 3] = [DriveLink::Usb, DriveLink::Rs232, DriveLink::Can];
const NAME: Address = Address::new(0x1008, 0);
const SERIAL: Address = Address::new(0x1018, 4);

/// A drive with a long object, which the simulated EPOS2 has not, instead of its name.
fn rig(link: DriveLink) -> Rig {
    with_name(Rig::on(link, AxisConfig::default()))
}

fn with_name(mut rig: Rig) -> Rig {
    let on_can = rig.drive.link == DriveLink::Can;
    rig.drive.long_object = Some(LongObject::new(on_can));
    rig
}

fn name(rig: &mut Rig) -> &mut LongObject {
    rig.drive.long_object.as_mut().unwrap()
}

fn write(address: Address, bytes: &[u8]) -> DriveCommand {
    let bytes = BoundedVec::from_slice(bytes).unwrap();
    DriveCommand::Write { address, bytes }
}

fn read(rig: &mut Rig, address: Address) -> Result<Vec<u8>, DriveError> {
    match rig.run(DriveCommand::Read(address))? {
        CommandOutcome::Read {
            address: got,
            bytes,
        } if got == address => Ok(bytes),
        other => panic!("{other:?}"),
    }
}

/// Lengths around multiples of a CAN segment, and the toggle bit of each segment.
#[test]
fn long_objects_are_written_and_read_back() {
    for link in LINKS {
        let mut rig = rig(link);
        for len in [5, 6, 7, 8, 13, 14, 15, 20] {
            // USB doubles 0x90.
            let bytes: Vec<u8> = (0..len).map(|n| 0x90 - n % 3).collect();
            assert_eq!(
                rig.run(write(NAME, &bytes)),
                Ok(CommandOutcome::Written(NAME)),
                "{link:?} {len}"
            );
            assert_eq!(name(&mut rig).bytes, bytes, "{link:?}");
            assert_eq!(read(&mut rig, NAME).unwrap(), bytes, "{link:?}");
        }
        assert_eq!(rig.drive.aborts, []);
        assert_eq!(rig.client.link_stats().lost, 0);
        // The log can be decoded.
        let is_noise = |seen: &&Observation| matches!(seen, Observation::Noise { .. });
        assert_eq!(rig.observations().iter().find(is_noise), None, "{link:?}");
    }
}

#[test]
fn short_objects_take_one_exchange_of_their_width() {
    for link in LINKS {
        let mut rig = rig(link);
        for (index, sub, bytes) in [
            (0x2300, 4, &[0xFA_u8][..]),
            (0x2100, 1, &[0x90, 0x01]),
            (0x6081, 0, &[0x78, 0x56, 0x34, 0x12]),
        ] {
            rig.drive.requests.clear();
            rig.run(write(Address::new(index, sub), bytes)).unwrap();
            let mut value = [0; 4];
            value[..bytes.len()].copy_from_slice(bytes);
            assert_eq!(rig.drive.get(index, sub), u32::from_le_bytes(value));
            assert_eq!(rig.drive.requests.len(), 2, "the statusword, and it");
        }
    }
}

#[test]
fn aborts_by_the_drive_are_reported_at_the_start_and_at_the_end() {
    for link in LINKS {
        let mut rig = rig(link);
        let absent = Address::new(0x5000, 1);
        for (address, len, expected) in [
            (absent, 8, AbortCode::NO_OBJECT),
            (NAME, 21, AbortCode::TOO_LONG),
        ] {
            let error = rig.run(write(address, &vec![1; len])).unwrap_err();
            assert!(
                matches!(error, DriveError::Refused { error, .. } if error == expected),
                "{link:?}: {error}"
            );
            let begin = format!("writing {len} bytes to object {address} refused by the drive");
            assert!(error.to_string().starts_with(&begin), "{error}");
        }
        name(&mut rig).refuses = true;
        let error = rig.run(write(NAME, b"a longer name")).unwrap_err();
        assert!(
            matches!(
                error,
                DriveError::Refused {
                    error: AbortCode::STATE,
                    ..
                }
            ),
            "{link:?}: {error}"
        );
        assert!(matches!(
            read(&mut rig, absent),
            Err(DriveError::Refused { .. })
        ));
        // The node's abort ends the transfer, and the next one works.
        assert_eq!(rig.drive.aborts, []);
        assert_eq!(name(&mut rig).bytes, b"EPOS2");
        assert_eq!(read(&mut rig, NAME).unwrap(), b"EPOS2");
    }
}

#[test]
fn a_wrong_toggle_bit_aborts_a_write() {
    for link in LINKS {
        let mut rig = rig(link);
        name(&mut rig).wrong_toggle = true;
        let error = rig.run(write(NAME, b"another name")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "writing 12 bytes to object 1008:00 in segments: SDO: toggle bit 1, expected 0",
            "{link:?}"
        );
        let aborts = if link == DriveLink::Can {
            vec![AbortCode::TOGGLE]
        } else {
            Vec::new()
        };
        // The pending abort is sent with the next command.
        name(&mut rig).wrong_toggle = false;
        assert_eq!(read(&mut rig, NAME).unwrap(), name(&mut rig).bytes);
        assert_eq!(rig.drive.aborts, aborts, "{link:?}");
    }
}

#[test]
fn a_lost_segment_is_not_repeated() {
    for link in LINKS {
        for lost in 1..4 {
            let mut rig = rig(link);
            rig.drive.hand = Box::new(move |n, _| if n == lost { Fate::Lost } else { Fate::Sent });
            let ended = rig.run(write(NAME, b"fourteen bytes"));
            // A single segment suffices on a serial link.
            if lost == 3 && link != DriveLink::Can {
                assert!(ended.is_ok(), "{link:?}");
                continue;
            }
            let error = ended.unwrap_err();
            assert!(
                matches!(error, DriveError::NoAnswer { attempts: 1, .. }),
                "{link:?} {lost}: {error}"
            );
            rig.drive.hand = Box::new(|_, _| Fate::Sent);
            read(&mut rig, NAME).unwrap();
            let timed_out = rig.drive.aborts == [AbortCode::TIMEOUT];
            assert_eq!(timed_out, link == DriveLink::Can, "{link:?} {lost}");
        }
    }
}

#[test]
fn reading_an_oversized_object_fails() {
    for link in LINKS {
        let mut rig = rig(link);
        name(&mut rig).bytes = vec![b'x'; 300];
        let error = read(&mut rig, NAME).unwrap_err();
        assert!(
            matches!(
                error,
                DriveError::Transfer {
                    error: TransferError::TooLong { max: 256, .. },
                    ..
                }
            ),
            "{error}"
        );
        name(&mut rig).bytes.truncate(256);
        assert_eq!(read(&mut rig, NAME).unwrap().len(), 256, "{link:?}");
    }
}

#[test]
fn direct_writes_are_refused_for_the_controlword_and_while_enabled() {
    for link in LINKS {
        let mut rig = with_name(Rig::homed_on(link));
        let controlword = Address::new(0x6040, 0);
        let error = rig.run(write(controlword, &[0x1F, 0])).unwrap_err();
        assert!(matches!(error, DriveError::Reserved { .. }), "{error}");
        rig.run(DriveCommand::Goto(to(-50.0))).unwrap();
        rig.forget();
        let error = rig.run(write(NAME, b"a new name")).unwrap_err();
        assert!(matches!(error, DriveError::State { .. }), "{error}");
        assert_eq!(rig.drive.requests.len(), 1, "{link:?}: the statusword");
        rig.run(DriveCommand::Brake).unwrap();
        assert!(rig.run(write(NAME, b"a new name")).is_ok());
    }
}

/// The bytes that USB doubles, that begin its frames, and that RS232 uses as handshake and answer
/// opcode, at every position of the data.
#[test]
fn every_byte_value_passes_at_every_position() {
    for link in LINKS {
        let mut rig = rig(link);
        for special in [0x90, 0x02, 0x4F, 0x46, 0x00] {
            for mask in 1..16_u8 {
                let value = u32::from_le_bytes(std::array::from_fn(|at| {
                    if mask & 1 << at == 0 { 0x11 } else { special }
                }));
                rig.drive.hand = Box::new(move |_, request| match request {
                    SerialRequest::ReadObject(read) if read.address == SERIAL => Fate::Value(value),
                    _ => Fate::Sent,
                });
                let Ok(CommandOutcome::Status(status)) = rig.run(DriveCommand::Status) else {
                    panic!("{link:?}: {:?}", rig.events.last())
                };
                assert_eq!(status.identity.serial, value, "{link:?}");
                let object = Address::new(0x6065, 0);
                rig.run(write(object, &value.to_le_bytes())).unwrap();
                assert_eq!(rig.drive.get(0x6065, 0), value, "{link:?}");
            }
            for (len, at) in (5..16).flat_map(|len| (0..len).map(move |at| (len, at))) {
                let mut bytes = vec![0x11; len];
                bytes[at] = special;
                rig.run(write(NAME, &bytes)).unwrap();
                assert_eq!(name(&mut rig).bytes, bytes, "{link:?}");
                assert_eq!(read(&mut rig, NAME).unwrap(), bytes, "{link:?}");
            }
        }
        let stats = rig.client.link_stats();
        assert_eq!((stats.lost, stats.damaged), (0, 0), "{link:?}");
    }
}
