//! Reads and writes of the object dictionary.

use protocol::epos2::cia402::control;
use protocol::epos2::objects::{self, Address};

use super::super::AbortCode;
use super::super::entry::{EntryAccess, Type};
use super::super::table::TABLE;
use super::{command, enabled, get, healthy, set, ticks};

#[test]
fn refused_accesses_have_their_abort_codes() {
    let mut node = healthy();
    let mut refused = |index, sub, raw| node.write(Address::new(index, sub), raw).unwrap_err();
    assert_eq!(refused(0x6041, 0, 0), AbortCode::READ_ONLY);
    assert_eq!(refused(0x5000, 0, 0), AbortCode::NO_OBJECT);
    assert_eq!(refused(0x6040, 1, 0), AbortCode::NO_SUB);
    assert_eq!(refused(0x607F, 0, 25_001), AbortCode::TOO_HIGH);
    assert_eq!(refused(0x2210, 1, 15), AbortCode::TOO_LOW);
    assert_eq!(refused(0x6060, 0, 42), AbortCode::RANGE);
    assert_eq!(refused(0x6098, 0, 3), AbortCode::RANGE);
    assert_eq!(refused(0x1003, 0, 1), AbortCode::RANGE);
    assert_eq!(refused(0x1010, 1, 1), AbortCode::STORE);
    set(&mut node, objects::MIN_POSITION, 0);
    assert_eq!(
        node.write(objects::MAX_POSITION.address, u32::MAX),
        Err(AbortCode::MAX_BELOW_MIN)
    );
}

#[test]
fn power_stage_configuration_needs_power_off() {
    let mut node = enabled();
    assert_eq!(
        node.write(objects::MOTOR_TYPE.address, 1),
        Err(AbortCode::STATE)
    );
    assert_eq!(
        node.write(objects::ENCODER_LINES.address, 1000),
        Err(AbortCode::STATE)
    );
    command(&mut node, control::DISABLE_VOLTAGE);
    assert_eq!(node.write(objects::MOTOR_TYPE.address, 1), Ok(()));
    assert_eq!(node.write(objects::ENCODER_LINES.address, 1000), Ok(()));
}

#[test]
fn values_round_trip_in_their_width() {
    let mut node = healthy();
    node.write(objects::HOMING_METHOD.address, 0xDEAD_BE11)
        .unwrap();
    assert_eq!(get(&node, objects::HOMING_METHOD), 0x11);
    node.write(objects::HOME_OFFSET.address, 0xFFFF_FFFE)
        .unwrap();
    assert_eq!(get(&node, objects::HOME_OFFSET), -2);
    assert_eq!(node.read(objects::DEVICE_NAME).unwrap().bytes(), b"EPOS2");
    assert_eq!(
        node.read(objects::SERIAL_NUMBER_64).unwrap().bytes().len(),
        8
    );
    assert_eq!(get(&node, objects::SOFTWARE_VERSION), 0x2126);
    assert_eq!(get(&node, objects::HARDWARE_VERSION), 0x6420);
}

#[test]
fn every_object_that_the_protocol_names_exists_in_its_width() {
    let node = healthy();
    for named in objects::ALL {
        let value = node.read(named.address).unwrap();
        assert_eq!(value.bytes().len(), usize::from(named.bytes), "{named:?}");
    }
    for entry in &TABLE {
        let expected = match (entry.access, entry.ty) {
            (EntryAccess::Wo, _) => Some(AbortCode::WRITE_ONLY),
            (_, Type::Domain) => Some(AbortCode::STATE),
            _ => None,
        };
        assert_eq!(
            node.read(entry.address).err(),
            expected,
            "{}",
            entry.address
        );
    }
}

#[test]
fn save_survives_power_off_and_load_restores_the_defaults() {
    let mut node = healthy();
    set(&mut node, objects::PROFILE_VELOCITY, 77);
    set(&mut node, objects::STORE_ALL, objects::SAVE);
    set(&mut node, objects::PROFILE_VELOCITY, 88);
    node.power_cycle();
    assert_eq!(get(&node, objects::PROFILE_VELOCITY), 77);
    set(&mut node, objects::RESTORE_ALL, objects::LOAD);
    assert_eq!(get(&node, objects::PROFILE_VELOCITY), 1000);
}

#[test]
fn the_timestamp_counts_microseconds_from_the_written_value() {
    let mut node = healthy();
    ticks(&mut node, 3);
    node.set_phase_us(250);
    assert_eq!(get(&node, objects::TIMESTAMP), 3250);
    set(&mut node, objects::TIMESTAMP, u32::MAX);
    node.tick();
    assert_eq!(get(&node, objects::TIMESTAMP), 749);
}
